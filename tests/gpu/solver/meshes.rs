//! Contact points of meshes, as the solver will get them.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::cpu::planes;
use bevy_faceoff::manifolds::{Manifold, ManifoldPoint, Manifolds, MarginPair, cpu};
use bevy_faceoff::solver::{CollisionSubstep, SolverBodies};
use bevy_faceoff::state::{Body, Plane, StepConfig, StepInput};
use bevy_faceoff::step::StepState;
use bevy_faceoff::testing::gpu_solver::GpuSolver;
use bevy_faceoff::types::solver_settings::SolverSettings;
use glam::{Quat, Vec3};

struct Scene {
    state: StepState,
    bodies: SolverBodies,
}

/// Rings, cubes and balls over a floor, nearly touching.
fn pile() -> Scene {
    let mut state = StepState::default();
    state.input.planes.push(Plane {
        normal: Vec3::Y,
        distance: 0.0,
        restitution: 0.0,
        ..Plane::default()
    });
    state.input.config = StepConfig {
        gravity: Vec3::NEG_Y * 9.81,
        ..state.input.config
    };
    let slots = [shapes::torus_240(), shapes::cube(0.6), shapes::ball(0.4, 2)]
        .map(|mesh| state.input.meshes.add(CollisionMesh::new(&mesh)));
    for i in 0..9 {
        let at = Vec3::new(0.3 * (i % 2) as f32, 1.0 + 1.1 * i as f32, 0.2 * (i % 3) as f32);
        let rotation = Quat::from_scaled_axis(Vec3::new(0.5, 0.2 * i as f32, 0.9));
        let body = Body::at_rest(slots[i % 3], at, rotation, Vec3::ONE);
        state.input.bodies.push(&body, &state.input.meshes).unwrap();
    }
    state.input.bodies.travel_time.fill(state.input.config.dt);
    let keys: Vec<u64> = (0..state.input.bodies.len() as u64).collect();
    let mut bodies = SolverBodies::default();
    bodies.read(&state.input.bodies, &state.input.planes, &keys);
    Scene { state, bodies }
}

impl Scene {
    fn manifolds(&self) -> Manifolds {
        let StepInput {
            bodies,
            meshes,
            planes,
            config,
            ..
        } = &self.state.input;
        let [mut on_planes, mut on_meshes] = [Manifolds::default(), Manifolds::default()];
        planes::find(
            bodies,
            meshes,
            planes,
            config,
            |_| true,
            &mut planes::Scratch::default(),
            &mut on_planes,
        );
        let count = bodies.len() as u32;
        let pairs: Vec<MarginPair> = (0..count)
            .flat_map(|a| (a + 1..count).map(move |b| [a, b]))
            .map(|bodies| MarginPair { bodies, margin: 0.02 })
            .collect();
        cpu::run(bodies, meshes, &pairs, &mut cpu::Scratch::default(), &mut on_meshes);
        joined([&on_planes, &on_meshes])
    }

    /// Lets contact generation know where the bodies are.
    fn place(&mut self) {
        self.bodies
            .write(&mut self.state.input.bodies, &self.state.input.meshes);
    }
}

/// In the order of bodies.
fn joined(parts: [&Manifolds; 2]) -> Manifolds {
    let mut all: Vec<(Manifold, &[ManifoldPoint])> = Vec::new();
    for part in parts {
        all.extend(part.pairs.iter().map(|pair| (*pair, part.points_of(pair))));
    }
    all.sort_by_key(|(pair, _)| pair.bodies);
    let mut joined = Manifolds::default();
    for (pair, points) in all {
        joined.pairs.push(Manifold {
            first_point: joined.points.len() as u32,
            ..pair
        });
        joined.points.extend(points);
    }
    joined
}

pub fn a_pile_of_meshes(gpu: &Gpu) {
    let settings = SolverSettings {
        sleeping: false,
        ..SolverSettings::default()
    };
    let mut pile = pile();
    let mut on_device = GpuSolver::new(gpu).unwrap();
    on_device.put_bodies(&pile.bodies).unwrap();
    let collision_substep = CollisionSubstep {
        dt: pile.state.input.config.dt,
        substeps: settings.substeps,
        gravity: pile.state.input.config.gravity,
    };
    let mut most = 0;
    for _ in 0..128 {
        let manifolds = pile.manifolds();
        most = most.max(manifolds.points.len());
        on_device.put_contacts(&manifolds).unwrap();
        on_device.run(&settings, &collision_substep).unwrap();
        pile.bodies.motions = on_device.motions().unwrap();
        pile.place();
    }
    let motions = &pile.bodies.motions;
    assert!(most > 40, "{most} points");
    assert!(motions.iter().all(|m| m.center.is_finite() && m.center.y > -0.01));
    let deepest = pile
        .manifolds()
        .points
        .iter()
        .map(|p| -p.separation)
        .fold(f32::MIN, f32::max);
    println!("at most {most} points, in the end {deepest} m deep");
    assert!(deepest < 0.02, "{deepest}");
}
