//! Contacts of random pairs: the deepest has the distance and the normal of the closed form.

use crate::distance::{between_triangles, segment_to_triangle};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::projection::BakeSettings;
use bevy_faceoff::queries::{ContactWorker, MeshContact, PairMemory, Placed};
use glam::{DQuat, DVec3, Vec3};

/// A rounded shape as its triangles, without the product's geometry.
pub struct Shape {
    pub name: &'static str,
    pub mesh: CollisionMesh,
    pub triangles: Vec<[DVec3; 3]>,
    pub radius: f64,
    /// Whether nothing else can be in it while the cores are apart.
    pub is_solid: bool,
}

impl Shape {
    fn of(name: &'static str, mesh: CollisionMesh) -> Self {
        let count = mesh.mesh.triangles().len();
        Self {
            triangles: (0..count).map(|t| mesh.mesh.corners(t).map(|p| p.as_dvec3())).collect(),
            radius: f64::from(mesh.settings.rounding),
            is_solid: mesh.mesh.is_solid(),
            name,
            mesh,
        }
    }

    /// The way from this core to another, both placed. Zero if they cross.
    pub fn way_to(&self, own: &[[DVec3; 3]], other: &Self, others: &[[DVec3; 3]]) -> DVec3 {
        let mut least = DVec3::splat(1.0e30);
        for a in own {
            for b in others {
                let way = match (self.is_thin(), other.is_thin()) {
                    (true, _) => segment_or_point([a[0], a[2]], *b, other.is_thin()),
                    (false, true) => -segment_or_point([b[0], b[2]], *a, false),
                    (false, false) => between_triangles(*a, *b),
                };
                if way.length() < least.length() {
                    least = way;
                }
            }
        }
        least
    }

    fn is_thin(&self) -> bool {
        self.mesh.mesh.is_thin()
    }
}

fn segment_or_point(segment: [DVec3; 2], other: [DVec3; 3], is_thin: bool) -> DVec3 {
    if is_thin {
        crate::distance::between_segments(segment, [other[0], other[2]])
    } else {
        segment_to_triangle(segment, other)
    }
}

/// The shapes whose pairs are compared.
pub fn all() -> Vec<Shape> {
    let rounded = |mesh: &TriMesh, rounding: f32| {
        let settings = BakeSettings {
            rounding,
            ..BakeSettings::default()
        };
        CollisionMesh::without_faces(mesh, settings)
    };
    let sheet = TriMesh::new(
        vec![
            Vec3::new(-0.6, 0.0, -0.5),
            Vec3::new(0.6, 0.0, -0.5),
            Vec3::new(0.0, 0.0, 0.7),
        ],
        vec![[0, 2, 1]],
    );
    vec![
        Shape::of("ball", CollisionMesh::ball(0.4).unwrap()),
        Shape::of("capsule", CollisionMesh::capsule(0.25, 0.8).unwrap()),
        Shape::of("small ball", CollisionMesh::ball(0.02).unwrap()),
        Shape::of(
            "rounded box",
            CollisionMesh::cuboid(Vec3::new(0.8, 0.5, 0.6), 0.1).unwrap(),
        ),
        Shape::of("box", CollisionMesh::new(&shapes::cube(0.7))),
        Shape::of("torus", CollisionMesh::new(&shapes::torus_240())),
        Shape::of("rounded torus", rounded(&shapes::torus_240(), 0.07)),
        Shape::of("thick sheet", rounded(&sheet.unwrap(), 0.08)),
    ]
}

fn any(random: &mut fastrand::Rng) -> DVec3 {
    DVec3::new(random.f64(), random.f64(), random.f64()) * 2.0 - 1.0
}

pub fn any_turn(random: &mut fastrand::Rng) -> DQuat {
    let [x, y, z, w] = [0; 4].map(|_| random.f64() * 2.0 - 1.0);
    DQuat::from_xyzw(x, y, z, w).normalize()
}

/// What has been compared.
#[derive(Debug, Default)]
struct Counts {
    near: u32,
    far: u32,
    normals: u32,
}

/// Compares random pairs in which at least one is rounded.
fn compare(rounds: u32, seed: u64) -> Counts {
    let shapes = all();
    let mut random = fastrand::Rng::with_seed(seed);
    let mut counts = Counts::default();
    let mut worker = ContactWorker::new();
    for _ in 0..rounds {
        let [a, b] = [0; 2].map(|_| &shapes[random.usize(..shapes.len())]);
        // Two tori take the slow test too long.
        let is_large = a.triangles.len() * b.triangles.len() > 5_000;
        if a.radius + b.radius == 0.0 || is_large {
            continue;
        }
        let turns = [any_turn(&mut random), any_turn(&mut random)];
        let way = any(&mut random) * 0.9;
        let place = |shape: &Shape, at: DVec3, turn: DQuat| -> Vec<[DVec3; 3]> {
            shape.triangles.iter().map(|t| t.map(|p| at + turn * p)).collect()
        };
        let placed = [place(a, DVec3::ZERO, turns[0]), place(b, way, turns[1])];
        let core = a.way_to(&placed[0], b, &placed[1]);
        let truth = core.length() - a.radius - b.radius;
        let margin = 0.03 + 0.05 * random.f32();
        let meshes = [
            Placed::new(&a.mesh, DVec3::ZERO, turns[0], Vec3::ONE).unwrap(),
            Placed::new(&b.mesh, way, turns[1], Vec3::ONE).unwrap(),
        ];
        let mut points: Vec<MeshContact> = Vec::new();
        worker.manifold(&meshes[0], &meshes[1], margin, &mut PairMemory::default(), &mut points);
        let what = || format!("{} and {}, {way}, {turns:?}, margin {margin}: {truth}", a.name, b.name);
        if core.length() < 1.0e-9 {
            // Cores that cross are pushed out by other rules.
            assert!(!points.is_empty(), "{}", what());
            continue;
        }
        if points
            .iter()
            .any(|point| f64::from(point.separation) < -a.radius - b.radius - 1.0e-6)
        {
            // One core is in the other.
            assert!(a.is_solid || b.is_solid, "{}", what());
            continue;
        }
        let found = points
            .iter()
            .map(|point| f64::from(point.separation))
            .fold(f64::INFINITY, f64::min);
        if truth > f64::from(margin) + 1.0e-6 {
            assert!(points.is_empty(), "{}: found {found}", what());
            counts.far += 1;
            continue;
        }
        if truth > f64::from(margin) - 1.0e-6 {
            continue;
        }
        assert!((found - truth).abs() < 2.0e-6, "{}: found {found}", what());
        counts.near += 1;
        let deepest = points
            .iter()
            .min_by(|p, q| p.separation.total_cmp(&q.separation))
            .unwrap();
        if core.length() > 0.01 {
            let turn = deepest.normal.as_dvec3().distance(core.normalize());
            // Another place may be as near.
            let others = points
                .iter()
                .filter(|p| (p.separation - deepest.separation).abs() < 1.0e-5)
                .count();
            if others == 1 {
                assert!(turn < 1.0e-4, "{}: the normal is off by {turn}", what());
                counts.normals += 1;
            }
        }
    }
    counts
}

#[test]
fn random_pairs_have_the_distance_and_normal_of_the_closed_form() {
    let counts = compare(8_000, 1);
    println!("{counts:?}");
    assert!(counts.near > 2_000 && counts.far > 1_000 && counts.normals > 1_000);
}

/// `cargo test --release --test round -- --ignored --nocapture a_hundred_thousand`
#[test]
#[ignore = "takes longer"]
fn a_hundred_thousand_random_pairs() {
    println!("{:?}", compare(200_000, 2));
}

/// `cargo test --release --test round -- --ignored --nocapture a_ball_on_a_large_terrain`
#[test]
#[ignore = "a measurement"]
fn a_ball_on_a_large_terrain() {
    let side = 708u32;
    let at = |i: u32, k: u32| i * (side + 1) + k;
    let height = |i: u32, k: u32| 0.3 * ((0.7 * i as f32).sin() + (0.9 * k as f32).cos());
    let vertices = (0..=side).flat_map(|i| (0..=side).map(move |k| Vec3::new(i as f32, height(i, k), k as f32)));
    let faces = (0..side).flat_map(|i| {
        (0..side).flat_map(move |k| {
            [
                [at(i, k), at(i, k + 1), at(i + 1, k)],
                [at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)],
            ]
        })
    });
    let terrain = CollisionMesh::new(&TriMesh::new(vertices.collect(), faces.collect()).unwrap());
    let ground = Placed::new(&terrain, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
    let ball = CollisionMesh::ball(0.5).unwrap();
    let mut random = fastrand::Rng::with_seed(1);
    let places: Vec<DVec3> = (0..10_000)
        .map(|_| DVec3::new(random.f64() * 700.0, 0.7, random.f64() * 700.0))
        .collect();
    let (mut worker, mut points, mut memory) = (ContactWorker::new(), Vec::new(), PairMemory::default());
    for round in 0..3 {
        points.clear();
        let start = std::time::Instant::now();
        for place in &places {
            let ball = Placed::new(&ball, *place, DQuat::IDENTITY, Vec3::ONE).unwrap();
            worker.manifold(&ball, &ground, 0.01, &mut memory, &mut points);
        }
        let each = start.elapsed().as_secs_f64() / places.len() as f64;
        println!("round {round}: {:.2} us a ball, {} points", 1e6 * each, points.len());
    }
}
