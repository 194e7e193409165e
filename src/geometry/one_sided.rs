//! To which side the faces of a mesh push.

use super::winding::Winding;
use crate::geometry::{Orientation, TriMesh};

/// A face is one-sided if the winding number is within this of 0 before it and of 1 behind it.
const DOUBT: f64 = 0.25;

/// Which triangles of a mesh are *one-sided*. Those push only to the side to which their normal points, and a body behind them
/// is inside. A *two-sided* triangle pushes to the side on which the other body's centre is.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum OneSided {
    /// All of them.
    #[default]
    All,
    /// None of them.
    None,
    /// Those with `true`.
    Some(Vec<bool>),
}

impl OneSided {
    /// Decides it for each triangle.
    ///
    /// * All triangles of a closed and consistently wound mesh are one-sided.
    /// * In a nearly closed mesh (see [`TriMesh::caps`]) those are around which the winding number is nearly that of a solid's
    ///   surface. A loose sheet in a solid stays two-sided.
    /// * All others are two-sided. The winding number alone would not do: at the bottom of a box without a lid it is within a
    ///   tenth of that of a solid, and a ball in the box would be pushed out through the bottom.
    pub fn of(mesh: &TriMesh) -> Self {
        match mesh.orientation() {
            Orientation::Outward | Orientation::Inward => return Self::All,
            Orientation::Open if !mesh.caps().is_empty() => {}
            Orientation::Open | Orientation::Mixed => return Self::None,
        }
        let winding = Winding::new(mesh);
        let is_one_sided = |t: usize| {
            let [a, b, c] = mesh.welded_corners(t).map(|v| v.as_dvec3());
            // The triangle itself adds a half behind it, and takes a half away before it.
            (winding.number((a + b + c) / 3.0, Some(t)) - 0.5).abs() <= DOUBT
        };
        (0..mesh.triangles().len())
            .map(is_one_sided)
            .collect::<Vec<bool>>()
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

    /// Whether all triangles are.
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
