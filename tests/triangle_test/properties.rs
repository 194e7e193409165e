//! What must not matter to `queries::check`: the order of bodies, and where the world is.

use crate::oracle::body::{Body, World};
use crate::oracle::brute::Touch;
use crate::oracle::margin::margin;
use crate::oracle::product::Product;
use crate::oracle::regimes::REGIMES;
use crate::oracle::rng::Rng;
use crate::oracle::shapes::Shapes;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Faces of two bodies, the one with the lower number first.
type Faces = BTreeMap<(u32, u32), BTreeSet<[u32; 2]>>;

/// Worlds of many bodies of all shapes.
fn crowds() -> Vec<Vec<Body>> {
    let shapes = Shapes::new();
    let crowded = REGIMES.iter().filter(|regime| regime.name.starts_with("500 bodies"));
    let crowds: Vec<_> = crowded
        .flat_map(|regime| [0, 1].map(|case| regime.bodies(&shapes, case)))
        .collect();
    assert_eq!(crowds.len(), 4);
    crowds
}

/// Face pairs by bodies, whose numbers `name` maps to others.
fn faces_of(touches: &[Touch], name: impl Fn(u32) -> u32) -> Faces {
    let named = touches.iter().map(|touch| {
        let (a, b) = (name(touch.a), name(touch.b));
        let turned = |&[f, g]: &[u32; 2]| if a < b { [f, g] } else { [g, f] };
        ((a.min(b), a.max(b)), touch.faces.iter().map(turned).collect())
    });
    named.collect()
}

#[test]
fn the_order_of_bodies_does_not_matter() {
    let product = Product::default();
    let mut rng = Rng::new(1, 0);
    for bodies in crowds() {
        let mut order: Vec<u32> = (0..bodies.len() as u32).collect();
        for i in (1..order.len()).rev() {
            order.swap(i, rng.below(i + 1));
        }
        let shuffled: Vec<Body> = order.iter().map(|&i| bodies[i as usize].clone()).collect();
        let expected = faces_of(&product.check(&bodies), |i| i);
        let found = faces_of(&product.check(&shuffled), |i| order[i as usize]);
        assert!(expected.len() > 50, "{} touching pairs", expected.len());
        assert!(
            expected == found,
            "{} and {} touching pairs",
            expected.len(),
            found.len()
        );
    }
}

/// Only faces so close to the opposite answer may differ, in units of the bodies' size. Positions and rotations are
/// rounded anew when the world moves: by 6e-8 of the distance from the origin, which is up to 20 sizes of a small body.
const BAND: f64 = 2e-6;

/// Requires the same faces, but for those in the band. Returns how many differ.
fn compare(what: &str, worlds: &[World], expected: &Faces, found: &Faces, band: f64) -> usize {
    let none = BTreeSet::new();
    let mut differ = 0;
    let pairs: BTreeSet<_> = expected.keys().chain(found.keys()).collect();
    for pair in pairs {
        let [one, other] = [expected, found].map(|faces| faces.get(pair).unwrap_or(&none));
        let [a, b] = [&worlds[pair.0 as usize], &worlds[pair.1 as usize]];
        for faces in one.symmetric_difference(other) {
            let [s, t] = [a.triangle(faces[0]).unwrap(), b.triangle(faces[1]).unwrap()];
            let relative = margin(s, t) / (a.radius + b.radius);
            assert!(
                relative < band,
                "{what}: bodies {pair:?}, faces {faces:?}, margin {relative:.1e}"
            );
            differ += 1;
        }
    }
    differ
}

#[test]
fn moving_and_turning_the_world_changes_no_contact() {
    let product = Product::default();
    let mut rng = Rng::new(2, 0);
    let (mut all, mut differ) = (0, 0);
    for bodies in crowds() {
        let worlds: Vec<World> = bodies.iter().map(Body::world).collect();
        let expected = faces_of(&product.check(&bodies), |i| i);
        all += expected.values().map(BTreeSet::len).sum::<usize>();
        // Single precision keeps 3e-8 of each distance.
        for (distance, band) in [(1.0, BAND), (10.0, BAND), (1000.0, 1e-3)] {
            let by = rng.direction() * distance;
            let moved: Vec<Body> = bodies.iter().map(|body| body.moved(by)).collect();
            let found = faces_of(&product.check(&moved), |i| i);
            differ += compare(&format!("moved by {distance} m"), &worlds, &expected, &found, band);
        }
        let turn = rng.rotation();
        let turned = |body: &Body| Body {
            translation: turn.as_dquat().mul_vec3(body.translation.as_dvec3()).as_vec3(),
            rotation: (turn.as_dquat() * body.rotation.as_dquat()).as_quat(),
            ..body.clone()
        };
        let turned: Vec<Body> = bodies.iter().map(turned).collect();
        let found = faces_of(&product.check(&turned), |i| i);
        differ += compare("turned", &worlds, &expected, &found, BAND);
    }
    assert!(all > 5_000, "{all} pairs of faces");
    println!("{differ} answers of 4 times {all} differ");
}

#[test]
fn a_shift_without_rounding_changes_nothing() {
    let product = Product::default();
    let grid = |x: f32| (x * 1024.0).round() / 1024.0;
    for bodies in crowds() {
        let on_grid = |body: &Body| Body {
            translation: body.translation.to_array().map(grid).into(),
            ..body.clone()
        };
        let bodies: Vec<Body> = bodies.iter().map(on_grid).collect();
        // Up to 8192 m, 24 bits hold multiples of a thousandth.
        let moved: Vec<Body> = bodies
            .iter()
            .map(|body| body.moved(DVec3::new(4096.0, -512.0, 2048.0)))
            .collect();
        let [here, there] = [&bodies, &moved].map(|bodies| faces_of(&product.check(bodies), |i| i));
        assert!(here == there, "{} and {} touching pairs", here.len(), there.len());
    }
}
