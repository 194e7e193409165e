// Contact generation: the relative pose of each pair of a batch. One thread per pair.
#import faceoff::arena::meshes
#import faceoff::batches::active_pair_of
#import faceoff::constants::manifolds::{NUDGE, SAME_PLACE}
#import faceoff::constants::shared::DEFAULT_DIRECTION
#import faceoff::dispatch::group_index
#import faceoff::math::{compose, conjugate, max_component, matrix, rotate, unit_of}
#import faceoff::types as t

@group(0) @binding(2) var<uniform> limits: t::ContactLimits;
@group(0) @binding(3) var<storage, read> contact_counters: array<u32>;
@group(0) @binding(4) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(5) var<storage, read> margin_pairs: array<t::MarginPair>;
@group(0) @binding(6) var<storage, read_write> pair_setups: array<t::PairSetup>;
// x: number of the batch. y: number of batches.
@group(0) @binding(7) var<uniform> constants: vec4<u32>;
@group(0) @binding(8) var<storage, read> active_pairs: array<u32>;

// Error bound of a height over a plane, in units of the sum of the bounding radii: about 12 roundings of 2^-23.
const ROUNDING_SINGLE: f32 = 1.5e-6;
// A smaller overlap, in units of the smaller body's size, counts as touching, so that rounding does not drop contacts
// of resting bodies.
const TOUCH_SINGLE: f32 = 1.0e-5;
// Upper bound of distances, in the pair's unit.
const WIDEST: f32 = 1.0e6;
// The bits of infinity.
const INFINITE: u32 = 0x7f800000u;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= contact_counters[t::BATCH_PAIRS] {
        return;
    }
    pair_setups[i] = pair_setup(margin_pairs[active_pairs[active_pair_of(i, constants.xy)]]);
}

fn pair_setup(pair: t::MarginPair) -> t::PairSetup {
    var result: t::PairSetup;
    result.a = pair.a;
    result.b = pair.b;
    result.valid = 0u;
    if pair.a == pair.b || max(pair.a, pair.b) >= limits.bodies {
        return result;
    }
    let a = bodies[pair.a];
    let b = bodies[pair.b];
    if !(a.radius > 0.0 && b.radius > 0.0) || max(a.mesh, b.mesh) >= arrayLength(&meshes) {
        return result;
    }
    result.valid = 1u;
    result.unit = unit_of(a.radius + b.radius);
    result.rotation = a.rotation;
    let back = conjugate(a.rotation);
    let rotation = compose(back, b.rotation);
    let b_to_a = matrix(rotation / sqrt(dot(rotation, rotation)));
    result.x = b_to_a[0];
    result.y = b_to_a[1];
    result.z = b_to_a[2];
    // The difference of two positions is rounded once, however far they are from the origin.
    let anchor_a = rotate(a.rotation, a.scale * meshes[a.mesh].center);
    let anchor_b = rotate(b.rotation, b.scale * meshes[b.mesh].center);
    var world_offset = (b.position - a.position) + (anchor_b - anchor_a);
    if same_place(a, b, world_offset) {
        world_offset += DEFAULT_DIRECTION * (NUDGE * min(a.radius, b.radius));
    }
    let center_offset = rotate(back, world_offset * result.unit);
    if b.radius < a.radius {
        result.offset_a = center_offset;
    } else {
        result.offset_b = -(center_offset * b_to_a);
    }
    result.spin = rotate(back, b.angular_velocity - a.angular_velocity);
    result.mesh_a = a.mesh;
    result.mesh_b = b.mesh;
    result.scale_a = a.scale * result.unit;
    result.scale_b = b.scale * result.unit;
    result.rounded_a = a.rounding * result.unit;
    result.rounded_b = b.rounding * result.unit;
    result.size = 2.0 * min(
        max_component(meshes[a.mesh].box_half * abs(result.scale_a)) + result.rounded_a,
        max_component(meshes[b.mesh].box_half * abs(result.scale_b)) + result.rounded_b
    );
    // NaN counts as no margin. Compared by bits, which are in the order of positive numbers, because compilers may
    // assume that NaN does not occur.
    let bits = bitcast<u32>(pair.margin);
    if bits <= INFINITE {
        result.margin = bitcast<f32>(min(bits, bitcast<u32>(WIDEST / result.unit))) * result.unit;
    }
    result.margin += result.rounded_a + result.rounded_b;
    result.rounding = ROUNDING_SINGLE * (a.radius + b.radius) * result.unit;
    result.touch = max(TOUCH_SINGLE * result.size, 4.0 * result.rounding);
    return result;
}

// Whether two bodies of equal meshes coincide. The twin of `nudge` in `src/manifolds/cpu/side.rs`.
fn same_place(a: t::Body, b: t::Body, world_offset: vec3<f32>) -> bool {
    let max_distance = SAME_PLACE * min(a.radius, b.radius);
    // Single precision resolves rotations to 3e-3 radians only; the CPU requires 1e-4.
    let rotation_difference = 1.0 - abs(dot(a.rotation, b.rotation));
    let near = dot(world_offset, world_offset) < max_distance * max_distance;
    let equal = meshes[a.mesh].fingerprint_low == meshes[b.mesh].fingerprint_low
        && meshes[a.mesh].fingerprint_high == meshes[b.mesh].fingerprint_high;
    return equal && all(a.scale == b.scale) && near && rotation_difference < 1.0e-6;
}
