//! The vertices and edges of a mesh with their neighbourhoods, from which contact points are computed.

mod curvature;

pub(crate) use curvature::MIN_TURN;
pub use curvature::Roundness;

use super::edges::{Edges, NO_EDGE, is_collapsed};
use super::slivers::AcrossSlivers;
use crate::geometry::{OneSided, TriMesh};
use glam::{DVec3, Vec3};

/// No triangle, or no edge.
pub const NONE: u32 = NO_EDGE;

/// An edge is flat if the neighbouring triangle goes less than this below the triangle's plane, relative to the
/// triangle's size. Rounding of the corners folds flat edges by about as much. A non-uniform scale folds them
/// noticeably only if its components differ by a factor of a thousand.
const MIN_FOLD: f64 = 1.0e-6;

/// An edge is a crease if the surface normal rotates by more than this across it, radians: about the angle between the
/// faces of a 12-sided cylinder.
const CREASE: f64 = 0.6;

/// Faces are facets, and not an approximation of a surface curved in all directions, if the surface normal rotates by
/// more than this across an edge, radians: about the angle between the faces of a 32-sided cylinder.
const FACET: f64 = 0.2;

/// The value of [`MeshFeatures::edge_normal_rotations`] that allows any contact normal: no two unit vectors are farther
/// apart.
pub const ANY_NORMAL: f32 = 2.0;

/// Angles below this are below a right angle, radians.
const NARROW: f64 = 1.5;

/// The unique vertices and edges of a mesh, in flat arrays.
///
/// Connectivity is that of [`TriMesh`], on welded vertices. Each vertex and each edge is owned by the first triangle
/// that has it, so a loop over pairs of triangles visits each pair of features once. Triangles with two corners on one
/// vertex are collapsed: they own nothing and are not neighbours across any edge. Triangles that count once with
/// another one of the same corners own nothing either.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFeatures {
    /// Vertex positions in mesh space, in the order in which the mesh's triangles first use them.
    pub vertices: Vec<Vec3>,
    /// For each triangle of the mesh, its corners as indices into [`MeshFeatures::vertices`].
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals of the triangles in mesh space, according to their winding; zero for a segment.
    pub normals: Vec<Vec3>,
    /// The three edges of each triangle; the first leads from its first corner to its second. [`NONE`] if both ends are
    /// the same vertex.
    pub triangle_edges: Vec<[u32; 3]>,
    /// What each triangle owns: its corners in bits 0 to 2, its edges in bits 3 to 5. Edges that cannot touch another
    /// edge have no owner: those of more than two triangles and, between one-sided triangles, those that are flat or
    /// concave.
    pub owned: Vec<u32>,
    /// For each edge, the triangle on the other side from its owner; [`NONE`] at a boundary edge, and beside a sliver
    /// that keeps the mesh closed.
    pub across: Vec<u32>,
    /// For each triangle, the largest rotation of a contact normal away from the triangle's own at an edge that it
    /// owns, radians. It is 0 if the triangle owns no edge, and at most [`ANY_NORMAL`], which allows any normal.
    pub edge_normal_rotations: Vec<f32>,
    /// For each triangle, the largest angle between its normal and the direction to a point of another mesh whose
    /// nearest feature is a vertex or edge that the triangle owns, radians; at most [`ANY_NORMAL`], which allows any.
    /// Two-sided triangles have that value.
    pub nearest_rotations: Vec<f32>,
    /// For each triangle, the smallest radius of curvature of the surface at its edges, mesh units. It is 0 beside a
    /// crease or a boundary edge, and infinite if all edges are flat or concave.
    pub curvature_radii: Vec<f32>,
    /// For each triangle, the smallest curvature of the surface at its edges, one over mesh units. On a sphere it is
    /// one over the radius. It is 0 where the surface is flat or concave in some direction, or where the faces are
    /// facets of a coarse mesh.
    pub curvature: Vec<f32>,
    /// For each vertex, the start of its neighbours in [`MeshFeatures::neighbors`]; one more entry marks the end.
    pub neighbor_starts: Vec<u32>,
    /// The neighbours of all vertices along edges, grouped by vertex.
    pub neighbors: Vec<u32>,
    /// For each vertex, the index of its connected component, in the order of [`TriMesh::component_vertices`].
    pub components: Vec<u32>,
    /// Unit vertex normals, each that of the sphere through the vertex that fits its neighbours best; they point away
    /// from the sphere's centre. Unlike averages of face normals they do not depend on the triangulation. Zero if no
    /// sphere fits.
    pub vertex_normals: Vec<Vec3>,
    /// For each vertex, how the smooth surface around it is curved.
    pub roundness: Vec<Roundness>,
    /// Which triangles push only to the side of their normal.
    pub one_sided: OneSided,
    /// For each triangle, whether it counts once with another one that has the same corners; empty if none does.
    twins: Vec<bool>,
}

/// The first triangle of an edge.
#[derive(Clone, Copy, Default)]
struct Owner {
    triangle: usize,
    /// Which of its edges it is.
    side: usize,
    /// The vertex where that edge begins.
    from: u32,
    /// Number of triangles of the edge.
    count: u32,
    /// Whether another triangle runs along the edge in the same direction.
    same_way: bool,
}

impl MeshFeatures {
    /// Computes the features of `mesh`.
    pub fn of(mesh: &TriMesh, one_sided: OneSided) -> Self {
        let mut features = Self {
            one_sided,
            ..Self::default()
        };
        let numbers = features.add_triangles(mesh);
        let (ends, creases) = features.add_edges(mesh, &numbers);
        if mesh.is_thin() {
            features.own_segment();
        }
        features.add_edge_normal_rotations();
        features.add_neighbors(&ends);
        features.add_nearest_rotations();
        features.add_components(mesh, &numbers);
        features.add_roundness(&creases);
        features
    }

    /// Gives the only triangle of a segment or a point what there is: its ends, and the edge between them. It owns no
    /// face.
    fn own_segment(&mut self) {
        self.owned[0] = if self.vertices.len() == 2 { 0b1011 } else { 0b1 };
        self.normals[0] = Vec3::ZERO;
    }

    /// The vertices that share an edge with `vertex`.
    pub fn neighbors_of(&self, vertex: u32) -> &[u32] {
        let at = |i: u32| self.neighbor_starts[i as usize] as usize;
        &self.neighbors[at(vertex)..at(vertex + 1)]
    }

    /// Marks triangles that own nothing because another one has the same corners. Otherwise no edge of a doubled
    /// surface could touch another edge: each has four triangles.
    fn add_twins(&mut self, mesh: &TriMesh) {
        let twins = mesh.twins();
        if !twins.is_empty() {
            self.twins = vec![false; mesh.triangles().len()];
        }
        for [t, _] in twins {
            self.twins[t] = true;
        }
    }

    fn is_twin(&self, t: usize) -> bool {
        self.twins.get(t) == Some(&true)
    }

    /// Adds triangles, vertices, normals and the owners of vertices. Returns for each vertex of the mesh its index in
    /// [`MeshFeatures::vertices`], [`NONE`] if no triangle uses it.
    fn add_triangles(&mut self, mesh: &TriMesh) -> Vec<u32> {
        let mut numbers = vec![NONE; mesh.vertices().len()];
        let mut has_owner = Vec::new();
        self.add_twins(mesh);
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
            if !is_collapsed(triangle) && !self.is_twin(t) {
                for (k, &vertex) in triangle.iter().enumerate() {
                    if !std::mem::replace(&mut has_owner[vertex as usize], true) {
                        owned |= 1 << k;
                    }
                }
            }
            let [p, q, r] = mesh.corners(t).map(|p| p.as_dvec3());
            // Only the triangle of a segment has no area.
            let normal = (q - p).cross(r - p).normalize_or(DVec3::Z).as_vec3();
            self.triangles.push(triangle);
            self.normals.push(normal);
            self.owned.push(owned);
        }
        mesh.welded().iter().map(|&keeper| numbers[keeper as usize]).collect()
    }

    /// Adds edges, their owners and the curvature across them. Returns the ends of the edges, and those of the creases
    /// among them. `numbers` maps vertices of the mesh to [`MeshFeatures::vertices`].
    fn add_edges(&mut self, mesh: &TriMesh, numbers: &[u32]) -> (Vec<[u32; 2]>, Vec<[u32; 2]>) {
        let Edges { ends, of_triangles } = Edges::of(&self.triangles, self.vertices.len());
        self.triangle_edges = of_triangles;
        self.across = vec![NONE; ends.len()];
        let mut owners = vec![Owner::default(); ends.len()];
        let collapsed: Vec<bool> = (0..)
            .zip(&self.triangles)
            .map(|(t, corners)| is_collapsed(*corners) || self.is_twin(t))
            .collect();
        for (t, edges) in self.triangle_edges.iter().enumerate() {
            if collapsed[t] {
                continue;
            }
            for (k, &edge) in edges.iter().enumerate() {
                let from = self.triangles[t][k];
                let owner = &mut owners[edge as usize];
                if owner.count == 0 {
                    (owner.triangle, owner.side, owner.from) = (t, k, from);
                } else {
                    self.across[edge as usize] = t as u32;
                    owner.same_way |= from == owner.from;
                }
                owner.count += 1;
            }
        }
        let mut slivers = self.slivers(mesh, numbers);
        for (edge, owner) in owners.iter().enumerate().filter(|(_, owner)| owner.count == 1) {
            slivers.add(ends[edge], owner.triangle);
        }
        let normals_at_ends = self.angle_weighted_normals();
        let mut creases = Vec::new();
        // A collapsed triangle is no smooth surface.
        let flattest = |collapsed: &bool| if *collapsed { 0.0 } else { f32::INFINITY };
        self.curvature_radii = collapsed.iter().map(flattest).collect();
        self.curvature = self.curvature_radii.clone();
        for (edge, owner) in owners.into_iter().enumerate() {
            let Owner {
                triangle: owner,
                side,
                count,
                same_way,
                ..
            } = owner;
            if count == 0 {
                continue;
            }
            let (mut radius, mut curvature) = (0.0, 0.0);
            // Two triangles that run the same way along an edge lie on each other, or are wound oppositely.
            if count == 2 && !same_way {
                let triangles = [owner, self.across[edge] as usize];
                let angle = self.angle_between(triangles);
                if angle <= CREASE {
                    radius = self.curvature_radius_along(ends[edge], &normals_at_ends);
                } else {
                    creases.push(ends[edge]);
                }
                if angle <= FACET {
                    curvature = radius.recip();
                }
            }
            let beside = [Some(owner), (count == 2).then_some(self.across[edge] as usize)];
            for t in beside.into_iter().flatten() {
                self.curvature_radii[t] = self.curvature_radii[t].min(radius);
                self.curvature[t] = self.curvature[t].min(curvature);
            }
            let is_convex = |others: &[usize]| {
                let is_hidden = |&other: &usize| self.one_sided.is(other) && self.is_flat_or_concave(owner, other);
                others.is_empty() || !self.one_sided.is(owner) || !others.iter().all(is_hidden)
            };
            let can_touch = match count {
                1 => is_convex(slivers.at(ends[edge])),
                2 => is_convex(&[self.across[edge] as usize]),
                _ => false,
            };
            if can_touch {
                self.owned[owner] |= 8 << side;
            }
        }
        (ends, creases)
    }

    /// The triangles without area that close the mesh, by the same numbers of vertices.
    fn slivers(&self, mesh: &TriMesh, numbers: &[u32]) -> AcrossSlivers {
        let number = |v: u32| match numbers[v as usize] {
            // Only slivers have this vertex.
            NONE => self.vertices.len() as u32 + mesh.welded()[v as usize],
            number => number,
        };
        let mut slivers: Vec<[u32; 3]> = mesh.slivers().map(|face| face.map(number)).collect();
        slivers.retain(|face| !is_collapsed(*face));
        AcrossSlivers::new(&slivers)
    }

    /// The normal of a contact at an edge lies between the normals of the edge's two triangles.
    fn add_edge_normal_rotations(&mut self) {
        let turn = |t: usize| {
            let owned = (0..3).filter(|k| self.owned[t] >> (3 + k) & 1 == 1);
            owned.fold(0.0, |most: f32, k| {
                match self.across[self.triangle_edges[t][k] as usize] {
                    NONE => ANY_NORMAL,
                    other if ![t, other as usize].iter().all(|&t| self.one_sided.is(t)) => ANY_NORMAL,
                    other => most.max(self.angle_between([t, other as usize]) as f32).min(ANY_NORMAL),
                }
            })
        };
        self.edge_normal_rotations = (0..self.triangles.len()).map(turn).collect();
    }

    /// A point whose nearest point of a solid is a vertex lies in a direction between the normals of the vertex's
    /// faces.
    fn add_nearest_rotations(&mut self) {
        let mut owner_of = vec![NONE; self.vertices.len()];
        let mut is_round = vec![true; self.vertices.len()];
        for (t, corners) in (0..).zip(&self.triangles) {
            for (k, &vertex) in corners.iter().enumerate() {
                if self.owned[t as usize] >> k & 1 == 1 {
                    owner_of[vertex as usize] = t;
                }
                // At boundary edges, and beside slivers, the faces at the vertex do not bound the directions.
                let boundary = self.triangle_edges[t as usize]
                    .iter()
                    .any(|&edge| edge == NONE || self.across[edge as usize] == NONE);
                is_round[vertex as usize] &= !boundary && self.one_sided.is(t as usize);
            }
        }
        let mut most = self.edge_normal_rotations.clone();
        for (t, corners) in self.triangles.iter().enumerate() {
            if !self.one_sided.is(t) {
                most[t] = ANY_NORMAL;
            }
            for &vertex in corners {
                let owner = owner_of[vertex as usize];
                if owner == NONE {
                    continue;
                }
                let angle = self.angle_between([owner as usize, t]);
                // Directions between normals more than a right angle apart may be farther than any of them.
                let is_narrow = is_round[vertex as usize] && angle < NARROW;
                let angle = if is_narrow { angle as f32 } else { ANY_NORMAL };
                let most = &mut most[owner as usize];
                *most = most.max(angle);
            }
        }
        self.nearest_rotations = most;
    }

    /// The angle between the normals of two triangles, radians.
    fn angle_between(&self, triangles: [usize; 2]) -> f64 {
        let [n, m] = triangles.map(|t| self.normals[t].as_dvec3());
        n.cross(m).length().atan2(n.dot(m))
    }

    /// Whether triangle `other` does not go below the plane of triangle `own`.
    fn is_flat_or_concave(&self, own: usize, other: usize) -> bool {
        let at = |v: u32| self.vertices[v as usize].as_dvec3();
        let [p, q, r] = self.triangles[own].map(at);
        let normal = (q - p).cross(r - p);
        let heights = self.triangles[other].map(|v| normal.dot(at(v) - p) / normal.length());
        let size = p.distance(q).max(p.distance(r));
        heights.iter().all(|h| *h >= -MIN_FOLD * size)
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

    /// Adds the connected components. `numbers` maps vertices of the mesh to [`MeshFeatures::vertices`].
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;

    fn of(mesh: &TriMesh) -> MeshFeatures {
        MeshFeatures::of(mesh, OneSided::of(mesh))
    }

    fn owned(features: &MeshFeatures, bits: u32) -> u32 {
        features.owned.iter().map(|o| (o & bits).count_ones()).sum()
    }

    #[test]
    fn every_vertex_and_convex_edge_of_a_closed_mesh_has_one_owner() {
        for (mesh, convex) in [
            (shapes::cube(1.0), 12),
            (shapes::ball(1.0, 2), 480),
            // All 120 edges around the tube are convex. Of those along the circle only the outer ones are: those on top
            // and below are flat, as diagonals are.
            (shapes::torus(12, 10, 0.7, 0.3), 120 + 48),
        ] {
            let features = of(&mesh);
            let (vertices, edges) = (features.vertices.len() as u32, features.across.len() as u32);
            assert_eq!(owned(&features, 7), vertices);
            assert_eq!(owned(&features, 56), convex);
            assert_eq!(2 * edges, 3 * mesh.triangles().len() as u32);
            assert!(!features.across.contains(&NONE));
            assert_eq!(features.neighbors.len() as u32, 2 * edges);
        }
    }

    #[test]
    fn a_room_is_sided_and_an_open_mesh_has_boundary_edges() {
        let cube = shapes::cube(1.0);
        let room = cube.clone().flipped();
        let features = of(&room);
        for (own, outward) in features.normals.iter().zip(&of(&cube).normals) {
            assert_eq!(*own, -outward);
        }
        assert!(features.one_sided.all());
        // Its vertices can touch a body inside. Its edges are all concave and can touch nothing.
        assert_eq!((owned(&features, 7), owned(&features, 56)), (8, 0));

        let open = TriMesh::new(cube.vertices().to_vec(), cube.triangles()[..10].to_vec()).unwrap();
        let features = of(&open);
        assert!(!features.one_sided.all());
        assert_eq!(features.across.iter().filter(|t| **t == NONE).count(), 4);
    }

    /// A cube, where a side of a triangle is split, but not that of its neighbour. A sliver fills the T-junction.
    fn cube_with_t_junction(triangle: usize, side: usize) -> TriMesh {
        let cube = shapes::cube(1.0);
        let [a, b, c] = [0, 1, 2].map(|i| cube.triangles()[triangle][(side + i) % 3]);
        let mut vertices = cube.vertices().to_vec();
        let middle = vertices.len() as u32;
        vertices.push(0.5 * (vertices[a as usize] + vertices[b as usize]));
        let mut triangles = cube.triangles().to_vec();
        let halves = [[a, middle, c], [middle, b, c]];
        triangles.splice(triangle..=triangle, halves.into_iter().chain([[a, b, middle]]));
        TriMesh::new(vertices, triangles).unwrap()
    }

    #[test]
    fn an_edge_beside_a_sliver_can_touch_if_it_is_convex() {
        let diagonals = (0..12).flat_map(|t| (0..3).map(move |k| (t, k))).filter(|&(t, k)| {
            let features = of(&cube_with_t_junction(t, k));
            assert!(features.one_sided.all());
            assert_eq!(features.across.iter().filter(|t| **t == NONE).count(), 3);
            match owned(&features, 56) {
                // The edges of the cube.
                12 => true,
                // The edges of the cube, and the two halves of one of them.
                14 => false,
                other => panic!("{other}"),
            }
        });
        assert_eq!(diagonals.count(), 12);
    }

    #[test]
    fn a_face_that_is_there_twice_is_no_smooth_surface() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let features = of(&TriMesh::new(corners, vec![[0, 1, 2]; 2]).unwrap());
        assert_eq!(features.curvature_radii, [0.0; 2]);
        assert_eq!(features.roundness, [Roundness::Corner; 3]);
    }

    #[test]
    fn radii_of_curvature_are_those_of_the_smooth_surface() {
        let range = |mesh: &TriMesh| {
            let radii = of(mesh).curvature_radii;
            let least = radii.iter().copied().fold(f32::INFINITY, f32::min);
            [least, radii.into_iter().fold(0.0, f32::max)]
        };
        let [least, most] = range(&shapes::ball(2.0, 4));
        // The radius comes out smaller where triangles are far from equilateral.
        assert!(least > 1.7 && most < 2.2, "{least} to {most}");
        // The curvature is largest around the tube.
        let [least, most] = range(&shapes::torus(96, 48, 0.7, 0.3));
        assert!(least > 0.27 && most < 0.33, "{least} to {most}");
        assert_eq!(range(&shapes::cube(1.0)), [0.0, 0.0]);
        // Concave edges count as flat, and boundary edges as creases.
        assert_eq!(range(&shapes::ball(2.0, 4).flipped()), [f32::INFINITY; 2]);
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE - Vec3::Z];
        let sheet = TriMesh::new(flat.to_vec(), vec![[0, 1, 2], [1, 3, 2]]).unwrap();
        assert_eq!(range(&sheet), [0.0, 0.0]);
    }

    #[test]
    fn vertex_normals_of_a_ball_are_radial() {
        let ball = of(&shapes::ball(2.0, 4));
        for (p, normal) in ball.vertices.iter().zip(&ball.vertex_normals) {
            assert!(p.normalize().distance(*normal) < 0.01, "{p} {normal}");
        }
        assert!(ball.curvature.iter().all(|c| (0.43..0.56).contains(c)));
        assert!(
            ball.roundness
                .iter()
                .all(|round| matches!(round, Roundness::Surface { .. }))
        );
        // Facets, creases and the inner side of a ring have no curvature in some direction.
        let none = |mesh: &TriMesh| of(mesh).curvature.iter().all(|c| *c == 0.0);
        assert!(none(&shapes::ball(2.0, 1)) && none(&shapes::cube(1.0)));
        let ring = shapes::torus(96, 48, 0.7, 0.3);
        let features = of(&ring);
        for (t, &curvature) in features.curvature.iter().enumerate() {
            let reach = ring.corners(t).map(|p| p.truncate().length());
            assert!(curvature > 0.0 || reach.iter().any(|r| *r < 0.8), "{t}");
            assert!(curvature == 0.0 || reach.iter().all(|r| *r > 0.69), "{t}: {curvature}");
        }
        let cube = of(&shapes::cube(1.0));
        assert!(cube.roundness.iter().all(|round| *round == Roundness::Corner));
    }

    /// The radius of curvature at a vertex along a direction of its tangent plane.
    fn radius_along(features: &MeshFeatures, vertex: usize, direction: DVec3) -> f64 {
        let tangent = direction.reject_from_normalized(features.vertex_normals[vertex].as_dvec3().normalize());
        let along = tangent.normalize();
        let Roundness::Surface { radii, .. } = features.roundness[vertex] else {
            panic!("{vertex} is a corner");
        };
        let [xx, xy, xz, yy, yz, zz] = radii.map(f64::from);
        let way = DVec3::new(
            DVec3::new(xx, xy, xz).dot(along),
            DVec3::new(xy, yy, yz).dot(along),
            DVec3::new(xz, yz, zz).dot(along),
        );
        along.dot(way)
    }

    #[test]
    fn radii_at_vertices_are_those_of_the_smooth_surface_in_each_direction() {
        // All vertices of a ball lie on its sphere, so they give its radius, however the sphere is divided.
        let ball = of(&shapes::ball(2.0, 4));
        for vertex in 0..ball.vertices.len() {
            for direction in DVec3::AXES {
                let radius = radius_along(&ball, vertex, direction + DVec3::splat(0.1));
                assert!((radius - 2.0).abs() < 1.0e-3, "{vertex}: {radius}");
            }
        }
        // At the equator of a torus the radii are those of the circle and of the tube.
        let torus = of(&shapes::torus(96, 48, 0.7, 0.3));
        let mut found = 0;
        for (vertex, p) in torus.vertices.iter().enumerate().map(|(i, p)| (i, p.as_dvec3())) {
            if p.truncate().length() < 0.999 {
                continue;
            }
            let [around, across] = [p.cross(DVec3::Z), DVec3::Z].map(|way| radius_along(&torus, vertex, way));
            assert!(
                (around - 1.0).abs() < 0.02 && (across - 0.3).abs() < 0.006,
                "{around} {across}"
            );
            found += 1;
        }
        assert_eq!(found, 96);
        // Faces of a coarse ball are facets.
        let rounds = |mesh: &TriMesh| {
            of(mesh)
                .roundness
                .iter()
                .filter(|round| matches!(round, Roundness::Surface { .. }))
                .count()
        };
        assert_eq!([rounds(&shapes::ball(2.0, 2)), rounds(&shapes::ball(2.0, 3))], [0, 642]);
    }

    #[test]
    fn an_edge_of_three_triangles_has_no_owner() {
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Y];
        let fins = TriMesh::new(points.to_vec(), vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]]).unwrap();
        let features = of(&fins);
        assert_eq!(owned(&features, 56), 6);
        assert_eq!(features.across.len(), 7);
    }
}
