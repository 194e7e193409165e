// Solver: a collision substep of one island: its substeps, and the passes of each. The twin of `src/solver/substep.rs`.
// One workgroup per island.
//
// A pass visits the pairs by colour: pairs of one colour at once, one thread each. Conditions of loops with barriers
// are the same for all threads.
//
// Between colours only the velocities of bodies go from thread to thread: the same thread visits the points of a pair
// in each pass. A small island keeps these velocities in workgroup memory. On a real GPU a barrier for storage buffers
// drops their cached data, and the next colour would then wait for memory at each point.
#import faceoff::constants::solver::{FEW_PASSES, PASS_BUDGET, RESTITUTION_TOLERANCE, SUBSTEP_BUDGET}
#import faceoff::contact as c
#import faceoff::contact::{body_states, collision_substep, point_states, solver_pairs}
#import faceoff::dispatch::group_index
#import faceoff::load::{compression, substep_factor}
#import faceoff::motion as m
#import faceoff::paces::{pace_of, paces}
#import faceoff::points::{begin_substep, update_points}
#import faceoff::restitution::{end_impacts, find_impacts}
#import faceoff::solve as v
#import faceoff::solver_math::finite_vector
#import faceoff::solver_types as s

@group(0) @binding(5) var<storage, read> solver_counters: array<u32>;
@group(0) @binding(6) var<storage, read> body_constants: array<s::BodyConstants>;
@group(0) @binding(7) var<storage, read> island_ranges: array<s::IslandRange>;
@group(0) @binding(8) var<storage, read> island_pairs: array<s::IslandPair>;

#ifdef LARGE
const THREADS: u32 = 64u;
#else
const THREADS: u32 = 8u;
// By place.
var<workgroup> velocities: array<s::Velocity, 2u * s::SMALL_ISLAND_PAIRS>;
// By number within the island: the pairs, and the ends of the colours.
var<workgroup> pass_pairs: array<v::PassPair, s::SMALL_ISLAND_PAIRS>;
var<workgroup> color_ends: array<u32, s::SMALL_ISLAND_PAIRS>;
#endif

var<workgroup> range: s::IslandRange;
var<workgroup> parts: array<vec2<f32>, THREADS>;
var<workgroup> result: vec2<f32>;

// What all threads know of their island.
struct SolvedIsland {
    range: s::IslandRange,
    pace: s::Pace,
    // Number of points.
    points: u32,
}

@compute @workgroup_size(THREADS)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let number = group_index(group);
    if thread == 0u {
        range = s::IslandRange(0u, 0u, 0u, 0u);
#ifdef LARGE
        if number < solver_counters[s::LARGE_ISLANDS] {
            range = island_ranges[arrayLength(&island_ranges) - 1u - number];
        }
#else
        if number < solver_counters[s::SMALL_ISLANDS] {
            range = island_ranges[number];
        }
#endif
    }
    var island: SolvedIsland;
    island.range = workgroupUniformLoad(&range);
    if island.range.first == island.range.end {
        return;
    }
#ifndef LARGE
    for (var color = thread; color < island.range.colors; color += THREADS) {
        color_ends[color] = island_pairs[island.range.first + color].color_end;
    }
    workgroupBarrier();
#endif
    island.pace = paces[longest_pace(thread, island.range)];
    // The zeroth substep only updates the points.
    var factor = 1u;
    var last = 0u;
    for (var number = 0u; number <= last; number += 1u) {
        substep(thread, island, number, factor);
        let all = reduced(thread, measure(thread, island, number == 0u));
        if number == 0u {
            island.points = max(u32(all.y), 1u);
            factor = substep_factor(all.x, island.points);
            last = factor * island.pace.substeps;
            scale_impulses(thread, island, 1.0 / f32(factor));
        }
    }
    // The saved impulses belong to a substep of the common length.
    scale_impulses(thread, island, f32(factor));
}

// The smallest pace number of all pairs, which is the pace with the longest collision substep.
fn longest_pace(thread: u32, range: s::IslandRange) -> u32 {
    var least = 0xffffu;
    for (var k = range.first + thread; k < range.end; k += THREADS) {
        least = min(least, solver_pairs[island_pairs[k].pair].pace);
    }
    return 0xffffu - u32(reduced(thread, vec2(f32(0xffffu - least), 0.0)).x);
}

// The largest compression of the pairs of a thread and their number of points, if `needed`. Sums of floats are exact up
// to 2^24 points.
fn measure(thread: u32, island: SolvedIsland, needed: bool) -> vec2<f32> {
    var own = vec2(0.0);
    for (var k = island.range.first + thread; needed && k < island.range.end; k += THREADS) {
        let pair = solver_pairs[island_pairs[k].pair];
        own = vec2(max(own.x, compression(pair, island.pace)), own.y + f32(pair.count));
    }
    return own;
}

// The maximum of the first component over all threads, and the sum of the second, in the order of threads.
fn reduced(thread: u32, part: vec2<f32>) -> vec2<f32> {
    parts[thread] = part;
    workgroupBarrier();
    if thread == 0u {
        var all = vec2(0.0);
        for (var other = 0u; other < THREADS; other += 1u) {
            all = vec2(max(all.x, parts[other].x), all.y + parts[other].y);
        }
        result = all;
    }
    return workgroupUniformLoad(&result);
}

// The pairs of a colour, as a range.
fn pairs_of(island: SolvedIsland, color: u32) -> vec2<u32> {
#ifdef LARGE
    let end = island_pairs[island.range.first + color].color_end;
    if color == 0u {
        return vec2(island.range.first, end);
    }
    return vec2(island_pairs[island.range.first + color - 1u].color_end, end);
#else
    if color == 0u {
        return vec2(island.range.first, color_ends[0]);
    }
    return vec2(color_ends[color - 1u], color_ends[color]);
#endif
}

// A pair of an island, for passes with these parameters.
fn pass_pair(island: SolvedIsland, k: u32, parameters: v::Pass) -> v::PassPair {
#ifdef LARGE
    return v::pass_pair(solver_pairs[island_pairs[k].pair], 0u, parameters);
#else
    return pass_pairs[k - island.range.first];
#endif
}

// What follows a colour sees the velocities that it has left.
fn end_color() {
#ifdef LARGE
    storageBarrier();
#else
    workgroupBarrier();
#endif
}

// The velocities of a pair's bodies. `places` comes from its `IslandPair`.
fn velocities_of(a: u32, b: u32, places: u32) -> c::PairVelocities {
    var result = c::velocities_of(a, b);
#ifndef LARGE
    if (places & 0xffffu) != s::NO_PLACE {
        result.a = velocities[places & 0xffffu];
    }
    if (places >> 16u) != s::NO_PLACE {
        result.b = velocities[places >> 16u];
    }
#endif
    return result;
}

// Stores the velocities of the bodies that impulses move: others may belong to several islands. Numbers that are not
// finite are dropped.
fn store_velocities(a: u32, b: u32, places: u32, flags: u32, pair_velocities: c::PairVelocities) {
    let of_a = pair_velocities.a;
    if (flags & s::FIRST_HAS_MASS) != 0u && finite_vector(of_a.linear) && finite_vector(of_a.angular) {
#ifdef LARGE
        body_states[a].velocity = of_a;
#else
        velocities[places & 0xffffu] = of_a;
#endif
    }
    let of_b = pair_velocities.b;
    if (flags & s::SECOND_HAS_MASS) != 0u && finite_vector(of_b.linear) && finite_vector(of_b.angular) {
#ifdef LARGE
        body_states[b].velocity = of_b;
#else
        velocities[places >> 16u] = of_b;
#endif
    }
}

#ifndef LARGE
// Moves the velocities of the bodies that a pair owns to workgroup memory, or back.
fn move_velocities(k: u32, back: bool) {
    let pair = solver_pairs[island_pairs[k].pair];
    for (var side = 0u; side < 2u; side += 1u) {
        if (island_pairs[k].flags & (s::OWNS_FIRST << side)) == 0u {
            continue;
        }
        let body = select(pair.a, pair.b, side == 1u);
        let place = (island_pairs[k].places >> (16u * side)) & 0xffffu;
        if back {
            body_states[body].velocity = velocities[place];
        } else {
            velocities[place] = body_states[body].velocity;
        }
    }
}
#endif

// Multiplies the impulses, for substeps of another length. The totals of the collision substep stay.
fn scale_impulses(thread: u32, island: SolvedIsland, factor: f32) {
    for (var k = island.range.first + thread; k < island.range.end; k += THREADS) {
        let pair = solver_pairs[island_pairs[k].pair];
        for (var point = pair.first; point < pair.first + pair.count; point += 1u) {
            let before = point_states[point].normal_impulse;
            let impulse = factor * before;
            point_states[point].total_normal_impulse += before - impulse;
            point_states[point].normal_impulse = impulse;
            point_states[point].friction_impulse *= factor;
        }
    }
}

// One substep of an island with this factor on their number. Each part stands here once, in a loop over what passes are
// for: compilers put all functions in place.
fn substep(thread: u32, island: SolvedIsland, number: u32, factor: u32) {
    let range = island.range;
    let h = island.pace.h / f32(factor);
    let is_first = number == 0u;
    let last = select(v::RESTITUTION, v::RELAX, is_first);
    for (var purpose = select(v::BIAS, v::RELAX, is_first); purpose <= last; purpose += 1u) {
        for (var k = range.first + thread; k < range.end; k += THREADS) {
            if !is_first && purpose != v::RESTITUTION {
                integrate_bodies(k, purpose, h, island.pace.dt);
            }
        }
        storageBarrier();
        var fastest = 0.0;
        for (var k = range.first + thread; k < range.end; k += THREADS) {
            let i = island_pairs[k].pair;
            if purpose == v::BIAS {
                begin_substep(i, h);
            } else if purpose == v::RESTITUTION {
                fastest = max(fastest, find_impacts(solver_pairs[i]));
            }
        }
#ifndef LARGE
        for (var k = range.first + thread; k < range.end; k += THREADS) {
            move_velocities(k, false);
        }
#endif
        storageBarrier();
        let fastest_of_all = reduced(thread, vec2(fastest, 0.0)).x;
        for (var color = 0u; color < select(range.colors, 0u, purpose == v::RESTITUTION); color += 1u) {
            let pairs = pairs_of(island, color);
            for (var k = pairs.x + thread; k < pairs.y; k += THREADS) {
                move_impulses(k, purpose, f32(number) * h);
            }
            end_color();
        }
        let has_few_passes = min(collision_substep.max_iterations, PASS_BUDGET / max(island.points, 1u)) < FEW_PASSES;
        let rate = select(island.pace.bias_rate, island.pace.few_bias_rate, has_few_passes);
        var parameters = v::Pass(
            h,
            // The rate of the spring is proportional to the rate of substeps.
            rate * (island.pace.h / h),
            select(island.pace.mass_scale, island.pace.few_mass_scale, has_few_passes),
            select(island.pace.impulse_scale, island.pace.few_impulse_scale, has_few_passes),
            purpose,
            collision_substep.convergence_speed,
        );
        var least = collision_substep.bias_iterations;
        if purpose == v::RELAX {
            least = collision_substep.relax_iterations;
        } else if purpose == v::RESTITUTION {
            least = collision_substep.restitution_iterations;
            parameters.convergence_speed = RESTITUTION_TOLERANCE * fastest_of_all;
        }
        let budget = min(PASS_BUDGET, SUBSTEP_BUDGET / factor);
        var most = max(min(collision_substep.max_iterations, budget / max(island.points, 1u)), least);
        most = select(most, 0u, is_first || (purpose == v::RESTITUTION && fastest_of_all == 0.0));
        storageBarrier();
        for (var k = range.first + thread; most > 0u && k < range.end; k += THREADS) {
            let pair = solver_pairs[island_pairs[k].pair];
            v::aim(pair, parameters);
#ifndef LARGE
            pass_pairs[k - range.first] = v::pass_pair(pair, island_pairs[k].places, parameters);
#endif
        }
        storageBarrier();
#ifndef LARGE
        // For `pass_pairs`, which other threads read.
        workgroupBarrier();
#endif
        solve(thread, island, parameters, least, most);
#ifndef LARGE
        for (var k = range.first + thread; k < range.end; k += THREADS) {
            move_velocities(k, true);
        }
#endif
        storageBarrier();
    }
    for (var k = range.first + thread; k < range.end; k += THREADS) {
        end_impacts(solver_pairs[island_pairs[k].pair]);
    }
    storageBarrier();
}

// Integrates the velocities of the bodies that a pair owns, or their poses. `h` is the length of a substep of the
// island, and `dt` the length of its collision substep. A body with another length moves in as many substeps.
fn integrate_bodies(k: u32, purpose: u32, h: f32, dt: f32) {
    let pair = solver_pairs[island_pairs[k].pair];
    for (var side = 0u; side < 2u; side += 1u) {
        if (island_pairs[k].flags & (s::OWNS_FIRST << side)) == 0u {
            continue;
        }
        let i = select(pair.a, pair.b, side == 1u);
        var state = body_states[i];
        let constants = body_constants[i];
        let own_h = h * (pace_of(constants.flags).dt / dt);
        if purpose == v::BIAS {
            // Bodies in no island move freely; see `finish.wgsl`.
            state.mass.flags |= s::SOLVED;
            state.velocity = m::with_integrated_velocity(state.velocity, state.mass, constants, own_h);
            state.initial_velocity = state.velocity;
        } else {
            m::integrate_pose(constants, &state, own_h);
        }
        body_states[i] = state;
    }
}

// Applies the impulses of the last substep, or updates the points of a pair after its bodies have moved.
//
// An elastic body that meets an immovable one keeps its energy: its impulses move with the points. Between two bodies
// they stay where they acted, which keeps the angular momentum.
fn move_impulses(k: u32, purpose: u32, time: f32) {
    let pair = solver_pairs[island_pairs[k].pair];
    let places = island_pairs[k].places;
    let both = s::FIRST_HAS_MASS | s::SECOND_HAS_MASS;
    let moves = pair.restitution > 0.0 && (pair.flags & both) != both;
    for (var part = select(0u, 1u, purpose == v::BIAS); part < 2u; part += 1u) {
        if moves || purpose == v::BIAS {
            var pair_velocities = velocities_of(pair.a, pair.b, places);
            c::apply_impulses(pair, &pair_velocities, select(-1.0, 1.0, part == 1u));
            store_velocities(pair.a, pair.b, places, pair.flags, pair_velocities);
        }
        if part == 0u {
            update_points(pair, time);
        }
    }
}

// Passes over all pairs, at least `least` and at most `most`, until they have converged. Impulses are extrapolated
// along a search direction, as in the method of conjugate gradients.
fn solve(thread: u32, island: SolvedIsland, parameters: v::Pass, least: u32, most: u32) {
    var last_energy = 0.0;
    for (var iteration = 1u; iteration <= most; iteration += 1u) {
        var own = v::Residual(0.0, 0.0);
        for (var color = 0u; color < island.range.colors; color += 1u) {
            let pairs = pairs_of(island, color);
            for (var k = pairs.x + thread; k < pairs.y; k += THREADS) {
                let pair = pass_pair(island, k, parameters);
                if (pair.flags & s::ACTIVE) != 0u {
                    var pair_velocities = velocities_of(pair.a, pair.b, pair.places);
                    v::solve(pair, &pair_velocities, &own);
                    store_velocities(pair.a, pair.b, pair.places, pair.flags, pair_velocities);
                }
            }
            end_color();
        }
        let residual = reduced(thread, vec2(own.velocity, own.energy));
        if iteration == most || (iteration >= least && residual.x <= 1.0) {
            break;
        }
        // The first direction has no predecessor, and one that leads away is dropped.
        let keep = select(0.0, residual.y / max(last_energy, 1.0e-37), residual.y < last_energy);
        last_energy = residual.y;
        for (var color = 0u; color < island.range.colors; color += 1u) {
            let pairs = pairs_of(island, color);
            for (var k = pairs.x + thread; k < pairs.y; k += THREADS) {
                let pair = pass_pair(island, k, parameters);
                if (pair.flags & s::ACTIVE) == 0u {
                    continue;
                }
                if keep == 0.0 {
                    v::start_search(pair);
                    continue;
                }
                var pair_velocities = velocities_of(pair.a, pair.b, pair.places);
                v::extrapolate(pair, &pair_velocities, keep);
                store_velocities(pair.a, pair.b, pair.places, pair.flags, pair_velocities);
            }
            end_color();
        }
    }
}
