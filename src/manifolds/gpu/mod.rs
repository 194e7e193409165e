//! Contact generation on the GPU: the twin of [`cpu`](super::cpu), in single precision.
//!
//! | kernel | one workgroup (or thread) per | task |
//! |---|---|---|
//! | select | (pair) | the pairs of a step in ascending order, and which of them are active |
//! | arguments | batch of pairs | workgroup counts; the lengths of lists |
//! | place | (pair of bodies) | relative poses |
//! | split | pair | the pieces of large pairs, as in TriangleTest |
//! | near | pair, or piece | pairs of triangles no farther apart than the margin, by both bounding-volume trees |
//! | features | pair, or piece | vertex-face and edge-edge features, segments in which triangles cross |
//! | near features | pair | features between nearest points, and which of them count |
//! | arrival | pair | which speculative points count: those where the surfaces meet, if they move |
//! | first contact | pair | where pairs meet of which points do not count |
//! | contour | pair | contours, also those that end at rims of open meshes, and patches |
//! | depth | pair | patches that are too deep for features; the window of the second search |
//! | split, near, features | pair, or piece | a second search around patches, for features that overlap |
//! | admit | pair | features that agree with the patches; the patches without an overlapping feature, or too deep for any |
//! | ray | pair | rays out of patches without an overlapping feature, and from the vertices that reach deepest there |
//! | inside | pair | containment; segments that pierce faces |
//! | reduce | pair | contact reduction, to at most 16 points |
//! | planes | body | contact points on planes |
//! | compound anchors | (slot) | anchors on colliders of compounds |
//! | counts, scans, emit | (slot) | the lists of pairs and points |
//!
//! Pairs of bodies that sleep or have completed their step are not active: they keep their contact points.
//!
//! From `arguments` to `reduce` the kernels run for one batch of active pairs, and then for the next in the same lists:
//! a pair needs most of its memory until it has its points, and none of that afterwards. There is one batch unless
//! these lists become very long: see [`batches`](mod@batches). The others run once, for all pairs.
//!
//! The results are two lists without gaps, ascending by the numbers of the bodies, and counters. The counters hold the
//! lengths of the results and tell whether an intermediate list overflowed. Test `CONTACTS_SKIPPED` first: if it is
//! set, the host makes the lists as long as the counters say and repeats the run. Plane `i` is numbered `bodies +
//! i`.
//!
//! The range of a pair in the intermediate lists depends on the order of workgroups. The order within the range is that
//! of the trees, and the order of the results follows from a scan. So a device always gives the same bits, in any
//! number of batches.
//!
//! What one workgroup does for a pair is at most proportional to the numbers of its features, segments and components,
//! or to their logarithms times them: features find their patches in a tree, and features of a vertex each other in a
//! hash table. Of pairs that are apart a workgroup looks at all pairs of triangles within the margin, also of large
//! meshes.
//!
//! Differences by single precision: bodies that overlap by less than some millionths of their size have no contours and
//! count as touching. Of several points at the same distance another may be selected than on the CPU. More than 1024
//! loose contour ends of a pair are not tied, and only 1024 components of a mesh are tested for containment.
//!
//! Rounded bodies have the distances of their cores until the reduction, where both roundings are taken off. Without
//! rounding nothing changes.
//!
//! Points of first contact are searched for among the triangles within the margin, and colliders of compounds turn
//! about their own centres meanwhile. What comes nearer than a quarter of the rest offset touches there.

pub mod batches;
pub mod buffers;
pub mod record;
mod reduce;

pub use batches::BatchSize;
pub use buffers::{ContactBuffers, ContactCapacity, ContactScratch};

use super::cpu::{arrival, contour, feature, near_features, nearest, pair, planes, precision, rim, side, smooth};
use crate::geometry::features::MIN_TURN;
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::shader::{Module, Shaders, module, shared_constants};

/// Selects pairs, keyed by their second body.
const SELECT_KEYS: Kernel = kernel!("manifolds/select_keys");
/// Replaces the keys by the first body.
const SELECT_ORDER: Kernel = kernel!("manifolds/select_order");
/// Writes the pairs in ascending order.
const SELECT_PAIRS: Kernel = kernel!("manifolds/select_pairs");
/// Computes workgroup counts.
const ARGUMENTS: Kernel = kernel!("manifolds/arguments");
/// Computes relative poses.
const PLACE: Kernel = kernel!("manifolds/place");
/// Finds pairs of near triangles.
const NEAR: Kernel = kernel!("manifolds/near");
/// Finds pairs of near triangles in pieces of large pairs.
const NEAR_PIECES: Kernel = kernel!("manifolds/near", "PIECES");
/// Splits large pairs into pieces.
const SPLIT: Kernel = kernel!("manifolds/split");
/// Finds features and segments, and overlapping features.
const FEATURES: [Kernel; 2] = [kernel!("manifolds/features"), kernel!("manifolds/features", "DEEP")];
/// Finds features and segments in pieces of large pairs.
const FEATURES_OF_PIECES: [Kernel; 2] = [
    kernel!("manifolds/features", "PIECES"),
    kernel!("manifolds/features", "DEEP PIECES"),
];
/// Finds the features between nearest points that count.
const NEAR_FEATURES: Kernel = kernel!("manifolds/near_features");
/// Drops speculative points where the surfaces do not meet.
const ARRIVAL: Kernel = kernel!("manifolds/arrival");
/// Finds where pairs with dropped points meet.
const FIRST_CONTACT: Kernel = kernel!("manifolds/first_contact");
/// Joins contours and computes patches.
const CONTOUR: Kernel = kernel!("manifolds/contour");
/// Measures how deep bodies overlap at patches.
const DEPTH: Kernel = kernel!("manifolds/depth");
/// Drops features that disagree with patches.
const ADMIT: Kernel = kernel!("manifolds/admit");
/// Casts rays out of patches.
const RAY: Kernel = kernel!("manifolds/ray");
/// Tests for containment.
const INSIDE: Kernel = kernel!("manifolds/inside");
/// Finds contact points on planes.
const PLANES: Kernel = kernel!("manifolds/planes");
/// Measures anchors on colliders of compounds from the compound's centre of mass.
const COMPOUND_ANCHORS: Kernel = kernel!("manifolds/compound_anchors");
/// Counts the pairs and points of slots.
const COUNTS: Kernel = kernel!("manifolds/counts");
/// Writes the lists of pairs and points.
const EMIT: Kernel = kernel!("manifolds/emit");

const CONSTANTS: Module = shared_constants!("faceoff::constants::manifolds", {
    u32 MAX_PLANE_POINTS = planes::MAX_POINTS;
    f32 ERROR = precision::ERROR;
    f32 DIRECTION_ERROR = precision::DIRECTION_ERROR;
    f32 AROUND_ERROR = precision::AROUND_ERROR;
    f32 BELOW = feature::BELOW;
    f32 ARC = feature::ARC;
    f32 ARC_SLACK = side::ARC_SLACK * feature::ARC;
    f32 FLAT = feature::FLAT;
    f32 PARALLEL = feature::PARALLEL;
    f32 OUTSIDE = feature::OUTSIDE;
    f32 ALONG = nearest::ALONG;
    f32 ARRIVAL_TOLERANCE = arrival::TOLERANCE;
    f32 NEARER = near_features::NEARER;
    f32 BESIDE = near_features::BESIDE;
    f32 SAME_PLACE = side::SAME_PLACE;
    f32 NUDGE = side::NUDGE;
    f32 MIN_AGREEMENT = contour::MIN_AGREEMENT;
    f32 REACH_FACTOR = contour::REACH_FACTOR;
    f32 PROBE_FRACTION = contour::PROBE_FRACTION;
    f32 MIN_ENCLOSED_AREA = contour::MIN_ENCLOSED_AREA;
    f32 MAX_DEPTH = pair::MAX_DEPTH;
    f32 RAY_LENGTH = pair::RAY_LENGTH;
    f32 MIN_PROBED_AREA = pair::MIN_PROBED_AREA;
    f32 ASIDE = pair::ASIDE;
    f32 DEEPER = pair::DEEPER;
    f32 SHALLOW = pair::SHALLOW;
    f32 MIN_MEAN = rim::MIN_MEAN;
    f32 HALFWAY_DEPTH = rim::HALFWAY_DEPTH;
    f32 SAME_CONTACT = pair::SAME_CONTACT;
    f32 SMOOTH = smooth::SMOOTH;
    f32 SMOOTH_PAIR = smooth::SMOOTH_PAIR;
    f32 MIN_TURN = MIN_TURN;
    f32 MIN_ROLL = smooth::MIN_ROLL;
    f32 LEVEL = planes::LEVEL;
    f32 MARGIN = planes::MARGIN;
});

/// This stage's modules and kernels.
pub const SHADERS: Shaders = Shaders {
    modules: &[
        CONSTANTS,
        reduce::CONSTANTS,
        module!("manifolds/batches"),
        module!("manifolds/contact_slots"),
        module!("manifolds/thread_sums"),
        module!("manifolds/side"),
        module!("manifolds/feature"),
        module!("manifolds/nearest"),
        module!("manifolds/known_vertices"),
        module!("manifolds/near_ranges"),
        module!("manifolds/surface"),
        module!("manifolds/pair_motion"),
        module!("manifolds/smooth"),
        module!("manifolds/near_boxes"),
        module!("manifolds/near_patches"),
        module!("manifolds/contours"),
        module!("manifolds/contour_sums"),
        module!("manifolds/rims"),
        module!("manifolds/empty_patches"),
        module!("manifolds/probes"),
        module!("manifolds/deepest"),
    ],
    kernels: &[
        &SELECT_KEYS,
        &SELECT_ORDER,
        &SELECT_PAIRS,
        &ARGUMENTS,
        &PLACE,
        &SPLIT,
        &NEAR,
        &NEAR_PIECES,
        &FEATURES[0],
        &FEATURES_OF_PIECES[0],
        &FEATURES[1],
        &FEATURES_OF_PIECES[1],
        &NEAR_FEATURES,
        &ARRIVAL,
        &FIRST_CONTACT,
        &CONTOUR,
        &DEPTH,
        &ADMIT,
        &RAY,
        &INSIDE,
        &reduce::REDUCE,
        &PLANES,
        &COMPOUND_ANCHORS,
        &COUNTS,
        &EMIT,
    ],
};
