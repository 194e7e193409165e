//! [`FeatureId`]: persistent ids of the vertices, edges and faces at which meshes touch.

use std::fmt;

/// The feature of a mesh at a contact point, packed into 32 bits.
///
/// Two contact points of a pair, found at different times, are the same point if their ids agree on both sides. The ids
/// of a mesh depend only on the source mesh and its bake settings, not on its pose, on the other body, or on the run of
/// the program. Ids of overlaps are different: see [`FeatureKind::Overlap`]. No id is zero.
///
/// An index has 28 bits. In a mesh with more than 89 million faces different features may have the same id.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FeatureId(u32);

/// The kinds of features of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum FeatureKind {
    /// A corner. The index is that of the vertex in the source mesh. Vertices that are welded have the same index.
    Vertex,
    /// An edge between two faces, or at a boundary. The index is `3 f + e`, where `f` is the index of a face at the
    /// edge, and `e` is 0 for the edge from the face's first corner to its second, 1 for the next edge and 2 for the
    /// last one. `f` is always the same one of the edge's faces.
    Edge,
    /// The interior of a face. The index is that of the face in the source mesh.
    Face,
    /// A place in a region of overlap, found by a ray through both bodies. The index is the number of the region among
    /// those of the pair at the time.
    ///
    /// Several regions may exchange their numbers as bodies move, above all when one appears or vanishes. Places may
    /// exchange their numbers when the region changes its shape. Match these points by their positions too.
    Overlap {
        /// 0 for the middle of the region, 1 to 4 for places towards its contour, 5 for a region that no ray leaves, 6
        /// and 7 for where the first and the second body reach deepest.
        place: u8,
    },
    /// One body is wholly inside the other. The index is 0, because a pair has one such point.
    Containment,
}

const INDEX_BITS: u32 = 28;
const INDEX: u32 = (1 << INDEX_BITS) - 1;

const VERTEX: u32 = 1;
const EDGE: u32 = 2;
const FACE: u32 = 3;
const CONTAINMENT: u32 = 4;
/// The code of place 0. Those of the other places follow.
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

    /// The kind of the feature.
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

    /// The index of the feature within its kind; see [`FeatureKind`].
    pub fn index(self) -> u32 {
        self.0 & INDEX
    }

    /// The id as a number that is not zero: the kind in the upper 4 bits, the index in the lower 28 bits.
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
        let overlaps = (0..8).map(|place| FeatureKind::Overlap { place });
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
