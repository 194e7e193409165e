//! Bodies and meshes that come and go for thousands of steps: nothing grows without end, and nothing gone is ever seen.

use super::band::Oracle;
use super::compare::{Tally, compare};
use super::scene::{Scene, Shape, step_on_cpu};
use crate::oracle::rng::Rng;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::buffers::Capacity;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::state::Body;
use bevy_faceoff::step::StepState;
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::types::settings::Culling;
use glam::Vec3;

const STEPS: usize = 3000;
const BODIES: usize = 12;
const MESHES: usize = 8;

/// The CPU is asked so often.
const COMPARED: usize = 50;

/// Meshes of 12 to 80 triangles, some with a face table.
fn shapes() -> Vec<Shape> {
    vec![
        Shape::new("cube", &shapes::cube(1.0), None),
        Shape::new("box", &shapes::cube(0.6), Some((90, 16))),
        Shape::new("torus", &shapes::torus(5, 4, 0.4, 0.15), Some((45, 16))),
        Shape::new("ball", &shapes::ball(0.5, 1), None),
        Shape::new("thick torus", &shapes::torus(3, 3, 0.3, 0.2), None),
    ]
}

/// The scene as the plugin keeps it: bodies by slot of a mesh, meshes in slots of which some are free.
struct Churn {
    rng: Rng,
    known: Vec<Shape>,
    /// What each slot held last, and whether it holds it still.
    slots: Vec<(Shape, bool)>,
    bodies: Vec<Body>,
    state: StepState,
}

impl Churn {
    fn body(&mut self) -> Option<Body> {
        let used: Vec<u32> = (0..self.slots.len() as u32)
            .filter(|&i| self.slots[i as usize].1)
            .collect();
        let mesh = if used.is_empty() {
            return None;
        } else {
            *self.rng.pick(&used)
        };
        let scale = Vec3::splat(self.rng.range(0.3, 1.0) as f32);
        let position = self.rng.in_cube(0.9).as_vec3();
        Some(Body {
            linear_velocity: self.rng.in_cube(1.0).as_vec3(),
            angular_velocity: self.rng.in_cube(3.0).as_vec3(),
            culling: *self
                .rng
                .pick(&[Culling::Exact, Culling::FacesOfCollision, Culling::FrontFacing]),
            ..Body::at_rest(mesh, position, self.rng.rotation(), scale)
        })
    }

    /// Something comes, goes, or becomes something else.
    fn change(&mut self) {
        match self.rng.below(8) {
            0 if self.slots.iter().filter(|slot| slot.1).count() < MESHES => {
                let shape = self.known[self.rng.below(self.known.len())].clone();
                let slot = self.state.input.meshes.add(shape.baked.clone()) as usize;
                self.slots
                    .resize((slot + 1).max(self.slots.len()), (shape.clone(), false));
                self.slots[slot] = (shape, true);
            }
            1 if self.slots.iter().any(|slot| slot.1) => {
                let slot = self.rng.below(self.slots.len());
                self.bodies.retain(|body| body.mesh as usize != slot);
                self.state.input.meshes.remove(slot as u32);
                self.slots[slot].1 = false;
            }
            2 if !self.slots.is_empty() => {
                let slot = self.rng.below(self.slots.len());
                let shape = self.known[self.rng.below(self.known.len())].clone();
                self.state.input.meshes.replace(slot as u32, shape.baked.clone());
                self.slots[slot] = (shape, true);
            }
            3 if !self.bodies.is_empty() => {
                let gone = self.rng.below(self.bodies.len());
                self.bodies.swap_remove(gone);
            }
            4..=6 if self.bodies.len() < BODIES => {
                let body = self.body();
                self.bodies.extend(body);
            }
            7 if self.rng.chance(0.02) => self.bodies.clear(),
            _ => {}
        }
    }

    fn scene(&self) -> Scene {
        Scene {
            shapes: self.slots.iter().map(|(shape, _)| shape.clone()).collect(),
            bodies: self.bodies.clone(),
            ..Default::default()
        }
    }
}

pub fn bodies_and_meshes_come_and_go(gpu: &Gpu) {
    let capacity = Capacity {
        bodies: 1,
        words: 1,
        ..Default::default()
    };
    let mut step = GpuStep::with_capacity(gpu.clone(), capacity).unwrap();
    let mut churn = Churn {
        rng: Rng::new(3000, 0),
        known: shapes(),
        slots: Vec::new(),
        bodies: Vec::new(),
        state: StepState::default(),
    };
    let (mut all, mut compared, mut early_bytes, mut emptied) = (Tally::default(), 0, 0, 0);
    for number in 0..STEPS {
        churn.change();
        let mut scene = churn.scene();
        scene.fill(&mut churn.state);
        step.run(&mut churn.state).unwrap();
        emptied += usize::from(scene.bodies.is_empty());
        let known = |i: u32| (i as usize) < scene.bodies.len();
        assert!(
            churn
                .state
                .results
                .contacts
                .pairs
                .iter()
                .all(|pair| pair.bodies.iter().all(|&i| known(i)))
        );
        if number % COMPARED == 0 {
            // The CPU takes over the meshes, in the same slots.
            let mut cpu = StepState::default();
            cpu.input.meshes = std::mem::take(&mut churn.state.input.meshes);
            scene.fill(&mut cpu);
            step_on_cpu(&mut cpu);
            let oracle = Oracle::new(&scene, &cpu);
            let (mut tally, _) = compare(&scene, &cpu, &churn.state, &oracle);
            let named = |text: &String| format!("step {number}: {text}");
            tally.failures = tally.failures.iter().map(named).collect();
            all.add(tally);
            compared += 1;
            churn.state.input.meshes = cpu.input.meshes;
        }
        scene.take(&churn.state);
        churn.bodies = scene.bodies;
        // Bodies that have left are brought back, or nothing would touch.
        for body in &mut churn.bodies {
            if body.position.abs().max_element() > 1.5 {
                body.position *= 0.5;
                body.linear_velocity *= -0.5;
            }
            body.angular_velocity = body.angular_velocity.clamp_length_max(3.0);
        }
        if number == STEPS / 5 {
            early_bytes = step.bytes();
        }
    }
    println!("\n{}\n{}", Tally::head(), all.row("every 50th of 3000 steps"));
    println!(
        "    {} bytes after {}, {} at the end, {:?}",
        early_bytes,
        STEPS / 5,
        step.bytes(),
        step.capacity()
    );
    all.require_no_failures();
    all.require_few_excused(1000);
    assert!(all.touching > 2 * compared && emptied > 0);
    // A little more may be wanted at once than ever before, but not again and again.
    assert!(
        step.bytes() <= early_bytes * 3 / 2,
        "{early_bytes} bytes became {}",
        step.bytes()
    );
    let most: usize = churn.known.iter().map(words).max().unwrap() * MESHES;
    assert!(
        step.capacity().words as usize <= 2 * most,
        "{} words for {most}",
        step.capacity().words
    );
}

/// Words of a mesh on the device, rounded up: triangles, boxes, vertices, heights and the face table.
fn words(shape: &Shape) -> usize {
    let mesh = &shape.baked;
    let triangles = mesh.mesh.triangles().len();
    let table = mesh
        .faces
        .as_ref()
        .map_or(0, |t| t.directions().len() + t.distinct_len() * triangles.div_ceil(32));
    9 * triangles + 6 * (triangles / 4 + 4) + 3 * mesh.mesh.vertices().len() + 3 * mesh.heights.points().len() + table
}
