//! Open meshes: small openings count as closed, cracks and T-junctions as nothing, and large openings stay open.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::asset::format::{from_bytes, to_bytes};
use bevy_faceoff::geometry::{DefectKind, MassBasis, OneSided, Orientation, TriMesh, shapes};
use bevy_faceoff::queries::Placed;
use glam::{DQuat, DVec3, Vec3, Vec3Swizzles};

/// A mesh without some of its faces.
fn without(mesh: &TriMesh, is_missing: impl Fn(usize) -> bool) -> TriMesh {
    let faces = (0..mesh.triangles().len())
        .filter(|&t| !is_missing(t))
        .map(|t| mesh.triangles()[t]);
    TriMesh::new(mesh.vertices().to_vec(), faces.collect()).unwrap()
}

fn contains(baked: &CollisionMesh, p: Vec3) -> bool {
    let placed = Placed::new(baked, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    placed.closest_point(p.as_dvec3(), f64::INFINITY).unwrap().is_inside
}

fn random(i: usize) -> u32 {
    (i as u32 + 1)
        .wrapping_mul(2_654_435_761)
        .rotate_left(13)
        .wrapping_mul(0x9e37_79b9)
        % 100
}

/// An opening counts as closed up to a fiftieth of the area that is left, and all of them up to a fifth. The openings
/// are around corners of an icosahedron.
#[test]
fn openings_count_as_closed_up_to_a_fiftieth_each_and_a_fifth_together() {
    let ball = shapes::ball(1.0, 4);
    let golden = 0.5 * (1.0 + 5f32.sqrt());
    let corners: Vec<Vec3> = (0..12)
        .map(|i| {
            let sign = |bit: usize| if i >> bit & 1 == 1 { -1.0 } else { 1.0 };
            let corner = Vec3::new(0.0, sign(0), sign(1) * golden).normalize();
            [corner, corner.yzx(), corner.zxy()][i / 4]
        })
        .collect();
    for (count, share, is_solid) in [
        (1, 0.0175, true),
        (1, 0.023, false),
        (10, 0.0155, true),
        (12, 0.016, false),
    ] {
        let is_missing = |t: usize| {
            let middle = ball.corners(t).into_iter().sum::<Vec3>().normalize();
            corners[..count]
                .iter()
                .any(|corner| corner.dot(middle) > 1.0 - 2.0 * share)
        };
        let mesh = without(&ball, is_missing);
        let missing = 1.0 - mesh.triangles().len() as f32 / ball.triangles().len() as f32;
        assert_eq!(
            mesh.is_solid(),
            is_solid,
            "{count} openings of {share}: {missing} is missing"
        );
    }
}

/// Random faces, one hole of the same area, and the same with random winding.
#[test]
fn a_ball_without_a_twentieth_of_its_faces_weighs_what_a_whole_one_does() {
    let ball = shapes::ball(1.0, 3);
    let clean = CollisionMesh::new(&ball);
    let below = |t: usize| ball.corners(t).iter().map(|p| p.y).sum::<f32>() / 3.0 < -0.905;
    for (name, mesh) in [
        ("random faces", without(&ball, |t| random(t) < 5)),
        ("one hole", without(&ball, below)),
        ("wound at random", {
            let open = without(&ball, |t| random(t) < 5);
            let faces = (0..)
                .zip(open.triangles())
                .map(|(t, &[a, b, c])| if random(t * 7) < 50 { [a, c, b] } else { [a, b, c] });
            TriMesh::new(open.vertices().to_vec(), faces.collect()).unwrap()
        }),
    ] {
        let missing = ball.triangles().len() - mesh.triangles().len();
        assert!((45..90).contains(&missing), "{missing} faces");
        let baked = CollisionMesh::new(&mesh);
        let (mass, whole) = (&baked.mass, &clean.mass);
        println!("{name}: {missing} faces, {mass:?}");
        assert_eq!(baked.mesh.orientation(), Orientation::Open);
        assert!(
            (mass.volume / whole.volume - 1.0).abs() < 0.03,
            "{name}: {}",
            mass.volume
        );
        assert!(mass.center.length() < 0.01, "{name}: {}", mass.center);
        assert!(mass.approximate && mass.error > 0.0 && mass.error < 0.1);
        assert!((mass.volume / whole.volume - 1.0).abs() <= mass.error, "{name}");
        for axis in 0..3 {
            let ratio = mass.second_moment.col(axis)[axis] / whole.second_moment.col(axis)[axis];
            assert!((ratio - 1.0).abs() < 0.05, "{name}: {ratio}");
        }
        if name == "one hole" {
            // Something could fall through it.
            assert_eq!(mass.basis, MassBasis::Capped);
            assert!(!baked.mesh.is_solid() && baked.one_sided == OneSided::None);
            assert!(
                baked.warnings()[0].contains("the mesh is open"),
                "{:?}",
                baked.warnings()
            );
        } else {
            assert_eq!(mass.basis, MassBasis::Capped);
            assert!((mass.thickness / whole.thickness - 1.0).abs() < 0.05);
            assert!(baked.mesh.is_solid() && contains(&baked, Vec3::splat(0.3)) && !contains(&baked, Vec3::splat(0.7)));
            let one_sided = (0..mesh.triangles().len()).filter(|&t| baked.one_sided.is(t)).count();
            assert!(one_sided * 10 > mesh.triangles().len() * 9, "{name}: {one_sided}");
            let told = baked.warnings().join("; ");
            assert!(told.contains("small openings"), "{told}");
        }
        let (read, _) = from_bytes(&to_bytes(&baked, [0; 32])).unwrap();
        assert!(read == baked && read.one_sided == baked.one_sided);
        assert_eq!(read.mesh.caps(), baked.mesh.caps());
    }
}

/// Rays from inside meet the caps where faces are missing.
#[test]
fn points_near_an_opening_are_inside_up_to_its_cap() {
    let ball = shapes::ball(1.0, 3);
    let first = ball.corners(0);
    let middle = first.iter().sum::<Vec3>() / 3.0;
    let baked = CollisionMesh::new(&without(&ball, |t| t == 0));
    assert_eq!(baked.mesh.caps().len(), 3);
    for (scale, is_inside) in [
        (0.0, true),
        (0.5, true),
        (0.99, true),
        (0.999, true),
        (1.001, false),
        (1.1, false),
    ] {
        assert_eq!(contains(&baked, middle * scale), is_inside, "{scale}");
    }
    // Containment casts its rays along z: from below each of the faces' middles.
    for t in 0..ball.triangles().len() {
        let baked = (t % 16 == 0).then(|| CollisionMesh::new(&without(&ball, |other| other == t)));
        let Some(baked) = baked else { continue };
        let middle = ball.corners(t).iter().sum::<Vec3>() / 3.0;
        for below in [0.02, 0.2] {
            let (inside, outside) = (middle * (1.0 - below), middle * (1.0 + below));
            assert!(contains(&baked, inside) && !contains(&baked, outside), "face {t}");
        }
    }
}

/// A box of six plates whose edges are split differently: closed but for T-junctions.
fn plates(split: u32) -> TriMesh {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for axis in 0..3usize {
        for side in [0.0f32, 1.0] {
            // Plates have a different number of parts along each axis.
            let n = split + axis as u32 * 2 + (side as u32);
            let first = vertices.len() as u32;
            let at = |i: u32, j: u32| {
                let mut p = [0.0; 3];
                p[axis] = side;
                p[(axis + 1) % 3] = i as f32 / n as f32;
                p[(axis + 2) % 3] = j as f32 / n as f32;
                Vec3::from_array(p)
            };
            vertices.extend((0..=n).flat_map(|i| (0..=n).map(move |j| at(i, j))));
            for i in 0..n {
                for j in 0..n {
                    let v = first + i * (n + 1) + j;
                    let two = [[v, v + n + 1, v + 1], [v + 1, v + n + 1, v + n + 2]];
                    faces.extend(two.map(|[a, b, c]| if side > 0.5 { [a, b, c] } else { [a, c, b] }));
                }
            }
        }
    }
    TriMesh::new(vertices, faces).unwrap()
}

#[test]
fn t_junctions_are_told_and_change_nothing() {
    for split in 1..4 {
        let baked = CollisionMesh::new(&plates(split));
        assert_eq!(baked.mesh.orientation(), Orientation::Open);
        let defects = baked.mesh.defects();
        assert!(defects.count(DefectKind::TJunction) > 10 && defects.count(DefectKind::Opening) == 0);
        assert!(defects.largest_opening == 0.0 && !baked.mesh.caps().is_empty());
        assert!(
            baked.mesh.is_solid() && baked.one_sided == OneSided::All,
            "{:?}",
            baked.one_sided
        );
        assert!(
            (baked.mass.volume - 1.0).abs() < 1e-6 && !baked.mass.approximate,
            "{:?}",
            baked.mass
        );
        assert!(baked.warnings().is_empty(), "{:?}", baked.warnings());
        for i in 0..500 {
            let at = |k: f32| (i as f32 * k).fract() * 1.4 - 0.2;
            let p = Vec3::new(at(0.618), at(0.754_87), at(0.569_84));
            let is_inside = p.cmpgt(Vec3::ZERO).all() && p.cmplt(Vec3::ONE).all();
            assert_eq!(contains(&baked, p), is_inside, "{p}");
        }
    }
}

/// A cube whose upper face is split in the middle of none of its sides, while its neighbours are, off by this much: a
/// crack at each of so many of the sides. Neighbours share a corner.
fn cracked_cube(cracks: usize, off: f32) -> TriMesh {
    let mut vertices: Vec<Vec3> = (0..8)
        .map(|i| {
            Vec3::new(
                [-0.5, 0.5, 0.5, -0.5][i % 4],
                [-0.5, -0.5, 0.5, 0.5][i % 4],
                i as f32 / 4.0,
            )
        })
        .collect();
    vertices.iter_mut().for_each(|v| v.z = v.z.floor() - 0.5);
    let mut faces = vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]];
    for side in 0..4u32 {
        let (a, b) = (side, (side + 1) % 4);
        if (side as usize) < cracks {
            let middle = 0.5 * (vertices[a as usize + 4] + vertices[b as usize + 4]);
            vertices.push(middle + (middle.with_z(0.0)).normalize() * off);
            let middle = vertices.len() as u32 - 1;
            faces.extend([[a, middle, a + 4], [a, b, middle], [b, b + 4, middle]]);
        } else {
            faces.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
        }
    }
    TriMesh::new(vertices, faces).unwrap()
}

#[test]
fn cracks_that_meet_at_a_corner_are_as_small_as_one() {
    for cracks in 1..=4 {
        // More than corners are welded over, so that the middles are no T-junctions.
        for off in [2e-6, -2e-6, 1e-5, 1e-4] {
            let baked = CollisionMesh::new(&cracked_cube(cracks, off));
            let defects = baked.mesh.defects();
            assert_eq!(baked.mesh.orientation(), Orientation::Open);
            assert_eq!(defects.count(DefectKind::Opening), cracks, "{off}");
            assert!(defects.largest_opening < 1e-4, "{cracks}: {}", defects.largest_opening);
            assert!(
                baked.mesh.is_solid() && baked.one_sided == OneSided::All,
                "{cracks}, {off}"
            );
            assert!(
                (baked.mass.volume - 1.0).abs() < 1e-6 + 2.0 * off.abs(),
                "{:?}",
                baked.mass
            );
            assert!(contains(&baked, Vec3::new(0.1, 0.2, 0.49)) && !contains(&baked, Vec3::new(0.1, 0.2, 0.51)));
        }
    }
}

/// A box without a lid holds things; so do a glass and a pipe. None of their faces is one-sided.
#[test]
fn vessels_stay_open() {
    let cube = shapes::cube(1.0);
    let top = |t: usize| cube.corners(t).iter().all(|p| p.y > 0.49);
    // A prism of 24 sides, six times as high as wide, without one or both of its ends.
    let prism = |ends: &[bool; 2]| {
        let n = 24u32;
        let at = |i: u32, y: f32| {
            let turn = i as f32 / n as f32 * std::f32::consts::TAU;
            Vec3::new(turn.cos(), y, turn.sin())
        };
        let mut vertices: Vec<Vec3> = (0..n).flat_map(|i| [at(i, 0.0), at(i, 12.0)]).collect();
        vertices.extend([Vec3::ZERO, Vec3::Y * 12.0]);
        let mut faces = Vec::new();
        for i in 0..n {
            let (a, b) = (2 * i, 2 * ((i + 1) % n));
            faces.extend([[a, a + 1, b], [b, a + 1, b + 1]]);
            faces.extend(ends[0].then_some([a, b, 2 * n]));
            faces.extend(ends[1].then_some([b + 1, a + 1, 2 * n + 1]));
        }
        TriMesh::new(vertices, faces).unwrap()
    };
    let whole = CollisionMesh::new(&prism(&[true; 2]));
    assert_eq!(whole.mesh.orientation(), Orientation::Outward);
    for (name, mesh) in [
        ("box", without(&cube, top)),
        ("glass", prism(&[true, false])),
        ("pipe", prism(&[false; 2])),
    ] {
        let baked = CollisionMesh::new(&mesh);
        assert_eq!(baked.mesh.orientation(), Orientation::Open, "{name}");
        assert!(baked.mesh.caps().is_empty() && !baked.mesh.is_solid(), "{name}");
        assert_eq!(baked.one_sided, OneSided::None, "{name}");
        assert_eq!(baked.mass.basis, MassBasis::Capped, "{name}");
    }
}

/// A loose sheet in a solid pushes to both sides; the faces around it do not.
#[test]
fn a_loose_sheet_in_a_solid_is_two_sided() {
    let ball = without(&shapes::ball(1.0, 3), |t| t == 5);
    let mut vertices = ball.vertices().to_vec();
    let first = vertices.len() as u32;
    vertices.extend([Vec3::ZERO, Vec3::X * 0.2, Vec3::Y * 0.2]);
    let mut faces = ball.triangles().to_vec();
    let sheet = faces.len() as u32;
    faces.push([first, first + 1, first + 2]);
    let baked = CollisionMesh::new(&TriMesh::new(vertices, faces).unwrap());
    let two_sided = (0..baked.mesh.triangles().len()).filter(|&t| !baked.one_sided.is(t));
    let two_sided: Vec<u32> = two_sided.map(|t| baked.mesh.face_ids()[t]).collect();
    assert_eq!(two_sided, [sheet]);
}

/// Corners moved by a ten-millionth of the size, and none of them shared.
#[test]
fn a_cad_file_is_closed() {
    for mesh in [shapes::torus_240(), shapes::knot_1120(), shapes::cube(3.0)] {
        let clean = CollisionMesh::new(&mesh);
        let size = mesh.aabb().half_size().length() * 2.0;
        let mut seed = 1u32;
        let mut shake = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((seed >> 8) as f32 / (1 << 24) as f32 - 0.5) * 2e-7 * size
        };
        let vertices: Vec<Vec3> = (0..mesh.triangles().len())
            .flat_map(|t| mesh.corners(t))
            .map(|p| p + Vec3::new(shake(), shake(), shake()))
            .collect();
        let faces = (0..mesh.triangles().len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect();
        let baked = CollisionMesh::new(&TriMesh::new(vertices, faces).unwrap());
        assert_eq!(baked.mesh.orientation(), Orientation::Outward);
        assert!(
            !baked.mass.approximate && baked.warnings().is_empty(),
            "{:?}",
            baked.warnings()
        );
        assert!(
            (baked.mass.volume / clean.mass.volume - 1.0).abs() < 1e-6,
            "{}",
            baked.mass.volume / clean.mass.volume - 1.0
        );
    }
}

#[test]
fn defects_are_counted_with_places() {
    let cube = shapes::cube(2.0);
    let mut faces = cube.triangles().to_vec();
    let first = faces[0];
    faces.push([first[1], first[0], first[2]]);
    faces.push([3, 3, 4]);
    let baked = CollisionMesh::new(&TriMesh::new(cube.vertices().to_vec(), faces).unwrap());
    let defects = baked.mesh.defects();
    let counts = [DefectKind::Duplicate, DefectKind::ZeroArea, DefectKind::CrowdedEdge].map(|kind| defects.count(kind));
    assert_eq!(counts, [1, 1, 3]);
    let duplicate = defects.of(DefectKind::Duplicate).next().unwrap();
    assert_eq!(duplicate.face, Some(12));
    let middle = first.map(|v| cube.vertices()[v as usize]).iter().sum::<Vec3>() / 3.0;
    assert!(duplicate.position.distance(middle) < 1e-6);
    // Two plates with a crack between them.
    let plate = |x: f32| {
        [
            Vec3::new(x, 0.0, 0.0),
            Vec3::new(x + 1.0, 0.0, 0.0),
            Vec3::new(x + 1.0, 1.0, 0.0),
            Vec3::new(x, 1.0, 0.0),
        ]
    };
    let vertices = [plate(0.0), plate(1.0005)].concat();
    let mesh = TriMesh::new(vertices, vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]).unwrap();
    assert_eq!(mesh.defects().count(DefectKind::Crack), 2);
    assert_eq!(mesh.defects().count(DefectKind::Opening), 2);
}
