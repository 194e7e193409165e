//! avian3d, with its own contacts and with those of avian_faceoff: whole steps of a headless app.

use crate::engine::{Contacts, Engine, THREADS};
use crate::scene::{STEP, Scene};
use crate::timing::time;
use avian_faceoff::prelude::*;
use avian3d::prelude::*;
use bevy::app::{TaskPoolOptions, TaskPoolPlugin};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use std::collections::HashMap;

/// An app without bodies, with default settings but for the length of a step.
pub fn app(contacts: Contacts) -> App {
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
    ));
    match contacts {
        Contacts::Own => app.add_plugins(PhysicsPlugins::default()),
        Contacts::Exact => app.add_plugins(PhysicsPlugins::default().with_exact_meshes()),
    };
    app.insert_resource(Time::<Fixed>::from_duration(STEP))
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    app
}

/// Makes an app ready for its first step.
pub fn begin(app: &mut App) {
    app.finish();
    app.cleanup();
    // In Bevy's first update no time has passed, so it runs no step.
    app.update();
}

/// The scene in avian with default settings, except those of the scene: no gravity, no friction, elastic bodies that
/// never sleep, and the same step length.
pub struct Avian {
    app: App,
    indices: HashMap<Entity, u32>,
}

impl Avian {
    /// An app that is ready for its first step.
    pub fn new(scene: &Scene, contacts: Contacts) -> Self {
        let mut app = app(contacts);
        app.insert_resource(Gravity(Vec3::ZERO))
            .insert_resource(DefaultFriction(Friction::ZERO))
            .insert_resource(DefaultRestitution(Restitution::new(scene.restitution)));
        for (center, size) in scene.walls() {
            let wall = Collider::cuboid(2.0 * size.x, 2.0 * size.y, 2.0 * size.z);
            app.world_mut()
                .spawn((RigidBody::Static, wall, Transform::from_translation(center)));
        }
        let mesh = match contacts {
            Contacts::Own => None,
            Contacts::Exact => {
                let mut meshes = app.world_mut().resource_mut::<Assets<CollisionMesh>>();
                Some(meshes.add(scene.mesh.clone()))
            }
        };
        let mut indices = HashMap::new();
        for (body, index) in scene.bodies.iter().zip(0..) {
            let mut entity = app.world_mut().spawn((
                RigidBody::Dynamic,
                body.pose,
                LinearVelocity(body.velocity),
                SleepingDisabled,
            ));
            match &mesh {
                Some(mesh) => entity.insert(ExactCollider(mesh.clone())),
                None => {
                    let (vertices, triangles) = scene.scaled_mesh(body);
                    let collider = Collider::trimesh(vertices.collect(), triangles);
                    entity.insert((collider, body.pose.with_scale(Vec3::ONE)))
                }
            };
            indices.insert(entity.id(), index);
        }
        begin(&mut app);
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

    fn kinetic_energy(&mut self) -> Option<f64> {
        let mut bodies = self.app.world_mut().query_filtered::<(
            &LinearVelocity,
            &AngularVelocity,
            &Rotation,
            &ComputedMass,
            &ComputedAngularInertia,
        ), With<SleepingDisabled>>();
        let energy = |(v, w, rotation, mass, inertia): (
            &LinearVelocity,
            &AngularVelocity,
            &Rotation,
            &ComputedMass,
            &ComputedAngularInertia,
        )| {
            let spin = inertia.rotated(rotation.0).tensor() * w.0;
            0.5 * (f64::from(mass.value() * v.length_squared()) + f64::from(w.dot(spin)))
        };
        Some(bodies.iter(self.app.world()).map(energy).sum())
    }
}
