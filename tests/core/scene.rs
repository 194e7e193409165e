//! Random poses of two meshes that touch.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::queries::{ContactWorker, MeshContact, PairMemory, Placed};
use glam::{DQuat, DVec3, Quat, Vec3};

/// Pose of a mesh, in single precision like those of a step.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    pub translation: Vec3,
    pub rotation: Quat,
    pub scale: Vec3,
}

impl Pose {
    pub fn new(translation: Vec3, rotation: Quat) -> Self {
        Self {
            translation,
            rotation,
            scale: Vec3::ONE,
        }
    }

    /// The mesh with this pose, translated by `offset`.
    pub fn place<'a>(&self, mesh: &'a CollisionMesh, offset: DVec3) -> Placed<'a> {
        let translation = self.translation.as_dvec3() + offset;
        Placed::new(mesh, translation, self.rotation.as_dquat(), self.scale).expect("a usable pose")
    }

    /// A slightly different pose.
    pub fn moved(&self, random: &mut fastrand::Rng, distance: f32, angle: f32) -> Self {
        Self {
            translation: self.translation + distance * vector(random),
            rotation: (Quat::from_scaled_axis(angle * vector(random)) * self.rotation).normalize(),
            ..*self
        }
    }
}

/// Baked shapes about 1 m in size, with names.
pub fn meshes() -> [(&'static str, CollisionMesh); 4] {
    [
        ("knot", shapes::knot_1120()),
        ("torus", shapes::torus_240()),
        ("box", shapes::cube(0.7)),
        ("ball", shapes::ball(0.5, 3)),
    ]
    .map(|(name, mesh)| (name, CollisionMesh::new(&mesh)))
}

/// A vector whose coordinates lie between -1 and 1.
pub fn vector(random: &mut fastrand::Rng) -> Vec3 {
    Vec3::from_array([0; 3].map(|_| 2.0 * random.f32() - 1.0))
}

pub fn rotation(random: &mut fastrand::Rng) -> Quat {
    let [x, y, z, w] = [0; 4].map(|_| 2.0 * random.f32() - 1.0);
    Quat::from_xyzw(x, y, z, w).normalize()
}

/// The first at the origin, and the second where it touches the first, up to 1 cm deep.
pub fn touching(random: &mut fastrand::Rng, a: &CollisionMesh, b: &CollisionMesh) -> [Pose; 2] {
    let mut worker = ContactWorker::new();
    loop {
        let first = Pose::new(Vec3::ZERO, rotation(random));
        let (turn, way, aside) = (rotation(random), vector(random).normalize(), 0.2 * vector(random));
        for i in 0..150 {
            let second = Pose::new(aside + way * (1.5 - 0.01 * i as f32), turn);
            let mut points = Vec::new();
            worker.points(
                &first.place(a, DVec3::ZERO),
                &second.place(b, DVec3::ZERO),
                0.0,
                &mut points,
            );
            if !points.is_empty() {
                return [first, second];
            }
        }
    }
}

/// All contact points of two placed meshes.
pub fn points(worker: &mut ContactWorker, a: &Placed, b: &Placed, margin: f32) -> Vec<MeshContact> {
    let mut points = Vec::new();
    worker.points(a, b, margin, &mut points);
    points
}

/// Their reduced manifold.
pub fn manifold(worker: &mut ContactWorker, a: &Placed, b: &Placed, margin: f32) -> Vec<MeshContact> {
    let mut points = Vec::new();
    worker.manifold(a, b, margin, &mut PairMemory::default(), &mut points);
    points
}

pub fn identity(mesh: &CollisionMesh, translation: DVec3) -> Placed<'_> {
    Placed::new(mesh, translation, DQuat::IDENTITY, Vec3::ONE).expect("a usable pose")
}
