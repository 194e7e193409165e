//! Baking a [`FaceTable`]: draws all directions in parallel.

use super::groups::{Interner, pack_bits};
use super::raster::{Raster, Scratch};
use super::{BakeSettings, Cancelled, FaceTable, Progress};
use crate::geometry::TriMesh;
use crate::geometry::direction::DirectionGrid;
use rayon::prelude::*;

/// Directions per task: a few milliseconds of work for a small mesh.
const TASK: u32 = 128;

/// The groups of consecutive directions. They are run-length encoded at once, so that the raw form never exists as a
/// whole.
#[derive(Default)]
struct Runs {
    /// The length of each run, and the end of its group in `data`.
    runs: Vec<(u32, usize)>,
    data: Vec<u8>,
}

impl FaceTable {
    /// Draws the mesh along all directions and collects the visible triangles.
    ///
    /// All work runs on `pool`. The table does not depend on the number of threads. `progress` counts the directions
    /// done, and the bake checks after each direction whether it was cancelled.
    ///
    /// Settings should be [valid](BakeSettings::validate). Invalid ones are adjusted: the image size is clamped, and
    /// the angular step becomes the next smaller divisor of 90.
    ///
    /// # Errors
    /// [`Cancelled`] if the bake was cancelled through `progress`.
    pub fn bake(
        mesh: &TriMesh,
        settings: &BakeSettings,
        pool: &rayon::ThreadPool,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let step = (1..=settings.degrees.clamp(1, 90)).rev().find(|s| 90 % s == 0);
        let grid = step.and_then(DirectionGrid::new).expect("1 divides 90");
        progress.begin(grid.len());
        // A bake that was cancelled while it was queued should not do the preparation.
        progress.advance(0)?;
        pool.install(|| {
            let raster = Raster::new(mesh, settings.image);
            let triangles = mesh.triangles().len() as u32;
            let tasks: Vec<Runs> = (0..grid.len().div_ceil(TASK))
                .into_par_iter()
                .map_init(Scratch::default, |scratch, task| {
                    let directions = task * TASK..((task + 1) * TASK).min(grid.len());
                    draw(&raster, grid, directions, triangles, scratch, progress)
                })
                .collect::<Result<_, _>>()?;

            let mut interner = Interner::new();
            let mut runs = Vec::new();
            for task in tasks {
                let mut start = 0;
                for (count, end) in task.runs {
                    runs.push((interner.intern(&task.data[start..end]), count));
                    start = end;
                }
            }
            Ok(Self::collect(grid, triangles, runs.into_iter(), interner))
        })
    }
}

fn draw(
    raster: &Raster,
    grid: DirectionGrid,
    directions: std::ops::Range<u32>,
    triangles: u32,
    scratch: &mut Scratch,
    progress: &Progress,
) -> Result<Runs, Cancelled> {
    let mut out = Runs::default();
    let mut previous = Vec::new();
    for direction in directions {
        let visible = raster.visible_bits(&grid.rotation(direction), scratch);
        match out.runs.last_mut() {
            Some((count, _)) if previous == visible => *count += 1,
            _ => {
                pack_bits(visible, triangles, &mut out.data);
                out.runs.push((1, out.data.len()));
                previous.clear();
                previous.extend_from_slice(visible);
            }
        }
        progress.advance(1)?;
    }
    Ok(out)
}
