//! Rays, casts, nearest points and overlaps of rounded shapes, against distances to their cores.

use crate::closed_forms::{Shape, all, any_turn};
use bevy_faceoff::queries::{CastScratch, Placed, QueryShape, Ray};
use glam::{DQuat, DVec3, Vec3};

/// A shape in a pose, and its core's triangles there.
struct Case<'a> {
    shape: &'a Shape,
    placed: Placed<'a>,
    triangles: Vec<[DVec3; 3]>,
}

impl<'a> Case<'a> {
    fn any(shapes: &'a [Shape], random: &mut fastrand::Rng) -> Self {
        let shape = &shapes[random.usize(..shapes.len())];
        let (at, turn) = (any(random) * 0.3, any_turn(random));
        Self {
            placed: Placed::new(&shape.mesh, at, turn, Vec3::ONE).unwrap(),
            triangles: shape.triangles.iter().map(|t| t.map(|p| at + turn * p)).collect(),
            shape,
        }
    }

    /// From a point to the core.
    fn core_distance(&self, p: DVec3) -> f64 {
        self.distance([p, p]).length()
    }

    /// The way from a segment to the core.
    fn distance(&self, segment: [DVec3; 2]) -> DVec3 {
        let ways = self.triangles.iter().map(|triangle| {
            if self.shape.mesh.mesh.is_thin() {
                crate::distance::between_segments(segment, [triangle[0], triangle[2]])
            } else {
                crate::distance::segment_to_triangle(segment, *triangle)
            }
        });
        ways.fold(DVec3::splat(1.0e30), |p, q| if q.length() < p.length() { q } else { p })
    }
}

fn any(random: &mut fastrand::Rng) -> DVec3 {
    DVec3::new(random.f64(), random.f64(), random.f64()) * 2.0 - 1.0
}

#[test]
fn rays_hit_the_round_surface_first() {
    let (shapes, mut random) = (all(), fastrand::Rng::with_seed(3));
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..4_000 {
        let case = Case::any(&shapes, &mut random);
        let radius = case.shape.radius;
        if radius == 0.0 {
            continue;
        }
        let origin = any(&mut random).normalize() * 3.0;
        let ray = Ray::new(origin, any(&mut random) * 0.6 - origin);
        let way = ray.direction.normalize();
        let outside = |t: f64| case.core_distance(origin + way * t) - radius;
        match case.placed.cast_ray(&ray) {
            Some(hit) => {
                hits += 1;
                assert!(
                    outside(hit.distance).abs() < 1.0e-7,
                    "{} {}",
                    case.shape.name,
                    outside(hit.distance)
                );
                let before = (0..40).map(|i| outside(hit.distance * f64::from(i) / 40.0));
                assert!(before.fold(f64::INFINITY, f64::min) > -1.0e-9, "{}", case.shape.name);
                // The normal leads to the core's nearest point.
                let to_core = case.distance([hit.point; 2]).normalize();
                assert!(
                    (to_core + hit.normal.as_dvec3()).length() < 1.0e-4,
                    "{}",
                    case.shape.name
                );
                assert!(case.placed.hits_ray(&ray));
            }
            None => {
                misses += 1;
                let least = (0..400)
                    .map(|i| outside(f64::from(i) * 0.015))
                    .fold(f64::INFINITY, f64::min);
                assert!(
                    least > -1.0e-9,
                    "{}: a ray passes {least} from the surface",
                    case.shape.name
                );
            }
        }
    }
    println!("{hits} hits, {misses} misses");
    assert!(hits > 500 && misses > 200);
}

#[test]
fn a_ray_from_inside_leaves_through_the_round_surface() {
    let (shapes, mut random) = (all(), fastrand::Rng::with_seed(5));
    let mut left = 0;
    for _ in 0..2_000 {
        let case = Case::any(&shapes, &mut random);
        let (origin, radius) = (any(&mut random) * 0.5, case.shape.radius);
        if radius == 0.0 || case.core_distance(origin) > 0.95 * radius {
            continue;
        }
        let hit = case.placed.cast_ray(&Ray::new(origin, any(&mut random))).unwrap();
        assert!(hit.from_behind);
        assert!(
            (case.core_distance(hit.point) - radius).abs() < 1.0e-6,
            "{}",
            case.shape.name
        );
        left += 1;
    }
    assert!(left > 100, "{left}");
}

#[test]
fn nearest_points_lie_on_the_round_surface() {
    let (shapes, mut random) = (all(), fastrand::Rng::with_seed(7));
    for _ in 0..4_000 {
        let case = Case::any(&shapes, &mut random);
        let (p, radius) = (any(&mut random) * 1.5, case.shape.radius);
        let truth = case.core_distance(p) - radius;
        let hit = case.placed.closest_point(p, f64::INFINITY).unwrap();
        if hit.is_inside {
            assert!(truth < 1.0e-9 || case.shape.is_solid, "{}", case.shape.name);
        } else {
            assert!(
                (hit.distance - truth).abs() < 1.0e-7,
                "{}: {} for {truth}",
                case.shape.name,
                hit.distance
            );
            assert!((hit.point.distance(p) - truth).abs() < 1.0e-6);
        }
    }
}

#[test]
fn casts_stop_where_the_shapes_touch() {
    let (shapes, mut random) = (all(), fastrand::Rng::with_seed(9));
    let mut scratch = CastScratch::default();
    let (mut hits, mut overlaps) = (0, 0);
    for _ in 0..3_000 {
        let case = Case::any(&shapes, &mut random);
        let (radius, half_length) = (0.05 + 0.3 * random.f64(), 0.4 * random.f64());
        let query = QueryShape::Capsule { radius, half_length };
        let (start, turn) = (any(&mut random).normalize() * 3.0, any_turn(&mut random));
        let way = any(&mut random) * 0.4 - start;
        let apart = |at: DVec3, turn: DQuat| {
            let axis = turn * (DVec3::Y * half_length);
            case.distance([at - axis, at + axis]).length() - radius - case.shape.radius
        };
        if let Some(hit) = case.placed.cast(&query, start, turn, way, 10.0, &mut scratch) {
            let end = start + way.normalize() * hit.distance;
            assert!(
                apart(end, turn).abs() < 1.0e-6,
                "{}: {} apart",
                case.shape.name,
                apart(end, turn)
            );
            hits += 1;
        }
        let at = any(&mut random);
        let truth = apart(at, turn);
        if truth.abs() > 1.0e-9 {
            let found = case.placed.overlaps(&query, at, turn);
            assert!(
                found == (truth < 0.0) || found && case.shape.is_solid,
                "{} {truth}",
                case.shape.name
            );
            overlaps += u32::from(found);
        }
    }
    assert!(hits > 500 && overlaps > 300, "{hits} hits, {overlaps} overlaps");
}

#[test]
fn rounded_meshes_cast_against_each_other_stop_where_they_touch() {
    let (shapes, mut random) = (all(), fastrand::Rng::with_seed(11));
    let mut scratch = CastScratch::default();
    let mut hits = 0;
    for _ in 0..400 {
        let case = Case::any(&shapes, &mut random);
        let other = &shapes[random.usize(..shapes.len())];
        if case.shape.radius + other.radius == 0.0 || case.triangles.len() * other.triangles.len() > 5_000 {
            continue;
        }
        let (start, turn) = (any(&mut random).normalize() * 3.0, any_turn(&mut random));
        let way = -start.normalize();
        let query = QueryShape::Mesh(&other.mesh, Vec3::ONE);
        let Some(hit) = case.placed.cast(&query, start, turn, way, 10.0, &mut scratch) else {
            continue;
        };
        let at = start + way * hit.distance;
        let placed: Vec<_> = other.triangles.iter().map(|t| t.map(|p| at + turn * p)).collect();
        let gap = case.shape.way_to(&case.triangles, other, &placed).length() - case.shape.radius - other.radius;
        assert!(
            (-1.0e-6..2.0e-6).contains(&gap),
            "{} and {}: {gap}",
            case.shape.name,
            other.name
        );
        hits += 1;
    }
    assert!(hits > 50, "{hits}");
}

#[test]
fn what_meets_the_core_itself_has_a_normal() {
    let shapes = all();
    for shape in shapes.iter().filter(|shape| shape.radius > 0.0) {
        let placed = Placed::new(&shape.mesh, DVec3::ZERO, DQuat::IDENTITY, Vec3::ONE).unwrap();
        let on_core = shape.triangles[0].iter().sum::<DVec3>() / 3.0;
        let hit = placed.closest_point(on_core, 1.0).unwrap();
        assert!((hit.normal.length() - 1.0).abs() < 1.0e-5, "{}: {hit:?}", shape.name);
        let ends = [on_core - DVec3::Y, on_core + DVec3::Y];
        let hit = placed.closest_to_segment(ends, 1.0).unwrap();
        assert!((hit.normal.length() - 1.0).abs() < 1.0e-5, "{}: {hit:?}", shape.name);
        assert!(hit.distance <= -shape.radius, "{}: {hit:?}", shape.name);
    }
}

#[test]
fn an_unevenly_scaled_ball_weighs_what_it_is() {
    let ball = bevy_faceoff::asset::CollisionMesh::ball(0.5).unwrap();
    let scaled = Placed::new(&ball, DVec3::ZERO, DQuat::IDENTITY, Vec3::new(1.0, 1.0, 4.0)).unwrap();
    let volume = std::f64::consts::PI / 6.0;
    assert!((scaled.mass(1.0) / volume - 1.0).abs() < 1.0e-5);
    let inertia = scaled.inertia(1.0);
    assert!((inertia.x_axis.x - 0.1).abs() < 1.0e-5 && (inertia.z_axis.z - 0.1).abs() < 1.0e-5);
    let hit = scaled.cast_ray(&Ray::new(DVec3::Z * 5.0, DVec3::NEG_Z)).unwrap();
    assert!((hit.distance - 4.5).abs() < 1.0e-6);
}
