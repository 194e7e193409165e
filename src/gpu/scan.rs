//! Exclusive scan of words on the device: block sums, scan of the sums, apply. Three dispatches, no look-back, since WGSL
//! promises no progress between workgroups.

use super::kernel::{Kernel, kernel};
use super::program::{Calls, Groups};

/// Values that one workgroup scans.
pub const BLOCK: u32 = 1024;

/// The number of a counter that is none: nobody wants the total.
pub const NO_TOTAL: u32 = u32::MAX;

/// Sums blocks.
pub const SUMS: Kernel = kernel!("shared/scan_sums");
/// Scans the sums.
pub const SPINE: Kernel = kernel!("shared/scan_spine");
/// Applies them.
pub const APPLY: Kernel = kernel!("shared/scan_apply");

/// What is scanned: how many values a counter stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// As many as the counter says.
    Counter,
    /// The digit counts of a sort of as many keys.
    Digits,
}

/// The names of the arrays of a scan.
#[derive(Clone, Copy, Debug)]
pub struct Scan {
    /// Holds the length, and takes the total.
    pub counters: &'static str,
    /// Replaced by the sum of all values before.
    pub values: &'static str,
    /// Scratch, a word for every [`BLOCK`] values.
    pub sums: &'static str,
}

impl Scan {
    /// Adds the calls. `length` is in counter `counter`; `total` is the counter that takes the sum of all; `groups` are
    /// those for one workgroup per block.
    pub fn record(&self, calls: &mut Calls, counter: u32, length: Length, total: Option<u32>, groups: Groups) {
        let constants = [counter, length as u32, total.unwrap_or(NO_TOTAL), 0];
        let Self { counters, values, sums } = *self;
        for (kernel, groups) in [(&SUMS, groups), (&SPINE, Groups::Exactly(1)), (&APPLY, groups)] {
            let call = calls.call(kernel, groups).constants(constants);
            call.bind("counters", counters).bind("sums", sums);
            if kernel.name != SPINE.name {
                call.bind("values", values);
            }
        }
    }
}
