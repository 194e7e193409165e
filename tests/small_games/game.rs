//! An app for a small game: default settings, 64 steps per second, earth's gravity, no window.

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::prelude::*;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Distance between the surfaces of bodies at rest, in bounding diameters: the default of
/// `SolverSettings::rest_offset`.
pub const GAP: f32 = 0.0005;

/// One fixed step.
const STEP: Duration = Duration::from_nanos(15_625_000);

pub struct Game {
    pub app: App,
    /// Whether steps are frames of the app. Else they run at once, and wait for their results.
    in_frames: bool,
    /// Whether all steps must run on a GPU.
    stays_on_gpu: bool,
}

impl Game {
    pub fn new(backend: Backend) -> Self {
        Self::with_readback(backend, Readback::Auto)
    }

    pub fn with_readback(backend: Backend, readback: Readback) -> Self {
        let mut app = App::new();
        let step = StepPlugin {
            backend,
            threads: 1,
            readback,
            ..default()
        };
        app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins { step, ..default() }));
        app.finish();
        app.cleanup();
        Self {
            app,
            in_frames: false,
            stays_on_gpu: backend == Backend::Gpu,
        }
    }

    /// Where the steps run.
    pub fn backend(&self) -> ActiveBackend {
        self.app.world().resource::<ActiveBackend>().clone()
    }

    /// A game whose steps are frames of the app, one each, when there is something to run them on.
    pub fn in_frames(mut self) -> Self {
        self.app.insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
        // Bevy's first update runs no step.
        self.app.update();
        while self.backend() == ActiveBackend::Opening {
            std::thread::sleep(STEP);
            self.app.update();
        }
        self.in_frames = true;
        self
    }

    pub fn without_gravity(mut self) -> Self {
        self.app.insert_resource(Gravity(Vec3::ZERO));
        self
    }

    /// Bodies bounce however slowly they meet.
    pub fn with_all_bounces(mut self) -> Self {
        self.app.insert_resource(SolverSettings {
            restitution_threshold: 0.0,
            ..default()
        });
        self
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

    /// A half-space below `y` = 0.
    pub fn plane(&mut self) -> Entity {
        self.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y))
    }

    /// A static box of this mesh, a cube of edge 1, so many times as large. Its top is at `y` = 0.
    pub fn slab(&mut self, cube: &MeshCollider, scale: f32) -> Entity {
        let size = Vec3::new(40.0, 1.0, 40.0) * scale;
        let pose = Transform::from_xyz(0.0, -0.5 * scale, 0.0).with_scale(size);
        self.spawn((cube.clone(), pose))
    }

    pub fn steps(&mut self, count: usize) {
        for _ in 0..count {
            if self.in_frames {
                self.app.update();
            } else {
                self.world().run_schedule(FaceoffStep);
            }
            let report = self.app.world().resource::<StepReport>();
            let is_elsewhere = report.bodies > 0 && report.gpu.is_none();
            assert!(!(self.stays_on_gpu && is_elsewhere), "a step ran on the CPU");
        }
    }

    pub fn seconds(&mut self, seconds: f32) {
        self.steps((64.0 * seconds) as usize);
    }

    pub fn get<C: Component + Clone>(&self, entity: Entity) -> C {
        self.app.world().get::<C>(entity).unwrap().clone()
    }

    pub fn set(&mut self, entity: Entity, bundle: impl Bundle) {
        self.world().entity_mut(entity).insert(bundle);
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

    pub fn sleeps(&self, entity: Entity) -> bool {
        self.get::<Sleeping>(entity).0
    }
}

/// A dynamic body of this mesh.
pub fn body(mesh: &MeshCollider, pose: Transform) -> impl Bundle + use<> {
    (RigidBody::Dynamic, mesh.clone(), pose)
}

/// What bounces without loss and without friction, off everything.
pub fn elastic() -> impl Bundle {
    (
        Restitution::new(1.0).with_combine(CombineRule::Max),
        Friction::new(0.0).with_combine(CombineRule::Min),
    )
}

/// A rotation, all alike likely.
pub fn any_rotation(random: &mut fastrand::Rng) -> Quat {
    loop {
        let q = Quat::from_array(std::array::from_fn(|_| 2.0 * random.f32() - 1.0));
        if (0.1..1.0).contains(&q.length()) {
            return q.normalize();
        }
    }
}

/// Fails unless `found` lies in `range`: what theory says, and the tolerance.
#[track_caller]
pub fn check(what: impl std::fmt::Display, found: f32, range: RangeInclusive<f32>) {
    assert!(range.contains(&found), "{what}: {found}, not in {range:?}");
}
