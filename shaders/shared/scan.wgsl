#define_import_path faceoff::scan

// What the three kernels of a scan share. `constants` are: which counter holds the number of things, what is scanned of
// them (see below), and which counter takes the total.

#import faceoff::constants::shared::{DIGITS, SORT_BLOCK}
#import faceoff::dispatch::divide_up

// How many values there are: one for each thing (0), or a sort's 256 digit counts for each of its blocks (1).
fn scan_length(constants: vec4<u32>, things: u32) -> u32 {
    if constants.y == 0u {
        return things;
    }
    return DIGITS * divide_up(things, SORT_BLOCK);
}

