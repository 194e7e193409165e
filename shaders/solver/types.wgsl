#define_import_path faceoff::solver_types

// The structs that the solver's kernels share with each other and with the host. `src/solver/gpu/layout.rs` declares
// the same structs; a test compares every offset. Constants that the host needs are declared there and added to this
// module. A symmetric tensor is six numbers: the diagonal xx, yy, zz and the off-diagonal xy, xz, yz.

// Parameters of a collision substep. `SolverSettings` explains those without a comment.
struct CollisionSubstep {
    gravity: vec3<f32>,
    // Number of paces; 0 if nothing is solved.
    paces: u32,
    bodies: u32,
    // Number of bodies, with half-spaces, in the last collision substep.
    old_bodies: u32,
    // Lengths of the solver's lists.
    pair_capacity: u32,
    point_capacity: u32,
    max_depenetration_speed: f32,
    deep_depenetration_speed: f32,
    deep_penetration: f32,
    rest_offset: f32,
    restitution_threshold: f32,
    match_distance: f32,
    match_normal: f32,
    convergence_speed: f32,
    bias_iterations: u32,
    relax_iterations: u32,
    restitution_iterations: u32,
    max_iterations: u32,
    sleep_speed: f32,
    sleep_time: f32,
    padding_a: u32,
    padding_b: u32,
}

// How a body with a given number of collision substeps passes through a step.
struct Pace {
    // Length of a substep, seconds.
    h: f32,
    // Length of a collision substep, seconds.
    dt: f32,
    // Number of substeps in it.
    substeps: u32,
    // Acceleration by the contact spring per metre, 1/s^2.
    stiffness: f32,
    // The contact spring.
    bias_rate: f32,
    mass_scale: f32,
    impulse_scale: f32,
    padding_a: u32,
    // The contact spring of islands that get few passes.
    few_bias_rate: f32,
    few_mass_scale: f32,
    few_impulse_scale: f32,
    padding_b: u32,
}

// Properties of a collider and its body, constant within a step. A body has the number of its first collider.
struct SolverBody {
    // In the body's own axes, 1/(kg m^2).
    inverse_inertia: vec3<f32>,
    inverse_mass: f32,
    inverse_inertia_off_diagonal: vec3<f32>,
    // Kind and sensor as in `Body`, combination rules, and locked axes; see the constants.
    flags: u32,
    radius: f32,
    restitution: f32,
    friction: f32,
    gravity_scale: f32,
    linear_damping: f32,
    angular_damping: f32,
    // Small enough that its square is finite.
    max_linear_speed: f32,
    max_angular_speed: f32,
    // From the body's centre of mass to the collider's, in the body's axes.
    offset: vec3<f32>,
    // Number of the body.
    body: u32,
    // Distance of the body's farthest point from its centre of mass.
    extent: f32,
    // Inverse mass that a kinematic body would have if contacts moved it, 1/kg; 0 if it is not known.
    own_inverse_mass: f32,
    padding_a: u32,
    padding_b: u32,
}

// Lengths from here on count as infinite.
const INFINITE_LENGTH: f32 = 1.0e29;

// Pose, velocity and sleep state of a body. Centre and rotation are each the sum of two parts: a coarse one and a small
// remainder.
struct MotionState {
    center: vec3<f32>,
    // Not 0: the body sleeps. A static or kinematic body has `CHANGED` until it has woken others.
    asleep: u32,
    center_low: vec3<f32>,
    // How long it has been at rest, seconds.
    rest_time: f32,
    rotation: vec4<f32>,
    rotation_low: vec4<f32>,
    linear_velocity: vec3<f32>,
    // The colliders that it touched when it fell asleep, as the sum of their keys.
    neighbours: u32,
    angular_velocity: vec3<f32>,
    // A hash of the body's key.
    key: u32,
    // How far it went and turned in the present half of the sleep time, and in the half before.
    moved: vec3<f32>,
    padding_a: u32,
    turned: vec3<f32>,
    padding_b: u32,
    last_moved: vec3<f32>,
    padding_c: u32,
    last_turned: vec3<f32>,
    padding_d: u32,
}

// External forces and impulses.
struct BodyForces {
    force: vec3<f32>,
    padding_a: f32,
    torque: vec3<f32>,
    padding_b: f32,
    impulse: vec3<f32>,
    padding_c: f32,
    angular_impulse: vec3<f32>,
    padding_d: f32,
}

// Properties of a body that are constant during a collision substep.
struct BodyConstants {
    // From the body's axes to the world's, at the start of the collision substep.
    initial_rotation: vec4<f32>,
    // In the body's own axes; zero if the inverse is singular.
    local_inertia: vec3<f32>,
    // Rates at which damping decreases the velocities, 1/s.
    linear_damping: f32,
    local_inertia_off_diagonal: vec3<f32>,
    angular_damping: f32,
    local_inverse_inertia: vec3<f32>,
    max_linear_speed: f32,
    local_inverse_inertia_off_diagonal: vec3<f32>,
    max_angular_speed: f32,
    // By gravity, m/s^2.
    acceleration: vec3<f32>,
    // See the constants below.
    flags: u32,
    force: vec3<f32>,
    padding_a: f32,
    torque: vec3<f32>,
    padding_b: f32,
}

// The body is neither static nor asleep, its motion is finite, and it has not completed its step.
const MOVES: u32 = 1u;
// Impulses change the body's velocity.
const HAS_MASS: u32 = 2u;
// The body's inertia is the same about all axes.
const ISOTROPIC: u32 = 4u;
// The body's numbers are finite.
const FINITE: u32 = 8u;
// First bit of the locked axes: x, y, z of translation, then of rotation.
const LOCKED: u32 = 8u;

// An island solves the body.
const SOLVED: u32 = 16u;
// The body is static or has completed its step.
const COMPLETED: u32 = 32u;
// First bit of the number of its pace.
const PACE_SHIFT: u32 = 16u;

// Velocity in world axes, m/s and rad/s.
struct Velocity {
    linear: vec3<f32>,
    padding_a: f32,
    angular: vec3<f32>,
    padding_b: f32,
}

// How impulses change the velocity of a body.
struct Mass {
    // Along each world axis, 1/kg.
    inverse_mass: vec3<f32>,
    // The flags of `BodyConstants`.
    flags: u32,
    // In world axes, 1/(kg m^2).
    inverse_inertia: vec3<f32>,
    padding_a: f32,
    inverse_inertia_off_diagonal: vec3<f32>,
    padding_b: f32,
}

// Change of a body's pose since the start of the collision substep, in world axes.
struct PoseChange {
    translation: vec3<f32>,
    padding: f32,
    rotation: vec4<f32>,
}

// Velocity, mass and pose of a body during a collision substep.
struct BodyState {
    velocity: Velocity,
    // Before the impulses of the substep.
    initial_velocity: Velocity,
    mass: Mass,
    pose_change: PoseChange,
}

// The contact constraint of two colliders.
struct SolverPair {
    // Numbers of the bodies.
    a: u32,
    b: u32,
    first: u32,
    count: u32,
    friction: f32,
    restitution: f32,
    rest_offset: f32,
    flags: u32,
    // The direction that resolves a conflict between contact points; zero for other pairs.
    separating_direction: vec3<f32>,
    // Number of the saved pair of the last collision substep, or `NOT_SAVED`.
    saved_pair: u32,
    // From the first body's centre of mass to the second's.
    center_offset: vec3<f32>,
    // The smaller bounding diameter.
    diameter: f32,
    // Velocity of the first centre relative to the second, m/s.
    approach_velocity: vec3<f32>,
    // Upper bound for the sum of both surface speeds relative to the centres, m/s.
    surface_speed: f32,
    // From each body's centre of mass to its collider's, in world axes.
    offset_a: vec3<f32>,
    collider_a: u32,
    offset_b: vec3<f32>,
    collider_b: u32,
    // The mass of the heavier body over that of the lighter one, if impulses move both, or if the lighter one is
    // kinematic; 1 otherwise.
    mass_ratio: f32,
    // Pairs of one island with the same colour have no body in common that impulses move.
    color: u32,
    // The number of its pace.
    pace: u32,
    // Length of the substeps in which its impulses act, seconds.
    substep: f32,
    // How much softer its contact spring is than that of a pair with a static body.
    softness: f32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

// The pair's numbers are valid. Its impulses are saved even if it is frozen.
const VALID: u32 = 1u;
// No impulse moves either body: the pair is not solved.
const FROZEN: u32 = 2u;
// Some point is active.
const ACTIVE: u32 = 4u;
const DEPENETRATING: u32 = 8u;
// The bodies of the saved pair are in the opposite order.
const SWAPPED: u32 = 16u;
const FIRST_HAS_MASS: u32 = 32u;
const SECOND_HAS_MASS: u32 = 64u;
// Neither body moves: the pair keeps its impulses.
const KEPT: u32 = 128u;
// One body is kinematic and moves.
const DRIVEN: u32 = 256u;

const NOT_SAVED: u32 = 0xffffffffu;

// What is constant about a point during a collision substep.
struct PointConstants {
    // From each centre of mass to the point on the surface, at the start of the collision substep.
    anchor_a: vec3<f32>,
    // Separation beyond the rest offset, at the start of the collision substep.
    initial_separation: f32,
    anchor_b: vec3<f32>,
    // Where impulses act, as a fraction of the way from the first anchor to the second.
    contact_fraction: f32,
    // From each centre of mass to the centre of curvature.
    curvature_center_a: vec3<f32>,
    padding_a: f32,
    curvature_center_b: vec3<f32>,
    padding_b: f32,
    // From the first anchor to the second.
    anchor_offset: vec3<f32>,
    padding_c: f32,
    // The normal at the start of the collision substep.
    initial_normal: vec3<f32>,
    // How fast the normal rotates as the surfaces slide, radians per metre.
    normal_rotation: f32,
}

// The constraint along the normal or a tangent of a point: the Jacobian, where its impulse acts now, and what passes
// aim at.
struct Row {
    direction: vec3<f32>,
    // Change of the impulse by a unit of velocity error; 0 if the row is not solved.
    response: f32,
    // The moment of a unit impulse about each centre of mass.
    moment_a: vec3<f32>,
    // The velocity along the row that is wanted, negated, m/s.
    bias: f32,
    moment_b: vec3<f32>,
    // Change of the relative velocity by a unit impulse. Both tangents have the larger of their two values.
    inverse_effective_mass: f32,
    // The changes of angular velocity by these moments.
    angular_response_a: vec3<f32>,
    // Fraction of the impulse that is subtracted.
    impulse_scale: f32,
    angular_response_b: vec3<f32>,
    padding: f32,
}

// The state of a point.
struct PointState {
    normal: vec3<f32>,
    separation: f32,
    // From the point to where friction acts.
    friction_offset: vec3<f32>,
    // The sum of the normal impulses of all earlier substeps; `normal_impulse` is not included.
    total_normal_impulse: f32,
    // Impulses of this substep, along the tangents and along the normal.
    friction_impulse: vec2<f32>,
    normal_impulse: f32,
    flags: u32,
    // The change of the impulses in the last pass, along the normal and along the tangents.
    change: vec3<f32>,
    // The normal velocity before the impulses of this substep, m/s.
    impact_velocity: f32,
    // The direction in which they are extrapolated. If the pair is `KEPT`, the friction impulse in world axes.
    search: vec3<f32>,
    padding: f32,
    normal_row: Row,
    first_tangent_row: Row,
    second_tangent_row: Row,
}

// The point's numbers are valid, and it is part of the constraint.
const POINT_VALID: u32 = 1u;
// The point is solved in this substep.
const POINT_ACTIVE: u32 = 2u;
// The point had no impulse at the start of the substep, so an impulse now is an impact.
const MAY_IMPACT: u32 = 4u;
// The point has an impact in this substep, with restitution.
const HAS_IMPACT: u32 = 8u;
// The point's velocity after the impacts of this substep is at least the reversed one.
const REBOUNDS: u32 = 16u;
// The point has had an impulse in this collision substep or at the end of the last one.
const TOUCHED: u32 = 32u;
// The point has had restitution in this collision substep: the bodies separate.
const BOUNCED: u32 = 64u;

// A pair as it is saved for the next collision substep, by the present numbers of its colliders.
struct SavedPair {
    a: u32,
    b: u32,
    first: u32,
    count: u32,
    separating_direction: vec3<f32>,
    depenetrating: u32,
    // From each body's axes to the world's.
    rotation_a: vec4<f32>,
    rotation_b: vec4<f32>,
    // Length of the substeps in which its impulses acted, seconds.
    substep: f32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

// A point as it is saved for the next collision substep, in world axes.
struct SavedPoint {
    anchor_a: vec3<f32>,
    normal_impulse: f32,
    anchor_b: vec3<f32>,
    padding_a: f32,
    normal: vec3<f32>,
    padding_b: f32,
    friction_impulse: vec3<f32>,
    padding_c: f32,
}

// An island as a range of `island_pairs`.
struct IslandRange {
    first: u32,
    // One more than the last.
    end: u32,
    // Number of colours.
    colors: u32,
    padding: u32,
}

// A pair of an island, sorted by colour.
struct IslandPair {
    // Number of the pair among `solver_pairs`.
    pair: u32,
    // See the constants below.
    flags: u32,
    // In the n-th pair of an island: one more than the last pair of colour n.
    color_end: u32,
    // In a small island, where the velocities of the first and of the second body are in workgroup memory, in 16 bits
    // each.
    places: u32,
}

// The place of a body that impulses do not move.
const NO_PLACE: u32 = 0xffffu;

// The thread that solves the pair also integrates this body. Each body has one such pair in its island.
const OWNS_FIRST: u32 = 1u;
const OWNS_SECOND: u32 = 2u;
