//! The edges of triangles, each once.

/// No edge: between two corners of a triangle that are one vertex.
pub const NO_EDGE: u32 = u32::MAX;

/// Edges in the order in which triangles first have them.
pub struct Edges {
    /// The vertices at both ends, in the order in which the first triangle runs past them.
    pub ends: Vec<[u32; 2]>,
    /// Of each triangle: the edge from its first corner to its second, and so on.
    pub of_triangles: Vec<[u32; 3]>,
}

impl Edges {
    /// Finds them. The triangles' corners are below `vertices`.
    pub fn of(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let mut degrees = vec![0u32; vertices];
        for &v in triangles.iter().flatten() {
            degrees[v as usize] += 1;
        }
        // Each vertex has a list of edges, and each edge is in that of the end where fewer triangles meet: no list is long,
        // however many triangles meet at the tip of a cone.
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

/// Whether corners of a triangle are one vertex, so that it separates nothing.
pub fn is_collapsed([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}
