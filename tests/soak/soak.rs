//! A world under random changes, checked after every step: what a long session of a busy game does to the plugin.
//!
//! Bodies appear and vanish, jump, change their shape, kind, parent and settings, and get values that are no numbers.
//! The clock pauses, snapshots are taken and restored, and a device is lost now and then.

use super::checks::{Checks, Report};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use fastrand::Rng;
use std::time::{Duration, Instant};

const STEP: Duration = Duration::from_nanos(15_625_000);

/// How to run.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    pub backend: Backend,
    pub readback: Readback,
    pub threads: usize,
    pub bodies: usize,
    /// Half the width of the bin, relative to the square root of the number of bodies. With 0.6 they lie on each other
    /// in piles of two or three, with 1.5 mostly side by side.
    pub room: f32,
    pub steps: usize,
    pub seed: u64,
    /// One random change every so many steps, on average.
    pub steps_per_change: usize,
    /// The bytes that the process has allocated and not freed, if memory is to be checked.
    pub live_bytes: Option<fn() -> usize>,
}

/// More steps than scratch memory lives.
const RENEWAL: usize = 4200;

/// Runs a world of many bodies in a bin.
///
/// # Panics
/// If anything is wrong after a step: see [`Checks`].
pub fn run(plan: Plan) -> Report {
    let mut soak = Soak::new(plan);
    let mut checks = Checks::new(plan.readback, plan.steps);
    let (mut busy, mut empty) = (0, 0);
    for number in 0..plan.steps {
        if let Some(live_bytes) = plan.live_bytes
            && number == plan.steps / 2
        {
            busy = live_bytes();
            soak.rest(&mut checks, RENEWAL);
            empty = live_bytes();
        }
        let change = match soak.random.usize(..plan.steps_per_change) {
            0 => soak.change(),
            _ => Change::Usual,
        };
        match change {
            Change::Taken => checks.take(),
            Change::Restored => checks.restore(),
            Change::Usual | Change::Slow => {}
        }
        let start = Instant::now();
        soak.app.update();
        let time = start.elapsed();
        checks.step(
            soak.app.world_mut(),
            number,
            time,
            change == Change::Slow,
            &soak.spoiled,
        );
        soak.keep_going();
        if number % 1024 == 1023 {
            println!("step {} of {}: {}", number + 1, plan.steps, checks.so_far());
        }
    }
    soak.rest(&mut checks, if plan.live_bytes.is_some() { RENEWAL } else { 100 });
    let growth = |live_bytes: fn() -> usize| (live_bytes() as f32 - empty as f32) / busy as f32;
    Report {
        growth: plan.live_bytes.map(growth),
        ..checks.finish()
    }
}

/// What a random change means for the checks.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Change {
    Usual,
    /// The step may take long: a device is opened, or steps move to the CPU or back.
    Slow,
    /// A snapshot was taken.
    Taken,
    /// It was restored.
    Restored,
}

struct Soak {
    app: App,
    random: Rng,
    meshes: Vec<MeshCollider>,
    /// Bodies that random changes may meet.
    bodies: Vec<Entity>,
    wanted: usize,
    /// Half the width of the bin.
    half_width: f32,
    /// Bodies that got a place that is no number.
    spoiled: Vec<Entity>,
    snapshot: Option<Snapshot>,
    /// Steps until the settings are the usual ones again.
    unusual: usize,
}

impl Soak {
    fn new(plan: Plan) -> Self {
        let mut app = App::new();
        let step = StepPlugin {
            backend: plan.backend,
            threads: plan.threads,
            readback: plan.readback,
            ..default()
        };
        app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins { step, ..default() }))
            .insert_resource(Time::<Fixed>::from_duration(STEP))
            .insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
        app.finish();
        app.cleanup();
        app.update();
        while *app.world().resource::<ActiveBackend>() == ActiveBackend::Opening {
            std::thread::sleep(STEP);
            app.update();
        }
        let mut assets = app.world_mut().resource_mut::<Assets<CollisionMesh>>();
        let meshes = [
            shapes::cube(0.5),
            shapes::torus_240(),
            shapes::ball(0.4, 2),
            shapes::knot_1120(),
        ]
        .map(|mesh| MeshCollider(assets.add(CollisionMesh::new(&mesh))))
        .to_vec();
        let mut soak = Self {
            app,
            random: Rng::with_seed(plan.seed),
            meshes,
            bodies: Vec::new(),
            wanted: plan.bodies,
            half_width: plan.room * (plan.bodies as f32).sqrt() + 1.0,
            spoiled: Vec::new(),
            snapshot: None,
            unusual: 0,
        };
        soak.build_bin();
        for _ in 0..plan.bodies {
            soak.spawn();
        }
        soak
    }

    /// A floor, and four walls around the bodies.
    fn build_bin(&mut self) {
        let half = self.half_width;
        let world = self.app.world_mut();
        world.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
        for normal in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
            world.spawn(PlaneCollider::through(-half * normal, normal));
        }
    }

    fn place(&mut self) -> Vec3 {
        let half = self.half_width - 1.0;
        let mut along = || half * (2.0 * self.random.f32() - 1.0);
        let (x, z) = (along(), along());
        Vec3::new(x, 1.0 + 4.0 * self.random.f32(), z)
    }

    fn rotation(&mut self) -> Quat {
        let mut x = || self.random.f32() - 0.5;
        Quat::from_xyzw(x(), x(), x(), x() + 0.6).normalize()
    }

    fn mesh(&mut self) -> MeshCollider {
        let at = self.random.usize(..self.meshes.len());
        self.meshes[at].clone()
    }

    fn spawn(&mut self) {
        let place = Transform {
            translation: self.place(),
            rotation: self.rotation(),
            scale: Vec3::splat(0.6 + 0.6 * self.random.f32()),
        };
        let kind = match self.random.u8(..20) {
            0 => RigidBody::Static,
            1 => RigidBody::Kinematic,
            _ => RigidBody::Dynamic,
        };
        let mesh = self.mesh();
        let several = self.random.u8(..10) == 0;
        let sensor = self.random.u8(..20) == 0;
        let mut body = self.app.world_mut().spawn((kind, place));
        if several {
            body.with_children(|body| {
                for side in [-0.4, 0.4] {
                    body.spawn((mesh.clone(), Transform::from_xyz(side, 0.0, 0.0)));
                }
            });
        } else {
            body.insert(mesh);
        }
        if sensor {
            body.insert(Sensor);
        }
        if kind == RigidBody::Kinematic {
            body.insert(AngularVelocity(Vec3::Y));
        }
        let entity = body.id();
        self.bodies.push(entity);
    }

    fn any_body(&mut self) -> Option<Entity> {
        let bodies = &self.bodies;
        (!bodies.is_empty()).then(|| bodies[self.random.usize(..bodies.len())])
    }

    /// Makes a random change.
    fn change(&mut self) -> Change {
        let Some(body) = self.any_body() else {
            self.spawn();
            return Change::Usual;
        };
        let (place, rotation, mesh) = (self.place(), self.rotation(), self.mesh());
        let other = self.any_body().filter(|&other| other != body);
        let kind = self.random.u8(..25);
        let world = self.app.world_mut();
        match kind {
            0..4 => {
                // With its children.
                world.despawn(body);
                self.spawn();
            }
            4..7 => {
                let mut body = world.entity_mut(body);
                body.insert((Transform::from_translation(place).with_rotation(rotation), Teleport));
                body.insert(LinearVelocity(Vec3::ZERO));
            }
            7..9 => {
                let scale = world.get::<Transform>(body).map_or(Vec3::ONE, |pose| pose.scale);
                let pose = Transform::from_translation(place).with_scale(scale);
                world.entity_mut(body).insert((mesh, pose));
            }
            9 => {
                world.entity_mut(body).insert(RigidBody::Static);
            }
            10 => {
                world.entity_mut(body).insert(RigidBody::Dynamic);
            }
            11 => {
                world
                    .entity_mut(body)
                    .insert(LinearVelocity(10.0 * rotation.mul_vec3(Vec3::X)));
            }
            12 => {
                world.entity_mut(body).insert(LinearVelocity(Vec3::NAN));
            }
            13 => {
                let mut pose = Transform::from_translation(place);
                pose.translation.x = f32::INFINITY;
                world.entity_mut(body).insert(pose);
                self.spoiled.push(body);
            }
            14 => {
                world.entity_mut(body).insert(ColliderDisabled);
            }
            15 => {
                world.entity_mut(body).insert(RigidBodyDisabled);
            }
            16 => {
                let mut body = world.entity_mut(body);
                body.remove::<(ColliderDisabled, RigidBodyDisabled)>();
            }
            17 => {
                if let Some(other) = other.filter(|&other| !is_above(world, body, other)) {
                    world.entity_mut(body).insert(ChildOf(other));
                }
            }
            18 => {
                world.entity_mut(body).remove::<ChildOf>();
            }
            19 => {
                world.entity_mut(body).insert(ContinuousCollision);
                self.unusual = 5;
                return Change::Slow;
            }
            20 => {
                world.resource_mut::<Time<Physics>>().pause();
                self.unusual = 3;
            }
            21 => {
                let response = [Response::Impulse, Response::None][usize::from(rotation.x > 0.0)];
                world.insert_resource(response);
                world.insert_resource(Gravity(2.0 * Vec3::Y));
                self.unusual = 5;
                return Change::Slow;
            }
            22 => {
                self.snapshot = Some(Snapshot::take(world));
                return Change::Taken;
            }
            23 => {
                if let Some(snapshot) = &self.snapshot {
                    snapshot.restore(world);
                    return Change::Restored;
                }
            }
            _ => {
                // Seldom: after three losses that soon follow each other steps stay on the CPU.
                #[cfg(feature = "gpu")]
                if place.y > 4.7
                    && let Some(gpu) = bevy_faceoff::plugin::gpu(world)
                {
                    gpu.device.destroy();
                }
                return Change::Slow;
            }
        }
        Change::Usual
    }

    /// Replaces bodies that are gone, lost in space or rejected, and ends unusual settings.
    fn keep_going(&mut self) {
        if self.unusual > 0 {
            self.unusual -= 1;
            if self.unusual == 0 {
                self.be_usual();
            }
        }
        let out = 3.0 * self.half_width + 20.0;
        let world = self.app.world_mut();
        let is_lost = |body: Entity| {
            let velocity = world.get::<LinearVelocity>(body).map_or(Vec3::ZERO, |v| v.0);
            let pose = world.get::<Transform>(body);
            let is_far = |pose: &Transform| !pose.is_finite() || pose.translation.length() >= out;
            pose.is_none_or(is_far) || !velocity.is_finite()
        };
        let lost: Vec<Entity> = self.bodies.iter().copied().filter(|&body| is_lost(body)).collect();
        for body in lost {
            if let Ok(body) = world.get_entity_mut(body) {
                body.despawn();
            }
        }
        self.bodies.retain(|&body| world.get_entity(body).is_ok());
        while self.bodies.len() < self.wanted {
            self.spawn();
        }
    }

    /// Ends unusual settings.
    fn be_usual(&mut self) {
        let world = self.app.world_mut();
        world.insert_resource(Response::default());
        world.insert_resource(Gravity::default());
        world.resource_mut::<Time<Physics>>().unpause();
        // A device has none of these, so that steps go on there.
        let mut fast = world.query_filtered::<Entity, With<ContinuousCollision>>();
        let fast: Vec<Entity> = fast.iter(world).collect();
        for body in fast {
            world.entity_mut(body).remove::<ContinuousCollision>();
        }
    }

    /// Despawns all bodies, and lets the empty world go on for some steps. The next change fills it again.
    fn rest(&mut self, checks: &mut Checks, steps: usize) {
        self.be_usual();
        self.snapshot = None;
        for body in std::mem::take(&mut self.bodies) {
            if let Ok(body) = self.app.world_mut().get_entity_mut(body) {
                body.despawn();
            }
        }
        for _ in 0..steps {
            self.app.update();
            checks.drain(self.app.world_mut());
        }
    }
}

/// Whether `upper` is `body` or one of its ancestors.
fn is_above(world: &World, upper: Entity, body: Entity) -> bool {
    let mut at = Some(body);
    while let Some(entity) = at {
        if entity == upper {
            return true;
        }
        at = world.get::<ChildOf>(entity).map(ChildOf::parent);
    }
    false
}
