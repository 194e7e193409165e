//! Repair of holes with thousands of edges.

use super::repair::{assert_sound, mesh, repaired, volume};
use bevy_faceoff::geometry::Orientation;
use bevy_faceoff::geometry::repair::{Repaired, Steps, WhyLeft, repair};
use glam::Vec3;

/// A tube without ends has two holes of 50,000 edges; a comb of triangles has 25,000 that cannot be closed.
#[test]
fn a_hundred_thousand_boundary_edges_are_no_trouble() {
    let count = 50_000u32;
    let steps = Steps {
        close_holes: usize::MAX,
        ..Steps::SAFE
    };
    let ring = |y: f32| {
        (0..count).map(move |k| {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(count);
            // Not round, so that the middle is not the best place for all.
            let radius = 1.0 + 0.3 * (5.0 * angle).sin();
            Vec3::new((radius * angle.cos()) as f32, y, (radius * angle.sin()) as f32)
        })
    };
    let vertices: Vec<Vec3> = ring(0.0).chain(ring(1.0)).collect();
    let tube = (0..count).flat_map(|k| {
        let next = (k + 1) % count;
        [[k, k + count, next + count], [k, next + count, next]]
    });
    let Repaired { mesh: closed, work } = repair(&mesh(&vertices, tube.collect()), &steps).unwrap();
    assert_eq!((work.closed_holes, work.added_faces as u32), (2, 2 * (count - 2)));
    assert_eq!(closed.orientation(), Orientation::Outward);
    // The area of the ends is half the integral of the squared radius.
    let expected = std::f32::consts::PI * (1.0 + 0.3 * 0.3 / 2.0);
    assert!(
        (volume(&closed) / expected - 1.0).abs() < 1e-4,
        "{} is not {expected}",
        volume(&closed)
    );
    let area = |t: usize| {
        let [a, b, c] = closed.corners(t).map(|p| p.as_dvec3());
        if a.y == b.y && b.y == c.y {
            (b - a).cross(c - a).length() * 0.5
        } else {
            0.0
        }
    };
    let ends: f64 = (0..closed.triangles().len()).map(area).sum();
    assert!(
        (ends / f64::from(2.0 * expected) - 1.0).abs() < 1e-3,
        "{ends}: the triangles lie over each other"
    );

    let vertices: Vec<Vec3> = (0..=count)
        .flat_map(|k| [Vec3::X * k as f32, Vec3::new(k as f32, 1.0, 0.0)])
        .collect();
    let comb = (0..count / 2).map(|k| [4 * k, 4 * k + 2, 4 * k + 3]);
    let work = repair(&mesh(&vertices, comb.collect()), &steps).unwrap().work;
    assert_eq!(work.left_holes.len() as u32, count / 2);
    assert!(work.left_holes.iter().all(|hole| hole.why == WhyLeft::NoTriangles));
}

/// A box without a bottom, of 300 by 200 squares a side: its hole has 1000 edges along four straight lines, and none
/// where two neighbours are not in line.
#[test]
fn a_large_hole_with_straight_sides_is_closed() {
    let (wide, deep) = (300u32, 200u32);
    let at = |i: u32, j: u32| i * (deep + 1) + j;
    let mut vertices: Vec<Vec3> = Vec::new();
    for i in 0..=wide {
        for j in 0..=deep {
            let is_rim = i == 0 || j == 0 || i == wide || j == deep;
            vertices.push(Vec3::new(i as f32, if is_rim { 0.0 } else { 50.0 }, j as f32));
        }
    }
    let faces = (0..wide).flat_map(|i| {
        (0..deep).flat_map(move |j| {
            let (a, b, c, d) = (at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
            [[a, b, c], [a, c, d]]
        })
    });
    let lid = mesh(&vertices, faces.collect());
    let steps = Steps {
        close_holes: 1000,
        ..Steps::SAFE
    };
    let Repaired { mesh: closed, work } = repaired(&lid, &steps);
    assert_eq!((work.closed_holes, work.added_faces), (1, 998));
    assert_sound(&closed);
}
