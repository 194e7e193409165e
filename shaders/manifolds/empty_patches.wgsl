#define_import_path faceoff::empty_patches

// The list of patches without an overlapping feature, among the contour links of a pair. They are no longer needed when
// features are admitted, and a patch has eight words of them.

#import faceoff::types as t

// The patch has a feature nearby that touches or is apart.
const HAS_FEATURE: u32 = 0x80000000u;

// Index of the n-th entry: the patch's number within the pair, perhaps with `HAS_FEATURE`.
fn list_at(setup: t::PairSetup, n: u32) -> u32 {
    return 8u * setup.first_segment + setup.patch_count + n;
}

// Index of the number of entries.
fn count_at(setup: t::PairSetup) -> u32 {
    return list_at(setup, setup.patch_count);
}
