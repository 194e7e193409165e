//! What two triangles may have: features and a crossing, as bits.

/// Features that two triangles may have, and whether they may cross, as bits. Corner `k` of the first triangle over the
/// face of the second is bit `k`; corner `k` of the second over the first is bit `3 + k`; edge `k` of the first with
/// edge `l` of the second is bit `6 + 3 k + l`; the crossing is [`CROSSING`].
pub type FeatureBits = u16;

/// The bit of [`FeatureBits`] for the crossing of two triangles.
pub const CROSSING: FeatureBits = 1 << 15;

/// The [`FeatureBits`] of corners, by sets of three corners of the first triangle and of three of the second.
#[inline]
pub fn corner_features([first, second]: [u32; 2]) -> FeatureBits {
    (first | second << 3) as FeatureBits
}

/// The [`FeatureBits`] of edges, by sets of three edges of the first triangle and of three of the second.
#[inline]
pub fn edge_features([first, second]: [u32; 2]) -> FeatureBits {
    const ROWS: [FeatureBits; 8] = edge_sets(0b111, 3);
    const COLUMNS: [FeatureBits; 8] = edge_sets(0b1_001_001, 1);
    ROWS[first as usize] & COLUMNS[second as usize]
}

/// For each subset of the three edges of one triangle, its [`FeatureBits`] with all edges of the other. `first` are
/// those of the first edge; `shift` leads to the next edge.
const fn edge_sets(first: FeatureBits, shift: usize) -> [FeatureBits; 8] {
    let mut sets = [0; 8];
    let mut set = 0;
    while set < sets.len() {
        let mut edge = 0;
        while edge < 3 {
            if set >> edge & 1 == 1 {
                sets[set] |= first << (6 + shift * edge);
            }
            edge += 1;
        }
        set += 1;
    }
    sets
}

/// Bits of what a triangle owns, see `MeshFeatures::owned`: its corners, its edges, and its face.
pub const CORNER_BITS: u32 = 0b111;
pub const EDGE_BITS: u32 = CORNER_BITS << 3;
pub const FACE_BIT: u32 = 1 << 6;

/// The features of two triangles, from what each owns.
#[inline(always)]
pub fn owned_features(owned: [u32; 2]) -> FeatureBits {
    let [first, second] = owned;
    let over = |triangle: u32| u32::from(triangle & FACE_BIT != 0).wrapping_neg();
    let corners = [first & CORNER_BITS & over(second), second & CORNER_BITS & over(first)];
    corner_features(corners) | edge_features([first >> 3 & CORNER_BITS, second >> 3 & CORNER_BITS])
}

/// A feature of two triangles.
#[derive(Clone, Copy, Debug)]
pub enum FeatureBit {
    /// This corner of a side's triangle over the other triangle.
    Vertex { side: usize, k: usize },
    /// These two edges.
    Edges([usize; 2]),
}

impl FeatureBit {
    /// The feature that a bit of [`FeatureBits`] stands for.
    #[inline]
    pub fn of(bit: usize) -> Self {
        match bit {
            0..6 => Self::Vertex {
                side: bit / 3,
                k: bit % 3,
            },
            _ => Self::Edges([(bit - 6) / 3, (bit - 6) % 3]),
        }
    }
}
