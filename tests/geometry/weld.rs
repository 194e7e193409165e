//! Corners that differ by rounding count as one: meshes are closed, weigh what they hold, and have the edges they show.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::asset::format::{from_bytes, to_bytes};
use bevy_faceoff::geometry::features::{MeshFeatures, NONE, Roundness};
use bevy_faceoff::geometry::{MassProperties, OneSided, Orientation, TriMesh, shapes};
use bevy_faceoff::projection::{BakeSettings, Inward, Progress};
use glam::Vec3;

fn with_tolerance(weld_tolerance: f32) -> BakeSettings {
    BakeSettings {
        weld_tolerance,
        ..BakeSettings::default()
    }
}

/// Every triangle with corners of its own, each moved by up to `by` along each axis.
fn shaken(mesh: &TriMesh, by: f32) -> TriMesh {
    let mut random = fastrand::Rng::with_seed(11);
    let mut number = move || (2.0 * random.f32() - 1.0) * by;
    let corners: Vec<Vec3> = (0..mesh.triangles().len())
        .flat_map(|t| mesh.corners(t))
        .map(|p| p + Vec3::new(number(), number(), number()))
        .collect();
    let faces = (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    TriMesh::new(corners, faces.collect()).unwrap()
}

fn bits(features: &MeshFeatures, mask: u32) -> u32 {
    features.owned.iter().map(|owned| (owned & mask).count_ones()).sum()
}

#[test]
fn a_mesh_of_separate_faces_that_rounding_moved_is_whole() {
    for clean in [
        shapes::knot_1120(),
        shapes::torus_240(),
        shapes::cube(1.0),
        shapes::ball_320(),
    ] {
        let mesh = shaken(&clean, 1.0e-7);
        let baked = CollisionMesh::new(&mesh);
        assert_eq!(baked.mesh.orientation(), Orientation::Outward);
        assert_eq!(baked.mesh.component_vertices().len(), 1);
        assert!(baked.warnings().is_empty());
        let (found, wanted) = (baked.mass, MassProperties::of(&clean));
        assert!((found.volume / wanted.volume - 1.0).abs() < 1e-5 && !found.approximate);
        assert!((found.thickness / wanted.thickness - 1.0).abs() < 1e-3);
        let (found, wanted) = (baked.features(), MeshFeatures::of(&clean, OneSided::All));
        assert_eq!(found.vertices.len(), wanted.vertices.len());
        assert_eq!(found.across.len(), wanted.across.len());
        assert!(found.one_sided.all() && !found.across.contains(&NONE));
        assert_eq!(bits(found, 7), found.vertices.len() as u32);
        // What is tested are the triangles as they came.
        for (t, &face) in baked.mesh.face_ids().iter().enumerate() {
            assert_eq!(baked.mesh.corners(t), mesh.corners(face as usize));
        }
        // Without a tolerance nothing hangs together, and the warning says by how little.
        let torn = CollisionMesh::without_faces(&mesh, with_tolerance(0.0));
        assert_eq!(torn.mesh.orientation(), Orientation::Open);
        let gaps = torn.mesh.gaps().unwrap();
        assert!(gaps.relative.is_some_and(|part| part < 1.0e-6), "{gaps:?}");
        assert!(torn.warnings()[0].contains(&format!("({} edges have no partner", gaps.edges)));
    }
}

/// A cube one of whose corners is two, with a sliver between them and a neighbour.
#[test]
fn slivers_that_collapse_leave_no_hole() {
    let cube = shapes::cube(1.0);
    let mut vertices = cube.vertices().to_vec();
    let mut faces = cube.triangles().to_vec();
    // Across the edge from `a` to `b` of the first face, the corner `a` is another one, which the sliver joins.
    let [a, b, _] = faces[0];
    let twin = vertices.len() as u32;
    vertices.push(vertices[a as usize] + Vec3::new(1.5e-7, 1.5e-7, 0.0));
    let other = (1..faces.len()).find(|&t| (0..3).any(|k| [faces[t][k], faces[t][(k + 1) % 3]] == [b, a]));
    let other = other.unwrap();
    let at_a = faces[other].map(|v| if v == a { twin } else { v });
    let opposite = *faces[other].iter().find(|v| ![a, b].contains(v)).unwrap();
    faces[other] = at_a;
    faces.push([a, twin, b]);
    faces.push([twin, a, opposite]);
    let mesh = TriMesh::new(vertices, faces).unwrap();
    assert_eq!((mesh.triangles().len(), mesh.dropped()), (14, 0));
    for settings in [with_tolerance(0.0), BakeSettings::default()] {
        let baked = CollisionMesh::without_faces(&mesh, settings);
        assert_eq!(baked.mesh.orientation(), Orientation::Outward);
        assert!((baked.mass.volume - 1.0).abs() < 1e-6);
    }
    let baked = CollisionMesh::new(&mesh);
    let features = baked.features();
    assert_eq!((features.vertices.len(), features.across.len()), (8, 18));
    assert_eq!((bits(features, 7), bits(features, 56)), (8, 12));
    assert!(!features.across.contains(&NONE));
    for (triangle, owned) in features.triangles.iter().zip(&features.owned) {
        let [a, b, c] = *triangle;
        assert!(*owned == 0 || (a != b && b != c && c != a));
    }
    assert!(features.vertex_normals.iter().all(|n| n.is_finite()));
    assert!(features.roundness.iter().all(|round| *round == Roundness::Corner));
}

/// Joining corners takes faces from an edge two at a time.
#[test]
fn what_is_closed_stays_closed_at_any_tolerance() {
    for mesh in [
        shapes::torus(200, 100, 0.7, 0.3),
        shapes::knot_1120(),
        shapes::ball(1.0, 4),
    ] {
        for tolerance in [0.0, 1e-4, 3e-3, 0.01] {
            let baked = CollisionMesh::without_faces(&mesh, with_tolerance(tolerance));
            assert_eq!(baked.mesh.orientation(), Orientation::Outward, "{tolerance}");
            let wanted = MassProperties::of(&mesh).volume;
            assert!((baked.mass.volume / wanted - 1.0).abs() < 0.1, "{tolerance}");
            let features = baked.features();
            assert!(
                features
                    .curvature_radii
                    .iter()
                    .chain(&features.curvature)
                    .all(|r| !r.is_nan())
            );
            assert!(features.vertex_normals.iter().all(|n| n.is_finite()));
            assert!(features.components.iter().all(|c| *c == 0));
        }
    }
}

#[test]
fn an_open_mesh_tells_how_far_apart_it_is() {
    let cube = shapes::cube(1.0);
    let lidless = TriMesh::new(cube.vertices().to_vec(), cube.triangles()[..10].to_vec()).unwrap();
    let gaps = lidless.gaps().unwrap();
    assert_eq!(gaps.edges, 4);
    // Only the far corners of a square rim are not joined by an edge.
    assert!((gaps.nearest.unwrap() - 2f64.sqrt()).abs() < 1e-6, "{gaps:?}");
    assert!(
        (gaps.relative.unwrap() - (2.0f64 / 3.0).sqrt()).abs() < 1e-6,
        "{gaps:?}"
    );
    assert_eq!(cube.gaps(), None);

    // A lid that is a thousandth too high.
    let mut vertices = lidless.vertices().to_vec();
    let mut faces = lidless.triangles().to_vec();
    for &face in &cube.triangles()[10..] {
        let way = {
            let [p, q, r] = face.map(|v| cube.vertices()[v as usize]);
            (q - p).cross(r - p).normalize()
        };
        let first = vertices.len() as u32;
        vertices.extend(face.map(|v| cube.vertices()[v as usize] + way * 1e-3));
        faces.push([first, first + 1, first + 2]);
    }
    let mesh = TriMesh::new(vertices, faces).unwrap();
    let gaps = mesh.gaps().unwrap();
    assert_eq!(gaps.edges, 8);
    assert!((gaps.nearest.unwrap() - 1e-3).abs() < 1e-6, "{gaps:?}");
    let warning = &CollisionMesh::new(&mesh).warnings()[0];
    assert!(
        warning.contains("8 edges have no partner") && warning.contains("1.00e-3 apart"),
        "{warning}"
    );
    // As it advises.
    let closed = CollisionMesh::without_faces(&mesh, with_tolerance(1e-3));
    assert_eq!(closed.mesh.orientation(), Orientation::Outward);
    assert!(closed.warnings().is_empty() && (closed.mass.volume - 1.0).abs() < 2e-3);
}

#[test]
fn tolerance_and_side_are_in_the_file_and_can_be_changed() {
    let cube = shapes::cube(1.0);
    let faces = cube.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    let room = TriMesh::new(cube.vertices().to_vec(), faces).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let solid = BakeSettings {
        inward: Inward::Solid,
        weld_tolerance: 2e-5,
        ..BakeSettings::default()
    };
    let baked = CollisionMesh::without_faces(&room, solid);
    assert_eq!(
        (baked.mesh.orientation(), baked.mesh.turned()),
        (Orientation::Outward, &[true; 12][..])
    );
    assert!(baked.warnings().is_empty());
    let (read, header) = from_bytes(&to_bytes(&baked, [0; 32])).unwrap();
    assert!(read == baked);
    assert_eq!((header.settings, read.mesh.weld_tolerance()), (solid, 2e-5));
    // What a bake turned is turned back if another one wants a room.
    let again = read
        .rebake(BakeSettings::default(), &pool, &Progress::default())
        .unwrap();
    assert!(again == CollisionMesh::new(&room));
    assert_eq!(
        (again.mesh.orientation(), again.mesh.turned()),
        (Orientation::Inward, &[][..])
    );
    assert!(again.warnings()[0].contains("room") && again.warnings()[0].contains("inward: Solid"));
    assert!(again.rebake(solid, &pool, &Progress::default()).unwrap() == baked);
    // The other way round nothing looks inward.
    assert!(CollisionMesh::without_faces(&cube, solid).mesh.turned().is_empty());
}
