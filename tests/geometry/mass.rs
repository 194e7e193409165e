//! Mass properties against figures known in closed form, and generated shapes against their promises.

use bevy_faceoff::geometry::{MassBasis, MassProperties, Orientation, SHELL_THICKNESS, TriMesh, shapes};
use glam::{Mat3, Vec3};
use proptest::prelude::*;
use std::f32::consts::PI;

fn mapped(mesh: &TriMesh, f: impl Fn(Vec3) -> Vec3) -> TriMesh {
    TriMesh::new(
        mesh.vertices().iter().map(|v| f(*v)).collect(),
        mesh.triangles().to_vec(),
    )
    .unwrap()
}

fn flipped(mesh: &TriMesh) -> TriMesh {
    let faces = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    TriMesh::new(mesh.vertices().to_vec(), faces).unwrap()
}

fn close(a: f32, b: f32, tolerance: f32) {
    assert!((a - b).abs() <= tolerance * b.abs().max(1e-3), "{a} is not {b}");
}

fn moment_close(a: Mat3, b: Mat3, tolerance: f32) {
    let scale = b.x_axis.x.abs() + b.y_axis.y.abs() + b.z_axis.z.abs();
    for i in 0..3 {
        for j in 0..3 {
            assert!(
                (a.col(i)[j] - b.col(i)[j]).abs() <= tolerance * scale,
                "{a:?} is not {b:?}"
            );
        }
    }
}

#[test]
fn a_box() {
    let size = Vec3::new(1.0, 2.0, 4.0);
    let at = Vec3::new(3.0, -2.0, 0.5);
    let m = MassProperties::of(&mapped(&shapes::cube(1.0), |v| v * size + at));
    close(m.volume, 8.0, 1e-6);
    assert!(m.center.distance(at) < 1e-6);
    moment_close(m.second_moment, Mat3::from_diagonal(size * size * (8.0 / 12.0)), 1e-6);
    close(m.thickness, 1.0, 1e-6);
    assert!(!m.approximate);
}

#[test]
fn a_tetrahedron() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
    let m = MassProperties::of(&mesh);
    close(m.volume, 1.0 / 6.0, 1e-6);
    assert!(m.center.distance(Vec3::splat(0.25)) < 1e-6);
    // 1/60 and 1/120 about the corner, less V c c^T.
    let (diagonal, off) = (1.0 / 60.0 - 1.0 / 96.0, 1.0 / 120.0 - 1.0 / 96.0);
    moment_close(
        m.second_moment,
        Mat3::from_cols(
            Vec3::new(diagonal, off, off),
            Vec3::new(off, diagonal, off),
            Vec3::new(off, off, diagonal),
        ),
        1e-6,
    );
}

#[test]
fn a_regular_tetrahedron_is_as_thick_as_its_inscribed_ball() {
    let corners = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]].map(|c| Vec3::from(c.map(|x| x as f32)));
    let mesh = TriMesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]).unwrap();
    // Edge 2 sqrt 2, radius of the inscribed ball edge / (2 sqrt 6).
    close(MassProperties::of(&mesh).thickness, 2.0 / 3.0f32.sqrt(), 1e-5);
}

#[test]
fn a_fine_ball() {
    let m = MassProperties::of(&shapes::ball(2.0, 6));
    let volume = 4.0 / 3.0 * PI * 8.0;
    close(m.volume, volume, 1e-3);
    assert!(m.center.length() < 1e-5);
    moment_close(
        m.second_moment,
        Mat3::from_diagonal(Vec3::splat(volume * 4.0 / 5.0)),
        1e-3,
    );
    close(m.thickness, 4.0, 1e-2);
}

#[test]
fn a_fine_torus() {
    let (major, minor) = (0.7f32, 0.3f32);
    let m = MassProperties::of(&shapes::torus(256, 128, 0.7, 0.3));
    let volume = 2.0 * PI * PI * major * minor * minor;
    close(m.volume, volume, 1e-3);
    assert!(m.center.length() < 1e-6);
    let across = volume * (major * major / 2.0 + 3.0 / 8.0 * minor * minor);
    let along = volume * minor * minor / 4.0;
    moment_close(
        m.second_moment,
        Mat3::from_diagonal(Vec3::new(across, across, along)),
        1e-3,
    );
    close(m.thickness, 0.6, 1e-2);
}

#[test]
fn a_distant_mesh_keeps_its_digits() {
    let here = MassProperties::of(&shapes::knot_1120());
    // Coordinates at 4096 are rounded to 1/2048 or so; the figures may not be worse than that.
    let there = MassProperties::of(&mapped(&shapes::knot_1120(), |v| v * 64.0 + 4096.0));
    let cube = 64.0f32.powi(3);
    close(there.volume, here.volume * cube, 1e-4);
    assert!(there.center.distance(here.center * 64.0 + 4096.0) < 1e-3);
    moment_close(there.second_moment, here.second_moment * (cube * 4096.0), 1e-4);
    close(there.thickness, here.thickness * 64.0, 1e-3);
}

#[test]
fn a_room_weighs_what_a_solid_of_its_inside_does() {
    for mesh in [shapes::torus_240(), shapes::cube(1.0), shapes::knot_1120()] {
        let room = flipped(&mesh);
        assert_eq!(room.orientation(), Orientation::Inward);
        let (own, solid) = (MassProperties::of(&room), MassProperties::of(&mesh));
        assert!(own.approximate && !solid.approximate);
        assert!(own.thickness > 0.0 && own.thickness.is_finite());
        let figures = |m: MassProperties| (m.volume, m.center, m.second_moment);
        assert_eq!(figures(own), figures(solid));
        assert_eq!(MassProperties::of(&room.flipped()), solid);
    }
}

/// A room's walls have no outside; what stands in it is as thick as it is.
#[test]
fn a_room_with_a_ball_in_it_is_as_thick_as_the_ball() {
    let (walls, ball) = (flipped(&shapes::cube(4.0)), shapes::ball(0.5, 3));
    let n = walls.vertices().len() as u32;
    let vertices = walls.vertices().iter().chain(ball.vertices()).copied().collect();
    let faces = ball.triangles().iter().map(|t| t.map(|v| v + n));
    let mesh = TriMesh::new(vertices, walls.triangles().iter().copied().chain(faces).collect()).unwrap();
    assert_eq!(mesh.orientation(), Orientation::Inward);
    let m = MassProperties::of(&mesh);
    close(m.thickness, 1.0, 2e-2);
    close(m.volume, 64.0 - 4.0 / 3.0 * PI / 8.0, 1e-3);
}

#[test]
fn a_hollow_ball_is_as_thick_as_its_wall() {
    let (outer, inner) = (shapes::ball(1.0, 4), shapes::ball(0.9, 4));
    let n = outer.vertices().len() as u32;
    let mut vertices = outer.vertices().to_vec();
    vertices.extend(inner.vertices());
    let mut faces = outer.triangles().to_vec();
    faces.extend(inner.triangles().iter().map(|&[a, b, c]| [a + n, c + n, b + n]));
    let mesh = TriMesh::new(vertices, faces).unwrap();
    let m = MassProperties::of(&mesh);
    close(m.volume, 4.0 / 3.0 * PI * (1.0 - 0.729), 1e-2);
    close(m.thickness, 0.1, 3e-2);
}

#[test]
fn a_thin_plate_with_a_fine_rim_is_thin() {
    let m = MassProperties::of(&mapped(&shapes::torus(64, 32, 0.7, 0.3), |v| {
        v * Vec3::new(1.0, 1.0, 0.05)
    }));
    assert!(m.thickness < 0.6 * 0.05 * 1.01, "{}", m.thickness);
    assert!(
        m.thickness > 0.05 * 0.08,
        "the rim alone does not decide: {}",
        m.thickness
    );
}

/// Sheets weigh what a shell along them does; a closed one that encloses nothing weighs its box.
#[test]
fn meshes_without_volume_weigh_a_shell_or_their_box() {
    let sheet = |faces: Vec<[u32; 3]>| {
        TriMesh::new(
            vec![Vec3::ZERO, Vec3::X * 2.0, Vec3::new(2.0, 1.0, 0.0), Vec3::Y],
            faces,
        )
        .unwrap()
    };
    let open = sheet(vec![[0, 1, 2], [0, 2, 3]]);
    let two_sided = sheet(vec![[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]]);
    let diagonal = 5.0f32.sqrt();
    for (mesh, shell, basis, volume) in [
        (&open, SHELL_THICKNESS, MassBasis::Shell, 2.0 * 0.01 * diagonal),
        (&open, 0.1, MassBasis::Shell, 2.0 * 0.1 * diagonal),
        (&two_sided, SHELL_THICKNESS, MassBasis::Box, 2.0 * 1.0 * 0.02),
    ] {
        let m = MassProperties::with_shell(mesh, shell);
        assert!(m.approximate && m.error == 1.0);
        assert_eq!(m.basis, basis);
        close(m.volume, volume, 1e-6);
        close(m.thickness, 0.02, 1e-6);
        assert!(m.center.distance(Vec3::new(1.0, 0.5, 0.0)) < 1e-6);
        close(m.second_moment.x_axis.x, volume * 4.0 / 12.0, 1e-6);
        if basis == MassBasis::Shell {
            let thickness = shell * diagonal;
            close(m.second_moment.z_axis.z / volume, thickness * thickness / 12.0, 1e-4);
        }
    }
}

/// Its opening is flat, so that what it holds is known.
#[test]
fn a_box_without_a_lid_weighs_what_it_holds() {
    let cube = mapped(&shapes::cube(1.0), |v| v * Vec3::new(1.0, 2.0, 1.0) + Vec3::splat(3.0));
    let is_lid = |t: &[u32; 3]| t.iter().all(|&v| cube.vertices()[v as usize].y > 4.0 - 1e-3);
    for flip in [false, true] {
        let faces = cube.triangles().iter().copied().filter(|t| !is_lid(t));
        let faces: Vec<[u32; 3]> = faces
            .map(|[a, b, c]| if flip { [a, c, b] } else { [a, b, c] })
            .collect();
        assert_eq!(faces.len(), 10);
        let m = MassProperties::of(&TriMesh::new(cube.vertices().to_vec(), faces).unwrap());
        assert!(m.approximate && m.error > 0.0 && m.error < 0.2, "{m:?}");
        assert_eq!(m.basis, MassBasis::Capped);
        close(m.volume, 2.0, 1e-6);
        assert!(m.center.distance(Vec3::splat(3.0)) < 1e-6, "{}", m.center);
        moment_close(
            m.second_moment,
            Mat3::from_diagonal(Vec3::new(1.0, 4.0, 1.0) * (2.0 / 12.0)),
            1e-5,
        );
    }
}

/// Half a ball is too wide open for that, and so are walls that do not hang together: the winding number tells where
/// they are solid.
#[test]
fn what_is_wide_open_weighs_where_its_winding_number_exceeds_a_half() {
    let ball = shapes::ball(1.0, 4);
    let upper = |t: &&[u32; 3]| t.iter().all(|&v| ball.vertices()[v as usize].z >= -1e-6);
    let half = TriMesh::new(
        ball.vertices().to_vec(),
        ball.triangles().iter().filter(upper).copied().collect(),
    );
    // A box of six walls, each a little apart from the others.
    let cube = shapes::cube(2.0);
    let corners = (0..12).flat_map(|t| {
        let [a, b, c] = cube.corners(t);
        let way = (b - a).cross(c - a).normalize();
        [a, b, c].map(|p| p + way * 0.02)
    });
    let walls = TriMesh::new(
        corners.collect(),
        (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    );
    let height = 3.0 / 8.0;
    for (name, mesh, volume, center) in [
        ("half a ball", half.unwrap(), 2.0 / 3.0 * PI, Vec3::Z * height),
        ("walls", walls.unwrap(), 2.04f32.powi(3), Vec3::ZERO),
    ] {
        let m = MassProperties::of(&mesh);
        println!("{name}: {m:?}");
        assert_eq!(m.basis, MassBasis::Winding, "{name}");
        assert!((m.volume / volume - 1.0).abs() < 0.06, "{name}: {} {volume}", m.volume);
        assert!((m.volume / volume - 1.0).abs() < m.error, "{name}: {}", m.error);
        assert!(m.center.distance(center) < 0.05, "{name}: {}", m.center);
        let diagonal = [0, 1, 2].map(|axis| m.second_moment.col(axis)[axis]);
        let ball = volume / 5.0;
        let expected = match name {
            "walls" => [volume * 2.04 * 2.04 / 12.0; 3],
            _ => [ball, ball, volume * (1.0 / 5.0 - height * height)],
        };
        for (found, expected) in diagonal.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 0.12, "{name}: {found} {expected}");
        }
    }
}

/// Below the middle of a hilly landscape the winding number barely exceeds a half.
#[test]
fn a_landscape_weighs_a_shell() {
    let n = 20u32;
    let at = |i: u32, j: u32| {
        let (x, y) = (i as f32, j as f32);
        Vec3::new(x, y, (0.9 * x).sin() * 1.5 + (0.7 * y).cos() * 1.5)
    };
    let vertices = (0..=n).flat_map(|i| (0..=n).map(move |j| at(i, j))).collect();
    let quads = (0..n).flat_map(|i| (0..n).map(move |j| i * (n + 1) + j));
    let faces = quads
        .flat_map(|v| [[v, v + n + 1, v + 1], [v + 1, v + n + 1, v + n + 2]])
        .collect();
    let m = MassProperties::of(&TriMesh::new(vertices, faces).unwrap());
    assert_eq!(m.basis, MassBasis::Shell, "{m:?}");
    assert!(m.center.distance(Vec3::new(10.0, 10.0, 0.0)) < 1.0, "{}", m.center);
}

#[test]
fn extreme_sizes_stay_finite() {
    for size in [1e-30f32, 1e-12, 1e9] {
        let m = MassProperties::of(&mapped(&shapes::cube(1.0), |v| v * size));
        finite(&m);
    }
}

#[test]
fn a_million_triangles_take_seconds_at_most() {
    let mesh = shapes::torus(1000, 500, 0.7, 0.3);
    let start = std::time::Instant::now();
    let m = MassProperties::of(&mesh);
    close(m.thickness, 0.6, 1e-2);
    eprintln!("mass of {} triangles: {:?}", mesh.triangles().len(), start.elapsed());
    // The worst order there is: neighbours in the list lie anywhere.
    let n = mesh.triangles().len() as u64;
    let order: Vec<u32> = (0..n).map(|i| (i * 618_033_989 % n) as u32).collect();
    let start = std::time::Instant::now();
    close(MassProperties::of(&mesh.reordered(&order)).thickness, 0.6, 1e-2);
    eprintln!("in scattered order: {:?}", start.elapsed());
    assert!(start.elapsed().as_secs() < 60);
}

fn finite(m: &MassProperties) {
    assert!(m.volume.is_finite() && m.volume > 0.0);
    assert!(m.center.is_finite());
    assert!(m.second_moment.is_finite());
    assert!(m.second_moment.x_axis.x > 0.0 && m.second_moment.y_axis.y > 0.0 && m.second_moment.z_axis.z > 0.0);
    assert!(m.thickness.is_finite() && m.thickness > 0.0);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    #[test]
    fn any_soup_has_finite_figures(
        points in proptest::collection::vec(proptest::array::uniform3(-1e3f32..1e3), 4..20),
        picks in proptest::collection::vec(proptest::array::uniform3(0u32..1000), 1..40),
    ) {
        let n = points.len() as u32;
        let faces = picks.iter().map(|t| t.map(|i| i % n)).collect();
        if let Ok(mesh) = TriMesh::new(points.into_iter().map(Vec3::from).collect(), faces) {
            finite(&MassProperties::of(&mesh));
        }
    }
}

#[test]
fn shapes_keep_their_promises() {
    for (mesh, triangles) in [
        (shapes::torus_240(), 240),
        (shapes::knot_1120(), 1120),
        (shapes::ring(), 384),
        (shapes::ball_320(), 320),
    ] {
        assert_eq!(mesh.triangles().len(), triangles);
        assert_eq!(mesh.dropped(), 0);
        assert_eq!(mesh.orientation(), Orientation::Outward);
        assert_eq!(mesh.component_vertices().len(), 1);
        let middle = mesh.aabb().center();
        assert!(middle.length() < 2e-6);
        let reach = mesh.used_positions().map(|p| p.distance(middle)).fold(0.0, f32::max);
        close(reach, 0.5, 5e-6);
    }
    for mesh in [
        shapes::cube(2.0),
        shapes::ball(1.5, 0),
        shapes::torus(3, 3, 1.0, 0.3),
        shapes::torus_knot(3, 2, 90, 6, 0.2),
    ] {
        assert_eq!(mesh.orientation(), Orientation::Outward);
    }
    assert_eq!(shapes::ball(1.0, 3).triangles().len(), 1280);
}

#[test]
fn rings_fit_through_each_other() {
    let reach = shapes::ring()
        .used_positions()
        .map(|p| p.truncate().length())
        .fold(f32::MAX, f32::min);
    let tube = shapes::ring().aabb().half_size().z;
    assert!(reach > 2.0 * tube, "hole {reach}, tube {tube}");
}

#[test]
fn the_knot_is_one_tube_that_nowhere_touches_itself() {
    let m = MassProperties::of(&shapes::knot_1120());
    let mesh = shapes::knot_1120();
    // Sections that are far apart along the curve keep their distance in space.
    let sections: Vec<Vec3> = mesh
        .vertices()
        .chunks(10)
        .map(|s| s.iter().sum::<Vec3>() / 10.0)
        .collect();
    let n = sections.len();
    for i in 0..n {
        for j in 0..n {
            let along = (i as i32 - j as i32)
                .rem_euclid(n as i32)
                .min((j as i32 - i as i32).rem_euclid(n as i32));
            if along > 8 {
                assert!(sections[i].distance(sections[j]) > m.thickness, "{i} {j}");
            }
        }
    }
}
