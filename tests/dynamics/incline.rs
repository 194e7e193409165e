//! Friction and rolling on a slope, by Coulomb's law. Sleep is off, because it would hide creep.

use crate::world::{GAP, World, any_turn};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::Plane;
use bevy_faceoff::testing::scenes::incline::slope;
use bevy_faceoff::types::body::RigidBody;
use glam::{DVec3, Quat, Vec3};

const GRAVITY: f64 = 9.81;
/// Default coefficient of friction.
const FRICTION: f64 = 0.5;

/// A slope that descends along x at `angle` radians.
struct Slope {
    world: World,
    turn: Quat,
    down: DVec3,
}

impl Slope {
    fn new(angle: f64) -> Self {
        let (scene, turn) = slope(angle);
        let world = World::of(&scene);
        Self {
            world,
            turn,
            down: (turn * Vec3::X).as_dvec3(),
        }
    }

    /// A cube of edge 1 that lies on it, rotated about the normal.
    fn cube(&mut self) -> usize {
        let cube = self.world.mesh(&shapes::cube(1.0));
        let at = self.turn * (Vec3::Y * (0.5 + GAP));
        let turn = self.turn * Quat::from_rotation_y(0.3);
        self.world.add(RigidBody::Dynamic, cube, Vec3::ONE, at, turn)
    }

    /// Speed of body `i` down the slope.
    fn speed(&self, i: usize) -> f64 {
        self.world.velocity(i).as_dvec3().dot(self.down)
    }
}

#[test]
fn a_box_sticks_below_the_angle_of_friction() {
    sticks(10);
}

/// A cube just below the angle of friction does not move for so many seconds.
pub fn sticks(seconds: u32) {
    let angle = FRICTION.atan() - 2.0f64.to_radians();
    let mut slope = Slope::new(angle);
    let cube = slope.cube();
    let start = slope.world.center(cube);
    slope.world.seconds(seconds);
    let moved = slope.world.center(cube).distance(start);
    println!(
        "at {:.2} degrees: moved {moved:.6} m in {seconds} s",
        angle.to_degrees()
    );
    assert!(moved < 0.01, "{moved}");
}

#[test]
fn a_box_slides_above_the_angle_of_friction() {
    for degrees in [FRICTION.atan().to_degrees() + 2.0, 35.0, 50.0] {
        slides(degrees);
    }
}

/// The acceleration of a cube beyond the angle of friction, in its second second.
pub fn slides(degrees: f64) {
    let angle = f64::to_radians(degrees);
    let mut slope = Slope::new(angle);
    let cube = slope.cube();
    slope.world.seconds(1);
    let before = slope.speed(cube);
    slope.world.seconds(1);
    let found = slope.speed(cube) - before;
    let wanted = GRAVITY * (angle.sin() - FRICTION * angle.cos());
    let error = found / wanted - 1.0;
    println!("at {degrees:.2} degrees: {found:.4} m/s^2, {:+.3} % off", 100.0 * error);
    assert!(error.abs() < 0.03, "{degrees}: {found}, not {wanted}");
}

/// Relative error of the acceleration of rolling balls, averaged over 2 s and over the rotations of the balls.
pub fn rolling_error(degrees: f64, half_space: bool, runs: u32) -> f64 {
    let mut random = fastrand::Rng::with_seed(9);
    let mesh = shapes::ball(0.5, 4);
    assert!(mesh.triangles().len() >= 5120);
    let mesh = CollisionMesh::new(&mesh);
    let angle = degrees.to_radians();
    let speeds = (0..runs).map(|_| {
        let mut slope = Slope::new(angle);
        let state = &mut slope.world.state;
        if half_space {
            state.input.bodies.clear();
            state.input.planes.push(Plane {
                normal: slope.turn * Vec3::Y,
                ..Plane::default()
            });
        }
        let mesh = state.input.meshes.add(mesh.clone());
        // A rest offset above the slope.
        let at = slope.turn * (Vec3::Y * 0.505);
        let turn = any_turn(&mut random);
        let ball = slope.world.add(RigidBody::Dynamic, mesh, Vec3::ONE, at, turn);
        slope.world.seconds(2);
        slope.speed(ball)
    });
    let found = speeds.sum::<f64>() / f64::from(runs) / 2.0;
    let error = found / (5.0 / 7.0 * GRAVITY * angle.sin()) - 1.0;
    let under = if half_space { "half-space" } else { "mesh" };
    println!(
        "ball on a {under} at {degrees} degrees: {found:.4} m/s^2, {:+.3} % off",
        100.0 * error
    );
    error
}

#[test]
fn balls_roll_down_a_mesh() {
    // A ball rolls without sliding up to a slope whose tangent is 7/2 of the coefficient of friction.
    for degrees in [5.0, 10.0, 20.0] {
        assert!(rolling_error(degrees, false, 6).abs() < 0.03);
    }
}

#[test]
fn balls_roll_down_a_half_space() {
    for degrees in [5.0, 10.0, 20.0] {
        assert!(rolling_error(degrees, true, 6).abs() < 0.03);
    }
}

#[test]
fn the_acceleration_of_rolling_balls_is_five_sevenths_within_a_percent() {
    for half_space in [false, true] {
        assert!(rolling_error(10.0, half_space, 3).abs() < 0.01);
    }
}
