//! A ball slides over a floor as CAD programs write it: its top is two rectangles, and the second has a vertex in the
//! middle of their common edge, which the first does not have. A face of zero area fills the T-junction, or nothing
//! does. Theory: the floor is flat.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// A block of 8 m, 1 m thick, with the common edge at x = 0. `filled`: with the face of zero area.
fn floor(filled: bool) -> TriMesh {
    let corners = [
        // Below.
        [-4.0, -1.0, -4.0],
        [4.0, -1.0, -4.0],
        [4.0, -1.0, 4.0],
        [-4.0, -1.0, 4.0],
        // Above.
        [-4.0, 0.0, -4.0],
        [4.0, 0.0, -4.0],
        [4.0, 0.0, 4.0],
        [-4.0, 0.0, 4.0],
        // The common edge, and the vertex in it.
        [0.0, 0.0, -4.0],
        [0.0, 0.0, 4.0],
        [0.0, 0.0, 0.3],
    ];
    let below = [[0, 1, 2], [0, 2, 3]];
    let left = [[4, 7, 9], [4, 9, 8]];
    let zero_area = &[[8, 9, 10]][..usize::from(filled)];
    let right = [[8, 10, 5], [10, 6, 5], [10, 9, 6]];
    let front_and_back = [[0, 4, 8], [0, 8, 1], [8, 5, 1], [3, 2, 9], [2, 6, 9], [3, 9, 7]];
    let sides = [[0, 3, 7], [0, 7, 4], [1, 5, 6], [1, 6, 2]];
    let faces = [&below[..], &left, zero_area, &right, &front_and_back, &sides];
    TriMesh::new(corners.map(Vec3::from_array).to_vec(), faces.concat()).unwrap()
}

pub fn a_ball_does_not_feel_it(backend: Backend) {
    slides_over(&floor(true), backend);
}

pub fn a_ball_does_not_feel_one_that_nothing_fills(backend: Backend) {
    slides_over(&floor(false), backend);
}

fn slides_over(floor: &TriMesh, backend: Backend) {
    let mut game = Game::new(backend);
    let (floor, ball) = (game.mesh(floor), game.mesh(&shapes::ball(0.25, 4)));
    game.spawn((floor, Friction::new(0.0)));
    let ball = game.spawn((
        body(&ball, Transform::from_xyz(-1.0, 0.2505, 0.1)),
        Friction::new(0.0),
        LinearVelocity(2.0 * Vec3::X),
    ));
    for _ in 0..16 {
        game.seconds(1.0 / 16.0);
        let velocity = game.velocity(ball);
        check("along the floor, m/s", velocity.x, 1.999..=2.001);
        check("up, m/s", velocity.y, -0.01..=0.01);
    }
    check("where, m", game.position(ball).x, 0.9..=1.1);
}
