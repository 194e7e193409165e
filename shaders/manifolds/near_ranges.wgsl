#define_import_path faceoff::near_ranges

// The ranges of a pair's pairs of triangles, one for each piece if it is split.

#import faceoff::types as t

@group(0) @binding(7) var<storage, read> near_pieces: array<t::NearPiece>;

// Number of ranges if there are `pieces` pieces in all and their list holds no more than `limit`. If not all fit, no
// piece has stored its results.
fn range_count(setup: t::PairSetup, pieces: u32, limit: u32) -> u32 {
    let told = select(setup.near_count, 0u, pieces > limit);
    return select(1u, told, setup.is_split != 0u);
}

// The start and the length of the i-th.
fn range_of(setup: t::PairSetup, i: u32) -> vec2<u32> {
    if setup.is_split != 0u {
        let at = setup.first_near + i;
        return vec2(near_pieces[at].first_near, near_pieces[at].near_count);
    }
    return vec2(setup.first_near, setup.near_count);
}
