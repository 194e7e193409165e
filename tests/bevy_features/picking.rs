//! Pointer hits on colliders.

use crate::app::{Sim, assert_near};
use bevy::camera::Camera;
use bevy::ecs::message::Messages;
use bevy::picking::backend::ray::{RayId, RayMap};
use bevy::picking::backend::{HitData, PointerHits};
use bevy::picking::pointer::PointerId;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::picking::{ColliderPickingCamera, ColliderPickingPlugin, ColliderPickingSettings};
use bevy_faceoff::prelude::*;

/// An app with a camera and a ray of the mouse through it along -z.
fn app() -> (Sim, Entity) {
    let mut sim = Sim::with_plugin(ColliderPickingPlugin);
    let camera = sim.spawn(Camera { order: 3, ..default() });
    let ray = Ray3d::new(Vec3::Z * 10.0, Dir3::NEG_Z);
    let mut rays = RayMap::default();
    rays.map.insert(RayId::new(camera, PointerId::Mouse), ray);
    sim.world().insert_resource(rays);
    (sim, camera)
}

fn picks(sim: &mut Sim) -> Vec<(Entity, HitData)> {
    sim.step(1);
    sim.world().resource_mut::<Messages<PointerHits>>().clear();
    sim.step(1);
    let hits: Vec<_> = sim.world().resource_mut::<Messages<PointerHits>>().drain().collect();
    assert!(
        hits.iter()
            .all(|hits| hits.order == 3.0 && hits.pointer == PointerId::Mouse)
    );
    hits.into_iter().flat_map(|hits| hits.picks).collect()
}

fn entities(sim: &mut Sim) -> Vec<Entity> {
    picks(sim).iter().map(|(entity, _)| *entity).collect()
}

#[test]
fn a_pointer_hits_the_collider_below_it_with_its_face() {
    let (mut sim, camera) = app();
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn((RigidBody::Static, Transform::default()));
    let front = sim.spawn((cube.clone(), Transform::from_xyz(0.1, 0.2, 2.0), ChildOf(body)));
    sim.spawn((cube, Transform::default()));
    let picks = picks(&mut sim);
    let [(entity, hit)] = &picks[..] else {
        panic!("{picks:?}")
    };
    assert_eq!((*entity, hit.camera), (front, camera));
    assert_eq!(hit.depth, 7.5);
    assert_near(hit.position.unwrap(), Vec3::Z * 2.5, 1e-6);
    assert_near(hit.normal.unwrap(), Vec3::Z, 1e-6);
    let data = hit.extra_as::<RayHitData>().unwrap();
    assert_eq!((data.collider, data.body), (front, body));
    let face = shapes::cube(1.0).corners(data.face.unwrap() as usize);
    assert!(face.iter().all(|corner| corner.z == 0.5));
}

#[test]
fn pickable_and_the_camera_decide_what_is_hit() {
    let (mut sim, camera) = app();
    let cube = sim.mesh(&shapes::cube(1.0));
    let at = |z: f32| Transform::from_xyz(0.0, 0.0, z);
    let [first, second, third] = [4.0, 2.0, 0.0].map(|z| sim.spawn((cube.clone(), at(z))));
    assert_eq!(entities(&mut sim), [first]);
    // What lets pointers through.
    let through = Pickable {
        should_block_lower: false,
        is_hoverable: true,
    };
    sim.set(first, through);
    assert_eq!(entities(&mut sim), [first, second]);
    sim.set(first, Pickable::IGNORE);
    assert_eq!(entities(&mut sim), [second]);
    // Sensors are left out, unless the camera says otherwise.
    sim.set(second, Sensor);
    assert_eq!(entities(&mut sim), [third]);
    sim.set(camera, ColliderPickingCamera(SpatialQueryFilter::default()));
    assert_eq!(entities(&mut sim), [second]);
    sim.set(
        camera,
        ColliderPickingCamera(SpatialQueryFilter::excluding([second, third])),
    );
    assert_eq!(entities(&mut sim), []);
    // Only what is marked.
    sim.set(camera, ColliderPickingCamera::default());
    sim.world()
        .insert_resource(ColliderPickingSettings { require_markers: true });
    assert_eq!(entities(&mut sim), []);
    sim.set(third, Pickable::default());
    assert_eq!(entities(&mut sim), [third]);
    sim.world().entity_mut(camera).remove::<ColliderPickingCamera>();
    assert_eq!(entities(&mut sim), []);
}

/// As in an editor.
#[test]
fn while_the_clock_is_paused_colliders_are_picked_where_they_are() {
    for pause in [pause_physics as fn(&mut Sim), pause_all] {
        let (mut sim, _) = app();
        let cube = sim.mesh(&shapes::cube(1.0));
        let back = sim.spawn((cube.clone(), Transform::default()));
        assert_eq!(entities(&mut sim), [back]);
        pause(&mut sim);
        let front = sim.spawn((cube, Transform::from_xyz(0.0, 0.0, 2.0)));
        assert_eq!(entities(&mut sim), [front]);
        sim.set(front, Transform::from_xyz(5.0, 0.0, 2.0));
        assert_eq!(entities(&mut sim), [back]);
        sim.set(front, Transform::from_xyz(0.0, 0.0, 2.0));
        assert_eq!(entities(&mut sim), [front]);
        sim.world().despawn(front);
        assert_eq!(entities(&mut sim), [back]);
    }
}

fn pause_physics(sim: &mut Sim) {
    sim.world().resource_mut::<Time<Physics>>().pause();
}

fn pause_all(sim: &mut Sim) {
    sim.world().resource_mut::<Time<Virtual>>().pause();
}

#[test]
fn a_collider_that_is_gone_blocks_no_pointer() {
    let (mut sim, _) = app();
    let cube = sim.mesh(&shapes::cube(1.0));
    let back = sim.spawn((cube.clone(), Transform::default()));
    let front = sim.spawn((cube, Transform::from_xyz(0.0, 0.0, 2.0)));
    assert_eq!(entities(&mut sim), [front]);
    // Before the next step.
    sim.world().despawn(front);
    sim.step(1);
    let hits: Vec<_> = sim.world().resource_mut::<Messages<PointerHits>>().drain().collect();
    let picks = hits.last().expect("a pointer hits").picks.iter();
    assert_eq!(picks.map(|(entity, _)| *entity).collect::<Vec<_>>(), [back]);
}
