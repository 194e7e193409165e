//! Headless apps with Avian.

use avian_faceoff::prelude::*;
use avian3d::math::{AdjustPrecision, AsF32, Scalar};
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::testing::scenes::{Body, Scene, Shape};
use std::collections::HashMap;
use std::time::Duration;

/// Steps per second.
pub const HZ: usize = 64;

/// Who makes contacts between meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contacts {
    Avian,
    Exact,
}

/// An app, its bodies, and the meshes that it has.
pub struct World {
    pub app: App,
    pub bodies: Vec<Entity>,
    made: HashMap<Shape, Handle<CollisionMesh>>,
    contacts: Contacts,
}

impl World {
    /// An app without bodies, in the Earth's gravity.
    pub fn new(contacts: Contacts) -> Self {
        match contacts {
            Contacts::Avian => Self::with(contacts, PhysicsPlugins::default().build()),
            Contacts::Exact => Self::with(contacts, PhysicsPlugins::default().with_exact_meshes()),
        }
    }

    /// An app with these plugins of Avian.
    pub fn with(contacts: Contacts, plugins: impl PluginGroup) -> Self {
        let mut app = App::new();
        let step = Duration::from_secs(1) / HZ as u32;
        app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default()))
            .add_plugins(plugins)
            .insert_resource(Time::<Fixed>::from_duration(step))
            .insert_resource(TimeUpdateStrategy::ManualDuration(step));
        Self {
            app,
            bodies: Vec::new(),
            made: HashMap::new(),
            contacts,
        }
    }

    /// An app with the bodies of a scene, ready for its first step.
    pub fn of(contacts: Contacts, scene: &Scene) -> Self {
        let mut world = Self::new(contacts);
        world.fill(scene);
        world.begin();
        world
    }

    /// Adds the bodies of a scene. They never sleep.
    pub fn fill(&mut self, scene: &Scene) {
        self.app.insert_resource(Gravity(scene.gravity.adjust_precision()));
        for body in &scene.bodies {
            self.add(body);
        }
    }

    /// Adds a body. It never sleeps.
    pub fn add(&mut self, body: &Body) -> Entity {
        self.add_with(body, ())
    }

    /// Adds a body with more components: Avian heeds some of them only where the collider comes later or with them.
    pub fn add_with(&mut self, body: &Body, more: impl Bundle) -> Entity {
        let entity = self.app.world_mut().spawn((
            if body.fixed {
                RigidBody::Static
            } else {
                RigidBody::Dynamic
            },
            Transform {
                translation: body.position,
                rotation: body.rotation,
                scale: body.scale,
            },
            LinearVelocity(body.velocity.adjust_precision()),
            AngularVelocity(body.spin.adjust_precision()),
            Friction::new(body.friction.coefficient.adjust_precision()),
            Restitution::new(body.restitution.adjust_precision()),
            SleepingDisabled,
            more,
        ));
        let entity = entity.id();
        self.shape(entity, body.shape);
        self.bodies.push(entity);
        entity
    }

    /// Gives an entity a collider.
    pub fn shape(&mut self, entity: Entity, shape: Shape) {
        let world = self.app.world_mut();
        if self.contacts == Contacts::Avian {
            let mesh = &shape.mesh().mesh;
            let vertices = mesh.vertices().iter().map(|v| v.adjust_precision()).collect();
            let collider = Collider::trimesh(vertices, mesh.triangles().to_vec());
            world.entity_mut(entity).insert(collider);
            return;
        }
        let mut meshes = world.resource_mut::<Assets<CollisionMesh>>();
        let mesh = self
            .made
            .entry(shape)
            .or_insert_with(|| meshes.add(shape.mesh().clone()));
        let mesh = ExactCollider(mesh.clone());
        world.entity_mut(entity).insert(mesh);
    }

    /// Ends the set-up. Bevy's first update has no time behind it and runs no step.
    pub fn begin(&mut self) {
        self.app.finish();
        self.app.cleanup();
        self.app.update();
    }

    pub fn step(&mut self) {
        self.app.update();
    }

    pub fn steps(&mut self, count: usize) {
        for _ in 0..count {
            self.step();
        }
    }

    fn get<C: Component>(&self, entity: Entity) -> &C {
        self.app.world().get(entity).expect("a body of Avian")
    }

    /// Origin of a body, metres.
    pub fn position(&self, entity: Entity) -> Vec3 {
        self.get::<Position>(entity).f32()
    }

    pub fn rotation(&self, entity: Entity) -> Quat {
        self.get::<Rotation>(entity).f32()
    }

    pub fn velocity(&self, entity: Entity) -> Vec3 {
        self.get::<LinearVelocity>(entity).f32()
    }

    /// Kinetic energy of all bodies, J, rotation included.
    pub fn kinetic_energy(&self) -> f64 {
        let energy = |&entity: &Entity| {
            let [v, w] = [self.velocity(entity), self.get::<AngularVelocity>(entity).f32()].map(|v| v.as_dvec3());
            let mass = double(self.get::<ComputedMass>(entity).value());
            let inertia = self.get::<ComputedAngularInertia>(entity);
            let inertia = inertia.rotated(self.get::<Rotation>(entity).0).tensor();
            let spin = (inertia * w.as_vec3().adjust_precision()).f32().as_dvec3();
            0.5 * (mass * v.length_squared() + w.dot(spin))
        };
        self.bodies.iter().map(energy).filter(|e| e.is_finite()).sum()
    }

    /// The points of all pairs that touch.
    pub fn points(&self) -> Vec<ContactPoint> {
        let graph = self.app.world().resource::<ContactGraph>();
        let manifolds = graph.iter_active_touching().flat_map(|pair| &pair.manifolds);
        manifolds.flat_map(|manifold| manifold.points.iter().copied()).collect()
    }

    /// How deep the deepest point lies, metres.
    pub fn deepest(&self) -> f64 {
        let depth = |point: &ContactPoint| double(point.penetration);
        self.points().iter().map(depth).fold(0.0, f64::max)
    }
}

/// A number of Avian.
#[allow(clippy::useless_conversion, reason = "it depends on the feature `f64`")]
pub fn double(x: Scalar) -> f64 {
    f64::from(x)
}
