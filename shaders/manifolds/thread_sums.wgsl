#define_import_path faceoff::thread_sums

// Sums over the 64 threads of a workgroup.

var<workgroup> sums: array<vec2<u32>, 64>;

// The sum of the values of earlier threads. All threads take part.
fn before_threads(own: vec2<u32>, thread: u32) -> vec2<u32> {
    var inclusive = own;
    for (var reach = 1u; reach < 64u; reach *= 2u) {
        sums[thread] = inclusive;
        workgroupBarrier();
        if thread >= reach {
            inclusive += sums[thread - reach];
        }
        workgroupBarrier();
    }
    sums[thread] = inclusive;
    workgroupBarrier();
    return inclusive - own;
}

// The sum of all threads, after `before_threads`.
fn of_all_threads() -> vec2<u32> {
    return sums[63];
}
