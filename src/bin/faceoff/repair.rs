//! `faceoff repair`: writes a mesh without its defects, and tells what was done.

use crate::lost::lost;
use crate::{Outcome, Wrong, mesh, output};
use bevy_faceoff::asset::{Imported, import_file, input_files, to_obj, to_off, to_ply, to_stl};
use bevy_faceoff::geometry::repair::{Steps, Work, repair};
use bevy_faceoff::geometry::{DefectKind, MassBasis, MassProperties, Orientation, TriMesh};
use bevy_faceoff::projection::BakeSettings;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Repair a mesh file, and print what was done.
///
/// Without --weld, --drop, --split and --orient all four are done: they do not change the shape. With any of them only
/// those that are named are done. Holes are closed only with --close-holes. Faces and vertices of the result have other
/// numbers, unless nothing was wrong. Only positions and faces are written: what else the file has, such as texture
/// coordinates, normals, materials and objects, is not kept, and a warning tells so.
///
/// Exits with 0 also if defects remain; the table and the JSON tell which. 1 if a file cannot be read or written, 2 if
/// the command line is wrong.
#[derive(clap::Args)]
pub struct Options {
    /// The mesh: .glb, .gltf, .obj, .stl, .ply, .off, .faceoff, or a .bake.ron, which stands for the mesh it names.
    mesh: PathBuf,
    /// The file to write: .obj, .stl, .ply or .off (STL and PLY are binary), or - for OBJ on standard output. A file
    /// that is there is replaced, but never the mesh itself.
    #[arg(
        short,
        long,
        value_name = "OUT",
        required_unless_present = "in_place",
        conflicts_with = "in_place"
    )]
    output: Option<PathBuf>,
    /// Write over the mesh file instead. If nothing was wrong its bytes stay.
    #[arg(long)]
    in_place: bool,
    /// Merge vertices within this distance of each other, relative to the mesh's size [default: 0.000001, or the
    /// `weld_tolerance` of a .bake.ron].
    #[arg(long, value_name = "TOLERANCE", num_args = 0..=1, require_equals = true)]
    weld: Option<Option<f32>>,
    /// Drop faces of zero area, duplicate faces and unused vertices; but no face that keeps the mesh closed.
    #[arg(long)]
    drop: bool,
    /// Split edges where a vertex of another face lies on them: T-junctions.
    #[arg(long)]
    split: bool,
    /// Make neighbouring faces agree about the winding, and turn solids outward.
    #[arg(long)]
    orient: bool,
    /// Close holes of up to N edges with triangles.
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    close_holes: usize,
    /// Write what was done as JSON to this file, or - for standard output.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The most holes left open that the table lists.
const LEFT: usize = 5;

/// The formats that are written.
#[derive(Clone, Copy)]
enum Format {
    Obj,
    Off,
    Ply,
    Stl,
}

#[derive(Serialize)]
struct Report {
    file: String,
    output: String,
    steps: StepsReport,
    done: Work,
    before: State,
    after: State,
}

/// Which steps ran.
#[derive(Serialize)]
struct StepsReport {
    weld: bool,
    /// Relative to the mesh's size.
    tolerance: f32,
    drop: bool,
    split: bool,
    orient: bool,
    /// The most edges of a hole that was to be closed.
    close_holes: usize,
}

/// What a mesh is like.
#[derive(Serialize)]
struct State {
    vertices: usize,
    /// All faces, also those of zero area.
    faces: usize,
    closed: bool,
    orientation: Orientation,
    /// Whether small openings count as closed for mass and containment.
    nearly_closed: bool,
    /// What it encloses, in cubic mesh units; `None` if that is nearly nothing, or not known, because it is
    /// open or its faces disagree.
    volume: Option<f32>,
    /// How many there are of each kind of defect; kinds without any are left out.
    defects: Vec<DefectCount>,
}

#[derive(Serialize)]
struct DefectCount {
    kind: DefectKind,
    count: usize,
}

/// Runs the command.
pub fn run(options: &Options) -> Outcome {
    let target = target(options)?;
    let format = Format::of(&target)?;
    output::check(&target)?;
    if let Some(json) = &options.json {
        output::refuse(json, input_files(&options.mesh).iter().chain([&target]))?;
        if output::is_standard(json) && output::is_standard(&target) {
            return Err(Wrong(
                "the mesh and the JSON cannot both go to standard output; give one of them a file".into(),
            )
            .into());
        }
        output::check(json)?;
    }
    let imported = import_file(&options.mesh)?;
    mesh::warn_all(&options.mesh, imported.warnings());
    let (mesh, own) = match imported {
        Imported::Mesh { mesh, settings, .. } => (mesh, settings),
        Imported::Baked { mesh, header } => (mesh.mesh.clone().as_input(), header.settings),
    };
    let steps = options.steps(own)?;
    let mesh = mesh.with_weld_tolerance(steps.tolerance);
    let before = State::of(&mesh);
    let repaired = repair(&mesh, &steps).map_err(|e| format!("{}: after the repair {e}", options.mesh.display()))?;
    let bytes = format.bytes(&repaired.mesh);
    // A file may have more than its shape, which writing it would lose.
    if !options.in_place || bytes != format.bytes(&mesh) {
        warn_lost(&options.mesh);
        output::save(&target, &bytes)?;
    }
    let report = Report {
        file: options.mesh.display().to_string(),
        output: target.display().to_string(),
        steps: StepsReport {
            weld: steps.weld,
            tolerance: steps.tolerance,
            drop: steps.drop,
            split: steps.split,
            orient: steps.orient,
            close_holes: steps.close_holes,
        },
        done: repaired.work,
        before,
        after: State::of(&repaired.mesh),
    };
    if let Some(json) = &options.json {
        output::json(json, &report)?;
    }
    let to_standard = output::is_standard(&target).then_some(target.as_path());
    output::table(to_standard.or(options.json.as_deref()), &report.text())
}

/// The file to write.
fn target(options: &Options) -> Outcome<PathBuf> {
    if let Some(output) = &options.output {
        output::refuse(output, [&options.mesh])
            .map_err(|error| Wrong(format!("{error}, or --in-place to write over the mesh")))?;
        output::refuse(output, input_files(&options.mesh))?;
        return Ok(output.clone());
    }
    let name = options.mesh.display();
    if Format::of(&options.mesh).is_err() {
        return Err(Wrong(format!(
            "{name}: --in-place writes .obj, .stl, .ply and .off files only; give a name for the result with --output"
        ))
        .into());
    }
    Ok(options.mesh.clone())
}

/// Warns of what the files of a mesh have that its repaired shape lacks.
fn warn_lost(mesh: &Path) {
    for file in input_files(mesh) {
        let lost = lost(&file);
        if !lost.is_empty() {
            let name = file.display();
            output::log(&format!(
                "warning: {name}: only positions and faces are written; not kept: {}",
                lost.join(", ")
            ));
        }
    }
}

impl Options {
    /// The steps to run. `own` are the settings of the mesh.
    fn steps(&self, own: BakeSettings) -> Outcome<Steps> {
        let is_named = self.weld.is_some() || self.drop || self.split || self.orient;
        let tolerance = self.weld.flatten().unwrap_or(own.weld_tolerance);
        BakeSettings {
            weld_tolerance: tolerance,
            ..BakeSettings::default()
        }
        .validate()
        .map_err(|e| Wrong(format!("--weld: {e}")))?;
        let named = Steps {
            weld: self.weld.is_some(),
            drop: self.drop,
            split: self.split,
            orient: self.orient,
            ..Steps::NONE
        };
        Ok(Steps {
            tolerance,
            close_holes: self.close_holes,
            ..if is_named { named } else { Steps::SAFE }
        })
    }
}

impl Format {
    fn of(path: &Path) -> Outcome<Self> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        Ok(match extension.as_deref() {
            _ if output::is_standard(path) => Self::Obj,
            Some("obj") => Self::Obj,
            Some("off") => Self::Off,
            Some("ply") => Self::Ply,
            Some("stl") => Self::Stl,
            _ => {
                let name = path.display();
                return Err(Wrong(format!("{name}: give a name that ends in .obj, .stl, .ply or .off")).into());
            }
        })
    }

    /// The bytes of a file.
    fn bytes(self, mesh: &TriMesh) -> Vec<u8> {
        match self {
            Self::Obj => to_obj(mesh).into_bytes(),
            Self::Off => to_off(mesh).into_bytes(),
            Self::Ply => to_ply(mesh),
            Self::Stl => to_stl(mesh),
        }
    }
}

impl State {
    fn of(mesh: &TriMesh) -> Self {
        let defects = mesh.defects();
        // The volume of other meshes is a guess, which takes long to make.
        let is_enclosed = match mesh.orientation() {
            Orientation::Outward | Orientation::Inward => true,
            Orientation::Mixed => false,
            Orientation::Open => !mesh.caps().is_empty(),
        };
        let mass = is_enclosed.then(|| MassProperties::of(mesh));
        let counts = DefectKind::ALL.into_iter().map(|kind| DefectCount {
            kind,
            count: defects.count(kind),
        });
        Self {
            vertices: mesh.vertices().len(),
            faces: mesh.all_faces().len(),
            closed: mesh.is_closed(),
            orientation: mesh.orientation(),
            nearly_closed: !mesh.is_closed() && !mesh.caps().is_empty(),
            volume: mass.filter(|mass| mass.basis != MassBasis::Box).map(|mass| mass.volume),
            defects: counts.filter(|defects| defects.count > 0).collect(),
        }
    }

    fn count(&self, kind: DefectKind) -> usize {
        let found = self.defects.iter().find(|defects| defects.kind == kind);
        found.map_or(0, |defects| defects.count)
    }

    fn surface(&self) -> &'static str {
        match self.orientation {
            Orientation::Outward => "closed, outward",
            Orientation::Inward => "closed, inward",
            Orientation::Mixed => "closed, mixed winding",
            Orientation::Open if self.nearly_closed => "nearly closed",
            Orientation::Open => "open",
        }
    }
}

impl Report {
    fn text(&self) -> String {
        let mut text = format!("{} -> {}\n", self.file, self.output);
        let (before, after) = (&self.before, &self.after);
        let mut row = |name: &str, a: String, b: String| text += &format!("  {name:<28} {a:>22} {b:>22}\n");
        row("", "before".into(), "after".into());
        row("vertices", before.vertices.to_string(), after.vertices.to_string());
        row("faces", before.faces.to_string(), after.faces.to_string());
        row("surface", before.surface().into(), after.surface().into());
        let volume = |state: &State| state.volume.map_or("unknown".into(), |volume| volume.to_string());
        row("volume", volume(before), volume(after));
        for kind in DefectKind::ALL {
            let (a, b) = (before.count(kind), after.count(kind));
            if a + b > 0 {
                row(kind.name(), a.to_string(), b.to_string());
            }
        }
        let (steps, done) = (&self.steps, &self.done);
        let mut step = |is_done: bool, name: &str, what: String| {
            if is_done {
                text += &format!("  {name:<12} {what}\n");
            }
        };
        step(
            steps.weld,
            "weld",
            format!(
                "{} vertices merged, within {:?} of the size",
                done.merged_vertices, steps.tolerance
            ),
        );
        step(
            steps.drop,
            "drop",
            format!(
                "{} faces of zero area, {} duplicate faces, {} unused vertices",
                done.dropped_zero_area, done.dropped_duplicates, done.dropped_vertices
            ),
        );
        let kept = done.kept_zero_area + 2 * done.kept_back_to_back;
        step(
            kept > 0,
            "",
            format!(
                "{} faces of zero area and {} back to back kept: without them the mesh would be open",
                done.kept_zero_area,
                2 * done.kept_back_to_back
            ),
        );
        step(
            steps.split,
            "split",
            format!("edges split in {} places", done.split_edges),
        );
        step(steps.orient, "orient", format!("{} faces turned", done.turned_faces));
        step(
            steps.close_holes > 0,
            "close holes",
            format!("{} closed with {} faces", done.closed_holes, done.added_faces),
        );
        for left in done.left_holes.iter().take(LEFT) {
            let [x, y, z] = left.position;
            step(
                true,
                "",
                format!("{} edges at ({x}, {y}, {z}) left: {}", left.edges, left.why.text()),
            );
        }
        let more = done.left_holes.len().saturating_sub(LEFT);
        step(more > 0, "", format!("{more} more holes left"));
        let left: usize = after.defects.iter().map(|defects| defects.count).sum();
        let advice = if steps.close_holes == 0 && after.count(DefectKind::Opening) > 0 {
            "; --close-holes N closes openings"
        } else {
            ""
        };
        step(left > 0, "left", format!("{left} defects{advice}"));
        text
    }
}
