#define_import_path faceoff::motion

// What a body does by itself: it speeds up and moves. `src/solver/motion.rs` explains it.

#import faceoff::constants::solver::{FREE_ANGLE, MAX_ROUNDS}
#import faceoff::math::{compose, turn}
#import faceoff::solver_math::{change, finite_rotation, finite_vector, limited, turned_on}
#import faceoff::solver_types as s
#import faceoff::tensor::{apply_tensor, inverse_tensor, is_zero, masked_tensor, turned_tensor, Tensor}

// 1 for each axis along which the body may move, else 0.
fn free_translation(flags: u32) -> vec3<f32> {
    return vec3<f32>((vec3(~(flags >> s::LOCKED)) >> vec3(0u, 1u, 2u)) & vec3(1u));
}

// 1 for each axis about which it may turn, else 0.
fn free_rotation(flags: u32) -> vec3<f32> {
    return vec3<f32>((vec3(~(flags >> s::LOCKED)) >> vec3(3u, 4u, 5u)) & vec3(1u));
}

// In world axes, for a body turned by `rotation`.
fn world_inverse_inertia(mover: s::Mover, rotation: vec4<f32>) -> Tensor {
    let own = Tensor(mover.inverse_inertia, mover.inverse_inertia_mixed);
    let free = free_rotation(mover.flags);
    let locked = any(free != vec3(1.0));
    if (mover.flags & s::ISOTROPIC) != 0u && !locked {
        return own;
    }
    let inverse = turned_tensor(own, rotation);
    if !locked {
        return inverse;
    }
    // What holds an axis takes up its moment. What is left of the inertia tensor without the axis is inverted.
    let inertia = turned_tensor(Tensor(mover.inertia, mover.inertia_mixed), rotation);
    var left = masked_tensor(inertia, free);
    left.diagonal += vec3(1.0) - free;
    left = masked_tensor(inverse_tensor(left), free);
    let regular = !is_zero(Tensor(mover.inertia, mover.inertia_mixed));
    if regular && finite_vector(left.diagonal) && finite_vector(left.mixed) {
        return left;
    }
    return masked_tensor(inverse, free);
}

fn inertia_of(mass: s::Mass) -> Tensor {
    return Tensor(mass.inverse_inertia, mass.inverse_inertia_mixed);
}

// The velocity after an impulse; unchanged if that would not be finite.
fn pushed(velocity: s::Velocity, mass: s::Mass, linear: vec3<f32>, angular: vec3<f32>) -> s::Velocity {
    var next = velocity;
    next.linear += mass.inverse_mass * linear;
    next.angular += apply_tensor(inertia_of(mass), angular);
    if finite_vector(next.linear) && finite_vector(next.angular) {
        return next;
    }
    return velocity;
}

fn limited_velocity(velocity: s::Velocity, mover: s::Mover) -> s::Velocity {
    var next = velocity;
    next.linear = limited(velocity.linear, mover.max_linear_speed);
    next.angular = limited(velocity.angular, mover.max_angular_speed);
    return next;
}

// Gravity, outer forces, damping and speed limits over one substep.
fn accelerated(velocity: s::Velocity, mass: s::Mass, mover: s::Mover, h: f32) -> s::Velocity {
    if (mover.flags & s::HAS_MASS) == 0u {
        return velocity;
    }
    var next = velocity;
    next.linear += mass.inverse_mass * (mover.force * h);
    next.angular += apply_tensor(inertia_of(mass), mover.torque * h);
    next.linear = (next.linear + mover.acceleration * h) * mover.linear_decay;
    next.angular *= mover.angular_decay;
    if !(finite_vector(next.linear) && finite_vector(next.angular)) {
        next = velocity;
    }
    return limited_velocity(next, mover);
}

// Moves and turns a body over one substep.
fn advance(
    mover: s::Mover,
    velocity: ptr<function, s::Velocity>,
    mass: ptr<function, s::Mass>,
    shift: ptr<function, s::Shift>,
    h: f32,
) {
    if (mover.flags & s::MOVES) == 0u {
        return;
    }
    *velocity = limited_velocity(*velocity, mover);
    (*shift).moved += (*velocity).linear * h;
    let angular = (*velocity).angular;
    if all(angular == vec3(0.0)) {
        return;
    }
    let turns = !is_zero(inertia_of(*mass));
    if !turns || (mover.flags & s::ISOTROPIC) != 0u || any(free_rotation(mover.flags) != vec3(1.0)) {
        (*shift).turned = turned_on(angular * h, (*shift).turned);
    } else {
        let freely = turned_freely(mover, angular, (*shift).turned, h);
        (*velocity).angular = freely.angular;
        (*shift).turned = freely.turned;
    }
    if turns {
        let inertia = world_inverse_inertia(mover, compose((*shift).turned, mover.rotation));
        (*mass).inverse_inertia = inertia.diagonal;
        (*mass).inverse_inertia_mixed = inertia.mixed;
    }
}

struct Turned {
    angular: vec3<f32>,
    turned: vec4<f32>,
}

// A body on which nothing acts after a substep: the implicit midpoint rule, in axes that turn with the body. Everything is
// summed as changes, so that rounding does not add up.
fn turned_freely(mover: s::Mover, angular: vec3<f32>, turned: vec4<f32>, h: f32) -> Turned {
    let rounds = max(ceil(sqrt(dot(angular, angular)) * h / FREE_ANGLE), 1.0);
    if !(rounds <= MAX_ROUNDS) {
        return Turned(angular, turned_on(angular * h, turned));
    }
    let part = h / rounds;
    var next = angular;
    var pose = turned;
    for (var k = 0u; k < u32(rounds); k += 1u) {
        let rotation = normalize(compose(pose, mover.rotation));
        let inverse = turned_tensor(Tensor(mover.inverse_inertia, mover.inverse_inertia_mixed), rotation);
        let inertia = turned_tensor(Tensor(mover.inertia, mover.inertia_mixed), rotation);
        let momentum = apply_tensor(inertia, next);
        var middle = next;
        for (var guess = 0u; guess < 3u; guess += 1u) {
            middle = next + apply_tensor(inverse, change(turn(middle * (-0.5 * part)), momentum));
        }
        let own = next + apply_tensor(inverse, change(turn(middle * -part), momentum));
        next = own + change(turn(middle * part), own);
        pose = turned_on(middle * part, pose);
    }
    if finite_vector(next) && finite_rotation(pose) {
        return Turned(next, pose);
    }
    return Turned(angular, turned);
}
