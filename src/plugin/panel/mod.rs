//! A panel on the screen, for development: where the step runs, what each stage costs and finds, and which bodies are
//! rejected. Needs the feature `debug_panel`.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_faceoff::plugin::panel::{FaceoffPanel, FaceoffPanelPlugin};
//! use bevy_faceoff::prelude::*;
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, FaceoffPlugins::default(), FaceoffPanelPlugin::default()))
//!     // F3 shows and hides the panel. So does this system.
//!     .add_systems(Startup, |mut panel: ResMut<FaceoffPanel>| panel.visible = false)
//!     .run();
//! ```
//!
//! | line | meaning |
//! |---|---|
//! | backend | [`ActiveBackend`](crate::plugin::backend::ActiveBackend), with the reason why the stages run on the CPU |
//! | clock | [`Time<Physics>`](crate::plugin::clock): paused, or its speed; the steps per second of real time |
//! | times | of each stage and of the whole step, in milliseconds: mean and longest since the last refresh |
//! | counts | those of [`StepReport`](crate::plugin::collisions::StepReport) in the last step |
//! | islands | sets of dynamic bodies that sleep and wake together. Not known without [`Response::Contacts`](crate::types::settings::Response::Contacts) and with [`Readback::Resident`](crate::plugin::settings::Readback::Resident) |
//! | GPU | what the last step asked of a GPU: [`StepReport::gpu`](crate::plugin::collisions::StepReport::gpu) |
//! | rejected | colliders, bodies and planes that are left out of the step now, newest first, with the reason |
//!
//! The panel is an entity with [`FaceoffPanelNode`] and a `Node`: change that to put it elsewhere. It is made when it
//! is shown first. While it is hidden it costs nothing. In an app without Bevy's UI, without a window or without the
//! step it does no harm.

mod averages;
mod figures;
mod rejected;
mod text;
mod view;

pub use view::FaceoffPanelNode;

use crate::plugin::schedule::FaceoffStep;
use averages::Averages;
use bevy::prelude::*;
use std::time::Duration;

/// Adds the panel. Add it after `DefaultPlugins`.
#[derive(Clone, Debug, Default)]
pub struct FaceoffPanelPlugin {
    /// The settings at the start.
    pub panel: FaceoffPanel,
}

/// Settings of the panel.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, PartialEq)]
pub struct FaceoffPanel {
    /// Whether it is shown. Default true.
    pub visible: bool,
    /// The key that shows and hides it. Default F3.
    pub key: Option<KeyCode>,
    /// Real time between two changes of the text. Default 0.25 s. Zero changes it in every frame.
    pub refresh: Duration,
    /// Height of the text in logical pixels. Read when the panel is shown first. Default 13.
    pub font_size: f32,
}

impl Default for FaceoffPanel {
    fn default() -> Self {
        Self {
            visible: true,
            key: Some(KeyCode::F3),
            refresh: Duration::from_millis(250),
            font_size: 13.0,
        }
    }
}

impl FaceoffPanel {
    /// Hidden at first.
    pub fn hidden() -> Self {
        Self {
            visible: false,
            ..Self::default()
        }
    }
}

impl Plugin for FaceoffPanelPlugin {
    fn build(&self, app: &mut App) {
        let sample = averages::sample.after(FaceoffStep).run_if(is_visible);
        app.insert_resource(self.panel.clone())
            .init_resource::<Averages>()
            .register_type::<FaceoffPanel>()
            .register_type::<FaceoffPanelNode>()
            .add_systems(FixedPostUpdate, sample)
            .add_systems(
                Update,
                (switch, view::show_or_hide, view::write.run_if(is_visible)).chain(),
            );
    }
}

/// Shows or hides the panel by its key.
fn switch(mut panel: ResMut<FaceoffPanel>, keys: Option<Res<ButtonInput<KeyCode>>>) {
    if let (Some(keys), Some(key)) = (keys, panel.key)
        && keys.just_pressed(key)
    {
        panel.visible = !panel.visible;
    }
}

fn is_visible(panel: Res<FaceoffPanel>) -> bool {
    panel.visible
}
