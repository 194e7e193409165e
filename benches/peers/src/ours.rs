//! bevy_faceoff: the narrow phase alone, as in `benches/narrow_phase`, and a whole headless app.

use crate::engine::{Engine, THREADS};
use crate::scene::{STEP, Scene};
use crate::timing::time;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::prelude::*;
use bevy_faceoff::state::mesh_arena::MeshArena;
use bevy_faceoff::state::{Bodies, Body};
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::stage::Stage;
use std::collections::HashMap;

/// The bodies of `scene` with its mesh after this number of steps in which nothing stops them, at rest.
pub fn at_rest(scene: &Scene, steps: usize, mesh: u32, meshes: &MeshArena) -> Bodies {
    let mut bodies = Bodies::default();
    for body in &scene.bodies {
        let Transform {
            translation,
            rotation,
            scale,
        } = body.pose_after(steps);
        let body = Body::at_rest(mesh, translation, rotation, scale);
        bodies.push(&body, meshes).expect("a usable body");
    }
    bodies
}

/// The stages without an app.
pub struct Stages {
    state: StepState,
}

impl Stages {
    /// Adds the bodies of `scene`.
    pub fn new(scene: &Scene) -> Self {
        let mut state = StepState::default();
        let mesh = state.input.meshes.add(scene.mesh.clone());
        state.input.bodies = at_rest(scene, 0, mesh, &state.input.meshes);
        Self { state }
    }

    /// Finds the pairs whose bounding spheres overlap.
    pub fn broad_phase(&mut self) {
        bevy_faceoff::step::cpu::run(Stage::BroadPhase, &mut self.state);
    }

    /// The pairs found by [`Self::broad_phase`].
    pub fn sphere_pairs(&self) -> &[[u32; 2]] {
        &self.state.results.sphere_pairs
    }

    /// Finds all intersecting faces of those pairs, with their segments, and the contacts.
    pub fn narrow_phase(&mut self) {
        bevy_faceoff::step::cpu::run(Stage::Angles, &mut self.state);
        bevy_faceoff::step::cpu::run(Stage::TriangleTest, &mut self.state);
    }

    /// Finds which of those pairs touch, including those of which one body is inside the other.
    pub fn first_hits(&mut self) -> Vec<[u32; 2]> {
        bevy_faceoff::step::cpu::run(Stage::Angles, &mut self.state);
        bevy_faceoff::step::cpu::touching(&mut self.state)
    }

    /// The pairs found by [`Self::narrow_phase`].
    pub fn all_touching(&self) -> Vec<[u32; 2]> {
        self.state.results.contacts.pairs.iter().map(|p| p.bodies).collect()
    }

    /// The pairs whose surfaces intersect.
    pub fn touching(&self) -> Vec<[u32; 2]> {
        let pairs = self.state.results.contacts.pairs.iter();
        pairs.filter(|p| p.face_count > 0).map(|p| p.bodies).collect()
    }

    /// The number of pairs of which one body is wholly inside the other.
    pub fn contained(&self) -> usize {
        self.state
            .results
            .contacts
            .pairs
            .iter()
            .filter(|p| p.face_count == 0)
            .count()
    }

    /// The number of face pairs that intersect.
    pub fn face_pairs(&self) -> usize {
        self.state.results.contacts.faces.len()
    }
}

/// The app of `faceoff simulate`.
pub struct Faceoff {
    app: App,
    indices: HashMap<Entity, u32>,
}

impl Faceoff {
    /// An app that is ready for its first step.
    pub fn new(scene: &Scene, response: Response) -> Self {
        let mut app = App::new();
        app.add_plugins((
            MinimalPlugins,
            FaceoffHeadlessPlugins {
                step: StepPlugin {
                    threads: THREADS,
                    ..default()
                },
                ..default()
            },
        ))
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP))
        .insert_resource(Gravity(Vec3::ZERO))
        .insert_resource(response);
        let mesh = app
            .world_mut()
            .resource_mut::<Assets<CollisionMesh>>()
            .add(scene.mesh.clone());
        for (point, normal) in scene.paper.walls() {
            app.world_mut().spawn((
                PlaneCollider::through(point, normal),
                Restitution::new(scene.restitution),
            ));
        }
        for body in &scene.bodies {
            app.world_mut().spawn((
                RigidBody::Dynamic,
                MeshCollider(mesh.clone()),
                body.pose,
                LinearVelocity(body.velocity),
                Restitution::new(scene.restitution),
            ));
        }
        app.finish();
        app.cleanup();
        // In Bevy's first update no time has passed, so it runs no step.
        app.update();
        let indices = app
            .world_mut()
            .query_filtered::<Entity, With<MeshCollider>>()
            .iter(app.world())
            .zip(0..)
            .collect();
        Self { app, indices }
    }
}

impl Engine for Faceoff {
    fn step(&mut self) -> f64 {
        time(|| self.app.update()).0
    }

    fn touching(&mut self) -> Vec<[u32; 2]> {
        // The walls are planes and have no index.
        let index = |entity| self.indices.get(&entity).copied();
        let collisions = self.app.world().resource::<Collisions>();
        collisions
            .iter()
            .filter_map(|c| Some([index(c.collider1)?, index(c.collider2)?]))
            .collect()
    }
}
