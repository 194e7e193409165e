//! What two triangles may have: features and a crossing, as bits.

/// Features that two triangles may have, and whether they may cross, as bits. Corner `k` of the first triangle over the
/// face of the second is bit `k`; corner `k` of the second over the first is bit `3 + k`; edge `k` of the first with edge
/// `l` of the second is bit `6 + 3 k + l`; the crossing is [`CROSSING`].
pub type Parts = u16;

/// The bit of [`Parts`] for the crossing of two triangles.
pub const CROSSING: Parts = 1 << 15;

/// The [`Parts`] of corners, by sets of three corners of the first triangle and of three of the second.
#[inline]
pub fn corner_parts([first, second]: [u32; 2]) -> Parts {
    (first | second << 3) as Parts
}

/// The [`Parts`] of edges, by sets of three edges of the first triangle and of three of the second.
#[inline]
pub fn edge_parts([first, second]: [u32; 2]) -> Parts {
    const ROWS: [Parts; 8] = edge_sets(0b111, 3);
    const COLUMNS: [Parts; 8] = edge_sets(0b1_001_001, 1);
    ROWS[first as usize] & COLUMNS[second as usize]
}

/// For each subset of the three edges of one triangle, its [`Parts`] with all edges of the other. `parts` are those of
/// the first edge; `shift` leads to the next edge.
const fn edge_sets(parts: Parts, shift: usize) -> [Parts; 8] {
    let mut sets = [0; 8];
    let mut set = 0;
    while set < sets.len() {
        let mut edge = 0;
        while edge < 3 {
            if set >> edge & 1 == 1 {
                sets[set] |= parts << (6 + shift * edge);
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
pub fn owned_features(owned: [u32; 2]) -> Parts {
    let [first, second] = owned;
    let over = |triangle: u32| u32::from(triangle & FACE_BIT != 0).wrapping_neg();
    let corners = [first & CORNER_BITS & over(second), second & CORNER_BITS & over(first)];
    corner_parts(corners) | edge_parts([first >> 3 & CORNER_BITS, second >> 3 & CORNER_BITS])
}

/// A feature of two triangles.
#[derive(Clone, Copy, Debug)]
pub enum Part {
    /// This corner of a side's triangle over the other triangle.
    Vertex { side: usize, k: usize },
    /// These two edges.
    Edges([usize; 2]),
}

impl Part {
    /// The feature that a bit of [`Parts`] stands for.
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
