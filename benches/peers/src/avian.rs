//! avian3d: whole steps of a headless app.

use crate::engine::{Engine, THREADS};
use crate::scene::{STEP, Scene};
use crate::timing::time;
use avian3d::prelude::*;
use bevy::app::{TaskPoolOptions, TaskPoolPlugin};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use std::collections::HashMap;

/// The scene in avian with default settings, except those of the scene: no gravity, no friction, elastic bodies that
/// never sleep, and the same step length.
pub struct Avian {
    app: App,
    indices: HashMap<Entity, u32>,
}

impl Avian {
    /// An app that is ready for its first step.
    pub fn new(scene: &Scene) -> Self {
        let mut app = App::new();
        let mut threads = TaskPoolOptions::with_num_threads(THREADS);
        // The thread that calls `update` works too, but with a single thread in its pool, avian's loops are serial.
        threads.compute.min_threads = THREADS;
        threads.compute.max_threads = THREADS;
        app.add_plugins((
            MinimalPlugins.set(TaskPoolPlugin {
                task_pool_options: threads,
            }),
            TransformPlugin,
            AssetPlugin::default(),
            PhysicsPlugins::default(),
        ))
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP))
        .insert_resource(Gravity(Vec3::ZERO))
        .insert_resource(DefaultFriction(Friction::ZERO))
        .insert_resource(DefaultRestitution(Restitution::PERFECTLY_ELASTIC));
        for (center, size) in scene.walls() {
            let wall = Collider::cuboid(2.0 * size.x, 2.0 * size.y, 2.0 * size.z);
            app.world_mut()
                .spawn((RigidBody::Static, wall, Transform::from_translation(center)));
        }
        let mut indices = HashMap::new();
        for (body, index) in scene.bodies.iter().zip(0..) {
            let (vertices, triangles) = scene.scaled_mesh(body);
            let entity = app.world_mut().spawn((
                RigidBody::Dynamic,
                Collider::trimesh(vertices.collect(), triangles),
                body.pose.with_scale(Vec3::ONE),
                LinearVelocity(body.velocity),
                SleepingDisabled,
            ));
            indices.insert(entity.id(), index);
        }
        app.finish();
        app.cleanup();
        // In Bevy's first update no time has passed, so it runs no step.
        app.update();
        Self { app, indices }
    }
}

impl Engine for Avian {
    fn step(&mut self) -> f64 {
        time(|| self.app.update()).0
    }

    fn touching(&mut self) -> Vec<[u32; 2]> {
        let graph = self.app.world().resource::<ContactGraph>();
        graph
            .iter_active_touching()
            .filter_map(|pair| Some([*self.indices.get(&pair.collider1)?, *self.indices.get(&pair.collider2)?]))
            .collect()
    }
}
