//! Faces that are there twice: what is closed without them counts once.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::asset::format::{from_bytes, to_bytes};
use bevy_faceoff::geometry::{DefectKind, MassBasis, OneSided, Orientation, TriMesh, shapes};
use bevy_faceoff::queries::Placed;
use glam::{DQuat, DVec3, Vec3};

/// A mesh with some of its faces a second time, wound alike or oppositely, with vertices of their own.
fn doubled(mesh: &TriMesh, reversed: bool, is_doubled: impl Fn(usize) -> bool) -> TriMesh {
    let count = mesh.vertices().len() as u32;
    let vertices = [mesh.vertices(), mesh.vertices()].concat();
    let mut faces = mesh.triangles().to_vec();
    for (t, face) in (0..).zip(mesh.triangles()) {
        if is_doubled(t) {
            let [a, b, c] = face.map(|v| v + count);
            faces.push(if reversed { [a, c, b] } else { [b, c, a] });
        }
    }
    TriMesh::new(vertices, faces).unwrap()
}

fn contains(baked: &CollisionMesh, p: Vec3) -> bool {
    let placed = Placed::new(baked, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    placed.closest_point(p.as_dvec3(), f64::INFINITY).unwrap().is_inside
}

#[test]
fn a_solid_with_faces_that_are_there_twice_weighs_and_contains_what_it_does_with_each_once() {
    for mesh in [shapes::cube(1.0), shapes::torus_240(), shapes::ball(1.0, 2)] {
        let once = CollisionMesh::new(&mesh);
        for reversed in [false, true] {
            for (name, is_doubled) in [
                ("all", (|_| true) as fn(usize) -> bool),
                ("one", |t| t == 3),
                ("some", |t| t % 3 == 0),
            ] {
                let baked = CollisionMesh::new(&doubled(&mesh, reversed, is_doubled));
                let name = format!("{name}, reversed: {reversed}, {} triangles", mesh.triangles().len());
                assert_eq!(baked.mesh.orientation(), Orientation::Outward, "{name}");
                assert!(baked.mesh.is_solid() && baked.one_sided == OneSided::All, "{name}");
                assert_eq!(baked.mass.basis, MassBasis::Solid, "{name}");
                let off = (baked.mass.volume / once.mass.volume - 1.0).abs();
                assert!(off < 1e-6 && !baked.mass.approximate, "{name}: {off}");
                assert!(baked.mass.center.distance(once.mass.center) < 1e-6, "{name}");
                assert!(
                    (baked.mass.thickness / once.mass.thickness - 1.0).abs() < 1e-6,
                    "{name}"
                );
                for i in 0..200 {
                    let at = |k: f32| ((i as f32 * k).fract() * 2.0 - 1.0) * 1.2;
                    let p = Vec3::new(at(0.618), at(0.754_87), at(0.569_84));
                    assert_eq!(contains(&baked, p), contains(&once, p), "{name}: {p}");
                }
                // They collide all the same, and are told.
                let doubled = baked.mesh.triangles().len() - mesh.triangles().len();
                assert_eq!(baked.mesh.defects().count(DefectKind::Duplicate), doubled);
                let told = baked.warnings().join("; ");
                assert!(told.contains("count once for the mass"), "{name}: {told}");
                let (read, _) = from_bytes(&to_bytes(&baked, [0; 32])).unwrap();
                assert!(read == baked && read.mesh.caps() == baked.mesh.caps(), "{name}");
            }
        }
    }
}

#[test]
fn edges_of_a_solid_that_is_there_twice_can_touch() {
    let convex = |baked: &CollisionMesh| {
        let owned = baked.features().owned.iter();
        owned.map(|owned| (owned & 56).count_ones()).sum::<u32>()
    };
    let cube = shapes::cube(1.0);
    for reversed in [false, true] {
        let twice = CollisionMesh::new(&doubled(&cube, reversed, |_| true));
        assert_eq!(
            convex(&twice),
            convex(&CollisionMesh::new(&cube)),
            "reversed: {reversed}"
        );
    }
}

#[test]
fn a_nearly_closed_solid_that_is_there_twice_weighs_what_it_does_once() {
    let ball = shapes::ball(1.0, 3);
    let faces = ball.triangles()[1..].to_vec();
    let open = TriMesh::new(ball.vertices().to_vec(), faces).unwrap();
    let once = CollisionMesh::new(&open);
    for reversed in [false, true] {
        let baked = CollisionMesh::new(&doubled(&open, reversed, |_| true));
        assert!(baked.mesh.orientation() == Orientation::Open && baked.mesh.is_solid());
        assert_eq!(baked.mass.basis, MassBasis::Capped);
        let off = (baked.mass.volume / once.mass.volume - 1.0).abs();
        assert!(off < 1e-6, "{off}");
        assert!(contains(&baked, Vec3::splat(0.3)) && !contains(&baked, Vec3::splat(0.7)));
        let one_sided = (0..baked.mesh.triangles().len()).filter(|&t| baked.one_sided.is(t));
        assert_eq!(one_sided.count(), baked.mesh.triangles().len());
    }
}

/// A sheet of two sides is no solid that is there twice.
#[test]
fn a_sheet_with_two_sides_stays_one() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
    let sides = vec![[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]];
    let baked = CollisionMesh::new(&TriMesh::new(corners, sides).unwrap());
    assert!(baked.mesh.is_closed() && baked.mesh.caps().is_empty());
    assert_eq!(baked.mass.basis, MassBasis::Box);
}
