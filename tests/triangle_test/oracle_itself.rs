//! The oracle tested on its own: against integer arithmetic, against itself without shortcuts, and in situations with
//! known answers.

use crate::oracle::body::{Body, Bounds, Mesh, World};
use crate::oracle::brute::{self, Touch};
use crate::oracle::compare::{Tally, compare};
use crate::oracle::inside::{inside, linking_number, winding_number};
use crate::oracle::lattice::{self, Point};
use crate::oracle::margin::{depth, distance, margin};
use crate::oracle::parallel;
use crate::oracle::regimes::{REGIMES, Rule};
use crate::oracle::rng::Rng;
use crate::oracle::shapes::Shapes;
use crate::oracle::tritri::{Triangle, coplanar, degenerate, meet};
use glam::{DVec3, Quat, Vec3};

#[test]
fn triangles_of_a_small_lattice_all_against_all() {
    let triangles = lattice::all_triangles(3);
    assert_eq!(
        triangles.len(),
        27 * 26 * 25 / 6 - 49,
        "three by three by three points have 49 lines of three"
    );
    let real: Vec<Triangle> = triangles.iter().map(lattice::real).collect();
    let met = parallel::map(triangles.len(), |i| {
        let mut met = 0;
        for j in 0..triangles.len() {
            // Both orders of a pair occur, with different corners first.
            let mut other = real[j];
            other.rotate_left((i + j) % 3);
            let expected = lattice::meet(&triangles[i], &triangles[j]);
            assert_eq!(meet(&real[i], &other), expected, "{:?} {other:?}", real[i]);
            met += usize::from(expected);
        }
        met
    });
    let met: usize = met.iter().sum();
    println!("{met} of {} pairs meet", triangles.len() * triangles.len());
}

#[test]
fn the_order_of_corners_does_not_matter() {
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let triangles: Vec<Triangle> = lattice::all_triangles(2).iter().map(lattice::real).collect();
    for a in &triangles {
        for b in &triangles {
            let expected = meet(a, b);
            for order in orders {
                for other in orders {
                    assert_eq!(
                        meet(&order.map(|i| a[i]), &other.map(|i| b[i])),
                        expected,
                        "{a:?} {b:?}"
                    );
                }
            }
        }
    }
}

/// Coordinates so large that determinants do not fit an `f64`, and corners within one unit of the other's plane, edges
/// or corners: only exact arithmetic decides these correctly.
#[test]
fn large_and_nearly_degenerate_triangles() {
    let mut rng = Rng::new(1, 1);
    let mut met = 0;
    for _ in 0..100_000 {
        let mut point = || -> Point { rng.in_cube(1e6).to_array().map(|c| c as i128) };
        let a = [point(), point(), point()];
        let mut b = [point(), point(), point()];
        for corner in &mut b {
            // An affine combination of a's corners with weights in quarters, rounded to the lattice.
            let [u, v] = [rng.below(9) as i128 - 3, rng.below(9) as i128 - 3];
            let off = [(); 3].map(|()| rng.below(3) as i128 - 1);
            if rng.chance(0.8) {
                *corner = [0, 1, 2].map(|k| a[0][k] + ((a[1][k] - a[0][k]) * u + (a[2][k] - a[0][k]) * v) / 4 + off[k]);
            }
        }
        if lattice::on_a_line(&a) || lattice::on_a_line(&b) {
            continue;
        }
        let expected = lattice::meet(&a, &b);
        assert_eq!(meet(&lattice::real(&a), &lattice::real(&b)), expected, "{a:?} {b:?}");
        met += usize::from(expected);
    }
    assert!(
        (10_000..90_000).contains(&met),
        "{met} meet, too one-sided to be a test"
    );
}

#[test]
fn degenerate_and_coplanar_are_exact() {
    let t = [DVec3::ZERO, DVec3::new(1.0, 1.0, 1.0), DVec3::new(3.0, 3.0, 3.0)];
    assert!(degenerate(&t));
    assert!(!degenerate(&[t[0], t[1], t[2] + DVec3::X * f64::EPSILON * 4.0]));
    let flat = [DVec3::ZERO, DVec3::X, DVec3::Y];
    assert!(coplanar(&flat, &flat.map(|p| p + DVec3::X * 5.0)));
    assert!(!coplanar(&flat, &[DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 1e-300)]));
}

fn random_triangle(rng: &mut Rng, spread: f64) -> Triangle {
    let center = rng.in_cube(spread);
    [(); 3].map(|()| center + rng.in_ball(1.0))
}

/// No shift shorter than the margin changes an answer; otherwise the product would be blamed wrongly.
#[test]
fn margins_are_not_too_large() {
    let mut rng = Rng::new(2, 1);
    for _ in 0..3000 {
        let [a, b] = [random_triangle(&mut rng, 0.7), random_triangle(&mut rng, 0.7)];
        let expected = meet(&a, &b);
        let margin = margin(&a, &b);
        for _ in 0..40 {
            let shift = rng.direction() * margin * 0.999;
            assert_eq!(
                meet(&a, &b.map(|p| p + shift)),
                expected,
                "margin {margin} of {a:?} {b:?}"
            );
        }
    }
}

/// Some shift slightly longer than the margin changes the answer; otherwise the product would be forgiven too much.
#[test]
fn margins_are_not_too_small() {
    let mut rng = Rng::new(3, 1);
    let [mut apart, mut together] = [0, 0];
    while apart < 200 || together < 200 {
        let [a, b] = [random_triangle(&mut rng, 0.7), random_triangle(&mut rng, 0.7)];
        if meet(&a, &b) {
            together += 1;
            let depth = depth(&a, &b);
            let parts = |_| !meet(&a, &b.map(|p| p + rng.direction() * depth * 1.1));
            assert!((0..20_000).any(parts), "no direction parts {a:?} {b:?} by {depth}");
        } else {
            apart += 1;
            // Sample points a thirtieth of an edge apart on both: the closest two are nearly as close as the triangles.
            let points = |t: &Triangle| -> Vec<DVec3> {
                let [e, f] = [(t[1] - t[0]) / 30.0, (t[2] - t[0]) / 30.0];
                let at = |i: i32, j: i32| t[0] + e * f64::from(i) + f * f64::from(j);
                (0..=30).flat_map(|i| (0..=30 - i).map(move |j| at(i, j))).collect()
            };
            let [of_a, of_b] = [points(&a), points(&b)];
            let pairs = of_a.iter().flat_map(|p| of_b.iter().map(|q| p.distance(*q)));
            let sampled = pairs.fold(f64::INFINITY, f64::min);
            let exact = distance(&a, &b);
            assert!(
                exact <= sampled + 1e-12 && sampled < exact + 0.1,
                "{exact} against {sampled}: {a:?} {b:?}"
            );
        }
    }
}

#[test]
fn margins_of_known_pairs() {
    let flat = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let near = |x: f64, y: f64| assert!((x - y).abs() < 1e-12, "{x} should be {y}");
    near(margin(&flat, &flat.map(|p| p + DVec3::Z * 0.25)), 0.25);
    near(margin(&flat, &flat), 0.0);
    near(margin(&flat, &flat.map(|p| p - DVec3::X * 3.0)), 2.0);
    // A needle that pierces the middle of the hypotenuse by 0.125.
    let needle = [
        DVec3::new(0.25, 0.25, -0.125),
        DVec3::new(0.25, 0.26, 5.0),
        DVec3::new(0.26, 0.25, 5.0),
    ];
    near(margin(&flat, &needle), 0.125);
    // Crossing edges, 0.5 apart.
    let across = [
        DVec3::new(0.5, -1.0, -0.5),
        DVec3::new(0.5, 1.0, -0.5),
        DVec3::new(0.5, 0.0, -9.0),
    ];
    near(margin(&flat, &across), 0.5);
}

#[test]
fn windings_and_links_of_known_bodies() {
    let shapes = Shapes::new();
    let at = |mesh, place: DVec3| Body::new(mesh, place, Quat::IDENTITY, 1.0);
    let torus = at(&shapes.torus, DVec3::ZERO).world();
    let winding = |p: DVec3, world: &World| (winding_number(p, &world.triangles) * 1e9).round() * 1e-9;
    assert_eq!(winding(DVec3::ZERO, &torus), 0.0);
    assert_eq!(winding(DVec3::X * 0.35, &torus), 1.0);
    assert_eq!(winding(DVec3::X * 3.0, &torus), 0.0);
    assert_eq!(
        winding(DVec3::ZERO, &at(&shapes.inward_ball, DVec3::ZERO).world()),
        -1.0
    );
    assert_eq!(winding(DVec3::ZERO, &at(&shapes.hollow_ball, DVec3::ZERO).world()), 0.0);
    assert_eq!(
        winding(DVec3::X * 0.4, &at(&shapes.hollow_ball, DVec3::ZERO).world()),
        1.0
    );
    assert!(inside(DVec3::X * 0.35, &torus));
    assert!(
        !inside(DVec3::ZERO, &at(&shapes.soups[0], DVec3::ZERO).world()),
        "nothing is inside an open mesh"
    );

    let ring = at(&shapes.ring, DVec3::ZERO);
    let upright = Quat::from_xyzw(0.5f32.sqrt(), 0.0, 0.0, 0.5f32.sqrt());
    let turned = |place: DVec3| Body::new(&shapes.ring, place, upright, 1.0);
    assert_eq!(linking_number(&ring, &turned(DVec3::new(0.45, 0.02, 0.0))).abs(), 1);
    assert_eq!(linking_number(&ring, &turned(DVec3::new(2.0, 0.02, 0.0))), 0);
    assert_eq!(
        linking_number(&ring, &turned(DVec3::new(0.0, 0.02, 0.0))),
        0,
        "passes through the hole twice"
    );
}

#[test]
fn the_meshes_are_what_they_are_called() {
    let shapes = Shapes::new();
    let facts = |mesh: &Mesh| (mesh.solid.len(), mesh.closed, mesh.components.len());
    assert_eq!(facts(&shapes.torus), (240, true, 1));
    assert_eq!(facts(&shapes.knot), (1120, true, 1));
    assert_eq!(facts(&shapes.ball), (128, true, 1));
    assert_eq!(facts(&shapes.cube), (12, true, 1));
    assert_eq!(facts(&shapes.hollow_ball), (256, true, 2));
    assert_eq!(facts(&shapes.two_balls), (256, true, 2));
    assert_eq!(facts(&shapes.unwelded_torus), (240, true, 1));
    assert_eq!(shapes.unwelded_torus.faces.len(), 275);
    assert_eq!(facts(&shapes.half_tori[0]), (120, false, 1));
    assert_eq!(facts(&shapes.soups[0]), (60, false, 60));
    for solid in shapes.solids() {
        assert!(solid.closed && solid.components.len() == 1, "{}", solid.name);
        let world = Body::new(solid, DVec3::ZERO, Quat::IDENTITY, 1.0).world();
        let volume: f64 = world.triangles.iter().map(|[a, b, c]| a.dot(b.cross(*c)) / 6.0).sum();
        assert!(volume > 0.0, "{} is inside out", solid.name);
        let reach = world.triangles.iter().flatten().map(|p| p.length()).fold(0.0, f64::max);
        assert!((reach - 0.5).abs() < 1e-6, "{} reaches {reach}", solid.name);
    }
}

#[test]
fn quaternions_of_any_length_and_exact_ones() {
    let shapes = Shapes::new();
    let p = DVec3::new(1.0, 2.0, 3.0);
    let turned = |q: [f32; 4]| Body {
        rotation: Quat::from_array(q),
        ..Body::new(&shapes.cube, DVec3::new(10.0, 0.0, 0.0), Quat::IDENTITY, 2.0)
    };
    assert_eq!(turned([0.0, 0.0, 0.0, 3.0]).place(p), DVec3::new(12.0, 4.0, 6.0));
    assert_eq!(turned([0.0, 0.0, 1.0, 0.0]).place(p), DVec3::new(8.0, -4.0, 6.0));
    assert_eq!(turned([0.5, 0.5, 0.5, 0.5]).place(p), DVec3::new(16.0, 2.0, 4.0));
    let quarter = turned([0.0, 0.0, 1.0, 1.0]).place(p);
    assert!(quarter.abs_diff_eq(DVec3::new(6.0, 2.0, 6.0), 1e-12), "{quarter}");
    let q = turned([0.1, -0.2, 0.3, 0.9]);
    let library = q.translation.as_dvec3() + q.rotation.as_dquat().normalize() * (p * 2.0);
    assert!(q.place(p).abs_diff_eq(library, 1e-12));
}

/// The box tests and the sorting before the triangle test lose nothing.
#[test]
fn brute_force_without_shortcuts() {
    let shapes = Shapes::new();
    let mut found = 0;
    for regime in REGIMES
        .iter()
        .filter(|regime| regime.cases >= 100 && regime.rule != Rule::Exact)
    {
        for case in 1000..1004 {
            let worlds: Vec<World> = regime.bodies(&shapes, case).iter().map(Body::world).collect();
            let [a, b] = &worlds[..] else { continue };
            let mut expected = vec![];
            for (s, f) in a.triangles.iter().zip(&a.faces) {
                let meeting = b.triangles.iter().zip(&b.faces).filter(|(t, _)| meet(s, t));
                expected.extend(meeting.map(|(_, g)| [*f, *g]));
            }
            expected.sort_unstable();
            assert_eq!(brute::face_pairs(a, b), expected, "{}", regime.name);
            found += expected.len();
        }
    }
    assert!(found > 1000, "{found}");
}

/// The oracle's answer for bodies whose corners are perturbed by about the rounding of `f32`.
fn rounded_answer(bodies: &[Body]) -> Vec<Touch> {
    let mut rng = Rng::new(9, bodies[0].translation.x.to_bits().into());
    let mut worlds: Vec<World> = bodies.iter().map(Body::world).collect();
    for world in &mut worlds {
        // Equal corners are perturbed equally, as by rounding.
        let mut moved = std::collections::HashMap::new();
        for t in &mut world.triangles {
            for p in t {
                let key = p.to_array().map(f64::to_bits);
                *p += *moved.entry(key).or_insert_with(|| rng.in_cube(5e-8 * world.radius));
            }
        }
        world.boxes = world.triangles.iter().map(|t| Bounds::around(t)).collect();
    }
    brute::check(&worlds)
}

/// Rounded answers pass in every regime that allows rounding: the limits are fair.
#[test]
fn an_answer_with_rounded_corners_is_accepted() {
    let shapes = Shapes::new();
    println!("{}", Tally::head());
    let tallies = REGIMES.iter().map(|regime| {
        let cases = regime.cases.div_ceil(10).min(200);
        let exact = |bodies: &[Body]| brute::check(&bodies.iter().map(Body::world).collect::<Vec<_>>());
        let tally = regime.run(
            &shapes,
            cases,
            if regime.rule == Rule::Exact {
                &exact
            } else {
                &rounded_answer
            },
        );
        println!("{}", tally.row(regime.name));
        (regime.rule, tally)
    });
    let tallies: Vec<(Rule, Tally)> = tallies.collect();
    tallies
        .iter()
        .map(|(_, tally)| tally.clone())
        .sum::<Tally>()
        .require_no_failures();
    tallies
        .into_iter()
        .filter(|(rule, _)| *rule == Rule::General)
        .map(|(_, t)| t)
        .sum::<Tally>()
        .require_few_forgiven();
}

/// The comparison refuses wrong answers.
#[test]
fn wrong_answers_are_refused() {
    let shapes = Shapes::new();
    let at = |mesh, x: f64, scale| Body::new(mesh, DVec3::X * x, Quat::IDENTITY, scale);
    // 0 and 1 cross, 2 lies inside 3, 4 is alone.
    let bodies = [
        at(&shapes.torus, 0.0, 1.0),
        at(&shapes.ball, 0.4, 0.7),
        at(&shapes.ball, 5.0, 0.5),
        at(&shapes.ball, 5.0, 2.0),
        at(&shapes.cube, 9.0, 1.0),
    ];
    let worlds: Vec<World> = bodies.iter().map(Body::world).collect();
    let truth = brute::check(&worlds);
    assert_eq!(truth.len(), 2);
    assert!(truth[0].faces.len() > 10 && truth[1].contained);
    let failures = |change: &dyn Fn(&mut Vec<Touch>)| {
        let mut answer = truth.clone();
        change(&mut answer);
        compare("", &bodies, &worlds, &truth, &answer).failures.len()
    };
    assert_eq!(failures(&|_| ()), 0);
    assert_eq!(failures(&|answer| drop(answer.remove(0))), 1);
    assert_eq!(failures(&|answer| drop(answer.remove(1))), 1);
    assert_eq!(failures(&|answer| answer[0].faces.truncate(5)), 1);
    assert_eq!(failures(&|answer| answer[0].faces.push([239, 127])), 1);
    assert_eq!(failures(&|answer| answer[0].faces.push([300, 0])), 1);
    assert!(failures(&|answer| answer[0].faces.swap(0, 1)) >= 1);
    assert!(failures(&|answer| answer.swap(0, 1)) >= 1);
    assert!(failures(&|answer| answer[0].contained = true) >= 1);
    assert!(failures(&|answer| answer[1].contained = false) >= 1);
    let alone = Touch {
        a: 1,
        b: 4,
        contained: true,
        faces: vec![],
    };
    assert!(failures(&|answer| answer.insert(1, alone.clone())) >= 1);
}

/// Two boxes that share one face: a rounded answer may lose it, and the difference is counted.
#[test]
fn a_difference_within_the_margin_is_counted() {
    let shapes = Shapes::new();
    let bodies = [Vec3::ZERO, Vec3::X].map(|p| Body::new(&shapes.unit_cube, p.as_dvec3(), Quat::IDENTITY, 1.0));
    let worlds = bodies.each_ref().map(Body::world);
    let truth = brute::check(&worlds);
    assert!(!truth[0].faces.is_empty());
    let tally = compare("", &bodies, &worlds, &truth, &[]);
    assert_eq!((tally.failures.len(), tally.forgiven), (0, truth[0].faces.len()));
}
