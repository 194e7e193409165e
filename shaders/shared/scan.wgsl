#define_import_path faceoff::scan

// Shared by the three kernels of a scan. In `constants`, x is the counter that holds the number of elements, y selects
// what is scanned (see below), and z is the counter that receives the total.

#import faceoff::constants::shared::{DIGITS, SORT_BLOCK}
#import faceoff::dispatch::divide_up

// Number of scanned values: one per element (y = 0), or the 256 digit counts of each block of a sort (y = 1).
fn scan_length(constants: vec4<u32>, things: u32) -> u32 {
    if constants.y == 0u {
        return things;
    }
    return DIGITS * divide_up(things, SORT_BLOCK);
}

