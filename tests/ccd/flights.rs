//! Moving bodies, for the product and for the oracle.

use super::oracle::MovingMesh;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::ccd::{Pose, Scratch, Sweep, time_of_impact};
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::state::{Body, StepInput};
use glam::{DQuat, DVec3, Quat, Vec3};

/// Bodies and the motion of each in a collision substep.
#[derive(Default)]
pub struct Flights {
    pub input: StepInput,
    pub sweeps: Vec<Sweep>,
    pub scratch: Scratch,
}

impl Flights {
    /// Without bodies; they may have these meshes.
    pub fn new(meshes: &[TriMesh]) -> Self {
        let mut flights = Self::default();
        for mesh in meshes {
            flights.input.meshes.add(CollisionMesh::new(mesh));
        }
        flights
    }

    /// Removes all bodies.
    pub fn clear(&mut self) {
        self.input.bodies.clear();
        self.sweeps.clear();
    }

    /// Adds a body. Its own pose is far from its sweep, and must not matter.
    pub fn add(&mut self, mesh: usize, scale: Vec3, sweep: Sweep) -> u32 {
        let body = Body::at_rest(mesh as u32, Vec3::new(-7.0, 70.0, 700.0), Quat::IDENTITY, scale);
        self.input
            .bodies
            .push(&body, &self.input.meshes)
            .expect("a usable body");
        self.sweeps.push(sweep);
        self.sweeps.len() as u32 - 1
    }

    pub fn time_of(&mut self, pair: [u32; 2], target_distance: f32) -> Option<f32> {
        let sweeps = pair.map(|i| &self.sweeps[i as usize]);
        let Self { input, scratch, .. } = self;
        time_of_impact(&input.bodies, &input.meshes, pair, sweeps, target_distance, scratch)
    }

    /// The time of impact of bodies 0 and 1.
    pub fn time(&mut self, target_distance: f32) -> Option<f32> {
        self.time_of([0, 1], target_distance)
    }

    /// Body `i` for the oracle.
    pub fn moving_mesh(&self, i: usize) -> MovingMesh {
        let slot = &self.input.meshes[self.input.bodies.mesh[i]].mesh;
        let (scale, sweep) = (self.input.bodies.scale[i].as_dvec3(), &self.sweeps[i]);
        let mass_center = slot.mass.center.as_dvec3();
        let place = |p: Vec3| sweep.before.rotation * (scale * (p.as_dvec3() - mass_center));
        MovingMesh {
            triangles: (0..slot.mesh.triangles().len())
                .map(|t| slot.mesh.corners(t).map(place))
                .collect(),
            center: sweep.before.center,
            travel: sweep.travel,
            turn: sweep.turn,
        }
    }

    /// Bodies 0 and 1.
    pub fn moving_meshes(&self) -> [MovingMesh; 2] {
        [self.moving_mesh(0), self.moving_mesh(1)]
    }
}

/// The motion of a body that starts at `from` and moves by `travel`, with the rotation vector `turn`.
pub fn flight(from: DVec3, rotation: DQuat, travel: DVec3, turn: DVec3) -> Sweep {
    Sweep {
        before: Pose { center: from, rotation },
        travel,
        turn,
    }
}

/// The motion of a body at rest.
pub fn stay(at: DVec3, rotation: DQuat) -> Sweep {
    Sweep::at_rest(Pose { center: at, rotation })
}

/// Random numbers for these tests.
pub struct Random(fastrand::Rng);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.f64()
    }

    pub fn below(&mut self, count: usize) -> usize {
        self.0.usize(..count)
    }

    /// A random direction, of length one.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::from_array([0; 3].map(|_| self.range(-1.0, 1.0)));
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    pub fn rotation(&mut self) -> DQuat {
        DQuat::from_axis_angle(self.direction(), self.range(0.0, 6.3))
    }
}
