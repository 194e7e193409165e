//! Apps whose stages run on a GPU.

pub mod backend;
pub mod contacts;
pub mod readback;
pub mod writes;
