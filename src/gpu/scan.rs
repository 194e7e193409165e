//! Exclusive scan of words on the device. One workgroup scans a short list alone, in one dispatch. A long one takes
//! three: sums of blocks, scan of the sums, application. There is no look-back, because WGSL does not guarantee
//! progress between workgroups.

use super::kernel::{Kernel, kernel};
use super::program::{Calls, Groups};

/// Values per workgroup.
pub const BLOCK: u32 = 1024;

/// In place of the index of a counter: the total is not needed.
pub const NO_TOTAL: u32 = u32::MAX;

/// The longest list that one workgroup scans alone. It takes a loop of 16 rounds, which costs less than two dispatches
/// more.
pub const WHOLE: u32 = 16 * BLOCK;

/// Scans a short list.
pub const SCAN_WHOLE: Kernel = kernel!("shared/scan_whole");
/// Sums the blocks.
pub const SUMS: Kernel = kernel!("shared/scan_sums");
/// Scans the sums.
pub const SPINE: Kernel = kernel!("shared/scan_spine");
/// Adds the sums to the values of each block.
pub const APPLY: Kernel = kernel!("shared/scan_apply");

/// Number of scanned values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// The value of the counter.
    Counter,
    /// The digit counts of a sort of that many keys.
    Digits,
}

/// The names of the arrays of a scan.
#[derive(Clone, Copy, Debug)]
pub struct Scan {
    /// Contains the number of values, and receives the total.
    pub counters: &'static str,
    /// Values, each of which is replaced by the sum of all before it.
    pub values: &'static str,
    /// Scratch memory: one word per [`BLOCK`] values.
    pub sums: &'static str,
}

impl Scan {
    /// Adds the calls. `counter` is the index of the counter that determines the number of values; `total` is the index
    /// of the counter that receives the total. There are at most `at_most` values. `groups` is the workgroup count of
    /// the kernels over blocks.
    pub fn record(
        &self,
        calls: &mut Calls,
        counter: u32,
        length: Length,
        total: Option<u32>,
        at_most: u32,
        groups: Groups,
    ) {
        let constants = [counter, length as u32, total.unwrap_or(NO_TOTAL), 0];
        let Self { counters, values, sums } = *self;
        if at_most <= WHOLE {
            let call = calls.call(&SCAN_WHOLE, Groups::Exactly(1)).constants(constants);
            call.bind("counters", counters).bind("values", values);
            return;
        }
        for (kernel, groups) in [(&SUMS, groups), (&SPINE, Groups::Exactly(1)), (&APPLY, groups)] {
            let call = calls.call(kernel, groups).constants(constants);
            call.bind("counters", counters).bind("sums", sums);
            if kernel.name != SPINE.name {
                call.bind("values", values);
            }
        }
    }
}
