//! [`PhysicsStepsPlugin`]: several steps of Avian where there was one.

use avian3d::dynamics::integrator::VelocityIntegrationData;
use avian3d::dynamics::rigid_body::forces::AccumulatedLocalAcceleration;
use avian3d::math::Vector;
use avian3d::prelude::*;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use std::time::Duration;

/// How many steps Avian runs in each run of the schedule it is in. The time is shared out evenly.
///
/// Avian looks for contacts once in each step, and its substeps work with those. Chains, and all that swings around its
/// contacts, need them more often: two steps of three substeps hold a chain of 50 rings that one step of six lets go.
///
/// ```
/// # use avian3d::prelude::*;
/// # use avian_faceoff::prelude::*;
/// # use bevy::prelude::*;
/// # fn add(app: &mut App) {
/// app.add_plugins((PhysicsPlugins::default().with_exact_meshes(), PhysicsStepsPlugin::new(2)))
///     .insert_resource(SubstepCount(3));
/// # }
/// ```
///
/// All of [`PhysicsSchedule`] runs as often, with the systems that you have added to it. Forces that are applied for a
/// step ([`Forces`]) act in all of them. Hooks and collision events see each of them.
pub struct PhysicsStepsPlugin {
    steps: u32,
    schedule: Interned<dyn ScheduleLabel>,
}

/// The number of steps; see [`PhysicsStepsPlugin`]. 0 counts as 1.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Resource, Debug, PartialEq)]
pub struct PhysicsSteps(pub u32);

impl PhysicsStepsPlugin {
    /// For Avian in `FixedPostUpdate`, where it is by default.
    pub fn new(steps: u32) -> Self {
        Self::in_schedule(FixedPostUpdate, steps)
    }

    /// For Avian in another schedule.
    pub fn in_schedule(schedule: impl ScheduleLabel, steps: u32) -> Self {
        Self {
            steps,
            schedule: schedule.intern(),
        }
    }
}

impl Plugin for PhysicsStepsPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(PhysicsSteps(self.steps))
            .init_resource::<Shared>()
            .register_type::<PhysicsSteps>()
            .add_systems(
                self.schedule,
                (
                    begin
                        .after(PhysicsSystems::Prepare)
                        .before(PhysicsSystems::StepSimulation),
                    run_the_rest
                        .after(PhysicsSystems::StepSimulation)
                        .before(PhysicsSystems::Writeback),
                ),
            );
    }
}

/// What the steps of one run share.
#[derive(Resource, Default)]
struct Shared {
    /// The clock before the steps.
    clock: Time<Physics>,
    /// Accelerations that a step would use up.
    accelerations: Vec<(Entity, [Vector; 2], AccumulatedLocalAcceleration)>,
}

/// Lets Avian's own step take its part of the time only.
fn begin(
    steps: Res<PhysicsSteps>,
    mut clock: ResMut<Time<Physics>>,
    mut shared: ResMut<Shared>,
    bodies: Query<(Entity, &VelocityIntegrationData, &AccumulatedLocalAcceleration)>,
) {
    shared.clock = *clock;
    shared.accelerations.clear();
    if steps.0 > 1 {
        let speed = clock.relative_speed_f64() / f64::from(steps.0);
        clock.set_relative_speed_f64(speed);
        shared
            .accelerations
            .extend(bodies.iter().filter_map(|(entity, world, local)| {
                let both = [world.linear_increment, world.angular_increment];
                let acts = both != [Vector::ZERO; 2] || (local.linear, local.angular) != (Vector::ZERO, Vector::ZERO);
                acts.then(|| (entity, both, local.clone()))
            }));
    }
}

/// Runs the other steps.
fn run_the_rest(world: &mut World) {
    let PhysicsSteps(steps) = *world.resource();
    if steps <= 1 {
        return;
    }
    let shared = std::mem::take(&mut *world.resource_mut::<Shared>());
    let mut clock = world.resource_mut::<Time<Physics>>();
    clock.set_relative_speed_f64(shared.clock.relative_speed_f64());
    // A clock that stands still has run no step.
    let step = clock.delta();
    if !clock.is_paused() && step > Duration::ZERO {
        let outer = *world.resource::<Time>();
        for _ in 1..steps {
            for (entity, [linear, angular], local) in &shared.accelerations {
                let Ok(mut body) = world.get_entity_mut(*entity) else {
                    continue;
                };
                if let Some(mut forces) = body.get_mut::<VelocityIntegrationData>() {
                    forces.linear_increment += *linear;
                    forces.angular_increment += *angular;
                }
                if let Some(mut forces) = body.get_mut::<AccumulatedLocalAcceleration>() {
                    forces.clone_from(local);
                }
            }
            let substeps = world.resource::<SubstepCount>().0.max(1);
            world.resource_mut::<Time<Physics>>().advance_by(step);
            world.resource_mut::<Time<Substeps>>().advance_by(step / substeps);
            *world.resource_mut::<Time>() = world.resource::<Time<Physics>>().as_generic();
            world.run_schedule(PhysicsSchedule);
        }
        *world.resource_mut::<Time>() = outer;
        // The clock is set as after one step of the whole time.
        let mut clock = world.resource_mut::<Time<Physics>>();
        let context = *clock.context();
        *clock = shared.clock;
        *clock.context_mut() = context;
        clock.advance_by(step * steps);
    }
    *world.resource_mut::<Shared>() = shared;
}
