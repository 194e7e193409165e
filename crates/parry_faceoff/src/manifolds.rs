//! Contact points as manifolds of parry.

use crate::convert::{narrow, rotation, to_parry};
use crate::parry::math::{Pose, Real};
use crate::parry::query::{ContactManifold, TrackedContact};
use crate::parry::shape::PackedFeatureId;
use bevy_faceoff::queries::{FeatureId, FeatureKind, MeshContact};

/// Most points of a manifold: engines drop those beyond.
const MOST_POINTS: usize = 4;
/// Least cosine of the angle between equal normals: they differ by rounding.
const SAME_NORMAL: Real = 1.0 - 1.0e-6;
/// Least cosine of the angle between the normals of a manifold and of the one that it follows.
const SIMILAR_NORMAL: Real = 0.5;
/// Bits of an index in the id of a point that stands for an overlap.
const OVERLAP_INDEX: u32 = (1 << 27) - 1;

/// A point of the last step, until a new one takes its data.
type Old<C> = Option<TrackedContact<C>>;

/// Replaces the manifolds of the last step by those of these points, whose first mesh lies at the origin. Points with
/// equal normals share manifolds. A point takes its data from the one with the same features, or from the nearest
/// within `reach`, metres.
pub fn replace<M, C>(points: &[MeshContact], pos12: &Pose, reach: Real, manifolds: &mut Vec<ContactManifold<M, C>>)
where
    M: Default,
    C: Default + Copy,
{
    let old = std::mem::take(manifolds);
    let back = rotation(pos12).normalize().inverse();
    for point in points {
        let normal = to_parry(point.normal);
        let place = manifolds
            .iter()
            .position(|m| m.points.len() < MOST_POINTS && m.local_n1.dot(normal) >= SAME_NORMAL);
        let manifold = match place {
            Some(place) => &mut manifolds[place],
            None => {
                let [face1, face2] = point.faces;
                let mut new = ContactManifold::with_data(face1, face2, M::default());
                new.local_n1 = normal;
                new.local_n2 = narrow(back * -point.normal.as_dvec3());
                manifolds.push(new);
                manifolds.last_mut().expect("one was pushed")
            }
        };
        let [at1, at2] = [narrow(point.anchors[0]), narrow(back * point.anchors[1])];
        let [id1, id2] = point.features.map(packed);
        manifold
            .points
            .push(TrackedContact::new(at1, at2, id1, id2, point.separation));
    }
    follow(old, manifolds, reach);
}

/// Hands the data of the last step on.
fn follow<M, C: Copy>(mut old: Vec<ContactManifold<M, C>>, new: &mut [ContactManifold<M, C>], reach: Real) {
    let mut contacts: Vec<Old<C>> = old.iter().flat_map(|m| m.points.iter().copied().map(Some)).collect();
    let mut lost = Vec::new();
    for contact in new.iter_mut().flat_map(|m| &mut m.points) {
        let same = |old: &&mut Old<C>| {
            old.is_some_and(|old| {
                (old.fid1, old.fid2) == (contact.fid1, contact.fid2)
                    && (is_of_feature(contact.fid1) || apart(&old, contact) <= reach)
            })
        };
        match contacts.iter_mut().find(same).and_then(Option::take) {
            Some(old) => contact.data = old.data,
            None => lost.push(contact),
        }
    }
    for contact in lost {
        let distance = |old: &Old<C>| old.map_or(Real::INFINITY, |old| apart(&old, contact));
        let nearest = contacts.iter_mut().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(nearest) = nearest.filter(|old| distance(old) <= reach).and_then(Option::take) {
            contact.data = nearest.data;
        }
    }
    for manifold in new {
        let cosine = |old: &ContactManifold<M, C>| old.local_n1.dot(manifold.local_n1);
        let nearest = (0..old.len()).max_by(|&a, &b| cosine(&old[a]).total_cmp(&cosine(&old[b])));
        if let Some(nearest) = nearest.filter(|&k| cosine(&old[k]) >= SIMILAR_NORMAL) {
            manifold.data = old.swap_remove(nearest).data;
        }
    }
}

/// How far a point has moved on the surfaces.
fn apart<C>(a: &TrackedContact<C>, b: &TrackedContact<C>) -> Real {
    let [first, second] = [a.local_p1.distance(b.local_p1), a.local_p2.distance(b.local_p2)];
    first.max(second)
}

/// Whether the id is that of a vertex, an edge or a face. Regions of overlap may exchange theirs.
fn is_of_feature(id: PackedFeatureId) -> bool {
    id.is_vertex() || id.is_edge() || id.is_face()
}

/// The id in parry's form. parry has no name for the features of overlaps, but their ids differ.
fn packed(id: FeatureId) -> PackedFeatureId {
    let overlap = |code: u32| PackedFeatureId(code << 27 | id.index() & OVERLAP_INDEX);
    match id.kind() {
        FeatureKind::Vertex => PackedFeatureId::vertex(id.index()),
        FeatureKind::Edge => PackedFeatureId::edge(id.index()),
        FeatureKind::Face => PackedFeatureId::face(id.index()),
        FeatureKind::Overlap { place } => overlap(1 + u32::from(place)),
        _ => overlap(7),
    }
}
