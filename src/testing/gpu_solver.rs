//! The solver on the GPU by itself: bodies and contacts in, motions and impulses out.

use crate::gpu::buffers::{TooLarge, buffers};
use crate::gpu::commands::Commands;
use crate::gpu::device::Gpu;
use crate::gpu::layout::{CONTACT_COUNTERS, CONTACT_PAIRS, CONTACT_POINTS, ContactPair, ContactPoint};
use crate::gpu::program::{Calls, Program};
use crate::gpu::readback::{DeviceError, read_words, scoped};
use crate::manifolds::Manifolds;
use crate::sleep;
use crate::solver::gpu as solver;
use crate::solver::gpu::arguments::record_arguments;
use crate::solver::gpu::layout::{self, COUNTERS, PAIRS_FOUND, POINTS, POINTS_FOUND, SKIPPED, SLOTS};
use crate::solver::gpu::record::record;
use crate::solver::gpu::{SolverBuffers, SolverCapacity, upload};
use crate::solver::{CollisionSubstep, SleepState, SolverBodies, SolverMotion};
use crate::step::gpu::StepError;
use crate::step::gpu::record::all_modules;
use crate::types::solver_settings::SolverSettings;
use crate::types::stage::Stage;
use bytemuck::{Pod, cast_slice};
use std::collections::HashMap;
use wgpu::Buffer;

/// Solves contacts on the GPU. Bodies and saved impulses stay on the device between collision substeps. Lists grow as
/// needed.
pub struct GpuSolver {
    gpu: Gpu,
    handed: Handed,
    lists: SolverBuffers,
    /// Programs for the current buffers, by whether bodies may fall asleep.
    programs: HashMap<bool, Program>,
    /// Number of dispatches in the last collision substep.
    dispatches: usize,
    bodies: u32,
    /// Number of bodies in the last collision substep; 0 after [`GpuSolver::forget`].
    old_bodies: u32,
    /// The host has written the new numbers of bodies.
    remapped: bool,
}

buffers! {
    /// Input buffers.
    Handed(SolverCapacity), |capacity| {
        solver_bodies: ARRAY layout::SolverBody, capacity.bodies, "solver bodies";
        motion_states: ARRAY layout::MotionState, capacity.bodies, "motion states";
        forces: ARRAY layout::BodyForces, capacity.bodies, "forces";
        /// All have the first one.
        body_paces: ARRAY u32, capacity.bodies, "paces of bodies";
        new_numbers: ARRAY u32, capacity.bodies, "new numbers of bodies";
        contact_pairs: ARRAY ContactPair, capacity.pairs, "contact pairs";
        contact_points: ARRAY ContactPoint, capacity.points, "contact points";
        contact_counters: ARRAY u32, CONTACT_COUNTERS, "contact counters";
        status: ARRAY u32, 4u32, "status";
        solver_arguments: INDIRECT u32, 3 * SLOTS, "arguments";
    }
}

impl GpuSolver {
    /// Compiles the kernels that the device does not have yet, and creates buffers for a small scene.
    ///
    /// # Errors
    /// If the device cannot run them.
    pub fn new(gpu: &Gpu) -> Result<Self, StepError> {
        let capacity = SolverCapacity {
            bodies: 256,
            pairs: 1024,
            points: 4096,
        };
        Self::with_capacity(gpu, capacity)
    }

    /// With this initial capacity. Results do not depend on it.
    ///
    /// # Errors
    /// If the device cannot run them.
    pub fn with_capacity(gpu: &Gpu, capacity: SolverCapacity) -> Result<Self, StepError> {
        let shaders = [&crate::gpu::SHADERS, &solver::SHADERS, &sleep::gpu::SHADERS];
        let all = shaders.into_iter().flat_map(|shaders| shaders.kernels.iter().copied());
        device(gpu.compile(all_modules(), all))?;
        let made = scoped(gpu, || {
            Ok::<_, TooLarge>((Handed::new(gpu, capacity)?, SolverBuffers::new(gpu, capacity)?))
        });
        let (handed, lists) = device(made)??;
        Ok(Self {
            gpu: gpu.clone(),
            handed,
            lists,
            programs: HashMap::new(),
            dispatches: 0,
            bodies: 0,
            old_bodies: 0,
            remapped: false,
        })
    }

    /// Capacity of the solver's own lists.
    pub fn capacity(&self) -> SolverCapacity {
        self.lists.capacity
    }

    /// Number of dispatches in the last collision substep.
    pub fn dispatches(&self) -> usize {
        self.dispatches
    }

    /// Writes the bodies: properties, poses, velocities, forces and sleep states. They keep their numbers unless
    /// [`GpuSolver::renumber`] is called.
    ///
    /// # Errors
    /// If they do not fit, or the device fails.
    pub fn put_bodies(&mut self, bodies: &SolverBodies) -> Result<(), StepError> {
        self.bodies = bodies.len() as u32;
        self.reserve(SolverCapacity {
            bodies: self.bodies,
            ..SolverCapacity::default()
        })?;
        let own = upload::bodies(bodies);
        let states = bodies.motions.iter().zip(&bodies.sleep).zip(&bodies.keys);
        let states: Vec<_> = states
            .map(|((m, s), k)| upload::state(m, s, sleep::cpu::hash(*k)))
            .collect();
        let forces: Vec<_> = bodies.forces.iter().map(upload::forces).collect();
        self.write(&[
            (&self.handed.solver_bodies, cast_slice(&own)),
            (&self.handed.motion_states, cast_slice(&states)),
            (&self.handed.forces, cast_slice(&forces)),
        ])
    }

    /// Sets the new number of each body of the last collision substep; `u32::MAX` for those that are gone.
    ///
    /// # Errors
    /// If the device fails.
    pub fn renumber(&mut self, new_numbers: &[u32]) -> Result<(), StepError> {
        self.old_bodies = self.old_bodies.min(new_numbers.len() as u32);
        self.remapped = true;
        let known = &new_numbers[..self.old_bodies as usize];
        self.write(&[(&self.handed.new_numbers, cast_slice(known))])
    }

    /// Writes the contact points of the next collision substep.
    ///
    /// # Errors
    /// If they do not fit, or the device fails.
    pub fn put_contacts(&mut self, manifolds: &Manifolds) -> Result<(), StepError> {
        let pairs: Vec<_> = manifolds.pairs.iter().map(upload::contact_pair).collect();
        let points: Vec<_> = manifolds.points.iter().map(upload::contact_point).collect();
        let mut counters = [0; CONTACT_COUNTERS as usize];
        counters[CONTACT_PAIRS as usize] = pairs.len() as u32;
        counters[CONTACT_POINTS as usize] = points.len() as u32;
        let needed = SolverCapacity {
            bodies: 0,
            pairs: pairs.len() as u32,
            points: points.len() as u32,
        };
        let grown = self.handed.capacity.grown(needed);
        if grown != self.handed.capacity {
            self.make_inputs(grown)?;
        }
        self.write(&[
            (&self.handed.contact_pairs, cast_slice(&pairs)),
            (&self.handed.contact_points, cast_slice(&points)),
            (&self.handed.contact_counters, cast_slice(&counters)),
        ])
    }

    /// Moves the bodies over one collision substep. If the solver's own lists overflow, nothing moves; they are made
    /// longer, and the collision substep is repeated.
    ///
    /// # Errors
    /// If the device cannot hold the lists, or fails.
    pub fn run(&mut self, settings: &SolverSettings, collision_substep: &CollisionSubstep) -> Result<(), StepError> {
        if !self.remapped {
            let same: Vec<u32> = (0..self.old_bodies).collect();
            self.write(&[(&self.handed.new_numbers, cast_slice(&same))])?;
        }
        let mut counters = self.launch(settings, collision_substep)?;
        if counters[SKIPPED as usize] != 0 {
            self.reserve(SolverCapacity {
                bodies: 0,
                pairs: counters[PAIRS_FOUND as usize],
                points: counters[POINTS_FOUND as usize],
            })?;
            counters = self.launch(settings, collision_substep)?;
        }
        if counters[SKIPPED as usize] != 0 {
            return Err(StepError::Device(DeviceError::failed("lists stay too short")));
        }
        self.old_bodies = self.bodies;
        self.remapped = false;
        Ok(())
    }

    /// Forgets all saved impulses.
    ///
    /// # Errors
    /// If the device fails.
    pub fn forget(&mut self) -> Result<(), StepError> {
        self.old_bodies = 0;
        self.write(&[(&self.lists.solver_counters, cast_slice(&[0u32; COUNTERS as usize]))])
    }

    /// Poses and velocities of the bodies.
    ///
    /// # Errors
    /// If the device fails.
    pub fn motions(&self) -> Result<Vec<SolverMotion>, StepError> {
        let states: Vec<layout::MotionState> = self.read(&self.handed.motion_states, self.bodies)?;
        Ok(states.iter().map(SolverMotion::from).collect())
    }

    /// Sleep states of the bodies.
    ///
    /// # Errors
    /// If the device fails.
    pub fn sleep(&self) -> Result<Vec<SleepState>, StepError> {
        let states: Vec<layout::MotionState> = self.read(&self.handed.motion_states, self.bodies)?;
        Ok(states.iter().map(SleepState::from).collect())
    }

    /// The total normal impulse of each contact point over the last collision substep, newton seconds.
    ///
    /// # Errors
    /// If the device fails.
    pub fn impulses(&self) -> Result<Vec<f32>, StepError> {
        let counters: Vec<u32> = self.read(&self.lists.solver_counters, COUNTERS)?;
        let points: Vec<layout::PointState> = self.read(&self.lists.point_states, counters[POINTS as usize])?;
        Ok(points
            .iter()
            .map(|p| p.total_normal_impulse + p.normal_impulse)
            .collect())
    }

    /// Submits a collision substep, waits for it, and returns the counters.
    fn launch(
        &mut self,
        settings: &SolverSettings,
        collision_substep: &CollisionSubstep,
    ) -> Result<Vec<u32>, StepError> {
        let may_sleep = settings.sleeping;
        let packed = upload::collision_substep(
            settings,
            collision_substep.gravity,
            1,
            [self.bodies, self.old_bodies],
            self.lists.capacity,
        );
        let pace = upload::pace(settings, collision_substep.pace());
        let Self {
            gpu,
            handed,
            lists,
            programs,
            dispatches,
            ..
        } = self;
        device(scoped(gpu, || {
            let program = programs.entry(may_sleep).or_insert_with(|| {
                let mut calls = Calls::new(STAGE);
                record_arguments(&mut calls);
                sleep::gpu::record_wake(&mut calls, may_sleep);
                record(&mut calls, &lists.capacity);
                sleep::gpu::record_fall_asleep(&mut calls, may_sleep);
                Program::new(gpu, &calls, &[handed, lists])
            });
            gpu.queue
                .write_buffer(&lists.collision_substep, 0, bytemuck::bytes_of(&packed));
            gpu.queue.write_buffer(&lists.paces, 0, bytemuck::bytes_of(&pace));
            gpu.queue.write_buffer(&handed.status, 0, &[0; 16]);
            let mut commands = Commands::new(gpu, "test");
            program.record(STAGE, &mut commands, packed.bodies.into(), None);
            *dispatches = commands.submit().1.dispatches as usize;
        }))?;
        self.read(&self.lists.solver_counters, COUNTERS)
    }

    /// Makes the solver's lists longer where needed. Saved impulses are copied.
    fn reserve(&mut self, needed: SolverCapacity) -> Result<(), StepError> {
        let grown = self.lists.capacity.grown(needed);
        if grown != self.lists.capacity {
            let Self { gpu, lists, .. } = self;
            let larger = scoped(gpu, || {
                let larger = SolverBuffers::new(gpu, grown)?;
                copy_all(
                    gpu,
                    [
                        (&lists.solver_counters, &larger.solver_counters),
                        (&lists.saved_pairs, &larger.saved_pairs),
                        (&lists.saved_points, &larger.saved_points),
                    ],
                );
                Ok::<_, TooLarge>(larger)
            });
            self.lists = device(larger)??;
            self.programs.clear();
        }
        let bodies = SolverCapacity {
            bodies: needed.bodies,
            ..SolverCapacity::default()
        };
        let grown = self.handed.capacity.grown(bodies);
        if grown != self.handed.capacity {
            self.make_inputs(grown)?;
        }
        Ok(())
    }

    /// Makes longer input lists. Bodies are copied.
    fn make_inputs(&mut self, capacity: SolverCapacity) -> Result<(), StepError> {
        let Self { gpu, handed, .. } = self;
        let larger = scoped(gpu, || {
            let larger = Handed::new(gpu, capacity)?;
            copy_all(
                gpu,
                [
                    (&handed.solver_bodies, &larger.solver_bodies),
                    (&handed.motion_states, &larger.motion_states),
                    (&handed.forces, &larger.forces),
                    (&handed.new_numbers, &larger.new_numbers),
                ],
            );
            Ok::<_, TooLarge>(larger)
        });
        self.handed = device(larger)??;
        self.programs.clear();
        Ok(())
    }

    fn write(&self, parts: &[(&Buffer, &[u8])]) -> Result<(), StepError> {
        device(scoped(&self.gpu, || {
            for (buffer, bytes) in parts {
                self.gpu.queue.write_buffer(buffer, 0, bytes);
            }
        }))
    }

    fn read<T: Pod>(&self, buffer: &Buffer, count: u32) -> Result<Vec<T>, StepError> {
        let words = device(read_words(&self.gpu, buffer, count as usize * size_of::<T>() / 4))?;
        Ok(bytemuck::pod_collect_to_vec(&words))
    }
}

/// The stage under which the calls are recorded.
const STAGE: Stage = Stage::Integrate;

fn device<T>(result: Result<T, DeviceError>) -> Result<T, StepError> {
    result.map_err(StepError::Device)
}

/// Copies each list to the start of a longer one.
fn copy_all<const N: usize>(gpu: &Gpu, lists: [(&Buffer, &Buffer); N]) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for (short, long) in lists {
        encoder.copy_buffer_to_buffer(short, 0, long, 0, short.size().min(long.size()));
    }
    gpu.queue.submit([encoder.finish()]);
}
