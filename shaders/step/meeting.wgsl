#define_import_path faceoff::meeting

// What can meet in the group of a body.

#import faceoff::math::ascending
#import faceoff::types as t

@group(0) @binding(9) var<storage, read_write> meetings: array<t::Meeting>;

fn add_velocity(root: u32, velocity: vec3<f32>, spin: f32) {
    for (var axis = 0u; axis < 3u; axis += 1u) {
        atomicMax(&meetings[root].highest[axis], ascending(velocity[axis]));
        atomicMax(&meetings[root].highest_negated[axis], ascending(-velocity[axis]));
    }
    // Speeds and lengths are not negative, so that their bits are in the order of the numbers.
    atomicMax(&meetings[root].spin, bitcast<u32>(abs(spin)));
}

fn add_thickness(root: u32, thickness: f32) {
    atomicMin(&meetings[root].thinnest, bitcast<u32>(abs(thickness)));
}

fn set_exists(root: u32) {
    atomicStore(&meetings[root].exists, 1u);
}
