//! An open sheet on a ball. Theory: it rocks, loses its energy to friction and impacts, and rests.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// A square of so many cells each way, of edge 1, in the plane y = 0.
fn sheet(cells: u32) -> TriMesh {
    let side = cells + 1;
    let place = |i: u32| i as f32 / cells as f32 - 0.5;
    let vertices = (0..side * side).map(|i| Vec3::new(place(i % side), 0.0, place(i / side)));
    let faces = (0..cells * cells).flat_map(|i| {
        let a = i / cells * side + i % cells;
        let [b, c, d] = [a + 1, a + side, a + side + 1];
        [[a, c, b], [b, c, d]]
    });
    TriMesh::new(vertices.collect(), faces.collect()).unwrap()
}

pub fn an_open_sheet_on_a_ball_comes_to_rest(backend: Backend) {
    let mut game = Game::new(backend);
    let (ball, sheet) = (game.mesh(&shapes::ball(0.5, 3)), game.mesh(&sheet(8)));
    game.spawn((ball, Transform::from_xyz(0.0, -0.5, 0.0)));
    let tilt = Quat::from_rotation_z(0.1);
    let sheet = game.spawn((
        body(&sheet, Transform::from_xyz(0.0, 0.02, 0.0).with_rotation(tilt)),
        Mass(1.0),
    ));
    game.seconds(20.0);
    check("height, m", game.position(sheet).y, 0.0..=0.03);
    check("spin, rad/s", game.spin(sheet).length(), 0.0..=0.001);
    check("asleep", f32::from(u8::from(game.sleeps(sheet))), 1.0..=1.0);
}
