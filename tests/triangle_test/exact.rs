//! `queries::check` against brute force with exact predicates, over many kinds of situations.

use crate::oracle::body::Body;
use crate::oracle::compare::Tally;
use crate::oracle::product::Product;
use crate::oracle::regimes::{REGIMES, Rule};
use crate::oracle::shapes::Shapes;
use bevy_faceoff::queries::check;
use glam::{DVec3, Quat, Vec3};

#[test]
fn check_finds_what_brute_force_finds() {
    // Enough to prove something.
    assert!(compare_regimes(1) >= 20_000);
}

/// `cargo test --release --features cli --test stages a_million_touching_pairs -- --ignored --nocapture`
#[test]
#[ignore = "takes ten minutes"]
fn a_million_touching_pairs() {
    assert!(compare_regimes(23) >= 1_000_000);
}

/// Compares so many times the usual number of cases of each regime, and returns the number of touching pairs.
fn compare_regimes(times: u64) -> usize {
    let shapes = Shapes::new();
    let product = Product::default();
    println!("{}", Tally::head());
    let tallies: Vec<(Rule, Tally)> = REGIMES
        .iter()
        .map(|regime| {
            let tally = regime.run(&shapes, times * regime.cases, &|bodies| product.check(bodies));
            println!("{}", tally.row(regime.name));
            (regime.rule, tally)
        })
        .collect();
    let all: Tally = tallies.iter().map(|(_, tally)| tally.clone()).sum();
    println!("{}", all.row("all"));
    all.require_no_failures();
    all.require_none_missed();
    // Where rounding decides by construction, any number may be forgiven; elsewhere very few.
    let general: Tally = tallies
        .into_iter()
        .filter(|(rule, _)| *rule != Rule::Rounding)
        .map(|(_, t)| t)
        .sum();
    general.require_few_forgiven();
    all.touching
}

#[test]
fn no_body_and_one_body_touch_nothing() {
    let body = Body::new(&Shapes::new().torus, DVec3::ZERO, Quat::IDENTITY, 1.0);
    assert_eq!(check(&[]), Ok(vec![]));
    assert_eq!(Product::default().check(&[body]), vec![]);
}

#[test]
fn a_placement_that_cannot_be_used_is_named() {
    let product = Product::default();
    let body = Body::new(&Shapes::new().torus, DVec3::ZERO, Quat::IDENTITY, 1.0);
    let refused = [
        Body {
            scale: Vec3::new(1.0, 0.0, 1.0),
            ..body.clone()
        },
        Body {
            scale: Vec3::new(1.0, f32::NAN, 1.0),
            ..body.clone()
        },
        Body {
            translation: Vec3::new(f32::NAN, 0.0, 0.0),
            ..body.clone()
        },
        Body {
            translation: Vec3::new(0.0, 0.0, f32::INFINITY),
            ..body.clone()
        },
        Body {
            rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0),
            ..body.clone()
        },
        Body {
            rotation: Quat::from_xyzw(0.0, f32::NAN, 0.0, 1.0),
            ..body.clone()
        },
    ];
    for bad in refused {
        let placements = [&body, &body, &bad].map(|body| product.placement(body));
        let error = check(&placements).expect_err("cannot be used");
        assert_eq!(error.body, 2, "{error}: {bad:?}");
    }
}
