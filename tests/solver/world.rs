//! A world of spheres, boxes and planes, and measurements of it.

use super::shapes::{self, Shape};
use bevy_faceoff::manifolds::{Manifold, Manifolds};
use bevy_faceoff::sleep::cpu::Sleeper;
use bevy_faceoff::solver::speeds::Speeds;
use bevy_faceoff::solver::*;
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::solver_settings::SolverSettings;
use glam::{DQuat, DVec3, Vec3};
use std::cell::RefCell;
use std::rc::Rc;

/// The solver under test, with its memory. It wakes bodies, moves them over a collision substep, and puts them to
/// sleep.
pub trait ContactSolver: Send {
    fn solve(
        &mut self,
        bodies: &mut SolverBodies,
        manifolds: &Manifolds,
        settings: &SolverSettings,
        collision_substep: &CollisionSubstep,
    );

    /// Forgets the impulses of the last collision substep.
    fn forget(&mut self);

    /// Number of pairs whose impulses it remembers, if it tells.
    fn saved_pairs(&self) -> Option<usize> {
        None
    }

    /// The impulse of each contact point over the last collision substep, newton seconds.
    fn impulses(&self, points: usize) -> Vec<f32>;
}

/// The solver on the CPU.
#[derive(Default)]
pub struct OnCpu {
    pub solver: Solver,
    pub warm: WarmStart,
    pub sleeper: Sleeper,
}

impl ContactSolver for OnCpu {
    fn solve(
        &mut self,
        bodies: &mut SolverBodies,
        manifolds: &Manifolds,
        settings: &SolverSettings,
        collision_substep: &CollisionSubstep,
    ) {
        let Self { solver, warm, sleeper } = self;
        sleeper.wake(bodies, manifolds, settings, collision_substep);
        solver.solve(bodies, manifolds, warm, settings, collision_substep);
        sleeper.settle(bodies, manifolds, settings, collision_substep.dt);
    }

    fn forget(&mut self) {
        self.warm.clear();
    }

    fn saved_pairs(&self) -> Option<usize> {
        Some(self.warm.pairs())
    }

    fn impulses(&self, points: usize) -> Vec<f32> {
        (0..points).map(|point| self.solver.impulse_of(point)).collect()
    }
}

type MakeSolver = Rc<dyn Fn() -> Box<dyn ContactSolver>>;

thread_local! {
    static MAKE_SOLVER: RefCell<MakeSolver> = RefCell::new(Rc::new(|| Box::new(OnCpu::default())));
}

/// Runs a test whose worlds have this solver.
#[allow(dead_code, reason = "the tests on a device call it")]
pub fn with_solver(make: impl Fn() -> Box<dyn ContactSolver> + 'static, test: impl FnOnce()) {
    let before = MAKE_SOLVER.replace(Rc::new(make));
    test();
    MAKE_SOLVER.set(before);
}

pub struct World {
    pub bodies: SolverBodies,
    pub shapes: Vec<Shape>,
    pub manifolds: Manifolds,
    pub solver: Box<dyn ContactSolver>,
    pub settings: SolverSettings,
    pub gravity: Vec3,
    pub dt: f32,
    /// Fixed number of collision substeps per step, instead of the settings' rule.
    pub collision_substeps: Option<u32>,
    pub time_solving: std::time::Duration,
}

impl World {
    /// Without gravity and without sleep.
    pub fn new() -> Self {
        Self {
            bodies: SolverBodies::default(),
            shapes: Vec::new(),
            manifolds: Manifolds::default(),
            solver: MAKE_SOLVER.with_borrow(|make| make()),
            settings: SolverSettings {
                sleeping: false,
                ..SolverSettings::default()
            },
            gravity: Vec3::ZERO,
            dt: 1.0 / 64.0,
            collision_substeps: None,
            time_solving: std::time::Duration::ZERO,
        }
    }

    pub fn heavy() -> Self {
        Self {
            gravity: Vec3::NEG_Y * 9.81,
            ..Self::new()
        }
    }

    pub fn add(&mut self, shape: Shape, body: SolverBody, motion: SolverMotion) -> usize {
        let key = 1000 + 7 * self.shapes.len() as u64;
        self.shapes.push(shape);
        let body = SolverBody {
            thickness: shape.thickness(),
            ..body
        };
        self.bodies.push(key, body, motion) as usize
    }

    pub fn dynamic(&mut self, shape: Shape, mass: f32, center: DVec3) -> usize {
        let body = SolverBody::dynamic(mass, shape.inertia(mass), shape.radius());
        self.add(shape, body, SolverMotion::at(center))
    }

    pub fn immovable(&mut self, shape: Shape, kind: RigidBody, center: DVec3) -> usize {
        let body = SolverBody::immovable(kind, shape.radius());
        self.add(shape, body, SolverMotion::at(center))
    }

    /// The static half-space below a plane through the origin, inclined about z.
    pub fn floor(&mut self, slope: f64) -> usize {
        let floor = self.immovable(Shape::Plane, RigidBody::Static, DVec3::ZERO);
        self.bodies.motions[floor].rotation = DQuat::from_rotation_z(slope);
        floor
    }

    pub fn motion(&mut self, i: usize) -> &mut SolverMotion {
        &mut self.bodies.motions[i]
    }

    pub fn center(&self, i: usize) -> DVec3 {
        self.bodies.motions[i].center
    }

    pub fn velocity(&self, i: usize) -> Vec3 {
        self.bodies.motions[i].linear_velocity
    }

    pub fn spin(&self, i: usize) -> Vec3 {
        self.bodies.motions[i].angular_velocity
    }

    pub fn step(&mut self, count: usize) {
        for _ in 0..count {
            let collision_substeps = self.collision_substeps.unwrap_or_else(|| {
                Speeds::of(&self.bodies, self.dt, |_| false).collision_substeps(&self.settings, &self.bodies, self.dt)
            });
            let collision_substep = CollisionSubstep {
                dt: self.dt / collision_substeps as f32,
                substeps: self.settings.substeps_per_collision_substep(collision_substeps),
                gravity: self.gravity,
            };
            for _ in 0..collision_substeps {
                self.detect(collision_substep.dt);
                self.solve(&collision_substep);
            }
        }
    }

    /// One collision substep with the present manifolds.
    pub fn solve(&mut self, collision_substep: &CollisionSubstep) {
        let start = std::time::Instant::now();
        self.solver
            .solve(&mut self.bodies, &self.manifolds, &self.settings, collision_substep);
        self.time_solving += start.elapsed();
    }

    pub fn seconds(&mut self, seconds: f32) {
        self.step((seconds / self.dt).round() as usize);
    }

    pub fn detect(&mut self, dt: f32) {
        let manifolds = &mut self.manifolds;
        manifolds.pairs.clear();
        manifolds.points.clear();
        for a in 0..self.shapes.len() {
            for b in a + 1..self.shapes.len() {
                let ends = [a, b];
                let [one, other] = ends.map(|i| &self.bodies.bodies[i]);
                if one.kind != RigidBody::Dynamic && other.kind != RigidBody::Dynamic {
                    continue;
                }
                let motions = ends.map(|i| &self.bodies.motions[i]);
                let speed = (motions[1].linear_velocity - motions[0].linear_velocity).length()
                    + ends
                        .map(|i| {
                            self.bodies.motions[i].angular_velocity.length() * self.bodies.bodies[i].radius.min(9.0)
                        })
                        .iter()
                        .sum::<f32>();
                let diameter = 2.0 * one.radius.min(other.radius);
                let fall = self.gravity.length() * dt;
                let margin = (0.01 * diameter + 1.5 * (speed + fall) * dt) as f64;
                let apart = motions[0].center.distance(motions[1].center);
                if apart > (one.radius + other.radius) as f64 + margin {
                    continue;
                }
                let points = shapes::contact(ends.map(|i| self.shapes[i]), motions, margin);
                if points.is_empty() {
                    continue;
                }
                manifolds.pairs.push(Manifold {
                    bodies: ends.map(|i| i as u32),
                    first_point: manifolds.points.len() as u32,
                    point_count: points.len() as u32,
                });
                manifolds.points.extend(points);
            }
        }
    }

    /// The deepest overlap of any two bodies, metres; negative for a gap.
    pub fn deepest(&mut self) -> f32 {
        self.detect(0.0);
        let points = &self.manifolds.points;
        points.iter().map(|p| -p.separation).fold(f32::NEG_INFINITY, f32::max)
    }

    pub fn measure(&self) -> Momenta {
        let mut sum = Momenta::default();
        for i in 0..self.shapes.len() {
            let (body, motion) = (&self.bodies.bodies[i], &self.bodies.motions[i]);
            if body.kind != RigidBody::Dynamic {
                continue;
            }
            let mass = 1.0 / body.inverse_mass as f64;
            let (v, w) = (motion.linear_velocity.as_dvec3(), motion.angular_velocity.as_dvec3());
            let own = motion.rotation.conjugate() * w;
            let spin = body.inverse_inertia.as_dmat3().inverse() * own;
            sum.linear += mass * v;
            sum.angular += motion.center.cross(mass * v) + motion.rotation * spin;
            sum.kinetic += 0.5 * mass * v.length_squared() + 0.5 * own.dot(spin);
            sum.size += mass * v.length();
        }
        sum
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub struct Momenta {
    pub linear: DVec3,
    /// About the origin.
    pub angular: DVec3,
    pub kinetic: f64,
    /// The sum of the magnitudes of the linear momenta.
    pub size: f64,
}

/// Prints the measured value (see `--nocapture`), and fails if it is not within the tolerance.
#[track_caller]
pub fn check(what: &str, found: f64, wanted: f64, tolerance: f64) {
    let error = found - wanted;
    println!("{what}: {found:.6}, wanted {wanted:.6}, off by {error:.2e} (allowed {tolerance:.1e})");
    assert!(
        error.abs() <= tolerance,
        "{what}: {found} instead of {wanted} +- {tolerance}"
    );
}

#[track_caller]
pub fn check_below(what: &str, found: f64, limit: f64) {
    println!("{what}: {found:.3e} (limit {limit:.1e})");
    assert!(found <= limit, "{what}: {found} is over {limit}");
}
