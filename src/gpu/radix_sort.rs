//! Stable radix sort of words with values, eight bits at a time. One workgroup sorts a short list alone, in one
//! dispatch. A long one takes three or five per digit: count the digits per block, scan the counts, move.

use super::kernel::{Kernel, kernel};
use super::program::{Calls, Groups};
use super::scan::{self, Length, Scan};

/// Keys per workgroup.
pub const BLOCK: u32 = 2048;

/// Bits per digit.
pub const DIGIT: u32 = 8;

/// Number of digit values.
pub const DIGITS: u32 = 1 << DIGIT;

/// The longest list that one workgroup sorts alone. It takes 16 rounds per digit, which cost less than the dispatches
/// that they replace.
pub const WHOLE: u32 = 4096;

/// Sorts a short list.
pub const SORT_WHOLE: Kernel = kernel!("shared/sort_whole");
/// Counts digits.
pub const COUNT: Kernel = kernel!("shared/sort_count");
/// Moves keys and values.
pub const MOVE: Kernel = kernel!("shared/sort_move");

/// The names of an array of keys and an array of values.
pub type KeysAndValues = [&'static str; 2];

/// The names of the arrays of a sort. Each has the capacity for all keys.
#[derive(Clone, Copy, Debug)]
pub struct Sort {
    /// Contains the number of keys.
    pub counters: &'static str,
    /// Keys and values. They are overwritten.
    pub input: KeysAndValues,
    /// Scratch memory of the same length.
    pub scratch: KeysAndValues,
    /// [`DIGITS`] words per [`BLOCK`] keys.
    pub digits: &'static str,
    /// Scratch memory for the scan of `digits`.
    pub sums: &'static str,
}

impl Sort {
    /// This sort with other keys and values.
    pub const fn between(self, input: KeysAndValues, scratch: KeysAndValues) -> Self {
        Self { input, scratch, ..self }
    }

    /// Adds the calls for at most `at_most` keys of `bits` bits, and returns the names of the buffers with the result.
    /// `groups` are the workgroup counts of the kernels over blocks, and of the scan of the digits.
    pub fn record(
        &self,
        calls: &mut Calls,
        counter: u32,
        bits: u32,
        at_most: u32,
        groups: [Groups; 2],
    ) -> KeysAndValues {
        let (mut from, mut to) = (self.input, self.scratch);
        if at_most <= WHOLE {
            let call = calls.call(&SORT_WHOLE, Groups::Exactly(1));
            call.constants([counter, bits, 0, 0]).bind("counters", self.counters);
            call.bind("keys", from[0]).bind("values", from[1]);
            call.bind("other_keys", to[0]).bind("other_values", to[1]);
            let is_odd = bits.div_ceil(DIGIT) % 2 == 1;
            return if is_odd { to } else { from };
        }
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
            let counts = DIGITS.saturating_mul(at_most.div_ceil(BLOCK));
            scan.record(calls, counter, Length::Digits, None, counts, groups[1]);
            let moved = calls.call(&MOVE, groups[0]).constants(constants);
            moved.bind("counters", self.counters).bind("digits", self.digits);
            moved.bind("keys", from[0]).bind("values", from[1]);
            moved.bind("sorted_keys", to[0]).bind("sorted_values", to[1]);
            std::mem::swap(&mut from, &mut to);
        }
        from
    }
}

/// Workgroup count of the scan of the digits for this many keys.
pub fn digit_groups(keys: u32) -> u32 {
    (DIGITS * keys.div_ceil(BLOCK)).div_ceil(scan::BLOCK)
}
