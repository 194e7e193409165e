//! `faceoff inspect`: prints the content of a mesh file and the data that a bake derives from it.

use crate::{Outcome, output};
use bevy_faceoff::asset::{CollisionMesh, Imported, import_file};
use bevy_faceoff::geometry::cluster::CLUSTER;
use bevy_faceoff::geometry::{DefectKind, Defects, MassBasis, Orientation};
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
    /// How many there are of each kind, and where the first are.
    defects: Vec<DefectReport>,
    /// The area of the largest opening, relative to that of the mesh.
    largest_opening: f64,
    /// Whether small openings count as closed for mass and containment.
    nearly_closed: bool,
    /// Whether something can be wholly inside.
    solid: bool,
    /// Triangles that push only to the side of their normal.
    one_sided_triangles: usize,
    volume: f32,
    mass_is_approximate: bool,
    /// What the mass was computed from.
    mass_basis: MassBasis,
    /// How far off the volume may be, relative to itself.
    mass_error: f32,
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

/// Defects of a kind.
#[derive(Serialize)]
struct DefectReport {
    kind: DefectKind,
    count: usize,
    /// Where the first of them are.
    places: Vec<DefectLocation>,
}

/// Where a defect is.
#[derive(Serialize)]
struct DefectLocation {
    position: [f32; 3],
    /// The face, an index of the input.
    #[serde(skip_serializing_if = "Option::is_none")]
    face: Option<u32>,
}

/// The most locations that are listed for each kind of defect.
const TOLD_LOCATIONS: usize = 5;

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
        let defects = mesh.defects();
        Self {
            file: file.display().to_string(),
            triangles: mesh.triangles().len(),
            dropped_faces: mesh.dropped(),
            vertices: mesh.vertices().len(),
            orientation: mesh.orientation(),
            closed: mesh.is_closed(),
            unmatched_edges: mesh.gaps().map_or(0, |gaps| gaps.edges),
            components: mesh.component_vertices().len(),
            defects: defect_reports(&defects),
            largest_opening: defects.largest_opening,
            nearly_closed: !mesh.is_closed() && !mesh.caps().is_empty(),
            solid: mesh.is_solid(),
            one_sided_triangles: (0..mesh.triangles().len()).filter(|&t| baked.one_sided.is(t)).count(),
            volume: mass.volume,
            mass_is_approximate: mass.approximate,
            mass_basis: mass.basis,
            mass_error: mass.error,
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
        let mut row = |name: &str, value: String| text += &format!("  {name:<26} {value}\n");
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
                Orientation::Open if self.nearly_closed => "nearly closed",
                Orientation::Open => "open",
            }
            .into(),
        );
        row("solid", if self.solid { "yes" } else { "no" }.into());
        row(
            "one-sided",
            format!("{} of {} triangles", self.one_sided_triangles, self.triangles),
        );
        let basis = match self.mass_basis {
            MassBasis::Solid => "of what it encloses",
            MassBasis::Room => "of a solid that fills the room",
            MassBasis::Capped => "of what it encloses, openings closed",
            MassBasis::Winding => "where its winding number exceeds a half",
            MassBasis::Shell => "of a shell along its faces",
            MassBasis::Box => "of its bounding box",
        };
        let doubt = match (self.mass_is_approximate, self.mass_basis) {
            (true, MassBasis::Capped | MassBasis::Winding) => format!(", within {:.2} %", self.mass_error * 100.0),
            (true, _) => ", approximate".into(),
            (false, _) => String::new(),
        };
        row("volume", format!("{}, {basis}{doubt}", self.volume));
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
            shell_thickness,
            rounding,
        } = self.settings;
        row("settings", format!("faces {faces}, {degrees} degrees, image {image}"));
        row("weld tolerance", format!("{weld_tolerance:?} of the size"));
        row("if inward", format!("{inward:?}").to_lowercase());
        row("shell thickness", format!("{shell_thickness:?} of the size"));
        row("rounding", rounding.to_string());
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
        for defect in &self.defects {
            let locations: Vec<String> = defect.places.iter().map(DefectLocation::text).collect();
            let more = if defect.count > locations.len() { ", .." } else { "" };
            row(
                defect.kind.name(),
                format!("{}, at {}{more}", defect.count, locations.join(", ")),
            );
        }
        row("source hash", self.source_hash.clone());
        for warning in &self.warnings {
            row("warning", warning.clone());
        }
        text
    }
}

impl DefectLocation {
    fn text(&self) -> String {
        let [x, y, z] = self.position;
        let face = self.face.map(|face| format!("face {face} ")).unwrap_or_default();
        format!("{face}({x}, {y}, {z})")
    }
}

/// The defects of each kind that there are.
fn defect_reports(defects: &Defects) -> Vec<DefectReport> {
    let report = |kind: DefectKind| DefectReport {
        kind,
        count: defects.count(kind),
        places: (defects.of(kind).take(TOLD_LOCATIONS))
            .map(|defect| DefectLocation {
                position: defect.position.to_array(),
                face: defect.face,
            })
            .collect(),
    };
    let reports = DefectKind::ALL.into_iter().map(report);
    reports.filter(|report| report.count > 0).collect()
}
