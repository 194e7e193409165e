//! `faceoff bake`: bakes mesh files, and folders of them, into `.faceoff` files.

mod bar;
mod claim;
mod library;
mod memory;
mod one;
mod plan;
mod report;
mod shard;

use crate::{Outcome, Wrong, output};
use bevy_faceoff::asset::input_files;
use bevy_faceoff::projection::{BakeSettings, Inward};
use bytesize::ByteSize;
use report::Summary;
use shard::Shard;
use std::path::PathBuf;
use std::time::Instant;

/// Bake meshes into .faceoff files. Files that are up to date are skipped.
///
/// Exits with 0 if all meshes are baked or up to date, 1 if some failed or an output could not be written, 2 if the
/// command line is wrong. docs/LIBRARY.md has command lines for many machines.
#[derive(clap::Args)]
pub struct Options {
    /// Mesh files: .glb, .gltf, .obj, .stl, .ply, .off, .bake.ron or .faceoff; or folders, of which all meshes but
    /// .faceoff files are baked, into the same folders below the output. A mesh that a recipe of the folder names is
    /// baked by the recipe alone. Options override the settings of a .bake.ron file.
    #[arg(required = true)]
    meshes: Vec<PathBuf>,
    /// Folder for the baked files; created if it does not exist.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Also bake the face table, which takes seconds. The exact mode does not need it.
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
    /// Thickness of the shell that an open mesh weighs if it encloses nothing, relative to the mesh's size [default:
    /// 0.01].
    #[arg(long, value_name = "PART")]
    shell_thickness: Option<f32>,
    /// Radius of the rounding, mesh units [default: 0].
    #[arg(long, value_name = "RADIUS")]
    rounding: Option<f32>,
    /// Bake meshes even if they are up to date.
    #[arg(long)]
    force: bool,
    /// Bake only one part of the meshes: I of N, from 1/N to N/N. All parts together bake each mesh once. With auto,
    /// Slurm's array variables give I and N; with auto/N, Kubernetes' JOB_COMPLETION_INDEX gives I.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Start no further mesh while those being baked may take this much memory together, such as 2GiB. A mesh that may
    /// take more is baked alone.
    #[arg(long, value_name = "SIZE", default_value = "4GiB")]
    memory: ByteSize,
    /// Threads, at most 1024; 0 for one per core. No result depends on it.
    #[arg(long, default_value_t = 0, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(0..=1024))]
    threads: usize,
    /// Write what became of each mesh as JSON to this file, or - for standard output.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The values of `--inward`.
#[derive(Clone, Copy, clap::ValueEnum)]
enum InwardChoice {
    /// Bodies inside are free, and its walls push inward.
    Room,
    /// Its faces are flipped.
    Solid,
}

impl Options {
    /// The settings of a bake: the options, and the mesh's own settings where the options are left out.
    fn settings(&self, own: BakeSettings) -> BakeSettings {
        BakeSettings {
            faces: self.faces || own.faces,
            degrees: self.degrees.unwrap_or(own.degrees),
            image: self.image.unwrap_or(own.image),
            weld_tolerance: self.weld_tolerance.unwrap_or(own.weld_tolerance),
            inward: match self.inward {
                None => own.inward,
                Some(InwardChoice::Room) => Inward::Room,
                Some(InwardChoice::Solid) => Inward::Solid,
            },
            shell_thickness: self.shell_thickness.unwrap_or(own.shell_thickness),
            rounding: self.rounding.unwrap_or(own.rounding),
        }
    }
}

/// Runs the command. It tries all meshes, and fails if any of them failed.
pub fn run(options: &Options) -> Outcome {
    let start = Instant::now();
    // The settings of a mesh without a recipe.
    let settings = options.settings(BakeSettings::default());
    settings.validate().map_err(|error| Wrong(error.to_string()))?;
    output::folder(&options.output)?;
    if let Some(json) = &options.json {
        output::check(json)?;
    }
    let mut plan = plan::plan(&options.meshes, &options.output);
    if let Some(json) = &options.json {
        output::refuse(json, plan.entries.iter().filter_map(|entry| entry.target.as_ref()))?;
        // A file that is not there yet is no input, and a library is long.
        if json.exists() {
            let sources = plan.entries.iter().flat_map(|entry| &entry.sources);
            output::refuse(json, sources.flat_map(input_files))?;
        }
    }
    for warning in &plan.warnings {
        output::log(&format!("warning: {warning}"));
    }
    if let Some(shard) = options.shard {
        plan.entries.retain(|entry| shard.holds(&entry.key));
    }
    claim::remove_leftovers(plan.entries.iter().filter_map(|entry| entry.target.as_deref()));
    let (reports, printed) = library::bake(options, &plan.entries)?;
    let summary = Summary::new(options.shard, reports, start.elapsed());
    if plan.has_folders {
        output::table(options.json.as_deref(), &summary.line())?;
    }
    if let Some(json) = &options.json {
        output::json(json, &summary)?;
    }
    match summary.failed() {
        0 => printed,
        n => Err(format!("{n} of {} meshes could not be baked", summary.meshes()).into()),
    }
}
