//! [`MemoryFault`]: why saved memory of a step cannot be used.

use thiserror::Error;

/// Why saved memory of a step cannot be used.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub(crate) enum MemoryFault {
    /// There are more or fewer states than keys.
    #[error("it has {bodies} states of bodies for {keys} keys")]
    Count { keys: usize, bodies: usize },
    /// The named list is not in ascending order.
    #[error("its {0} are not in ascending order, or one of them is there twice")]
    Order(&'static str),
    /// An element of the named list names another element that is not there.
    #[error("its {0} name something that it does not contain")]
    Reference(&'static str),
    /// A number in the named list is NaN, infinite or out of range.
    #[error("its {0} contain a number that is not finite or out of range")]
    Number(&'static str),
}
