//! View directions between bodies, and the faces that are culled by them.

mod recall;
mod support_axis;
mod views;

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::projection::{BakeSettings, Progress, bake_pool};
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::settings::Culling;
use bevy_faceoff::types::stage::Stage;
use glam::{Quat, Vec3};
use std::collections::BTreeSet;

pub const MODES: [Culling; 3] = [Culling::Exact, Culling::FacesOfCollision, Culling::FrontFacing];

pub fn baked(mesh: &TriMesh, degrees: u32, image: u32) -> CollisionMesh {
    let settings = BakeSettings {
        faces: true,
        degrees,
        image,
        ..BakeSettings::default()
    };
    CollisionMesh::bake(mesh, settings, bake_pool(), &Progress::default()).expect("nobody cancels")
}

pub fn inside_out(mesh: &TriMesh) -> TriMesh {
    let faces = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    TriMesh::new(mesh.vertices().to_vec(), faces).unwrap()
}

/// Most triangles are invisible from everywhere, so groups are stored as lists.
pub fn boxed_ball() -> TriMesh {
    let (cube, ball) = (shapes::cube(1.0), shapes::ball(0.3, 3));
    let first = cube.vertices().len() as u32;
    let vertices = cube.vertices().iter().chain(ball.vertices()).copied().collect();
    let moved = ball.triangles().iter().map(|t| t.map(|v| v + first));
    TriMesh::new(vertices, cube.triangles().iter().copied().chain(moved).collect()).unwrap()
}

pub fn random_pose(random: &mut fastrand::Rng, size: f32) -> (Vec3, Quat) {
    let mut vector = |size: f32| Vec3::from_array([0; 3].map(|_| size * (2.0 * random.f32() - 1.0)));
    (vector(size), Quat::from_scaled_axis(vector(3.0)))
}

/// Runs the three detection stages on one pair.
pub fn collide(state: &mut StepState, bodies: [Body; 2], culling: [Culling; 2]) -> BTreeSet<[u32; 2]> {
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
