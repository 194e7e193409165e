//! Feature ids: stable identifiers of the features that make a contact point.

use super::feature::{Feature, Origin};
use super::side::Side;
use crate::types::feature_id::{FeatureId, FeatureKind};

/// The ids of a feature on both bodies.
pub fn feature_ids(sides: &[Side; 2], feature: &Feature) -> [FeatureId; 2] {
    [0, 1].map(|i| {
        let (own, triangle) = (&sides[i], feature.triangles[i]);
        match feature.origin {
            Origin::Vertex { side, vertex } if usize::from(side) == i => vertex_id(own, triangle, vertex),
            Origin::Vertex { .. } => FeatureId::new(FeatureKind::Face, own.face(triangle)),
            Origin::Edges(places) => edge_id(own, triangle, places[i]),
            Origin::VertexEdge { side, vertex, .. } if usize::from(side) == i => vertex_id(own, triangle, vertex),
            Origin::VertexEdge { edge, .. } => edge_id(own, triangle, edge),
            Origin::Vertices(corners) => {
                let corners_of = own.features.triangles[triangle as usize];
                vertex_id(own, triangle, corners_of[usize::from(corners[i])])
            }
            Origin::Patch { place, number } => FeatureId::new(FeatureKind::Overlap { place }, number),
            Origin::Inside => FeatureId::new(FeatureKind::Containment, 0),
        }
    })
}

/// Id of a vertex, given a triangle that contains it.
fn vertex_id(side: &Side, triangle: u32, vertex: u32) -> FeatureId {
    let mesh = &side.mesh.mesh;
    let corners = side.features.triangles[triangle as usize];
    let corner = corners.iter().position(|&v| v == vertex).unwrap_or(0);
    let index = mesh.triangles()[triangle as usize][corner];
    FeatureId::new(FeatureKind::Vertex, mesh.welded()[index as usize])
}

/// Id of the edge at this position of a triangle.
fn edge_id(side: &Side, triangle: u32, place: u8) -> FeatureId {
    // Turned faces list their corners in the opposite order of the input.
    let is_turned = side.mesh.mesh.is_turned(triangle as usize);
    let place = if is_turned { 2 - place } else { place };
    let index = side.face(triangle).wrapping_mul(3).wrapping_add(u32::from(place));
    FeatureId::new(FeatureKind::Edge, index)
}
