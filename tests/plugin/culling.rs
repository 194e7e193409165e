//! The modes in an app: who bakes when, and whose choice counts.

use crate::app::Sim;
use crate::log;
use bevy::prelude::*;
use bevy_faceoff::geometry::direction::DirectionGrid;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use bevy_faceoff::projection::{Progress, bake_pool};
use std::time::{Duration, Instant};
use tracing::Level;

/// Bodies that stand still: two tori that touch.
fn tori(culling: Culling) -> (Sim, [Entity; 2], Handle<CollisionMesh>) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default()))
        .insert_resource(Response::None)
        .insert_resource(culling);
    let mut sim = Sim::of(app);
    let settings = BakeSettings {
        faces: false,
        degrees: 15,
        image: 32,
        ..BakeSettings::default()
    };
    let mesh = CollisionMesh::bake(&shapes::torus_240(), settings, bake_pool(), &Progress::default()).unwrap();
    let handle = sim.world().resource_mut::<Assets<CollisionMesh>>().add(mesh);
    let bodies = [(0.0, 0.0), (0.8, 1.0)].map(|(x, angle)| {
        let pose = Transform::from_xyz(x, 0.1 * x, 0.0).with_rotation(Quat::from_rotation_x(angle));
        sim.spawn((RigidBody::Dynamic, MeshCollider(handle.clone()), pose))
    });
    (sim, bodies, handle)
}

fn step(sim: &mut Sim) -> StepReport {
    sim.step(1);
    sim.report().clone()
}

#[test]
fn a_mesh_without_a_table_is_exact_until_one_is_baked() {
    if log::ran_alone("culling::a_mesh_without_a_table_is_exact_until_one_is_baked") {
        return;
    }
    log::keep(&[Level::WARN, Level::ERROR]);
    let (mut sim, _, handle) = tori(Culling::Exact);
    let exact = step(&mut sim);
    assert!(exact.face_pairs > 0 && exact.approximate_pairs == 0 && exact.tables_in_bake == 0);

    // Nothing is baked while every thread of the pool is busy.
    let hold: Vec<_> = (0..bake_pool().current_num_threads())
        .map(|_| {
            let (release, wait) = std::sync::mpsc::channel::<()>();
            bake_pool().spawn(move || _ = wait.recv());
            release
        })
        .collect();
    sim.world().insert_resource(Culling::FacesOfCollision);
    for _ in 0..5 {
        let waiting = step(&mut sim);
        assert_eq!((waiting.face_pairs, waiting.approximate_pairs), (exact.face_pairs, 0));
        assert_eq!(waiting.tables_in_bake, 1);
    }

    drop(hold);
    let start = Instant::now();
    let switched = loop {
        let report = step(&mut sim);
        if report.tables_in_bake == 0 {
            break report;
        }
        assert_eq!(report.face_pairs, exact.face_pairs);
        assert!(start.elapsed() < Duration::from_secs(60), "never baked");
        std::thread::sleep(Duration::from_millis(1));
    };
    assert_eq!(switched.approximate_pairs, 1);
    assert!((1..exact.face_pairs).contains(&switched.face_pairs), "{switched:?}");

    // Back and forth: no second bake, no second warning. The asset itself stays as it was loaded.
    sim.world().insert_resource(Culling::Exact);
    assert_eq!(step(&mut sim).face_pairs, exact.face_pairs);
    sim.world().insert_resource(Culling::FacesOfCollision);
    assert_eq!(step(&mut sim).face_pairs, switched.face_pairs);
    let assets = sim.app.world().resource::<Assets<CollisionMesh>>();
    assert!(assets.get(&handle).unwrap().faces.is_none());
    let warnings = log::lines();
    let about_tables: Vec<_> = warnings.iter().filter(|w| w.contains("no face table")).collect();
    assert_eq!(about_tables.len(), 1, "{warnings:?}");
}

fn torus(degrees: u32, image: u32) -> CollisionMesh {
    let settings = BakeSettings {
        faces: true,
        degrees,
        image,
        ..BakeSettings::default()
    };
    CollisionMesh::bake(&shapes::torus_240(), settings, bake_pool(), &Progress::default()).expect("nobody cancels")
}

/// As the step looks them up: `angles::modes` in the tests of the stages.
#[test]
fn asked_from_outside_a_step_a_baked_direction_has_that_directions_group() {
    let mesh = torus(10, 64);
    let table = mesh.faces.as_ref().unwrap();
    let grid = DirectionGrid::new(10).unwrap();
    let rotation = Quat::from_euler(EulerRot::XYZ, 0.4, -1.1, 2.0);
    let scale = Vec3::new(0.5, -0.8, 1.3);
    for index in 0..grid.len() {
        // M d, so that the look-up has to invert both scale and rotation.
        let offset = 0.3 * (rotation * (scale * grid.direction(index)));
        let pose = Transform {
            translation: -(rotation * (scale * mesh.mass.center)),
            rotation,
            scale,
        };
        let lit = mesh.faces_towards(&pose, offset).expect("a table and a direction");
        assert!(lit == table.of_direction(index), "direction {index}");
    }
}

#[test]
fn without_table_or_direction_nothing_is_known_of_what_is_seen() {
    let mesh = torus(30, 32);
    let pose = Transform::from_xyz(1.0, 2.0, 3.0);
    let center = pose.transform_point(mesh.mass.center);
    assert!(mesh.faces_towards(&pose, center + Vec3::X).is_some());
    assert!(mesh.faces_towards(&pose, center).is_none());
    assert!(mesh.faces_towards(&pose, Vec3::NAN).is_none());
    let bare = CollisionMesh::new(&shapes::torus_240());
    assert!(bare.faces_towards(&pose, center + Vec3::X).is_none());
}

#[test]
fn a_bodys_choice_overrules_the_worlds_at_its_own_end() {
    let (mut sim, [a, b], _) = tori(Culling::Exact);
    let exact = step(&mut sim);
    let mut faces = [0; 4];
    for (choice, faces) in faces.iter_mut().enumerate() {
        for (entity, bit) in [(a, 1), (b, 2)] {
            let culling = if choice & bit == 0 {
                Culling::Exact
            } else {
                Culling::FrontFacing
            };
            sim.world().entity_mut(entity).insert(BodyCulling(culling));
        }
        let report = step(&mut sim);
        assert_eq!(report.approximate_pairs, usize::from(choice > 0));
        *faces = report.face_pairs;
    }
    let [neither, first, second, both] = faces;
    assert_eq!(neither, exact.face_pairs);
    assert!(first < neither && second < neither, "{faces:?}");
    assert!(both <= first.min(second), "{faces:?}");
    // And the world's choice holds where a body has none.
    sim.world().entity_mut(a).remove::<BodyCulling>();
    sim.world().entity_mut(b).insert(BodyCulling(Culling::Exact));
    sim.world().insert_resource(Culling::FrontFacing);
    assert_eq!(step(&mut sim).face_pairs, first);
}
