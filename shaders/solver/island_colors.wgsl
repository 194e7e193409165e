// Solver: colours the pairs of an island and sorts them by colour. Two pairs of one colour have no body in common that
// impulses move, so they can be solved at once. One workgroup per island.
//
// In each round a pair gets a colour if its rank, with its bits reversed, is the smallest among uncoloured pairs at
// both of its bodies: the lowest colour that is free at both (Jones and Plassmann, "A Parallel Graph Coloring
// Heuristic", 1993). The result does not depend on the order of threads. Ranks count within the island: with the
// numbers of pairs, events elsewhere would change the order of passes, and a barely stable stack would sway.
//
// Pairs with a body that impulses do not move get the last colours: what is solved last is satisfied best, and nothing
// may be pressed through static bodies.
#import faceoff::dispatch::group_index
#import faceoff::solver_types as s

// What the search knows of a body.
struct BodyColors {
    // The pair that may choose a colour now, or the first pair of the island with this body.
    claim: atomic<u32>,
    // The colours that are used, of the 32 that are given at present.
    used: atomic<u32>,
}

@group(0) @binding(0) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(1) var<storage, read> pair_order: array<u32>;
@group(0) @binding(2) var<storage, read_write> solver_pairs: array<s::SolverPair>;
@group(0) @binding(3) var<storage, read_write> island_ranges: array<s::IslandRange>;
@group(0) @binding(4) var<storage, read_write> island_pairs: array<s::IslandPair>;
@group(0) @binding(5) var<storage, read_write> body_colors: array<BodyColors>;

#ifdef LARGE
const THREADS: u32 = 64u;
#else
const THREADS: u32 = 8u;
#endif

// In place of a colour: waits for one of the 32 colours that are given at present, or for later ones.
const WAITING: u32 = 0xffffffffu;
const LATER: u32 = 0xfffffffeu;
const UNCLAIMED: u32 = 0xffffffffu;

var<workgroup> range: vec2<u32>;
var<workgroup> counts: array<vec2<u32>, THREADS>;
var<workgroup> result: vec2<u32>;

@compute @workgroup_size(THREADS)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = group_index(group);
#ifdef LARGE
    let count = solver_counters[s::LARGE_ISLANDS];
    let at = arrayLength(&island_ranges) - 1u - number;
#else
    let count = solver_counters[s::SMALL_ISLANDS];
    let at = number;
#endif
    if thread == 0u {
        range = vec2(0u);
        if number < count {
            range = vec2(island_ranges[at].first, island_ranges[at].end);
        }
    }
    let island = workgroupUniformLoad(&range);
    if island.x == island.y {
        return;
    }
    for (var q = island.x + thread; q < island.y; q += THREADS) {
        solver_pairs[pair_order[q]].color = LATER;
    }
    rank_pairs(thread, island);
    var colors = 0u;
    for (var phase = 0u; phase < 2u; phase += 1u) {
        loop {
            let given = give_colors(thread, island, colors, phase == 1u);
            if given == 0u {
                break;
            }
            colors += given;
        }
    }
    if thread == 0u {
        island_ranges[at].colors = colors;
    }
    sort(thread, island, colors);
    choose_owners(thread, island);
}

// The sum and the maximum over all threads.
fn reduced(thread: u32, sum: u32, maximum: u32) -> vec2<u32> {
    counts[thread] = vec2(sum, maximum);
    workgroupBarrier();
    if thread == 0u {
        var all = vec2(0u);
        for (var other = 0u; other < THREADS; other += 1u) {
            all = vec2(all.x + counts[other].x, max(all.y, counts[other].y));
        }
        result = all;
    }
    return workgroupUniformLoad(&result);
}

fn has_mass(pair: s::SolverPair) -> vec2<bool> {
    return (vec2(pair.flags) & vec2(s::FIRST_HAS_MASS, s::SECOND_HAS_MASS)) != vec2(0u);
}

fn set_claims(pair: s::SolverPair, claim: u32) {
    let moves = has_mass(pair);
    if moves.x {
        atomicStore(&body_colors[pair.a].claim, claim);
    }
    if moves.y {
        atomicStore(&body_colors[pair.b].claim, claim);
    }
}

fn claim(pair: s::SolverPair, priority: u32) {
    let moves = has_mass(pair);
    if moves.x {
        atomicMin(&body_colors[pair.a].claim, priority);
    }
    if moves.y {
        atomicMin(&body_colors[pair.b].claim, priority);
    }
}

// For each body, whether the pair has claimed it.
fn has_claimed(pair: s::SolverPair, priority: u32) -> vec2<bool> {
    let moves = has_mass(pair);
    var claimed = vec2(false);
    if moves.x {
        claimed.x = atomicLoad(&body_colors[pair.a].claim) == priority;
    }
    if moves.y {
        claimed.y = atomicLoad(&body_colors[pair.b].claim) == priority;
    }
    return claimed;
}

// Ranks the pairs of two bodies that impulses move, and the others, each in their order. The ranks are in `flags`.
fn rank_pairs(thread: u32, island: vec2<u32>) {
    let part = (island.y - island.x + THREADS - 1u) / THREADS;
    let start = min(island.x + thread * part, island.y);
    let end = min(start + part, island.y);
    var own = vec2(0u);
    for (var q = start; q < end; q += 1u) {
        own += select(vec2(0u, 1u), vec2(1u, 0u), all(has_mass(solver_pairs[pair_order[q]])));
    }
    counts[thread] = own;
    workgroupBarrier();
    var ranks = vec2(0u);
    for (var other = 0u; other < thread; other += 1u) {
        ranks += counts[other];
    }
    for (var q = start; q < end; q += 1u) {
        let both = all(has_mass(solver_pairs[pair_order[q]]));
        island_pairs[q].flags = select(ranks.y, ranks.x, both);
        ranks += select(vec2(0u, 1u), vec2(1u, 0u), both);
    }
    storageBarrier();
    workgroupBarrier();
}

fn priority_of(q: u32) -> u32 {
    return reverseBits(island_pairs[q].flags);
}

// Gives up to 32 colours from `first` on, to pairs of two bodies that impulses move, or to the others. Returns their
// number: 0 if all these pairs have a colour.
fn give_colors(thread: u32, island: vec2<u32>, first: u32, others: bool) -> u32 {
    var waiting = 0u;
    for (var q = island.x + thread; q < island.y; q += THREADS) {
        let i = pair_order[q];
        let pair = solver_pairs[i];
        let moves = has_mass(pair);
        if pair.color == LATER && (moves.x && moves.y) != others {
            solver_pairs[i].color = WAITING;
            set_claims(pair, UNCLAIMED);
            if moves.x {
                atomicStore(&body_colors[pair.a].used, 0u);
            }
            if moves.y {
                atomicStore(&body_colors[pair.b].used, 0u);
            }
            waiting += 1u;
        }
    }
    storageBarrier();
    var left = reduced(thread, waiting, 0u).x;
    var highest = 0u;
    while left > 0u {
        for (var q = island.x + thread; q < island.y; q += THREADS) {
            let i = pair_order[q];
            let pair = solver_pairs[i];
            if pair.color == WAITING {
                claim(pair, priority_of(q));
            }
        }
        storageBarrier();
        waiting = 0u;
        for (var q = island.x + thread; q < island.y; q += THREADS) {
            let i = pair_order[q];
            let pair = solver_pairs[i];
            if pair.color != WAITING {
                continue;
            }
            if all(has_claimed(pair, priority_of(q)) == has_mass(pair)) {
                let color = choose_color(pair);
                solver_pairs[i].color = select(first + color, LATER, color == 32u);
                highest = max(highest, select(color + 1u, 0u, color == 32u));
            } else {
                waiting += 1u;
            }
        }
        storageBarrier();
        for (var q = island.x + thread; q < island.y; q += THREADS) {
            let pair = solver_pairs[pair_order[q]];
            if pair.color == WAITING {
                set_claims(pair, UNCLAIMED);
            }
        }
        storageBarrier();
        left = reduced(thread, waiting, 0u).x;
    }
    return reduced(thread, 0u, highest).y;
}

// The lowest colour, of 32, that no other pair of its bodies has; 32 if there is none.
fn choose_color(pair: s::SolverPair) -> u32 {
    let moves = has_mass(pair);
    var used = 0u;
    if moves.x {
        used |= atomicLoad(&body_colors[pair.a].used);
    }
    if moves.y {
        used |= atomicLoad(&body_colors[pair.b].used);
    }
    if used == 0xffffffffu {
        return 32u;
    }
    let color = firstTrailingBit(~used);
    if moves.x {
        atomicOr(&body_colors[pair.a].used, 1u << color);
    }
    if moves.y {
        atomicOr(&body_colors[pair.b].used, 1u << color);
    }
    return color;
}

// Lists the pairs by colour, and within a colour in their order: so threads sum in the same order in every run.
fn sort(thread: u32, island: vec2<u32>, colors: u32) {
    let part = (island.y - island.x + THREADS - 1u) / THREADS;
    let start = min(island.x + thread * part, island.y);
    let end = min(start + part, island.y);
    var first = island.x;
    for (var color = 0u; color < colors; color += 1u) {
        var found = 0u;
        for (var q = start; q < end; q += 1u) {
            found += u32(solver_pairs[pair_order[q]].color == color);
        }
        counts[thread].x = found;
        workgroupBarrier();
        var at = first;
        for (var other = 0u; other < THREADS; other += 1u) {
            let count = counts[other].x;
            at += select(0u, count, other < thread);
            first += count;
        }
        workgroupBarrier();
        for (var q = start; q < end && found > 0u; q += 1u) {
            let i = pair_order[q];
            if solver_pairs[i].color == color {
                island_pairs[at].pair = i;
                at += 1u;
                found -= 1u;
            }
        }
        if thread == 0u {
            island_pairs[island.x + color].color_end = first;
        }
    }
    storageBarrier();
}

// The first pair of each body owns it. Each pair has two places for velocities of bodies that it owns.
fn choose_owners(thread: u32, island: vec2<u32>) {
    for (var k = island.x + thread; k < island.y; k += THREADS) {
        set_claims(solver_pairs[island_pairs[k].pair], UNCLAIMED);
    }
    storageBarrier();
    for (var k = island.x + thread; k < island.y; k += THREADS) {
        claim(solver_pairs[island_pairs[k].pair], k);
    }
    storageBarrier();
    for (var k = island.x + thread; k < island.y; k += THREADS) {
        let owns = has_claimed(solver_pairs[island_pairs[k].pair], k);
        island_pairs[k].flags = select(0u, s::OWNS_FIRST, owns.x) | select(0u, s::OWNS_SECOND, owns.y);
    }
    storageBarrier();
    for (var k = island.x + thread; k < island.y; k += THREADS) {
        let pair = solver_pairs[island_pairs[k].pair];
        let moves = has_mass(pair);
        island_pairs[k].places = place_of(island.x, pair.a, moves.x) | (place_of(island.x, pair.b, moves.y) << 16u);
    }
}

fn place_of(first: u32, body: u32, moves: bool) -> u32 {
    if !moves {
        return s::NO_PLACE;
    }
    let owner = atomicLoad(&body_colors[body].claim);
    let side = select(1u, 0u, (island_pairs[owner].flags & s::OWNS_FIRST) != 0u
        && solver_pairs[island_pairs[owner].pair].a == body);
    return 2u * (owner - first) + side;
}
