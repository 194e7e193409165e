// Contact generation: how the bodies of each pair lie to each other. A thread a pair.
#import faceoff::arena::meshes
#import faceoff::constants::manifolds::{DEFAULT_DIRECTION, ASIDE, SAME_PLACE}
#import faceoff::dispatch::group_index
#import faceoff::math::{compose, conjugate, largest, matrix, rotate}
#import faceoff::types as t

@group(0) @binding(2) var<uniform> limits: t::ContactLimits;
@group(0) @binding(3) var<storage, read> contact_counters: array<u32>;
@group(0) @binding(4) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(5) var<storage, read> margin_pairs: array<t::MarginPair>;
@group(0) @binding(6) var<storage, read_write> settings: array<t::ContactSetting>;

// How wrong a height over a plane can be, in units of the bounding radii together: some 12 roundings of 2^-23.
const ROUNDING_SINGLE: f32 = 1.5e-6;
// What overlaps by less, in units of the smaller body's size, touches: rounding must not part bodies that rest on each
// other.
const TOUCH_SINGLE: f32 = 1.0e-5;
// Nothing is farther than this, in the pair's unit.
const WIDEST: f32 = 1.0e6;
// The bits of infinity.
const INFINITE: u32 = 0x7f800000u;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= contact_counters[t::MARGIN_PAIRS] {
        return;
    }
    settings[i] = setting(margin_pairs[i]);
}

fn setting(pair: t::MarginPair) -> t::ContactSetting {
    var result: t::ContactSetting;
    result.a = pair.a;
    result.b = pair.b;
    result.valid = 0u;
    if pair.still != 0u || pair.a == pair.b || max(pair.a, pair.b) >= limits.bodies {
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
    let turn = compose(back, b.rotation);
    let turning = matrix(turn / sqrt(dot(turn, turn)));
    result.x = turning[0];
    result.y = turning[1];
    result.z = turning[2];
    // The difference of two positions is rounded once, however far away they are.
    let arm_a = rotate(a.rotation, a.scale * meshes[a.mesh].center);
    let arm_b = rotate(b.rotation, b.scale * meshes[b.mesh].center);
    var between = (b.position - a.position) + (arm_b - arm_a);
    if same_place(a, b, between) {
        between += DEFAULT_DIRECTION * (ASIDE * min(a.radius, b.radius));
    }
    let apart = rotate(back, between * result.unit);
    if b.radius < a.radius {
        result.offset_a = apart;
    } else {
        result.offset_b = -(apart * turning);
    }
    result.mesh_a = a.mesh;
    result.mesh_b = b.mesh;
    result.scale_a = a.scale * result.unit;
    result.scale_b = b.scale * result.unit;
    result.size = 2.0 * min(
        largest(meshes[a.mesh].box_half * abs(result.scale_a)), largest(meshes[b.mesh].box_half * abs(result.scale_b))
    );
    // Not a number is no margin. By bits, which are in the order of positive numbers: devices may take it that all are
    // numbers.
    let bits = bitcast<u32>(pair.margin);
    if bits <= INFINITE {
        result.margin = bitcast<f32>(min(bits, bitcast<u32>(WIDEST / result.unit))) * result.unit;
    }
    result.rounding = ROUNDING_SINGLE * (a.radius + b.radius) * result.unit;
    result.touch = max(TOUCH_SINGLE * result.size, 4.0 * result.rounding);
    return result;
}

// Whether two bodies are the same in the same place; `aside` in `src/manifolds/cpu/side.rs` explains it.
fn same_place(a: t::Body, b: t::Body, between: vec3<f32>) -> bool {
    let most = SAME_PLACE * min(a.radius, b.radius);
    // Single precision tells rotations apart by 3e-3 radians, where the CPU asks for 1e-4.
    let turned = 1.0 - abs(dot(a.rotation, b.rotation));
    return a.mesh == b.mesh && all(a.scale == b.scale) && dot(between, between) < most * most && turned < 1.0e-6;
}

// The power of two that brings a size between 1 and 2.
fn unit_of(size: f32) -> f32 {
    let exponent = clamp((bitcast<u32>(size) >> 23u) & 255u, 1u, 253u);
    return bitcast<f32>((254u - exponent) << 23u);
}
