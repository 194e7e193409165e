#define_import_path faceoff::solver_types

// What passes between the solver's kernels, and between them and the host. `src/solver/gpu/layout.rs` holds the same structs,
// of which a test compares every offset; and it holds the constants that the host needs, which are added to this module from
// there. Symmetric tensors are six numbers: the diagonal xx, yy, zz and, mixed, xy, xz, yz.

// A collision substep, and how contacts are solved in it; `settings.rs` explains what is not explained here.
struct CollisionSubstep {
    gravity: vec3<f32>,
    // Length of a substep, seconds.
    h: f32,
    bodies: u32,
    // How many bodies there were when the memory of impulses was written.
    old_bodies: u32,
    // How many pairs and points the solver's own lists hold.
    pair_capacity: u32,
    point_capacity: u32,
    // The contact spring.
    bias_rate: f32,
    mass_scale: f32,
    impulse_scale: f32,
    relaxation: f32,
    sweeps: u32,
    max_depenetration_speed: f32,
    deep_depenetration_speed: f32,
    deep_penetration: f32,
    rest_offset: f32,
    restitution_threshold: f32,
    match_distance: f32,
    match_normal: f32,
    // Length of the interval, seconds.
    dt: f32,
    sleep_speed: f32,
    sleep_time: f32,
    padding: u32,
}

// What a body is.
struct SolverBody {
    // In the body's own axes.
    inverse_inertia: vec3<f32>,
    inverse_mass: f32,
    inverse_inertia_off_diagonal: vec3<f32>,
    // Kind and sensor as in `Body`; the rules of combination, and the locked axes, at the shifts below.
    flags: u32,
    radius: f32,
    restitution: f32,
    friction: f32,
    gravity_scale: f32,
    linear_damping: f32,
    angular_damping: f32,
    // Squares of limits are finite numbers.
    max_linear_speed: f32,
    max_angular_speed: f32,
}

// Lengths from here on count as infinite.
const INFINITE_LENGTH: f32 = 1.0e29;

// Where a body is and how it moves. What is in two parts is their sum: a coarse one, and a small one that holds what the
// coarse one is too coarse for.
struct MotionState {
    center: vec3<f32>,
    // Not 0: frozen. Of a static body: `CHANGED`, until others have woken from it.
    asleep: u32,
    center_low: vec3<f32>,
    // For how long it has been slow, seconds.
    rest_time: f32,
    rotation: vec4<f32>,
    rotation_low: vec4<f32>,
    linear_velocity: vec3<f32>,
    // What it touched when it fell asleep, as a sum of keys.
    neighbours: u32,
    angular_velocity: vec3<f32>,
    // A hash of what tells it from other bodies.
    key: u32,
}

// What acts on a body from outside.
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

// What about a body holds for an interval.
struct BodyConstants {
    // At the start of the interval.
    initial_rotation: vec4<f32>,
    // In the body's own axes; zero if it has no inverse.
    local_inertia: vec3<f32>,
    // What is left of the velocities after a substep.
    linear_decay: f32,
    local_inertia_off_diagonal: vec3<f32>,
    angular_decay: f32,
    local_inverse_inertia: vec3<f32>,
    max_linear_speed: f32,
    local_inverse_inertia_off_diagonal: vec3<f32>,
    max_angular_speed: f32,
    // By gravity.
    acceleration: vec3<f32>,
    // See the constants.
    flags: u32,
    force: vec3<f32>,
    padding_a: f32,
    torque: vec3<f32>,
    padding_b: f32,
}

// It changes its place.
const MOVES: u32 = 1u;
// Contacts push it.
const HAS_MASS: u32 = 2u;
// Its inertia is the same about all axes.
const ISOTROPIC: u32 = 4u;
// Its numbers are finite.
const FINITE: u32 = 8u;
// Above them the locked axes: x, y, z of translation, then of rotation.
const LOCKED: u32 = 8u;

// The range of a body's sides in the sorted list of sides, and its number in the last collision substep.
struct BodyAdjacency {
    first_side: u32,
    // One more than the last.
    sides_end: u32,
    // `NOT_SAVED` if it is new.
    old_number: u32,
    padding: u32,
}

// How a body moves.
struct Velocity {
    linear: vec3<f32>,
    padding_a: f32,
    angular: vec3<f32>,
    padding_b: f32,
}

// How a body gives way.
struct Mass {
    // Along each world axis.
    inverse_mass: vec3<f32>,
    // Into how many bodies it is split in this substep.
    split_count: f32,
    // In world axes.
    inverse_inertia: vec3<f32>,
    // Those of the mover.
    flags: u32,
    inverse_inertia_off_diagonal: vec3<f32>,
    padding: f32,
}

// How far a body has come since the start of the interval.
struct PoseChange {
    translation: vec3<f32>,
    padding: f32,
    rotation: vec4<f32>,
}

// Two bodies and what holds for all their points.
struct SolverPair {
    a: u32,
    b: u32,
    first: u32,
    count: u32,
    friction: f32,
    restitution: f32,
    rest_offset: f32,
    flags: u32,
    // The way out of an overlap whose points disagree; zero for other pairs.
    separating_direction: vec3<f32>,
    // Which of the remembered pairs it is.
    saved_pair: u32,
    // From the first body's centre of mass to the second's.
    center_offset: vec3<f32>,
    // The smaller bounding diameter.
    diameter: f32,
    // The velocity of the first centre as seen from the second.
    approach_velocity: vec3<f32>,
    // How fast both surfaces turn about their centres together, at most.
    surface_speed: f32,
}

// Its points are to be solved, or at least kept.
const VALID: u32 = 1u;
// Neither end moves.
const FROZEN: u32 = 2u;
// Some point pushes, or may, in this substep.
const ACTIVE: u32 = 4u;
const DEPENETRATING: u32 = 8u;
// The first body was the second of the remembered pair.
const SWAPPED: u32 = 16u;
// Whether contacts push the ends.
const FIRST_HAS_MASS: u32 = 32u;
const SECOND_HAS_MASS: u32 = 64u;

const NOT_SAVED: u32 = 0xffffffffu;

// What of a point stays as it is for an interval.
struct PointConstants {
    // From the centres of mass to the points on the surfaces, at the start of the interval.
    anchor_a: vec3<f32>,
    // Beyond the rest offset, at the start of the interval.
    initial_separation: f32,
    anchor_b: vec3<f32>,
    // How far from the first body's point to the second's impulses act.
    contact_fraction: f32,
    // To the centres of curvature.
    curvature_center_a: vec3<f32>,
    padding_a: f32,
    curvature_center_b: vec3<f32>,
    padding_b: f32,
    // From the first body's point to the second's.
    anchor_offset: vec3<f32>,
    padding_c: f32,
    // At the start of the interval.
    initial_normal: vec3<f32>,
    // How fast it turns as the surfaces slide, radians per metre.
    normal_rotation: f32,
}

// What of a point changes.
struct PointState {
    normal: vec3<f32>,
    separation: f32,
    // Where impulses act, from the centres of mass.
    impulse_anchor_a: vec3<f32>,
    flags: u32,
    impulse_anchor_b: vec3<f32>,
    // How fast the bodies parted at the point just before it first pushed.
    impact_velocity: f32,
    // Change of velocity that a unit impulse causes: along the normal and across it, of the first body, then the second.
    inverse_effective_mass: vec4<f32>,
    // Of this substep.
    friction_impulse: vec2<f32>,
    normal_impulse: f32,
    // The largest normal impulse.
    max_normal_impulse: f32,
    // Impulses that made it bounce.
    restitution_friction_impulse: vec2<f32>,
    restitution_impulse: f32,
    // The sum of the normal impulses of the substeps so far, less what is in `impulse`.
    total_normal_impulse: f32,
}

// Not left out.
const POINT_VALID: u32 = 1u;
// Pushes, or may, in this substep.
const POINT_ACTIVE: u32 = 2u;

// What is kept of a pair until the next interval, by the numbers that its bodies had.
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
}

// What is kept of a point, as the world was then.
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
