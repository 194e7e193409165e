//! The bake of one mesh.

use super::Options;
use super::claim::Claim;
use super::report::{Report, Status};
use crate::{Outcome, output};
use bevy_faceoff::asset::format::{self, HEADER_LENGTH, Hash};
use bevy_faceoff::asset::{CollisionMesh, Imported, Origin, import_file};
use bevy_faceoff::projection::{BakeSettings, Progress};
use rayon::ThreadPool;
use std::fs::{self, File};
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Instant;

/// What to do if another process has claimed the mesh.
#[derive(Clone, Copy, PartialEq)]
pub enum Claimed {
    /// Leave it for later.
    Leave,
    /// Bake it.
    Bake,
}

/// Bakes a mesh unless it is up to date. `None` if it is left to another process.
pub fn bake(
    options: &Options,
    (source, target): (&Path, &Path),
    claimed: Claimed,
    pool: &ThreadPool,
    progress: &Progress,
) -> Option<Report> {
    let start = Instant::now();
    let bake = || try_bake(options, (source, target), claimed, pool, progress);
    let result = catch_unwind(AssertUnwindSafe(bake)).unwrap_or_else(|_| {
        let name = source.display();
        Err(format!("{name}: the bake panicked, which is a bug: please report it").into())
    });
    let mut report = match result {
        Ok(report) => report?,
        Err(error) => Report::failed(source, Some(target), error.to_string()),
    };
    report.seconds = start.elapsed().as_secs_f64();
    Some(report)
}

fn try_bake(
    options: &Options,
    (source, target): (&Path, &Path),
    claimed: Claimed,
    pool: &ThreadPool,
    progress: &Progress,
) -> Outcome<Option<Report>> {
    let report = |status, triangles, bytes| Report {
        status,
        triangles: Some(triangles),
        bytes: Some(bytes),
        ..Report::new(source, Some(target))
    };
    let valid = |own: BakeSettings| -> Outcome<BakeSettings> {
        let settings = options.settings(own);
        settings.validate().map_err(|e| format!("{}: {e}", source.display()))?;
        Ok(settings)
    };
    let mut claim = None;
    if !options.force {
        let origin = Origin::read(source)?;
        let settings = valid(origin.settings)?;
        let there = || up_to_date(target, &origin.source_hash, &settings);
        let mut found = there();
        if found.is_none() {
            if let Some(folder) = target.parent() {
                output::folder(folder)?;
            }
            claim = match claimed {
                Claimed::Bake => Some(Claim::take_over(target)),
                Claimed::Leave => match Claim::take(target) {
                    None => return Ok(None),
                    claim => claim,
                },
            };
            // Another process may have baked it, and ended its claim, since.
            found = there();
        }
        if let Some((triangles, bytes)) = found {
            return Ok(Some(report(Status::UpToDate, triangles, bytes)));
        }
    }
    let imported = import_file(source)?;
    let (own, hash) = match &imported {
        Imported::Mesh {
            settings, source_hash, ..
        } => (*settings, *source_hash),
        Imported::Baked { header, .. } => (header.settings, header.source_hash),
    };
    let settings = valid(own)?;
    let baked = match &imported {
        Imported::Mesh { mesh, .. } => CollisionMesh::bake(mesh, settings, pool, progress),
        Imported::Baked { mesh, .. } => mesh.rebake(settings, pool, progress),
    }?;
    let bytes = format::to_bytes(&baked, hash);
    if let Some(folder) = target.parent() {
        output::folder(folder)?;
    }
    output::save(target, &bytes)?;
    drop(claim);
    Ok(Some(Report {
        warnings: [imported.warnings(), &baked.warnings()].concat(),
        ..report(Status::Baked, baked.mesh.triangles().len() as u64, bytes.len() as u64)
    }))
}

/// The triangles and bytes of a baked file that is up to date. `None` if it is not, does not exist, or is damaged.
///
/// Most files that are not up to date differ in the header. Only where it agrees are the other bytes read, for their
/// checksum.
fn up_to_date(target: &Path, hash: &Hash, settings: &BakeSettings) -> Option<(u64, u64)> {
    // A pipe would block.
    fs::metadata(target).ok().filter(|there| there.is_file())?;
    let mut file = File::open(target).ok()?;
    let mut bytes = Vec::new();
    file.by_ref().take(HEADER_LENGTH as u64).read_to_end(&mut bytes).ok()?;
    let header = format::read_header(&bytes).ok()?;
    if !header.is_up_to_date(hash, settings) {
        return None;
    }
    file.read_to_end(&mut bytes).ok()?;
    let (_, triangles) = format::verify(&bytes).ok()?;
    Some((triangles.into(), bytes.len() as u64))
}
