//! Bodies that lie in each other's planes, and small bodies deep in large faces.

use crate::support::Random;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::queries::{ContactWorker, Placed};
use glam::{DQuat, DVec3, Vec3};

/// A closed surface around y, from its radii and heights on the way up; the first and the last point lie on the axis.
fn turned(sides: u32, profile: &[[f32; 2]]) -> TriMesh {
    let [first, rings @ .., last] = profile else {
        panic!("a profile");
    };
    let mut vertices = vec![Vec3::Y * first[1], Vec3::Y * last[1]];
    for [radius, height] in rings {
        let angle = |i: u32| i as f32 / sides as f32 * std::f32::consts::TAU;
        vertices.extend((0..sides).map(|i| Vec3::new(radius * angle(i).cos(), *height, radius * angle(i).sin())));
    }
    let mut triangles = Vec::new();
    for i in 0..sides {
        let j = (i + 1) % sides;
        let at = |ring: u32, i: u32| 2 + ring * sides + i;
        let count = rings.len() as u32;
        triangles.push([0, at(0, i), at(0, j)]);
        for ring in 1..count {
            let [a, b, c, d] = [at(ring - 1, i), at(ring, i), at(ring, j), at(ring - 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        triangles.push([1, at(count - 1, j), at(count - 1, i)]);
    }
    TriMesh::new(vertices, triangles).unwrap()
}

/// A cylinder along y.
fn cylinder(sides: u32, radius: f32, half: f32) -> TriMesh {
    turned(sides, &[[0.0, -half], [radius, -half], [radius, half], [0.0, half]])
}

/// The depth of the deepest contact point; negative for a gap.
fn depth(a: &Placed, b: &Placed, margin: f32) -> f32 {
    let mut points = Vec::new();
    ContactWorker::new().points(a, b, margin, &mut points);
    -points
        .iter()
        .map(|point| point.separation)
        .fold(f32::INFINITY, f32::min)
}

#[test]
fn a_cylinder_on_a_block_that_is_turned_like_it_only_touches() {
    let [cylinder, block] = [cylinder(32, 0.25, 0.5), shapes::cube(1.0)].map(|mesh| CollisionMesh::new(&mesh));
    let mut random = Random::new(17);
    for round in 0..2000 {
        let rotation = random.rotation();
        let at = random.vector() * 3.0;
        // Its lower end lies in the plane of the block's upper face, its upper end in that of the lower.
        let height = [1.0, -1.0][round % 2];
        let aside = rotation * DVec3::new(0.6 * random.unit(), height, 0.6 * random.unit());
        let a = Placed::new(&block, at, rotation, Vec3::ONE).unwrap();
        let b = Placed::new(&cylinder, at + aside, rotation, Vec3::ONE).unwrap();
        let depth = depth(&a, &b, 0.01);
        assert!(depth.abs() < 1.0e-5, "{depth} in round {round}");
    }
}

#[test]
fn a_peg_whose_end_lies_in_the_floor_of_its_hole_only_touches() {
    // A hole from the top down to the middle.
    let outline = [
        [0.0, -0.5],
        [0.5, -0.5],
        [0.5, 0.5],
        [0.25, 0.5],
        [0.25, 0.0],
        [0.0, 0.0],
    ];
    let [block, peg] = [turned(24, &outline), cylinder(32, 0.2, 0.5)].map(|mesh| CollisionMesh::new(&mesh));
    let mut random = Random::new(18);
    for round in 0..500 {
        let rotation = random.rotation();
        let aside = DVec3::new(random.unit(), 0.0, random.unit()) * 0.02;
        let a = Placed::new(&block, DVec3::ZERO, rotation, Vec3::ONE).unwrap();
        let b = Placed::new(&peg, rotation * (aside + DVec3::Y * 0.5), rotation, Vec3::ONE).unwrap();
        for depth in [depth(&a, &b, 0.01), depth(&b, &a, 0.01)] {
            assert!(depth.abs() < 1.0e-5, "{depth} in round {round}");
        }
    }
}

#[test]
fn a_slender_body_in_a_huge_triangle_or_a_thick_slab_is_as_deep_as_its_lowest_corner() {
    let mesh = cylinder(32, 0.02, 0.07);
    let small = CollisionMesh::new(&mesh);
    let corners = [[-100.0, 0.0, -100.0], [0.0, 0.0, 150.0], [100.0, 0.0, -100.0]];
    let triangle = TriMesh::new(corners.into_iter().map(Vec3::from).collect(), vec![[0, 1, 2]]).unwrap();
    let [triangle, slab] = [triangle, shapes::cube(1.0)].map(|mesh| CollisionMesh::new(&mesh));
    let large = [(&triangle, Vec3::ONE, 0.0), (&slab, Vec3::new(2.0, 1.0, 2.0), -0.5)];
    for tilt in [0.0, 0.3, 0.6, 1.0] {
        for wanted in [0.002, 0.005, 0.01, 0.03, 0.04] {
            let rotation = DQuat::from_rotation_z(tilt) * DQuat::from_rotation_y(0.3);
            let heights = mesh.vertices().iter().map(|v| (rotation * v.as_dvec3()).y);
            let lowest = heights.fold(f64::INFINITY, f64::min);
            for (large, scale, height) in large {
                let a = Placed::new(large, DVec3::Y * height, DQuat::IDENTITY, scale).unwrap();
                let b = Placed::new(&small, DVec3::Y * (-lowest - wanted), rotation, Vec3::ONE).unwrap();
                for depth in [depth(&a, &b, 0.001), depth(&b, &a, 0.001)] {
                    let error = f64::from(depth) / wanted - 1.0;
                    assert!(error.abs() < 0.025, "{depth} for {wanted}, tilt {tilt}, scale {scale}");
                }
            }
        }
    }
}
