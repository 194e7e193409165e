//! What questions to all bodies cost: reading the poses after a step, building the tree, and rays, points and casts.
//!
//! `cargo bench --bench spatial_queries`

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::queries::{QueryShape, Ray, Scene};
use glam::{DQuat, DVec3, Vec3};
use std::hint::black_box;
use std::time::Instant;

/// Bodies, and the edge of the cube in which they are, metres.
const CROWDS: [(usize, f64); 3] = [(100, 7.0), (2_200, 20.0), (10_000, 33.0)];
/// Rounds, of which the fastest counts.
const ROUNDS: usize = 5;
const RAYS: usize = 20_000;
const CASTS: usize = 2_000;

fn main() {
    let knot = CollisionMesh::new(&shapes::knot_1120());
    let small = CollisionMesh::new(&shapes::torus_240());
    println!(
        "| knots | add all, ms | build the tree, ms | ray, ns | nearest point, ns | cast of a ball, ns | of a torus, us |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (count, size) in CROWDS {
        let mut random = fastrand::Rng::with_seed(1);
        let mut vector = || DVec3::from_array([0; 3].map(|_| 2.0 * random.f64() - 1.0));
        let poses: Vec<_> = (0..count)
            .map(|_| (0.5 * size * vector(), DQuat::from_scaled_axis(3.0 * vector())))
            .collect();
        let starts: Vec<_> = (0..RAYS).map(|_| (0.5 * size * vector(), vector())).collect();
        let mut scene = Scene::default();
        let add = fastest(|| {
            scene.clear();
            for &(translation, rotation) in &poses {
                scene.add_mesh(&knot, translation, rotation, Vec3::ONE).expect("a pose");
            }
        });
        let all = fastest(|| {
            scene.clear();
            for &(translation, rotation) in &poses {
                scene.add_mesh(&knot, translation, rotation, Vec3::ONE).expect("a pose");
            }
            black_box(scene.hits_ray(&Ray::new(DVec3::splat(2.0 * size), DVec3::ONE), |_| true));
        });
        let ray = fastest(|| {
            for &(start, way) in &starts {
                black_box(scene.cast_ray(&Ray::new(start, way), |_| true));
            }
        });
        let point = fastest(|| {
            for &(start, _) in &starts {
                black_box(scene.closest_point(start, f64::INFINITY, |_| true));
            }
        });
        let cast = |shape: &QueryShape| {
            fastest(|| {
                for &(start, way) in &starts[..CASTS] {
                    black_box(scene.cast(shape, start, DQuat::IDENTITY, way, 0.25 * size, |_| true));
                }
            })
        };
        let ball = cast(&QueryShape::Ball { radius: 0.2 });
        let torus = cast(&QueryShape::Mesh(&small, Vec3::splat(0.4)));
        println!(
            "| {count} | {:.2} | {:.2} | {:.0} | {:.0} | {:.0} | {:.1} |",
            1e3 * add,
            1e3 * (all - add),
            1e9 * ray / RAYS as f64,
            1e9 * point / RAYS as f64,
            1e9 * ball / CASTS as f64,
            1e6 * torus / CASTS as f64,
        );
    }
}

/// Seconds of the fastest round.
fn fastest(mut work: impl FnMut()) -> f64 {
    let round = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    (0..ROUNDS).map(round).fold(f64::INFINITY, f64::min)
}
