//! Apps whose stages run on a GPU.

pub mod backend;
pub mod bytes;
pub mod changes;
pub mod clock;
pub mod drawn;
pub mod every_readback;
pub mod fast_bodies;
pub mod readback;
pub mod soak;
pub mod spatial_queries;
pub mod with_contacts;
pub mod writes;
