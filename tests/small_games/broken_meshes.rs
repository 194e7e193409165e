//! Meshes as they come: cracks, missing faces, any winding, several shells. Theory: they do what clean ones do. And a
//! box without a lid, which is open on purpose.

use crate::game::{Game, body, check};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

fn mesh(vertices: Vec<Vec3>, faces: Vec<[u32; 3]>) -> TriMesh {
    TriMesh::new(vertices, faces).unwrap()
}

fn random(i: usize) -> u32 {
    (i as u32 + 1)
        .wrapping_mul(2_654_435_761)
        .rotate_left(13)
        .wrapping_mul(0x9e37_79b9)
        % 100
}

/// Some of the faces wound the other way.
fn wound_at_random(clean: &TriMesh) -> TriMesh {
    let faces = clean.triangles().iter().enumerate();
    let faces = faces.map(|(i, &[a, b, c])| if random(i) < 40 { [a, c, b] } else { [a, b, c] });
    mesh(clean.vertices().to_vec(), faces.collect())
}

/// Corners of their own for each face, moved by a ten-millionth of the size.
fn torn(clean: &TriMesh) -> TriMesh {
    let shift = |i: usize| (random(i) as f32 / 100.0 - 0.5) * 1e-7;
    let corners = (0..clean.triangles().len()).flat_map(|t| clean.corners(t)).enumerate();
    let vertices: Vec<Vec3> = corners
        .map(|(i, p)| p + Vec3::new(shift(3 * i), shift(3 * i + 1), shift(3 * i + 2)))
        .collect();
    let faces = (0..vertices.len() as u32 / 3)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    mesh(vertices, faces)
}

/// A twentieth of the faces are missing, but none for which `keep` holds.
fn punctured(clean: &TriMesh, keep: impl Fn([Vec3; 3]) -> bool) -> TriMesh {
    let stays = |&t: &usize| random(t) >= 5 || keep(clean.corners(t));
    let faces = (0..clean.triangles().len()).filter(stays).map(|t| clean.triangles()[t]);
    mesh(clean.vertices().to_vec(), faces.collect())
}

/// Without the face above a point.
fn punctured_above(clean: &TriMesh, at: Vec2) -> TriMesh {
    let is_above = |corners: [Vec3; 3]| {
        let [a, b, c] = corners.map(|p| p.truncate() - at);
        let sides = [a.perp_dot(b), b.perp_dot(c), c.perp_dot(a)];
        corners[0].z > 0.0 && (sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0))
    };
    let faces: Vec<usize> = (0..clean.triangles().len())
        .filter(|&t| !is_above(clean.corners(t)))
        .collect();
    assert_eq!(faces.len(), clean.triangles().len() - 1);
    mesh(
        clean.vertices().to_vec(),
        faces.into_iter().map(|t| clean.triangles()[t]).collect(),
    )
}

/// With a cavity whose faces are wound like those outside, at random.
fn hollow(clean: &TriMesh) -> TriMesh {
    let outer = wound_at_random(clean);
    let first = outer.vertices().len() as u32;
    let vertices = outer
        .vertices()
        .iter()
        .copied()
        .chain(clean.vertices().iter().map(|p| *p * 0.5));
    let inner = outer.triangles().iter().map(|t| t.map(|v| v + first));
    mesh(
        vertices.collect(),
        outer.triangles().iter().copied().chain(inner).collect(),
    )
}

/// The clean mesh and broken ones of the same outside.
fn variants(clean: &TriMesh, keep: impl Fn([Vec3; 3]) -> bool) -> Vec<(&'static str, TriMesh)> {
    vec![
        ("clean", clean.clone()),
        ("wound at random", wound_at_random(clean)),
        ("torn", torn(clean)),
        ("punctured", punctured(clean, keep)),
        ("hollow", hollow(clean)),
    ]
}

/// A plate on four feet, so that it rests in one way only.
fn table() -> TriMesh {
    let cube = shapes::cube(1.0);
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for (size, at) in [
        (Vec3::new(1.0, 0.1, 1.0), Vec3::Y * 0.35),
        (Vec3::new(0.1, 0.3, 0.1), Vec3::new(0.4, 0.15, 0.4)),
        (Vec3::new(0.1, 0.3, 0.1), Vec3::new(-0.4, 0.15, 0.4)),
        (Vec3::new(0.1, 0.3, 0.1), Vec3::new(0.4, 0.15, -0.4)),
        (Vec3::new(0.1, 0.3, 0.1), Vec3::new(-0.4, 0.15, -0.4)),
    ] {
        let first = vertices.len() as u32;
        vertices.extend(cube.vertices().iter().map(|p| *p * size + at));
        faces.extend(cube.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    mesh(vertices, faces)
}

pub fn they_rest_as_clean_ones_do(backend: Backend) {
    // Five shells side by side that touch each other.
    let table = table();
    for (name, mesh) in [
        ("clean", table.clone()),
        ("wound at random", wound_at_random(&table)),
        ("torn", torn(&table)),
    ] {
        let mut game = Game::new(backend);
        let cube = game.mesh(&shapes::cube(1.0));
        game.slab(&cube, 0.2);
        let mesh = game.mesh(&mesh);
        let table = game.spawn(body(&mesh, Transform::from_xyz(0.0, 0.05, 0.0)));
        game.seconds(2.0);
        check(format!("{name}: height, m"), game.position(table).y, -0.001..=0.003);
        check(
            format!("{name}: asleep"),
            f32::from(u8::from(game.sleeps(table))),
            1.0..=1.0,
        );
    }
    // A ball; its lowest faces are there.
    let ball = shapes::ball(0.5, 2);
    for (name, mesh) in variants(&ball, |corners| corners.iter().any(|p| p.y < -0.4)) {
        let mut game = Game::new(backend);
        game.plane();
        let mesh = game.mesh(&mesh);
        let ball = game.spawn(body(&mesh, Transform::from_xyz(0.0, 0.55, 0.0)));
        game.seconds(2.0);
        check(format!("{name}: height, m"), game.position(ball).y, 0.46..=0.502);
        check(format!("{name}: speed, m/s"), game.velocity(ball).length(), 0.0..=0.01);
    }
}

/// A small ball falls on the crown of a larger one that stands still, a little beside the middle.
pub fn they_push_as_clean_ones_do(backend: Backend) {
    let large = shapes::ball(1.0, 3);
    let mut clean = None;
    for (name, mesh) in variants(&large, |corners| corners.iter().any(|p| p.y > 0.5)) {
        let mut game = Game::new(backend);
        let (large, small) = (game.mesh(&mesh), game.mesh(&shapes::ball(0.2, 3)));
        game.spawn((RigidBody::Static, large, Transform::IDENTITY));
        let ball = game.spawn((body(&small, Transform::from_xyz(0.08, 1.3, 0.03)), Friction::new(0.0)));
        game.seconds(0.75);
        let clean = *clean.get_or_insert(game.position(ball));
        check(
            format!("{name}: from where the clean one is, m"),
            game.position(ball).distance(clean),
            0.0..=0.02,
        );
        check(format!("{name}: to the side, m"), game.position(ball).x, 0.15..=2.0);
    }
}

/// A small ball inside a larger one is pushed out; the larger one gives way, as it is free.
pub fn they_contain_as_clean_ones_do(backend: Backend) {
    let large = shapes::ball(1.0, 2);
    // The face straight above the small ball is missing: rays go along z.
    let above = punctured_above(&large, Vec2::new(0.5, 0.1));
    for (name, mesh) in variants(&large, |_| false).into_iter().chain([("open above", above)]) {
        let in_cavity = name == "hollow";
        let mut game = Game::new(backend).without_gravity();
        let (large, small) = (game.mesh(&mesh), game.mesh(&shapes::ball(0.02, 1)));
        let outer = game.spawn((RigidBody::Static, large, Transform::IDENTITY));
        let free = game.spawn(body(&small, Transform::from_xyz(-0.2, 0.1, 0.05)));
        let place = if in_cavity { 0.75 } else { 0.5 };
        let inner = game.spawn(body(&small, Transform::from_xyz(place, 0.1, 0.05)));
        game.steps(1);
        // What is in the cavity is free, and else another one inside.
        let is_free = game.world().resource::<Collisions>().get(outer, free).is_none();
        check(
            format!("{name}: is free"),
            f32::from(u8::from(is_free)),
            f32::from(u8::from(in_cavity))..=f32::from(u8::from(in_cavity)),
        );
        let touches = game.world().resource::<Collisions>().get(outer, inner).is_some();
        check(format!("{name}: touches"), f32::from(u8::from(touches)), 1.0..=1.0);
        game.seconds(3.0);
        check(
            format!("{name}: from the middle, m"),
            game.position(inner).length(),
            0.97..=10.0,
        );
    }
}

/// Its faces are thin, and those at its bottom look like those of a solid. But what lies in it must stay in it.
pub fn a_box_without_a_lid_holds_balls(backend: Backend) {
    let cube = shapes::cube(2.0);
    let faces = (0..12).filter(|&t| !cube.corners(t).iter().all(|p| p.y > 0.9));
    let open = mesh(cube.vertices().to_vec(), faces.map(|t| cube.triangles()[t]).collect());
    let mut game = Game::new(backend);
    let (open, ball) = (game.mesh(&open), game.mesh(&shapes::ball(0.2, 2)));
    game.spawn((RigidBody::Static, open, Transform::IDENTITY));
    let balls: Vec<Entity> = (0..4)
        .map(|i| {
            let place = Vec3::new(
                (i % 2) as f32 * 0.6 - 0.3,
                -0.5 + 0.1 * i as f32,
                (i / 2) as f32 * 0.6 - 0.3,
            );
            game.spawn(body(&ball, Transform::from_translation(place)))
        })
        .collect();
    game.seconds(3.0);
    for ball in balls {
        let at = game.position(ball);
        check("height, m", at.y, -0.82..=-0.75);
        check("beside the middle, m", at.x.abs().max(at.z.abs()), 0.0..=0.81);
    }
}
