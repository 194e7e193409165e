//! Rims of open sheets, and edges on edges.

use crate::world::World;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, BodyParams};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::material::Friction;
use glam::{DVec3, Quat, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_6};

/// A level sheet of two triangles and edge 1.
fn card() -> TriMesh {
    let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let corners = vec![
        corner(-0.5, 0.5),
        corner(0.5, 0.5),
        corner(-0.5, -0.5),
        corner(0.5, -0.5),
    ];
    TriMesh::new(corners, vec![[0, 1, 3], [0, 3, 2]]).unwrap()
}

/// A tetrahedron with two perpendicular level edges, above and below its centre.
fn tetrahedron() -> TriMesh {
    let corners = [
        [0.5, -0.353_554, 0.0],
        [0.0, 0.353_554, -0.5],
        [0.0, 0.353_554, 0.5],
        [-0.5, -0.353_554, 0.0],
    ];
    let corners = corners.into_iter().map(Vec3::from).collect();
    TriMesh::new(corners, vec![[0, 1, 2], [0, 2, 3], [1, 3, 2], [0, 3, 1]]).unwrap()
}

fn put(world: &mut World, kind: RigidBody, mesh: u32, at: Vec3, turn: Quat, velocity: Vec3) -> usize {
    world.put(&Body {
        kind,
        linear_velocity: velocity,
        params: BodyParams {
            friction: Friction::new(0.0),
            ..BodyParams::default()
        },
        ..Body::at_rest(mesh, at, turn, Vec3::ONE)
    })
}

/// The distance of a point from an upright sheet of edge 1 at the origin, in the plane x = 0.
fn from_upright(p: DVec3) -> f64 {
    let beyond = |x: f64| (x.abs() - 0.5).max(0.0);
    DVec3::new(p.x, beyond(p.y), beyond(p.z)).length()
}

/// A world with an upright sheet at the origin, in the plane x = 0.
fn upright() -> World {
    let mut world = World::new();
    let card = world.mesh(&card());
    let turn = Quat::from_rotation_z(FRAC_PI_2);
    put(&mut world, RigidBody::Static, card, Vec3::ZERO, turn, Vec3::ZERO);
    world
}

/// A ball falls onto a rim, a little beside it.
pub fn hold_a_ball(x: f32) {
    let mut world = upright();
    let ball = world.mesh(&shapes::ball(0.25, 3));
    let ball = put(
        &mut world,
        RigidBody::Dynamic,
        ball,
        Vec3::new(x, 0.8, 0.0),
        Quat::IDENTITY,
        Vec3::ZERO,
    );
    let mut least = f64::INFINITY;
    for _ in 0..64 {
        world.step();
        least = least.min(from_upright(world.center(ball)));
    }
    assert!(least > 0.24, "{least} at {x}");
}

#[test]
fn a_rim_holds_a_ball() {
    [0.0, 1.0e-3, 0.02].into_iter().for_each(hold_a_ball);
}

/// The triangles of a body.
fn placed(world: &World, body: usize, mesh: &TriMesh) -> Vec<[DVec3; 3]> {
    let frame = &world.state.input.bodies.frame[body];
    let place = |p: Vec3| frame.rotation * p.as_dvec3() + frame.position;
    (0..mesh.triangles().len())
        .map(|t| mesh.corners(t).map(place))
        .collect()
}

/// Whether a segment crosses a triangle.
fn crosses(p: DVec3, q: DVec3, t: &[DVec3; 3]) -> bool {
    let volume = |a: DVec3, b: DVec3| (q - p).dot((a - p).cross(b - p)) > 0.0;
    let normal = (t[1] - t[0]).cross(t[2] - t[0]);
    let sides = [p, q].map(|end| normal.dot(end - t[0]) > 0.0);
    let around = [0, 1, 2].map(|k| volume(t[k], t[(k + 1) % 3]));
    sides[0] != sides[1] && around == [around[0]; 3]
}

/// Whether edges of some triangles cross others.
fn surfaces_cross(some: &[[DVec3; 3]], others: &[[DVec3; 3]]) -> bool {
    let any = |s: &[[DVec3; 3]], t: &[[DVec3; 3]]| {
        let mut pairs = s.iter().flat_map(|s| t.iter().map(move |t| (s, t)));
        pairs.any(|(s, t)| (0..3).any(|k| crosses(s[k], s[(k + 1) % 3], t)))
    };
    any(some, others) || any(others, some)
}

/// Two sheets meet rim to rim, each displaced along the rim and turned.
pub fn meet_rim_to_rim((z, turn): (f32, f32)) {
    let mut world = World::weightless();
    let sheet = card();
    let card = world.mesh(&sheet);
    let [left, right] = [-1.0, 1.0].map(|side: f32| {
        let (at, turn) = (
            Vec3::new(side, 0.0, 0.5 * side * z),
            Quat::from_rotation_z(-side * turn),
        );
        put(&mut world, RigidBody::Dynamic, card, at, turn, Vec3::NEG_X * side)
    });
    for step in 0..128 {
        world.step();
        let [a, b] = [left, right].map(|body| placed(&world, body, &sheet));
        assert!(!surfaces_cross(&a, &b), "step {step}, {z}, {turn}");
    }
    let apart = world.center(right).x - world.center(left).x;
    assert!(turn > 0.0 || apart > 0.99, "{apart}");
}

/// For [`meet_rim_to_rim`].
pub const MEETINGS: [(f32, f32); 5] = [(0.0, 0.0), (0.0, FRAC_PI_6), (0.2, FRAC_PI_6), (0.2, 0.3), (0.2, 1.2)];

#[test]
fn sheets_that_meet_rim_to_rim_do_not_pass() {
    MEETINGS.into_iter().for_each(meet_rim_to_rim);
}

#[test]
fn a_torus_on_a_rim_is_not_cut() {
    hold_a_torus();
}

/// A torus falls onto a rim.
pub fn hold_a_torus() {
    let mut world = upright();
    let torus = shapes::torus(24, 16, 0.35, 0.15);
    let mesh = world.mesh(&torus);
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 1.4, 0.65, 0.2);
    let body = put(
        &mut world,
        RigidBody::Dynamic,
        mesh,
        Vec3::new(0.02, 1.2, 0.01),
        turn,
        Vec3::ZERO,
    );
    let mut deepest = 0.0f64;
    for _ in 0..64 {
        world.step();
        let frame = &world.state.input.bodies.frame[body];
        // The rim's depth below the tube's surface.
        for i in 0..=200 {
            let rim = DVec3::new(0.0, 0.5, f64::from(i) / 200.0 - 0.5);
            let p = frame.rotation.transpose() * (rim - frame.center);
            let around = p.truncate().length() - 0.35;
            deepest = deepest.max(0.15 - around.hypot(p.z));
        }
    }
    assert!(deepest < 0.01, "{deepest}");
}

/// A tetrahedron falls with an edge onto the edge of another one, displaced and turned a little.
pub fn hold_an_edge((aside, turn): (f32, f32)) {
    let mut world = World::new();
    let mesh = world.mesh(&tetrahedron());
    put(
        &mut world,
        RigidBody::Static,
        mesh,
        Vec3::NEG_Y * 0.5,
        Quat::IDENTITY,
        Vec3::ZERO,
    );
    let (at, turn) = (Vec3::new(aside, 0.21, aside), Quat::from_rotation_y(FRAC_PI_2 + turn));
    let body = put(&mut world, RigidBody::Dynamic, mesh, at, turn, Vec3::ZERO);
    // It stands on an edge, and falls off in time. Without contact it would be at 0.19 by now.
    for _ in 0..4 {
        world.step();
    }
    let (height, deepest) = (world.center(body).y, world.deepest());
    assert!(height > 0.2 && deepest < 1.0e-3, "{height}, {deepest} for {aside}");
}

/// For [`hold_an_edge`].
pub const EDGES: [(f32, f32); 5] = [(0.0, 0.0), (1.0e-4, 0.0), (0.0, 1.0e-4), (0.0, 1.0e-3), (1.0e-3, 0.017)];

#[test]
fn an_edge_holds_a_parallel_edge_with_the_same_ends() {
    EDGES.into_iter().for_each(hold_an_edge);
}
