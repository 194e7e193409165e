//! The corners and edges of a mesh with all that lies around them: what contact points between surfaces are made of.

use super::edges::{Edges, NO_EDGE, is_collapsed};
use crate::geometry::{Orientation, TriMesh};
use glam::{DMat3, DVec3, Vec3};

/// No triangle, or no edge.
pub const NONE: u32 = NO_EDGE;

/// A neighbour that leads below a triangle's plane by less than this part of the triangle's size lies in it: rounding of the
/// corners does that, and scales fold the edge noticeably only if their components differ by a factor of thousand.
const LEAST_FOLD: f64 = 1.0e-6;

/// Edges at which the surface turns further than this are creases, radians: about what a round of twelve faces has.
const CREASE: f64 = 0.6;

/// Where faces turn further than this at an edge, radians, they are facets and no surface that is round all ways: about what a
/// round of 32 has.
const FACET: f64 = 0.2;

/// Of a triangle at whose edges contacts may have any normal: no two unit vectors are farther apart.
pub const EVERY_WAY: f32 = 2.0;

/// Vertices and edges of a mesh, each once, in flat arrays.
///
/// Connectivity is that of [`TriMesh`]: corners that count as one are one vertex. Every vertex and every edge is owned by one
/// triangle, the first that has it: whoever visits pairs of triangles meets each pair of features once. Triangles of which
/// two corners are one have collapsed: they own nothing, and are beside no edge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFeatures {
    /// Places of the vertices, in mesh space and in the order in which the mesh's triangles first use them.
    pub vertices: Vec<Vec3>,
    /// Corners of the mesh's triangles, in its order, as indices of [`MeshFeatures::vertices`].
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals of the triangles by that winding, in mesh space.
    pub normals: Vec<Vec3>,
    /// Edges of each triangle: the first from its first corner to its second, and so on; [`NONE`] between corners that are one.
    pub triangle_edges: Vec<[u32; 3]>,
    /// What each triangle owns: bits 0 to 2 its corners, bits 3 to 5 its edges. Edges that can touch no other edge have no
    /// owner: those of more than two triangles, and if [`MeshFeatures::sided`] those that are flat or concave.
    pub owned: Vec<u32>,
    /// For each edge the other triangle than its owner; [`NONE`] at a rim.
    pub across: Vec<u32>,
    /// For each triangle how far the normal of a contact at an edge that it owns may turn from its own, radians; at most
    /// [`EVERY_WAY`], which any normal is within, and 0 if it owns no edge.
    pub edge_turn: Vec<f32>,
    /// Radius of curvature of the surface around each triangle, mesh units: the least one that an edge of it shows, 0 beside
    /// a crease or a rim, infinite if all edges are flat or concave.
    pub roundness: Vec<f32>,
    /// The least curvature that an edge of each triangle shows, one over mesh units: that of a ball, but 0 where the surface is
    /// flat or concave in some direction, or cut so coarsely that faces are facets.
    pub curvature: Vec<f32>,
    /// Where each vertex's neighbours start in [`MeshFeatures::neighbors`], and where the last one's end.
    pub neighbor_starts: Vec<u32>,
    /// The vertices to which edges lead, one vertex's after the other's.
    pub neighbors: Vec<u32>,
    /// For each vertex which of the mesh's components it belongs to, in the order of [`TriMesh::component_vertices`].
    pub components: Vec<u32>,
    /// Unit normals at the vertices: each of the sphere that fits the vertex and its neighbours best, which does not depend on
    /// how the surface is cut, and away from its centre; zero if none fits.
    pub round_normals: Vec<Vec3>,
    /// Radius of curvature around each vertex: the least of its triangles'.
    pub vertex_roundness: Vec<f32>,
    /// Whether the mesh is closed and its faces agree about where it is solid. The triangles of one that is not have two sides.
    pub sided: bool,
}

impl MeshFeatures {
    /// Finds them.
    pub fn of(mesh: &TriMesh) -> Self {
        let mut features = Self {
            sided: matches!(mesh.orientation(), Orientation::Outward | Orientation::Inward),
            ..Self::default()
        };
        let numbers = features.add_triangles(mesh);
        let ends = features.add_edges();
        features.add_edge_turns();
        features.add_neighbors(&ends);
        features.add_components(mesh, &numbers);
        features.add_rounds();
        features
    }

    /// The vertices at the other ends of a vertex's edges.
    pub fn neighbors_of(&self, vertex: u32) -> &[u32] {
        let at = |i: u32| self.neighbor_starts[i as usize] as usize;
        &self.neighbors[at(vertex)..at(vertex + 1)]
    }

    /// Triangles, vertices, normals, and who owns which corner; returns for each vertex of the mesh its number here, if
    /// triangles use it.
    fn add_triangles(&mut self, mesh: &TriMesh) -> Vec<u32> {
        let mut numbers = vec![NONE; mesh.vertices().len()];
        let mut has_owner = Vec::new();
        for (t, corners) in mesh.triangles().iter().enumerate() {
            let triangle = corners.map(|corner| {
                let keeper = mesh.welded()[corner as usize];
                let number = &mut numbers[keeper as usize];
                if *number == NONE {
                    *number = self.vertices.len() as u32;
                    self.vertices.push(mesh.vertices()[keeper as usize]);
                    has_owner.push(false);
                }
                *number
            });
            let mut owned = 0;
            if !is_collapsed(triangle) {
                for (k, &vertex) in triangle.iter().enumerate() {
                    if !std::mem::replace(&mut has_owner[vertex as usize], true) {
                        owned |= 1 << k;
                    }
                }
            }
            let [p, q, r] = mesh.corners(t).map(|p| p.as_dvec3());
            // Never zero: a mesh has no triangles without area.
            let normal = (q - p).cross(r - p).normalize_or(DVec3::Z).as_vec3();
            self.triangles.push(triangle);
            self.normals.push(normal);
            self.owned.push(owned);
        }
        mesh.welded().iter().map(|&keeper| numbers[keeper as usize]).collect()
    }

    /// Edges and who owns them; returns their ends.
    fn add_edges(&mut self) -> Vec<[u32; 2]> {
        let Edges { ends, of_triangles } = Edges::of(&self.triangles, self.vertices.len());
        self.triangle_edges = of_triangles;
        self.across = vec![NONE; ends.len()];
        // For each edge its owner, which of the owner's edges it is, and how many triangles have it.
        let mut owners = vec![(0, 0, 0); ends.len()];
        let collapsed: Vec<bool> = self.triangles.iter().map(|t| is_collapsed(*t)).collect();
        for (t, edges) in self.triangle_edges.iter().enumerate() {
            if collapsed[t] {
                continue;
            }
            for (k, &edge) in edges.iter().enumerate() {
                let owner = &mut owners[edge as usize];
                if owner.2 == 0 {
                    *owner = (t, k, 0);
                } else {
                    self.across[edge as usize] = t as u32;
                }
                owner.2 += 1;
            }
        }
        let vertex_normals = self.vertex_normals();
        // Nothing rolls on what has collapsed.
        let flattest = |collapsed: &bool| if *collapsed { 0.0 } else { f32::INFINITY };
        self.roundness = collapsed.iter().map(flattest).collect();
        self.curvature = self.roundness.clone();
        for (edge, &(owner, k, count)) in owners.iter().enumerate() {
            if count == 0 {
                continue;
            }
            let (mut roundness, mut curvature) = (0.0, 0.0);
            if count == 2 {
                let triangles = [owner, self.across[edge] as usize];
                let angle = self.angle_between(triangles);
                if angle <= CREASE {
                    roundness = self.roundness_along(ends[edge], &vertex_normals);
                }
                if angle <= FACET {
                    curvature = roundness.recip();
                }
            }
            let beside = [Some(owner), (count == 2).then_some(self.across[edge] as usize)];
            for t in beside.into_iter().flatten() {
                self.roundness[t] = self.roundness[t].min(roundness);
                self.curvature[t] = self.curvature[t].min(curvature);
            }
            if count <= 2 && !(self.sided && self.is_concave(owner, self.across[edge])) {
                self.owned[owner] |= 8 << k;
            }
        }
        ends
    }

    /// Between the normals of both triangles lie those that a contact at their edge may have.
    fn add_edge_turns(&mut self) {
        let turn = |t: usize| {
            let owned = (0..3).filter(|k| self.owned[t] >> (3 + k) & 1 == 1);
            owned.fold(0.0, |most: f32, k| {
                match self.across[self.triangle_edges[t][k] as usize] {
                    other if other == NONE || !self.sided => EVERY_WAY,
                    other => most.max(self.angle_between([t, other as usize]) as f32).min(EVERY_WAY),
                }
            })
        };
        self.edge_turn = (0..self.triangles.len()).map(turn).collect();
    }

    /// How far the surface turns from one triangle to another, radians.
    fn angle_between(&self, triangles: [usize; 2]) -> f64 {
        let [n, m] = triangles.map(|t| self.normals[t].as_dvec3());
        n.cross(m).length().atan2(n.dot(m))
    }

    /// How round the surface is along an edge that is no crease: the radius of the circle that has the normals of both ends
    /// there.
    fn roundness_along(&self, [u, v]: [u32; 2], vertex_normals: &[DVec3]) -> f32 {
        let way = self.vertices[v as usize].as_dvec3() - self.vertices[u as usize].as_dvec3();
        let turn = vertex_normals[v as usize] - vertex_normals[u as usize];
        let curvature = turn.dot(way) / way.length_squared();
        // What rounding of the normals makes of a flat surface.
        if curvature * way.length() > 1.0e-4 {
            curvature.recip() as f32
        } else {
            f32::INFINITY
        }
    }

    /// Unit normals at the vertices: means of those of the triangles, weighted by their angles there, so that it does not
    /// matter how a surface is cut into triangles (Thuermer and Wuethrich, "Computing Vertex Normals from Polygonal Facets",
    /// 1998).
    fn vertex_normals(&self) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; self.vertices.len()];
        let triangles = self.triangles.iter().zip(&self.normals);
        for (corners, normal) in triangles.filter(|(corners, _)| !is_collapsed(**corners)) {
            let at = corners.map(|v| self.vertices[v as usize].as_dvec3());
            for k in 0..3 {
                let (u, v) = (at[(k + 1) % 3] - at[k], at[(k + 2) % 3] - at[k]);
                sums[corners[k] as usize] += normal.as_dvec3() * u.angle_between(v);
            }
        }
        sums.into_iter().map(DVec3::normalize_or_zero).collect()
    }

    /// Whether triangle `other` does not lead below the plane of triangle `own`.
    fn is_concave(&self, own: usize, other: u32) -> bool {
        let at = |v: u32| self.vertices[v as usize].as_dvec3();
        let [p, q, r] = self.triangles[own].map(at);
        let normal = (q - p).cross(r - p);
        let heights = self.triangles[other as usize].map(|v| normal.dot(at(v) - p) / normal.length());
        let size = p.distance(q).max(p.distance(r));
        heights.iter().all(|h| *h >= -LEAST_FOLD * size)
    }

    fn add_neighbors(&mut self, ends: &[[u32; 2]]) {
        let mut counts = vec![0u32; self.vertices.len() + 1];
        for &v in ends.iter().flatten() {
            counts[v as usize + 1] += 1;
        }
        for i in 1..counts.len() {
            counts[i] += counts[i - 1];
        }
        let mut next = counts.clone();
        self.neighbors = vec![0; 2 * ends.len()];
        for &[u, v] in ends {
            for (from, to) in [(u, v), (v, u)] {
                self.neighbors[next[from as usize] as usize] = to;
                next[from as usize] += 1;
            }
        }
        self.neighbor_starts = counts;
    }

    /// Which vertices hang together; `numbers` are those of the mesh's vertices here.
    fn add_components(&mut self, mesh: &TriMesh, numbers: &[u32]) {
        let mut components = vec![NONE; self.vertices.len()];
        let mut waiting = Vec::new();
        for (component, &first) in (0..).zip(mesh.component_vertices()) {
            let first = numbers[first as usize];
            components[first as usize] = component;
            waiting.push(first);
            while let Some(vertex) = waiting.pop() {
                for &next in self.neighbors_of(vertex) {
                    if components[next as usize] == NONE {
                        components[next as usize] = component;
                        waiting.push(next);
                    }
                }
            }
        }
        self.components = components;
    }

    /// Normals and roundness at the vertices.
    fn add_rounds(&mut self) {
        let count = self.vertices.len() as u32;
        self.round_normals = (0..count).map(|vertex| self.round_normal(vertex).as_vec3()).collect();
        self.vertex_roundness = vec![f32::INFINITY; self.vertices.len()];
        let triangles = self.triangles.iter().zip(&self.roundness);
        for (corners, &roundness) in triangles.filter(|(corners, _)| !is_collapsed(**corners)) {
            for &v in corners {
                let least = &mut self.vertex_roundness[v as usize];
                *least = least.min(roundness);
            }
        }
    }

    fn round_normal(&self, vertex: u32) -> DVec3 {
        let at = self.vertices[vertex as usize].as_dvec3();
        let (mut squares, mut sum) = (DMat3::ZERO, DVec3::ZERO);
        for &neighbor in self.neighbors_of(vertex) {
            // From a point of a sphere to its centre `c` and another point `e`: 2 c . e = e . e.
            let edge = self.vertices[neighbor as usize].as_dvec3() - at;
            let way = edge.normalize_or_zero();
            squares += DMat3::from_cols(way * way.x, way * way.y, way * way.z);
            sum += edge;
        }
        (squares.inverse() * -sum).normalize_or_zero()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;

    fn owned(features: &MeshFeatures, bits: u32) -> u32 {
        features.owned.iter().map(|o| (o & bits).count_ones()).sum()
    }

    #[test]
    fn every_vertex_and_convex_edge_of_a_closed_mesh_has_one_owner() {
        for (mesh, convex) in [
            (shapes::cube(1.0), 12),
            (shapes::ball(1.0, 2), 480),
            // Around the tube all, around the circle those outside; those on top and below are flat, as diagonals are.
            (shapes::torus(12, 10, 0.7, 0.3), 120 + 48),
        ] {
            let features = MeshFeatures::of(&mesh);
            let (vertices, edges) = (features.vertices.len() as u32, features.across.len() as u32);
            assert_eq!(owned(&features, 7), vertices);
            assert_eq!(owned(&features, 56), convex);
            assert_eq!(2 * edges, 3 * mesh.triangles().len() as u32);
            assert!(!features.across.contains(&NONE));
            assert_eq!(features.neighbors.len() as u32, 2 * edges);
        }
    }

    #[test]
    fn a_room_keeps_its_sides_and_an_open_mesh_has_rims() {
        let cube = shapes::cube(1.0);
        let room = cube.clone().turned();
        let features = MeshFeatures::of(&room);
        for (own, outward) in features.normals.iter().zip(&MeshFeatures::of(&cube).normals) {
            assert_eq!(*own, -outward);
        }
        assert!(features.sided);
        // Its corners can touch what is inside, and its edges, all of them concave, nothing.
        assert_eq!((owned(&features, 7), owned(&features, 56)), (8, 0));

        let open = TriMesh::new(cube.vertices().to_vec(), cube.triangles()[..10].to_vec()).unwrap();
        let features = MeshFeatures::of(&open);
        assert!(!features.sided);
        assert_eq!(features.across.iter().filter(|t| **t == NONE).count(), 4);
    }

    #[test]
    fn surfaces_are_as_round_as_they_look() {
        let range = |mesh: &TriMesh| {
            let roundness = MeshFeatures::of(mesh).roundness;
            let least = roundness.iter().copied().fold(f32::INFINITY, f32::min);
            [least, roundness.into_iter().fold(0.0, f32::max)]
        };
        let [least, most] = range(&shapes::ball(2.0, 4));
        // Less where the triangles are far from equilateral.
        assert!(least > 1.7 && most < 2.2, "{least} to {most}");
        // Around the tube is the sharpest way.
        let [least, most] = range(&shapes::torus(96, 48, 0.7, 0.3));
        assert!(least > 0.27 && most < 0.33, "{least} to {most}");
        assert_eq!(range(&shapes::cube(1.0)), [0.0, 0.0]);
        // A dent has nothing to roll on, and a rim nothing but itself.
        assert_eq!(range(&shapes::ball(2.0, 4).turned()), [f32::INFINITY; 2]);
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE - Vec3::Z];
        let sheet = TriMesh::new(flat.to_vec(), vec![[0, 1, 2], [1, 3, 2]]).unwrap();
        assert_eq!(range(&sheet), [0.0, 0.0]);
    }

    #[test]
    fn what_is_round_all_ways_has_normals_from_its_centre() {
        let ball = MeshFeatures::of(&shapes::ball(2.0, 4));
        for (p, normal) in ball.vertices.iter().zip(&ball.round_normals) {
            assert!(p.normalize().distance(*normal) < 0.01, "{p} {normal}");
        }
        assert!(ball.curvature.iter().all(|c| (0.43..0.56).contains(c)));
        assert!(ball.vertex_roundness.iter().all(|r| (1.7..2.2).contains(r)));
        // Facets, creases, and the inside of a ring are not.
        let none = |mesh: &TriMesh| MeshFeatures::of(mesh).curvature.iter().all(|c| *c == 0.0);
        assert!(none(&shapes::ball(2.0, 1)) && none(&shapes::cube(1.0)));
        let ring = shapes::torus(96, 48, 0.7, 0.3);
        let features = MeshFeatures::of(&ring);
        for (t, &curvature) in features.curvature.iter().enumerate() {
            let reach = ring.corners(t).map(|p| p.truncate().length());
            assert!(curvature > 0.0 || reach.iter().any(|r| *r < 0.8), "{t}");
            assert!(curvature == 0.0 || reach.iter().all(|r| *r > 0.69), "{t}: {curvature}");
        }
        let cube = MeshFeatures::of(&shapes::cube(1.0));
        assert!(cube.vertex_roundness.iter().all(|r| *r == 0.0));
    }

    #[test]
    fn an_edge_of_three_triangles_has_no_owner() {
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Y];
        let fins = TriMesh::new(points.to_vec(), vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]]).unwrap();
        let features = MeshFeatures::of(&fins);
        assert_eq!(owned(&features, 56), 6);
        assert_eq!(features.across.len(), 7);
    }
}
