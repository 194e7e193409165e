//! Contact generation on a device: the twin of [`cpu`](super::cpu), which explains every step of it, in single precision.
//!
//! | kernel | one workgroup (or thread) for | what it does |
//! |---|---|---|
//! | select | (a pair) | which pairs of a step are looked at, ascending |
//! | arguments | all | sizes of the dispatches that follow |
//! | place | (a pair of bodies) | how the two lie to each other |
//! | near | a pair | pairs of triangles no farther apart than the margin, down both trees of boxes |
//! | features | a pair | vertices over faces, edges over edges, segments in which triangles cross |
//! | contour | a pair | segments joined into contours, and their patches |
//! | near, features | a pair | once more, around patches, for features that overlap |
//! | admit | a pair | which features agree with the patches |
//! | ray | a pair | rays out of patches without an overlapping feature |
//! | inside | a pair | one body inside the other |
//! | reduce | a pair | at most 16 points |
//! | planes | a body | vertices near half-spaces |
//! | counts, scans, emit | (a slot) | the lists of pairs and points |
//!
//! The results are two compact lists, ascending by the numbers of the bodies, and counters that tell how long these are and
//! whether a list on the way had no room: whoever reads them must look at `CONTACTS_SKIPPED` first, and the host then makes
//! the lists as long as the counters say and runs everything again. Half-space `i` is the body `bodies + i`.
//!
//! A pair's share of the lists in between lies wherever a counter had come when the pair asked, but the order within the
//! share is that of the trees, and that of the results follows from a scan: a device gives the same bits every time.
//!
//! What single precision changes: bodies that overlap by less than some millionths of their size have no contours and touch,
//! and of places or points that are as far as each other another may be taken than on the CPU. Not done are more than 1024
//! loose ends of contours per pair, which are not tied then, and more than 1024 components of one mesh inside another.

pub mod buffers;
pub mod record;
mod reduce;

pub use buffers::{ContactBuffers, ContactCapacity};

use super::cpu::{contour, feature, near, pair, planes, side, smooth};
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::shader::{Module, Shaders, module, shared_constants};

/// Which pairs of a step are looked at, and their second bodies.
const SELECT_KEYS: Kernel = kernel!("manifolds/select_keys");
/// Their first bodies.
const SELECT_ORDER: Kernel = kernel!("manifolds/select_order");
/// The pairs, ascending.
const SELECT_PAIRS: Kernel = kernel!("manifolds/select_pairs");
/// How many workgroups the others take.
const ARGUMENTS: Kernel = kernel!("manifolds/arguments");
/// How the bodies of each pair lie to each other.
const PLACE: Kernel = kernel!("manifolds/place");
/// Pairs of triangles that are near each other.
const NEAR: Kernel = kernel!("manifolds/near");
/// Features and segments.
const FEATURES: Kernel = kernel!("manifolds/features");
/// Contours and patches.
const CONTOUR: Kernel = kernel!("manifolds/contour");
/// Which features count.
const ADMIT: Kernel = kernel!("manifolds/admit");
/// Rays out of patches.
const RAY: Kernel = kernel!("manifolds/ray");
/// Bodies inside bodies.
const INSIDE: Kernel = kernel!("manifolds/inside");
/// Bodies on half-spaces.
const PLANES: Kernel = kernel!("manifolds/planes");
/// What the scans add up.
const COUNTS: Kernel = kernel!("manifolds/counts");
/// The lists.
const EMIT: Kernel = kernel!("manifolds/emit");

const CONSTANTS: Module = shared_constants!("faceoff::constants::manifolds", {
    u32 MAX_PLANE_POINTS = planes::MAX_POINTS;
    f32 ERROR = near::ERROR;
    f32 DIRECTION_ERROR = near::DIRECTION_ERROR;
    f32 AROUND_ERROR = near::AROUND_ERROR;
    f32 BELOW = feature::BELOW;
    f32 ARC = feature::ARC;
    f32 ARC_SLACK = side::ARC_SLACK * feature::ARC;
    f32 FLAT = feature::FLAT;
    f32 PARALLEL = feature::PARALLEL;
    f32 OUTSIDE = feature::OUTSIDE;
    f32 SAME_PLACE = side::SAME_PLACE;
    f32 NUDGE = side::NUDGE;
    f32 MIN_AGREEMENT = contour::MIN_AGREEMENT;
    f32 REACH_FACTOR = contour::REACH_FACTOR;
    f32 PROBE_FRACTION = contour::PROBE_FRACTION;
    f32 MIN_ENCLOSED_AREA = contour::MIN_ENCLOSED_AREA;
    f32 MAX_DEPTH = pair::MAX_DEPTH;
    f32 RAY_LENGTH = pair::RAY_LENGTH;
    f32 MIN_PROBED_AREA = pair::MIN_PROBED_AREA;
    f32 SHALLOW = pair::SHALLOW;
    f32 SMOOTH = smooth::SMOOTH;
    f32 LEVEL = planes::LEVEL;
    f32 MARGIN = planes::MARGIN;
});

/// All of them.
pub const SHADERS: Shaders = Shaders {
    modules: &[
        CONSTANTS,
        reduce::CONSTANTS,
        module!("manifolds/contact_slots"),
        module!("manifolds/side"),
        module!("manifolds/feature"),
        module!("manifolds/smooth"),
    ],
    kernels: &[
        &SELECT_KEYS,
        &SELECT_ORDER,
        &SELECT_PAIRS,
        &ARGUMENTS,
        &PLACE,
        &NEAR,
        &FEATURES,
        &CONTOUR,
        &ADMIT,
        &RAY,
        &INSIDE,
        &reduce::REDUCE,
        &PLANES,
        &COUNTS,
        &EMIT,
    ],
};
