#define_import_path faceoff::motion

// Integration of a body's velocity and pose. The twin of `src/solver/motion.rs` and `body_constants.rs`.

#import faceoff::constants::solver::{FREE_ANGLE, MAX_ROUNDS}
#import faceoff::math::{compose, rotation_by}
#import faceoff::solver_math::{decay, rotation_displacement, finite_rotation, finite_vector, limited, rotated}
#import faceoff::solver_types as s
#import faceoff::tensor::{apply_tensor, inverse_tensor, is_zero, masked_tensor, rotated_tensor, Tensor}

// 1 for each axis along which the body may translate, else 0.
fn free_translation(flags: u32) -> vec3<f32> {
    return vec3<f32>((vec3(~(flags >> s::LOCKED)) >> vec3(0u, 1u, 2u)) & vec3(1u));
}

// 1 for each axis about which it may rotate, else 0.
fn free_rotation(flags: u32) -> vec3<f32> {
    return vec3<f32>((vec3(~(flags >> s::LOCKED)) >> vec3(3u, 4u, 5u)) & vec3(1u));
}

// The inverse inertia in world axes at `rotation`.
fn world_inverse_inertia(constants: s::BodyConstants, rotation: vec4<f32>) -> Tensor {
    let own = Tensor(constants.local_inverse_inertia, constants.local_inverse_inertia_off_diagonal);
    let free = free_rotation(constants.flags);
    let locked = any(free != vec3(1.0));
    if (constants.flags & s::ISOTROPIC) != 0u && !locked {
        return own;
    }
    let inverse = rotated_tensor(own, rotation);
    if !locked {
        return inverse;
    }
    // The bearing of a locked axis balances any moment about it. So the locked axes are removed from the inertia
    // tensor, and the rest is inverted.
    let inertia = rotated_tensor(Tensor(constants.local_inertia, constants.local_inertia_off_diagonal), rotation);
    var reduced = masked_tensor(inertia, free);
    reduced.diagonal += vec3(1.0) - free;
    reduced = masked_tensor(inverse_tensor(reduced), free);
    let regular = !is_zero(Tensor(constants.local_inertia, constants.local_inertia_off_diagonal));
    if regular && finite_vector(reduced.diagonal) && finite_vector(reduced.off_diagonal) {
        return reduced;
    }
    return masked_tensor(inverse, free);
}

fn inertia_of(mass: s::Mass) -> Tensor {
    return Tensor(mass.inverse_inertia, mass.inverse_inertia_off_diagonal);
}

// The velocity after an impulse; unchanged if the result would not be finite.
fn with_impulse(velocity: s::Velocity, mass: s::Mass, linear: vec3<f32>, angular: vec3<f32>) -> s::Velocity {
    var next = velocity;
    next.linear += mass.inverse_mass * linear;
    next.angular += apply_tensor(inertia_of(mass), angular);
    if finite_vector(next.linear) && finite_vector(next.angular) {
        return next;
    }
    return velocity;
}

fn limited_velocity(velocity: s::Velocity, constants: s::BodyConstants) -> s::Velocity {
    var next = velocity;
    next.linear = limited(velocity.linear, constants.max_linear_speed);
    next.angular = limited(velocity.angular, constants.max_angular_speed);
    return next;
}

// The velocity after one substep of gravity, external forces, damping and speed limits.
fn with_integrated_velocity(velocity: s::Velocity, mass: s::Mass, constants: s::BodyConstants, h: f32) -> s::Velocity {
    if (constants.flags & s::HAS_MASS) == 0u {
        return velocity;
    }
    var next = velocity;
    next.linear += mass.inverse_mass * (constants.force * h);
    next.angular += apply_tensor(inertia_of(mass), constants.torque * h);
    next.linear = (next.linear + constants.acceleration * h) * decay(constants.linear_damping * h);
    next.angular *= decay(constants.angular_damping * h);
    if !(finite_vector(next.linear) && finite_vector(next.angular)) {
        next = velocity;
    }
    return limited_velocity(next, constants);
}

// Moves and rotates a body over one substep.
fn integrate_pose(constants: s::BodyConstants, state: ptr<function, s::BodyState>, h: f32) {
    if (constants.flags & s::MOVES) == 0u {
        return;
    }
    let velocity = limited_velocity((*state).velocity, constants);
    (*state).velocity = velocity;
    (*state).pose_change.translation += velocity.linear * h;
    let angular = velocity.angular;
    if all(angular == vec3(0.0)) {
        return;
    }
    let rotation_change = (*state).pose_change.rotation;
    let turns = !is_zero(inertia_of((*state).mass));
    if !turns || (constants.flags & s::ISOTROPIC) != 0u || any(free_rotation(constants.flags) != vec3(1.0)) {
        (*state).pose_change.rotation = rotated(angular * h, rotation_change);
    } else {
        let freely = rotate_freely(constants, angular, rotation_change, h);
        (*state).velocity.angular = freely.angular;
        (*state).pose_change.rotation = freely.rotation_change;
    }
    if turns {
        let rotation = compose((*state).pose_change.rotation, constants.initial_rotation);
        let inertia = world_inverse_inertia(constants, rotation);
        (*state).mass.inverse_inertia = inertia.diagonal;
        (*state).mass.inverse_inertia_off_diagonal = inertia.off_diagonal;
    }
}

struct FreeRotation {
    angular: vec3<f32>,
    rotation_change: vec4<f32>,
}

// The rotation of a body without torque over one substep, by the implicit midpoint rule in axes that rotate with the
// body. All terms are summed as changes, so that rounding errors do not add up.
fn rotate_freely(constants: s::BodyConstants, angular: vec3<f32>, rotation_change: vec4<f32>, h: f32) -> FreeRotation {
    let rounds = max(ceil(sqrt(dot(angular, angular)) * h / FREE_ANGLE), 1.0);
    if !(rounds <= MAX_ROUNDS) {
        return FreeRotation(angular, rotated(angular * h, rotation_change));
    }
    let part = h / rounds;
    var next = angular;
    var pose = rotation_change;
    for (var k = 0u; k < u32(rounds); k += 1u) {
        let rotation = normalize(compose(pose, constants.initial_rotation));
        let local_inverse = Tensor(constants.local_inverse_inertia, constants.local_inverse_inertia_off_diagonal);
        let inverse = rotated_tensor(local_inverse, rotation);
        let inertia = rotated_tensor(Tensor(constants.local_inertia, constants.local_inertia_off_diagonal), rotation);
        let momentum = apply_tensor(inertia, next);
        var middle = next;
        for (var guess = 0u; guess < 3u; guess += 1u) {
            middle = next + apply_tensor(inverse, rotation_displacement(rotation_by(middle * (-0.5 * part)), momentum));
        }
        let own = next + apply_tensor(inverse, rotation_displacement(rotation_by(middle * -part), momentum));
        next = own + rotation_displacement(rotation_by(middle * part), own);
        pose = rotated(middle * part, pose);
    }
    if finite_vector(next) && finite_rotation(pose) {
        return FreeRotation(next, pose);
    }
    return FreeRotation(angular, rotation_change);
}
