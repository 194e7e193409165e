// Begin of a step that may need several collision substeps: the groups in which bodies can meet each other, or
// something static, and how fast they turn there. One thread per pair.
#import faceoff::arena::{meshes, words, vector}
#import faceoff::arm::arm_within
#import faceoff::constants::shared::TREE_LEVELS
#import faceoff::dispatch::{divide_up, group_index}
#import faceoff::math::{conjugate, rotate}
#import faceoff::meeting::{add_spin, add_thickness, add_velocity, meetings, set_exists}
#import faceoff::sweep::{is_solid, moves}
#import faceoff::types as t
#import faceoff::union_find::root_of

@group(0) @binding(2) var<storage, read> counters: array<u32>;
@group(0) @binding(3) var<storage, read> sphere_pairs: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> sweeps: array<t::Sweep>;
@group(0) @binding(5) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(6) var<uniform> step: t::Step;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= counters[t::PAIRS] {
        return;
    }
    let pair = sphere_pairs[i];
    let first_moves = moves(sweeps[pair.x]);
    let mover = select(pair.y, pair.x, first_moves);
    let other = select(pair.x, pair.y, first_moves);
    let a = sweeps[mover];
    let b = sweeps[other];
    if !is_solid(a) || !is_solid(b) {
        return;
    }
    let root = root_of(mover);
    let body = bodies[mover];
    let neighbour = bodies[other];
    if !moves(b) {
        if !meets_mesh(a, neighbour) {
            return;
        }
        add_thickness(root, neighbour.thickness);
        add_velocity(root, vec3(0.0));
    }
    set_exists(root);
    add_spin_near(root, a.spin, body, neighbour);
    add_spin_near(root, b.spin, neighbour, body);
}

// Adds the speed at which the surface of a body moves relative to its centre of mass where `other` may touch it within
// the step. No part of the surface is faster than `most`. The twin of `spin_near` in `src/step/reach.rs`.
fn add_spin_near(root: u32, most: f32, body: t::Body, other: t::Body) {
    // Another surface of the group moves as fast.
    if most <= bitcast<f32>(atomicLoad(&meetings[root].spin)) {
        return;
    }
    var spin = most;
    // The axis of a body of several colliders does not pass through their centres.
    if body.center_offset == 0.0 {
        let w = body.angular_velocity;
        spin -= sqrt(dot(w, w)) * (body.radius - arm_within(step, body, other, step.dt));
    }
    add_spin(root, spin);
}

// Whether the bounding box of a sweep, in the axes of a static body, overlaps the box of a cluster of the body's
// triangles. Most of a level's bounding sphere is empty.
fn meets_mesh(sweep: t::Sweep, body: t::Body) -> bool {
    let mesh = meshes[body.mesh];
    let to_local = conjugate(body.rotation);
    let half_travel = 0.5 * rotate(to_local, sweep.travel);
    let offset = (sweep.center - body.position) - rotate(body.rotation, body.scale * mesh.center);
    let center = rotate(to_local, offset) + half_travel;
    // The second term is the rounding of both centres.
    let place = max(abs(body.position), abs(offset));
    let half_size = abs(half_travel) + sweep.radius + body.rounding + 1.0e-6 * max(place.x, max(place.y, place.z));

    // Node `number` of a level has the children from 8 * `number` on, one level below.
    var first: array<u32, TREE_LEVELS>;
    var count: array<u32, TREE_LEVELS>;
    var at = mesh.boxes;
    var nodes = divide_up(mesh.triangle_count, 8u);
    var top = 0u;
    for (var level = 0u; level < TREE_LEVELS; level += 1u) {
        first[level] = at;
        count[level] = nodes;
        at += 6u * nodes;
        if nodes > 1u {
            top = min(level + 1u, TREE_LEVELS - 1u);
        }
        nodes = divide_up(nodes, 8u);
    }
    top = min(top, mesh.levels - 1u);
    var level = top;
    var number = 0u;
    while number < count[level] {
        let box = first[level] + 6u * number;
        let apart = abs(vector(box) * body.scale - center);
        let overlap = all(apart <= vector(box + 3u) * abs(body.scale) + half_size);
        if overlap && level == 0u {
            return true;
        }
        if overlap {
            level -= 1u;
            number *= 8u;
            continue;
        }
        number += 1u;
        // After the last child comes what follows the parent.
        while level < top && (number % 8u == 0u || number == count[level]) {
            number = divide_up(number, 8u);
            level += 1u;
        }
    }
    return false;
}
