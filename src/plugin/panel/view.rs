//! The entities of the panel.

use super::FaceoffPanel;
use super::averages::{Averages, StepTimes};
use super::figures::Source;
use super::rejected::Rejected;
use super::text;
use crate::plugin::collisions::StepReport;
use crate::plugin::sync::Step;
use bevy::picking::Pickable;
use bevy::prelude::*;
use std::time::Duration;

/// The panel: an entity with a `Node`, and texts below it.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct FaceoffPanelNode;

/// What a text of the panel is about.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Section {
    Backend,
    Times,
    Counts,
    Gpu,
    Rejected,
}

impl Section {
    const ALL: [Self; 5] = [Self::Backend, Self::Times, Self::Counts, Self::Gpu, Self::Rejected];

    fn color(self) -> Color {
        match self {
            Self::Backend => Color::srgb(0.55, 0.85, 1.0),
            Self::Times | Self::Counts | Self::Gpu => Color::srgb(0.92, 0.93, 0.95),
            Self::Rejected => Color::srgb(1.0, 0.65, 0.35),
        }
    }
}

/// What the panel showed at the last refresh.
#[derive(Default)]
pub(super) struct Shown {
    /// Real time at that moment; `None` before the first, and after the settings changed.
    at: Option<Duration>,
    times: StepTimes,
    rejected: Rejected,
}

/// Makes the panel when it is shown first, and hides and shows it later.
pub(super) fn show_or_hide(
    panel: Res<FaceoffPanel>,
    mut nodes: Query<&mut Node, With<FaceoffPanelNode>>,
    mut averages: ResMut<Averages>,
    report: Option<Res<StepReport>>,
    mut commands: Commands,
) {
    if !panel.is_changed() {
        return;
    }
    let display = if panel.visible { Display::Flex } else { Display::None };
    for mut node in &mut nodes {
        if node.display != display {
            node.display = display;
        }
    }
    if panel.visible {
        averages.restart(report.map_or(0, |report| report.step));
        if nodes.is_empty() {
            spawn(&mut commands, panel.font_size);
        }
    }
}

fn spawn(commands: &mut Commands, font_size: f32) {
    let node = Node {
        position_type: PositionType::Absolute,
        top: px(12),
        right: px(12),
        max_width: px(26.0 * font_size),
        flex_direction: FlexDirection::Column,
        row_gap: px(6),
        padding: UiRect::all(px(10)),
        border_radius: BorderRadius::all(px(6)),
        ..default()
    };
    let panel = (
        FaceoffPanelNode,
        Name::new("bevy_faceoff panel"),
        node,
        BackgroundColor(Color::srgba(0.03, 0.04, 0.06, 0.85)),
        // In front of the game's own UI.
        GlobalZIndex(i32::MAX - 33),
        Pickable::IGNORE,
    );
    commands.spawn(panel).with_children(|panel| {
        for section in Section::ALL {
            panel.spawn((
                section,
                Text::default(),
                TextFont::from_font_size(font_size),
                TextColor(section.color()),
                Node {
                    display: Display::None,
                    ..default()
                },
                Pickable::IGNORE,
            ));
        }
    });
}

/// Writes the texts, some times a second.
pub(super) fn write(
    panel: Res<FaceoffPanel>,
    source: Source,
    step: Option<Res<Step>>,
    mut averages: ResMut<Averages>,
    mut shown: Local<Shown>,
    mut sections: Query<(&Section, &mut Text, &mut Node)>,
    names: Query<&Name>,
    time: Option<Res<Time<Real>>>,
) {
    let report = source.report.as_deref().cloned().unwrap_or_default();
    averages.add(&report);
    if panel.is_changed() {
        // Written at once.
        shown.at = None;
    }
    let now = time.map_or(Duration::ZERO, |time| time.elapsed());
    let since = shown.at.map(|at| now.saturating_sub(at));
    if since.is_some_and(|since| since < panel.refresh) {
        return;
    }
    shown.at = Some(now);
    let taken = averages.take();
    if let Some(times) = taken {
        shown.times = times;
    }
    let seconds = since.unwrap_or_default().as_secs_f32();
    let steps = taken.map_or(0, |times| times.steps) as f32;
    let rate = if seconds > 0.0 { steps / seconds } else { 0.0 };
    let figures = source.figures();
    let times = shown.times;
    for (section, mut text, mut node) in &mut sections {
        let new = match section {
            Section::Backend => text::backend(source.active.as_deref(), &report, &figures, rate),
            _ if source.active.is_none() => String::new(),
            Section::Times => text::times(&times, &report),
            Section::Counts => text::counts(&report, &figures),
            Section::Gpu => text::gpu(report.gpu.as_ref(), &report),
            Section::Rejected => shown.rejected.text(step.as_deref(), &names),
        };
        let display = if new.is_empty() { Display::None } else { Display::Flex };
        if node.display != display {
            node.display = display;
        }
        if text.0 != new {
            text.0 = new;
        }
    }
}
