//! `faceoff check`: finds the pairs of placed meshes that touch.

use crate::scene_file::{BodyEntry, SceneFile};
use crate::{BackendChoice, CullingChoice, Outcome, mesh, output};
use bevy_faceoff::asset::{CollisionMesh, input_files};
use bevy_faceoff::gpu::device;
use bevy_faceoff::queries::{Check, CheckError, CheckOptions, Placement, TouchingPair, check_on_gpu};
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::types::kernel_cache::KernelCache;
use indicatif::ProgressBar;
use serde::Serialize;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Find all touching pairs of a set of placed meshes.
///
/// SCENE is RON: (meshes: {"name": "path"}, bodies: [(mesh: "name", translation: (x,y,z), rotation: (x,y,z,w), scale:
/// (x,y,z))]). Paths are relative to the scene file. translation, rotation and scale are optional.
#[derive(clap::Args)]
pub struct Options {
    /// The scene file.
    scene: PathBuf,
    /// Which triangles are tested.
    #[arg(long, value_enum, default_value = "exact")]
    culling: CullingChoice,
    /// Where the check runs; auto is the CPU, because to open a GPU takes longer than most checks.
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendChoice,
    /// List the intersecting faces of each pair.
    #[arg(long)]
    faces: bool,
    /// Write the pairs as JSON to this file, or - for standard output.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// The JSON output.
#[derive(Serialize)]
struct Report {
    pairs: Vec<PairReport>,
}

#[derive(Serialize)]
struct PairReport {
    a: u32,
    b: u32,
    triangle_pairs: usize,
    contained: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    faces: Option<Vec<[u32; 2]>>,
}

/// Runs the command.
pub fn run(options: &Options) -> Outcome {
    let path = options.scene.as_path();
    let scene = scene(path)?;
    if let Some(json) = &options.json {
        let meshes = scene.meshes.values().flat_map(|file| input_files(beside(path, file)));
        output::refuse(json, meshes.chain([path.to_owned()]))?;
        // Find out before the work whether the file can be written.
        output::check(json)?;
    }
    let placements = placements(path, &scene, options.culling)?;
    let how = CheckOptions {
        culling: options.culling.into(),
    };
    let checked = match options.backend {
        // To open a GPU takes longer than most checks.
        BackendChoice::Auto | BackendChoice::Cpu => on_cpu(&placements, &how, options.faces),
        BackendChoice::Gpu => {
            let gpu = device::open(true, &KernelCache::User).and_then(GpuStep::new);
            let mut gpu = gpu.map_err(|error| format!("--backend gpu: {error}"))?;
            check_on_gpu(&placements, &how, &mut gpu).map(|pairs| reports(pairs, options.faces).collect())
        }
    };
    let report = Report {
        pairs: checked.map_err(|error| format!("{}: {error}", path.display()))?,
    };
    if let Some(json) = &options.json {
        output::json(json, &report)?;
    }
    output::table(
        options.json.as_deref(),
        &summary(placements.len(), options.culling, &report),
    )
}

/// Checks on the CPU with a progress bar. Unless faces are requested they are only counted: deeply overlapping bodies
/// can have more of them than fit in memory.
fn on_cpu(placements: &[Placement], how: &CheckOptions, faces: bool) -> Result<Vec<PairReport>, CheckError> {
    let mut check = Check::new(placements, how)?;
    let bar = ProgressBar::new(check.progress().1 as u64);
    let mut pairs = Vec::new();
    while let Some(batch) = check.next() {
        pairs.extend(reports(batch, faces));
        bar.set_position(check.progress().0 as u64);
    }
    bar.finish_and_clear();
    Ok(pairs)
}

fn reports(pairs: Vec<TouchingPair>, faces: bool) -> impl Iterator<Item = PairReport> {
    pairs.into_iter().map(move |pair| PairReport::new(pair, faces))
}

/// The maximum length of a scene file in bytes. It guards against an endless device.
const MAX_LENGTH: u64 = 1 << 28;

fn read(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    File::open(path)?.take(MAX_LENGTH + 1).read_to_string(&mut text)?;
    if text.len() as u64 > MAX_LENGTH {
        return Err(io::Error::other(format!(
            "it is longer than {MAX_LENGTH} bytes, so it is not a scene"
        )));
    }
    Ok(text)
}

fn scene(path: &Path) -> Outcome<SceneFile> {
    let name = path.display();
    let text = read(path).map_err(|e| format!("cannot read {name}: {e}"))?;
    Ok(SceneFile::parse(&text)
        .map_err(|e| format!("{name}:{e}; see `faceoff check --help` for the format of a scene"))?)
}

/// The path of a file that a scene names.
fn beside(scene: &Path, file: &Path) -> PathBuf {
    scene.parent().unwrap_or(Path::new("")).join(file)
}

fn placements(path: &Path, scene: &SceneFile, culling: CullingChoice) -> Outcome<Vec<Placement>> {
    let name = path.display();
    let mut meshes: HashMap<&str, CollisionMesh> = HashMap::new();
    for (mesh, file) in &scene.meshes {
        meshes.insert(mesh, mesh::load(&beside(path, file), culling)?);
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

impl PairReport {
    fn new(pair: TouchingPair, faces: bool) -> Self {
        Self {
            a: pair.a,
            b: pair.b,
            triangle_pairs: pair.faces.len(),
            contained: pair.contained,
            faces: faces.then_some(pair.faces),
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
                CullingChoice::Faces | CullingChoice::Front => ", or faces that were culled intersect",
            };
            format!("{a:>6} {b:>6}  one inside the other{how}\n")
        } else {
            format!("{a:>6} {b:>6}  {triangle_pairs} pairs of faces intersect\n")
        };
        for [face_a, face_b] in pair.faces.iter().flatten() {
            text += &format!("{:>15} {face_a:>7} {face_b:>7}\n", "");
        }
    }
    text
}
