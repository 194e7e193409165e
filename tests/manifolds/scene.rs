//! Two bodies, their contact points, and their true depth.

use crate::oracle::body::{Body, Mesh};
use crate::oracle::brute::surfaces_meet;
use crate::oracle::product::Product;
use crate::oracle::shapes::Shapes;
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::manifolds::{ManifoldPoint, Manifolds, MarginPair, cpu};
use bevy_faceoff::queries::Placement;
use bevy_faceoff::state::Body as StageBody;
use bevy_faceoff::step::StepState;
use glam::{DVec3, Quat, Vec3};
use std::sync::Arc;

/// A generated mesh of the product in the oracle's form.
pub fn oracle_mesh(name: &str, mesh: &TriMesh) -> Arc<Mesh> {
    Mesh::new(name, mesh.vertices().to_vec(), mesh.triangles().to_vec())
}

/// A body at its mesh's own size.
pub fn body(mesh: &Arc<Mesh>, translation: DVec3, rotation: Quat) -> Body {
    Body::new(mesh, translation, rotation, 1.0)
}

/// The state of a step with these bodies.
pub fn state(product: &Product, bodies: &[&Body]) -> StepState {
    let mut state = StepState::default();
    for body in bodies {
        let Placement {
            mesh,
            translation,
            rotation,
            scale,
        } = product.placement(body);
        let slot = state.input.meshes.add(mesh);
        let body = StageBody::at_rest(slot, translation, rotation, scale);
        state
            .input
            .bodies
            .push(&body, &state.input.meshes)
            .expect("a usable body");
    }
    state
}

/// The contact points of two bodies.
pub fn points(product: &Product, a: &Body, b: &Body, margin: f64) -> Vec<ManifoldPoint> {
    let state = state(product, &[a, b]);
    let pair = MarginPair {
        bodies: [0, 1],
        margin: margin as f32,
    };
    let manifolds = cpu::of_pair(&state.input.bodies, &state.input.meshes, pair);
    require_sane(&manifolds);
    manifolds.points
}

/// Requires finite numbers, unit normals and consistent lists.
pub fn require_sane(manifolds: &Manifolds) {
    let mut next = 0;
    for pair in &manifolds.pairs {
        assert_eq!(pair.first_point, next);
        assert!((1..=16).contains(&pair.point_count), "{pair:?}");
        next += pair.point_count;
    }
    assert_eq!(next as usize, manifolds.points.len());
    for point in &manifolds.points {
        let finite = point.anchors.iter().all(|arm| arm.is_finite()) && point.separation.is_finite();
        assert!(finite && (point.normal.length() - 1.0).abs() < 1e-5, "{point:?}");
    }
}

/// Depth of the deepest point; negative for a gap.
pub fn depth(points: &[ManifoldPoint]) -> f64 {
    -points
        .iter()
        .map(|p| f64::from(p.separation))
        .fold(f64::INFINITY, f64::min)
}

/// The depth-weighted mean normal; across a gap that of the nearest point.
pub fn push(points: &[ManifoldPoint]) -> DVec3 {
    let deepest = points.iter().min_by(|p, q| p.separation.total_cmp(&q.separation));
    let sum: DVec3 = points
        .iter()
        .map(|p| p.normal.as_dvec3() * f64::from(-p.separation).max(0.0))
        .sum();
    sum.try_normalize()
        .unwrap_or(deepest.expect("a point").normal.as_dvec3())
}

/// Angle between unit vectors, degrees.
pub fn degrees(u: DVec3, v: DVec3) -> f64 {
    u.cross(v).length().atan2(u.dot(v)).to_degrees()
}

/// Distance that `b` travels along `way`, from far off, until the surfaces first meet, if they do. Crossings shorter
/// than `step` may be missed.
pub fn first_touch(a: &Body, b: &Body, way: DVec3, from: f64, to: f64, step: f64) -> Option<f64> {
    let meets = |t: f64| surfaces_meet(a, &b.moved(way * t));
    let count = ((to - from) / step).ceil() as usize;
    let hit = (1..=count).map(|i| from + i as f64 * step).find(|t| meets(*t))?;
    Some(bisect(hit - step, hit, meets))
}

/// The value between `low` and `high` at which `holds` becomes true.
fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..25 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

/// The shortest separating translation of `b` near `guess`: its direction and its length, at most `most`. It searches
/// directions all around, then refines the best.
pub fn way_out(a: &Body, b: &Body, guess: DVec3, most: f64) -> (DVec3, f64) {
    let free = |way: DVec3, t: f64| !surfaces_meet(a, &b.moved(way * t));
    // The length along `way` if it is below `limit`.
    let along = |way: DVec3, limit: f64| free(way, limit).then(|| bisect(0.0, limit, |t| free(way, t)));
    let mut best = (guess, along(guess, most).unwrap_or(most));
    let attempt = |way: DVec3, best: &mut (DVec3, f64), part: f64| {
        if let Some(length) = along(way, best.1 * part) {
            *best = (way, length);
        }
    };
    let count = 150;
    for i in 0..count {
        let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(count);
        let (sin, cos) = (f64::from(i) * 2.399_963).sin_cos();
        let r = (1.0 - z * z).sqrt();
        attempt(DVec3::new(r * cos, r * sin, z), &mut best, 0.999);
    }
    let mut width = 0.2;
    for _ in 0..14 {
        let (u, v) = best.0.any_orthonormal_pair();
        for k in 0..8 {
            let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
            let way = (best.0 + (u * cos + v * sin) * width).normalize();
            attempt(way, &mut best, 0.9995);
        }
        width *= 0.6;
    }
    best
}

/// The rotation from `from` to `to`.
pub fn turn(from: Vec3, to: Vec3) -> Quat {
    Quat::from_rotation_arc(from.normalize(), to.normalize())
}

/// A cube with corners at -0.5 and 0.5.
pub fn cube() -> Arc<Mesh> {
    Shapes::new().unit_cube
}

/// A closed shape along y of a counter-clockwise profile in x and z, whose area these triangles fill, from -0.1 to 0.1.
fn extruded(profile: &[[f32; 2]], filled: &[[u32; 3]]) -> TriMesh {
    let count = profile.len() as u32;
    let side = |y: f32| profile.iter().map(move |&[x, z]| Vec3::new(x, y, z));
    let vertices = side(-0.1).chain(side(0.1)).collect();
    let mut faces = filled.to_vec();
    faces.extend(filled.iter().map(|&[a, b, c]| [c + count, b + count, a + count]));
    for (i, next) in (0..count).map(|i| (i, (i + 1) % count)) {
        faces.extend([[next, i, i + count], [next, i + count, next + count]]);
    }
    TriMesh::new(vertices, faces).unwrap()
}

/// A bar on two legs, which end at heights of -0.5 and -0.41.
pub fn uneven_legs() -> Arc<Mesh> {
    let profile = [
        [-0.5, 0.5],
        [-0.5, -0.5],
        [-0.3, -0.5],
        [-0.3, 0.3],
        [0.3, 0.3],
        [0.3, -0.41],
        [0.5, -0.41],
        [0.5, 0.5],
    ];
    let filled = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 7], [4, 5, 6], [4, 6, 7]];
    oracle_mesh("uneven legs", &extruded(&profile, &filled))
}

/// A bar with its lower side at a height of 0, and below its middle a foot that ends at -0.06.
pub fn bar_on_a_foot() -> Arc<Mesh> {
    let profile = [
        [-0.5, 0.3],
        [-0.5, 0.0],
        [-0.1, 0.0],
        [-0.1, -0.06],
        [0.1, -0.06],
        [0.1, 0.0],
        [0.5, 0.0],
        [0.5, 0.3],
    ];
    let filled = [[0, 1, 2], [2, 3, 4], [2, 4, 5], [0, 2, 5], [0, 5, 7], [5, 6, 7]];
    oracle_mesh("bar on a foot", &extruded(&profile, &filled))
}
