//! `faceoff check`: which meshes of a scene touch.

use crate::{BackendChoice, CullingChoice, Outcome, mesh, output};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::gpu::{device, step::GpuStep};
use bevy_faceoff::queries::{CheckError, CheckOptions, Placement, TouchingPair, check_on_gpu, check_with};
use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// Find all touching pairs of a set of placed meshes.
///
/// SCENE is RON: (meshes: {"name": "path"}, bodies: [(mesh: "name", translation: (x,y,z), rotation: (x,y,z,w), scale:
/// (x,y,z))]), paths relative to the scene file. translation, rotation and scale may be left out.
#[derive(clap::Args)]
pub struct Options {
    /// The scene file.
    scene: PathBuf,
    /// How triangles are chosen for the test.
    #[arg(long, value_enum, default_value = "exact")]
    culling: CullingChoice,
    /// Where the stages run; auto is the CPU, since opening a GPU takes longer than most checks.
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendChoice,
    /// List the intersecting faces of each pair.
    #[arg(long)]
    faces: bool,
    /// Write the pairs as JSON to this file, or - for standard output.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// A scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    meshes: BTreeMap<String, PathBuf>,
    bodies: Vec<BodyEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyEntry {
    mesh: String,
    #[serde(default)]
    translation: Vec3,
    #[serde(default)]
    rotation: Quat,
    #[serde(default = "one")]
    scale: Vec3,
}

fn one() -> Vec3 {
    Vec3::ONE
}

/// The JSON output.
#[derive(Serialize)]
struct Report<'a> {
    pairs: Vec<PairReport<'a>>,
}

#[derive(Serialize)]
struct PairReport<'a> {
    a: u32,
    b: u32,
    triangle_pairs: usize,
    contained: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    faces: Option<&'a [[u32; 2]]>,
}

/// Runs the command.
pub fn run(options: &Options) -> Outcome {
    let path = options.scene.as_path();
    let placements = placements(path, options.culling)?;
    let how = CheckOptions {
        culling: options.culling.into(),
    };
    let checked = match options.backend {
        // Opening a device takes longer than most checks.
        BackendChoice::Auto | BackendChoice::Cpu => check_with(&placements, &how).map_err(CheckError::from),
        BackendChoice::Gpu => {
            let gpu = device::open(true).and_then(GpuStep::new);
            let mut gpu = gpu.map_err(|error| format!("--backend gpu: {error}"))?;
            check_on_gpu(&placements, &how, &mut gpu)
        }
    };
    let pairs = checked.map_err(|error| format!("{}: {error}", path.display()))?;
    let report = Report {
        pairs: pairs.iter().map(|pair| PairReport::new(pair, options.faces)).collect(),
    };
    output::table(
        options.json.as_deref(),
        &summary(placements.len(), options.culling, &report),
    );
    match &options.json {
        Some(path) => output::json(path, &report),
        None => Ok(()),
    }
}

fn placements(path: &Path, culling: CullingChoice) -> Outcome<Vec<Placement>> {
    let name = path.display();
    let text = std::fs::read_to_string(path).map_err(|e| format!("cannot read {name}: {e}"))?;
    let scene: SceneFile = ron::from_str(&text)
        .map_err(|e| format!("{name}:{e}; see `faceoff check --help` for what a scene looks like"))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut meshes: HashMap<&str, CollisionMesh> = HashMap::new();
    for (mesh, file) in &scene.meshes {
        meshes.insert(mesh, mesh::load(&folder.join(file), culling)?);
    }
    let place = |(i, body): (usize, &BodyEntry)| {
        let mesh = meshes.get(body.mesh.as_str()).ok_or_else(|| {
            let known: Vec<_> = scene.meshes.keys().map(String::as_str).collect();
            format!(
                "{name}: body {i} names the mesh {:?}, which `meshes` does not list; it lists: {}",
                body.mesh,
                known.join(", ")
            )
        })?;
        Ok(Placement {
            mesh: mesh.clone(),
            translation: body.translation,
            rotation: body.rotation,
            scale: body.scale,
        })
    };
    scene.bodies.iter().enumerate().map(place).collect()
}

impl<'a> PairReport<'a> {
    fn new(pair: &'a TouchingPair, faces: bool) -> Self {
        Self {
            a: pair.a,
            b: pair.b,
            triangle_pairs: pair.faces.len(),
            contained: pair.contained,
            faces: faces.then_some(&pair.faces),
        }
    }
}

fn summary(bodies: usize, culling: CullingChoice, report: &Report) -> String {
    let mut text = format!("{bodies} bodies, {} touching pairs", report.pairs.len());
    text += match culling {
        CullingChoice::Exact => "\n",
        CullingChoice::Faces | CullingChoice::Front => " (approximate: some may be missing)\n",
    };
    for pair in &report.pairs {
        let PairReport {
            a, b, triangle_pairs, ..
        } = pair;
        text += &if pair.contained {
            let how = match culling {
                CullingChoice::Exact => "",
                CullingChoice::Faces | CullingChoice::Front => ", or faces out of view intersect",
            };
            format!("{a:>6} {b:>6}  one inside the other{how}\n")
        } else {
            format!("{a:>6} {b:>6}  {triangle_pairs} pairs of faces intersect\n")
        };
        for [face_a, face_b] in pair.faces.unwrap_or_default() {
            text += &format!("{:>15} {face_a:>7} {face_b:>7}\n", "");
        }
    }
    text
}
