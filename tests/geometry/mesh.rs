//! `TriMesh::new`: what it refuses, what it drops and what it finds out.

use bevy_faceoff::geometry::mesh::MAX_COORDINATE;
use bevy_faceoff::geometry::{MeshError, Orientation, TriMesh};
use glam::Vec3;

/// A tetrahedron, outward.
fn tetrahedron() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    (
        vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
        vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    )
}

fn mesh(vertices: &[[f32; 3]], faces: &[[u32; 3]]) -> Result<TriMesh, MeshError> {
    TriMesh::new(vertices.iter().copied().map(Vec3::from_array).collect(), faces.to_vec())
}

#[test]
fn no_faces() {
    let (vertices, _) = tetrahedron();
    assert_eq!(TriMesh::new(vertices, vec![]), Err(MeshError::Empty));
    assert_eq!(TriMesh::new(vec![], vec![]), Err(MeshError::Empty));
}

#[test]
fn a_vertex_that_is_not_finite_is_named() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut vertices, faces) = tetrahedron();
            vertices[2][axis] = bad;
            match TriMesh::new(vertices, faces) {
                Err(MeshError::NonFinite { vertex: 2, position }) => assert!(!position[axis].is_finite()),
                other => panic!("{bad} on axis {axis}: {other:?}"),
            }
        }
    }
}

#[test]
fn a_vertex_too_far_out_is_named_and_the_last_allowed_is_not() {
    for sign in [1.0, -1.0] {
        for axis in 0..3 {
            let (mut vertices, faces) = tetrahedron();
            vertices[3][axis] = sign * MAX_COORDINATE;
            assert!(
                TriMesh::new(vertices.clone(), faces.clone()).is_ok(),
                "{MAX_COORDINATE} is allowed"
            );
            vertices[3][axis] = sign * MAX_COORDINATE.next_up();
            let position = vertices[3];
            assert_eq!(
                TriMesh::new(vertices, faces),
                Err(MeshError::TooFar { vertex: 3, position })
            );
        }
    }
}

#[test]
fn a_mesh_as_large_as_allowed_is_a_mesh() {
    let m = MAX_COORDINATE;
    let (vertices, faces) = tetrahedron();
    let corners = vertices.iter().map(|v| (*v * 2.0 - 1.0) * m).collect();
    let mesh = TriMesh::new(corners, faces).unwrap();
    assert_eq!((mesh.orientation(), mesh.dropped()), (Orientation::Outward, 0));
    assert_eq!((mesh.aabb().min, mesh.aabb().max), (Vec3::splat(-m), Vec3::splat(m)));
    assert!(mesh.aabb().half_size().is_finite());
}

#[test]
fn a_face_that_names_a_missing_vertex_is_named() {
    for slot in 0..3 {
        let (vertices, mut faces) = tetrahedron();
        faces[2][slot] = 4;
        let error = TriMesh::new(vertices, faces);
        assert_eq!(
            error,
            Err(MeshError::IndexOutOfRange {
                face: 2,
                index: 4,
                vertices: 4
            })
        );
    }
    let error = mesh(&[], &[[0, 0, 0]]);
    assert_eq!(
        error,
        Err(MeshError::IndexOutOfRange {
            face: 0,
            index: 0,
            vertices: 0
        })
    );
    let (vertices, mut faces) = tetrahedron();
    faces[0][0] = u32::MAX;
    let error = TriMesh::new(vertices, faces);
    assert_eq!(
        error,
        Err(MeshError::IndexOutOfRange {
            face: 0,
            index: u32::MAX,
            vertices: 4
        })
    );
}

#[test]
fn a_vertex_no_face_uses_is_checked_but_does_not_count() {
    let (mut vertices, faces) = tetrahedron();
    vertices.push(Vec3::splat(100.0));
    let mesh = TriMesh::new(vertices.clone(), faces.clone()).unwrap();
    assert_eq!((mesh.vertices().len(), mesh.aabb().max), (5, Vec3::ONE));
    vertices[4] = Vec3::NAN;
    assert!(matches!(
        TriMesh::new(vertices, faces),
        Err(MeshError::NonFinite { vertex: 4, .. })
    ));
}

#[test]
fn only_degenerate_faces() {
    let line = [[0.0, 0.0, 0.0], [1.0, 2.0, 3.0], [2.0, 4.0, 6.0]];
    assert_eq!(
        mesh(&line, &[[0, 1, 2], [0, 0, 1]]),
        Err(MeshError::AllDegenerate { faces: 2 })
    );
}

#[test]
fn messages_name_the_culprit() {
    let (vertices, mut faces) = tetrahedron();
    faces[1] = [0, 9, 1];
    let text = TriMesh::new(vertices, faces).unwrap_err().to_string();
    assert!(
        text.contains("face 1") && text.contains("vertex 9") && text.contains("4 vertices"),
        "{text}"
    );
    let text = mesh(&[[0.0, 0.0, 2e9], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])
        .unwrap_err()
        .to_string();
    assert!(text.contains("vertex 0") && text.contains("1e9"), "{text}");
}

#[test]
fn degenerate_faces_are_dropped_counted_and_keep_their_ids() {
    let (mut vertices, faces) = tetrahedron();
    // Twice the same index, twice the same place, three on a line.
    vertices.extend([Vec3::ZERO, Vec3::new(0.5, 0.5, 0.0)]);
    let all = vec![faces[0], [1, 1, 2], faces[1], [0, 4, 3], faces[2], [1, 5, 2], faces[3]];
    let mesh = TriMesh::new(vertices, all).unwrap();
    assert_eq!(mesh.dropped(), 3);
    assert_eq!(mesh.face_ids(), [0, 2, 4, 6]);
    assert_eq!(mesh.triangles(), faces);
    assert_eq!(mesh.corners(3), [Vec3::X, Vec3::Y, Vec3::Z]);
}

#[test]
fn thin_is_not_degenerate() {
    // One step of an f32 off the line, in the middle of it and at the end.
    let half = 0.5f32.next_up();
    let one = 1.0f32.next_up();
    for tip in [[half, 0.5, 0.5], [1.0, one, 1.0]] {
        let mesh = mesh(&[[0.0; 3], [1.0; 3], tip, [2.0, 2.0, 2.0]], &[[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.unwrap().dropped(), 0, "{tip:?}");
    }
    // Small in all directions is fine too.
    let small = 1e-20;
    let mesh = mesh(&[[0.0; 3], [small, 0.0, 0.0], [0.0, small, 0.0]], &[[0, 1, 2]]).unwrap();
    assert_eq!(mesh.dropped(), 0);
}

#[test]
fn orientation() {
    let (vertices, faces) = tetrahedron();
    let of = |faces: &[[u32; 3]]| TriMesh::new(vertices.clone(), faces.to_vec()).unwrap();
    assert_eq!(of(&faces).orientation(), Orientation::Outward);
    assert!(of(&faces).is_closed());
    let inward: Vec<[u32; 3]> = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert_eq!(of(&inward).orientation(), Orientation::Inward);
    let mixed = [inward[0], faces[1], faces[2], faces[3]];
    assert_eq!(of(&mixed).orientation(), Orientation::Mixed);
    assert!(of(&mixed).is_closed());
    assert_eq!(of(&faces[..3]).orientation(), Orientation::Open);
    assert!(!of(&faces[..3]).is_closed());
}

/// Far from the origin the volume must not drown in rounding.
#[test]
fn orientation_of_a_small_mesh_far_away() {
    let (vertices, faces) = tetrahedron();
    let far: Vec<Vec3> = vertices.iter().map(|v| *v + Vec3::new(1e6, -1e6, 1e6)).collect();
    assert_eq!(
        TriMesh::new(far.clone(), faces.clone()).unwrap().orientation(),
        Orientation::Outward
    );
    let inward = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert_eq!(TriMesh::new(far, inward).unwrap().orientation(), Orientation::Inward);
}

#[test]
fn seams_are_welded_by_place() {
    let (vertices, faces) = tetrahedron();
    let separate: Vec<Vec3> = faces.iter().flatten().map(|&v| vertices[v as usize]).collect();
    let of_its_own = (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = TriMesh::new(separate, of_its_own).unwrap();
    assert_eq!((mesh.orientation(), mesh.vertices().len()), (Orientation::Outward, 12));
    assert_eq!(mesh.component_vertices(), [0]);
}

#[test]
fn minus_zero_is_zero() {
    let (vertices, mut faces) = tetrahedron();
    let mut all = vertices.clone();
    // The corner at the origin, a second time with minus zeros.
    all.push(Vec3::splat(-0.0));
    faces[1] = [4, 1, 3];
    let mesh = TriMesh::new(all.clone(), faces).unwrap();
    assert_eq!(
        (mesh.orientation(), mesh.component_vertices().len()),
        (Orientation::Outward, 1)
    );
    assert!(matches!(
        TriMesh::new(all, vec![[0, 4, 1]]),
        Err(MeshError::AllDegenerate { faces: 1 })
    ));
}

/// A face of zero area that fills a T-junction closes the mesh; without it there is a gap in the connectivity.
#[test]
fn a_sliver_in_a_t_junction_keeps_a_mesh_closed() {
    let (mut vertices, faces) = tetrahedron();
    // The edge from 1 to 2 is split on one side only.
    vertices.push(Vec3::new(0.5, 0.5, 0.0));
    let split = vec![faces[0], faces[1], faces[2], [1, 4, 3], [4, 2, 3]];
    assert_eq!(
        TriMesh::new(vertices.clone(), split.clone()).unwrap().orientation(),
        Orientation::Open
    );
    // The sliver takes the long edge from face 0 and gives the two halves.
    let mut filled = split;
    filled.insert(3, [1, 2, 4]);
    let mesh = TriMesh::new(vertices, filled).unwrap();
    assert_eq!(mesh.orientation(), Orientation::Outward);
    assert_eq!((mesh.dropped(), mesh.face_ids()), (1, &[0, 1, 2, 4, 5][..]));
}

#[test]
fn components_in_the_order_of_their_first_faces() {
    let (vertices, faces) = tetrahedron();
    let mut all = vertices.clone();
    all.extend(vertices.iter().map(|v| *v + 10.0));
    let second = faces.iter().map(|face| face.map(|v| v + 4));
    let both: Vec<[u32; 3]> = second.chain(faces.iter().copied()).collect();
    let mesh = TriMesh::new(all, both.clone()).unwrap();
    assert_eq!(mesh.component_vertices().len(), 2);
    let [far, near] = [mesh.component_vertices()[0], mesh.component_vertices()[1]];
    assert!(far >= 4 && near < 4, "{far} {near}");
    assert_eq!((mesh.orientation(), mesh.triangles().len()), (Orientation::Outward, 8));

    // Bodies that share one corner hang together, through vertices of their own too.
    let mut touching = vertices.clone();
    touching.extend(vertices.iter().map(|v| *v + Vec3::X));
    let mesh = TriMesh::new(touching, both).unwrap();
    assert_eq!(mesh.component_vertices().len(), 1);
}

#[test]
fn a_degenerate_face_connects_nothing_that_is_left() {
    let (vertices, faces) = tetrahedron();
    let mut all = vertices.clone();
    all.extend(vertices.iter().map(|v| *v + Vec3::splat(10.0)));
    let mut both = faces.clone();
    both.extend(faces.iter().map(|face| face.map(|v| v + 4)));
    // A line from one to the other.
    both.push([0, 4, 0]);
    let mesh = TriMesh::new(all, both).unwrap();
    assert_eq!((mesh.component_vertices().len(), mesh.dropped()), (2, 1));
}
