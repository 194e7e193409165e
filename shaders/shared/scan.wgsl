#define_import_path faceoff::scan

// What the three kernels of a scan share. `constants` are: which counter holds the number of things, what is scanned of
// them (see below), and which counter takes the total.

#import faceoff::dispatch::divide_up

// Values that one workgroup scans.
const BLOCK: u32 = 1024u;

// Items that one workgroup of a radix sort moves.
const SORT_BLOCK: u32 = 2048u;

// How many values there are: one for each thing (0), or a sort's 256 digit counts for each of its blocks (1).
fn scan_length(constants: vec4<u32>, things: u32) -> u32 {
    if constants.y == 0u {
        return things;
    }
    return 256u * divide_up(things, SORT_BLOCK);
}

// No counter takes the total.
const NO_TOTAL: u32 = 0xffffffffu;
