//! Questions of systems: what they find, what they ignore, and which poses they see. Other tests run them on a GPU.

use crate::app::{Sim, assert_near};
use bevy::ecs::system::SystemState;
use bevy::math::{DAffine3, DVec3};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::queries::update_spatial_queries;
use bevy_faceoff::prelude::*;
use bevy_faceoff::queries::{Placed, Ray};

fn ask<T>(sim: &mut Sim, question: impl FnOnce(SpatialQuery) -> T) -> T {
    let mut state = SystemState::<SpatialQuery>::new(sim.world());
    question(state.get(sim.app.world()).unwrap())
}

fn cast(sim: &mut Sim, origin: Vec3, direction: Vec3) -> Option<RayHitData> {
    let direction = Dir3::new(direction).unwrap();
    ask(sim, move |world| {
        world.cast_ray(origin, direction, f32::INFINITY, &SpatialQueryFilter::default())
    })
}

fn random(random: &mut fastrand::Rng) -> Vec3 {
    let mut unit = || 2.0 * random.f32() - 1.0;
    Vec3::new(unit(), unit(), unit())
}

pub fn a_ray_finds_what_rays_against_each_collider_find() {
    let mut sim = Sim::new();
    let (knot, cube) = (shapes::knot_1120(), shapes::cube(0.7));
    let meshes = [sim.mesh(&knot), sim.mesh(&cube)];
    let baked = [CollisionMesh::new(&knot), CollisionMesh::new(&cube)];
    let mut rng = fastrand::Rng::with_seed(3);
    let mut colliders = Vec::new();
    for i in 0..200 {
        let transform = Transform {
            translation: 6.0 * random(&mut rng) + 5000.0 * Vec3::X,
            rotation: Quat::from_scaled_axis(3.0 * random(&mut rng)),
            scale: Vec3::ONE + 0.5 * random(&mut rng),
        };
        let entity = sim.spawn((meshes[i % 2].clone(), transform));
        colliders.push((entity, i % 2, transform));
    }
    let floor = sim.spawn(PlaneCollider::through(Vec3::NEG_Y * 7.0, Vec3::Y));
    sim.step(1);
    let placed: Vec<_> = (colliders.iter())
        .map(|&(entity, mesh, t)| {
            let (translation, rotation) = (t.translation.as_dvec3(), t.rotation.as_dquat());
            (
                entity,
                Placed::new(&baked[mesh], translation, rotation, t.scale).unwrap(),
            )
        })
        .collect();
    let (mut on_meshes, mut on_floor) = (0, 0);
    for _ in 0..500 {
        let origin = 8.0 * random(&mut rng) + 5000.0 * Vec3::X;
        let direction = Dir3::new(random(&mut rng)).unwrap();
        let ray = Ray::new(origin.as_dvec3(), direction.as_dvec3());
        let hits = placed
            .iter()
            .filter_map(|(entity, placed)| Some((*entity, placed.cast_ray(&ray)?)));
        let nearest = hits.min_by(|a, b| a.1.distance.total_cmp(&b.1.distance));
        let found = cast(&mut sim, origin, *direction);
        let below = direction.y < 0.0 && origin.y > -7.0 || direction.y > 0.0 && origin.y < -7.0;
        let to_floor = below.then(|| f64::from((-7.0 - origin.y) / direction.y));
        match (nearest, to_floor) {
            (Some((entity, hit)), floor) if floor.is_none_or(|floor| hit.distance < floor) => {
                let found = found.expect("a hit");
                assert_eq!((found.collider, found.face), (entity, Some(hit.face)));
                assert!((f64::from(found.distance) - hit.distance).abs() < 1e-5);
                on_meshes += 1;
            }
            (_, Some(distance)) => {
                let found = found.expect("the floor");
                assert_eq!((found.collider, found.body, found.face), (floor, floor, None));
                assert!((f64::from(found.distance) - distance).abs() < 1e-4 * distance);
                assert_eq!(found.from_behind, origin.y < -7.0);
                on_floor += 1;
            }
            _ => assert_eq!(found, None),
        }
    }
    assert!(on_meshes > 60 && on_floor > 60, "{on_meshes} {on_floor}");
}

pub fn a_filter_chooses_what_counts() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let at = |x: f32| Transform::from_xyz(x, 0.0, 0.0);
    let layers = CollisionLayers {
        memberships: 0b10,
        ..default()
    };
    let first = sim.spawn((cube.clone(), at(2.0), Sensor));
    let second = sim.spawn((RigidBody::Kinematic, at(4.0), layers));
    let part = sim.spawn((cube.clone(), ChildOf(second)));
    let third = sim.spawn((cube.clone(), at(6.0)));
    let behind = sim.spawn((cube, at(8.0), ColliderDisabled));
    sim.step(1);
    let mut hit = |filter: SpatialQueryFilter| {
        let hit = ask(&mut sim, move |world| {
            let all = world.ray_hits(Vec3::ZERO, Dir3::X, 100.0, &filter);
            let first = world.cast_ray(Vec3::ZERO, Dir3::X, 100.0, &filter);
            assert_eq!(world.hits_ray(Vec3::ZERO, Dir3::X, 100.0, &filter), first.is_some());
            assert_eq!(all.first(), first.as_ref());
            first
        });
        hit.map(|hit| (hit.collider, hit.body))
    };
    let all = SpatialQueryFilter::default;
    assert_eq!(hit(all()), Some((first, first)));
    assert_eq!(hit(all().without_sensors()), Some((part, second)));
    assert_eq!(hit(SpatialQueryFilter::in_layers(0b10)), Some((part, second)));
    assert_eq!(hit(SpatialQueryFilter::in_layers(0b100)), None);
    assert_eq!(hit(SpatialQueryFilter::excluding([first, part])), Some((third, third)));
    // A body stands for its colliders.
    assert_eq!(
        hit(SpatialQueryFilter::excluding([first, second])),
        Some((third, third))
    );
    assert_eq!(hit(SpatialQueryFilter::excluding([first, second, third])), None);
    sim.world().entity_mut(behind).remove::<ColliderDisabled>();
    sim.step(1);
    let filter = SpatialQueryFilter::excluding([first, second, third]);
    let hit = ask(&mut sim, move |world| {
        world.cast_ray(Vec3::ZERO, Dir3::X, 100.0, &filter)
    });
    assert_eq!(hit.unwrap().collider, behind);
    // A predicate sees each hit.
    let on_far_side = ask(&mut sim, |world| {
        let is_wanted = |hit: &RayHitData| hit.from_behind;
        world.cast_ray_predicate(Vec3::ZERO, Dir3::X, 100.0, &SpatialQueryFilter::default(), is_wanted)
    });
    assert_near(on_far_side.unwrap().point, Vec3::X * 2.5, 1e-6);
}

pub fn parts_are_where_their_body_is() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let root = sim.spawn(
        Transform::from_xyz(10.0, 3.0, 0.0)
            .with_rotation(Quat::from_rotation_z(0.4))
            .with_scale(Vec3::splat(2.0)),
    );
    let body = sim.spawn((
        RigidBody::Dynamic,
        LinearVelocity(Vec3::Y),
        AngularVelocity(Vec3::X),
        Transform::from_xyz(0.0, 1.0, 0.0),
        ChildOf(root),
    ));
    let parts = [-1.0, 1.0].map(|x| sim.spawn((cube.clone(), Transform::from_xyz(x, 0.0, 0.3), ChildOf(body))));
    for _ in 0..20 {
        sim.step(1);
        let affine = |entity| {
            let transform = sim.get::<Transform>(entity);
            DAffine3::from_scale_rotation_translation(
                transform.scale.as_dvec3(),
                transform.rotation.as_dquat(),
                transform.translation.as_dvec3(),
            )
        };
        let to_world = parts.map(|part| affine(root) * affine(body) * affine(part));
        for (part, to_world) in parts.into_iter().zip(to_world) {
            // From above its own upper face, which is at 1 m from its middle.
            let [origin, face] = [1.0, 0.5].map(|y| to_world.transform_point3(DVec3::Y * y).as_vec3());
            let hit = cast(&mut sim, origin, face - origin).unwrap();
            assert_eq!((hit.collider, hit.body), (part, body));
            assert_near(hit.point, face, 1e-4);
        }
    }
}

pub fn what_moved_since_the_step_is_seen_after_an_update() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let lift = sim.spawn((RigidBody::Kinematic, cube.clone(), Transform::default()));
    let down = |sim: &mut Sim| cast(sim, Vec3::Y * 10.0, Vec3::NEG_Y).map(|hit| (hit.collider, hit.distance));
    // The first question comes before the first step.
    assert_eq!(down(&mut sim), Some((lift, 9.5)));
    sim.step(1);
    sim.set(lift, Transform::from_xyz(0.0, 2.0, 0.0));
    assert_eq!(down(&mut sim), Some((lift, 9.5)));
    let box_above = sim.spawn((cube, Transform::from_xyz(0.0, 5.0, 0.0)));
    sim.world().run_system_cached(update_spatial_queries).unwrap();
    assert_eq!(down(&mut sim), Some((box_above, 4.5)));
    sim.world().despawn(box_above);
    sim.step(1);
    assert_eq!(down(&mut sim), Some((lift, 7.5)));
    sim.set(lift, Transform::from_xyz(f32::NAN, 2.0, 0.0));
    sim.step(1);
    assert_eq!(down(&mut sim), None);
}

pub fn systems_that_ask_may_write_transforms_and_run_in_parallel() {
    #[derive(Resource, Default)]
    struct Found(Vec<Entity>);
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let entity = sim.spawn((cube, Transform::default()));
    let look = |world: SpatialQuery, mut transforms: Query<&mut Transform>, mut found: ResMut<Found>| {
        let hit = world.cast_ray(Vec3::Y * 3.0, Dir3::NEG_Y, 10.0, &SpatialQueryFilter::default());
        if let Some(hit) = hit {
            found.0.push(hit.collider);
            transforms.get_mut(hit.collider).unwrap().translation.x += 0.125;
        }
    };
    fn also(_: SpatialQuery) {}
    sim.world().init_resource::<Found>();
    sim.app.add_systems(Update, (look, also));
    sim.step(6);
    // It leaves the ray's way, which starts above its middle, after half its width.
    assert_eq!(sim.app.world().resource::<Found>().0, [entity; 5]);
}

pub fn invalid_rays_hit_nothing() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.spawn((cube, Transform::default()));
    sim.spawn(PlaneCollider::through(Vec3::NEG_Y, Vec3::Y));
    sim.step(1);
    ask(&mut sim, |world| {
        let filter = SpatialQueryFilter::default();
        for (origin, length) in [(Vec3::NAN, 1.0), (Vec3::Y, f32::NAN), (Vec3::Y, -1.0), (Vec3::Y, 0.25)] {
            assert_eq!(world.cast_ray(origin, Dir3::NEG_Y, length, &filter), None);
            assert!(!world.hits_ray(origin, Dir3::NEG_Y, length, &filter));
            assert!(world.ray_hits(origin, Dir3::NEG_Y, length, &filter).is_empty());
        }
        assert_eq!(world.check(), Ok(()));
        let far = Vec3::new(1e30, 0.1, 0.2);
        assert!(
            world
                .cast_ray(far, Dir3::NEG_X, f32::INFINITY, &filter)
                .is_none_or(|hit| hit.distance > 1e29)
        );
    });
}

pub fn a_ray_caster_keeps_what_it_hits() {
    let mut sim = Sim::new();
    let (cube, ring) = (sim.mesh(&shapes::cube(1.0)), sim.mesh(&shapes::torus_240()));
    let body = sim.spawn((
        RigidBody::Dynamic,
        cube.clone(),
        LinearVelocity(Vec3::X * 4.0),
        Transform::from_rotation(Quat::from_rotation_y(std::f32::consts::PI)),
    ));
    // It looks along the world's -x from inside of its own body.
    let eye = RayCaster::new(Vec3::ZERO, Dir3::X);
    let eye = sim.spawn((eye, Transform::from_xyz(0.0, 0.1, 0.0), ChildOf(body)));
    let wall = sim.spawn((cube, Transform::from_xyz(-6.0, 0.0, 0.0)));
    let tube = sim.spawn((
        ring,
        Transform::from_xyz(-3.0, 0.0, 0.0).with_rotation(Quat::from_rotation_x(1.3)),
    ));
    let colliders = |sim: &Sim| {
        sim.get::<RayHits>(eye)
            .iter()
            .map(|hit| hit.collider)
            .collect::<Vec<_>>()
    };
    for _ in 0..4 {
        sim.step(1);
        let hits = sim.get::<RayHits>(eye);
        let hit = hits.last().unwrap();
        // Once for each collider, though the ray passes through the tube twice.
        assert_eq!(colliders(&sim), [tube, wall]);
        assert_eq!(hit.collider, wall);
        assert!((hit.distance - (sim.position(body).x + 5.5)).abs() < 1e-5);
    }
    let mut caster = sim.get::<RayCaster>(eye).with_max_hits(1);
    sim.set(eye, caster.clone());
    sim.step(1);
    assert_eq!(colliders(&sim), [tube]);
    caster = caster.with_ignore_self(false);
    sim.set(eye, caster.clone());
    sim.step(1);
    assert_eq!(colliders(&sim), [body]);
    caster.enabled = false;
    sim.set(eye, caster);
    sim.step(1);
    assert!(colliders(&sim).is_empty());
}

pub fn the_nearest_point_is_that_of_the_nearest_collider() {
    let mut sim = Sim::new();
    let torus = sim.mesh(&shapes::torus_240());
    let baked = CollisionMesh::new(&shapes::torus_240());
    let mut rng = fastrand::Rng::with_seed(11);
    let mut colliders = Vec::new();
    for _ in 0..60 {
        let transform = Transform {
            translation: 3.0 * random(&mut rng),
            rotation: Quat::from_scaled_axis(3.0 * random(&mut rng)),
            scale: Vec3::ONE + 0.5 * random(&mut rng),
        };
        colliders.push((sim.spawn((torus.clone(), transform)), transform));
    }
    let floor = sim.spawn(PlaneCollider::through(Vec3::NEG_Y * 3.0, Vec3::Y));
    sim.step(1);
    let (mut inside, mut on_floor) = (0, 0);
    for _ in 0..400 {
        let point = 4.0 * random(&mut rng);
        let hits = colliders.iter().map(|&(entity, t)| {
            let (translation, rotation) = (t.translation.as_dvec3(), t.rotation.as_dquat());
            let placed = Placed::new(&baked, translation, rotation, t.scale).unwrap();
            let hit = placed.closest_point(point.as_dvec3(), f64::INFINITY).unwrap();
            (hit.distance, entity)
        });
        let distances: Vec<_> = hits.chain([((f64::from(point.y) + 3.0).max(0.0), floor)]).collect();
        let nearest = distances
            .iter()
            .map(|(distance, _)| *distance)
            .fold(f64::INFINITY, f64::min);
        let mut found = |most: f32| {
            ask(&mut sim, |world| {
                world.closest_point(point, most, &SpatialQueryFilter::default())
            })
        };
        let hit = found(f32::INFINITY).unwrap();
        assert!((f64::from(hit.distance) - nearest).abs() < 1e-5, "{hit:?} {nearest}");
        let of_collider = distances.iter().find(|(_, entity)| *entity == hit.collider).unwrap();
        assert!((of_collider.0 - nearest).abs() < 1e-9);
        if hit.distance == 0.0 {
            inside += usize::from(hit.is_inside);
        } else {
            assert_near(hit.point + hit.normal * hit.distance, point, 1e-5);
            assert_eq!(found(hit.distance * 0.999), None);
        }
        on_floor += usize::from(hit.collider == floor);
    }
    assert!(inside > 20 && on_floor > 20, "{inside} {on_floor}");
}

pub fn shapes_overlap_what_they_touch_or_contain() {
    let mut sim = Sim::new();
    let (cube, ring) = (sim.mesh(&shapes::cube(1.0)), sim.mesh(&shapes::torus_240()));
    let room = sim.spawn((cube, Transform::from_scale(Vec3::splat(20.0))));
    let upright = Quat::from_rotation_arc(hole_axis(), Vec3::Y);
    let ring = sim.spawn((ring, Transform::from_rotation(upright)));
    let floor = sim.spawn(PlaneCollider::through(Vec3::NEG_Y * 2.0, Vec3::Y));
    sim.step(1);
    let baked = CollisionMesh::new(&shapes::cube(0.2));
    let mut overlapping = |shape: &QueryShape, at: Vec3| {
        let found = ask(&mut sim, |world| {
            world.overlapping(shape, at, Quat::IDENTITY, &SpatialQueryFilter::default())
        });
        [room, ring, floor].map(|entity| found.contains(&entity))
    };
    let ball = |radius: f64| QueryShape::Ball { radius };
    // In the hole of the ring, inside of the solid cube.
    assert_eq!(overlapping(&ball(0.05), Vec3::ZERO), [true, false, false]);
    assert_eq!(overlapping(&ball(0.6), Vec3::ZERO), [true, true, false]);
    assert_eq!(overlapping(&ball(1.5), Vec3::NEG_Y), [true, true, true]);
    assert_eq!(overlapping(&ball(1.0), Vec3::Y * 11.5), [false; 3]);
    assert_eq!(
        overlapping(&QueryShape::Mesh(&baked, Vec3::ONE), Vec3::ZERO),
        [true, false, false]
    );
    assert_eq!(
        overlapping(&QueryShape::Mesh(&baked, Vec3::ONE), Vec3::NEG_Y * 1.95),
        [true, false, true]
    );
    let capsule = QueryShape::Capsule {
        radius: 0.1,
        half_length: 2.0,
    };
    assert_eq!(overlapping(&capsule, Vec3::ZERO), [true, false, true]);
    let half_size = Vec3::new(0.02, 1.95, 0.02).as_dvec3();
    assert_eq!(
        overlapping(&QueryShape::Box { half_size }, Vec3::ZERO),
        [true, false, false]
    );
    assert_eq!(overlapping(&ball(f64::NAN), Vec3::ZERO), [false; 3]);
}

pub fn a_shape_caster_keeps_what_it_runs_into() {
    let mut sim = Sim::new();
    let (cube, ring) = (sim.mesh(&shapes::cube(1.0)), sim.mesh(&shapes::torus_240()));
    let body = sim.spawn((RigidBody::Dynamic, cube.clone(), Transform::default()));
    let ball = CasterShape::Ball { radius: 0.25 };
    let eye = sim.spawn((
        ShapeCaster::new(ball, Vec3::ZERO, Dir3::X).with_max_hits(4),
        ChildOf(body),
    ));
    // The ball flies through the hole of the first ring, and not through that of the second.
    let through = Quat::from_rotation_arc(hole_axis(), Vec3::X);
    let wide = Transform::from_xyz(3.0, 0.0, 0.0)
        .with_rotation(through)
        .with_scale(Vec3::splat(4.0));
    let narrow = Transform::from_xyz(6.0, 0.0, 0.0)
        .with_rotation(through)
        .with_scale(Vec3::splat(0.5));
    let wide = sim.spawn((ring.clone(), wide));
    let narrow = sim.spawn((ring, narrow));
    let wall = sim.spawn((RigidBody::Static, cube.clone(), Transform::from_xyz(9.0, 0.0, 0.0)));
    // Another collider of the wall's body.
    let behind = sim.spawn((cube.clone(), Transform::from_xyz(1.5, 0.0, 0.0), ChildOf(wall)));
    let plane = sim.spawn(PlaneCollider::through(Vec3::X * 12.0, Vec3::NEG_X));
    sim.step(1);
    let colliders = |sim: &Sim| {
        sim.get::<ShapeHits>(eye)
            .iter()
            .map(|hit| hit.collider)
            .collect::<Vec<_>>()
    };
    assert_eq!(colliders(&sim), [narrow, wall, behind, plane]);
    let hits = sim.get::<ShapeHits>(eye);
    assert!((hits[1].distance - 8.25).abs() < 1e-6 && (hits[3].distance - 11.75).abs() < 1e-6);
    assert_near(hits[1].normal, Vec3::NEG_X, 1e-6);
    assert!((hits[1].point.x - 8.5).abs() < 1e-6);
    sim.world().despawn(wide);
    // A mesh, turned with its entity.
    let caster = sim.get::<ShapeCaster>(eye);
    let shape = CasterShape::Mesh {
        mesh: cube.0,
        scale: Vec3::new(1.0, 6.0, 1.0),
    };
    sim.set(
        eye,
        ShapeCaster {
            shape,
            ..caster.with_max_hits(1)
        },
    );
    sim.set(
        eye,
        Transform::from_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)),
    );
    sim.step(1);
    // It goes along +y now, lying along x.
    assert_eq!(colliders(&sim), []);
    let collider: MeshCollider = sim.get(wall);
    let lid = sim.spawn((collider, Transform::from_xyz(2.8, 4.0, 0.0)));
    sim.step(1);
    let hits = sim.get::<ShapeHits>(eye);
    assert_eq!(colliders(&sim), [lid]);
    assert!((hits[0].distance - 3.0).abs() < 1e-6);
    assert!(hits[0].face.is_some() && hits[0].shape_face.is_some());
}

/// The axis of the hole of the torus: that of its smallest extent.
fn hole_axis() -> Vec3 {
    let torus = shapes::torus_240();
    let size = torus.vertices().iter().fold(Vec3::ZERO, |size, v| size.max(v.abs()));
    Vec3::AXES[size.min_position()]
}
