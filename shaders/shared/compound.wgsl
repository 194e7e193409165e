#define_import_path faceoff::compound

// Places the colliders of compounds.

#import faceoff::math::{compose, rotate}
#import faceoff::types as t

// Pose and velocities of a compound.
struct CompoundMotion {
    // The centre of mass is the sum of both.
    center: vec3<f32>,
    center_low: vec3<f32>,
    rotation: vec4<f32>,
    linear_velocity: vec3<f32>,
    angular_velocity: vec3<f32>,
}

// The collider `body` at its place in the compound.
fn placed_part(body: t::Body, part: t::CompoundPart, motion: CompoundMotion) -> t::Body {
    var placed = body;
    placed.position = motion.center + (motion.center_low + rotate(motion.rotation, part.translation));
    let rotation = compose(motion.rotation, part.rotation);
    placed.rotation = rotation / sqrt(dot(rotation, rotation));
    placed.linear_velocity = motion.linear_velocity + cross(motion.angular_velocity, offset_of(part, motion));
    placed.angular_velocity = motion.angular_velocity;
    return placed;
}

// From the compound's centre of mass to the collider's, in world axes.
fn offset_of(part: t::CompoundPart, motion: CompoundMotion) -> vec3<f32> {
    return rotate(motion.rotation, part.offset);
}
