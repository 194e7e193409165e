//! To which side the faces of a mesh push.

use super::weld::scattered;
use super::winding::Winding;
use crate::geometry::{Orientation, TriMesh};

/// A face is one-sided if the winding number is within this of 0 before it and of 1 behind it.
const DOUBT: f64 = 0.25;

/// How many triangles and nodes the winding numbers of a mesh may look at: a fixed number, and a number for each
/// triangle. About 20 ms, and a millisecond for a thousand triangles. Where triangles are long, a single number may
/// look at all of them.
const WORK: [u64; 2] = [1_500_000, 50];

/// Which triangles of a mesh are *one-sided*. Those push only to the side to which their normal points, and a body
/// behind them is inside. A *two-sided* triangle pushes to the side on which the other body's centre is.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum OneSided {
    /// All of them.
    #[default]
    All,
    /// None of them.
    None,
    /// The triangles with `true`.
    Some(Vec<bool>),
}

impl OneSided {
    /// Decides for each triangle whether it is one-sided.
    ///
    /// * All triangles of a closed and consistently wound mesh are one-sided.
    /// * In a nearly closed mesh (see [`TriMesh::caps`]) a triangle is one-sided if the winding number around it is
    ///   nearly that of a solid's surface. A loose sheet in a solid stays two-sided. All faces of a piece of surface
    ///   without a border are one-sided. In a large mesh only some numbers are computed, at least one for each piece of
    ///   surface as long as there is time; other triangles are like the nearest of them in the piece.
    /// * All others are two-sided. The winding number alone would not do: at the bottom of a box without a lid it is
    ///   within a tenth of that of a solid, and a ball in the box would be pushed out through the bottom.
    pub fn of(mesh: &TriMesh) -> Self {
        match mesh.orientation() {
            Orientation::Outward | Orientation::Inward => return Self::All,
            Orientation::Open if !mesh.caps().is_empty() => {}
            Orientation::Open | Orientation::Mixed => return Self::None,
        }
        let [fixed, each] = WORK;
        nearly_closed(mesh, fixed + each * mesh.triangles().len() as u64)
            .0
            .into()
    }

    /// Whether a triangle is one-sided.
    #[inline]
    pub fn is(&self, triangle: usize) -> bool {
        match self {
            Self::All => true,
            Self::None => false,
            Self::Some(some) => some[triangle],
        }
    }

    /// Whether all triangles are one-sided.
    #[inline]
    pub fn all(&self) -> bool {
        *self == Self::All
    }
}

impl From<Vec<bool>> for OneSided {
    fn from(some: Vec<bool>) -> Self {
        if !some.contains(&false) {
            Self::All
        } else if !some.contains(&true) {
            Self::None
        } else {
            Self::Some(some)
        }
    }
}

/// Which triangles of a nearly closed mesh are one-sided, and how many triangles and nodes were looked at. When there
/// were more than `most`, no further number is computed.
fn nearly_closed(mesh: &TriMesh, most: u64) -> (Vec<bool>, u64) {
    let patches = mesh.patches();
    let patch = |t: usize| patches.of_triangles[t] as usize;
    let count = mesh.triangles().len();
    let open: Vec<usize> = (0..count).filter(|&t| !patches.is_closed[patch(t)]).collect();
    let winding = Winding::new(mesh);
    let mut known: Vec<Option<bool>> = vec![None; count];
    // One triangle of each patch comes first.
    let mut is_begun = vec![false; patches.is_closed.len()];
    let firsts: Vec<usize> = (open.iter().copied())
        .filter(|&t| !std::mem::replace(&mut is_begun[patch(t)], true))
        .collect();
    let firsts = scattered(firsts.len()).map(|i| firsts[i]);
    for t in firsts.chain(scattered(open.len()).map(|i| open[i])) {
        if winding.work() > most {
            break;
        }
        if known[t].is_none() {
            let [a, b, c] = mesh.welded_corners(t).map(|v| v.as_dvec3());
            // The triangle itself adds a half behind it, and takes a half away before it.
            known[t] = Some((winding.number((a + b + c) / 3.0, Some(t)) - 0.5).abs() <= DOUBT);
        }
    }
    let yes = known.iter().flatten().filter(|known| **known).count();
    let most_are = 2 * yes >= known.iter().flatten().count();
    // The last known triangle of each patch: first going forward, then going backward.
    let mut last: Vec<Option<bool>> = vec![None; patches.is_closed.len()];
    let mut before = vec![None; count];
    for &t in &open {
        last[patch(t)] = known[t].or(last[patch(t)]);
        before[t] = last[patch(t)];
    }
    last.fill(None);
    let mut one_sided = vec![true; count];
    for &t in open.iter().rev() {
        last[patch(t)] = known[t].or(last[patch(t)]);
        one_sided[t] = known[t].or(before[t]).or(last[patch(t)]).unwrap_or(most_are);
    }
    for [t, first] in mesh.twins() {
        one_sided[t] = one_sided[first];
    }
    (one_sided, winding.work())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A prism of so many long strips, whose ends are fans of slivers, without one of its faces.
    fn open_prism(sides: u32) -> TriMesh {
        let at = |i: u32, z: f32| {
            let angle = i as f32 / sides as f32 * std::f32::consts::TAU;
            Vec3::new(angle.cos(), angle.sin(), z)
        };
        let vertices = (0..2 * sides).map(|i| at(i % sides, if i < sides { 0.0 } else { 2.0 }));
        let strip = |i: u32| {
            let (a, b) = (i, (i + 1) % sides);
            [[a, b, a + sides], [b, b + sides, a + sides]]
        };
        let fans = (1..sides - 1).flat_map(|i| [[0, i + 1, i], [sides, sides + i, sides + i + 1]]);
        let faces = (0..sides).flat_map(strip).chain(fans).skip(1);
        TriMesh::new(vertices.collect(), faces.collect()).unwrap()
    }

    #[test]
    fn long_slivers_take_no_more_work_than_there_is_for_each_triangle() {
        for sides in [500, 8_000] {
            let mesh = open_prism(sides);
            let count = mesh.triangles().len() as u64;
            let [fixed, each] = WORK;
            let (one_sided, work) = nearly_closed(&mesh, fixed + each * count);
            // The last number may look at all of them.
            assert!(work <= fixed + (each + 3) * count, "{work} for {count} triangles");
            assert!(one_sided.iter().all(|one_sided| *one_sided));
        }
    }

    #[test]
    fn surfaces_without_a_border_need_no_numbers_beside_one_that_has_one() {
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        let ball = crate::geometry::shapes::ball(1.0, 2);
        for part in 0..20 {
            let first = vertices.len() as u32;
            vertices.extend(ball.vertices().iter().map(|p| *p + Vec3::X * (3 * part) as f32));
            faces.extend(ball.triangles().iter().map(|t| t.map(|v| v + first)));
        }
        faces.pop();
        let mesh = TriMesh::new(vertices, faces).unwrap();
        let (one_sided, work) = nearly_closed(&mesh, u64::MAX);
        assert!(one_sided.iter().all(|one_sided| *one_sided));
        let open = ball.triangles().len() as u64 - 1;
        assert!(work < 1000 * open, "{work} for {open} triangles of an open surface");
    }

    #[test]
    fn with_little_work_each_loose_sheet_is_still_found() {
        let ball = crate::geometry::shapes::ball(1.0, 4);
        let (mut vertices, mut faces) = (ball.vertices().to_vec(), ball.triangles().to_vec());
        faces.pop();
        for sheet in 0..10 {
            let first = vertices.len() as u32;
            let at = Vec3::X * (0.1 * sheet as f32 - 0.5);
            vertices.extend([at, at + Vec3::Y * 0.05, at + Vec3::Z * 0.05]);
            faces.push([first, first + 1, first + 2]);
        }
        let mesh = TriMesh::new(vertices, faces).unwrap();
        assert!(!mesh.caps().is_empty());
        let (one_sided, _) = nearly_closed(&mesh, 20_000);
        let two_sided: Vec<usize> = (0..one_sided.len()).filter(|&t| !one_sided[t]).collect();
        let sheets: Vec<usize> = (one_sided.len() - 10..one_sided.len()).collect();
        assert_eq!(two_sided, sheets);
    }
}
