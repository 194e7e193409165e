//! Every array that passes between stages, as structures of arrays.

pub mod bodies;
pub mod margins;
pub mod mesh_arena;

use crate::manifolds::Manifolds;
use crate::step::dynamics::Dynamics;
use crate::types::body::{CollisionLayers, ExternalForces, LockedAxes, RigidBody};
use crate::types::material::{CombineRule, Friction};
use crate::types::settings::{Culling, Response};
use crate::types::solver_settings::SolverSettings;
use glam::{DMat3, DVec3, Mat3, Quat, Vec3};
use mesh_arena::MeshArena;
use std::time::Duration;

/// All input, intermediate and output of a step.
#[derive(Default)]
pub struct StepState {
    /// What holds for all bodies.
    pub config: StepConfig,
    /// The meshes in use.
    pub meshes: MeshArena,
    /// The bodies.
    pub bodies: Bodies,
    /// The half-spaces.
    pub planes: Vec<Plane>,
    /// BroadPhase's result: bodies whose spheres overlap, `a < b`, ascending.
    pub sphere_pairs: Vec<[u32; 2]>,
    /// Angles' result: what is left of them, in the same order.
    pub near_pairs: Vec<NearPair>,
    /// How many of them are tested with some triangles left out.
    pub approximate_pairs: usize,
    /// TriangleTest's result.
    pub contacts: Contacts,
    /// Manifolds' result: where solid bodies push each other, or may within the step. Empty with [`Response::Impulse`].
    pub manifolds: Manifolds,
    /// ForceScan's result: one sum per body. With [`Response::Contacts`] the solver's are in `dynamics`.
    pub impulses: Vec<Impulse>,
    /// What the solver works on, and keeps from step to step.
    pub dynamics: Dynamics,
    /// With [`Response::Contacts`], of each body whether it was asleep at the end of the step; else empty.
    pub asleep: Vec<bool>,
    /// Into how many detection intervals the step was cut.
    pub intervals: u32,
    /// Scratch that stages keep between steps.
    pub(crate) angles_scratch: crate::angles::cpu::Scratch,
    pub(crate) grid_scratch: crate::broad_phase::cpu::Scratch,
    pub(crate) force_scratch: crate::force_scan::cpu::Scratch,
    pub(crate) triangle_scratch: crate::triangle_test::cpu::Scratch,
    pub(crate) manifold_scratch: crate::manifolds::step::Scratch,
    /// How long each stage took in the last step.
    pub times: [Duration; crate::types::stage::Stage::COUNT],
}

/// How many of each thing a step found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Pairs of bodies whose spheres overlap.
    pub sphere_pairs: usize,
    /// Pairs tested with some triangles left out.
    pub approximate_pairs: usize,
    /// Pairs of bodies that touch.
    pub touching_pairs: usize,
    /// Pairs of triangles tested.
    pub triangle_tests: u64,
    /// Pairs of faces that intersect.
    pub face_pairs: usize,
    /// Points at which bodies push each other, or may.
    pub contact_points: usize,
    /// Bodies that sleep after the step.
    pub asleep: usize,
}

/// What holds for all bodies in a step.
#[derive(Clone, Copy, Debug)]
pub struct StepConfig {
    /// Length of the step in seconds, more than 0.
    pub dt: f32,
    /// Acceleration in m/s^2.
    pub gravity: Vec3,
    /// What happens to bodies that touch.
    pub response: Response,
    /// How contacts are solved.
    pub solver: SolverSettings,
}

impl Default for StepConfig {
    fn default() -> Self {
        Self {
            dt: 1.0 / 64.0,
            gravity: Vec3::ZERO,
            response: Response::Impulse,
            solver: SolverSettings::default(),
        }
    }
}

/// One entry per body in every array.
#[derive(Clone, Debug, Default)]
pub struct Bodies {
    /// Slot in the [`MeshArena`].
    pub mesh: Vec<u32>,
    /// How the body moves.
    pub kind: Vec<RigidBody>,
    /// Where the mesh's origin lies.
    pub position: Vec<Vec3>,
    /// Unit quaternion.
    pub rotation: Vec<Quat>,
    /// Scale along the mesh's own axes; no component is zero.
    pub scale: Vec<Vec3>,
    /// Velocity of the centre of mass, m/s.
    pub linear_velocity: Vec<Vec3>,
    /// World axes, rad/s.
    pub angular_velocity: Vec<Vec3>,
    /// The pose in double precision, from the three above.
    pub frame: Vec<Frame>,
    /// Centre of the bounding sphere: the centre of mass in the world.
    pub center: Vec<Vec3>,
    /// Radius of the bounding sphere, rounded up.
    pub radius: Vec<f32>,
    /// The same without what rounding its centre may cost: it does not depend on where the body is.
    pub own_radius: Vec<f32>,
    /// Of the thinnest part, metres.
    pub thickness: Vec<f32>,
    /// The radius and how far from it the body looks for others: what the broad phase goes by.
    pub reach: Vec<f32>,
    /// 0 for what cannot be pushed.
    pub inverse_mass: Vec<f32>,
    /// In the body's own axes; zero for what cannot be turned.
    pub own_inverse_inertia: Vec<Mat3>,
    /// The same in world axes.
    pub inverse_inertia: Vec<Mat3>,
    /// Bounciness.
    pub restitution: Vec<f32>,
    /// Factor on gravity.
    pub gravity_scale: Vec<f32>,
    /// Who collides with whom.
    pub layers: Vec<CollisionLayers>,
    /// Whether the body only reports.
    pub sensor: Vec<bool>,
    /// Which of its triangles take part in tests.
    pub culling: Vec<Culling>,
    /// How the body answers.
    pub handling: Vec<Handling>,
}

/// What a caller knows about a body; [`Bodies::push`] derives the rest.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Slot in the [`MeshArena`].
    pub mesh: u32,
    /// How the body moves.
    pub kind: RigidBody,
    /// Where the mesh's origin lies.
    pub position: Vec3,
    /// Need not have unit length, but must not be zero.
    pub rotation: Quat,
    /// Scale along the mesh's own axes.
    pub scale: Vec3,
    /// m/s.
    pub linear_velocity: Vec3,
    /// rad/s.
    pub angular_velocity: Vec3,
    /// Kilograms; `None` for what follows from the density.
    pub mass: Option<f32>,
    /// Kilograms per cubic metre.
    pub density: f32,
    /// Inertia tensor about the centre of mass in the body's own axes, kg m^2; `None` for what follows from mass and shape.
    pub inertia: Option<Mat3>,
    /// 0 to 1.
    pub restitution: f32,
    /// Factor on gravity.
    pub gravity_scale: f32,
    /// Who collides with whom.
    pub layers: CollisionLayers,
    /// Whether the body only reports.
    pub sensor: bool,
    /// Which of its triangles take part in tests.
    pub culling: Culling,
    /// How it answers.
    pub handling: Handling,
}

/// How a body answers contacts and forces, with [`Response::Contacts`]. The components of these names say what each means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handling {
    /// Coulomb's coefficient, and the rule for pairs.
    pub friction: Friction,
    /// The rule for pairs of the body's restitution.
    pub restitution_combine: CombineRule,
    /// 1/s.
    pub linear_damping: f32,
    /// 1/s.
    pub angular_damping: f32,
    /// m/s.
    pub max_linear_speed: f32,
    /// rad/s.
    pub max_angular_speed: f32,
    /// Where it does not move.
    pub locked_axes: LockedAxes,
    /// What acts on it. Impulses act in the step that begins.
    pub forces: ExternalForces,
    /// Whether it may fall asleep.
    pub can_sleep: bool,
    /// Whether it is to be awake at the beginning of the step.
    pub woken: bool,
    /// Whether it is stopped by what it meets within a step, and carried by it for the rest.
    pub continuous: bool,
}

impl Default for Handling {
    fn default() -> Self {
        Self {
            friction: Friction::default(),
            restitution_combine: CombineRule::default(),
            linear_damping: 0.0,
            angular_damping: 0.0,
            max_linear_speed: f32::INFINITY,
            max_angular_speed: f32::INFINITY,
            locked_axes: LockedAxes::NONE,
            forces: ExternalForces::default(),
            can_sleep: true,
            woken: false,
            continuous: false,
        }
    }
}

/// A body's pose in double precision: world point = `position + rotation * (scale * mesh point)`.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Where the mesh's origin lies.
    pub position: DVec3,
    /// Orthonormal.
    pub rotation: DMat3,
    /// Along the mesh's own axes.
    pub scale: DVec3,
    /// The centre of mass in the world.
    pub center: DVec3,
}

/// Where a body is and how it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Where the mesh's origin lies.
    pub position: Vec3,
    /// Unit quaternion.
    pub rotation: Quat,
    /// Velocity of the centre of mass, m/s.
    pub linear_velocity: Vec3,
    /// World axes, rad/s.
    pub angular_velocity: Vec3,
}

/// A solid half-space: `normal . p < distance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit vector out of the solid side.
    pub normal: Vec3,
    /// Metres from the origin.
    pub distance: f32,
    /// Bounciness.
    pub restitution: f32,
    /// The rule for pairs of its restitution.
    pub restitution_combine: CombineRule,
    /// Coulomb's coefficient, and the rule for pairs.
    pub friction: Friction,
}

impl Default for Plane {
    /// The ground at height 0.
    fn default() -> Self {
        Self {
            normal: Vec3::Y,
            distance: 0.0,
            restitution: 0.0,
            restitution_combine: CombineRule::default(),
            friction: Friction::default(),
        }
    }
}

/// A pair that may touch.
#[derive(Clone, Copy, Debug)]
pub struct NearPair {
    /// The two bodies, `a < b`.
    pub bodies: [u32; 2],
    /// Turns `b`'s axes into `a`'s.
    pub rotation: Mat3,
    /// From `a`'s centre of mass to `b`'s, in `a`'s axes, metres.
    pub translation: Vec3,
    /// The support axis along which the two overlap least: a unit vector from `a` to `b` in `a`'s axes.
    pub axis: Vec3,
    /// No point of `b` reaches below this along the axis, measured from `a`'s centre.
    pub b_above: f32,
    /// No point of `a` reaches above this along the axis, measured from `a`'s centre.
    pub a_below: f32,
    /// Which triangles of `a` and of `b` take part.
    pub views: [View; 2],
    /// How near the surfaces must come for contact points to be found, metres.
    pub margin: f32,
}

/// Which triangles of one end of a pair take part in the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// All of them.
    All,
    /// Those of the group of this number in the mesh's [`FaceTable`](crate::projection::FaceTable).
    Group(u32),
    /// Those whose normal, by the winding of the corners placed in the first body's axes, has a positive product with
    /// this vector. It points to the other body, or away from it where the winding shows the inner side.
    Facing(Vec3),
}

/// TriangleTest's result.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Pairs that touch, ascending.
    pub pairs: Vec<TouchingPair>,
    /// Intersecting faces of all pairs, one pair's after the other's.
    pub faces: Vec<FacePair>,
    /// Bodies that reach into half-spaces, ascending by body, then plane.
    pub planes: Vec<PlaneContact>,
    /// Where the pairs, and after them bodies and half-spaces, pushed each other: one pair's after the other's.
    pub points: Vec<ContactPoint>,
    /// Triangle against triangle tests made (pairs of triangles whose boxes overlap).
    pub triangle_tests: u64,
}

/// Two bodies that touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchingPair {
    /// The two bodies, `a < b`.
    pub bodies: [u32; 2],
    /// One is closed and has the other, or a connected component of it, inside, and no faces were found to intersect; with an
    /// approximate culling mode some may.
    pub contained: bool,
    /// Where its faces start in [`Contacts::faces`].
    pub first_face: u32,
    /// How many there are.
    pub face_count: u32,
    /// Where to push.
    pub contact: Contact,
    /// Where its points start in [`Contacts::points`].
    pub first_point: u32,
    /// How many there are.
    pub point_count: u32,
    /// How strongly the two pushed each other along the normals of their points in the step, newton seconds; 0 unless the
    /// response is [`Response::Contacts`].
    pub impulse: f32,
    /// They did not touch at the beginning of the step, but on their ways within it: a sensor and another body, one of them with
    /// [`ContinuousCollision`](crate::plugin::components::ContinuousCollision). The contact is where they first touched.
    pub passing: bool,
}

/// A point at which two bodies push each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// In the world, metres.
    pub point: Vec3,
    /// Unit vector from the first body to the second.
    pub normal: Vec3,
}

/// One of the points at which two bodies pushed each other in a step, or might have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Halfway between both surfaces, in the world, metres: where it was as its detection interval began.
    pub point: Vec3,
    /// Unit vector from the first body to the second.
    pub normal: Vec3,
    /// How far the surfaces were apart, metres; negative where they overlapped.
    pub separation: f32,
    /// How strongly the two pushed each other there along the normal in that interval, newton seconds; 0 unless the response
    /// is [`Response::Contacts`], and for bodies asleep.
    pub impulse: f32,
}

/// Two faces that intersect, with their common segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacePair {
    /// Face of the first body's mesh, an index of the input mesh.
    pub a: u32,
    /// Face of the second body's mesh.
    pub b: u32,
    /// One end of the common segment in the world.
    pub start: Vec3,
    /// The other end; equal to `start` if they touch in a point. For coplanar faces the longest diagonal.
    pub end: Vec3,
}

/// A body that reaches into a half-space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneContact {
    /// The body.
    pub body: u32,
    /// Index of the half-space.
    pub plane: u32,
    /// Mean of the vertices inside, weighted by depth, in the world.
    pub point: Vec3,
    /// Unit vector from the body into the half-space.
    pub normal: Vec3,
    /// How far the deepest vertex is inside, metres.
    pub depth: f32,
    /// Where its points start in [`Contacts::points`].
    pub first_point: u32,
    /// How many there are.
    pub point_count: u32,
    /// As that of a [`TouchingPair`].
    pub impulse: f32,
}

/// A change of velocity, linear and angular.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impulse {
    /// m/s.
    pub linear: Vec3,
    /// rad/s, world axes.
    pub angular: Vec3,
}

impl StepState {
    /// How much the step found.
    pub fn counts(&self) -> Counts {
        Counts {
            sphere_pairs: self.sphere_pairs.len(),
            approximate_pairs: self.approximate_pairs,
            touching_pairs: self.contacts.pairs.len(),
            triangle_tests: self.contacts.triangle_tests,
            face_pairs: self.contacts.faces.len(),
            contact_points: self.manifolds.points.len(),
            asleep: self.asleep.iter().filter(|&&asleep| asleep).count(),
        }
    }
}

impl Contacts {
    /// The intersecting faces of one of [`Contacts::pairs`].
    pub fn faces_of(&self, pair: &TouchingPair) -> &[FacePair] {
        let first = pair.first_face as usize;
        &self.faces[first..first + pair.face_count as usize]
    }

    /// The points of one of [`Contacts::pairs`].
    pub fn points_of(&self, pair: &TouchingPair) -> &[ContactPoint] {
        self.points_from(pair.first_point, pair.point_count)
    }

    /// The points of one of [`Contacts::planes`].
    pub fn points_on(&self, plane: &PlaneContact) -> &[ContactPoint] {
        self.points_from(plane.first_point, plane.point_count)
    }

    fn points_from(&self, first: u32, count: u32) -> &[ContactPoint] {
        &self.points[first as usize..(first + count) as usize]
    }
}

impl NearPair {
    /// Whether a support plane separates the two: they are listed for the margin between them.
    pub fn is_apart(&self) -> bool {
        self.a_below < self.b_above
    }

    /// Whether some triangles are left out although they may touch.
    pub fn is_approximate(&self) -> bool {
        self.views != [View::All; 2]
    }
}

impl Body {
    /// A body that no one moves, at `position`.
    pub fn at_rest(mesh: u32, position: Vec3, rotation: Quat, scale: Vec3) -> Self {
        Self {
            mesh,
            kind: RigidBody::Dynamic,
            position,
            rotation,
            scale,
            linear_velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            mass: None,
            density: 1.0,
            inertia: None,
            restitution: 0.0,
            gravity_scale: 1.0,
            layers: CollisionLayers::default(),
            sensor: false,
            culling: Culling::Exact,
            handling: Handling::default(),
        }
    }

    /// Where it is and how it moves.
    pub fn motion(&self) -> Motion {
        Motion {
            position: self.position,
            rotation: self.rotation,
            linear_velocity: self.linear_velocity,
            angular_velocity: self.angular_velocity,
        }
    }
}
