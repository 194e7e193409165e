//! Which triangles of a body are in the view of another.

use super::{MODES, baked, boxed_ball, collide};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::direction::{Angles, DirectionGrid};
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::queries::{CheckOptions, Placement, TouchingPair, check_with};
use bevy_faceoff::state::{Body, View};
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::settings::Culling;
use glam::{Quat, Vec3};

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
        // M d, so that the lookup must invert both scale and rotation.
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
        let back = Angles::of(-offset);
        let steps = [back.a, back.b].map(|angle| (angle.to_degrees() / 10.0).round() as i32);
        let [a, b] = steps.map(|step| step.rem_euclid(36) as u32);
        assert_eq!(views[1], View::Group(table.directions()[grid.index_at(a, b) as usize]));
    }
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
