//! The solver on a device in the worlds of the physical tests.

use super::world::{ContactSolver, with_solver};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::Manifolds;
use bevy_faceoff::solver::{CollisionSubstep, SolverBodies};
use bevy_faceoff::testing::gpu_solver::GpuSolver;
use bevy_faceoff::types::solver_settings::SolverSettings;
use glam::Vec3;

/// Bodies go to the device before each collision substep, and come back after it. Saved impulses stay there.
struct OnDevice {
    solver: GpuSolver,
    /// Keys of the bodies of the last collision substep.
    keys: Vec<u64>,
}

impl ContactSolver for OnDevice {
    fn solve(
        &mut self,
        bodies: &mut SolverBodies,
        manifolds: &Manifolds,
        settings: &SolverSettings,
        collision_substep: &CollisionSubstep,
    ) {
        self.solver.put_bodies(bodies).unwrap();
        if self.keys != bodies.keys {
            let number = |key: &u64| bodies.keys.iter().position(|other| other == key);
            let new_numbers: Vec<u32> = self
                .keys
                .iter()
                .map(|key| number(key).map_or(u32::MAX, |i| i as u32))
                .collect();
            self.solver.renumber(&new_numbers).unwrap();
            self.keys.clone_from(&bodies.keys);
        }
        self.solver.put_contacts(manifolds).unwrap();
        self.solver.run(settings, collision_substep).unwrap();
        bodies.motions = self.solver.motions().unwrap();
        bodies.sleep = self.solver.sleep().unwrap();
        for (forces, sleep) in bodies.forces.iter_mut().zip(&bodies.sleep) {
            // They have acted.
            if !sleep.asleep {
                forces.impulse = Vec3::ZERO;
                forces.angular_impulse = Vec3::ZERO;
            }
        }
    }

    fn forget(&mut self) {
        self.solver.forget().unwrap();
    }

    fn impulses(&self, points: usize) -> Vec<f32> {
        self.solver.impulses().unwrap()[..points].to_vec()
    }
}

/// Runs a test of the solver on the device.
pub fn run(gpu: &Gpu, test: fn()) {
    let gpu = gpu.clone();
    let make = move || {
        let solver = GpuSolver::new(&gpu).unwrap();
        Box::new(OnDevice {
            solver,
            keys: Vec::new(),
        }) as Box<dyn ContactSolver>
    };
    with_solver(make, test);
}
