// Angles: the relative pose of each pair, the support-axis cull, and which triangles are visible. One thread per pair.
#import faceoff::arena::{meshes, words, support}
#import faceoff::constants::angles::AXES
#import faceoff::dispatch::group_index
#import faceoff::math::{angle_of, compose, conjugate, direction, matrix, norm1, rotate, unit_of}
#import faceoff::pair_margin::speculative_margin
#import faceoff::types as t

@group(0) @binding(2) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(4) var<storage, read> sphere_pairs: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read_write> near_pairs: array<t::NearPair>;
@group(0) @binding(6) var<uniform> step: t::Step;

// Error of a placed coordinate in the pair's unit: about 40 roundings of 2^-24. Relative poses are products of two
// rotations, each rounded.
const PLACING_ERROR: f32 = 2.5e-6;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= atomicLoad(&counters[t::PAIRS]) {
        return;
    }
    let pair = near(sphere_pairs[i]);
    near_pairs[i] = pair;
    if pair.near != t::FAR && (pair.view_a != t::VIEW_ALL || pair.view_b != t::VIEW_ALL) {
        atomicAdd(&counters[t::APPROXIMATE], 1u);
    }
}

fn near(bodies_of_pair: vec2<u32>) -> t::NearPair {
    let a = bodies[bodies_of_pair.x];
    let b = bodies[bodies_of_pair.y];
    let margin = speculative_margin(step, a, b);
    if (a.inactive & b.inactive & t::COMPLETED) != 0u {
        // Both bodies have completed their step, or one has and the other is static: the pair keeps its contact points.
        var kept: t::NearPair;
        kept.a = bodies_of_pair.x;
        kept.b = bodies_of_pair.y;
        kept.near = t::NEAR;
        kept.view_a = t::VIEW_ALL;
        kept.view_b = t::VIEW_ALL;
        kept.margin = margin;
        return kept;
    }
    let mesh_a = meshes[a.mesh];
    let mesh_b = meshes[b.mesh];
    let unit = unit_of(a.radius + b.radius);
    let scale_a = unit * a.scale;
    let scale_b = unit * b.scale;

    let back = conjugate(a.rotation);
    let rotation = matrix(compose(back, b.rotation));
    // The difference of two positions is rounded once, however far they are from the origin.
    let anchor_a = rotate(a.rotation, a.scale * mesh_a.center);
    let anchor_b = rotate(b.rotation, b.scale * mesh_b.center);
    let apart = rotate(back, ((b.position - a.position) + (anchor_b - anchor_a)) * unit);
    let error = PLACING_ERROR + 1.0e-6 * unit * (norm1(anchor_a) + norm1(anchor_b));
    let pad = 2.0 * error;

    var best: t::NearPair;
    best.a = bodies_of_pair.x;
    best.b = bodies_of_pair.y;
    best.near = t::OVERLAPPING;
    best.margin = margin;
    best.x = rotation[0];
    best.y = rotation[1];
    best.z = rotation[2];
    best.translation = apart;
    best.error = error;
    best.axis = vec3(0.0);
    best.a_below = 3.0e38;
    best.b_above = -3.0e38;
    best.view_a = t::VIEW_ALL;
    best.view_b = t::VIEW_ALL;

    var best_overlap = 3.0e38;
    // Gilbert's iteration: the point of the Minkowski difference of a and b that is nearest to the origin so far; at
    // first the difference of the centres.
    var nearest = -apart;
    for (var k = 0u; k < AXES; k += 1u) {
        let distance = sqrt(dot(nearest, nearest));
        if distance <= pad {
            break;
        }
        let u = -nearest / distance;
        let pa = scale_a * support(mesh_a.heights, scale_a * u);
        let pb = apart + rotation * (scale_b * support(mesh_b.heights, scale_b * ((-u) * rotation)));
        let a_below = dot(pa, u) + unit * a.rounding;
        let b_above = dot(pb, u) - unit * b.rounding;
        let overlap = a_below - b_above;
        if overlap < -2.0 * pad {
            best.near = t::NEAR;
            if overlap < -2.0 * pad - unit * margin {
                best.near = t::FAR;
                return best;
            }
        }
        if overlap < best_overlap {
            best_overlap = overlap;
            best.axis = u;
            best.a_below = a_below + pad;
            best.b_above = b_above - pad;
        }
        let to = (pa - pb) - nearest;
        let square = dot(to, to);
        let along = -dot(nearest, to);
        // This axis gives no nearer point.
        if !(square > 0.0 && along > 0.0) {
            break;
        }
        nearest += to * min(along / square, 1.0);
    }

    // Within the distance `pad` rounding determines the direction between the centres.
    if dot(apart, apart) > pad * pad {
        let local = apart * rotation;
        best.view_a = view(a, mesh_a, apart, true);
        best.view_b = view(b, mesh_b, -local, false);
    }
    return best;
}

// The visible triangles of a body. `to_other` points to the other body, in the body's axes. `first`: it is the first of
// the pair.
fn view(body: t::Body, mesh: t::Mesh, to_other: vec3<f32>, first: bool) -> u32 {
    let culling = body.flags & t::CULLING_MASK;
    let orientation = mesh.flags & t::ORIENTATION_MASK;
    if culling == t::CULLING_FACES && mesh.direction_steps != 0u {
        return t::VIEW_GROUP + words[mesh.directions + direction_index(mesh.direction_steps, to_other / body.scale)];
    }
    // A body inside a room sees every wall.
    if culling == t::CULLING_FRONT && orientation == t::OUTWARD {
        // Mirroring reverses the winding.
        let mirrored = (body.scale.x < 0.0) != ((body.scale.y < 0.0) != (body.scale.z < 0.0));
        return select(t::VIEW_AGAINST, t::VIEW_ALONG, mirrored != first);
    }
    return t::VIEW_ALL;
}

// The index of the table's direction nearest to `d`. `src/geometry/direction.rs` explains the grid.
fn direction_index(steps: u32, d: vec3<f32>) -> u32 {
    let u = direction(d);
    let turn = i32(steps);
    let per_step = f32(turn) * 0.15915494;
    let a = angle_of(u.y, sqrt(u.x * u.x + u.z * u.z));
    let b = angle_of(-u.x, u.z);
    let row = clamp(i32(round(a * per_step)) + turn / 4, 0, turn / 2);
    let column = (i32(round(b * per_step)) + 2 * turn) % turn;
    if row == 0 {
        return 0u;
    }
    if row == turn / 2 {
        return u32((turn / 2 - 1) * turn + 1);
    }
    return u32(1 + (row - 1) * turn + column);
}
