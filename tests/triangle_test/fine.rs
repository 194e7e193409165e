//! `queries::check` and `queries::touching` against brute force on meshes so fine that both trees are traversed:
//! thousands of triangles each, tens of thousands in a few cases.

use crate::oracle::body::{Body, Mesh};
use crate::oracle::brute;
use crate::oracle::compare::{Tally, compare};
use crate::oracle::generators::{contact, deform, diameter, near, placed_inside};
use crate::oracle::parallel;
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use crate::oracle::shapes::Shapes;
use glam::{DVec3, Quat, Vec3};
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

/// The mesh with each face split into four, `times` times. `blown` moves all vertices to the distance 0.5.
fn cut(mesh: &Mesh, times: u32, blown: bool) -> Arc<Mesh> {
    let (mut vertices, mut faces) = (mesh.vertices.clone(), mesh.faces.clone());
    for _ in 0..times {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut next = vec![];
        for [a, b, c] in faces {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(u, v)| {
                *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                    vertices.push((vertices[u as usize] + vertices[v as usize]) * 0.5);
                    vertices.len() as u32 - 1
                })
            });
            next.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = next;
    }
    if blown {
        vertices.iter_mut().for_each(|v| *v = v.normalize() * 0.5);
    }
    Mesh::new(&format!("{} cut {times} times", mesh.name), vertices, faces)
}

/// Meshes of 3,072 to 8,192 triangles, and one coarse mesh.
struct Fine {
    coarse: Shapes,
    torus: Arc<Mesh>,
    knot: Arc<Mesh>,
    ball: Arc<Mesh>,
    hollow_ball: Arc<Mesh>,
    soup: Arc<Mesh>,
    unit_cube: Arc<Mesh>,
}

impl Fine {
    fn new() -> Self {
        let coarse = Shapes::new();
        Self {
            torus: cut(&coarse.torus, 2, false),
            knot: cut(&coarse.knot, 1, false),
            ball: cut(&coarse.ball, 3, true),
            hollow_ball: cut(&coarse.hollow_ball, 2, false),
            soup: cut(&coarse.soups[0], 3, false),
            unit_cube: cut(&coarse.unit_cube, 4, false),
            coarse,
        }
    }

    fn any(&self, rng: &mut Rng) -> &Arc<Mesh> {
        match rng.below(6) {
            0 => &self.torus,
            1 => &self.knot,
            2 => &self.ball,
            3 => &self.hollow_ball,
            4 => &self.soup,
            _ => &self.coarse.knot,
        }
    }

    fn two(&self, rng: &mut Rng) -> [&Arc<Mesh>; 2] {
        [self.any(rng), self.any(rng)]
    }

    fn near(&self, rng: &mut Rng) -> [Body; 2] {
        let (meshes, sizes) = (self.two(rng), [diameter(rng), diameter(rng)]);
        near(rng, meshes, sizes, 0.8)
    }
}

/// Compares `count` cases. At least `touching` pairs must touch, else the test would prove nothing.
fn run(name: &str, count: usize, touching: usize, make: impl Fn(&Fine, &mut Rng) -> Vec<Body> + Sync) -> Tally {
    let (fine, product) = (Fine::new(), Product::default());
    let seed = name
        .bytes()
        .fold(11u64, |h, b| h.wrapping_mul(31).wrapping_add(b.into()));
    let one = |case: usize| {
        let bodies = make(&fine, &mut Rng::new(seed, case as u64));
        let start = Instant::now();
        let worlds: Vec<_> = bodies.iter().map(Body::world).collect();
        let truth = brute::check(&worlds);
        let oracle_done = Instant::now();
        let answer = product.check(&bodies);
        let seconds = [(oracle_done - start).as_secs_f64(), oracle_done.elapsed().as_secs_f64()];
        Tally {
            seconds,
            ..compare(&format!("{name} case {case}"), &bodies, &worlds, &truth, &answer)
        }
    };
    let tally: Tally = parallel::map(count, one).into_iter().sum();
    println!("{}\n{}", Tally::head(), tally.row(name));
    tally.require_no_failures();
    tally.require_none_missed();
    assert!(tally.touching >= touching, "only {} pairs touch", tally.touching);
    tally
}

#[test]
fn near_each_other() {
    run("fine, near", 400, 200, |fine, rng| fine.near(rng).into()).require_few_forgiven();
}

#[test]
fn just_in_contact() {
    let contacts = |fine: &Fine, rng: &mut Rng| {
        let (meshes, depth) = (fine.two(rng), rng.range(0.0005, 0.01));
        contact(rng, meshes, depth).into()
    };
    run("fine, contact", 200, 190, contacts).require_few_forgiven();
}

#[test]
fn stretched_and_mirrored() {
    let stretched = |fine: &Fine, rng: &mut Rng| {
        let pair = fine.near(rng);
        pair.iter().map(|body| deform(rng, body)).collect()
    };
    run("fine, stretched", 200, 40, stretched).require_few_forgiven();
}

#[test]
fn far_from_the_origin() {
    let far = |fine: &Fine, rng: &mut Rng| {
        let offset = rng.direction() * 1e4;
        fine.near(rng).iter().map(|body| body.moved(offset)).collect()
    };
    run("fine, far", 200, 100, far).require_few_forgiven();
}

#[test]
fn tiny() {
    let tiny = |fine: &Fine, rng: &mut Rng| {
        let [a, b] = fine.near(rng);
        let origin = a.translation;
        let resized = |body: &Body| Body {
            translation: (body.translation - origin) * 1e-5,
            scale: body.scale * 1e-5,
            ..body.clone()
        };
        vec![resized(&a), resized(&b)]
    };
    run("fine, tiny", 200, 100, tiny).require_few_forgiven();
}

/// The margin scales with the larger body, and is not small for the faces of the smaller one.
#[test]
fn a_hundred_times_as_large() {
    let dwarf = |fine: &Fine, rng: &mut Rng| {
        let meshes = fine.two(rng);
        let giant = Body::new(meshes[0], rng.in_cube(5.0), rng.rotation(), diameter(rng));
        let size = f64::from(giant.scale.x) / 100.0;
        let place = giant.place(rng.pick(&meshes[0].vertices).as_dvec3()) + rng.in_ball(0.5 * size);
        let dwarf = Body::new(meshes[1], place, rng.rotation(), size);
        if rng.chance(0.5) {
            vec![dwarf, giant]
        } else {
            vec![giant, dwarf]
        }
    };
    run("fine, size 1 to 100", 300, 200, dwarf);
}

#[test]
fn inside_and_in_holes() {
    let inside = |fine: &Fine, rng: &mut Rng| {
        let shell = rng.direction() * 0.385;
        let places = [
            (&fine.ball, DVec3::ZERO, 0.46),
            (&fine.hollow_ball, shell, 0.08),
            (&fine.hollow_ball, DVec3::ZERO, 0.27),
            (&fine.torus, DVec3::ZERO, 0.18),
        ];
        let &(mesh, center, radius) = rng.pick(&places);
        let outer = Body::new(mesh, rng.in_cube(5.0), rng.rotation(), diameter(rng));
        let inner = fine.any(rng);
        vec![placed_inside(rng, &outer, center, radius, inner), outer]
    };
    let tally = run("fine, inside", 200, 60, inside);
    assert_eq!(tally.contained, tally.touching);
}

/// Cubes of 3,072 triangles on a lattice: they share faces exactly and overlap.
#[test]
fn stacked_cubes() {
    let stack = |fine: &Fine, rng: &mut Rng| {
        let corner = rng.in_cube(100.0).round();
        let mut place = || DVec3::from_array([(); 3].map(|()| rng.below(5) as f64 * 0.5));
        let places = [(); 4].map(|()| place());
        places
            .map(|place| {
                let turn = Quat::from_xyzw(0.5, 0.5, -0.5, 0.5);
                Body {
                    scale: Vec3::splat(if place.x < 1.0 { 1.0 } else { -0.5 }),
                    ..Body::new(&fine.unit_cube, corner + place, turn, 1.0)
                }
            })
            .into()
    };
    let tally = run("fine, stacked", 40, 20, stack);
    assert_eq!(tally.forgiven, 0, "all coordinates are exact");
}

#[test]
fn twice_in_one_pose() {
    let twice = |fine: &Fine, rng: &mut Rng| {
        let mesh = *rng.pick(&[&fine.torus, &fine.knot]);
        let body = Body::new(mesh, rng.in_cube(5.0), rng.rotation(), diameter(rng));
        vec![body.clone(), body]
    };
    run("fine, coincident", 6, 6, twice);
}

#[test]
fn tens_of_thousands_of_triangles() {
    let shapes = Shapes::new();
    let meshes = [
        cut(&shapes.ball, 4, true),
        cut(&shapes.knot, 3, false),
        cut(&shapes.torus, 4, false),
    ];
    assert!(meshes.iter().all(|mesh| mesh.faces.len() > 20_000));
    let large = |_: &Fine, rng: &mut Rng| {
        let pair = [0, 1].map(|_| rng.pick(&meshes));
        let depth = rng.range(0.0005, 0.005);
        contact(rng, pair, depth).into()
    };
    run("large, contact", 10, 10, large).require_few_forgiven();
}
