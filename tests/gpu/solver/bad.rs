//! Input that makes no sense: it is left out, and nothing hangs.

use super::shapes::Shape;
use super::twin::Twin;
use super::world::{World, check};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::{Manifold, ManifoldPoint, Manifolds};
use bevy_faceoff::solver::gpu::SolverCapacity;
use bevy_faceoff::solver::{CollisionSubstep, SolverBodies, SolverBody};
use bevy_faceoff::step::gpu::StepError;
use bevy_faceoff::testing::gpu_solver::GpuSolver;
use bevy_faceoff::types::solver_settings::SolverSettings;
use glam::{DQuat, DVec3, Vec3};

const CUBE: Shape = Shape::Box(DVec3::splat(0.5));

fn point(normal: Vec3, separation: f32) -> ManifoldPoint {
    ManifoldPoint {
        anchors: [Vec3::ZERO, Vec3::NEG_Y * 0.5],
        normal,
        separation,
        curvature_radii: [0.0, f32::INFINITY],
        bulge: 0.0,
        normal_rotation: 0.0,
        faces: [0, 0],
    }
}

fn pair(bodies: [usize; 2], first_point: u32, point_count: u32) -> Manifold {
    Manifold {
        bodies: bodies.map(|i| i as u32),
        first_point,
        point_count,
    }
}

fn collision_substep(world: &World) -> CollisionSubstep {
    CollisionSubstep {
        dt: world.dt,
        substeps: 8,
        gravity: world.gravity,
    }
}

pub fn bad_input_is_left_out(gpu: &Gpu) {
    let mut world = World::heavy();
    world.floor(0.0);
    let cube = world.dynamic(CUBE, 1.0, DVec3::Y * 0.505);
    let lost = world.dynamic(CUBE, 1.0, DVec3::Y * 3.0);
    world.motion(lost).linear_velocity = Vec3::NAN;
    let weightless = world.dynamic(CUBE, 1.0, DVec3::new(5.0, 1.0, 0.0));
    world.bodies.bodies[weightless] = SolverBody {
        inverse_mass: f32::INFINITY,
        inverse_inertia: glam::Mat3::NAN,
        ..world.bodies.bodies[weightless]
    };
    let odd = world.dynamic(CUBE, 1.0, DVec3::new(-5.0, 0.505, 0.0));
    world.bodies.bodies[odd].radius = f32::NAN;
    world.bodies.bodies[odd].friction = f32::NAN;
    world.bodies.bodies[odd].linear_damping = f32::NAN;
    world.bodies.bodies[odd].max_linear_speed = f32::NAN;
    let turned = world.dynamic(CUBE, 1.0, DVec3::new(-9.0, 9.0, 0.0));
    world.motion(turned).rotation = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    let fast = world.dynamic(CUBE, 1.0, DVec3::new(-9.0, 9.0, 5.0));
    world.motion(fast).angular_velocity = Vec3::new(1.0e30, 3.0, 1.0e12);
    let mut twin = Twin::new(gpu, world);
    for _ in 0..64 {
        twin.world.detect(1.0 / 64.0);
        let first = twin.world.manifolds.points.len() as u32;
        twin.world.manifolds.points.extend([
            point(Vec3::NAN, -0.1),
            point(Vec3::ZERO, -0.1),
            point(Vec3::Y, f32::NAN),
            point(Vec3::Y * f32::INFINITY, -0.1),
            ManifoldPoint {
                anchors: [Vec3::splat(f32::NAN), Vec3::ZERO],
                ..point(Vec3::Y, -0.1)
            },
        ]);
        twin.world.manifolds.pairs.extend([
            pair([cube, weightless], first, 5),
            pair([cube, cube], first, 1),
            pair([cube, 77], first, 1),
            pair([usize::MAX, 77], first, 1),
            pair([cube, odd], first + 5, 9),
            pair([cube, odd], u32::MAX, u32::MAX),
            pair([cube, lost], first + 5, 0),
        ]);
        let collision_substep = collision_substep(&twin.world);
        twin.solve(&collision_substep);
    }
    let world = &twin.world;
    check("the cube rests", world.center(cube).y, 0.5 + 0.000866, 0.005);
    assert_eq!(world.center(lost), DVec3::Y * 3.0);
    assert_eq!(
        world.center(weightless),
        DVec3::new(5.0, 1.0, 0.0),
        "moves as a kinematic one at rest"
    );
    for i in [odd, turned, fast] {
        let motion = &world.bodies.motions[i];
        assert!(motion.center.is_finite() && motion.rotation.is_finite(), "{motion:?}");
    }
    assert_eq!(world.bodies.motions[turned].rotation, DQuat::IDENTITY);
}

pub fn nothing_at_all(gpu: &Gpu) {
    let mut solver = GpuSolver::new(gpu).unwrap();
    let collision_substep = CollisionSubstep {
        dt: 0.01,
        substeps: 3,
        gravity: Vec3::NEG_Y,
    };
    let settings = SolverSettings::default();
    solver.run(&settings, &collision_substep).unwrap();
    solver.put_bodies(&SolverBodies::default()).unwrap();
    solver.put_contacts(&Manifolds::default()).unwrap();
    solver.run(&settings, &collision_substep).unwrap();
    assert_eq!(solver.motions().unwrap(), []);
    assert_eq!(solver.impulses().unwrap(), [0.0; 0]);
    // No passes at all, but bodies fall.
    let settings = SolverSettings {
        bias_iterations: 0,
        relax_iterations: 0,
        restitution_iterations: 0,
        ..settings
    };
    let mut world = World::heavy();
    world.settings = settings;
    world.dynamic(CUBE, 1.0, DVec3::ZERO);
    let mut twin = Twin::new(gpu, world);
    twin.step(64);
    check("speed", twin.world.velocity(0).y as f64, -9.81, 1.0e-3);
}

pub fn empty_intervals_change_nothing(gpu: &Gpu) {
    let mut world = World::heavy();
    world.floor(0.0);
    world.dynamic(CUBE, 1.0, DVec3::Y * 0.505);
    let mut twin = Twin::new(gpu, world);
    twin.step(5);
    let before = twin.world.bodies.motions.clone();
    for (dt, gravity) in [
        (0.0, Vec3::ZERO),
        (-1.0, Vec3::ZERO),
        (f32::NAN, Vec3::ZERO),
        (f32::INFINITY, Vec3::ZERO),
        (0.01, Vec3::NAN),
        (0.01, Vec3::Y * f32::INFINITY),
    ] {
        twin.solve(&CollisionSubstep {
            dt,
            substeps: 0,
            gravity,
        });
        assert_eq!(before, twin.world.bodies.motions, "{dt} s, {gravity}");
    }
}

/// Pairs that share points, are in no order or come twice.
pub fn lists_that_lie(gpu: &Gpu) {
    let mut world = World::heavy();
    for i in 0..8 {
        world.dynamic(CUBE, 1.0, DVec3::Y * f64::from(i));
    }
    let mut twin = Twin::new(gpu, world);
    let mut random = fastrand::Rng::with_seed(3);
    for _ in 0..32 {
        let mut word = |below: u32| random.u32(0..below);
        let count = word(40);
        let pairs = (0..word(40)).map(|_| {
            let bodies = [word(10) as usize, word(10) as usize];
            pair(bodies, word(50), word(20))
        });
        twin.world.manifolds.pairs = pairs.collect();
        twin.world.manifolds.points = (0..count)
            .map(|_| {
                point(
                    [Vec3::X, Vec3::Y, Vec3::NEG_Y][word(3) as usize],
                    word(100) as f32 * 0.01 - 0.5,
                )
            })
            .collect();
        let collision_substep = collision_substep(&twin.world);
        twin.solve(&collision_substep);
        for motion in &twin.world.bodies.motions {
            assert!(motion.center.is_finite() && motion.rotation.is_finite(), "{motion:?}");
        }
    }
}

pub fn too_much_is_an_error(gpu: &Gpu) {
    let capacity = SolverCapacity {
        bodies: 10,
        pairs: 10,
        points: u32::MAX,
    };
    let error = GpuSolver::with_capacity(gpu, capacity).err().unwrap();
    assert!(matches!(error, StepError::TooLarge(_)), "{error}");
}
