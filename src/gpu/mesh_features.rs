//! The topology of a mesh as words, as `shaders/manifolds/side.wgsl` reads it.

use super::layout::{FLAT_RADIUS, NOTHING, ONE_SIDED};
use crate::geometry::features::{ANY_NORMAL, MeshFeatures, NONE, Roundness};
use crate::state::mesh_arena::MeshSlot;
use glam::Vec3;

/// Number of words before the triangles' records. Seven are used: the number of vertices, and the start of the
/// positions, of the starts of the neighbour lists, of these lists, of the component numbers, of the components' far
/// ends, and of the vertex normals, each with the roundness.
pub const HEADER: usize = 8;

/// Number of words per triangle: vertices; edges; the triangles across the edges that it owns; normal; what it owns,
/// whether it is one-sided, and the largest rotations of normals at its edges and of ways to nearest points; radius of
/// curvature; number in the source mesh; lower bound of the curvature.
pub const RECORD: usize = 16;

/// Number of words per vertex of its normal and roundness: the normal; the radii of curvature of a surface, or the
/// tangent and the curvature of a rim; the reach, which is negative on a rim and 0 at a corner.
pub const ROUNDNESS: usize = 10;

/// The words of a mesh. Starts are relative to the first word.
pub fn words(slot: &MeshSlot) -> Vec<u32> {
    let features = &*slot.features;
    let center = slot.mesh.mass.center;
    let (vertices, triangles) = (features.vertices.len(), features.triangles.len());
    let positions = HEADER + RECORD * triangles;
    let starts = positions + 3 * vertices;
    let neighbors = starts + vertices + 1;
    let components = neighbors + features.neighbors.len();
    let far_ends = components + vertices;
    let rounds = far_ends + 3 * slot.mesh.mesh.component_vertices().len();
    let mut words = Vec::with_capacity(rounds + ROUNDNESS * vertices);
    words.extend([vertices, positions, starts, neighbors, components, far_ends, rounds, 0].map(|word| word as u32));
    for t in 0..triangles {
        record(slot, features, t, &mut words);
    }
    // Relative to the centre of mass, with the same bits as the triangles' corners.
    let place = |p: &Vec3| (*p - center).to_array().map(f32::to_bits);
    words.extend(features.vertices.iter().flat_map(place));
    words.extend(&features.neighbor_starts);
    words.extend(&features.neighbors);
    words.extend(&features.components);
    words.extend(far_ends_of(slot, features).iter().flat_map(place));
    for (normal, round) in features.vertex_normals.iter().zip(&features.roundness) {
        let (shape, reach) = match *round {
            Roundness::Corner => ([0.0; 6], 0.0),
            Roundness::Surface { radii, reach } => (radii, reach),
            Roundness::Rim {
                tangent,
                curvature,
                reach,
            } => {
                let ([x, y, z], [u, v, w]) = (tangent.to_array(), curvature.to_array());
                ([x, y, z, u, v, w], -reach)
            }
        };
        words.extend(normal.to_array().map(f32::to_bits));
        words.extend(shape.map(f32::to_bits));
        words.push(reach.to_bits());
    }
    words
}

/// For each component the vertex farthest from its first one. A component is inside another body if both are; one that
/// only touches its surface is not.
fn far_ends_of(slot: &MeshSlot, features: &MeshFeatures) -> Vec<Vec3> {
    let mesh = &slot.mesh.mesh;
    let firsts: Vec<Vec3> = (mesh.component_vertices().iter())
        .map(|&v| mesh.vertices()[v as usize])
        .collect();
    let mut far_ends = firsts.clone();
    for (position, &number) in features.vertices.iter().zip(&features.components) {
        let first = firsts[number as usize];
        let far_end = &mut far_ends[number as usize];
        if position.distance_squared(first) > far_end.distance_squared(first) {
            *far_end = *position;
        }
    }
    far_ends
}

fn record(slot: &MeshSlot, features: &MeshFeatures, t: usize, words: &mut Vec<u32>) {
    let edges = features.triangle_edges[t];
    let other = |edge: u32| match features.across.get(edge as usize) {
        None | Some(&NONE) => NOTHING,
        Some(&triangle) => triangle,
    };
    words.extend(features.triangles[t]);
    words.extend(edges);
    words.extend(edges.map(other));
    words.extend(features.normals[t].to_array().map(f32::to_bits));
    // Rounded up.
    let turn = |angle: f32| ((angle * (255.0 / ANY_NORMAL)).ceil() as u32).min(255);
    let edge_turn = turn(features.edge_normal_rotations[t]);
    let near_turn = turn(features.nearest_rotations[t]);
    let one_sided = u32::from(features.one_sided.is(t)) * ONE_SIDED;
    words.push(features.owned[t] | one_sided | (edge_turn << 8) | (near_turn << 16));
    words.push(features.curvature_radii[t].min(FLAT_RADIUS).to_bits());
    words.push(slot.mesh.mesh.face_ids()[t]);
    words.push(features.curvature[t].to_bits());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::{TriMesh, shapes};

    #[test]
    fn every_vertex_belongs_to_a_component() {
        let cube = shapes::cube(1.0);
        let mut vertices = cube.vertices().to_vec();
        vertices.extend(cube.vertices().iter().map(|p| *p + Vec3::X * 3.0));
        let mut triangles = cube.triangles().to_vec();
        triangles.extend(cube.triangles().iter().map(|t| t.map(|v| v + 8)));
        let slot = MeshSlot::new(CollisionMesh::new(&TriMesh::new(vertices, triangles).unwrap()));
        let words = words(&slot);
        assert_eq!(words[0], 16);
        let components = &words[words[4] as usize..words[5] as usize];
        assert_eq!((components.len(), (words[6] - words[5]) as usize), (16, 2 * 3));
        let features = &*slot.features;
        // One component number per side.
        let right = |p: &Vec3| p.x > 1.5;
        let number_of = |side: bool| {
            let at = features.vertices.iter().position(|p| right(p) == side).unwrap();
            components[at]
        };
        assert_ne!(number_of(true), number_of(false));
        for (p, &number) in features.vertices.iter().zip(components) {
            assert_eq!(number, number_of(right(p)));
        }
    }

    #[test]
    fn places_lie_one_after_the_other() {
        let slot = MeshSlot::new(CollisionMesh::new(&shapes::torus_240()));
        let words = words(&slot);
        let features = &*slot.features;
        assert_eq!(words[1] as usize, HEADER + RECORD * features.triangles.len());
        assert_eq!(
            words.len(),
            words[4] as usize + (1 + ROUNDNESS) * features.vertices.len() + 3
        );
        assert_eq!(words[HEADER..HEADER + 3], features.triangles[0]);
    }
}
