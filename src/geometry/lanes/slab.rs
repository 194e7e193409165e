//! Slabs: how flat what lies in a box is.
//!
//! A patch of a smooth surface that is `s` wide departs from its plane by only some `s^2`, but its box is `s` thick
//! unless the patch happens to lie along the axes. Where two bodies touch, boxes therefore overlap far around the
//! contact, the farther the finer the meshes; slabs part there as soon as the surfaces do.

use super::{Points, points};
use crate::geometry::cluster::CLUSTER;
use glam::{DVec3, Vec3};
use wide::f32x8;

/// Eight slabs, each around the triangles of a node: for each of their points `x`, `|normal . (x - center)|` is at most
/// `thickness`, and `|x - center|` at most `radius`.
#[derive(Clone, Copy)]
pub struct SlabGroup {
    /// Any point.
    pub center: Points,
    /// Of about unit length, or zero.
    pub normal: Points,
    /// Half of it; times the normal's length.
    pub thickness: f32x8,
    /// About the center.
    pub radius: f32x8,
}

#[derive(Clone, Copy, Default)]
struct Slab {
    center: Vec3,
    normal: Vec3,
    thickness: f32,
    radius: f32,
}

/// The slabs of the clusters in groups of eight, then of those groups in groups of eight, and so on up to one group.
/// `corners` are the triangles'.
pub fn levels(corners: &[[Vec3; 3]]) -> Vec<Vec<SlabGroup>> {
    let mut levels = Vec::new();
    let mut normals: Vec<DVec3> = corners.iter().map(area_vector).collect();
    let mut run = 1;
    loop {
        // Patches that turn away from their mean, a closed surface say, have a mean that means nothing; but a slab is never
        // wrong, only of no use.
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

/// What rounding to `f32` can take from a bound.
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
        // Of the rounded centre and normal.
        let (thickness, square) = all()
            .map(|p| p - center.as_dvec3())
            .fold((0.0f64, 0.0f64), |(t, s), p| {
                (t.max(n.dot(p).abs()), s.max(p.length_squared()))
            });
        Self {
            center,
            normal,
            thickness: (thickness * UP) as f32,
            radius: (square.sqrt() * UP) as f32,
        }
    }
}

impl SlabGroup {
    fn new(slabs: &[Slab]) -> Self {
        // Lanes without a slab have a box that overlaps nothing.
        let slab = |lane: usize| slabs.get(lane).copied().unwrap_or_default();
        let lanes = |of: fn(Slab) -> f32| f32x8::new(std::array::from_fn(|lane| of(slab(lane))));
        Self {
            center: points(|lane| slab(lane).center),
            normal: points(|lane| slab(lane).normal),
            thickness: lanes(|slab| slab.thickness),
            radius: lanes(|slab| slab.radius),
        }
    }
}
