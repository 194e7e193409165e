//! Queries of one mesh on one thread: rays against a large terrain, in bevy_faceoff, parry3d and obvhs, and overlaps of
//! pairs of meshes one at a time and all at once.

use crate::narrow::sphere_pairs;
use crate::ours::Stages;
use crate::parry::Parry;
use crate::scene::{Choice, Scene, Shape};
use crate::timing::{median, pool, ratio, time};
use bevy::math::{DQuat, DVec3, Vec3};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::queries::{self, CastScratch, Placed, QueryShape, Ray};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use parry3d::math::Vector;
use parry3d::query::RayCast;
use std::time::Duration;

/// Vertices along each side of the terrain: three million triangles.
const SIDE: usize = 1226;
/// Length of its sides, metres.
const LENGTH: f32 = 1000.0;
const RAYS: usize = 100_000;

/// Measures and prints.
pub fn compare(rounds: usize) {
    let mesh = terrain();
    println!(
        "{RAYS} rays against a terrain of {} triangles, one thread, medians of {rounds} interleaved rounds\n",
        mesh.triangles().len()
    );
    println!("| rays | library | million rays a second | ours is so many times as fast | hits |");
    println!("|---|---|---|---|---|");
    let peers = Peers::new(&mesh);
    let from_above =
        |random: &mut fastrand::Rng| Vec3::new(random.f32() - 0.5, -random.f32() - 0.1, random.f32() - 0.5);
    let level = |random: &mut fastrand::Rng| Vec3::new(random.f32() - 0.5, -0.05 * random.f32(), random.f32() - 0.5);
    peers.compare("steep", &rays(from_above), rounds);
    peers.compare("level", &rays(level), rounds);
    println!();
    among_bodies(rounds);
    overlaps(rounds);
    casts(&peers.ours, rounds);
}

/// Hills at several scales.
fn terrain() -> TriMesh {
    let point = |i: usize| {
        let [x, z] = [i % SIDE, i / SIDE].map(|k| (k as f32 / (SIDE - 1) as f32 - 0.5) * LENGTH);
        let height = |length: f32| length * 0.1 * ((x / length).sin() + (z / length + 1.0).cos());
        Vec3::new(x, height(60.0) + height(13.0) + height(3.1), z)
    };
    let corner = |x: usize, z: usize| (z * SIDE + x) as u32;
    let cell = |i: usize| {
        let (x, z) = (i % (SIDE - 1), i / (SIDE - 1));
        let [a, b, c, d] = [corner(x, z), corner(x, z + 1), corner(x + 1, z + 1), corner(x + 1, z)];
        [[a, b, c], [a, c, d]]
    };
    let faces = (0..(SIDE - 1) * (SIDE - 1)).flat_map(cell).collect();
    TriMesh::new((0..SIDE * SIDE).map(point).collect(), faces).expect("a valid mesh")
}

/// Origins and unit directions: from 20 to 70 m above sea level anywhere over the terrain.
fn rays(direction: impl Fn(&mut fastrand::Rng) -> Vec3) -> Vec<(Vec3, Vec3)> {
    let mut random = fastrand::Rng::with_seed(3);
    (0..RAYS)
        .map(|_| {
            let [x, z] = [(); 2].map(|()| (random.f32() - 0.5) * LENGTH);
            (
                Vec3::new(x, 20.0 + 50.0 * random.f32(), z),
                direction(&mut random).normalize(),
            )
        })
        .collect()
}

struct Peers {
    ours: CollisionMesh,
    parry: parry3d::shape::TriMesh,
    obvhs: CwBvh,
    /// In the order of the tree.
    triangles: Vec<RtTriangle>,
}

impl Peers {
    fn new(mesh: &TriMesh) -> Self {
        let points = mesh.vertices().iter().map(|v| Vector::from(v.to_array())).collect();
        let corners = (0..mesh.triangles().len()).map(|t| mesh.corners(t).map(|p| p.to_array().into()));
        let triangles: Vec<Triangle> = corners.map(|[v0, v1, v2]| Triangle { v0, v1, v2 }).collect();
        let obvhs = build_cwbvh_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
        let order = obvhs.primitive_indices.iter();
        Self {
            ours: CollisionMesh::new(mesh),
            parry: parry3d::shape::TriMesh::new(points, mesh.triangles().to_vec()).expect("a valid mesh"),
            triangles: order.map(|&t| (&triangles[t as usize]).into()).collect(),
            obvhs,
        }
    }

    /// The distance of each ray's first hit, infinite if there is none.
    fn ours(&self, rays: &[(Vec3, Vec3)]) -> Vec<f32> {
        let placed = Placed::new(&self.ours, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).expect("a valid pose");
        let cast = |&(origin, way): &(Vec3, Vec3)| {
            let hit = placed.cast_ray(&Ray::new(origin.as_dvec3(), way.as_dvec3()));
            hit.map_or(f32::INFINITY, |hit| hit.distance as f32)
        };
        rays.iter().map(cast).collect()
    }

    /// With the normal, as ours.
    fn parry(&self, rays: &[(Vec3, Vec3)]) -> Vec<f32> {
        let cast = |&(origin, way): &(Vec3, Vec3)| {
            let [origin, way] = [origin, way].map(|v| Vector::from(v.to_array()));
            let ray = parry3d::query::Ray::new(origin, way);
            let hit = self.parry.cast_local_ray_and_get_normal(&ray, f32::MAX, false);
            hit.map_or(f32::INFINITY, |hit| hit.time_of_impact)
        };
        rays.iter().map(cast).collect()
    }

    fn obvhs(&self, rays: &[(Vec3, Vec3)]) -> Vec<f32> {
        let cast = |&(origin, way): &(Vec3, Vec3)| {
            let ray = obvhs::ray::Ray::new_inf(origin.to_array().into(), way.to_array().into());
            let mut hit = obvhs::ray::RayHit::none();
            self.obvhs
                .ray_traverse(ray, &mut hit, |ray, id| self.triangles[id].intersect(ray));
            hit.t
        };
        rays.iter().map(cast).collect()
    }

    fn compare(&self, name: &str, rays: &[(Vec3, Vec3)], rounds: usize) {
        let mut seconds = [const { Vec::new() }; 3];
        let mut found = [const { Vec::new() }; 3];
        for _ in 0..rounds {
            let runs = [
                time(|| self.ours(rays)),
                time(|| self.parry(rays)),
                time(|| self.obvhs(rays)),
            ];
            for (i, (time, hits)) in runs.into_iter().enumerate() {
                seconds[i].push(time);
                found[i] = hits;
            }
        }
        for (i, library) in ["ours", "parry3d", "obvhs"].into_iter().enumerate() {
            let speed = RAYS as f64 / median(seconds[i].iter().copied()) / 1e6;
            let hits = found[i].iter().filter(|t| **t < 1e6).count();
            let differ = found[i]
                .iter()
                .zip(&found[0])
                .filter(|(t, ours)| (*t - *ours).abs() > 0.01 && t.min(**ours) < 1e6);
            let times = ratio(&seconds[i], &seconds[0]);
            println!(
                "| {name} | {library} | {speed:.3} | {times:.2} | {hits}, {} others |",
                differ.count()
            );
        }
    }
}

/// Rays between 2200 knots, through the trees over all of them. In parry3d each body has a mesh of its own, scaled in
/// advance; ours share one.
fn among_bodies(rounds: usize) {
    let scene = Scene::new(&Choice::new(Shape::Knot));
    let mut ours = queries::Scene::default();
    for body in &scene.bodies {
        let (translation, rotation) = (body.pose.translation.as_dvec3(), body.pose.rotation.as_dquat());
        ours.add_mesh(&scene.mesh, translation, rotation, body.pose.scale)
            .expect("a valid pose");
    }
    let parry = Parry::new(&scene);
    let tree = parry.tree_of_boxes();
    let half = scene
        .bodies
        .iter()
        .map(|b| b.pose.translation.abs().max_element())
        .fold(0.0, f32::max);
    let mut random = fastrand::Rng::with_seed(5);
    let mut vector = || Vec3::from_array([0; 3].map(|_| 2.0 * random.f32() - 1.0));
    let rays: Vec<_> = (0..RAYS).map(|_| (half * vector(), vector().normalize())).collect();
    let by_ours = || -> Vec<f32> {
        let cast = |&(origin, way): &(Vec3, Vec3)| {
            let hit = ours.cast_ray(&Ray::new(origin.as_dvec3(), way.as_dvec3()), |_| true);
            hit.map_or(f32::INFINITY, |hit| hit.distance as f32)
        };
        rays.iter().map(cast).collect()
    };
    let by_parry = || -> Vec<f32> {
        let cast = |(origin, way): &(Vec3, Vec3)| parry.first_hit_of_ray(&tree, origin.to_array(), way.to_array());
        rays.iter().map(cast).collect()
    };
    let mut seconds = [const { Vec::new() }; 2];
    let mut found = [const { Vec::new() }; 2];
    for _ in 0..rounds {
        for (i, (time, hits)) in [time(by_ours), time(by_parry)].into_iter().enumerate() {
            seconds[i].push(time);
            found[i] = hits;
        }
    }
    println!("{RAYS} rays among {} knots, one thread\n", scene.bodies.len());
    println!("| library | million rays a second | ours is so many times as fast | hits |");
    println!("|---|---|---|---|");
    for (i, library) in ["ours", "parry3d"].into_iter().enumerate() {
        let speed = RAYS as f64 / median(seconds[i].iter().copied()) / 1e6;
        let hits = found[i].iter().filter(|t| t.is_finite()).count();
        let pairs = found[i].iter().zip(&found[0]);
        let differ = pairs.filter(|(t, ours)| t != ours && (*t - *ours).abs() > 1e-3).count();
        println!(
            "| {library} | {speed:.3} | {:.2} | {hits}, {differ} others |",
            ratio(&seconds[i], &seconds[0])
        );
    }
    println!();
}

/// Overlaps of all pairs of knots whose bounding spheres overlap, one by one, and by the stages behind
/// `queries::touching`.
fn overlaps(rounds: usize) {
    let scene = Scene::new(&Choice::new(Shape::Knot));
    let pairs = sphere_pairs(&scene);
    let mut stages = Stages::new(&scene);
    stages.broad_phase();
    let poses: Vec<(DVec3, DQuat, Vec3)> = scene
        .bodies
        .iter()
        .map(|b| (b.pose.translation.as_dvec3(), b.pose.rotation.as_dquat(), b.pose.scale))
        .collect();
    let overlapping = || {
        let touch = |pair: &&[u32; 2]| {
            let [a, b] = pair.map(|i| poses[i as usize]);
            let placed = Placed::new(&scene.mesh, a.0, a.1, a.2).expect("a valid pose");
            placed.overlaps(&QueryShape::Mesh(&scene.mesh, b.2), b.0, b.1)
        };
        pairs.iter().filter(touch).count()
    };
    let one = pool(1);
    let mut seconds = [const { Vec::new() }; 2];
    let mut found = [0; 2];
    for _ in 0..rounds {
        let (time_all, all) = one.install(|| time(|| stages.first_hits().len()));
        let (time_each, each) = one.install(|| time(overlapping));
        seconds[0].push(time_all);
        seconds[1].push(time_each);
        found = [all, each];
    }
    println!(
        "{} pairs of knots: {} touch by `queries::touching`, {} by `Placed::overlaps`",
        pairs.len(),
        found[0],
        found[1]
    );
    for (name, seconds) in ["touching", "overlaps"].into_iter().zip(&seconds) {
        let each = median(seconds.iter().copied()) / pairs.len() as f64;
        println!("{name}: {:.2} us a pair", each * 1e6);
    }
    println!("ratio {:.2}", ratio(&seconds[1], &seconds[0]));
}

/// Casts of a character's shapes across the terrain, 1 m each.
fn casts(terrain: &CollisionMesh, rounds: usize) {
    let placed = Placed::new(terrain, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).expect("a valid pose");
    let knot = CollisionMesh::new(&bevy_faceoff::geometry::shapes::knot_1120());
    let shapes = [
        ("ball", QueryShape::Ball { radius: 0.4 }),
        (
            "capsule",
            QueryShape::Capsule {
                radius: 0.4,
                half_length: 0.5,
            },
        ),
        (
            "box",
            QueryShape::Box {
                half_size: DVec3::new(0.4, 0.9, 0.4),
            },
        ),
        ("knot of 1120 triangles", QueryShape::Mesh(&knot, Vec3::ONE)),
    ];
    let mut random = fastrand::Rng::with_seed(4);
    let mut starts = Vec::new();
    while starts.len() < 2000 {
        let [x, z] = [(); 2].map(|()| (random.f64() - 0.5) * 900.0);
        let down = placed
            .cast_ray(&Ray::new(DVec3::new(x, 100.0, z), DVec3::NEG_Y))
            .expect("the terrain");
        let way = DVec3::new(random.f64() - 0.5, -0.3 * random.f64(), random.f64() - 0.5);
        starts.push((down.point + DVec3::Y * 1.2, way));
    }
    let mut scratch = CastScratch::default();
    for (name, shape) in shapes {
        let mut seconds = Vec::new();
        let mut hits = 0;
        for _ in 0..rounds {
            let mut hit = |at: DVec3, way: DVec3| {
                placed
                    .cast(&shape, at, DQuat::IDENTITY, way, 1.0, &mut scratch)
                    .is_some()
            };
            let (taken, count) = time(|| starts.iter().filter(|(at, way)| hit(*at, *way)).count());
            seconds.push(taken);
            hits = count;
        }
        let each = median(seconds) / starts.len() as f64;
        println!(
            "casts of a {name} by 1 m: {:.2} us each, {hits} of {} hit",
            each * 1e6,
            starts.len()
        );
    }
}
