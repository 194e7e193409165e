//! `faceoff inspect`: prints the content of a mesh file and the data that a bake derives from it.

use crate::{Outcome, output};
use bevy_faceoff::asset::{CollisionMesh, Imported, import_file};
use bevy_faceoff::geometry::Orientation;
use bevy_faceoff::geometry::cluster::CLUSTER;
use bevy_faceoff::projection::BakeSettings;
use bevy_faceoff::projection::faces::TableStats;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Print the content of a mesh file and the data that a bake derives from it.
#[derive(clap::Args)]
pub struct Options {
    /// The file: .faceoff, .bake.ron or a mesh. Only a .faceoff file can contain a face table.
    file: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    file: String,
    triangles: usize,
    dropped_faces: u32,
    vertices: usize,
    orientation: Orientation,
    closed: bool,
    /// The number of boundary edges; 0 if the mesh is closed.
    unmatched_edges: u32,
    components: usize,
    volume: f32,
    mass_is_approximate: bool,
    center_of_mass: [f32; 3],
    radius: f32,
    thickness: f32,
    clusters: usize,
    support_heights: usize,
    settings: BakeSettings,
    table: Option<TableStats>,
    source_hash: String,
    warnings: Vec<String>,
}

/// Runs the command.
pub fn run(options: &Options) -> Outcome {
    let imported = import_file(&options.file)?;
    let mut warnings = imported.warnings().to_vec();
    let (mesh, settings, hash) = match imported {
        Imported::Mesh {
            mesh,
            settings,
            source_hash,
            ..
        } => (CollisionMesh::without_faces(&mesh, settings), settings, source_hash),
        Imported::Baked { mesh, header } => {
            let settings = header.settings;
            (mesh, settings, header.source_hash)
        }
    };
    warnings.extend(mesh.warnings());
    let report = Report::new(&options.file, &mesh, settings, &hash, warnings);
    if options.json {
        output::json(Path::new("-"), &report)
    } else {
        output::table(None, &report.text())
    }
}

impl Report {
    fn new(file: &Path, baked: &CollisionMesh, settings: BakeSettings, hash: &[u8], warnings: Vec<String>) -> Self {
        let (mesh, mass) = (&baked.mesh, &baked.mass);
        Self {
            file: file.display().to_string(),
            triangles: mesh.triangles().len(),
            dropped_faces: mesh.dropped(),
            vertices: mesh.vertices().len(),
            orientation: mesh.orientation(),
            closed: mesh.is_closed(),
            unmatched_edges: mesh.gaps().map_or(0, |gaps| gaps.edges),
            components: mesh.component_vertices().len(),
            volume: mass.volume,
            mass_is_approximate: mass.approximate,
            center_of_mass: mass.center.to_array(),
            radius: baked.radius,
            thickness: mass.thickness,
            clusters: mesh.triangles().len().div_ceil(CLUSTER),
            support_heights: baked.heights.heights().len(),
            settings,
            table: baked.faces.as_ref().map(|table| table.stats()),
            source_hash: hash.iter().map(|byte| format!("{byte:02x}")).collect(),
            warnings,
        }
    }

    fn text(&self) -> String {
        let mut text = format!("{}\n", self.file);
        let mut row = |name: &str, value: String| text += &format!("  {name:<18} {value}\n");
        row("triangles", format!("{} in {} clusters", self.triangles, self.clusters));
        row("dropped faces", self.dropped_faces.to_string());
        row("vertices", self.vertices.to_string());
        row("components", self.components.to_string());
        row(
            "surface",
            match self.orientation {
                Orientation::Outward => "closed, faces point outward",
                Orientation::Inward => "closed, faces point inward: a room",
                Orientation::Mixed => "closed, winding is inconsistent",
                Orientation::Open => "open",
            }
            .into(),
        );
        let doubt = if self.mass_is_approximate { " (approximate)" } else { "" };
        row("volume", format!("{}{doubt}", self.volume));
        row("centre of mass", format!("{:?}", self.center_of_mass));
        row("bounding radius", self.radius.to_string());
        row("thickness", self.thickness.to_string());
        row("support heights", self.support_heights.to_string());
        let BakeSettings {
            faces,
            degrees,
            image,
            weld_tolerance,
            inward,
        } = self.settings;
        row("settings", format!("faces {faces}, {degrees} degrees, image {image}"));
        row("weld tolerance", format!("{weld_tolerance:?} of the size"));
        row("if inward", format!("{inward:?}").to_lowercase());
        match &self.table {
            None => row("face table", "none".into()),
            Some(table) => {
                row(
                    "face table",
                    format!(
                        "{} directions, {} distinct groups, {} runs",
                        table.directions, table.groups, table.runs
                    ),
                );
                row(
                    "visible faces",
                    format!(
                        "{} to {}, {:.1} on average",
                        table.min_visible, table.max_visible, table.mean_visible
                    ),
                );
                row(
                    "table bytes",
                    format!(
                        "{} raw, {} run-length, {} encoded, {} in memory",
                        table.raw_bytes, table.run_length_bytes, table.encoded_bytes, table.memory_bytes
                    ),
                );
            }
        }
        row("source hash", self.source_hash.clone());
        for warning in &self.warnings {
            row("warning", warning.clone());
        }
        text
    }
}
