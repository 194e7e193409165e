//! Stable sort of words with a value each, eight bits at a time: count digits per block, scan the counts, move. Five
//! dispatches a digit.

use super::kernel::{Kernel, kernel};
use super::program::{Calls, Groups};
use super::scan::{self, Length, Scan};

/// Keys that one workgroup moves.
pub const BLOCK: u32 = 2048;

/// Bits sorted by at a time.
pub const DIGIT: u32 = 8;

/// Different digits that there are.
pub const DIGITS: u32 = 1 << DIGIT;

/// Counts digits.
pub const COUNT: Kernel = kernel!("shared/sort_count");
/// Moves keys and values.
pub const MOVE: Kernel = kernel!("shared/sort_move");

/// The names of a pair of arrays, of keys and of their values.
pub type KeysAndValues = [&'static str; 2];

/// The names of the arrays of a sort, each with room for all keys.
#[derive(Clone, Copy, Debug)]
pub struct Sort {
    /// Holds the number of keys.
    pub counters: &'static str,
    /// Keys and values; read, and overwritten by every second digit.
    pub input: KeysAndValues,
    /// Scratch of the same size.
    pub scratch: KeysAndValues,
    /// [`DIGITS`] words for every [`BLOCK`] keys.
    pub digits: &'static str,
    /// Scratch of the scan over `digits`.
    pub sums: &'static str,
}

impl Sort {
    /// The same for other keys and values.
    pub const fn between(self, input: KeysAndValues, scratch: KeysAndValues) -> Self {
        Self { input, scratch, ..self }
    }

    /// Adds the calls for keys of `bits` bits, and tells which buffers hold the result. `groups` are those for one
    /// workgroup per [`BLOCK`] keys, and for the scan of the digits.
    pub fn record(&self, calls: &mut Calls, counter: u32, bits: u32, groups: [Groups; 2]) -> KeysAndValues {
        let (mut from, mut to) = (self.input, self.scratch);
        for shift in (0..bits).step_by(DIGIT as usize) {
            let constants = [counter, shift, 0, 0];
            let count = calls.call(&COUNT, groups[0]).constants(constants);
            count
                .bind("counters", self.counters)
                .bind("keys", from[0])
                .bind("digits", self.digits);
            let scan = Scan {
                counters: self.counters,
                values: self.digits,
                sums: self.sums,
            };
            scan.record(calls, counter, Length::Digits, None, groups[1]);
            let moved = calls.call(&MOVE, groups[0]).constants(constants);
            moved.bind("counters", self.counters).bind("digits", self.digits);
            moved.bind("keys", from[0]).bind("values", from[1]);
            moved.bind("sorted_keys", to[0]).bind("sorted_values", to[1]);
            std::mem::swap(&mut from, &mut to);
        }
        from
    }
}

/// Workgroups for the scan of the digits of so many keys.
pub fn digit_groups(keys: u32) -> u32 {
    (DIGITS * keys.div_ceil(BLOCK)).div_ceil(scan::BLOCK)
}
