//! Random pairs of bodies in the situations that matter. The oracle decides what is a first contact or a link.

use super::body::{Body, Mesh};
use super::brute::surfaces_meet;
use super::inside::linking_number;
use super::rng::Rng;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// A diameter as in the scenes.
pub fn diameter(rng: &mut Rng) -> f64 {
    rng.range(0.25, 2.0)
}

/// Two bodies of the given diameters, the first at the origin, the second at a uniform position where the bounding
/// spheres are closer than `reach` times the sum of their radii.
pub fn near(rng: &mut Rng, meshes: [&Arc<Mesh>; 2], [a, b]: [f64; 2], reach: f64) -> [Body; 2] {
    let first = Body::new(meshes[0], rng.in_cube(5.0), rng.rotation(), a);
    let second = Body::new(meshes[1], DVec3::ZERO, rng.rotation(), b);
    let offset = rng.in_ball(reach * 0.5 * (a + b));
    [first.clone(), second.moved(first.translation.as_dvec3() + offset)]
}

/// Two bodies of random size as in a scene: their spheres overlap.
pub fn scene(rng: &mut Rng, meshes: [&Arc<Mesh>; 2]) -> [Body; 2] {
    let diameters = [diameter(rng), diameter(rng)];
    near(rng, meshes, diameters, 1.0)
}

/// Bodies that penetrate by `depth` times their mean diameter. A touching pair is moved apart along a random direction,
/// and bisection finds where the surfaces separate.
pub fn contact(rng: &mut Rng, meshes: [&Arc<Mesh>; 2], depth: f64) -> [Body; 2] {
    loop {
        let [a, b] = scene(rng, meshes);
        if !surfaces_meet(&a, &b) {
            continue;
        }
        let size = mean_diameter(&a, &b);
        let way = rng.direction() * size;
        let part = last_contact(&a, &b, way, 2.0);
        return [a, b.moved(way * (part - depth))];
    }
}

/// The shift along `way`, to some accuracy, at which `b` separates from `a`: they meet at 0 and are separated at `end`.
fn last_contact(a: &Body, b: &Body, way: DVec3, end: f64) -> f64 {
    let [mut together, mut apart] = [0.0, end];
    while apart - together > 2e-4 {
        let middle = 0.5 * (together + apart);
        if surfaces_meet(a, &b.moved(way * middle)) {
            together = middle;
        } else {
            apart = middle;
        }
    }
    together
}

fn mean_diameter(a: &Body, b: &Body) -> f64 {
    0.5 * f64::from(a.scale.abs().max_element() + b.scale.abs().max_element())
}

/// Two tubes of similar size that are linked and do not touch.
pub fn linked(rng: &mut Rng, meshes: [&Arc<Mesh>; 2]) -> [Body; 2] {
    loop {
        let a = diameter(rng);
        let b = a * rng.range(0.6, 1.0 / 0.6);
        let [a, b] = near(rng, meshes, [a, b], 1.0);
        if linking_number(&a, &b) != 0 && !surfaces_meet(&a, &b) {
            return [a, b];
        }
    }
}

/// Linked tubes, one of which was moved until they touched, and up to one part in a hundred farther.
pub fn linked_contact(rng: &mut Rng, meshes: [&Arc<Mesh>; 2]) -> [Body; 2] {
    let [a, b] = linked(rng, meshes);
    let way = rng.direction() * mean_diameter(&a, &b);
    // Linked tubes cannot separate without touching, and the steps are thinner than the tubes.
    let mut step = 0.0;
    while !surfaces_meet(&a, &b.moved(way * step)) {
        step += 0.01;
        assert!(step < 4.0, "linked tubes passed through each other: {a:?} {b:?}");
    }
    let touching = b.moved(way * step);
    let before = last_contact(&a, &touching, -way, 0.01f64.min(step));
    let mut deeper = rng.range(0.0, 0.01);
    // Tubes that graze each other separate again within this distance.
    while deeper > 1e-5 {
        let moved = touching.moved(way * (deeper - before));
        if surfaces_meet(&a, &moved) {
            return [a, moved];
        }
        deeper *= 0.5;
    }
    [a, touching]
}

/// Scales each axis by 0.3 to 1 and mirrors at random.
pub fn deform(rng: &mut Rng, body: &Body) -> Body {
    let mut axis = || (rng.range(0.3, 1.0) * if rng.chance(0.5) { -1.0 } else { 1.0 }) as f32;
    let factor = Vec3::new(axis(), axis(), axis());
    Body {
        scale: body.scale * factor,
        ..body.clone()
    }
}

/// A body within the open ball of the given radius about `center`, in the coordinates of `outer`, which has a uniform
/// scale.
pub fn placed_inside(rng: &mut Rng, outer: &Body, center: DVec3, radius: f64, mesh: &Arc<Mesh>) -> Body {
    let scale = f64::from(outer.scale.x);
    let diameter = radius * rng.range(0.2, 1.6);
    let slack = 0.99 * (radius - 0.5 * diameter);
    let place = outer.place(center + rng.in_ball(slack));
    Body::new(mesh, place, rng.rotation(), diameter * scale)
}
