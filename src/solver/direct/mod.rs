//! A direct solve of an island whose passes do not converge: chains, arches, and heavy bodies on light ones.
//!
//! A pass moves an impulse by one body, so a chain of a hundred links needs thousands of passes. Passes that end early
//! leave impulses that belong to a moment that has passed: the next substep starts with them, and a chain that was
//! stopped by its tension is thrown back with more energy than it had.
//!
//! Here the velocities of all bodies of the island are the unknowns, and the impulses follow from them. An
//! interior-point method finds both: impulses and gaps stay positive, and their products fall together, so the method
//! needs no guess which points push (Wright, "Primal-Dual Interior-Point Methods", 1997). Each iteration solves a
//! linear system. The limits of friction follow the normal impulses from one iteration to the next.
//!
//! The matrix has a block of six unknowns for each body and one for each pair of bodies in contact. It is factorised
//! in an order that fills few other blocks, so a chain costs no more than its length.
//!
//! | file | contents |
//! |---|---|
//! | `island` | an island, gathered from the lanes of its batches |
//! | `interior` | the iteration |
//! | `point` | a contact point, and the laws between its impulses and velocities |
//! | `mass` | how a body reacts to impulses |
//! | `blocks` | the sparse Cholesky factorisation |
//! | `order` | in which order bodies are eliminated |

mod blocks;
mod interior;
mod island;
mod mass;
mod order;
mod point;

pub(super) use island::Direct;

use super::colors::LANES;

/// The islands of a bundle that are solved directly.
#[derive(Default)]
pub(super) struct DirectIslands {
    islands: [Option<Direct>; LANES],
    /// Bits of islands of which it is known whether they are, and of those under a heavy load.
    asked: u32,
    loaded: u32,
}

impl DirectIslands {
    /// Adds the island of this number, which is under a heavy load, if it can be solved directly. Returns whether it
    /// can.
    pub fn add(&mut self, number: usize, island: Option<Direct>) -> bool {
        self.asked |= 1 << number;
        self.loaded |= 1 << number;
        self.islands[number] = island;
        self.islands[number].is_some()
    }

    /// Whether the island of this number is under a heavy load.
    pub fn is_loaded(&self, number: usize) -> bool {
        self.loaded >> number & 1 == 1
    }

    /// The island of this number if it is solved directly. `new` makes one that is not under a heavy load when it is
    /// needed for the first time.
    pub fn get(&mut self, number: usize, new: impl FnOnce() -> Option<Direct>) -> Option<&mut Direct> {
        if self.asked >> number & 1 == 0 {
            self.asked |= 1 << number;
            self.islands[number] = new();
        }
        self.islands[number].as_mut()
    }
}
