//! Meshes on half-spaces: the points made of their vertices, solved, there and back.

use crate::world::{check, check_below};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::stages::manifolds::Manifolds;
use bevy_faceoff::stages::manifolds::cpu::planes;
use bevy_faceoff::stages::solver::*;
use bevy_faceoff::stages::state::{Body, Plane, StepConfig, StepState};
use glam::{Quat, Vec3};

struct Scene {
    state: StepState,
    solver: Solver,
    warm: WarmStart,
    bodies: SolverBodies,
    manifolds: Manifolds,
    scratch: planes::Scratch,
}

impl Scene {
    fn new() -> Self {
        let mut state = StepState::default();
        state.planes.push(Plane {
            normal: Vec3::Y,
            distance: 0.0,
            restitution: 0.0,
        });
        state.config = StepConfig {
            gravity: Vec3::NEG_Y * 9.81,
            ..state.config
        };
        Self {
            state,
            solver: Solver::default(),
            warm: WarmStart::default(),
            bodies: SolverBodies::default(),
            manifolds: Manifolds::default(),
            scratch: planes::Scratch::default(),
        }
    }

    fn add(&mut self, mesh: &TriMesh, scale: Vec3, position: Vec3, rotation: Quat) -> usize {
        let slot = self.state.meshes.add(CollisionMesh::new(mesh));
        let body = Body::at_rest(slot, position, rotation, scale);
        self.state.bodies.push(&body, &self.state.meshes).unwrap();
        self.state.bodies.len() - 1
    }

    fn step(&mut self, count: usize) {
        let settings = SolverSettings::default();
        for _ in 0..count {
            let state = &mut self.state;
            self.manifolds.pairs.clear();
            self.manifolds.points.clear();
            planes::find(
                &state.bodies,
                &state.meshes,
                &state.planes,
                &state.config,
                &mut self.scratch,
                &mut self.manifolds,
            );
            let keys: Vec<u64> = (0..state.bodies.len() as u64).collect();
            self.bodies.read(&state.bodies, &state.meshes, &state.planes, &keys);
            let interval = Interval {
                dt: state.config.dt,
                substeps: settings.substeps,
                gravity: state.config.gravity,
            };
            self.solver
                .solve(&mut self.bodies, &self.manifolds, &mut self.warm, &settings, &interval);
            self.bodies.write(&mut state.bodies, &state.meshes);
        }
    }
}

#[test]
fn a_cube_lies_on_four_corners() {
    let mut scene = Scene::new();
    let cube = scene.add(
        &shapes::cube(1.0),
        Vec3::ONE,
        Vec3::new(3.0, 0.51, 1.0),
        Quat::from_rotation_y(0.3),
    );
    scene.step(1);
    assert_eq!(scene.manifolds.pairs[0].bodies, [0, 1]);
    assert_eq!(scene.manifolds.points.len(), 4);
    scene.step(640);
    let position = scene.state.bodies.position[cube];
    check("height", position.y as f64, 0.50866, 0.001);
    check_below("aside", (position.x - 3.0).hypot(position.z - 1.0) as f64, 0.001);
    for point in &scene.manifolds.points {
        assert_eq!(point.normal, Vec3::NEG_Y);
        assert!((point.arms[0].y + 0.5).abs() < 0.002);
        let on_plane = point.arms[1].y;
        assert!(on_plane.abs() < 1.0e-5, "{on_plane}");
    }
}

#[test]
fn meshes_dropped_on_a_plane_come_to_rest() {
    let bodies = [
        (shapes::ball(0.5, 3), Vec3::ONE),
        (shapes::torus_240(), Vec3::ONE),
        (shapes::cube(1.0), Vec3::new(0.4, -0.6, 1.0)),
    ];
    for (k, (mesh, scale)) in bodies.iter().enumerate() {
        let mut scene = Scene::new();
        let body = scene.add(
            mesh,
            *scale,
            Vec3::Y * 1.5,
            Quat::from_scaled_axis(Vec3::new(0.5, 0.2, 0.9)),
        );
        scene.step(64 * 8);
        let speed = scene.state.bodies.linear_velocity[body].length();
        let deepest = scene
            .manifolds
            .points
            .iter()
            .map(|p| -p.separation)
            .fold(f32::MIN, f32::max);
        check_below(
            &format!("mesh {k}: speed, m/s"),
            speed as f64,
            if k == 0 { 0.2 } else { 0.02 },
        );
        check_below("deepest, metres", deepest as f64, 0.001);
        assert!(scene.manifolds.points.len() <= planes::MAX_POINTS);
    }
}
