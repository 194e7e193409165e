//! The plugin groups, the step's schedule and its ordered sets.

pub mod assets;
pub mod backend;
pub mod clock;
pub mod collisions;
pub mod components;
#[cfg(feature = "debug_gizmos")]
pub mod debug;
pub mod diagnostics;
pub mod events;
#[cfg(feature = "bevy_mesh")]
pub mod mesh_collider_from;
mod renderer;
pub mod settings;
pub mod snapshot;
pub(crate) mod sync;

#[cfg(feature = "gpu")]
use crate::gpu::device::Gpu;
use crate::plugin::backend::{ActiveBackend, BackendFailed, BackendReady, Engine};
use crate::plugin::clock::Physics;
use crate::plugin::collisions::{Collisions, StepReport};
use crate::plugin::components::*;
use crate::plugin::diagnostics::FaceoffDiagnosticsPlugin;
use crate::plugin::events::{BodyRejected, CollisionEnd, CollisionStart};
use crate::plugin::settings::{Backend, EventHysteresis, Gravity, Reading};
#[cfg(feature = "gpu")]
use crate::plugin::sync::latent;
use crate::plugin::sync::{Step, collect, publish};
#[cfg(feature = "gpu")]
use crate::step::gpu::Poses;
use crate::types::body::*;
use crate::types::material::{Friction, Restitution};
use crate::types::settings::{Culling, Response};
use crate::types::solver_settings::SolverSettings;
use crate::types::stage::Stage;
use bevy::app::PluginGroupBuilder;
use bevy::ecs::schedule::{LogLevel, ScheduleBuildSettings, ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;

/// Everything of bevy_faceoff, to be added after `DefaultPlugins` or whatever else brings Bevy's `AssetPlugin`.
///
/// With the feature `bevy_render` the stages share the device of the app's renderer: see [`backend`](crate::plugin::backend).
///
/// Parts can be replaced or disabled like those of any plugin group.
#[derive(Default)]
pub struct FaceoffPlugins {
    /// How the step runs.
    pub step: StepPlugin,
}

impl PluginGroup for FaceoffPlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>()
            .add(CollisionMeshPlugin)
            .add(self.step)
            .add(FaceoffDiagnosticsPlugin);
        #[cfg(feature = "bevy_mesh")]
        let group = group.add(crate::plugin::mesh_collider_from::MeshColliderFromPlugin);
        group
    }
}

/// [`FaceoffPlugins`] and `AssetPlugin`, to be added after `MinimalPlugins`: no window, no renderer, no GPU needed.
///
/// Add Bevy's `LogPlugin` too: without it nobody hears why a body is left out, or where the stages run. It is not part of this
/// group since a process has one log, and tests build many apps.
#[derive(Default)]
pub struct FaceoffHeadlessPlugins {
    /// How the step runs.
    pub step: StepPlugin,
    /// Where assets lie.
    pub assets: AssetPlugin,
}

impl PluginGroup for FaceoffHeadlessPlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(self.assets)
            .add_group(FaceoffPlugins { step: self.step })
    }
}

/// Registers [`CollisionMesh`](crate::asset::CollisionMesh) and its loader.
///
/// # Panics
/// When it is added without Bevy's `AssetPlugin` before it; the message says what to add.
pub struct CollisionMeshPlugin;

impl Plugin for CollisionMeshPlugin {
    fn build(&self, app: &mut App) {
        assert!(
            app.is_plugin_added::<AssetPlugin>(),
            "FaceoffPlugins needs Bevy's AssetPlugin: add DefaultPlugins before FaceoffPlugins, \
             or use FaceoffHeadlessPlugins, which brings it"
        );
        assets::register(app);
    }
}

/// Runs the fixed step.
#[derive(Clone, Debug, Default)]
pub struct StepPlugin {
    /// Where the stages run.
    pub backend: Backend,
    /// Threads of the CPU stages; 0 for one per core.
    pub threads: usize,
    /// When results of a GPU reach the world.
    pub reading: Reading,
}

/// The schedule of one step. Add systems around [`FaceoffSystems`] to it to see or change what passes between components and
/// stages; in it `Time` is the clock of the steps, [`Time<Physics>`](Physics).
///
/// It runs in `FixedPostUpdate`, in the system set of the same name: other systems there can be ordered before or after
/// `FaceoffStep`, and a run condition of the set decides whether there are steps at all.
///
/// To do a step by hand run it yourself, wherever and whenever: `world.run_schedule(FaceoffStep)`. Such a step is as long as the
/// fixed timestep, even if a clock is paused, and is waited for: results of a GPU are published in it, whatever the
/// [`Reading`]. While [`ActiveBackend`] has nothing to run on it does nothing.
#[derive(ScheduleLabel, SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct FaceoffStep;

/// The parts of [`FaceoffStep`], in order.
///
/// With [`Response::Contacts`] a step may consist of several detection intervals: systems between the stages run in the first
/// one, and the stages of the others in [`FaceoffSystems::Integrate`]. On a GPU all stages are one submission, made and
/// waited for in [`FaceoffSystems::BroadPhase`]; systems between them see its results.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FaceoffSystems {
    /// Copies components into the stages' arrays and leaves out what cannot be used.
    Collect,
    /// See [`broad_phase`](crate::broad_phase).
    BroadPhase,
    /// See [`angles`](crate::angles).
    Angles,
    /// See [`triangle_test`](crate::triangle_test).
    TriangleTest,
    /// See [`manifolds`](crate::manifolds).
    Manifolds,
    /// See [`force_scan`](crate::force_scan).
    ForceScan,
    /// See [`integrate`](crate::integrate).
    Integrate,
    /// Writes poses, velocities, [`Collisions`], messages and events.
    Publish,
}

impl From<Stage> for FaceoffSystems {
    fn from(stage: Stage) -> Self {
        match stage {
            Stage::BroadPhase => Self::BroadPhase,
            Stage::Angles => Self::Angles,
            Stage::TriangleTest => Self::TriangleTest,
            Stage::Manifolds => Self::Manifolds,
            Stage::ForceScan => Self::ForceScan,
            Stage::Integrate => Self::Integrate,
        }
    }
}

impl Plugin for StepPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.backend)
            .init_resource::<Culling>()
            .init_resource::<EventHysteresis>()
            .init_resource::<Gravity>()
            .init_resource::<Response>()
            .init_resource::<SolverSettings>()
            .init_resource::<Collisions>()
            .init_resource::<Time<Physics>>()
            .init_resource::<StepReport>()
            .add_message::<CollisionStart>()
            .add_message::<CollisionEnd>()
            .add_message::<BodyRejected>()
            .add_message::<BackendReady>()
            .add_message::<BackendFailed>();
        register_types(app);

        match Engine::new(self.backend, self.threads, self.reading) {
            Ok(mut engine) => {
                if !renderer::is_coming(app) {
                    engine.choose();
                }
                app.insert_resource(engine.active().clone())
                    .insert_resource(Step::new(engine));
            }
            Err(reason) => {
                error!("no collisions are found and no body moves: {reason}");
                app.insert_resource(ActiveBackend::None { reason });
                return;
            }
        }

        let mut schedule = Schedule::new(FaceoffStep);
        schedule
            .set_executor(SingleThreadedExecutor::new())
            .set_build_settings(ScheduleBuildSettings {
                ambiguity_detection: LogLevel::Warn,
                ..default()
            })
            .configure_sets(
                (
                    FaceoffSystems::Collect,
                    FaceoffSystems::BroadPhase,
                    FaceoffSystems::Angles,
                    FaceoffSystems::TriangleTest,
                    FaceoffSystems::Manifolds,
                    FaceoffSystems::ForceScan,
                    FaceoffSystems::Integrate,
                    FaceoffSystems::Publish,
                )
                    .chain(),
            )
            .add_systems((
                (get_ready.run_if(clock::is_by_hand), clock::begin)
                    .chain()
                    .before(FaceoffSystems::Collect)
                    .ambiguous_with_all(),
                collect::collect.in_set(FaceoffSystems::Collect),
                (
                    publish::use_up_impulses,
                    publish::write_back,
                    publish::publish,
                    publish::tell_failure,
                    clock::settle.run_if(clock::was_by_hand),
                )
                    .chain()
                    .in_set(FaceoffSystems::Publish),
                clock::end.after(FaceoffSystems::Publish).ambiguous_with_all(),
            ));
        for stage in Stage::ALL {
            let run = move |mut step: ResMut<Step>| {
                step.run(stage);
                if !step.engine.runs() {
                    // The device is lost, and another one has to be waited for.
                    step.forget();
                }
            };
            schedule.add_systems(run.in_set(FaceoffSystems::from(stage)));
        }
        #[cfg(feature = "gpu")]
        {
            let release = latent::release.after(collect::collect);
            schedule.add_systems(release.in_set(FaceoffSystems::Collect));
            latent::observe(app);
            let after = RunFixedMainLoopSystems::AfterFixedMainLoop;
            app.add_systems(RunFixedMainLoop, publish_while_time_stands.in_set(after));
        }
        app.add_schedule(schedule)
            .add_systems(FixedPostUpdate, run_step.in_set(FaceoffStep));
    }

    fn finish(&self, app: &mut App) {
        choose(app.world_mut());
    }
}

/// Chooses what the stages run on, if that is not done yet or Bevy's renderer has a new device.
fn choose(world: &mut World) {
    renderer::follow(world);
    let Some(mut step) = world.get_resource_mut::<Step>() else {
        return;
    };
    step.engine.choose();
    let active = world.resource::<Step>().engine.active();
    if world.resource::<ActiveBackend>() != active {
        world.insert_resource(active.clone());
    }
}

/// Runs the steps of a tick of fixed time, if there is something to run them on by now.
fn run_step(world: &mut World) {
    get_ready(world);
    let engine = &world.resource::<Step>().engine;
    if engine.runs() {
        clock::tick(world);
    } else if engine.has_failed()
        && let Err(error) = world.run_system_cached(publish::tell_failure)
    {
        error!("{error}");
    }
}

/// Takes what there is to run steps on by now, and tells of it.
fn get_ready(world: &mut World) {
    choose(world);
    let engine = &mut world.resource_mut::<Step>().engine;
    if let Some(active) = engine.poll() {
        match &active {
            ActiveBackend::Gpu { adapter, shared: false } => info!("collisions run on the GPU: {adapter}"),
            ActiveBackend::Gpu { adapter, shared: true } => {
                info!("collisions run on the GPU, on the device of Bevy's renderer: {adapter}");
            }
            ActiveBackend::Cpu { threads, reason } => {
                info!("collisions run on the CPU with {threads} threads: {reason}");
            }
            ActiveBackend::None { reason } => error!("no collisions are found and no body moves: {reason}"),
            ActiveBackend::Opening | ActiveBackend::Lost => {}
        }
        world.insert_resource(active.clone());
        world.write_message(BackendReady { active });
    }
}

/// No step will follow that would bring the results of those that are on their way: publishes those of one.
#[cfg(feature = "gpu")]
fn publish_while_time_stands(world: &mut World) {
    let stands = (world.get_resource::<Time<Virtual>>()).is_some_and(|time| time.delta().is_zero());
    if stands {
        publish::land(world);
    }
}

fn register_types(app: &mut App) {
    app.register_type::<RigidBody>()
        .register_type::<MeshCollider>()
        .register_type::<PlaneCollider>()
        .register_type::<LinearVelocity>()
        .register_type::<AngularVelocity>()
        .register_type::<CenterOfMass>()
        .register_type::<Mass>()
        .register_type::<Density>()
        .register_type::<AngularInertia>()
        .register_type::<Restitution>()
        .register_type::<Friction>()
        .register_type::<GravityScale>()
        .register_type::<LinearDamping>()
        .register_type::<AngularDamping>()
        .register_type::<MaxLinearSpeed>()
        .register_type::<MaxAngularSpeed>()
        .register_type::<LockedAxes>()
        .register_type::<ExternalForces>()
        .register_type::<Sleeping>()
        .register_type::<SleepingDisabled>()
        .register_type::<ContinuousCollision>()
        .register_type::<CollisionLayers>()
        .register_type::<Sensor>()
        .register_type::<BodyCulling>()
        .register_type::<CollidingEntities>()
        .register_type::<CollisionEventsEnabled>()
        .register_type::<Culling>()
        .register_type::<EventHysteresis>()
        .register_type::<Gravity>()
        .register_type::<Response>()
        .register_type::<SolverSettings>()
        .register_type::<Backend>()
        .register_type::<Time<Physics>>();
}

/// How many threads the CPU stages run on; 0 without a [`StepPlugin`].
pub fn threads(world: &World) -> usize {
    world
        .get_resource::<Step>()
        .map_or(0, |step| step.engine.pool.current_num_threads())
}

/// The device that the stages run on, if it is a GPU.
#[cfg(feature = "gpu")]
pub fn gpu(world: &World) -> Option<&Gpu> {
    world.get_resource::<Step>()?.engine.device()
}

/// Where all bodies are, for shaders that draw them with [`Reading::Resident`], or otherwise without waiting for results:
/// two poses on the GPU, and the entities in their order. There are none between [`Snapshot::restore`](crate::plugin::snapshot::Snapshot::restore)
/// and the next step. `None` if results are not read later than steps run.
#[cfg(feature = "gpu")]
pub fn poses(world: &World) -> Option<(Poses<'_>, impl Iterator<Item = Entity> + '_)> {
    let step = world.get_resource::<Step>()?;
    step.engine.latent()?;
    Some((step.engine.gpu()?.poses(), step.latent.entities()))
}
