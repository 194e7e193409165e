//! Slabs: thin bounding volumes for the nearly flat patches of a surface.
//!
//! A patch of width `s` of a smooth surface deviates from its plane by only about `s^2`, but its axis-aligned box is
//! about `s` thick unless the patch is parallel to the axes. Where two bodies touch, boxes therefore overlap far around
//! the contact, and the finer the meshes, the more boxes do. Slabs separate as soon as the surfaces do.

use super::points::{Stored, StoredPoints, points};
use crate::geometry::cluster::CLUSTER;
use glam::{DVec3, Vec3};

/// Eight slabs, each around the triangles of a node. For each point `x` of the triangles, `|normal . (x - center)|` is
/// at most `half_thickness` and `|x - center|` is at most `radius`.
#[derive(Clone, Copy)]
pub struct SlabGroup {
    /// A point in the middle plane.
    pub center: StoredPoints,
    /// The normal, of about unit length, or zero.
    pub normal: StoredPoints,
    /// Half the thickness, times the length of `normal`.
    pub half_thickness: Stored,
    /// The radius of a sphere about `center` that contains the triangles.
    pub radius: Stored,
}

#[derive(Clone, Copy, Default)]
struct Slab {
    center: Vec3,
    normal: Vec3,
    half_thickness: f32,
    radius: f32,
}

/// The slabs of the clusters in groups of eight, then of those groups in groups of eight, and so on up to one group.
/// `corners` holds the corners of each triangle.
pub fn levels(corners: &[[Vec3; 3]]) -> Vec<Vec<SlabGroup>> {
    let mut levels = Vec::new();
    let mut normals: Vec<DVec3> = corners.iter().map(area_vector).collect();
    let mut run = 1;
    loop {
        // The mean normal of a strongly curved patch, such as a closed surface, is meaningless. The slab is still
        // valid, just not thin.
        normals = normals.chunks(CLUSTER).map(|run| run.iter().sum()).collect();
        run *= CLUSTER;
        let slabs: Vec<Slab> = corners
            .chunks(run)
            .zip(&normals)
            .map(|(corners, normal)| Slab::around(corners, *normal))
            .collect();
        levels.push(slabs.chunks(CLUSTER).map(SlabGroup::new).collect());
        if slabs.len() <= CLUSTER {
            return levels;
        }
    }
}

fn area_vector(t: &[Vec3; 3]) -> DVec3 {
    let [p, q, r] = t.map(|p| p.as_dvec3());
    (q - p).cross(r - p)
}

/// Bounds are enlarged by this factor, so that rounding to `f32` cannot make them too small.
const UP: f64 = 1.0 + 1.0e-6;

impl Slab {
    fn around(corners: &[[Vec3; 3]], normal: DVec3) -> Self {
        let normal = normal.normalize_or_zero().as_vec3();
        let all = || corners.iter().flatten().map(|p| p.as_dvec3());
        let (low, high) = all().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
        let (middle, n) = ((low + high) * 0.5, normal.as_dvec3());
        let (least, most) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), p| {
            let height = n.dot(p - middle);
            (least.min(height), most.max(height))
        });
        let center = (middle + n * (0.5 * (least + most))).as_vec3();
        // Measured from the rounded centre and normal, which are what is stored.
        let (half_thickness, square) = all()
            .map(|p| p - center.as_dvec3())
            .fold((0.0f64, 0.0f64), |(t, s), p| {
                (t.max(n.dot(p).abs()), s.max(p.length_squared()))
            });
        Self {
            center,
            normal,
            half_thickness: (half_thickness * UP) as f32,
            radius: (square.sqrt() * UP) as f32,
        }
    }
}

impl SlabGroup {
    fn new(slabs: &[Slab]) -> Self {
        // The default is fine for unused lanes: their boxes overlap nothing.
        let slab = |lane: usize| slabs.get(lane).copied().unwrap_or_default();
        let lanes = |of: fn(Slab) -> f32| Stored(std::array::from_fn(|lane| of(slab(lane))));
        Self {
            center: points(|lane| slab(lane).center),
            normal: points(|lane| slab(lane).normal),
            half_thickness: lanes(|slab| slab.half_thickness),
            radius: lanes(|slab| slab.radius),
        }
    }
}
