//! The solver's bodies: properties, motion, external forces and sleep state.
//!
//! There is an entry for each collider. A body has the number of its first collider, and its motion, mass, forces and
//! sleep state are in that entry. Manifolds name colliders.

use crate::state::part_index::PartIndex;
use crate::state::revision::Revision;
use crate::types::body::{ExternalForces, LockedAxes, RigidBody};
use crate::types::material::CombineRule;
use glam::{DQuat, DVec3, Mat3, Vec3};

/// Properties of a body, constant within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverBody {
    /// Static, kinematic or dynamic.
    pub kind: RigidBody,
    /// 1/kg. A dynamic body whose value is not positive and finite moves as a kinematic one.
    pub inverse_mass: f32,
    /// Inverse mass that a kinematic body would have if contacts moved it, 1/kg; 0 if it is not known, or static.
    pub own_inverse_mass: f32,
    /// In the body's own axes, 1/(kg m^2). Zero for bodies that no moment rotates.
    pub inverse_inertia: Mat3,
    /// Radius of the collider's bounding sphere, metres.
    pub radius: f32,
    /// Distance of the body's farthest point from its centre of mass, metres.
    pub extent: f32,
    /// Thickness of its thinnest part, metres; infinite for a plane.
    pub thickness: f32,
    /// Coefficient of restitution: outgoing over incoming normal speed, 0 to 1.
    pub restitution: f32,
    /// How the coefficients of both bodies combine.
    pub restitution_combine: CombineRule,
    /// Coulomb's coefficient of friction, 0 or more, both static and dynamic.
    pub friction: f32,
    /// How the coefficients of both bodies combine.
    pub friction_combine: CombineRule,
    /// Factor on gravity.
    pub gravity_scale: f32,
    /// Rate at which linear velocity decays, 1/s.
    pub linear_damping: f32,
    /// Rate at which angular velocity decays, 1/s.
    pub angular_damping: f32,
    /// Largest speed of the centre of mass, m/s.
    pub max_linear_speed: f32,
    /// Largest angular speed, rad/s.
    pub max_angular_speed: f32,
    /// World axes along which it does not translate, and about which it does not rotate.
    pub locked_axes: LockedAxes,
    /// Whether contacts act on it. They do not act on sensors.
    pub solid: bool,
    /// Whether it has continuous collision detection. Its speed then causes no collision substeps.
    pub continuous: bool,
}

impl SolverBody {
    /// A body that forces and contacts move.
    pub fn dynamic(mass: f32, inertia: Mat3, radius: f32) -> Self {
        Self {
            kind: RigidBody::Dynamic,
            inverse_mass: 1.0 / mass,
            own_inverse_mass: 1.0 / mass,
            inverse_inertia: inertia.as_dmat3().inverse().as_mat3(),
            ..Self::immovable(RigidBody::Static, radius)
        }
    }

    /// A static or kinematic body, without mass.
    pub fn immovable(kind: RigidBody, radius: f32) -> Self {
        Self {
            kind,
            inverse_mass: 0.0,
            own_inverse_mass: 0.0,
            inverse_inertia: Mat3::ZERO,
            radius,
            extent: radius,
            thickness: f32::INFINITY,
            restitution: 0.0,
            restitution_combine: CombineRule::Average,
            friction: 0.5,
            friction_combine: CombineRule::Average,
            gravity_scale: 1.0,
            linear_damping: 0.0,
            angular_damping: 0.0,
            max_linear_speed: f32::INFINITY,
            max_angular_speed: f32::INFINITY,
            locked_axes: LockedAxes::NONE,
            solid: true,
            continuous: false,
        }
    }

    /// Whether it can move at all.
    pub(crate) fn moves(&self) -> bool {
        self.kind != RigidBody::Static
    }

    /// Whether it is kinematic and moves like this.
    pub(super) fn is_driven(&self, motion: &SolverMotion) -> bool {
        self.kind == RigidBody::Kinematic
            && (motion.linear_velocity, motion.angular_velocity) != (Vec3::ZERO, Vec3::ZERO)
    }

    /// Whether forces and contacts move it.
    pub(crate) fn has_mass(&self) -> bool {
        self.kind == RigidBody::Dynamic
            && self.inverse_mass > 0.0
            && self.inverse_mass.is_finite()
            && self.inverse_inertia.is_finite()
    }
}

/// Pose and velocity of a body. The pose has double precision, because small changes add up in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverMotion {
    /// Centre of mass in the world, metres.
    pub center: DVec3,
    /// From the body's axes to the world's; of unit length.
    pub rotation: DQuat,
    /// Velocity of the centre of mass, m/s.
    pub linear_velocity: Vec3,
    /// In world axes, rad/s.
    pub angular_velocity: Vec3,
}

impl SolverMotion {
    /// At rest at `center`, with the axes of the world.
    pub fn at(center: DVec3) -> Self {
        Self {
            center,
            rotation: DQuat::IDENTITY,
            linear_velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.center.is_finite()
            && self.rotation.is_finite()
            && self.linear_velocity.is_finite()
            && self.angular_velocity.is_finite()
    }
}

/// Whether a body is asleep, and how long it has been at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SleepState {
    /// Asleep: its velocity is zero and the solver treats it as static until it wakes.
    pub asleep: bool,
    /// How long it has been at rest, seconds. It stops growing when the body counts as at rest, and starts negative
    /// where that takes longer.
    pub rest_time: f32,
    /// The colliders that it touched when it fell asleep, as the sum of hashes of their keys.
    pub neighbours: u32,
    /// How far it has gone since the present half of the sleep time began.
    pub way: Way,
    /// How far it went in the half before.
    pub last_way: Way,
}

/// How far a body went and turned.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Way {
    /// Way of the centre of mass, metres.
    pub moved: Vec3,
    /// Rotation about the axes of the world, radians.
    pub turned: Vec3,
}

impl Way {
    /// How far some point of a body with this extent went, at most.
    pub(crate) fn length(&self, extent: f32) -> f32 {
        self.moved.length() + self.turned.length() * extent
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        Self {
            moved: self.moved - other.moved,
            turned: self.turned - other.turned,
        }
    }

    pub(crate) fn times(&self, factor: f32) -> Self {
        Self {
            moved: self.moved * factor,
            turned: self.turned * factor,
        }
    }

    #[cfg(feature = "bevy")]
    pub(crate) fn is_finite(&self) -> bool {
        self.moved.is_finite() && self.turned.is_finite()
    }
}

/// A collider of a body of several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SolverPart {
    /// Number of the collider.
    pub collider: u32,
    /// The number of its body.
    pub body: u32,
    /// From the body's centre of mass to the collider's, in the body's axes, metres.
    pub offset: DVec3,
}

/// All bodies; one entry per collider in every array up to `sleep`.
#[derive(Clone, Debug, Default)]
pub struct SolverBodies {
    /// Unique key of each collider, the same in every step: an entity's bits, for example. Numbers of bodies may change
    /// from step to step.
    pub keys: Vec<u64>,
    /// Properties.
    pub bodies: Vec<SolverBody>,
    /// Poses and velocities.
    pub motions: Vec<SolverMotion>,
    /// External forces and impulses.
    pub forces: Vec<ExternalForces>,
    /// Which are asleep.
    pub sleep: Vec<SleepState>,
    /// The colliders of bodies of several, ascending.
    pub(crate) parts: Vec<SolverPart>,
    /// Finds a collider among `parts`.
    pub(super) part_index: PartIndex,
    /// Bodies that are neither static nor dormant, ascending, where `revision` is known.
    pub(super) moving: Vec<u32>,
    /// Summary of static colliders, where `revision` is known.
    pub(super) statics: Statics,
    /// Number of colliders, where `revision` is known. Planes follow.
    pub(super) colliders: usize,
    /// The state of the static bodies.
    pub(super) revision: Revision,
    /// Since the static bodies had this state none has come or gone.
    pub(super) base: Revision,
    /// Names which collider has which number.
    pub(super) layout: Revision,
    /// Summary of dormant bodies, in the set with this name.
    pub(super) dormant: Statics,
    pub(super) dormant_name: Revision,
}

/// What there is of static bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Statics {
    pub any: bool,
    pub solid: bool,
    /// The thickness of the thinnest solid one, metres.
    pub thinnest: f32,
}

impl Default for Statics {
    fn default() -> Self {
        Self {
            any: false,
            solid: false,
            thinnest: f32::INFINITY,
        }
    }
}

impl Statics {
    pub fn include(&mut self, body: &SolverBody) {
        self.any = true;
        if body.solid {
            self.solid = true;
            self.thinnest = self.thinnest.min(body.thickness);
        }
    }
}

impl SolverBodies {
    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// The acceleration of a body by the external force, m/s², and an upper bound of its angular acceleration by the
    /// external torque, rad/s².
    pub(crate) fn accelerations(&self, i: usize) -> (Vec3, f32) {
        let body = &self.bodies[i];
        self.forces[i].accelerations(body.inverse_mass, &body.inverse_inertia)
    }

    /// Whether there are no bodies.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Removes all bodies and keeps the allocations.
    pub fn clear(&mut self) {
        // Destructured, so that the compiler reports an array that is missing here.
        let Self {
            keys,
            bodies,
            motions,
            forces,
            sleep,
            parts,
            part_index,
            moving,
            statics,
            colliders,
            revision,
            base,
            layout,
            dormant,
            dormant_name,
        } = self;
        moving.clear();
        *colliders = 0;
        *statics = Statics::default();
        *revision = Revision::UNKNOWN;
        *base = Revision::UNKNOWN;
        *layout = Revision::UNKNOWN;
        *dormant = Statics::default();
        *dormant_name = Revision::UNKNOWN;
        keys.clear();
        bodies.clear();
        motions.clear();
        forces.clear();
        sleep.clear();
        parts.clear();
        part_index.clear();
    }

    /// The numbers of bodies that are neither static nor dormant, ascending.
    pub(crate) fn movers(&self) -> impl Iterator<Item = usize> + Clone + '_ {
        let (listed, all) = match self.revision.is_known() {
            true => (&self.moving[..], 0..0),
            false => (&[][..], 0..self.len()),
        };
        let moves = |&i: &usize| self.bodies[i].moves();
        listed.iter().map(|&i| i as usize).chain(all.filter(moves))
    }

    /// Calls `f` with each of [`SolverBodies::movers`].
    pub(crate) fn for_each_mover(&mut self, mut f: impl FnMut(&mut Self, usize)) {
        if self.revision.is_known() {
            let moving = std::mem::take(&mut self.moving);
            moving.iter().for_each(|&i| f(self, i as usize));
            self.moving = moving;
            return;
        }
        for i in 0..self.len() {
            if self.bodies[i].moves() {
                f(self, i);
            }
        }
    }

    /// The state of the static bodies.
    pub(crate) fn revision(&self) -> Revision {
        self.revision
    }

    /// A state of the static bodies since which none has come or gone.
    pub(super) fn base(&self) -> Revision {
        self.base
    }

    /// How many bodies are static, and come first, where their state is known.
    pub(super) fn static_count(&self) -> usize {
        self.moving.first().map_or(self.colliders, |&first| first as usize)
    }

    /// Names which collider has which number.
    pub(crate) fn layout(&self) -> Revision {
        self.layout
    }

    /// The thickness of the thinnest solid body that does not move, metres, and whether there is one.
    pub(super) fn still(&self) -> (f32, bool) {
        let statics = self.statics();
        let thinnest = statics.thinnest.min(self.dormant.thinnest);
        (thinnest, statics.solid || self.dormant.solid)
    }

    /// What there is of static bodies.
    pub(super) fn statics(&self) -> Statics {
        let (mut statics, rest) = match self.revision.is_known() {
            true => (self.statics, &self.bodies[self.colliders..]),
            false => (Statics::default(), &self.bodies[..]),
        };
        let fixed = rest.iter().filter(|body| !body.moves());
        fixed.for_each(|body| statics.include(body));
        statics
    }

    /// The number of the body of a collider.
    pub(crate) fn body_of(&self, collider: u32) -> u32 {
        self.part(collider).map_or(collider, |part| part.body)
    }

    /// From the body's centre of mass to the collider's, in world axes, metres.
    pub(super) fn offset(&self, collider: u32) -> Vec3 {
        self.part(collider).map_or(Vec3::ZERO, |part| {
            (self.motions[part.body as usize].rotation * part.offset).as_vec3()
        })
    }

    fn part(&self, collider: u32) -> Option<&SolverPart> {
        self.part_index.get(collider).map(|at| &self.parts[at])
    }

    /// Wakes the body of a collider.
    pub(crate) fn wake(&mut self, collider: u32) {
        let body = self.body_of(collider);
        self.sleep[body as usize] = SleepState::default();
        self.share_sleep();
    }

    /// Copies the sleep states of bodies to their other colliders.
    pub(crate) fn share_sleep(&mut self) {
        for part in &self.parts {
            self.sleep[part.collider as usize] = self.sleep[part.body as usize];
        }
    }

    /// Whether these are two solid colliders of different bodies with finite motions, so that there may be contacts
    /// between them.
    pub(super) fn may_touch(&self, colliders: [u32; 2]) -> bool {
        let is_valid = |collider: u32| {
            let (i, body) = (collider as usize, self.body_of(collider) as usize);
            i < self.len() && self.bodies[i].solid && self.motions[body].is_finite()
        };
        let [a, b] = colliders.map(|collider| self.body_of(collider));
        a != b && colliders.into_iter().all(is_valid)
    }

    /// Adds an awake body without external forces and returns its number.
    pub fn push(&mut self, key: u64, body: SolverBody, motion: SolverMotion) -> u32 {
        let number = self.keys.len() as u32;
        self.keys.push(key);
        self.bodies.push(body);
        self.motions.push(motion);
        self.forces.push(ExternalForces::default());
        self.sleep.push(SleepState::default());
        number
    }
}
