//! Times and counts of the step as Bevy diagnostics, for overlays and logs.

use crate::plugin::collisions::StepReport;
use crate::plugin::schedule::{FaceoffStep, FaceoffSystems};
use crate::types::stage::Stage;
use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;

/// Registers a diagnostic for the time of each stage in milliseconds, and one for each of the [`COUNTS`].
pub struct FaceoffDiagnosticsPlugin;

/// Paths of the counts of [`StepReport`] that are diagnostics.
pub const COUNTS: [DiagnosticPath; 4] = [
    DiagnosticPath::const_new("faceoff/sphere_pairs"),
    DiagnosticPath::const_new("faceoff/touching_pairs"),
    DiagnosticPath::const_new("faceoff/triangle_tests"),
    DiagnosticPath::const_new("faceoff/face_pairs"),
];

/// Path of the diagnostic for the time of `stage`.
pub const fn stage_path(stage: Stage) -> DiagnosticPath {
    DiagnosticPath::const_new(match stage {
        Stage::BroadPhase => "faceoff/broad_phase",
        Stage::Angles => "faceoff/angles",
        Stage::TriangleTest => "faceoff/triangle_test",
        Stage::Manifolds => "faceoff/manifolds",
        Stage::ForceScan => "faceoff/force_scan",
        Stage::Integrate => "faceoff/integrate",
    })
}

impl Plugin for FaceoffDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        for stage in Stage::ALL {
            app.register_diagnostic(Diagnostic::new(stage_path(stage)).with_suffix("ms"));
        }
        for path in COUNTS {
            app.register_diagnostic(Diagnostic::new(path));
        }
        app.add_systems(FaceoffStep, measure.after(FaceoffSystems::Publish));
    }
}

fn measure(report: Res<StepReport>, mut diagnostics: Diagnostics) {
    for stage in Stage::ALL {
        diagnostics.add_measurement(&stage_path(stage), || report.time(stage).as_secs_f64() * 1e3);
    }
    let counts = [
        report.sphere_pairs as f64,
        report.touching_pairs as f64,
        report.triangle_tests as f64,
        report.face_pairs as f64,
    ];
    for (path, count) in COUNTS.iter().zip(counts) {
        diagnostics.add_measurement(path, || count);
    }
}
