#define_import_path faceoff::sort

// Radix sort: the places of 256 keys at a time, one per thread.

// The position of the next key of each digit.
var<workgroup> next: array<u32, 256>;
// Bit sets of the 256 threads that hold each digit: eight words per digit.
var<workgroup> holders: array<atomic<u32>, 2048>;

// Each thread calls this before the first `place`, with the position of the first key whose digit is the thread's
// number.
fn begin(thread: u32, first: u32) {
    next[thread] = first;
    for (var k = 0u; k < 8u; k += 1u) {
        atomicStore(&holders[thread * 8u + k], 0u);
    }
    workgroupBarrier();
}

// The place of a thread's key with this digit. Keys with the same digit keep their order. All threads call it, also
// those that hold no key.
fn place(thread: u32, held: bool, digit: u32) -> u32 {
    if held {
        atomicOr(&holders[digit * 8u + thread / 32u], 1u << (thread % 32u));
    }
    workgroupBarrier();
    var at = 0u;
    if held {
        // Number of earlier threads with the same digit.
        var rank = countOneBits(atomicLoad(&holders[digit * 8u + thread / 32u]) & ((1u << (thread % 32u)) - 1u));
        for (var k = 0u; k < thread / 32u; k += 1u) {
            rank += countOneBits(atomicLoad(&holders[digit * 8u + k]));
        }
        at = next[digit] + rank;
    }
    workgroupBarrier();
    // Each thread updates one digit: it advances the position and clears the bit set for the next round.
    var count = 0u;
    for (var k = 0u; k < 8u; k += 1u) {
        count += countOneBits(atomicExchange(&holders[thread * 8u + k], 0u));
    }
    next[thread] += count;
    workgroupBarrier();
    return at;
}
