//! Equal inputs give the same bits: run after run, and whatever the capacity of the lists.

use super::scene::Scene;
use super::scenes::{ANY, Kit, crowd, half_spaces};
use crate::oracle::rng::Rng;
use bevy_faceoff::gpu::buffers::Capacity;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::state::StepConfig;
use bevy_faceoff::step::StepState;
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::types::settings::Culling;
use glam::Vec3;

/// The smallest capacity: every list has to grow.
pub const TINY: Capacity = Capacity {
    bodies: 1,
    compounds: 0,
    parts: 0,
    planes: 0,
    pairs: 1,
    hits: 1,
    plane_contacts: 1,
    pieces: 1,
    meshes: 1,
    words: 1,
};

/// Enough for every scene here.
pub const AMPLE: Capacity = Capacity {
    bodies: 5000,
    compounds: 1000,
    parts: 2000,
    planes: 100,
    pairs: 50_000,
    hits: 200_000,
    plane_contacts: 5000,
    pieces: 20_000,
    meshes: 64,
    words: 1 << 20,
};

/// All that a step puts out, as bits.
#[derive(PartialEq)]
pub struct Bits {
    pairs: Vec<[u32; 2]>,
    contacts: Vec<u32>,
    bodies: Vec<u32>,
    counts: [u64; 2],
}

impl Bits {
    pub fn of(state: &StepState) -> Self {
        let vector = |v: Vec3| v.to_array().map(f32::to_bits);
        let mut contacts = Vec::new();
        for pair in &state.results.contacts.pairs {
            contacts.extend(pair.bodies);
            contacts.extend([u32::from(pair.contained), pair.first_face, pair.face_count]);
            contacts.extend(vector(pair.contact.point));
            contacts.extend(vector(pair.contact.normal));
        }
        for face in &state.results.contacts.faces {
            contacts.extend([face.a, face.b]);
            contacts.extend(vector(face.start));
            contacts.extend(vector(face.end));
        }
        for plane in &state.results.contacts.planes {
            contacts.extend([plane.body, plane.plane, plane.depth.to_bits()]);
            contacts.extend(vector(plane.point));
        }
        let mut bodies = Vec::new();
        for i in 0..state.input.bodies.len() {
            bodies.extend(vector(state.input.bodies.position[i]));
            bodies.extend(state.input.bodies.rotation[i].to_array().map(f32::to_bits));
            bodies.extend(vector(state.input.bodies.linear_velocity[i]));
            bodies.extend(vector(state.input.bodies.angular_velocity[i]));
        }
        Self {
            pairs: state.results.sphere_pairs.clone(),
            contacts,
            bodies,
            counts: [
                state.results.contacts.triangle_tests,
                state.results.approximate_pairs as u64,
            ],
        }
    }

    /// Says which part differs, and not how: a scene's bits fill pages.
    pub fn require(&self, other: &Self, what: &str) {
        assert!(self.pairs == other.pairs, "{what}: pairs of spheres differ");
        assert!(self.contacts == other.contacts, "{what}: contacts differ");
        assert!(self.bodies == other.bodies, "{what}: bodies differ");
        assert_eq!(self.counts, other.counts, "{what}");
    }
}

/// Bodies of every kind that fall on half-spaces and each other.
pub fn falling(kit: &Kit, meshes: &[u32], count: usize, side: f64) -> Scene {
    let mut rng = Rng::new(77, count as u64);
    let mut scene = crowd(&mut rng, meshes, side);
    scene.bodies.truncate(count);
    scene.shapes.clone_from(&kit.0);
    scene.planes = half_spaces(&mut rng, 0.3 * side as f32);
    scene.config = StepConfig {
        gravity: Vec3::NEG_Y * 9.81,
        ..Default::default()
    };
    let modes = [Culling::Exact, Culling::FacesOfCollision, Culling::FrontFacing];
    scene
        .bodies
        .iter_mut()
        .for_each(|body| body.culling = *rng.pick(&modes));
    scene
}

pub fn again_and_with_other_room(gpu: &Gpu) {
    let kit = Kit::new();
    let scene = falling(&kit, ANY, 300, 8.0);
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    let first = Bits::of(&scene.on_gpu(&mut step));
    assert!(first.contacts.len() > 20_000 && first.pairs.len() > 400);
    for _ in 0..2 {
        first.require(&Bits::of(&scene.on_gpu(&mut step)), "again");
    }
    for (name, capacity) in [("tiny", TINY), ("ample", AMPLE)] {
        let mut step = GpuStep::with_capacity(gpu.clone(), capacity).unwrap();
        first.require(&Bits::of(&scene.on_gpu(&mut step)), name);
    }
    // After another scene, with lists that have grown and meshes elsewhere.
    let mut other = falling(&kit, ANY, 400, 9.0);
    other.shapes.rotate_left(3);
    other.on_gpu(&mut step);
    first.require(&Bits::of(&scene.on_gpu(&mut step)), "after another scene");
}
