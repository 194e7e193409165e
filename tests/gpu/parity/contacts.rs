//! Contacts, half-spaces and the bodies after the step, where both sides found the same faces.

use super::scene::Scene;
use bevy_faceoff::step::StepState;
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// The largest differences, and how many were too large.
#[derive(Clone, Debug, Default)]
pub struct Differences {
    pub contacts: usize,
    /// Distance of points, as a part of the sum of the radii.
    pub point: f32,
    pub normal: f32,
    /// Contacts beyond the tolerance.
    pub contacts_off: usize,
    pub planes: usize,
    pub planes_excused: usize,
    pub depth: f32,
    pub bodies: usize,
    /// Velocity, as a part of the scene's largest; spin, by the speed it gives the surface; position, as a part of the
    /// radius.
    pub velocity: f32,
    pub spin: f32,
    pub position: f32,
    pub rotation: f32,
    /// Bodies beyond the tolerance.
    pub bodies_off: usize,
    pub failures: Vec<String>,
}

/// Points of contact, parts of the sum of the radii; and normals.
pub const CONTACT: f32 = 5.0e-4;

/// Velocities, parts of the scene's largest; more where the CPU's points of contact, which are `f32` in the world, lie on
/// a lattice that is coarse for the body.
pub const VELOCITY: f32 = 1.0e-4;

impl Differences {
    pub fn add(&mut self, other: Self) {
        self.contacts += other.contacts;
        self.contacts_off += other.contacts_off;
        self.planes += other.planes;
        self.planes_excused += other.planes_excused;
        self.bodies += other.bodies;
        self.bodies_off += other.bodies_off;
        self.point = self.point.max(other.point);
        self.normal = self.normal.max(other.normal);
        self.depth = self.depth.max(other.depth);
        self.velocity = self.velocity.max(other.velocity);
        self.spin = self.spin.max(other.spin);
        self.position = self.position.max(other.position);
        self.rotation = self.rotation.max(other.rotation);
        self.failures.extend(other.failures);
    }

    pub fn row(&self) -> String {
        format!(
            "    {} contacts: point {:.0e} normal {:.0e}, {} off; {} planes: depth {:.0e}, {} excused; {} bodies: \
             velocity {:.0e} spin {:.0e} position {:.0e} rotation {:.0e}, {} off",
            self.contacts,
            self.point,
            self.normal,
            self.contacts_off,
            self.planes,
            self.depth,
            self.planes_excused,
            self.bodies,
            self.velocity,
            self.spin,
            self.position,
            self.rotation,
            self.bodies_off
        )
    }
}

/// Compares what follows from the faces. `agreed` are the pairs whose faces are the same on both sides.
pub fn differences(scene: &Scene, cpu: &StepState, gpu: &StepState, agreed: &BTreeSet<[u32; 2]>) -> Differences {
    let mut d = Differences::default();
    // Bodies whose contacts differ; and neighbours of such, since a body's share of mass depends on its contacts.
    let mut unlike: BTreeSet<u32> = BTreeSet::new();
    let of_gpu: BTreeMap<_, _> = gpu
        .results
        .contacts
        .pairs
        .iter()
        .map(|pair| (pair.bodies, pair.contact))
        .collect();
    for pair in &cpu.results.contacts.pairs {
        if !agreed.contains(&pair.bodies) {
            unlike.extend(pair.bodies);
            continue;
        }
        let (on_cpu, on_gpu) = (pair.contact, of_gpu[&pair.bodies]);
        let size: f32 = pair.bodies.iter().map(|&i| cpu.input.bodies.radius[i as usize]).sum();
        let coarse = f32::EPSILON * on_cpu.point.abs().max_element();
        let point = (on_cpu.point.distance(on_gpu.point) - 2.0 * coarse).max(0.0) / size;
        let normal = on_cpu.normal.distance(on_gpu.normal);
        d.contacts += 1;
        if point > CONTACT || normal > CONTACT {
            d.contacts_off += 1;
            unlike.extend(pair.bodies);
        } else {
            d.point = d.point.max(point);
            d.normal = d.normal.max(normal);
        }
    }
    unlike.extend(of_gpu.keys().filter(|pair| !agreed.contains(*pair)).flatten());
    planes(scene, cpu, gpu, &mut d, &mut unlike);
    let neighbours: BTreeSet<u32> = (cpu.results.contacts.pairs.iter())
        .filter(|pair| pair.bodies.iter().any(|i| unlike.contains(i)))
        .flat_map(|pair| pair.bodies)
        .chain(unlike.iter().copied())
        .collect();
    bodies(scene, cpu, gpu, &neighbours, &mut d);
    d
}

fn planes(scene: &Scene, cpu: &StepState, gpu: &StepState, d: &mut Differences, unlike: &mut BTreeSet<u32>) {
    let of = |state: &StepState| -> BTreeMap<_, _> {
        let contacts = state.results.contacts.planes.iter();
        contacts.map(|c| ((c.body, c.plane), (c.depth, c.point))).collect()
    };
    let (of_cpu, of_gpu) = (of(cpu), of(gpu));
    let both: BTreeSet<_> = of_cpu.keys().chain(of_gpu.keys()).copied().collect();
    d.planes += of_cpu.len();
    for key in both {
        let radius = cpu.input.bodies.radius[key.0 as usize];
        let far = cpu.input.bodies.center[key.0 as usize].abs().max_element();
        let band = 1.0e-5 * radius + 4.0 * f32::EPSILON * (far + scene.planes[key.1 as usize].distance.abs());
        let [on_cpu, on_gpu] = [&of_cpu, &of_gpu].map(|side| side.get(&key).copied());
        let [(depth, point), (other_depth, other_point)] = [on_cpu, on_gpu].map(|c| c.unwrap_or((0.0, Vec3::NAN)));
        if (depth - other_depth).abs() > band {
            d.failures
                .push(format!("half-space {key:?}: depth {depth} and {other_depth}"));
        }
        if on_cpu.is_none() || on_gpu.is_none() {
            d.planes_excused += 1;
            unlike.insert(key.0);
            continue;
        }
        d.depth = d.depth.max((depth - other_depth).abs() / radius);
        // Weights of shallow contacts are rounding.
        if depth > 100.0 * band && point.distance(other_point) > 0.05 * radius {
            d.failures
                .push(format!("half-space {key:?}: points {point} and {other_point}"));
        }
        if depth <= 100.0 * band {
            unlike.insert(key.0);
        }
    }
}

fn bodies(scene: &Scene, cpu: &StepState, gpu: &StepState, unlike: &BTreeSet<u32>, d: &mut Differences) {
    let dt = scene.config.dt;
    let fastest = |of: &dyn Fn(usize) -> Vec3| (0..scene.bodies.len()).map(|i| of(i).length()).fold(1.0e-9, f32::max);
    let speed = fastest(&|i| cpu.input.bodies.linear_velocity[i]);
    let (c, g) = (&cpu.input.bodies, &gpu.input.bodies);
    for i in (0..scene.bodies.len()).filter(|i| !unlike.contains(&(*i as u32))) {
        d.bodies += 1;
        let radius = c.radius[i];
        let velocity = c.linear_velocity[i].distance(g.linear_velocity[i]) / speed;
        // A spin counts by the speed it gives the surface.
        let spin = c.angular_velocity[i].distance(g.angular_velocity[i]) * radius / speed;
        let coarse = 2.0 * f32::EPSILON * c.position[i].abs().max_element();
        let tolerance = VELOCITY + 2.0 * coarse / radius;
        if velocity > tolerance || spin > tolerance {
            d.bodies_off += 1;
            continue;
        }
        let moved = tolerance * speed * dt;
        let position = (c.position[i].distance(g.position[i]) - coarse).max(0.0) / (radius + moved);
        let turned = (c.rotation[i] - g.rotation[i]).length();
        d.velocity = d.velocity.max(velocity);
        d.spin = d.spin.max(spin);
        d.position = d.position.max(position);
        d.rotation = d.rotation.max(turned);
        let may_move = 1.0e-6 + moved / radius;
        if position > may_move || turned > may_move {
            d.failures.push(format!(
                "body {i}: position {position:.1e}, rotation {turned:.1e} of {may_move:.1e}"
            ));
        }
    }
}
