//! The approximate culling modes: what they find, and whose faces they look at.

use bevy::prelude::Transform;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::direction::{Angles, DirectionGrid};
use bevy_faceoff::geometry::{Orientation, TriMesh, shapes};
use bevy_faceoff::projection::{BakeSettings, Progress, bake_pool};
use bevy_faceoff::queries::{CheckOptions, Placement, TouchingPair, check, check_with};
use bevy_faceoff::state::{Body, View};
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::settings::Culling;
use bevy_faceoff::types::stage::Stage;
use glam::{DMat3, DVec3, Quat, Vec3};
use std::collections::BTreeSet;

#[path = "culling/app.rs"]
mod app;
mod log;

const MODES: [Culling; 3] = [Culling::Exact, Culling::FacesOfCollision, Culling::FrontFacing];

fn baked(mesh: &TriMesh, degrees: u32, image: u32) -> CollisionMesh {
    let settings = BakeSettings {
        faces: true,
        degrees,
        image,
        ..BakeSettings::default()
    };
    CollisionMesh::bake(mesh, settings, bake_pool(), &Progress::default()).expect("nobody cancels")
}

fn inside_out(mesh: &TriMesh) -> TriMesh {
    let faces = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    TriMesh::new(mesh.vertices().to_vec(), faces).unwrap()
}

/// Most triangles are hidden from everywhere, so that groups are stored as lists.
fn boxed_ball() -> TriMesh {
    let (cube, ball) = (shapes::cube(1.0), shapes::ball(0.3, 3));
    let first = cube.vertices().len() as u32;
    let vertices = cube.vertices().iter().chain(ball.vertices()).copied().collect();
    let moved = ball.triangles().iter().map(|t| t.map(|v| v + first));
    TriMesh::new(vertices, cube.triangles().iter().copied().chain(moved).collect()).unwrap()
}

fn random_pose(random: &mut fastrand::Rng, size: f32) -> (Vec3, Quat) {
    let mut vector = |size: f32| Vec3::from_array([0; 3].map(|_| size * (2.0 * random.f32() - 1.0)));
    (vector(size), Quat::from_scaled_axis(vector(3.0)))
}

/// Runs the three stages that find collisions, on one pair.
fn collide(state: &mut StepState, bodies: [Body; 2], culling: [Culling; 2]) -> BTreeSet<[u32; 2]> {
    state.input.bodies.clear();
    for (body, culling) in bodies.into_iter().zip(culling) {
        state
            .input
            .bodies
            .push(&Body { culling, ..body }, &state.input.meshes)
            .unwrap();
    }
    for stage in [Stage::BroadPhase, Stage::Angles, Stage::TriangleTest] {
        bevy_faceoff::step::cpu::run(stage, state);
    }
    state.results.contacts.faces.iter().map(|f| [f.a, f.b]).collect()
}

/// Which input faces of a body look at `other`, worked out in double precision from the definition: `Some` if it is clear.
struct Seen(Vec<Option<bool>>);

impl Seen {
    fn of(mesh: &CollisionMesh, body: &Body, other: DVec3, culling: Culling) -> Self {
        let matrix =
            DMat3::from_quat(body.rotation.as_dquat().normalize()) * DMat3::from_diagonal(body.scale.as_dvec3());
        let direction = other - (matrix * mesh.mass.center.as_dvec3() + body.position.as_dvec3());
        let local = matrix.inverse() * direction;
        let count = mesh.mesh.triangles().len();
        let mut seen = vec![Some(true); count];
        for t in 0..count {
            let face = mesh.mesh.face_ids()[t] as usize;
            seen[face] = match culling {
                Culling::FacesOfCollision => {
                    let table = mesh.faces.as_ref().unwrap();
                    let near = |by: DVec3| {
                        table
                            .group((local + by * local.length() * 1.0e-5).as_vec3())
                            .contains(t as u32)
                    };
                    let around = [
                        DVec3::ZERO,
                        DVec3::X,
                        DVec3::NEG_X,
                        DVec3::Y,
                        DVec3::NEG_Y,
                        DVec3::Z,
                        DVec3::NEG_Z,
                    ];
                    let here = near(DVec3::ZERO);
                    around.iter().all(|&by| near(by) == here).then_some(here)
                }
                // What is in a room sees every wall.
                Culling::FrontFacing if mesh.mesh.orientation() == Orientation::Inward => Some(true),
                Culling::FrontFacing => {
                    let [p, q, r] = mesh.mesh.corners(t).map(|p| p.as_dvec3());
                    let normal = (q - p).cross(r - p);
                    let outward = match mesh.mesh.orientation() {
                        Orientation::Outward => normal,
                        _ => panic!("no outside"),
                    };
                    // Normals go with the inverse transpose.
                    let world = (matrix.inverse().transpose() * outward).normalize();
                    let cosine = world.dot(direction.normalize());
                    (cosine.abs() > 1.0e-4).then_some(cosine > 0.0)
                }
                _ => Some(true),
            };
        }
        Self(seen)
    }
}

#[test]
fn modes_find_exactly_those_pairs_of_faces_that_are_in_view_from_either_end() {
    let torus = shapes::torus_240();
    let meshes = [
        baked(&torus, 5, 64),
        baked(&shapes::knot_1120(), 15, 64),
        baked(&inside_out(&torus), 10, 64),
        baked(&boxed_ball(), 10, 32),
    ];
    let mut state = StepState::default();
    let slots = meshes.clone().map(|mesh| state.input.meshes.add(mesh));
    let mut random = fastrand::Rng::with_seed(5);
    let scales = [
        Vec3::ONE,
        Vec3::new(0.4, 1.0, 1.7),
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(1.3, -0.7, -0.9),
        Vec3::new(-0.5, -1.0, -1.5),
    ];
    let (mut hits, mut left_out) = (0, 0);
    for case in 0..1500 {
        let kinds = [0; 2].map(|_| random.usize(..4));
        let culling = [0; 2].map(|_| MODES[random.usize(..3)]);
        let bodies = [0, 1].map(|end| {
            let (position, rotation) = random_pose(&mut random, 0.35);
            Body::at_rest(slots[kinds[end]], position, rotation, scales[random.usize(..5)])
        });
        let exact = collide(&mut state, bodies, [Culling::Exact; 2]);
        let touching = state.results.contacts.pairs.len();
        let found = collide(&mut state, bodies, culling);
        assert!(
            state.results.contacts.pairs.len() <= touching,
            "case {case}: a collision was invented"
        );
        let centers = [0, 1].map(|i| state.input.bodies.frame[i].center);
        let seen = [0, 1].map(|i| Seen::of(&meshes[kinds[i]], &bodies[i], centers[1 - i], culling[i]));
        for hit in &exact {
            let expected = [0, 1].map(|i| seen[i].0[hit[i] as usize]);
            let expected = match expected {
                [Some(a), Some(b)] => a && b,
                [Some(false), _] | [_, Some(false)] => false,
                _ => continue,
            };
            let what = (culling, bodies[0].scale, bodies[1].scale, kinds);
            assert_eq!(found.contains(hit), expected, "case {case}, faces {hit:?}: {what:?}");
        }
        assert!(found.is_subset(&exact), "case {case}: a hit was invented");
        hits += found.len();
        left_out += exact.len() - found.len();
    }
    assert!(hits > 10_000 && left_out > 10_000, "{hits} {left_out}");
}

#[test]
fn no_first_contact_of_cubes_is_missed() {
    let cube = baked(&shapes::cube(1.0), 1, 64);
    let mut random = fastrand::Rng::with_seed(9);
    let run = |placements: &[Placement; 2], culling| check_with(placements, &CheckOptions { culling }).unwrap();
    for case in 0..300 {
        let (way, rotation) = random_pose(&mut random, 1.0);
        let (_, first_rotation) = random_pose(&mut random, 1.0);
        let scale = Vec3::splat(0.3 + random.f32());
        let way = way.normalize_or(Vec3::X);
        let place = |at: f32| {
            [(Vec3::ZERO, first_rotation, Vec3::ONE), (at * way, rotation, scale)].map(
                |(translation, rotation, scale)| Placement {
                    mesh: cube.clone(),
                    translation,
                    rotation,
                    scale,
                },
            )
        };
        // Convex bodies that approach along the line of centres touch from some distance on.
        let (mut touching, mut apart) = (0.0, 4.0);
        for _ in 0..30 {
            let middle = 0.5 * (touching + apart);
            if check(&place(middle)).unwrap().is_empty() {
                apart = middle;
            } else {
                touching = middle;
            }
        }
        let met = place(touching * 0.999);
        assert!(!run(&met, Culling::Exact)[0].faces.is_empty());
        for culling in [Culling::FacesOfCollision, Culling::FrontFacing] {
            let found = run(&met, culling);
            assert!(
                found.first().is_some_and(|pair| !pair.faces.is_empty()),
                "case {case}, {culling:?}"
            );
        }
    }
}

#[test]
fn a_body_in_a_baked_direction_looks_up_that_directions_group() {
    let mesh = baked(&shapes::torus_240(), 10, 64);
    let table = mesh.faces.as_ref().unwrap();
    let grid = DirectionGrid::new(10).unwrap();
    let mut state = StepState::default();
    let slot = state.input.meshes.add(mesh.clone());
    let rotation = Quat::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 2.0);
    let scale = Vec3::new(0.5, -0.8, 1.3);
    for index in 0..grid.len() {
        // M d, so that the look-up has to invert both scale and rotation.
        let offset = 0.3 * (rotation * (scale * grid.direction(index)));
        let body = |at: Vec3, rotation: Quat, scale: Vec3| {
            Body::at_rest(slot, at - rotation * (scale * mesh.mass.center), rotation, scale)
        };
        let bodies = [
            body(Vec3::ZERO, rotation, scale),
            body(offset, Quat::IDENTITY, Vec3::ONE),
        ];
        collide(&mut state, bodies, [Culling::FacesOfCollision; 2]);
        let views = state.results.near_pairs[0].views;
        assert_eq!(
            views[0],
            View::Group(table.directions()[index as usize]),
            "direction {index}"
        );
        // The question asked from outside the step has the same answer.
        let pose = Transform {
            translation: -(rotation * (scale * mesh.mass.center)),
            rotation,
            scale,
        };
        let lit = mesh.faces_towards(&pose, offset).expect("a table and a direction");
        assert!(lit == table.of_direction(index), "direction {index}");
        let back = Angles::of(-offset);
        let steps = [back.a, back.b].map(|angle| (angle.to_degrees() / 10.0).round() as i32);
        let [a, b] = steps.map(|step| step.rem_euclid(36) as u32);
        assert_eq!(views[1], View::Group(table.directions()[grid.index_at(a, b) as usize]));
    }
}

#[test]
fn without_table_or_direction_nothing_is_known_of_what_is_seen() {
    let mesh = baked(&shapes::torus_240(), 30, 32);
    let pose = Transform::from_xyz(1.0, 2.0, 3.0);
    let center = pose.transform_point(mesh.mass.center);
    assert!(mesh.faces_towards(&pose, center + Vec3::X).is_some());
    assert!(mesh.faces_towards(&pose, center).is_none());
    assert!(mesh.faces_towards(&pose, Vec3::NAN).is_none());
    let bare = CollisionMesh::new(&shapes::torus_240());
    assert!(bare.faces_towards(&pose, center + Vec3::X).is_none());
}

#[test]
fn lane_masks_are_the_group_in_both_forms() {
    for mesh in [shapes::torus_240(), boxed_ball()] {
        let baked = baked(&mesh, 15, 32);
        let table = baked.faces.as_ref().unwrap();
        let mut scratch = vec![0xff; 3];
        for id in 0..table.distinct_len() as u32 {
            let group = table.distinct(id);
            let masks = group.lane_masks(&mut scratch);
            assert_eq!(masks.len(), mesh.triangles().len().div_ceil(8));
            let set = (0..masks.len() as u32 * 8).filter(|t| masks[*t as usize / 8] >> (t % 8) & 1 == 1);
            assert!(set.eq(group.iter()));
        }
    }
}

#[test]
fn coinciding_centres_are_exact() {
    let mesh = baked(&shapes::torus_240(), 10, 32);
    let mut state = StepState::default();
    let slot = state.input.meshes.add(mesh.clone());
    for angle in [0.3, 0.8, 1.5] {
        let bodies = [Quat::IDENTITY, Quat::from_rotation_x(angle)]
            .map(|rotation| Body::at_rest(slot, Vec3::ONE - rotation * mesh.mass.center, rotation, Vec3::ONE));
        let [exact, faces, front] = MODES.map(|mode| collide(&mut state, bodies, [mode; 2]));
        assert!(!exact.is_empty());
        assert_eq!((&exact, &exact), (&faces, &front));
    }
}

#[test]
fn meshes_without_a_table_or_an_outside_are_exact() {
    let half = |mesh: &TriMesh| TriMesh::new(mesh.vertices().to_vec(), mesh.triangles()[..120].to_vec()).unwrap();
    let torus = shapes::torus_240();
    let run = |mesh: &TriMesh, culling| -> Vec<TouchingPair> {
        let mesh = CollisionMesh::new(mesh);
        let placements = [(0.0, 0.0), (0.35, 1.2), (0.2, 0.5)].map(|(x, angle)| Placement {
            mesh: mesh.clone(),
            translation: Vec3::new(x, x * x, 0.1 * angle),
            rotation: Quat::from_rotation_x(angle),
            scale: Vec3::ONE,
        });
        check_with(&placements, &CheckOptions { culling }).unwrap()
    };
    for (mesh, culling) in [
        (torus.clone(), Culling::FacesOfCollision),
        (half(&torus), Culling::FrontFacing),
    ] {
        let exact = run(&mesh, Culling::Exact);
        assert!(!exact.is_empty());
        assert_eq!(run(&mesh, culling), exact);
    }
}
