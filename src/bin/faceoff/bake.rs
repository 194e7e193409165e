//! `faceoff bake`: bakes mesh files into `.faceoff` files.

use crate::progress::with_bar;
use crate::{Outcome, mesh, output};
use bevy_faceoff::asset::format::{self, Hash};
use bevy_faceoff::asset::{CollisionMesh, Imported, import_file};
use bevy_faceoff::projection::{BakeSettings, Inward};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;
use std::{fmt, fs};

/// Bake meshes into .faceoff files. Files that are up to date are skipped.
#[derive(clap::Args)]
pub struct Options {
    /// Mesh files: .glb, .gltf, .obj, .stl, .ply, .off, .bake.ron or .faceoff. Options override the settings of a .bake.ron file.
    #[arg(required = true)]
    meshes: Vec<PathBuf>,
    /// Folder for the baked files; created if it does not exist.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Also bake the table of faces of collision, which takes seconds. The exact mode does not need it.
    #[arg(long)]
    faces: bool,
    /// Angular step of the face table in degrees; must divide 90 [default: 1].
    #[arg(long)]
    degrees: Option<u32>,
    /// Side of the height image in pixels [default: 256].
    #[arg(long)]
    image: Option<u32>,
    /// Weld vertices within this distance, relative to the mesh's size [default: 0.000001].
    #[arg(long, value_name = "PART")]
    weld_tolerance: Option<f32>,
    /// How to treat a closed mesh whose faces point inward [default: room].
    #[arg(long)]
    inward: Option<InwardChoice>,
    /// Bake meshes even if they are up to date.
    #[arg(long)]
    force: bool,
}

/// The values of `--inward`.
#[derive(Clone, Copy, clap::ValueEnum)]
enum InwardChoice {
    /// Bodies inside are free, and its walls push inward.
    Room,
    /// Its faces are flipped.
    Solid,
}

/// Runs the command. It tries all meshes, and fails if any of them failed.
pub fn run(options: &Options) -> Outcome {
    let folder = options.output.as_path();
    output::folder(folder)?;
    let Plan { bakes, clashes } = plan(&options.meshes, folder);
    let pool = rayon::ThreadPoolBuilder::new().build()?;
    let mut failed = 0;
    let all = bakes.len() + clashes.iter().map(|clash| clash.sources.len()).sum::<usize>();
    for clash in clashes {
        output::log(&format!("error: {clash}"));
        failed += clash.sources.len();
    }
    let mut printed = Ok(());
    for (source, target) in &bakes {
        match bake(options, source, target, &pool) {
            Ok(line) => printed = printed.and(output::table(None, &line)),
            Err(error) => {
                output::log(&format!("error: {error}"));
                failed += 1;
            }
        }
    }
    match failed {
        0 => printed,
        n => Err(format!("{n} of {all} meshes could not be baked").into()),
    }
}

/// The bakes to do.
struct Plan<'a> {
    /// Source and target of each bake.
    bakes: Vec<(&'a Path, PathBuf)>,
    clashes: Vec<Clash<'a>>,
}

/// Different meshes that would be baked into the same file.
struct Clash<'a> {
    sources: Vec<&'a Path>,
    target: PathBuf,
}

impl fmt::Display for Clash<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = self.sources.iter().map(|source| source.display().to_string()).collect();
        write!(
            f,
            "{} would be baked into the same file, {}: rename all but one, or bake into different folders (names that \
             differ only in case are the same on some systems)",
            names.join(" and "),
            self.target.display()
        )
    }
}

/// Finds the target of each mesh. A file that is given twice is baked once.
fn plan<'a>(meshes: &'a [PathBuf], folder: &Path) -> Plan<'a> {
    let mut names: BTreeMap<String, usize> = BTreeMap::new();
    let mut targets: Vec<Clash> = Vec::new();
    for source in meshes {
        let target = folder.join(format!("{}.faceoff", stem(source)));
        let name = target.to_string_lossy().to_lowercase();
        let at = *names.entry(name).or_insert(targets.len());
        match targets.get_mut(at) {
            None => targets.push(Clash {
                sources: vec![source],
                target,
            }),
            Some(there) if there.sources.iter().any(|other| is_same(source, other)) => {}
            Some(there) => there.sources.push(source),
        }
    }
    let (alone, clashes): (Vec<_>, Vec<_>) = targets.into_iter().partition(|target| target.sources.len() == 1);
    Plan {
        bakes: alone.into_iter().map(|one| (one.sources[0], one.target)).collect(),
        clashes,
    }
}

/// The name of a mesh file without its extension.
fn stem(source: &Path) -> String {
    let name = source.file_name().unwrap_or_default().to_string_lossy();
    name.strip_suffix(".bake.ron")
        .or_else(|| name.rsplit_once('.').map(|(stem, _)| stem))
        .unwrap_or(&name)
        .to_owned()
}

/// Whether two paths lead to the same file.
fn is_same(a: &Path, b: &Path) -> bool {
    a == b || fs::canonicalize(a).is_ok_and(|a| fs::canonicalize(b).is_ok_and(|b| a == b))
}

/// Bakes a mesh unless it is up to date. Returns the line to print.
fn bake(options: &Options, source: &Path, target: &Path, pool: &rayon::ThreadPool) -> Outcome<String> {
    let imported = import_file(source)?;
    let (own, hash) = match &imported {
        Imported::Mesh {
            settings, source_hash, ..
        } => (*settings, *source_hash),
        Imported::Baked { header, .. } => (header.settings, header.source_hash),
    };
    let settings = BakeSettings {
        faces: options.faces || own.faces,
        degrees: options.degrees.unwrap_or(own.degrees),
        image: options.image.unwrap_or(own.image),
        weld_tolerance: options.weld_tolerance.unwrap_or(own.weld_tolerance),
        inward: match options.inward {
            None => own.inward,
            Some(InwardChoice::Room) => Inward::Room,
            Some(InwardChoice::Solid) => Inward::Solid,
        },
    };
    settings.validate().map_err(|e| format!("{}: {e}", source.display()))?;
    if !options.force && is_up_to_date(target, &hash, &settings) {
        return Ok(format!("{} is up to date\n", target.display()));
    }
    let start = Instant::now();
    let baked = with_bar(&source.display().to_string(), settings, |progress| match &imported {
        Imported::Mesh { mesh, .. } => CollisionMesh::bake(mesh, settings, pool, progress),
        Imported::Baked { mesh, .. } => mesh.rebake(settings, pool, progress),
    })?;
    mesh::warn_all(source, imported.warnings());
    mesh::warn(source, &baked);
    let bytes = format::to_bytes(&baked, hash);
    output::save(target, &bytes)?;
    Ok(format!(
        "{} -> {}: {} triangles, {} bytes, {:.2} s\n",
        source.display(),
        target.display(),
        baked.mesh.triangles().len(),
        bytes.len(),
        start.elapsed().as_secs_f64()
    ))
}

/// Whether the target is up to date. It is not if it does not exist or is not a valid baked file.
fn is_up_to_date(target: &Path, hash: &Hash, settings: &BakeSettings) -> bool {
    import_file(target)
        .is_ok_and(|there| matches!(there, Imported::Baked { header, .. } if header.is_up_to_date(hash, settings)))
}
