//! Names for the parts of a mesh that touch, which last from step to step.

use std::fmt;

/// What of a mesh a contact point is made of, packed into 32 bits.
///
/// Two points of the same two bodies are the same one, some time later, if the ids agree on both sides. The ids of one mesh
/// do not depend on where it is, on the other body, or on the run of the program: they follow from the input mesh and its
/// bake settings. None is zero.
///
/// An index has 28 bits. Of meshes of more than 89 million faces different features may have the same id.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FeatureId(u32);

/// The kinds of features of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum FeatureKind {
    /// A corner. The index is that of the vertex in the input mesh. Of vertices that count as one it is always the same.
    Vertex,
    /// An edge between two faces, or at a rim. The index is three times that of a face at the edge, plus 0 for the edge from
    /// the face's first corner to its second, 1 for the next, 2 for the last. It is always the same one of the two faces.
    Edge,
    /// The inside of a face. The index is that of the face in the input mesh.
    Face,
    /// A place in a region of overlap, which is found by a ray through both bodies. The index stands for the region: it is
    /// that of an edge or a face of the region's contour, in an order of the bake. It changes when the contour leaves them,
    /// and as the region changes its shape its places may exchange numbers: such points may be matched better by where they
    /// are.
    Overlap {
        /// 0 for the middle of the region, 1 to 4 for places towards its contour, 5 for a region that no ray leaves.
        place: u8,
    },
    /// A body that is inside the other, or has the other inside. The index is 0: there is one such point of two bodies.
    Containment,
}

const INDEX_BITS: u32 = 28;
const INDEX: u32 = (1 << INDEX_BITS) - 1;

const VERTEX: u32 = 1;
const EDGE: u32 = 2;
const FACE: u32 = 3;
const CONTAINMENT: u32 = 4;
/// The first place; the others follow.
const OVERLAP: u32 = 8;

impl FeatureId {
    pub(crate) fn new(kind: FeatureKind, index: u32) -> Self {
        let code = match kind {
            FeatureKind::Vertex => VERTEX,
            FeatureKind::Edge => EDGE,
            FeatureKind::Face => FACE,
            FeatureKind::Containment => CONTAINMENT,
            FeatureKind::Overlap { place } => OVERLAP + u32::from(place),
        };
        Self(code << INDEX_BITS | index & INDEX)
    }

    /// What kind of feature it is.
    pub fn kind(self) -> FeatureKind {
        match self.0 >> INDEX_BITS {
            VERTEX => FeatureKind::Vertex,
            EDGE => FeatureKind::Edge,
            FACE => FeatureKind::Face,
            CONTAINMENT => FeatureKind::Containment,
            code => FeatureKind::Overlap {
                place: (code - OVERLAP) as u8,
            },
        }
    }

    /// Which one of its kind; see [`FeatureKind`].
    pub fn index(self) -> u32 {
        self.0 & INDEX
    }

    /// All of it as a number, which is not zero: the kind in the upper 4 bits, the index in the lower 28.
    pub fn bits(self) -> u32 {
        self.0
    }
}

impl fmt::Debug for FeatureId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} {}", self.kind(), self.index())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kind_and_index_come_back() {
        let overlaps = (0..6).map(|place| FeatureKind::Overlap { place });
        let kinds = [
            FeatureKind::Vertex,
            FeatureKind::Edge,
            FeatureKind::Face,
            FeatureKind::Containment,
        ];
        for kind in kinds.into_iter().chain(overlaps) {
            for index in [0, 1, 77, INDEX] {
                let id = FeatureId::new(kind, index);
                assert_eq!((id.kind(), id.index()), (kind, index));
                assert_ne!(id.bits(), 0);
            }
        }
    }
}
