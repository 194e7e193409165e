#define_import_path faceoff::meeting

// What can meet in the group of a body.

#import faceoff::math::{ascending, descending}
#import faceoff::types as t

@group(0) @binding(9) var<storage, read_write> meetings: array<t::Meeting>;

fn add_velocity(root: u32, velocity: vec3<f32>) {
    for (var axis = 0u; axis < 3u; axis += 1u) {
        atomicMax(&meetings[root].highest[axis], ascending(velocity[axis]));
        atomicMax(&meetings[root].highest_negated[axis], ascending(-velocity[axis]));
    }
}

// Speeds and lengths are not negative, so that their bits are in the order of the numbers.
fn add_spin(root: u32, spin: f32) {
    atomicMax(&meetings[root].spin, bitcast<u32>(abs(spin)));
}

fn add_thickness(root: u32, thickness: f32) {
    atomicMin(&meetings[root].thinnest, bitcast<u32>(abs(thickness)));
}

fn set_exists(root: u32) {
    atomicStore(&meetings[root].exists, 1u);
}

// Adds another group to the group of `root`.
fn add_group(root: u32, other: u32) {
    for (var axis = 0u; axis < 3u; axis += 1u) {
        atomicMax(&meetings[root].highest[axis], atomicLoad(&meetings[other].highest[axis]));
        atomicMax(&meetings[root].highest_negated[axis], atomicLoad(&meetings[other].highest_negated[axis]));
    }
    atomicMax(&meetings[root].spin, atomicLoad(&meetings[other].spin));
    atomicMin(&meetings[root].thinnest, atomicLoad(&meetings[other].thinnest));
    atomicMax(&meetings[root].exists, atomicLoad(&meetings[other].exists));
}

// Upper bound for the relative speed of any two surfaces of a group, m/s. The twin of `Speeds::relative`.
fn relative_speed(root: u32) -> f32 {
    var speed = bitcast<f32>(atomicLoad(&meetings[root].spin));
    if atomicLoad(&meetings[root].highest[0]) != 0u {
        var between: vec3<f32>;
        for (var axis = 0u; axis < 3u; axis += 1u) {
            let highest = descending(atomicLoad(&meetings[root].highest[axis]));
            let lowest = -descending(atomicLoad(&meetings[root].highest_negated[axis]));
            between[axis] = highest - lowest;
        }
        speed += length(between);
    }
    return speed;
}

// The number of collision substeps that a group needs in a step of `dt` seconds. In each of them no two surfaces of the
// group move farther relative to each other than a part of its thinnest body. The twin of
// `Speeds::collision_substeps_for`.
fn count_substeps(root: u32, division: t::Division, dt: f32) -> u32 {
    if atomicLoad(&meetings[root].exists) == 0u {
        return 1u;
    }
    let thinnest = bitcast<f32>(atomicLoad(&meetings[root].thinnest));
    let wanted = ceil(relative_speed(root) * dt / (division.travel * thinnest));
    return select(1u, u32(min(wanted, f32(division.most))), wanted > 1.0);
}
