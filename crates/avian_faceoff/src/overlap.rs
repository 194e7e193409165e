//! Deep overlaps whose contact points disagree about the direction out of them.
//!
//! Points with opposed normals push a pair against itself, and Avian's solver gains energy from that. So only points
//! that agree with one direction count.

use avian3d::math::{AdjustPrecision, Scalar, Vector};
use avian3d::prelude::ContactManifold;
use bevy_faceoff::queries::MeshContact;

/// Normals are opposed if the cosine of the angle between them is below this.
const OPPOSED: f32 = -0.5;

/// Only points deeper than this part of the diameter disagree.
const DEPTH: f32 = 0.01;

/// Drops the points of an overlap that disagree with its direction: that of the last step's impulses, or else that from
/// the first centre of mass to the second. A wedge may lie in a groove below the groove's centre: where no deep point
/// agrees, the direction is the opposite one.
pub(crate) fn resolve(points: &mut Vec<MeshContact>, diameter: f32, old: &[ContactManifold], centers: Vector) {
    let deep = || points.iter().filter(|point| point.separation < -DEPTH * diameter);
    if !deep().any(|p| deep().any(|q| p.normal.dot(q.normal) < OPPOSED)) {
        return;
    }
    let impulse = |m: &ContactManifold| m.normal * m.points.iter().map(|p| p.warm_start_normal_impulse).sum::<Scalar>();
    let last: Vector = old.iter().map(impulse).sum();
    let mut direction = [last, centers]
        .into_iter()
        .find_map(Vector::try_normalize)
        .unwrap_or(Vector::Y);
    let agrees = |point: &MeshContact, direction: Vector| {
        let normal: Vector = point.normal.adjust_precision();
        normal.dot(direction) >= 0.0
    };
    if !deep().any(|point| agrees(point, direction)) {
        direction = -direction;
    }
    points.retain(|point| point.separation >= 0.0 || agrees(point, direction));
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::{DQuat, DVec3, Vec3};
    use bevy_faceoff::asset::CollisionMesh;
    use bevy_faceoff::geometry::shapes;
    use bevy_faceoff::queries::{ContactWorker, Placed};

    /// Some point of two meshes.
    fn any() -> MeshContact {
        let cube = CollisionMesh::new(&shapes::cube(1.0));
        let placed = [DVec3::ZERO, DVec3::Y * 0.9]
            .map(|at| Placed::new(&cube, at, DQuat::IDENTITY, Vec3::ONE).expect("a valid pose"));
        let mut points = Vec::new();
        ContactWorker::new().points(&placed[0], &placed[1], 0.0, &mut points);
        points[0]
    }

    /// The remaining normals of deep points with these normals; `up` points from centre to centre.
    fn remaining(normals: &[Vec3], up: Vector) -> Vec<Vec3> {
        let point = any();
        let deep = |&normal: &Vec3| MeshContact {
            normal: normal.normalize(),
            separation: -0.1,
            ..point
        };
        let mut points: Vec<MeshContact> = normals.iter().map(deep).collect();
        resolve(&mut points, 1.0, &[], up);
        points.iter().map(|point| point.normal).collect()
    }

    #[test]
    fn points_against_the_direction_are_dropped() {
        assert_eq!(remaining(&[Vec3::Y, Vec3::NEG_Y], Vector::Y), [Vec3::Y]);
        assert_eq!(remaining(&[Vec3::Y, Vec3::NEG_Y], Vector::NEG_Y), [Vec3::NEG_Y]);
    }

    #[test]
    fn a_wedge_in_a_groove_is_held() {
        let sides = [Vec3::new(2.0, 1.0, 0.0), Vec3::new(-2.0, 1.0, 0.0)];
        for centers in [Vector::Y, Vector::NEG_Y] {
            assert_eq!(remaining(&sides, centers).len(), 2, "{centers}");
        }
    }
}
