//! The regimes: a table of situations in which the product is compared with the oracle, and code that runs them.

use super::body::{Body, Mesh};
use super::brute::{self, Touch};
use super::compare::{Tally, compare};
use super::generators::{contact, deform, diameter, linked, linked_contact, near, placed_inside, scene};
use super::parallel;
use super::rng::Rng;
use super::shapes::Shapes;
use glam::{DVec3, Quat, Vec3};
use std::sync::Arc;
use std::time::Instant;

/// How a disagreement on a pair of faces is judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// All coordinates are exact in `f32`: no disagreement is allowed.
    Exact,
    /// Forgiven within the margin, for at most one pair in 100,000.
    General,
    /// Always forgiven within the margin. Rounding decides many pairs: surfaces coincide, or one body is so small that
    /// the margin, which scales with the larger one, is not small for it.
    Rounding,
}

/// A property that holds for every pair by construction, whatever the oracle finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expect {
    Any,
    Touching,
    Apart,
    Contained,
}

/// A situation, its number of cases, and how to make one.
pub struct Regime {
    pub name: &'static str,
    pub cases: u64,
    pub rule: Rule,
    pub expect: Expect,
    make: fn(&Shapes, &mut Rng) -> Vec<Body>,
}

const fn general(name: &'static str, cases: u64, expect: Expect, make: fn(&Shapes, &mut Rng) -> Vec<Body>) -> Regime {
    Regime {
        name,
        cases,
        rule: Rule::General,
        expect,
        make,
    }
}

/// All regimes.
pub const REGIMES: &[Regime] = &[
    general("scene, tori", 6000, Expect::Any, |s, r| {
        scene(r, [&s.torus, &s.torus]).into()
    }),
    general("scene, knots", 3000, Expect::Any, |s, r| {
        scene(r, [&s.knot, &s.knot]).into()
    }),
    general("scene, any", 8000, Expect::Any, |s, r| {
        let meshes = s.two(r);
        scene(r, meshes).into()
    }),
    general("contact, tori", 2000, Expect::Any, |s, r| {
        let depth = r.range(0.001, 0.05);
        contact(r, [&s.torus, &s.torus], depth).into()
    }),
    general("contact, knots", 1000, Expect::Any, |s, r| {
        let depth = r.range(0.001, 0.05);
        contact(r, [&s.knot, &s.knot], depth).into()
    }),
    general("contact 0.1 %, any", 2000, Expect::Any, |s, r| {
        let meshes = s.two(r);
        contact(r, meshes, 0.001).into()
    }),
    general("contact, any", 2000, Expect::Any, |s, r| {
        let (meshes, depth) = (s.two(r), r.range(0.001, 0.05));
        contact(r, meshes, depth).into()
    }),
    general("deep, tori", 3000, Expect::Any, |s, r| deep(r, [&s.torus, &s.torus])),
    general("deep, knots", 1000, Expect::Any, |s, r| deep(r, [&s.knot, &s.knot])),
    general("deep, any", 3000, Expect::Any, |s, r| {
        let meshes = s.two(r);
        deep(r, meshes)
    }),
    general("linked rings, apart", 500, Expect::Apart, |s, r| {
        linked(r, [&s.ring, &s.ring]).into()
    }),
    general("linked thin knots, apart", 100, Expect::Apart, |s, r| {
        linked(r, [&s.thin_knot, &s.thin_knot]).into()
    }),
    general("linked tori, apart", 10, Expect::Apart, |s, r| {
        linked(r, [&s.torus, &s.torus]).into()
    }),
    general("linked rings", 600, Expect::Touching, |s, r| {
        linked_contact(r, [&s.ring, &s.ring]).into()
    }),
    general("linked tori", 10, Expect::Touching, |s, r| {
        linked_contact(r, [&s.torus, &s.torus]).into()
    }),
    general("linked ring, knot", 100, Expect::Touching, |s, r| {
        linked_contact(r, [&s.ring, &s.knot]).into()
    }),
    general("linked thin knots", 100, Expect::Touching, |s, r| {
        linked_contact(r, [&s.thin_knot, &s.thin_knot]).into()
    }),
    general("size 1 to 8", 3000, Expect::Any, |s, r| {
        let large = diameter(r);
        let sizes = if r.chance(0.5) {
            [large, large / 8.0]
        } else {
            [large / 8.0, large]
        };
        let meshes = s.two(r);
        near(r, meshes, sizes, 1.0).into()
    }),
    Regime {
        name: "size 1 to 200",
        cases: 1000,
        rule: Rule::Rounding,
        expect: Expect::Any,
        make: |s, r| dwarf_at_giant(s, r, 200.0),
    },
    Regime {
        name: "size 1 to 1000",
        cases: 500,
        rule: Rule::Rounding,
        expect: Expect::Any,
        make: |s, r| dwarf_at_giant(s, r, 1000.0),
    },
    general("stretched, mirrored", 4000, Expect::Any, |s, r| {
        let pair = near_by(s, r);
        pair.iter().map(|body| deform(r, body)).collect()
    }),
    general("far from the origin", 1500, Expect::Any, |s, r| {
        let offset = r.direction() * 1e4;
        near_by(s, r).iter().map(|body| body.moved(offset)).collect()
    }),
    general("tiny, 0.02", 1500, Expect::Any, |s, r| resized(s, r, 0.02)),
    general("tiny, 1e-5", 1500, Expect::Any, |s, r| resized(s, r, 1e-5)),
    general("tiny, 1e-7", 1500, Expect::Any, |s, r| resized(s, r, 1e-7)),
    general("large, 1e4", 1500, Expect::Any, |s, r| resized(s, r, 1e4)),
    general("large, 5e7", 1500, Expect::Any, |s, r| resized(s, r, 5e7)),
    general("one triangle", 2000, Expect::Any, |s, r| {
        let other = if r.chance(0.3) { &s.triangle } else { s.any(r) };
        let meshes = if r.chance(0.5) {
            [&s.triangle, other]
        } else {
            [other, &s.triangle]
        };
        let sizes = [diameter(r), diameter(r)];
        near(r, meshes, sizes, 0.6).into()
    }),
    general("contained", 1500, Expect::Contained, contained),
    general("in holes, apart", 600, Expect::Apart, in_holes),
    Regime {
        name: "stacked boxes",
        cases: 300,
        rule: Rule::Exact,
        expect: Expect::Any,
        make: stacked_boxes,
    },
    Regime {
        name: "27 cubes",
        cases: 20,
        rule: Rule::Exact,
        expect: Expect::Touching,
        make: cube_of_cubes,
    },
    Regime {
        name: "coincident",
        cases: 300,
        rule: Rule::Rounding,
        expect: Expect::Touching,
        make: coincident,
    },
    Regime {
        name: "common edges",
        cases: 100,
        rule: Rule::Rounding,
        expect: Expect::Any,
        make: common_edges,
    },
    general("500 bodies", 6, Expect::Any, |s, r| crowd(s, r, 13.7)),
    general("500 bodies, dense", 3, Expect::Any, |s, r| crowd(s, r, 8.0)),
];

fn deep(rng: &mut Rng, meshes: [&Arc<Mesh>; 2]) -> Vec<Body> {
    let sizes = [diameter(rng), diameter(rng)];
    near(rng, meshes, sizes, 0.5).into()
}

fn near_by(shapes: &Shapes, rng: &mut Rng) -> [Body; 2] {
    let sizes = [diameter(rng), diameter(rng)];
    let meshes = shapes.two(rng);
    near(rng, meshes, sizes, 0.7)
}

/// A body near a vertex of one that is `ratio` times as large.
fn dwarf_at_giant(shapes: &Shapes, rng: &mut Rng, ratio: f64) -> Vec<Body> {
    let meshes = shapes.two(rng);
    let giant = Body::new(meshes[0], rng.in_cube(5.0), rng.rotation(), diameter(rng));
    let diameter = f64::from(giant.scale.x) / ratio;
    let place = giant.place(rng.pick(&meshes[0].vertices).as_dvec3()) + rng.in_ball(0.5 * diameter);
    let dwarf = Body::new(meshes[1], place, rng.rotation(), diameter);
    if rng.chance(0.5) {
        vec![dwarf, giant]
    } else {
        vec![giant, dwarf]
    }
}

fn resized(shapes: &Shapes, rng: &mut Rng, diameter: f64) -> Vec<Body> {
    let ratio = rng.range(0.5, 2.0);
    let meshes = shapes.two(rng);
    let [a, b] = near(rng, meshes, [1.0, ratio], 0.7);
    // Scaled about the first body, and placed a few diameters from the origin.
    let place = rng.in_ball(10.0 * diameter);
    let origin = a.translation.as_dvec3();
    let resized_body = |body: &Body| Body {
        translation: (place + (body.translation.as_dvec3() - origin) * diameter).as_vec3(),
        scale: body.scale * diameter as f32,
        ..body.clone()
    };
    vec![resized_body(&a), resized_body(&b)]
}

/// A body inside the material of a closed one, in a part known to contain a ball.
fn contained(shapes: &Shapes, rng: &mut Rng) -> Vec<Body> {
    let s = shapes;
    let torus_core = *rng.pick(&s.torus.core);
    let shell = rng.direction() * 0.385;
    // The outer mesh, and a ball inside its material: centre and radius.
    let places = [
        (&s.ball, DVec3::ZERO, 0.46),
        (&s.inward_ball, DVec3::ZERO, 0.46),
        (&s.cube, DVec3::ZERO, 0.28),
        (&s.torus, torus_core, 0.12),
        (&s.unwelded_torus, torus_core, 0.12),
        (&s.two_balls, DVec3::X * 0.35, 0.13),
        (&s.hollow_ball, shell, 0.08),
    ];
    let &(mesh, center, radius) = rng.pick(&places);
    let outer = Body::new(mesh, rng.in_cube(5.0), rng.rotation(), diameter(rng));
    let inner = match rng.below(4) {
        0 => rng.pick(&s.soups),
        1 => &s.triangle,
        2 => &s.ring,
        _ => s.any(rng),
    };
    let mut bodies = vec![placed_inside(rng, &outer, center, radius, inner), outer];
    if rng.chance(0.2) {
        // It is enough that one of two components is inside: a ball around one end.
        let pair = Body::new(&s.two_balls, rng.in_cube(5.0), rng.rotation(), diameter(rng));
        let ball = Body::new(
            &s.ball,
            pair.place(DVec3::X * 0.35),
            rng.rotation(),
            f64::from(pair.scale.x) * 0.8,
        );
        bodies = vec![ball, pair];
    } else if rng.chance(0.3) {
        let mirror = Vec3::new(-1.0, 1.0, 1.0);
        bodies.iter_mut().for_each(|body| body.scale *= mirror);
        // The mirror acts along the outer body's own axes, so the inner body must follow.
        let outer = bodies[1].clone();
        bodies[0].translation = (outer.place(center)).as_vec3();
    }
    if rng.chance(0.5) {
        bodies.reverse();
    }
    bodies
}

/// A body in a hole of another, so not contained: in the ring of a torus, in a hollow ball, between two balls.
fn in_holes(shapes: &Shapes, rng: &mut Rng) -> Vec<Body> {
    let s = shapes;
    let places = [
        (&s.torus, 0.18),
        (&s.ring, 0.4),
        (&s.hollow_ball, 0.27),
        (&s.two_balls, 0.18),
    ];
    let &(mesh, radius) = rng.pick(&places);
    let outer = Body::new(mesh, rng.in_cube(5.0), rng.rotation(), diameter(rng));
    let inner = s.any(rng);
    let inner = placed_inside(rng, &outer, DVec3::ZERO, radius, inner);
    if rng.chance(0.5) {
        vec![inner, outer]
    } else {
        vec![outer, inner]
    }
}

/// A random rotation that maps axes to axes and is exact in `f32`: half turns, and turns about a diagonal.
fn exact_rotation(rng: &mut Rng) -> Quat {
    if rng.chance(0.5) {
        let mut q = [0.0; 4];
        q[rng.below(4)] = 1.0;
        Quat::from_array(q)
    } else {
        Quat::from_array([(); 4].map(|()| if rng.chance(0.5) { 0.5 } else { -0.5 }))
    }
}

/// Boxes with corners on a lattice: they share faces, edges and corners exactly, overlap, and contain each other.
fn stacked_boxes(shapes: &Shapes, rng: &mut Rng) -> Vec<Body> {
    let corner = rng.in_cube(16.0).round();
    let mut coordinate = |count: usize, step: f64| step * rng.below(count) as f64;
    let places: Vec<DVec3> = (0..12)
        .map(|_| DVec3::new(coordinate(7, 0.5), coordinate(7, 0.5), coordinate(7, 0.5)))
        .collect();
    places
        .iter()
        .map(|&place| {
            let edge = [(); 3].map(|()| *rng.pick(&[0.5, 1.0, 2.0, -0.5, -1.0, -2.0]));
            let rotation = exact_rotation(rng);
            Body {
                scale: Vec3::from_array(edge),
                ..Body::new(&shapes.unit_cube, corner + place, rotation, 1.0)
            }
        })
        .collect()
}

/// A stack of three by three by three unit cubes: neighbours share a face, an edge or a corner; others are a distance
/// of one apart.
fn cube_of_cubes(shapes: &Shapes, rng: &mut Rng) -> Vec<Body> {
    let corner = rng.in_cube(100.0).round();
    let places = (0..27).map(|i| DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)));
    places
        .map(|place| Body::new(&shapes.unit_cube, corner + place, exact_rotation(rng), 1.0))
        .collect()
}

/// Two equal closed bodies in the same pose.
fn coincident(shapes: &Shapes, rng: &mut Rng) -> Vec<Body> {
    let mesh = *rng.pick(&shapes.solids());
    let body = Body::new(mesh, rng.in_cube(5.0), rng.rotation(), diameter(rng));
    vec![body.clone(), body]
}

/// Two parts of a torus in the same pose: they share edges.
fn common_edges(shapes: &Shapes, rng: &mut Rng) -> Vec<Body> {
    let [a, b] = &shapes.half_tori;
    let body = Body::new(a, rng.in_cube(5.0), rng.rotation(), diameter(rng));
    vec![
        body.clone(),
        Body {
            mesh: b.clone(),
            ..body
        },
    ]
}

/// 500 bodies in a cube of the given side.
fn crowd(shapes: &Shapes, rng: &mut Rng, side: f64) -> Vec<Body> {
    (0..500)
        .map(|_| Body::new(shapes.any(rng), rng.in_cube(0.5 * side), rng.rotation(), diameter(rng)))
        .collect()
}

impl Regime {
    /// The bodies of one case. They depend only on its number.
    pub fn bodies(&self, shapes: &Shapes, case: u64) -> Vec<Body> {
        let seed = self
            .name
            .bytes()
            .fold(7u64, |h, b| h.wrapping_mul(31).wrapping_add(u64::from(b)));
        (self.make)(shapes, &mut Rng::new(seed, case))
    }

    /// Compares `answer` with the oracle on the first `cases` cases.
    pub fn run(&self, shapes: &Shapes, cases: u64, answer: &(dyn Fn(&[Body]) -> Vec<Touch> + Sync)) -> Tally {
        let tallies = parallel::map(cases as usize, |case| self.run_case(shapes, case as u64, answer));
        let mut tally: Tally = tallies.into_iter().sum();
        if self.rule == Rule::Exact && tally.forgiven > 0 {
            tally.failures.push(format!(
                "{}: {} face pairs differ, and none may",
                self.name, tally.forgiven
            ));
        }
        tally
    }

    fn run_case(&self, shapes: &Shapes, case: u64, answer: &dyn Fn(&[Body]) -> Vec<Touch>) -> Tally {
        let label = format!("{} case {case}", self.name);
        let start = Instant::now();
        let bodies = self.bodies(shapes, case);
        let worlds: Vec<_> = bodies.iter().map(Body::world).collect();
        let truth = brute::check(&worlds);
        let oracle_done = Instant::now();
        let answer = answer(&bodies);
        let seconds = [(oracle_done - start).as_secs_f64(), oracle_done.elapsed().as_secs_f64()];
        let mut tally = Tally {
            seconds,
            ..compare(&label, &bodies, &worlds, &truth, &answer)
        };
        for (who, touches) in [("oracle", &truth), ("product", &answer)] {
            if !self.expected(&bodies, touches) {
                tally.failures.push(format!(
                    "{label}: the {who} does not find {:?}: {bodies:?}",
                    self.expect
                ));
            }
        }
        tally
    }

    fn expected(&self, bodies: &[Body], touches: &[Touch]) -> bool {
        match self.expect {
            Expect::Any => true,
            Expect::Apart => touches.is_empty(),
            Expect::Contained => touches.len() == 1 && touches[0].contained,
            Expect::Touching => {
                // Two bodies must touch; cubes on a lattice touch if no coordinate differs by more than one.
                let near = |a: &Body, b: &Body| (a.translation - b.translation).abs().max_element() <= 1.0;
                let all = |i: usize| {
                    bodies[i + 1..]
                        .iter()
                        .filter(|b| bodies.len() == 2 || near(&bodies[i], b))
                        .count()
                };
                touches.len() == (0..bodies.len()).map(all).sum::<usize>()
            }
        }
    }
}
