//! The support-axis cull: rejected pairs do not touch, and the bounds along the axis hold for every vertex.

use super::random_pose;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::queries::{Placement, check};
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::stage::Stage;
use glam::{Mat3, Vec3};

#[test]
fn pairs_that_a_support_plane_separates_do_not_touch_and_the_others_know_their_overlap() {
    let meshes = [shapes::torus_240(), shapes::knot_1120()].map(|mesh| CollisionMesh::new(&mesh));
    let mut state = StepState::default();
    let slots = meshes.each_ref().map(|mesh| state.input.meshes.add(mesh.clone()));
    let mut random = fastrand::Rng::with_seed(31);
    let (mut rejected, mut missed) = (0, 0);
    for case in 0..1000 {
        let kinds = [random.usize(..2), random.usize(..2)];
        let bodies = kinds.map(|kind| {
            let (position, rotation) = random_pose(&mut random, 0.4);
            let scale = Vec3::from_array([0; 3].map(|_| 0.3 + random.f32()));
            Body::at_rest(slots[kind], position, rotation, scale)
        });
        state.input.bodies.clear();
        for body in &bodies {
            state.input.bodies.push(body, &state.input.meshes).unwrap();
        }
        for stage in [Stage::BroadPhase, Stage::Angles] {
            bevy_faceoff::step::cpu::run(stage, &mut state);
        }
        if state.results.sphere_pairs.is_empty() {
            continue;
        }
        let placements = [0, 1].map(|i| Placement {
            mesh: meshes[kinds[i]].clone(),
            translation: bodies[i].position,
            rotation: bodies[i].rotation,
            scale: bodies[i].scale,
        });
        let touch = !check(&placements).unwrap().is_empty();
        let Some(near) = state.results.near_pairs.first() else {
            assert!(!touch, "case {case}: a pair that touches was rejected");
            rejected += 1;
            continue;
        };
        missed += usize::from(!touch);
        // Heights along the axis, from a's centre and in its axes.
        let heights = |i: usize| {
            let Placement {
                mesh,
                translation,
                rotation,
                scale,
            } = &placements[i];
            let axes = Mat3::from_quat(bodies[0].rotation).transpose();
            let center = state.input.bodies.frame[0].center.as_vec3();
            let vertices = mesh.mesh.vertices().iter();
            vertices.map(move |&v| near.axis.dot(axes * (*rotation * (*scale * v) + *translation - center)))
        };
        assert!((near.axis.length() - 1.0).abs() < 1.0e-5, "case {case}");
        assert!(heights(0).all(|h| h <= near.a_below + 1.0e-5), "case {case}");
        assert!(heights(1).all(|h| h >= near.b_above - 1.0e-5), "case {case}");
    }
    println!("{rejected} of the pairs that do not touch were rejected, {missed} were not");
    assert!(rejected > 100 && rejected > missed, "{rejected} {missed}");
}
