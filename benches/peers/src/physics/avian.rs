//! avian3d, by default settings but for sleep and the length of a step, with its own contacts or those of
//! avian_faceoff.

use super::mass::Mass as BodyMass;
use super::world::{State, World};
use crate::avian::{app, begin};
use crate::engine::Contacts;
use avian_faceoff::prelude::*;
use avian3d::prelude::*;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_faceoff::testing::scenes::{Scene, Shape};
use std::collections::HashMap;

/// The scene in avian.
pub struct Avian {
    app: App,
    /// Each with its centre of mass from its origin, in its own axes.
    bodies: Vec<(Entity, DVec3)>,
}

impl Avian {
    /// An app that is ready for its first step.
    pub fn new(scene: &Scene, contacts: Contacts) -> Self {
        let mut app = app(contacts);
        app.insert_resource(Gravity(scene.gravity));
        // Bodies of one shape share their data, as a game's do.
        let mut colliders: HashMap<Shape, Collider> = HashMap::new();
        let mut meshes: HashMap<Shape, Handle<CollisionMesh>> = HashMap::new();
        let mut bodies = Vec::new();
        for body in &scene.bodies {
            let mass = BodyMass::of(body);
            let kind = if body.fixed {
                RigidBody::Static
            } else {
                RigidBody::Dynamic
            };
            let pose = Transform {
                translation: body.position,
                rotation: body.rotation,
                scale: body.scale,
            };
            let mut entity = app.world_mut().spawn((
                (kind, pose, LinearVelocity(body.velocity), AngularVelocity(body.spin)),
                (
                    Friction::new(body.friction.coefficient),
                    Restitution::new(body.restitution),
                ),
                SleepingDisabled,
            ));
            if !body.fixed {
                entity.insert((
                    Mass(mass.mass as f32),
                    AngularInertia::try_from_mat3(mass.inertia.as_mat3()).expect("symmetric"),
                    CenterOfMass(mass.center.as_vec3()),
                    (NoAutoMass, NoAutoAngularInertia, NoAutoCenterOfMass),
                ));
            }
            let id = entity.id();
            match contacts {
                Contacts::Own => {
                    let collider = colliders.entry(body.shape).or_insert_with(|| {
                        let mesh = &body.shape.mesh().mesh;
                        let (vertices, triangles) = (mesh.vertices().to_vec(), mesh.triangles().to_vec());
                        // Without the flag cubes do not slide at all.
                        Collider::trimesh_with_config(vertices, triangles, TrimeshFlags::FIX_INTERNAL_EDGES)
                    });
                    entity.insert(collider.clone());
                }
                Contacts::Exact => {
                    let mut assets = app.world_mut().resource_mut::<Assets<CollisionMesh>>();
                    let mesh = meshes
                        .entry(body.shape)
                        .or_insert_with(|| assets.add(body.shape.mesh().clone()))
                        .clone();
                    app.world_mut().entity_mut(id).insert(ExactCollider(mesh));
                }
            }
            bodies.push((id, mass.center));
        }
        begin(&mut app);
        Self { app, bodies }
    }
}

impl World for Avian {
    fn step(&mut self) {
        self.app.update();
    }

    fn states(&self) -> Vec<State> {
        let states = self.bodies.iter().map(|&(entity, center)| {
            let body = self.app.world().entity(entity);
            let rotation = body.get::<Rotation>().expect("a body").0.as_dquat().normalize();
            let vector = |v: Option<Vec3>| v.map_or(DVec3::ZERO, |v| v.as_dvec3());
            State {
                center: vector(body.get::<Position>().map(|at| at.0)) + rotation * center,
                rotation,
                velocity: vector(body.get::<LinearVelocity>().map(|v| v.0)),
                spin: vector(body.get::<AngularVelocity>().map(|v| v.0)),
            }
        });
        states.collect()
    }
}
