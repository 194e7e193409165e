//! `faceoff bake`: mesh files to `.faceoff` files.

use crate::progress::with_bar;
use crate::{Outcome, mesh, output};
use bevy_faceoff::asset::format::{self, Hash};
use bevy_faceoff::asset::{CollisionMesh, Imported, import_file};
use bevy_faceoff::projection::{BakeSettings, Inward};
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Bake meshes into .faceoff files, skipping what is up to date.
#[derive(clap::Args)]
pub struct Options {
    /// Mesh files: .glb, .gltf, .obj, .stl, .bake.ron (whose settings count where no option is given) or .faceoff.
    #[arg(required = true)]
    meshes: Vec<PathBuf>,
    /// Folder for the baked files; made if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Bake the table of faces of collision as well, which takes seconds. The exact mode does not need it.
    #[arg(long)]
    faces: bool,
    /// Angular step of the table in degrees; divides 90 [default: 1].
    #[arg(long)]
    degrees: Option<u32>,
    /// Side of the height image in pixels [default: 256].
    #[arg(long)]
    image: Option<u32>,
    /// Corners no farther apart than this part of the mesh's size count as one [default: 0.000001].
    #[arg(long, value_name = "PART")]
    weld_tolerance: Option<f32>,
    /// What a closed mesh is whose faces look inward [default: room].
    #[arg(long)]
    inward: Option<InwardChoice>,
    /// Bake even what is up to date.
    #[arg(long)]
    force: bool,
}

/// `--inward`.
#[derive(Clone, Copy, clap::ValueEnum)]
enum InwardChoice {
    /// Bodies inside are free, and its walls push inward.
    Room,
    /// Its faces are turned.
    Solid,
}

/// Runs the command: every mesh is tried, and any failure makes the whole fail.
pub fn run(options: &Options) -> Outcome {
    let folder = options.output.as_path();
    output::folder(folder)?;
    let targets = targets(options)?;
    let pool = rayon::ThreadPoolBuilder::new().build()?;
    let mut failed = 0;
    for (source, target) in &targets {
        if let Err(error) = bake(options, source, target, &pool) {
            eprintln!("error: {error}");
            failed += 1;
        }
    }
    match failed {
        0 => Ok(()),
        n => Err(format!("{n} of {} meshes could not be baked", targets.len()).into()),
    }
}

/// Where each mesh goes.
fn targets(options: &Options) -> Outcome<Vec<(&Path, PathBuf)>> {
    let mut taken: HashMap<PathBuf, &Path> = HashMap::new();
    let mut targets = Vec::new();
    for source in &options.meshes {
        let name = source.file_name().unwrap_or_default().to_string_lossy();
        let stem = name
            .strip_suffix(".bake.ron")
            .or_else(|| name.rsplit_once('.').map(|(stem, _)| stem))
            .unwrap_or(&name);
        let target = options.output.join(format!("{stem}.faceoff"));
        if let Some(other) = taken.insert(target.clone(), source) {
            return Err(format!(
                "{} and {} would both be baked into {}: rename one, or bake into different folders",
                other.display(),
                source.display(),
                target.display()
            )
            .into());
        }
        targets.push((source.as_path(), target));
    }
    Ok(targets)
}

fn bake(options: &Options, source: &Path, target: &Path, pool: &rayon::ThreadPool) -> Outcome {
    let imported = import_file(source)?;
    let (asked, hash) = match &imported {
        Imported::Mesh {
            settings, source_hash, ..
        } => (*settings, *source_hash),
        Imported::Baked { header, .. } => (header.settings, header.source_hash),
    };
    let settings = BakeSettings {
        faces: options.faces || asked.faces,
        degrees: options.degrees.unwrap_or(asked.degrees),
        image: options.image.unwrap_or(asked.image),
        weld_tolerance: options.weld_tolerance.unwrap_or(asked.weld_tolerance),
        inward: match options.inward {
            None => asked.inward,
            Some(InwardChoice::Room) => Inward::Room,
            Some(InwardChoice::Solid) => Inward::Solid,
        },
    };
    settings.validate().map_err(|e| format!("{}: {e}", source.display()))?;
    if !options.force && is_up_to_date(target, &hash, &settings) {
        output::table(None, &format!("{} is up to date\n", target.display()));
        return Ok(());
    }
    let start = Instant::now();
    let baked = with_bar(&source.display().to_string(), settings, |progress| match &imported {
        Imported::Mesh { mesh, .. } => CollisionMesh::bake(mesh, settings, pool, progress),
        Imported::Baked { mesh, .. } => mesh.rebake(settings, pool, progress),
    })?;
    mesh::warn(source, &baked);
    let bytes = format::to_bytes(&baked, hash);
    write(target, &bytes)?;
    let line = format!(
        "{} -> {}: {} triangles, {} bytes, {:.2} s\n",
        source.display(),
        target.display(),
        baked.mesh.triangles().len(),
        bytes.len(),
        start.elapsed().as_secs_f64()
    );
    output::table(None, &line);
    Ok(())
}

/// A file that is not there, or that cannot be read as a baked one, is not up to date.
fn is_up_to_date(target: &Path, hash: &Hash, settings: &BakeSettings) -> bool {
    fs::read(target)
        .ok()
        .and_then(|bytes| format::from_bytes(&bytes).ok())
        .is_some_and(|(_, header)| header.is_up_to_date(hash, settings))
}

/// Writes beside the target and renames, so that a reader never sees half a file.
fn write(target: &Path, bytes: &[u8]) -> Outcome {
    let partial = target.with_extension("faceoff.partial");
    fs::write(&partial, bytes)
        .and_then(|()| fs::rename(&partial, target))
        .map_err(|e| {
            // Whether or not there is half a file to remove, the error to tell is the first one.
            let _ = fs::remove_file(&partial);
            format!("cannot write {}: {e}", target.display()).into()
        })
}
