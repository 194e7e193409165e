//! Repair of meshes: each step removes what it claims to, and a sound mesh stays as it is.

use bevy_faceoff::asset::{import_bytes, to_obj};
use bevy_faceoff::geometry::repair::{Repaired, Steps, WhyLeft, repair};
use bevy_faceoff::geometry::{DefectKind, MassProperties, Orientation, TriMesh, shapes};
use glam::Vec3;

/// A number below `below`, another for each `i`.
fn random(i: usize, below: u32) -> u32 {
    let hash = (i as u32 + 1).wrapping_mul(2_654_435_761).rotate_left(13);
    (hash.wrapping_mul(0x9e37_79b9) >> 8) % below
}

pub(super) fn mesh(vertices: &[Vec3], faces: Vec<[u32; 3]>) -> TriMesh {
    TriMesh::new(vertices.to_vec(), faces).unwrap()
}

/// Each face with vertices of its own, moved by up to `shake` along each axis.
fn soup(mesh: &TriMesh, shake: f32) -> TriMesh {
    let corners = mesh.triangles().as_flattened().iter().enumerate();
    let moved = |(i, &v): (usize, &u32)| {
        let part = |axis: usize| random(3 * i + axis, 2001) as f32 / 1000.0 - 1.0;
        mesh.vertices()[v as usize] + Vec3::new(part(0), part(1), part(2)) * shake
    };
    let vertices: Vec<Vec3> = corners.map(moved).collect();
    let faces = (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    TriMesh::new(vertices, faces.collect()).unwrap()
}

fn wound_at_random(mesh: &TriMesh) -> TriMesh {
    let faces = mesh.triangles().iter().enumerate();
    let turned = faces.map(|(t, &[a, b, c])| if random(t, 2) == 0 { [a, c, b] } else { [a, b, c] });
    TriMesh::new(mesh.vertices().to_vec(), turned.collect()).unwrap()
}

/// Both meshes as one.
fn union(a: &TriMesh, b: &TriMesh) -> TriMesh {
    let start = a.vertices().len() as u32;
    let shifted = b.triangles().iter().map(|t| t.map(|v| v + start));
    let faces = a.triangles().iter().copied().chain(shifted);
    TriMesh::new([a.vertices(), b.vertices()].concat(), faces.collect()).unwrap()
}

fn without(mesh: &TriMesh, is_missing: impl Fn(usize) -> bool) -> TriMesh {
    let faces = mesh.triangles().iter().enumerate();
    let left = faces.filter(|(t, _)| !is_missing(*t)).map(|(_, face)| *face);
    TriMesh::new(mesh.vertices().to_vec(), left.collect()).unwrap()
}

pub(super) fn volume(mesh: &TriMesh) -> f32 {
    MassProperties::of(mesh).volume
}

/// Repairs, and checks that the file of the result has the same faces, and that another repair changes nothing.
#[track_caller]
pub(super) fn repaired(mesh: &TriMesh, steps: &Steps) -> Repaired {
    let once = repair(mesh, steps).unwrap();
    let file = to_obj(&once.mesh);
    let read = import_bytes("mesh.obj", file.as_bytes()).unwrap();
    assert_eq!(read.with_weld_tolerance(steps.tolerance), once.mesh);
    let twice = repair(&once.mesh, steps).unwrap();
    assert_eq!(to_obj(&twice.mesh), file, "repaired twice");
    once
}

#[track_caller]
pub(super) fn assert_sound(mesh: &TriMesh) {
    assert_eq!(mesh.orientation(), Orientation::Outward);
    assert_eq!(mesh.defects().list(), []);
}

#[test]
fn a_sound_mesh_stays_as_it_is() {
    let nested = union(&shapes::ball(2.0, 2), &shapes::ball(1.0, 2).flipped());
    for mesh in [shapes::cube(1.0), shapes::torus_240(), shapes::knot_1120(), nested] {
        let Repaired { mesh: same, work } = repaired(
            &mesh,
            &Steps {
                close_holes: 100,
                ..Steps::SAFE
            },
        );
        assert_eq!(same, mesh);
        assert_eq!(work, Default::default());
    }
}

#[test]
fn a_shaken_soup_is_welded_into_the_mesh_it_was_made_of() {
    let torus = shapes::torus_240();
    let soup = soup(&torus, 2e-7);
    assert_eq!(soup.vertices().len(), 720);
    let Repaired { mesh, work } = repaired(
        &soup,
        &Steps {
            weld: true,
            ..Steps::NONE
        },
    );
    assert_eq!((mesh.vertices().len(), work.merged_vertices), (120, 600));
    assert_sound(&mesh);
    assert_sound(&mesh.clone().with_weld_tolerance(0.0));
    assert!((volume(&mesh) / volume(&torus) - 1.0).abs() < 1e-5);
    // Too far apart for the tolerance, and not for a larger one.
    let far = self::soup(&torus, 1e-4);
    let steps = Steps {
        weld: true,
        ..Steps::NONE
    };
    assert!(!repaired(&far, &steps).mesh.is_closed());
    let wide = Steps {
        tolerance: 1e-3,
        ..steps
    };
    assert_sound(&repaired(&far, &wide).mesh);
    let all = Steps {
        tolerance: 1.0,
        ..steps
    };
    assert!(repair(&far, &all).is_err(), "all vertices become one");
}

#[test]
fn windings_at_random_are_made_to_agree() {
    let ball = shapes::ball(1.0, 3);
    let cavity = shapes::ball(0.5, 2);
    let beside = TriMesh::new(
        ball.vertices().iter().map(|v| *v + Vec3::X * 3.0).collect(),
        ball.triangles().to_vec(),
    )
    .unwrap();
    for (name, mesh, expected) in [
        ("ball", wound_at_random(&ball), volume(&ball)),
        (
            "two shells",
            wound_at_random(&union(&ball, &beside)),
            2.0 * volume(&ball),
        ),
        (
            "nested shells",
            wound_at_random(&union(&ball, &cavity)),
            volume(&ball) - volume(&cavity),
        ),
        ("inside out", wound_at_random(&ball).flipped(), volume(&ball)),
    ] {
        assert!(mesh.defects().count(DefectKind::Disagreement) > 100, "{name}");
        let Repaired { mesh, work } = repaired(
            &mesh,
            &Steps {
                orient: true,
                ..Steps::NONE
            },
        );
        assert_sound(&mesh);
        assert!((volume(&mesh) / expected - 1.0).abs() < 1e-5, "{name}");
        assert!(work.turned_faces > mesh.triangles().len() / 4, "{name}");
    }
}

#[test]
fn a_ball_without_a_twentieth_of_its_faces_is_closed() {
    let ball = shapes::ball(1.0, 4);
    for seed in 0..20 {
        let open = without(&ball, |t| random(t + 100_000 * seed, 20) == 0);
        let missing = ball.triangles().len() - open.triangles().len();
        assert!((200..320).contains(&missing), "{missing}");
        let steps = Steps {
            close_holes: 12,
            ..Steps::SAFE
        };
        let Repaired { mesh, work } = repaired(&open, &steps);
        assert_eq!(work.left_holes, [], "seed {seed}");
        assert_sound(&mesh);
        assert!((volume(&mesh) / volume(&ball) - 1.0).abs() < 0.01);
        assert!(work.closed_holes > 150 && work.added_faces <= missing);
    }
}

#[test]
fn holes_are_closed_up_to_the_number_of_edges_asked_for() {
    // A tube of 20 segments without ends, about the y axis: two holes of 20 edges.
    let ring = |y: f32| {
        (0..20).map(move |k| {
            let angle = std::f32::consts::TAU * k as f32 / 20.0;
            Vec3::new(angle.cos(), y, angle.sin())
        })
    };
    let vertices: Vec<Vec3> = ring(0.0).chain(ring(1.0)).collect();
    let faces = (0..20u32).flat_map(|k| {
        let next = (k + 1) % 20;
        [[k, k + 20, next + 20], [k, next + 20, next]]
    });
    let tube = mesh(&vertices, faces.collect());
    let close = |close_holes| {
        repaired(
            &tube,
            &Steps {
                close_holes,
                ..Steps::SAFE
            },
        )
    };
    let Repaired { mesh: open, work } = close(19);
    assert_eq!((work.closed_holes, work.left_holes.len()), (0, 2));
    assert!(
        work.left_holes
            .iter()
            .all(|hole| hole.edges == 20 && hole.why == WhyLeft::TooLong)
    );
    assert_eq!(open, tube);
    let Repaired { mesh: closed, work } = close(20);
    assert_eq!((work.closed_holes, work.added_faces), (2, 36));
    assert_sound(&closed);
    let prism = 20.0 / 2.0 * (std::f32::consts::TAU / 20.0).sin();
    assert!((volume(&closed) - prism).abs() < 1e-5);
}

#[test]
fn a_hole_that_triangles_cannot_close_is_left() {
    // One triangle: what closes it is there already. Three faces at an edge: no loop.
    let vertices = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_ONE];
    for (faces, why) in [
        (vec![[0, 1, 2]], WhyLeft::NoTriangles),
        (vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]], WhyLeft::NoLoop),
    ] {
        let Repaired { mesh, work } = repaired(
            &mesh(&vertices, faces.clone()),
            &Steps {
                close_holes: 12,
                ..Steps::NONE
            },
        );
        assert_eq!(mesh.triangles(), faces);
        assert_eq!(work.closed_holes, 0);
        assert!(!work.left_holes.is_empty());
        assert!(
            work.left_holes.iter().all(|hole| hole.why == why),
            "{:?}",
            work.left_holes
        );
    }
}

/// The cube with one corner of a side at the middle of an edge, which its neighbour does not have; and a finer one.
fn cube_with_t_junctions(parts: u32) -> TriMesh {
    let cube = shapes::cube(1.0);
    let (mut vertices, mut faces) = (cube.vertices().to_vec(), cube.triangles().to_vec());
    let [a, b, c] = faces.remove(0);
    let mut from = a;
    for k in 1..parts {
        let (u, v) = (vertices[a as usize], vertices[b as usize]);
        vertices.push(u.lerp(v, k as f32 / parts as f32));
        let middle = vertices.len() as u32 - 1;
        faces.push([from, middle, c]);
        from = middle;
    }
    faces.push([from, b, c]);
    mesh(&vertices, faces)
}

#[test]
fn edges_are_split_at_t_junctions() {
    for parts in [2, 3, 7, 1000] {
        let cube = cube_with_t_junctions(parts);
        assert!(!cube.is_closed());
        assert_eq!(cube.defects().count(DefectKind::TJunction), parts as usize - 1);
        let Repaired { mesh, work } = repaired(
            &cube,
            &Steps {
                split: true,
                ..Steps::NONE
            },
        );
        assert_eq!(work.split_edges, parts as usize - 1);
        assert_sound(&mesh);
        assert!((volume(&mesh) - 1.0).abs() < 1e-5);
        assert_eq!(mesh.vertices(), cube.vertices());
    }
}

#[test]
fn faces_of_zero_area_go_but_those_that_close_the_mesh_need_a_split() {
    let mut vertices = shapes::cube(1.0).vertices().to_vec();
    let mut faces = shapes::cube(1.0).triangles().to_vec();
    // A face that is a point, one that is an edge, and vertices that no face uses.
    faces.insert(3, [4, 4, 4]);
    faces.insert(7, [1, 2, 1]);
    vertices.extend([Vec3::ONE * 0.1, Vec3::ONE * 0.2]);
    let drop = Steps {
        drop: true,
        ..Steps::NONE
    };
    let Repaired { mesh: plain, work } = repaired(&mesh(&vertices, faces), &drop);
    assert_eq!((work.dropped_zero_area, work.dropped_vertices), (2, 2));
    assert_eq!(plain, shapes::cube(1.0));

    // A sliver fills the T-junction.
    let cube = cube_with_t_junctions(2);
    let [a, b, _] = shapes::cube(1.0).triangles()[0];
    let faces = [cube.triangles(), &[[a, b, 8]]].concat();
    let filled = mesh(cube.vertices(), faces);
    assert!(filled.is_closed());
    let Repaired { mesh: kept, work } = repaired(&filled, &drop);
    assert_eq!((work.dropped_zero_area, work.kept_zero_area), (0, 1));
    assert_eq!(kept, filled);
    let Repaired { mesh: split, work } = repaired(&filled, &Steps { split: true, ..drop });
    assert_eq!((work.dropped_zero_area, work.split_edges), (1, 1));
    assert_sound(&split);
    // One that lies about adds nothing.
    let loose = union(&cube_with_t_junctions(1), &shapes::cube(3.0));
    let vertices = [loose.vertices(), &[Vec3::X * 5.0, Vec3::X * 6.0, Vec3::X * 7.0]].concat();
    let faces = [loose.triangles(), &[[16, 17, 18]]].concat();
    let Repaired { mesh: clean, work } = repaired(&mesh(&vertices, faces), &drop);
    assert_eq!((work.dropped_zero_area, work.dropped_vertices), (1, 3));
    assert_eq!(clean.triangles(), loose.triangles());
}

#[test]
fn duplicates_go_but_not_the_second_side_of_a_sheet() {
    let torus = shapes::torus_240();
    let drop = Steps {
        drop: true,
        ..Steps::NONE
    };
    let twice = [torus.triangles(), torus.triangles()].concat();
    let some: Vec<[u32; 3]> = torus
        .triangles()
        .iter()
        .map(|&[a, b, c]| [c, a, b])
        .step_by(7)
        .collect();
    let turned: Vec<[u32; 3]> = torus
        .triangles()
        .iter()
        .map(|&[a, b, c]| [a, c, b])
        .step_by(5)
        .collect();
    for (faces, dropped) in [
        (twice, 240),
        ([torus.triangles(), &some].concat(), 35),
        ([torus.triangles(), &turned].concat(), 48),
        ([&some, torus.triangles(), &some].concat(), 70),
    ] {
        let doubled = mesh(torus.vertices(), faces);
        assert_eq!(doubled.defects().count(DefectKind::Duplicate), dropped);
        let Repaired { mesh, work } = repaired(&doubled, &Steps { orient: true, ..drop });
        assert_eq!((work.dropped_duplicates, work.kept_back_to_back), (dropped, 0));
        assert_sound(&mesh);
        assert_eq!(volume(&mesh), volume(&torus));
    }
    // A square with two sides, and the same with one.
    let vertices = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
    let sides = [[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]];
    let Repaired { mesh: sheet, work } = repaired(&mesh(&vertices, sides.to_vec()), &drop);
    assert_eq!((work.dropped_duplicates, work.kept_back_to_back), (0, 2));
    assert_eq!(sheet.triangles(), sides);
    let doubled = [sides[0], sides[1], sides[0], sides[1]];
    let Repaired { mesh: sheet, work } = repaired(&mesh(&vertices, doubled.to_vec()), &drop);
    assert_eq!(work.dropped_duplicates, 2);
    assert_eq!(sheet.triangles(), &sides[..2]);
}

#[test]
fn all_defects_at_once_are_repaired() {
    let ball = shapes::ball(1.0, 3);
    let broken = wound_at_random(&soup(&without(&ball, |t| random(t, 20) == 0), 1e-7));
    let mut vertices = broken.vertices().to_vec();
    let mut faces = broken.triangles().to_vec();
    vertices.push(Vec3::ZERO);
    faces.extend_from_within(10..20);
    faces.push([5, 5, 6]);
    let Repaired { mesh, work } = repaired(
        &mesh(&vertices, faces),
        &Steps {
            close_holes: 12,
            ..Steps::SAFE
        },
    );
    assert_sound(&mesh);
    assert!((volume(&mesh) / volume(&ball) - 1.0).abs() < 0.01);
    assert_eq!((work.dropped_duplicates, work.dropped_zero_area), (10, 1));
}

/// Random faces between the points of a small lattice: all kinds of defects at once, many edges of more than two faces,
/// and points in line with others.
#[test]
fn whatever_the_mesh_no_step_makes_it_worse() {
    let lattice = |i: usize| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9 % 3) as f32);
    let (mut repaired, mut closed, mut changed) = (0, 0, 0);
    for seed in 0..4000 {
        let number = |i: usize, below: u32| random(seed * 1000 + i, below);
        let vertices: Vec<Vec3> = (0..20).map(|i| lattice(number(i, 27) as usize)).collect();
        let count = 1 + number(20, 30) as usize;
        let faces = (0..count).map(|f| [0, 1, 2].map(|k| number(100 + 3 * f + k, 20)));
        let Ok(mesh) = TriMesh::new(vertices, faces.collect()) else {
            continue;
        };
        let steps = Steps {
            close_holes: 20,
            ..Steps::SAFE
        };
        for steps in [Steps::SAFE, steps] {
            let Repaired { mesh: once, work } = repair(&mesh, &steps).unwrap();
            let odd = |mesh: &TriMesh| mesh.gaps().map_or(0, |gaps| gaps.edges);
            assert!(
                !mesh.is_closed() || once.is_closed(),
                "seed {seed}: the repair opened the mesh"
            );
            assert_eq!(once.defects().count(DefectKind::ZeroArea), 0, "seed {seed}");
            assert_eq!(
                once.vertices().len(),
                once.welded()
                    .iter()
                    .enumerate()
                    .filter(|(i, w)| *i as u32 == **w)
                    .count()
            );
            let before = repair(
                &mesh,
                &Steps {
                    close_holes: 0,
                    ..steps
                },
            )
            .unwrap()
            .mesh;
            assert!(odd(&once) <= odd(&before), "seed {seed}: closing holes opened others");
            if work.closed_holes > 0 {
                assert_eq!(
                    once.defects().count(DefectKind::CrowdedEdge),
                    before.defects().count(DefectKind::CrowdedEdge),
                    "seed {seed}: triangles joined what was joined"
                );
            }
            let twice = repair(&once, &steps).unwrap().mesh;
            changed += usize::from(to_obj(&twice) != to_obj(&once));
            repaired += 1;
            closed += work.closed_holes;
        }
    }
    println!("{repaired} repairs, {closed} holes closed, {changed} changed by another repair");
    assert!(repaired > 7000 && closed > 1000);
    // In such meshes one step may make work for another once more.
    assert!(changed < repaired / 100);
}
