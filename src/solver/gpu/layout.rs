//! Structs and constants that the solver's kernels share with the host. `shaders/solver/types.wgsl` has the same
//! structs and explains their fields.

use crate::gpu::layout::{constants, layout};
use bytemuck::{Pod, Zeroable};

type Vec3 = [f32; 3];
type Quat = [f32; 4];

layout! {
    /// Parameters of a collision substep.
    CollisionSubstep {
        gravity: Vec3, paces: u32,
        bodies: u32, old_bodies: u32, pair_capacity: u32, point_capacity: u32,
        max_depenetration_speed: f32, deep_depenetration_speed: f32, deep_penetration: f32, rest_offset: f32,
        restitution_threshold: f32, match_distance: f32, match_normal: f32, convergence_speed: f32,
        bias_iterations: u32, relax_iterations: u32, restitution_iterations: u32, max_iterations: u32,
        sleep_speed: f32, sleep_time: f32, padding_a: u32, padding_b: u32,
    }
    /// How a body with a given number of collision substeps passes through a step.
    Pace {
        h: f32, dt: f32, substeps: u32, stiffness: f32,
        bias_rate: f32, mass_scale: f32, impulse_scale: f32, padding_a: u32,
        few_bias_rate: f32, few_mass_scale: f32, few_impulse_scale: f32, padding_b: u32,
    }
    /// Properties of a body, constant within a step.
    SolverBody {
        inverse_inertia: Vec3, inverse_mass: f32,
        inverse_inertia_off_diagonal: Vec3, flags: u32,
        radius: f32, restitution: f32, friction: f32, gravity_scale: f32,
        linear_damping: f32, angular_damping: f32, max_linear_speed: f32, max_angular_speed: f32,
        offset: Vec3, body: u32,
        extent: f32, own_inverse_mass: f32, padding_a: u32, padding_b: u32,
    }
    /// Pose, velocity and sleep state of a body.
    MotionState {
        center: Vec3, asleep: u32,
        center_low: Vec3, rest_time: f32,
        rotation: Quat,
        rotation_low: Quat,
        linear_velocity: Vec3, neighbours: u32,
        angular_velocity: Vec3, key: u32,
        moved: Vec3, padding_a: u32,
        turned: Vec3, padding_b: u32,
        last_moved: Vec3, padding_c: u32,
        last_turned: Vec3, padding_d: u32,
    }
    /// External forces and impulses.
    BodyForces {
        force: Vec3, padding_a: f32,
        torque: Vec3, padding_b: f32,
        impulse: Vec3, padding_c: f32,
        angular_impulse: Vec3, padding_d: f32,
    }
    /// Properties of a body that are constant during a collision substep.
    BodyConstants {
        initial_rotation: Quat,
        local_inertia: Vec3, linear_damping: f32,
        local_inertia_off_diagonal: Vec3, angular_damping: f32,
        local_inverse_inertia: Vec3, max_linear_speed: f32,
        local_inverse_inertia_off_diagonal: Vec3, max_angular_speed: f32,
        acceleration: Vec3, flags: u32,
        force: Vec3, padding_a: f32,
        torque: Vec3, padding_b: f32,
    }
    /// Velocity of a body.
    Velocity {
        linear: Vec3, padding_a: f32,
        angular: Vec3, padding_b: f32,
    }
    /// How impulses change the velocity of a body.
    Mass {
        inverse_mass: Vec3, flags: u32,
        inverse_inertia: Vec3, padding_a: f32,
        inverse_inertia_off_diagonal: Vec3, padding_b: f32,
    }
    /// Change of a body's pose since the start of the collision substep.
    PoseChange {
        translation: Vec3, padding: f32,
        rotation: Quat,
    }
    /// Velocity, mass and pose of a body during a collision substep.
    BodyState {
        velocity: Velocity,
        initial_velocity: Velocity,
        mass: Mass,
        pose_change: PoseChange,
    }
    /// The contact constraint of two bodies.
    SolverPair {
        a: u32, b: u32, first: u32, count: u32,
        friction: f32, restitution: f32, rest_offset: f32, flags: u32,
        separating_direction: Vec3, saved_pair: u32,
        center_offset: Vec3, diameter: f32,
        approach_velocity: Vec3, surface_speed: f32,
        offset_a: Vec3, collider_a: u32,
        offset_b: Vec3, collider_b: u32,
        mass_ratio: f32, color: u32, pace: u32, substep: f32,
        softness: f32, padding_a: u32, padding_b: u32, padding_c: u32,
    }
    /// What is constant about a point during a collision substep.
    PointConstants {
        anchor_a: Vec3, initial_separation: f32,
        anchor_b: Vec3, contact_fraction: f32,
        curvature_center_a: Vec3, padding_a: f32,
        curvature_center_b: Vec3, padding_b: f32,
        anchor_offset: Vec3, padding_c: f32,
        initial_normal: Vec3, normal_rotation: f32,
    }
    /// The constraint along the normal or a tangent of a point.
    Row {
        direction: Vec3, response: f32,
        moment_a: Vec3, bias: f32,
        moment_b: Vec3, inverse_effective_mass: f32,
        angular_response_a: Vec3, impulse_scale: f32,
        angular_response_b: Vec3, padding: f32,
    }
    /// The state of a point.
    PointState {
        normal: Vec3, separation: f32,
        friction_offset: Vec3, total_normal_impulse: f32,
        friction_impulse: [f32; 2], normal_impulse: f32, flags: u32,
        change: Vec3, impact_velocity: f32,
        search: Vec3, padding: f32,
        normal_row: Row,
        first_tangent_row: Row,
        second_tangent_row: Row,
    }
    /// A pair as it is saved for the next collision substep.
    SavedPair {
        a: u32, b: u32, first: u32, count: u32,
        separating_direction: Vec3, depenetrating: u32,
        rotation_a: Quat,
        rotation_b: Quat,
        substep: f32, padding_a: u32, padding_b: u32, padding_c: u32,
    }
    /// A point as it is saved for the next collision substep.
    SavedPoint {
        anchor_a: Vec3, normal_impulse: f32,
        anchor_b: Vec3, padding_a: f32,
        normal: Vec3, padding_b: f32,
        friction_impulse: Vec3, padding_c: f32,
    }
    /// A body in the union-find forest of islands.
    Island {
        parent: u32, neighbours: u32, disturbed: u32, padding: u32,
    }
    /// An island as a range of the list of pairs.
    IslandRange {
        first: u32, end: u32, colors: u32, padding: u32,
    }
    /// A pair of an island.
    IslandPair {
        pair: u32, flags: u32, color_end: u32, places: u32,
    }
    /// What the search for colours knows of a body.
    BodyColors {
        claim: u32, used: u32,
    }
}

constants! {
    // Shifts of the fields of `SolverBody::flags` besides kind and sensor.
    u32 RESTITUTION_RULE = 8;
    u32 FRICTION_RULE = 12;
    u32 LOCKED_AXES = 16;

    /// `MotionState::asleep` of a static body that was moved or changed since the last step.
    u32 CHANGED = 2;

    // Indices into `solver_counters`, which persist between collision substeps.
    u32 PAIRS = 0;
    u32 POINTS = 1;
    u32 ENTRIES = 2;
    /// Not 0: a list was too short, and nothing was solved.
    u32 SKIPPED = 3;
    u32 SAVED_PAIRS = 4;
    /// The number found, even if the list is shorter.
    u32 PAIRS_FOUND = 5;
    u32 POINTS_FOUND = 6;
    u32 SMALL_ISLANDS = 7;
    u32 LARGE_ISLANDS = 8;
    u32 COUNTERS = 12;

    // Slots of `solver_arguments`.
    u32 GROUPS_PER_64_PAIRS = 0;
    u32 GROUPS_PER_SORT_BLOCK = 1;
    u32 GROUPS_PER_DIGIT_BLOCK = 2;
    u32 GROUPS_PER_64_BODIES = 3;
    u32 GROUPS_PER_64_OLD_BODIES = 4;
    u32 GROUPS_PER_SMALL_ISLAND = 5;
    u32 GROUPS_PER_LARGE_ISLAND = 6;
    u32 SLOTS = 7;

    // Islands of more pairs are solved by larger workgroups.
    u32 SMALL_ISLAND_PAIRS = 128;

    // What the kernels of sleep do.
    u32 WAKE = 0;
    u32 FALL_ASLEEP = 1;
}
