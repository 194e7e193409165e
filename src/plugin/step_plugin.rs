//! [`StepPlugin`]: adds the resources, messages and schedule of the fixed step.

#[cfg(feature = "gpu")]
use crate::gpu::device::Gpu;
use crate::plugin::backend::{ActiveBackend, BackendFailed, BackendReady, Engine};
use crate::plugin::clock::{self, Physics};
use crate::plugin::collisions::{Collisions, StepReport};
use crate::plugin::events::{BodyRejected, CollisionEnd, CollisionStart};
use crate::plugin::hooks;
use crate::plugin::registration;
use crate::plugin::renderer;
use crate::plugin::schedule::{FaceoffStep, FaceoffSystems};
use crate::plugin::settings::{Backend, EventHysteresis, FaceLists, Gravity, MeasureEnergy, Readback};
use crate::plugin::sync::changes::{note_enabled, note_removed};
use crate::plugin::sync::{Step, collect, deep_overlaps, hierarchy, publish};
#[cfg(feature = "gpu")]
use crate::plugin::sync::{latent, release};
#[cfg(feature = "gpu")]
use crate::step::gpu::Poses;
use crate::types::kernel_cache::KernelCache;
use crate::types::limits::StepLimits;
use crate::types::settings::{Culling, Response};
use crate::types::solver_settings::SolverSettings;
use crate::types::stage::Stage;
use bevy::ecs::schedule::{LogLevel, ScheduleBuildSettings, SingleThreadedExecutor};
use bevy::prelude::*;

/// Runs the step in every tick of fixed time.
#[derive(Clone, Debug, Default)]
pub struct StepPlugin {
    /// Where the stages run. Default [`Backend::Auto`].
    pub backend: Backend,
    /// Number of threads of the CPU stages. 0, the default, means one per core.
    pub threads: usize,
    /// When the results of a GPU are published. Default [`Readback::Auto`].
    pub readback: Readback,
    /// Where compiled kernels of a device that the plugin opens itself are kept. Default [`KernelCache::User`].
    pub kernel_cache: KernelCache,
    /// A device that is open already, in place of one of the plugin's own or the renderer's: that of another app, from
    /// [`plugin::gpu`](gpu). Such apps share its compiled kernels, so that only the first waits for them: tests and
    /// servers run many worlds. If the device is lost, each app opens its own. Default `None`.
    #[cfg(feature = "gpu")]
    pub device: Option<Gpu>,
}

impl Plugin for StepPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.backend)
            .init_resource::<Culling>()
            .init_resource::<EventHysteresis>()
            .init_resource::<FaceLists>()
            .init_resource::<MeasureEnergy>()
            .init_resource::<Gravity>()
            .init_resource::<Response>()
            .init_resource::<SolverSettings>()
            .init_resource::<StepLimits>()
            .init_resource::<Collisions>()
            .add_observer(note_removed)
            .add_observer(note_enabled)
            .init_resource::<Time<Physics>>()
            .init_resource::<StepReport>()
            .add_message::<CollisionStart>()
            .add_message::<CollisionEnd>()
            .add_message::<BodyRejected>()
            .add_message::<BackendReady>()
            .add_message::<BackendFailed>();
        registration::register(app);

        match Engine::new(self.backend, self.threads, self.readback, self.kernel_cache.clone()) {
            Ok(mut engine) => {
                #[cfg(feature = "gpu")]
                if let Some(gpu) = &self.device {
                    engine.choose_given(gpu.clone());
                }
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

        // Plugins of a game may have added systems to the schedule.
        app.init_schedule(FaceoffStep)
            .edit_schedule(FaceoffStep, build_schedule);
        #[cfg(feature = "gpu")]
        {
            latent::observe(app);
            let after = RunFixedMainLoopSystems::AfterFixedMainLoop;
            let publish = publish_while_time_stands.in_set(FaceoffStep).in_set(after);
            app.add_systems(RunFixedMainLoop, publish);
        }
        let hold = hierarchy::hold_nested.before(bevy::transform::TransformSystems::Propagate);
        app.add_systems(FixedPostUpdate, run_step.in_set(FaceoffStep))
            .add_systems(PostUpdate, hold);
    }

    fn finish(&self, app: &mut App) {
        choose(app.world_mut());
    }
}

/// Adds the stages.
fn build_schedule(schedule: &mut Schedule) {
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
                FaceoffSystems::Respond,
            )
                .chain(),
        )
        .add_systems((
            (poll_backend.run_if(clock::is_by_hand), clock::begin)
                .chain()
                .before(FaceoffSystems::Collect)
                .ambiguous_with_all(),
            collect::collect.in_set(FaceoffSystems::Collect),
            publish::choose_place
                .in_set(FaceoffSystems::Collect)
                .after(collect::collect)
                .ambiguous_with_all(),
            (
                (publish::use_up_impulses, publish::use_up_teleports),
                publish::show_driven,
                publish::find_written,
                publish::write_back,
                publish::publish,
                deep_overlaps::warn_of_deep_overlaps,
                publish::report_failure,
                clock::settle.run_if(clock::was_by_hand),
            )
                .chain()
                .in_set(FaceoffSystems::Publish),
            clock::end.after(FaceoffSystems::Respond).ambiguous_with_all(),
        ));
    for stage in Stage::ALL {
        let run = hooks::run_without_hooks(stage);
        schedule.add_systems(run.in_set(FaceoffSystems::from(stage)).ambiguous_with_all());
    }
    #[cfg(feature = "gpu")]
    {
        let release = release::release.after(collect::collect).before(publish::choose_place);
        schedule.add_systems(release.in_set(FaceoffSystems::Collect));
    }
}

/// Chooses the backend, if that is still to be done or if Bevy's renderer has a new device.
fn choose(world: &mut World) {
    #[cfg(feature = "bevy_render")]
    if let Some(gpu) = renderer::new_device(world)
        && let Some(mut step) = world.get_resource_mut::<Step>()
        && step.engine.share(gpu)
    {
        step.forget();
    }
    let Some(mut step) = world.get_resource_mut::<Step>() else {
        return;
    };
    step.engine.choose();
    let active = world.resource::<Step>().engine.active();
    if world.resource::<ActiveBackend>() != active {
        world.insert_resource(active.clone());
    }
}

/// Runs the steps of a tick of fixed time, if the backend is ready.
fn run_step(world: &mut World) {
    poll_backend(world);
    let engine = &world.resource::<Step>().engine;
    if engine.runs() {
        clock::tick(world);
    } else if engine.has_failed()
        && let Err(error) = world.run_system_cached(publish::report_failure)
    {
        error!("{error}");
    }
}

/// Updates the backend, and logs and publishes it once it is ready.
fn poll_backend(world: &mut World) {
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

/// Publishes the results of one pending step per frame while time stands still and no step does so.
#[cfg(feature = "gpu")]
fn publish_while_time_stands(world: &mut World) {
    let stands = (world.get_resource::<Time<Virtual>>()).is_some_and(|time| time.delta().is_zero());
    if stands {
        publish::land(world);
    }
}

/// Number of threads of the CPU stages. 0 without a [`StepPlugin`].
pub fn threads(world: &World) -> usize {
    world.get_resource::<Step>().map_or(0, |step| step.engine.threads())
}

/// The device on which the stages run, if they run on a GPU.
#[cfg(feature = "gpu")]
pub fn gpu(world: &World) -> Option<&Gpu> {
    world.get_resource::<Step>()?.engine.device()
}

/// The fraction between the two [`poses`] at which to draw in this frame, from 0 to 1:
/// `Time<Fixed>::overstep_fraction`, or 1 while the physics clock is paused, because fixed time goes on.
#[cfg(feature = "gpu")]
pub fn drawn_part(world: &World) -> f32 {
    let stands = world.get_resource::<Step>().is_some_and(|step| step.stands);
    let fixed = world.get_resource::<Time<Fixed>>().filter(|_| !stands);
    fixed.map_or(1.0, Time::overstep_fraction)
}

/// The poses of all colliders on the GPU, for shaders that draw them without reading results back: buffers with the
/// poses before and after the last submitted step, and the entities in the same order.
///
/// `None` unless the stages run on a GPU with [`Readback::Latent`] or [`Readback::Resident`]. There are no entities
/// between [`Snapshot::restore`](crate::plugin::snapshot::Snapshot::restore) and the next step.
#[cfg(feature = "gpu")]
pub fn poses(world: &World) -> Option<(Poses<'_>, impl Iterator<Item = Entity> + '_)> {
    let step = world.get_resource::<Step>()?;
    step.engine.latent()?;
    Some((step.engine.gpu()?.poses(), step.latent.colliders()))
}
