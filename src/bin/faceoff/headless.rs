//! Apps without a window, in which every update is one step.

use crate::{BackendChoice, CullingChoice, Outcome, output};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::prelude::*;
use std::time::Duration;

/// The step of Bevy's fixed clock.
pub const STEP: Duration = Duration::from_nanos(15_625_000);

/// What an app runs on, and how.
pub struct Headless {
    pub backend: BackendChoice,
    pub readback: Readback,
    /// Threads of the CPU stages; 0 for one per core.
    pub threads: usize,
    pub culling: CullingChoice,
    pub response: Response,
    pub gravity: Gravity,
}

impl Headless {
    /// The app, without bodies. An error says why nothing can run the stages.
    pub fn app(self) -> Outcome<App> {
        let backend = match self.backend {
            BackendChoice::Auto => Backend::Auto,
            BackendChoice::Gpu => Backend::Gpu,
            BackendChoice::Cpu => Backend::Cpu,
        };
        let mut app = App::new();
        app.add_plugins((
            MinimalPlugins,
            FaceoffHeadlessPlugins {
                step: StepPlugin {
                    backend,
                    readback: self.readback,
                    threads: self.threads,
                    ..default()
                },
                ..default()
            },
        ))
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        // Every update is one step, however long it takes.
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP))
        .insert_resource(self.gravity)
        .insert_resource(Culling::from(self.culling))
        .insert_resource(self.response);
        app.finish();
        app.cleanup();
        // Bevy's first update has no time behind it and runs no step.
        app.update();
        check_backend(&app)?;
        Ok(app)
    }
}

/// Updates until the next step is done, and returns its report.
///
/// While kernels compile there are no steps, and results of a GPU may come some updates later. Failures of a device are
/// warnings, because the step goes on elsewhere, and so are bodies that it cannot take.
pub fn step(app: &mut App) -> Outcome<&StepReport> {
    let before = app.world().resource::<StepReport>().step;
    loop {
        app.update();
        for failure in app.world_mut().resource_mut::<Messages<BackendFailed>>().drain() {
            output::log(&format!("warning: {}", failure.reason));
        }
        for rejected in app.world_mut().resource_mut::<Messages<BodyRejected>>().drain() {
            output::log(&format!(
                "warning: {} takes no part: {}",
                rejected.entity, rejected.fault
            ));
        }
        check_backend(app)?;
        if app.world().resource::<StepReport>().step > before {
            return Ok(app.world().resource());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn check_backend(app: &App) -> Outcome {
    match app.world().resource() {
        ActiveBackend::None { reason } => Err(format!("nothing can run the stages: {reason}").into()),
        _ => Ok(()),
    }
}
