//! A world whose bodies live on a device, and how far two worlds are apart.

use super::world::World;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::solver::gpu::SolverCapacity;
use bevy_faceoff::solver::speeds::Speeds;
use bevy_faceoff::solver::{CollisionSubstep, SolverBodies, SolverMotion};
use bevy_faceoff::testing::gpu_solver::GpuSolver;

pub struct Twin {
    /// Its bodies are where the device says.
    pub world: World,
    pub solver: GpuSolver,
    pub time_solving: std::time::Duration,
}

impl Twin {
    pub fn new(gpu: &Gpu, world: World) -> Self {
        Self::with_solver(GpuSolver::new(gpu).unwrap(), world)
    }

    pub fn with_capacity(gpu: &Gpu, capacity: SolverCapacity, world: World) -> Self {
        Self::with_solver(GpuSolver::with_capacity(gpu, capacity).unwrap(), world)
    }

    fn with_solver(solver: GpuSolver, world: World) -> Self {
        let mut twin = Self {
            world,
            solver,
            time_solving: std::time::Duration::ZERO,
        };
        twin.put();
        twin
    }

    /// Hands the world's bodies over. Afterwards they stay on the device.
    pub fn put(&mut self) {
        self.solver.put_bodies(&self.world.bodies).unwrap();
    }

    pub fn step(&mut self, count: usize) {
        for _ in 0..count {
            let world = &mut self.world;
            let collision_substeps = world.collision_substeps.unwrap_or_else(|| {
                Speeds::of(&world.bodies, world.dt, |_| false).collision_substeps(
                    &world.settings,
                    &world.bodies,
                    world.dt,
                )
            });
            let collision_substep = CollisionSubstep {
                dt: world.dt / collision_substeps as f32,
                substeps: world.settings.substeps_per_collision_substep(collision_substeps),
                gravity: world.gravity,
            };
            for _ in 0..collision_substeps {
                self.world.detect(collision_substep.dt);
                self.solve(&collision_substep);
            }
        }
    }

    /// One collision substep with the present manifolds.
    pub fn solve(&mut self, collision_substep: &CollisionSubstep) {
        self.solver.put_contacts(&self.world.manifolds).unwrap();
        let start = std::time::Instant::now();
        self.solver.run(&self.world.settings, collision_substep).unwrap();
        self.time_solving += start.elapsed();
        self.world.bodies.motions = self.solver.motions().unwrap();
        self.world.bodies.sleep = self.solver.sleep().unwrap();
    }
}

/// Two equal worlds after `seconds`, on the CPU and on the device.
pub fn both(gpu: &Gpu, make: impl Fn() -> World, seconds: f32) -> (World, Twin) {
    let mut cpu = make();
    let mut twin = Twin::new(gpu, make());
    let steps = (seconds / cpu.dt).round() as usize;
    cpu.step(steps);
    twin.step(steps);
    (cpu, twin)
}

/// How far apart two motions are: centres, metres; rotations, radians; velocities, m/s and rad/s.
#[derive(Clone, Copy, Debug, Default)]
pub struct Apart {
    pub center: f64,
    pub turned: f64,
    pub linear: f64,
    pub angular: f64,
}

impl Apart {
    pub fn new(a: &SolverMotion, b: &SolverMotion) -> Self {
        // Not `angle_between`, which is too coarse for small angles.
        let between = a.rotation.normalize().conjugate() * b.rotation.normalize();
        Self {
            center: a.center.distance(b.center),
            turned: 2.0 * between.xyz().length(),
            linear: a.linear_velocity.distance(b.linear_velocity) as f64,
            angular: a.angular_velocity.distance(b.angular_velocity) as f64,
        }
    }

    /// The largest differences over all bodies of two worlds.
    pub fn of(a: &World, b: &World) -> Self {
        Self::between(&a.bodies, &b.bodies)
    }

    /// The largest differences over all bodies.
    pub fn between(a: &SolverBodies, b: &SolverBodies) -> Self {
        let pairs = a.motions.iter().zip(&b.motions);
        pairs.map(|(a, b)| Self::new(a, b)).fold(Self::default(), |x, y| Self {
            center: x.center.max(y.center),
            turned: x.turned.max(y.turned),
            linear: x.linear.max(y.linear),
            angular: x.angular.max(y.angular),
        })
    }

    /// Prints it, for the record, and fails if anything is over its limit.
    #[track_caller]
    pub fn check(&self, what: &str, limit: Self) {
        println!(
            "{what}: apart {:.1e} m, {:.1e} rad, {:.1e} m/s, {:.1e} rad/s",
            self.center, self.turned, self.linear, self.angular
        );
        let within = self.center <= limit.center
            && self.turned <= limit.turned
            && self.linear <= limit.linear
            && self.angular <= limit.angular;
        assert!(within, "{what}: {self:?} is over {limit:?}");
    }
}

/// One limit for all quantities.
pub fn all(limit: f64) -> Apart {
    Apart {
        center: limit,
        turned: limit,
        linear: limit,
        angular: limit,
    }
}
