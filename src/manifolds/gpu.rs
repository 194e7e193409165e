//! Contact generation on a device: the twin of [`cpu`](super::cpu), which explains every step of it, in single precision.
//!
//! | kernel | one workgroup (or thread) for | what it does |
//! |---|---|---|
//! | arguments | all | sizes of the dispatches that follow |
//! | place | (a pair of bodies) | how the two lie to each other |
//! | near | a pair | pairs of triangles no farther apart than the margin, down both trees of boxes |
//! | features | a pair | vertices over faces, edges over edges, segments in which triangles cross |
//! | contours | a pair | segments joined into contours, and their patches |
//! | near, features | a pair | once more, around patches, for features that overlap |
//! | admit | a pair | which features agree with the patches |
//! | probe | a pair | rays out of patches without an overlapping feature |
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
pub mod kernels;

pub use buffers::{ContactBuffers, ContactCapacity};
pub use kernels::{KERNELS, Shared, record, record_lists, record_points};
