#define_import_path faceoff::union_find

// Islands of bodies by union-find. The solver and sleep each join the bodies of their own pairs.

// A body in the union-find forest of islands.
struct Island {
    // A body closer to the root of the island, or the root itself. The root has the smallest number.
    parent: atomic<u32>,
    // For sleep: the bodies that this body touches, as the sum of their keys.
    neighbours: atomic<u32>,
    // For sleep, of a root, not 0: the island stays awake, or must wake.
    disturbed: atomic<u32>,
    padding: u32,
}

@group(0) @binding(8) var<storage, read_write> islands: array<Island>;

// The root of a body's island, with path halving. Parents have smaller numbers, so the loop ends.
fn root_of(body: u32) -> u32 {
    var at = body;
    var above = atomicLoad(&islands[at].parent);
    while above < at {
        let next = atomicLoad(&islands[above].parent);
        atomicMin(&islands[at].parent, next);
        at = above;
        above = next;
    }
    return at;
}

// Unites two islands without locks (Komura, "GPU-based cluster-labeling algorithm without the use of conventional
// iteration", 2015). Whatever the order of threads, the smallest number becomes the root.
fn join(a: u32, b: u32) {
    var one = root_of(a);
    var other = root_of(b);
    while one != other {
        let high = max(one, other);
        let low = min(one, other);
        let before = atomicMin(&islands[high].parent, low);
        if before == high {
            return;
        }
        // Another thread has united it with a different root meanwhile.
        one = before;
        other = low;
    }
}
