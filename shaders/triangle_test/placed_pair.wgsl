#define_import_path faceoff::placed_pair

// A pair of bodies in the axes of the first, relative to its centre of mass. Lengths are in the pair's unit. Other data
// of bodies and meshes is read at each use: copies would take too many registers.

#import faceoff::arena::{meshes, vector}
#import faceoff::math::{absolute, rotate, unit_of}
#import faceoff::tree
#import faceoff::types as t

@group(0) @binding(4) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(5) var<storage, read> near_pairs: array<t::NearPair>;

struct Pair {
    index: u32,
    a: u32,
    b: u32,
    // From b's axes to a's.
    rotation: mat3x3<f32>,
    translation: vec3<f32>,
    unit: f32,
    scale_a: vec3<f32>,
    scale_b: vec3<f32>,
    // Error bound of each placed coordinate.
    error: f32,
    mesh_a: u32,
    mesh_b: u32,
}

// The pair of this number.
fn placed(index: u32) -> Pair {
    let near = near_pairs[index];
    let a = bodies[near.a];
    let b = bodies[near.b];
    var pair: Pair;
    pair.index = index;
    pair.a = near.a;
    pair.b = near.b;
    pair.rotation = mat3x3(near.x, near.y, near.z);
    pair.translation = near.translation;
    pair.unit = unit_of(a.radius + b.radius);
    pair.scale_a = pair.unit * a.scale;
    pair.scale_b = pair.unit * b.scale;
    pair.error = near.error;
    pair.mesh_a = a.mesh;
    pair.mesh_b = b.mesh;
    return pair;
}

// How far apart cores are whose rounded surfaces touch; 0 without rounding.
fn rounding_of(pair: Pair) -> f32 {
    return pair.unit * (bodies[pair.a].rounding + bodies[pair.b].rounding);
}

// Whether a rounded pair has contact points in a step with a contact solver. They tell whether it touches.
fn has_contact_points(step: t::Step, pair: Pair) -> bool {
    let solid = ((bodies[pair.a].flags | bodies[pair.b].flags) & t::SENSOR) == 0u;
    let has_mass = bodies[pair.a].inverse_mass > 0.0 || bodies[pair.b].inverse_mass > 0.0;
    return step.substeps > 0u && solid && has_mass && rounding_of(pair) > 0.0;
}

fn slack_of(pair: Pair) -> f32 {
    return 2.0 * pair.error;
}

// To the world.
fn to_world(pair: Pair, p: vec3<f32>) -> vec3<f32> {
    let a = bodies[pair.a];
    return a.position + rotate(a.rotation, a.scale * meshes[pair.mesh_a].center + p / pair.unit);
}

fn placed_a(pair: Pair, at: u32) -> vec3<f32> {
    return pair.scale_a * vector(at);
}

fn placed_b(pair: Pair, at: u32) -> vec3<f32> {
    return pair.rotation * (pair.scale_b * vector(at)) + pair.translation;
}

// Whether both nodes exist, reach beyond the other body's bound along the support axis and into its sphere, and their
// boxes overlap along the axes of both.
fn boxes_meet(pair: Pair, node_a: u32, node_b: u32) -> bool {
    let at_a = tree::box_of(0u, node_a);
    let at_b = tree::box_of(1u, node_b);
    if at_a == 0u || at_b == 0u {
        return false;
    }
    let pad = slack_of(pair);
    let spread = absolute(pair.rotation);
    let center_a = placed_a(pair, at_a);
    let half_a = abs(pair.scale_a) * vector(at_a + 3u);
    let half_b = abs(pair.scale_b) * vector(at_b + 3u);
    let center_b = placed_b(pair, at_b);
    let around_b = spread * half_b;
    if any(abs(center_b - center_a) > half_a + around_b + pad) {
        return false;
    }
    if dot(center_a, near_pairs[pair.index].axis) + dot(half_a, abs(near_pairs[pair.index].axis)) < near_pairs[pair.index].b_above - pad {
        return false;
    }
    if dot(center_b, near_pairs[pair.index].axis) - dot(around_b, abs(near_pairs[pair.index].axis)) > near_pairs[pair.index].a_below + pad {
        return false;
    }
    let past_a = max(abs(center_a - pair.translation) - half_a, vec3(0.0));
    let past_b = max(abs(center_b) - around_b, vec3(0.0));
    let reach_a = pair.unit * bodies[pair.a].radius + pad;
    let reach_b = pair.unit * bodies[pair.b].radius + pad;
    if dot(past_a, past_a) > reach_b * reach_b || dot(past_b, past_b) > reach_a * reach_a {
        return false;
    }
    let apart = (center_a - center_b) * pair.rotation;
    return all(abs(apart) <= half_b + half_a * spread + pad);
}
