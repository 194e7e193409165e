//! Collision meshes and colliders from Bevy's own meshes.

use crate::asset_app::*;
use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, MeshPlugin, PrimitiveTopology};
use bevy::prelude::*;
use bevy_faceoff::geometry::{MeshError, Orientation, TriMesh, shapes};
use bevy_faceoff::plugin::assets::bevy_mesh::BevyMeshError;
use bevy_faceoff::prelude::*;

fn bevy_mesh(topology: PrimitiveTopology, positions: Vec<[f32; 3]>, indices: Option<Indices>) -> Mesh {
    let mut mesh =
        Mesh::new(topology, RenderAssetUsages::default()).with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions);
    if let Some(indices) = indices {
        mesh.insert_indices(indices);
    }
    mesh
}

/// A Bevy mesh of the same triangles.
fn drawn(mesh: &TriMesh) -> Mesh {
    let positions = mesh.vertices().iter().map(|v| v.to_array()).collect();
    let indices = Indices::U32(mesh.triangles().as_flattened().to_vec());
    bevy_mesh(PrimitiveTopology::TriangleList, positions, Some(indices))
}

#[test]
fn lists_with_and_without_indices() {
    let mesh = shapes::torus_240();
    assert_eq!(TriMesh::try_from(&drawn(&mesh)), Ok(mesh.clone()));
    let positions: Vec<[f32; 3]> = mesh.vertices().iter().map(|v| v.to_array()).collect();
    let indices = mesh.triangles().as_flattened().iter().map(|&i| i as u16).collect();
    let short = bevy_mesh(PrimitiveTopology::TriangleList, positions, Some(Indices::U16(indices)));
    assert_eq!(TriMesh::try_from(&short), Ok(mesh.clone()));
    let soup = (0..mesh.triangles().len())
        .flat_map(|t| mesh.corners(t))
        .map(|c| c.to_array())
        .collect();
    let soup = TriMesh::try_from(&bevy_mesh(PrimitiveTopology::TriangleList, soup, None)).unwrap();
    assert_eq!(soup.orientation(), Orientation::Outward);
    assert!((0..240).all(|t| soup.corners(t) == mesh.corners(t)));
    let baked = CollisionMesh::from_bevy_mesh(&drawn(&mesh)).unwrap();
    assert_eq!(baked, CollisionMesh::new(&mesh));
}

#[test]
fn a_collision_mesh_is_drawn_face_by_face() {
    let (vertices, mut faces) = (
        shapes::torus_240().vertices().to_vec(),
        shapes::torus_240().triangles().to_vec(),
    );
    faces.iter_mut().for_each(|face| face.swap(0, 1));
    let inward = TriMesh::new(vertices, faces).unwrap();
    for (mesh, orientation) in [
        (shapes::torus_240(), Orientation::Outward),
        (inward, Orientation::Inward),
    ] {
        let baked = CollisionMesh::new(&mesh);
        let drawn = baked.to_bevy_mesh();
        let back = TriMesh::try_from(&drawn).unwrap();
        assert_eq!(back.orientation(), orientation);
        let normals = drawn.attribute(Mesh::ATTRIBUTE_NORMAL).unwrap().as_float3().unwrap();
        for t in 0..240 {
            let sorted = |mut corners: [Vec3; 3]| {
                corners.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap());
                corners
            };
            assert_eq!(sorted(back.corners(t)), sorted(baked.mesh.corners(t)));
            let [a, b, c] = back.corners(t);
            for normal in &normals[3 * t..3 * t + 3] {
                assert!((b - a).cross(c - a).normalize().distance(Vec3::from(*normal)) < 1e-6);
            }
        }
    }
}

#[test]
fn strips_and_shapes_of_bevy() {
    // A tetrahedron is a strip that comes back to its first two corners.
    let corners = vec![[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let indices = Indices::U16(vec![0, 1, 2, 3, 0, 1]);
    let strip = bevy_mesh(PrimitiveTopology::TriangleStrip, corners, Some(indices));
    let strip = TriMesh::try_from(&strip).unwrap();
    assert_eq!(
        (strip.triangles().len(), strip.orientation()),
        (4, Orientation::Outward)
    );
    assert!(
        TriMesh::try_from(&Cuboid::default().mesh().build())
            .unwrap()
            .is_closed()
    );
}

/// Bevy closes its round shapes at corners that differ in their last bits. Volumes are those of the shapes as they are cut.
#[test]
fn round_shapes_of_bevy_are_closed_and_weigh_what_they_hold() {
    use std::f64::consts::{PI, TAU};
    // A polygon of `n` corners on a circle of radius `r`.
    let polygon = |n: f64, r: f64| 0.5 * n * r * r * (TAU / n).sin();
    // A polygon swept around: each of `n` sections holds sin(turn) times the first moment of its area about the axis.
    let torus = 32.0 * (TAU / 32.0).sin() * 0.75 * polygon(24.0, 0.25);
    let between =
        |low: f64, high: f64, height: f64| polygon(32.0, 1.0) * height / 3.0 * (low * low + low * high + high * high);
    let stack = |i: i32| PI / 2.0 - PI * f64::from(i) / 18.0;
    let sphere = (0..18)
        .map(|i| between(stack(i).cos(), stack(i + 1).cos(), stack(i).sin() - stack(i + 1).sin()))
        .sum();
    for (name, mesh, volume) in [
        ("torus", Torus::default().mesh().build(), torus),
        ("cylinder", Cylinder::default().mesh().build(), polygon(32.0, 0.5)),
        ("sphere", Sphere::new(1.0).mesh().uv(32, 18), sphere),
        (
            "frustum",
            ConicalFrustum::default().mesh().build(),
            between(0.25, 0.5, 0.5),
        ),
        ("cone", Cone::default().mesh().build(), polygon(32.0, 0.5) / 3.0),
    ] {
        let baked = CollisionMesh::from_bevy_mesh(&mesh).unwrap();
        assert_eq!(baked.mesh.orientation(), Orientation::Outward, "{name}");
        assert_eq!(
            baked.warnings().len(),
            usize::from(baked.mesh.dropped() > 0),
            "{name}: {:?}",
            baked.warnings()
        );
        assert!(!baked.mass.approximate, "{name}");
        let found = f64::from(baked.mass.volume);
        assert!((found - volume).abs() < 1e-5 * volume, "{name}: {found}, not {volume}");
        let exactly = BakeSettings {
            weld_tolerance: 0.0,
            ..BakeSettings::default()
        };
        let exactly = CollisionMesh::without_faces(&baked.mesh, exactly);
        println!("{name}: {found}, {:?} without a tolerance", exactly.mesh.orientation());
        // Where bits differ the warning says by how much.
        for warning in exactly.warnings().iter().filter(|w| w.contains("is open")) {
            assert!(
                warning.contains("edges have no partner; the nearest corners"),
                "{warning}"
            );
        }
    }
    assert!((torus - 0.909).abs() < 1e-3);
}

#[test]
fn what_cannot_collide_says_why() {
    let list = PrimitiveTopology::TriangleList;
    let triangle = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let error = |mesh: &Mesh| TriMesh::try_from(mesh).unwrap_err();
    let lines = bevy_mesh(PrimitiveTopology::LineList, triangle.clone(), None);
    assert_eq!(error(&lines), BevyMeshError::Topology(PrimitiveTopology::LineList));
    assert_eq!(
        error(&Mesh::new(list, RenderAssetUsages::default())),
        BevyMeshError::NoPositions
    );
    assert_eq!(
        error(&bevy_mesh(list, triangle[..2].to_vec(), None)),
        BevyMeshError::Corners(2)
    );
    assert_eq!(
        error(&bevy_mesh(list, vec![], None)),
        BevyMeshError::Mesh(MeshError::Empty)
    );
    let beyond = bevy_mesh(list, triangle.clone(), Some(Indices::U32(vec![0, 1, 9])));
    assert!(error(&beyond).to_string().contains("names vertex 9"));
    let nan = bevy_mesh(list, vec![[f32::NAN; 3]; 3], None);
    assert!(matches!(error(&nan), BevyMeshError::Mesh(MeshError::NonFinite { .. })));
    let mut taken = drawn(&shapes::cube(1.0));
    taken.take_gpu_data().unwrap();
    assert_eq!(error(&taken), BevyMeshError::InRenderWorld);
    assert!(error(&taken).to_string().contains("RenderAssetUsages::MAIN_WORLD"));
}

fn collider(app: &App, entity: Entity) -> Option<Handle<CollisionMesh>> {
    app.world().get::<MeshCollider>(entity).map(|c| c.0.clone())
}

#[test]
fn entities_get_colliders_of_what_they_show() {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins.build().disable::<bevy::app::ScheduleRunnerPlugin>(),
        FaceoffHeadlessPlugins::default(),
        MeshPlugin,
    ));
    finish(&mut app);
    let add = |app: &mut App, mesh: Mesh| app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    let torus = add(&mut app, drawn(&shapes::torus_240()));
    let mut taken = drawn(&shapes::cube(1.0));
    taken.take_gpu_data().unwrap();
    let taken = add(&mut app, taken);
    let later = app.world().resource::<Assets<Mesh>>().reserve_handle();
    let mut spawn = |mesh: &Handle<Mesh>| app.world_mut().spawn(MeshColliderFrom(mesh.clone())).id();
    let [a, b, broken, early] = [spawn(&torus), spawn(&torus), spawn(&taken), spawn(&later)];
    update_until(&mut app, |app| collider(app, a).is_some() && collider(app, b).is_some());
    assert_eq!(collider(&app, a), collider(&app, b), "one bake for both");
    let baked = app.world().resource::<Assets<CollisionMesh>>();
    assert!(baked.get(&collider(&app, a).unwrap()) == Some(&CollisionMesh::new(&shapes::torus_240())));
    assert_eq!((collider(&app, broken), collider(&app, early)), (None, None));

    app.world_mut()
        .resource_mut::<Assets<Mesh>>()
        .insert(&later, drawn(&shapes::cube(1.0)))
        .unwrap();
    update_until(&mut app, |app| collider(app, early).is_some());
    // A mended mesh is tried again, and a removed collider is made of the mesh as it is now.
    app.world_mut()
        .resource_mut::<Assets<Mesh>>()
        .insert(&taken, drawn(&shapes::ball_320()))
        .unwrap();
    app.world_mut()
        .resource_mut::<Assets<Mesh>>()
        .insert(&torus, drawn(&shapes::cube(1.0)))
        .unwrap();
    for _ in 0..3 {
        app.update();
    }
    app.world_mut().entity_mut(a).remove::<MeshCollider>();
    update_until(&mut app, |app| {
        collider(app, broken).is_some() && collider(app, a).is_some()
    });
    let count = |app: &App, entity: Entity| {
        let baked = app.world().resource::<Assets<CollisionMesh>>();
        baked
            .get(&collider(app, entity).unwrap())
            .unwrap()
            .mesh
            .triangles()
            .len()
    };
    assert_eq!([a, b, broken, early].map(|e| count(&app, e)), [12, 240, 320, 12]);
}

#[test]
fn without_bevy_meshes_nothing_happens() {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins.build().disable::<bevy::app::ScheduleRunnerPlugin>(),
        FaceoffHeadlessPlugins::default(),
    ));
    finish(&mut app);
    app.update();
}
