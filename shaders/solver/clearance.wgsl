#define_import_path faceoff::clearance

// Tight fits: surfaces on opposite sides of a body that leave less room than two rest offsets. The twin of
// `src/solver/clearance.rs`.

#import faceoff::constants::solver::{ALIKE, MOST_COMPARED, OPPOSITE}
#import faceoff::overlap::contact_points
#import faceoff::solver_types as s
#import faceoff::types as t

// Whether points of a pair may be opposite.
fn may_be_tight(pair: s::SolverPair) -> bool {
    let end = pair.first + min(pair.count, MOST_COMPARED);
    for (var k = pair.first + 1u; k < end; k += 1u) {
        if dot(contact_points[k].normal, contact_points[pair.first].normal) < ALIKE {
            return true;
        }
    }
    return false;
}

// The rest offset of a point of a pair: half of the gap to each opposite point, if that is less. It is negative by up
// to the bulge where only the meshes leave room.
fn rest_offset(pair: s::SolverPair, point: t::ContactPoint) -> f32 {
    let end = pair.first + min(pair.count, MOST_COMPARED);
    var least = pair.rest_offset;
    for (var k = pair.first; k < end; k += 1u) {
        if dot(contact_points[k].normal, point.normal) < OPPOSITE {
            let other = contact_points[k];
            least = min(least, 0.5 * ((point.separation - point.bulge) + (other.separation - other.bulge)));
        }
    }
    return max(least, -point.bulge);
}
