//! Recall of the face table: which of the intersecting pairs of faces the culling modes find.

use super::{MODES, baked, boxed_ball, collide, inside_out, random_pose};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{Orientation, shapes};
use bevy_faceoff::queries::{CheckOptions, Placement, check, check_with};
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::settings::Culling;
use glam::{DMat3, DVec3, Vec3};

/// Which input faces of a body are visible from `other`, computed in double precision from the definition; `None` where
/// rounding decides.
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
                // A body inside a room sees every wall.
                Culling::FrontFacing if mesh.mesh.orientation() == Orientation::Inward => Some(true),
                Culling::FrontFacing => {
                    let [p, q, r] = mesh.mesh.corners(t).map(|p| p.as_dvec3());
                    let normal = (q - p).cross(r - p);
                    let outward = match mesh.mesh.orientation() {
                        Orientation::Outward => normal,
                        _ => panic!("no outside"),
                    };
                    // Normals transform with the inverse transpose.
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
        // Convex bodies that approach along the line of centres touch at some distance.
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
