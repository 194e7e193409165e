//! Contact points of two meshes as Avian's manifolds.

use crate::pose::Pose;
use avian3d::collision::contact_types::PackedFeatureId;
use avian3d::math::{AdjustPrecision, Scalar, Vector};
use avian3d::prelude::{ContactManifold, ContactPoint};
use bevy_faceoff::queries::{FeatureId, FeatureKind, MeshContact};

/// Avian drops all points of a manifold but four.
const MAX_POINTS: usize = 4;

/// Normals within one degree count as equal: the points of a manifold share the normal of the first of them.
const SAME_NORMAL: Scalar = 0.999_847_7;

/// Bits of an index in the id of a point that stands for an overlap. Avian uses the two highest bits of others.
const OVERLAP_BITS: u32 = 27;

/// Points that take the impulse of another feature have normals within 37 degrees.
const LIKE_NORMAL: Scalar = 0.8;

/// Manifolds of `points`, in their order. `first` is the position of the first mesh's origin, and surfaces that are
/// `rest_offset` apart count as touching.
pub(crate) fn group(points: &[MeshContact], first: Vector, rest_offset: f32) -> Vec<ContactManifold> {
    let mut manifolds: Vec<ContactManifold> = Vec::new();
    for point in points {
        let normal = point.normal.adjust_precision();
        let contact = contact(point, first, rest_offset);
        let with_room = |m: &&mut ContactManifold| m.points.len() < MAX_POINTS && m.normal.dot(normal) >= SAME_NORMAL;
        match manifolds.iter_mut().find(with_room) {
            Some(manifold) => manifold.points.push(contact),
            None => manifolds.push(ContactManifold::new([contact], normal)),
        }
    }
    manifolds
}

/// Anchors are relative to the origins of the meshes: Avian makes them relative to the centres of mass.
fn contact(point: &MeshContact, first: Vector, rest_offset: f32) -> ContactPoint {
    let [a, b] = point.anchors.map(|anchor| anchor.adjust_precision());
    let half_way = (0.5 * point.separation * point.normal).adjust_precision();
    let [feature_a, feature_b] = point.features.map(packed);
    let depth = (rest_offset - point.separation).adjust_precision();
    ContactPoint::new(a, b, first + a + half_way, depth).with_feature_ids(feature_a, feature_b)
}

/// Avian has no name for the features of overlaps, but their ids must differ: unknown ones are all equal to it.
fn packed(feature: FeatureId) -> PackedFeatureId {
    let overlap = |code: u32| PackedFeatureId(code << OVERLAP_BITS | feature.index() & ((1 << OVERLAP_BITS) - 1));
    match feature.kind() {
        FeatureKind::Vertex => PackedFeatureId::vertex(feature.index()),
        FeatureKind::Edge => PackedFeatureId::edge(feature.index()),
        FeatureKind::Face => PackedFeatureId::face(feature.index()),
        FeatureKind::Overlap { place } => overlap(1 + u32::from(place)),
        _ => overlap(7),
    }
}

/// A point of the last step.
pub(crate) struct Carried<'a> {
    old: &'a ContactPoint,
    /// Place and normal of the point now, if it has moved with the first collider.
    point: Vector,
    normal: Vector,
}

/// The points of the last step, moved with the first collider from `last` to `now`. So points keep their places on the
/// surface while a whole scene moves.
pub(crate) fn carried<'a>(old: &'a [ContactManifold], last: &Pose, now: &Pose) -> Vec<Carried<'a>> {
    let carried = |normal: Vector, old: &'a ContactPoint| Carried {
        old,
        point: last.carry(old.point, now),
        normal: last.turn(normal, now),
    };
    let points = old
        .iter()
        .flat_map(|m| m.points.iter().map(move |point| (m.normal, point)));
    points.map(|(normal, point)| carried(normal, point)).collect()
}

/// Gives each point the impulses of the last step's point between the same features, or else of the nearest one within
/// `reach` that no other point has.
///
/// Avian does the first by itself, for pairs with at most four manifolds.
pub(crate) fn warm_start(new: &mut [ContactManifold], old: Vec<Carried>, reach: Scalar) {
    let mut left = old;
    let mut unmatched = Vec::new();
    for manifold in new {
        let normal = manifold.normal;
        for point in &mut manifold.points {
            let same = |last: &Carried| {
                (last.old.feature_id1, last.old.feature_id2) == (point.feature_id1, point.feature_id2)
                    && (is_of_feature(point.feature_id1) || last.point.distance_squared(point.point) < reach * reach)
            };
            match left.iter().position(same) {
                Some(i) => take_impulses(point, left.swap_remove(i).old),
                None => unmatched.push((normal, point)),
            }
        }
    }
    for (normal, point) in unmatched {
        let near = left
            .iter()
            .enumerate()
            .filter(|(_, last)| last.normal.dot(normal) > LIKE_NORMAL);
        let near = near.map(|(i, last)| (i, last.point.distance_squared(point.point)));
        let nearest = near.min_by(|(_, a), (_, b)| a.total_cmp(b));
        if let Some((i, _)) = nearest.filter(|(_, apart)| *apart < reach * reach) {
            take_impulses(point, left.swap_remove(i).old);
        }
    }
}

/// Whether the id is that of a vertex, an edge or a face. Regions of overlap may exchange theirs.
fn is_of_feature(id: PackedFeatureId) -> bool {
    id.is_vertex() || id.is_edge() || id.is_face()
}

fn take_impulses(point: &mut ContactPoint, old: &ContactPoint) {
    point.warm_start_normal_impulse = old.warm_start_normal_impulse;
    point.warm_start_tangent_impulse = old.warm_start_tangent_impulse;
}

#[cfg(test)]
mod tests {
    use super::*;
    use avian3d::math::Quaternion;

    /// A manifold of one point between `features`, with an impulse.
    fn manifold(point: Vector, normal: Vector, features: u32, impulse: Scalar) -> ContactManifold {
        let id = PackedFeatureId::vertex(features);
        let mut contact = ContactPoint::new(Vector::ZERO, Vector::ZERO, point, 0.0).with_feature_ids(id, id);
        contact.warm_start_normal_impulse = impulse;
        ContactManifold::new([contact], normal)
    }

    #[test]
    fn impulses_move_with_the_pair() {
        let pose = |position, turn| Pose {
            position,
            rotation: Quaternion::from_rotation_z(turn),
        };
        let (last, now) = (pose(Vector::X, 0.0), pose(Vector::new(5.0, 2.0, 0.0), 1.0));
        let (point, normal) = (Vector::new(1.0, 1.0, 0.0), Vector::Y);
        let old = [manifold(point, normal, 1, 3.0)];
        let turned = Quaternion::from_rotation_z(1.0) * Vector::Y;
        let mut new = [manifold(now.position + turned, turned, 2, 0.0)];
        warm_start(&mut new, carried(&old, &last, &now), 0.01);
        assert_eq!(new[0].points[0].warm_start_normal_impulse, 3.0);
        // If the pair has not moved, this is another point.
        let mut new = [manifold(now.position + turned, turned, 2, 0.0)];
        warm_start(&mut new, carried(&old, &last, &last), 0.01);
        assert_eq!(new[0].points[0].warm_start_normal_impulse, 0.0);
    }
}
