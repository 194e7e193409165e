//! Orientation by shell: whatever the winding of a file, solids point outward, and mass and containment agree.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::asset::format::{from_bytes, to_bytes};
use bevy_faceoff::geometry::{DefectKind, MassBasis, Orientation, TriMesh, shapes};
use bevy_faceoff::queries::Placed;
use glam::{DQuat, DVec3, Vec3};

/// How a shell of a test is wound.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wound {
    Outward,
    Inward,
    /// Some of its faces.
    Randomly(u32),
}

/// Several meshes as one, each moved and wound as told.
fn joined(parts: &[(&TriMesh, Vec3, Wound)]) -> TriMesh {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for (mesh, at, wound) in parts {
        let first = vertices.len() as u32;
        vertices.extend(mesh.vertices().iter().map(|v| *v + *at));
        for (i, face) in (0u32..).zip(mesh.triangles()) {
            let [a, b, c] = face.map(|v| v + first);
            let flip = match wound {
                Wound::Outward => false,
                Wound::Inward => true,
                Wound::Randomly(seed) => {
                    (i + 1)
                        .wrapping_mul(2_654_435_761)
                        .wrapping_add(*seed)
                        .wrapping_mul(0x9e37_79b9)
                        >> 31
                        == 1
                }
            };
            faces.push(if flip { [a, c, b] } else { [a, b, c] });
        }
    }
    TriMesh::new(vertices, faces).unwrap()
}

fn contains(baked: &CollisionMesh, p: Vec3) -> bool {
    let placed = Placed::new(baked, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    placed.closest_point(p.as_dvec3(), f64::INFINITY).unwrap().is_inside
}

const WINDINGS: [Wound; 4] = [Wound::Outward, Wound::Inward, Wound::Randomly(1), Wound::Randomly(77)];

#[test]
fn one_shell_of_any_winding_is_a_solid_or_a_room() {
    for mesh in [shapes::torus_240(), shapes::knot_1120(), shapes::cube(1.0)] {
        let clean = CollisionMesh::new(&mesh);
        for wound in WINDINGS {
            let baked = CollisionMesh::new(&joined(&[(&mesh, Vec3::ZERO, wound)]));
            if wound == Wound::Inward {
                assert_eq!(baked.mesh.orientation(), Orientation::Inward);
                assert!(baked.mesh.turned().is_empty());
                continue;
            }
            // The mesh is as before, but for what was turned.
            assert_eq!(baked.mesh.orientation(), Orientation::Outward, "{wound:?}");
            assert_eq!(baked.mesh.triangles().len(), clean.mesh.triangles().len());
            assert_eq!(baked.mesh.face_ids(), clean.mesh.face_ids());
            assert!(
                (baked.mass.volume - clean.mass.volume).abs() < 1e-6 * clean.mass.volume,
                "{wound:?}"
            );
            assert_eq!(baked.mass.basis, MassBasis::Solid);
            let is_told = baked.warnings().iter().any(|warning| warning.contains("were turned"));
            assert_eq!(is_told, wound != Wound::Outward);
        }
    }
}

#[test]
fn shells_side_by_side_add_up() {
    let (ball, torus) = (shapes::ball(0.5, 2), shapes::torus_240());
    let sum = CollisionMesh::new(&ball).mass.volume + CollisionMesh::new(&torus).mass.volume;
    for first in WINDINGS {
        for second in WINDINGS {
            let mesh = joined(&[(&ball, Vec3::ZERO, first), (&torus, Vec3::X * 3.0, second)]);
            let baked = CollisionMesh::new(&mesh);
            let name = format!("{first:?} {second:?}");
            assert!(
                (baked.mass.volume - sum).abs() < 1e-5 * sum,
                "{name}: {} {sum}",
                baked.mass.volume
            );
            // Two rooms stay rooms.
            let is_room = [first, second] == [Wound::Inward; 2];
            assert_eq!(baked.mesh.is_room(), is_room, "{name}");
            assert_eq!(baked.mesh.orientation() == Orientation::Outward, !is_room, "{name}");
            assert_eq!(contains(&baked, Vec3::splat(0.1)), !is_room, "{name}");
            assert_eq!(contains(&baked, Vec3::new(3.35, 0.0, 0.0)), !is_room, "{name}");
            assert!(
                !contains(&baked, Vec3::new(3.0, 0.0, 0.0)),
                "{name}: the hole of the torus"
            );
        }
    }
}

#[test]
fn a_shell_inside_another_is_a_cavity_or_told() {
    let (outer, inner) = (shapes::ball(1.0, 3), shapes::ball(0.5, 2));
    let [large, small] = [&outer, &inner].map(|mesh| CollisionMesh::new(mesh).mass.volume);
    let at = Vec3::new(0.1, 0.2, 0.0);
    for first in WINDINGS {
        for second in WINDINGS {
            let mesh = joined(&[(&inner, at, second), (&outer, Vec3::ZERO, first)]);
            let baked = CollisionMesh::new(&mesh);
            let name = format!("{first:?} {second:?}");
            let told = baked.mesh.defects().count(DefectKind::SolidInSolid);
            // An outer shell that was turned takes the inner one with it, if that has a winding of its own.
            let outward = |wound: Wound| wound != Wound::Inward;
            let alike = match (first, second) {
                (_, Wound::Randomly(_)) => false,
                _ => outward(first) == outward(second),
            };
            let volume = if alike { large + small } else { large - small };
            assert!(
                (baked.mass.volume - volume).abs() < 1e-4 * volume,
                "{name}: {} {volume}",
                baked.mass.volume
            );
            assert_eq!(told, usize::from(alike), "{name}");
            assert_eq!(baked.mesh.is_room(), first == Wound::Inward, "{name}");
            if !baked.mesh.is_room() {
                assert!(contains(&baked, Vec3::X * -0.8), "{name}");
                assert_eq!(contains(&baked, at), alike, "{name}");
            }
        }
    }
}

/// What stands inside a shell that is turned turns with it, to any depth.
#[test]
fn nested_shells_turn_together() {
    let balls = [1.0, 0.8, 0.6, 0.4].map(|radius| shapes::ball(radius, 2));
    let volumes = balls.each_ref().map(|ball| CollisionMesh::new(ball).mass.volume);
    // Beside a ball that points outward, so that it is no room.
    let beside = (&balls[3], Vec3::X * 5.0, Wound::Outward);
    let wounds = [Wound::Inward, Wound::Outward, Wound::Inward, Wound::Outward];
    let nested = (0..4).map(|i| (&balls[i], Vec3::ZERO, wounds[i]));
    let baked = CollisionMesh::new(&joined(&nested.chain([beside]).collect::<Vec<_>>()));
    let volume = volumes[0] - volumes[1] + volumes[2] - volumes[3] + volumes[3];
    assert!(
        (baked.mass.volume - volume).abs() < 1e-4,
        "{} {volume}",
        baked.mass.volume
    );
    let inside = [0.0, 0.5, 0.7, 0.9].map(|x| contains(&baked, Vec3::new(x, 0.01, 0.02)));
    assert_eq!(inside, [false, true, false, true]);
}

/// A Möbius strip has no consistent winding. It stays as it is, and nothing goes wrong.
#[test]
fn a_moebius_strip_stays_as_it_is() {
    let n = 24u32;
    let mut vertices = Vec::new();
    for i in 0..n {
        let turn = i as f32 / n as f32 * std::f32::consts::TAU;
        let across = Vec3::new(
            turn.cos() * (turn / 2.0).cos(),
            turn.sin() * (turn / 2.0).cos(),
            (turn / 2.0).sin(),
        );
        let middle = Vec3::new(turn.cos(), turn.sin(), 0.0);
        vertices.extend([middle - across * 0.3, middle + across * 0.3]);
    }
    let mut faces = Vec::new();
    for i in 0..n {
        let [a, b] = [2 * i, 2 * i + 1];
        let [c, d] = if i + 1 < n { [a + 2, b + 2] } else { [1, 0] };
        faces.extend([[a, b, c], [b, d, c]]);
    }
    let baked = CollisionMesh::new(&TriMesh::new(vertices, faces).unwrap());
    assert_eq!(baked.mesh.orientation(), Orientation::Open);
    assert!(baked.mesh.turned().is_empty() && baked.mesh.caps().is_empty() && !baked.mesh.is_solid());
    assert!(baked.mesh.defects().count(DefectKind::Disagreement) > 0);
    assert_eq!(baked.mass.basis, MassBasis::Shell);
}

#[test]
fn what_was_turned_is_in_the_file_and_face_numbers_are_those_of_the_input() {
    let mesh = joined(&[(&shapes::ball(0.5, 2), Vec3::ZERO, Wound::Randomly(5))]);
    let baked = CollisionMesh::new(&mesh);
    let (read, _) = from_bytes(&to_bytes(&baked, [0; 32])).unwrap();
    assert!(read == baked && read.mesh.turned() == baked.mesh.turned());
    // A second bake of what was read gives the same.
    assert!(CollisionMesh::new(&read.mesh) == baked);
    assert_eq!(read.mesh.clone().as_input().turned(), &[] as &[bool]);
    for face in 0..mesh.triangles().len() {
        assert_eq!(read.mesh.input_face(face as u32), Some(mesh.corners(face)));
    }
    // Hits name the face, and weigh its corners in their order in the input.
    let placed = Placed::new(&read, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    for i in 0..50 {
        let way = Vec3::new((i as f32).sin(), (i as f32 * 1.7).cos(), (i as f32 * 0.3).sin()).normalize();
        let hit = placed.closest_point((way * 2.0).as_dvec3(), 10.0).unwrap();
        let corners = mesh.corners(hit.face as usize);
        let place: DVec3 = corners
            .iter()
            .zip(hit.barycentric.to_array())
            .map(|(p, w)| p.as_dvec3() * f64::from(w))
            .sum();
        assert!(place.distance(hit.point) < 1e-6, "{place} {}", hit.point);
        assert!(hit.normal.dot(way) > 0.9);
    }
}

/// The number of shells costs no more than their faces.
#[test]
fn ten_thousand_shells_take_no_time() {
    let cube = shapes::cube(0.5);
    let parts: Vec<_> = (0..10_000)
        .map(|i| {
            (
                &cube,
                Vec3::new((i % 100) as f32, (i / 100) as f32, 0.0),
                WINDINGS[i % 4],
            )
        })
        .collect();
    let baked = CollisionMesh::new(&joined(&parts));
    assert_eq!(baked.mesh.orientation(), Orientation::Outward);
    assert!((baked.mass.volume - 1250.0).abs() < 0.01, "{}", baked.mass.volume);
}

/// Cubes in cubes, many of them.
#[test]
fn the_order_of_the_file_does_not_decide_what_is_inside() {
    let (large, small) = (shapes::cube(1.0), shapes::cube(0.5));
    let parts: Vec<(&TriMesh, Vec3, Wound)> = (0..200_u32)
        .flat_map(|i| {
            let at = Vec3::new((i % 6) as f32, (i / 6 % 6) as f32, (i / 36) as f32) * 1.5;
            [(&large, at, Wound::Randomly(i)), (&small, at, Wound::Outward)]
        })
        .collect();
    let mesh = joined(&parts);
    let oriented = CollisionMesh::new(&mesh);
    let count = mesh.triangles().len();
    // 7919 is prime, so this is a permutation.
    let order: Vec<usize> = (0..count).map(|i| i * 7919 % count).collect();
    let shuffled = order.iter().map(|&t| mesh.triangles()[t]).collect();
    let shuffled = CollisionMesh::new(&TriMesh::new(mesh.vertices().to_vec(), shuffled).unwrap());
    let turned = |baked: &CollisionMesh, face: usize| baked.mesh.turned()[face];
    for (at, &face) in order.iter().enumerate() {
        assert_eq!(turned(&shuffled, at), turned(&oriented, face));
    }
    let inside = |baked: &CollisionMesh| baked.mesh.defects().count(DefectKind::SolidInSolid);
    assert_eq!((inside(&oriented), inside(&shuffled)), (200, 200));
}
