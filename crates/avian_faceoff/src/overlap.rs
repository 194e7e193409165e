//! Deep overlaps whose contact points disagree about where to.
//!
//! Points with opposed normals push a pair against itself, and Avian's solver makes energy of that. So only those count that
//! agree with one direction.

use avian3d::math::{AdjustPrecision, Scalar, Vector};
use avian3d::prelude::ContactManifold;
use bevy_faceoff::queries::MeshContact;

/// Normals are opposed if the cosine of the angle between them is below this.
const OPPOSED: f32 = -0.5;

/// Only points deeper than this part of the diameter disagree.
const DEPTH: f32 = 0.01;

/// Drops the points of an overlap that disagree with its direction: that of the last step's impulses, or else that from
/// the first centre of mass to the second.
pub(crate) fn resolve(points: &mut Vec<MeshContact>, diameter: f32, old: &[ContactManifold], centers: Vector) {
    let deep = || points.iter().filter(|point| point.separation < -DEPTH * diameter);
    if !deep().any(|p| deep().any(|q| p.normal.dot(q.normal) < OPPOSED)) {
        return;
    }
    let impulse = |m: &ContactManifold| m.normal * m.points.iter().map(|p| p.warm_start_normal_impulse).sum::<Scalar>();
    let last: Vector = old.iter().map(impulse).sum();
    let direction = [last, centers]
        .into_iter()
        .find_map(Vector::try_normalize)
        .unwrap_or(Vector::Y);
    points.retain(|point| {
        let normal: Vector = point.normal.adjust_precision();
        point.separation >= 0.0 || normal.dot(direction) >= 0.0
    });
}
