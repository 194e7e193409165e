//! The unique edges of a list of triangles.

/// Marks the side of a collapsed triangle whose two ends are the same vertex.
pub const NO_EDGE: u32 = u32::MAX;

/// Unique undirected edges, in the order of the triangles in which they first occur.
pub struct Edges {
    /// The two vertices of each edge, directed as in the first triangle that has it.
    pub ends: Vec<[u32; 2]>,
    /// The three edges of each triangle; the first leads from its first corner to its second.
    pub of_triangles: Vec<[u32; 3]>,
}

impl Edges {
    /// Collects the edges of `triangles`, whose vertex indices must be below `vertices`.
    pub fn of(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let mut degrees = vec![0u32; vertices];
        for &v in triangles.iter().flatten() {
            degrees[v as usize] += 1;
        }
        // Each edge is stored in the list of the end that has fewer triangles. So all lists are short, even when many
        // triangles meet at the tip of a cone.
        let mut first = vec![NO_EDGE; vertices];
        let mut next = Vec::new();
        let mut ends: Vec<[u32; 2]> = Vec::with_capacity(triangles.len() * 3 / 2);
        let mut number = |u: u32, v: u32| {
            if u == v {
                return NO_EDGE;
            }
            let keeper = if (degrees[u as usize], u) < (degrees[v as usize], v) {
                u
            } else {
                v
            };
            let mut edge = first[keeper as usize];
            while edge != NO_EDGE {
                if ends[edge as usize] == [u, v] || ends[edge as usize] == [v, u] {
                    return edge;
                }
                edge = next[edge as usize];
            }
            next.push(first[keeper as usize]);
            first[keeper as usize] = ends.len() as u32;
            ends.push([u, v]);
            ends.len() as u32 - 1
        };
        let of_triangles = triangles
            .iter()
            .map(|&[a, b, c]| [number(a, b), number(b, c), number(c, a)])
            .collect();
        Self { ends, of_triangles }
    }
}

/// Whether at least two corners of a triangle are the same vertex.
pub fn is_collapsed([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}
