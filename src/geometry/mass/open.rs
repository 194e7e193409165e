//! The mass of an open mesh: by sampling the winding number, or as a shell along the faces.

use super::{MIN_VOLUME, MassBasis, Solid, outer, solid_box};
use crate::geometry::winding::Winding;
use crate::geometry::{Aabb, TriMesh};
use glam::{DMat3, DVec3};

/// Samples along the longest edge of the bounding box at first.
const SAMPLES: f64 = 8.0;
/// The most parts along each axis into which a sample at the border is split.
const MAX_PARTS: u32 = 4;
/// The number of triangles and nodes that samples at the border may look at, for each triangle of the mesh: about a
/// tenth of a millisecond.
const WORK: f64 = 3.0e3;
/// The least and the most of this work for a mesh: a millisecond, a tenth of a second.
const WORK_OF_MESH: [f64; 2] = [4.0e4, 3.0e6];
/// With a larger error there is no inside to speak of.
const MAX_ERROR: f64 = 0.5;
/// The largest part of the sides of the bounding box through which the inside may reach out.
const MAX_REACH: f64 = 0.1;
/// At least this part of the inside must have a winding number above [`SURE`]. Below a hilly terrain it barely exceeds
/// a half.
const MIN_SURE: f64 = 0.25;
const SURE: f64 = 0.75;
/// A sample is at the border if its winding number is this close to a half.
const NEAR: f64 = 0.25;

/// The mass of an open mesh, its basis, and its error; see [`MassProperties::with_shell`](super::MassProperties).
pub(super) fn solid(mesh: &TriMesh, aabb: Aabb, shell: f64) -> (Solid, MassBasis, f64) {
    if let Some((solid, error)) = inside(mesh, aabb) {
        return (solid, MassBasis::Winding, error);
    }
    match along_faces(mesh, aabb, shell) {
        Some(solid) => (solid, MassBasis::Shell, 1.0),
        None => (solid_box(aabb), MassBasis::Box, 1.0),
    }
}

/// The samples of the bounding box.
struct Grid {
    winding: Winding,
    low: DVec3,
    /// The size of a sample's cell.
    cell: DVec3,
    counts: [i32; 3],
}

impl Grid {
    fn number(&self, [x, y, z]: [i32; 3]) -> f64 {
        let at = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) + 0.5;
        self.winding.number(self.low + self.cell * at, None)
    }

    fn all(&self) -> impl Iterator<Item = [i32; 3]> {
        indices(self.counts)
    }

    fn index(&self, [x, y, z]: [i32; 3]) -> Option<usize> {
        let [nx, ny, nz] = self.counts;
        let is_inside = (0..nx).contains(&x) && (0..ny).contains(&y) && (0..nz).contains(&z);
        is_inside.then_some(((x * ny + y) * nz + z) as usize)
    }
}

/// All indices below these counts.
fn indices([nx, ny, nz]: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    (0..nx).flat_map(move |x| (0..ny).flat_map(move |y| (0..nz).map(move |z| [x, y, z])))
}

/// The six neighbours of a sample.
fn neighbors([x, y, z]: [i32; 3]) -> [[i32; 3]; 6] {
    [
        [x - 1, y, z],
        [x + 1, y, z],
        [x, y - 1, z],
        [x, y + 1, z],
        [x, y, z - 1],
        [x, y, z + 1],
    ]
}

/// Sums of volumes.
struct Sums {
    volume: f64,
    first: DVec3,
    second: DMat3,
    /// The volume of samples at the border.
    border: f64,
}

/// The places where the winding number exceeds a half, and their relative error; `None` if there are none that a body
/// could have.
fn inside(mesh: &TriMesh, aabb: Aabb) -> Option<(Solid, f64)> {
    let (low, size) = (aabb.min.as_dvec3(), (aabb.max - aabb.min).as_dvec3());
    if size.min_element() <= 1.0e-6 * size.max_element() {
        return None;
    }
    let counts = (size / size.max_element() * SAMPLES).ceil().max(DVec3::splat(4.0));
    let grid = Grid {
        winding: Winding::new(mesh),
        low,
        cell: size / counts,
        counts: counts.to_array().map(|n| n as i32),
    };
    if reaches_out(&grid) {
        return None;
    }
    let before = grid.winding.work();
    let numbers: Vec<f64> = grid.all().map(|at| grid.number(at)).collect();
    let work = (grid.winding.work() - before) as f64 / numbers.len() as f64;
    let share = |least: f64| numbers.iter().filter(|number| **number > least).count() as f64;
    if share(SURE) < MIN_SURE * share(0.5) {
        return None;
    }
    let is_border = |at: [i32; 3]| {
        let own = numbers[grid.index(at).unwrap_or(0)];
        let differs = |other: Option<usize>| (other.map_or(0.0, |other| numbers[other]) > 0.5) != (own > 0.5);
        (own - 0.5).abs() < NEAR || neighbors(at).iter().any(|&other| differs(grid.index(other)))
    };
    let at_border = grid.all().filter(|&at| is_border(at)).count() as f64;
    let [least, most] = WORK_OF_MESH;
    let max_work = (WORK * mesh.triangles().len() as f64).clamp(least, most);
    let is_affordable = |parts: &u32| at_border * f64::from(*parts).powi(3) * work <= max_work;
    let parts = (1..=MAX_PARTS).rev().find(is_affordable).unwrap_or(1);
    let mut sums = Sums {
        volume: 0.0,
        first: DVec3::ZERO,
        second: DMat3::ZERO,
        border: 0.0,
    };
    let middle = low + size * 0.5;
    for (at, &number) in grid.all().zip(&numbers) {
        if is_border(at) {
            add(&grid, at, None, parts as i32, middle, &mut sums);
        } else {
            add(&grid, at, Some(number), 1, middle, &mut sums);
        }
    }
    let diagonal = size.length();
    let error = 0.5 * sums.border / sums.volume;
    if sums.volume <= MIN_VOLUME * diagonal.powi(3) || error > MAX_ERROR {
        return None;
    }
    let center = sums.first / sums.volume;
    let solid = Solid {
        volume: sums.volume,
        center: center + middle,
        second_moment: sums.second - outer(center) * sums.volume,
    };
    Some((solid, error))
}

/// Whether the inside reaches out of the bounding box through too much of its sides.
fn reaches_out(grid: &Grid) -> bool {
    let (mut reached, mut all) = (0.0, 0.0);
    for at in grid.all() {
        for other in neighbors(at).into_iter().filter(|other| grid.index(*other).is_none()) {
            // The area of the side.
            let axis = (0..3).find(|&axis| at[axis] != other[axis]).unwrap_or(0);
            let area = grid.cell.element_product() / grid.cell[axis];
            all += area;
            if grid.number(other) > 0.5 {
                reached += area;
            }
        }
    }
    reached > MAX_REACH * all
}

/// Adds a sample in `parts` parts along each axis. `number` is its winding number; without it each part has its own.
fn add(grid: &Grid, at: [i32; 3], number: Option<f64>, parts: i32, middle: DVec3, sums: &mut Sums) {
    let corner = grid.low + grid.cell * DVec3::from_array(at.map(f64::from));
    let part = grid.cell / f64::from(parts);
    let volume = part.element_product();
    // A part that differs from one before it is at the border. Differences between samples are not looked for.
    let mut before: Vec<bool> = Vec::new();
    for [x, y, z] in indices([parts; 3]) {
        let p = corner + part * (DVec3::new(f64::from(x), f64::from(y), f64::from(z)) + 0.5);
        let is_inside = number.unwrap_or_else(|| grid.winding.number(p, None)) > 0.5;
        let index = before.len() as i32;
        before.push(is_inside);
        let differs = |step: i32| before[(index - step) as usize] != is_inside;
        let is_border = (x > 0 && differs(parts * parts)) || (y > 0 && differs(parts)) || (z > 0 && differs(1));
        // A sample that is not split is at the border as a whole.
        if is_border || (number.is_none() && parts == 1) {
            sums.border += volume;
        }
        if is_inside {
            let p = p - middle;
            sums.volume += volume;
            sums.first += p * volume;
            sums.second += outer(p) * volume + DMat3::from_diagonal(part * part * (volume / 12.0));
        }
    }
}

/// A shell of even thickness along the faces; `None` if they have no area.
fn along_faces(mesh: &TriMesh, aabb: Aabb, shell: f64) -> Option<Solid> {
    let origin = (aabb.min.as_dvec3() + aabb.max.as_dvec3()) * 0.5;
    let thickness = shell * (aabb.max.as_dvec3() - aabb.min.as_dvec3()).length();
    let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
    for t in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.corners(t).map(|v| v.as_dvec3() - origin);
        let area_vector = (b - a).cross(c - a) * 0.5;
        let own = area_vector.length() * thickness;
        let sum = a + b + c;
        volume += own;
        first += sum * (own / 3.0);
        second += (outer(a) + outer(b) + outer(c) + outer(sum)) * (own / 12.0);
        // Across the shell.
        second += outer(area_vector.normalize_or_zero()) * (own * thickness * thickness / 12.0);
    }
    let center = first / volume;
    let second_moment = second - outer(center) * volume;
    let diagonal = [second_moment.x_axis.x, second_moment.y_axis.y, second_moment.z_axis.z];
    (volume > 0.0 && diagonal.iter().all(|m| *m > 0.0)).then_some(Solid {
        volume,
        center: center + origin,
        second_moment,
    })
}
