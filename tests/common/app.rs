//! A headless app on a manual clock, for tests that use the plugins like a game.

#![allow(dead_code)]

use bevy::ecs::message::Messages;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::TriMesh;
#[cfg(feature = "gpu")]
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::prelude::*;
use std::cell::Cell;
#[cfg(feature = "gpu")]
use std::cell::RefCell;
use std::time::Duration;

thread_local! {
    /// Whether apps that this thread makes run on a GPU by default.
    pub static ON_GPU: Cell<bool> = const { Cell::new(false) };
}

#[cfg(feature = "gpu")]
thread_local! {
    /// The device of this thread's apps. Without it each app opens its own, and compiles its kernels.
    pub static DEVICE: RefCell<Option<Gpu>> = const { RefCell::new(None) };
}

/// Length of a fixed step, seconds: a power of two, so that times add up exactly.
pub const STEP: Duration = Duration::from_nanos(15_625_000);
pub const DT: f32 = 1.0 / 64.0;

/// An app that runs one fixed step per update and keeps all messages.
pub struct Sim {
    pub app: App,
    pub started: Vec<CollisionStart>,
    pub ended: Vec<CollisionEnd>,
    pub rejected: Vec<BodyRejected>,
    /// Whether all steps must run on a GPU.
    pub stays_on_gpu: bool,
}

impl Sim {
    /// An app without gravity, on one thread, with the folder of test assets.
    pub fn new() -> Self {
        Self::with_threads(1)
    }

    pub fn with_threads(threads: usize) -> Self {
        Self::with_step(Self::step_plugin(threads))
    }

    /// An app on one thread, with another plugin.
    pub fn with_plugin(plugin: impl Plugin) -> Self {
        let mut app = App::new();
        let step = Self::step_plugin(1);
        app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins { step, ..default() }, plugin));
        Self {
            // Hooks run on the CPU.
            stays_on_gpu: false,
            ..Self::of(app)
        }
    }

    fn step_plugin(threads: usize) -> StepPlugin {
        // Most of these tests expect the bits of the CPU.
        let backend = if ON_GPU.get() { Backend::Gpu } else { Backend::Cpu };
        StepPlugin {
            backend,
            threads,
            ..default()
        }
    }

    /// An app with these settings of the step plugin.
    pub fn with_step(#[allow(unused_mut)] mut step: StepPlugin) -> Self {
        #[cfg(feature = "gpu")]
        if step.backend == Backend::Gpu {
            step.device = DEVICE.with_borrow(Clone::clone);
        }
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins { step, ..default() }));
        Self::of(app)
    }

    /// Reports the end of a touch at once, without hysteresis.
    pub fn exact(mut self) -> Self {
        self.world().insert_resource(EventHysteresis(0.0));
        self
    }

    /// Wraps an app that already has its plugins.
    pub fn of(mut app: App) -> Self {
        app.insert_resource(Time::<Fixed>::from_duration(STEP))
            .insert_resource(TimeUpdateStrategy::ManualDuration(STEP))
            .insert_resource(Gravity(Vec3::ZERO))
            // Some tests look at the lists of faces.
            .insert_resource(FaceLists(true));
        app.finish();
        app.cleanup();
        // Bevy's first update has zero elapsed time and runs no step.
        app.update();
        Self {
            app,
            started: Vec::new(),
            ended: Vec::new(),
            rejected: Vec::new(),
            stays_on_gpu: ON_GPU.get(),
        }
    }

    pub fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }

    pub fn mesh(&mut self, mesh: &TriMesh) -> MeshCollider {
        let mut meshes = self.world().resource_mut::<Assets<CollisionMesh>>();
        MeshCollider(meshes.add(CollisionMesh::new(mesh)))
    }

    pub fn spawn(&mut self, bundle: impl Bundle) -> Entity {
        self.world().spawn(bundle).id()
    }

    pub fn set(&mut self, entity: Entity, bundle: impl Bundle) {
        self.world().entity_mut(entity).insert(bundle);
    }

    pub fn get<C: Component + Clone>(&self, entity: Entity) -> C {
        self.app.world().get::<C>(entity).unwrap().clone()
    }

    pub fn position(&self, entity: Entity) -> Vec3 {
        self.get::<Transform>(entity).translation
    }

    pub fn velocity(&self, entity: Entity) -> Vec3 {
        self.get::<LinearVelocity>(entity).0
    }

    pub fn spin(&self, entity: Entity) -> Vec3 {
        self.get::<AngularVelocity>(entity).0
    }

    /// Runs updates, one step each unless the clock was set otherwise.
    pub fn step(&mut self, updates: usize) {
        for _ in 0..updates {
            self.app.update();
            let world = self.app.world_mut();
            self.started
                .extend(world.resource_mut::<Messages<CollisionStart>>().drain());
            self.ended
                .extend(world.resource_mut::<Messages<CollisionEnd>>().drain());
            self.rejected
                .extend(world.resource_mut::<Messages<BodyRejected>>().drain());
            let report = self.report();
            let is_elsewhere = report.bodies > 0 && report.gpu.is_none();
            assert!(!(self.stays_on_gpu && is_elsewhere), "a step ran on the CPU");
        }
    }

    pub fn report(&self) -> &StepReport {
        self.app.world().resource::<StepReport>()
    }

    pub fn collisions(&self) -> &Collisions {
        self.app.world().resource::<Collisions>()
    }

    /// Pairs of bodies that touched in the last step.
    pub fn touching(&self) -> Vec<[Entity; 2]> {
        self.collisions().iter().map(|c| [c.collider1, c.collider2]).collect()
    }

    pub fn touch(&self, one: Entity, other: Entity) -> bool {
        self.collisions().get(one, other).is_some()
    }
}

/// The message of a start between two bodies of one collider each, ascending.
pub fn start_of([a, b]: [Entity; 2]) -> CollisionStart {
    CollisionStart {
        target: a,
        collider1: a,
        collider2: b,
        body1: a,
        body2: b,
    }
}

/// The message of the end of such a touch.
pub fn end_of([a, b]: [Entity; 2]) -> CollisionEnd {
    CollisionEnd {
        target: a,
        collider1: a,
        collider2: b,
        body1: a,
        body2: b,
    }
}

/// A dynamic body at `position` that moves with `velocity` and bounces without loss.
pub fn ball_like(mesh: &MeshCollider, position: Vec3, velocity: Vec3) -> impl Bundle + use<> {
    (
        RigidBody::Dynamic,
        mesh.clone(),
        Transform::from_translation(position),
        LinearVelocity(velocity),
        Restitution::new(1.0),
    )
}

/// A dynamic body at rest at `position`.
pub fn resting(mesh: &MeshCollider, position: Vec3) -> impl Bundle + use<> {
    (RigidBody::Dynamic, mesh.clone(), Transform::from_translation(position))
}

/// The place of an entity without a stable key in the order of collisions: that of spawning, unless it replaces
/// another.
pub fn place(entity: &Entity) -> u64 {
    entity.to_bits() ^ u64::from(u32::MAX)
}

pub fn sorted(one: Entity, other: Entity) -> [Entity; 2] {
    let mut both = [one, other];
    both.sort_by_key(place);
    both
}

pub fn assert_near(found: Vec3, wanted: Vec3, tolerance: f32) {
    assert!(
        found.distance(wanted) <= tolerance,
        "found {found}, wanted {wanted} to within {tolerance}"
    );
}

/// Requires that every start has had its end, but for the pairs that touch now, and that no pair has a despawned
/// collider.
#[track_caller]
pub fn assert_told(sim: &Sim) {
    let pair = |[a, b]: [Entity; 2]| sorted(a, b);
    let mut open: Vec<_> = sim.started.iter().map(|s| pair([s.collider1, s.collider2])).collect();
    for end in &sim.ended {
        let ended = pair([end.collider1, end.collider2]);
        let at = open
            .iter()
            .position(|&started| started == ended)
            .expect("an end without a start");
        open.remove(at);
    }
    let mut now: Vec<_> = sim.touching().into_iter().map(pair).collect();
    now.sort();
    open.sort();
    assert_eq!(open, now);
    for entity in now.into_iter().flatten() {
        assert!(sim.app.world().get_entity(entity).is_ok());
    }
}
