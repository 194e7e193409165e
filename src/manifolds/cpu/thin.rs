//! Cores without faces: segments and points. Their surface is all that is within the rounding of them, so while they are
//! outside of the other body their features are all there is. A segment that has pierced the other's surface has no
//! contour; its ends are pushed back out.

use super::crossing::Segment;
use super::feature::{Feature, Origin};
use super::side::Side;

/// The feature that pushes a segment out of the faces that it pierces: of its end that is least deep behind one of
/// them.
pub fn push_out(sides: &[Side; 2], segments: &[Segment]) -> Option<Feature> {
    let thin = sides.iter().position(Side::is_thin)?;
    let (own, other) = (&sides[thin], &sides[1 - thin]);
    let behind = segments.iter().flat_map(|segment| {
        let face = other.triangle(segment.triangles[1 - thin]);
        (0..own.features.vertices.len() as u32).filter_map(move |vertex| {
            let end = own.vertex(vertex);
            let height = face.normal.dot(end - face.corners[0]);
            let foot = end - face.normal * height;
            (height < 0.0).then_some((height, segment, vertex, [end, foot], face.normal))
        })
    });
    let (separation, segment, vertex, [end, foot], out) = behind.max_by(|p, q| p.0.total_cmp(&q.0))?;
    let (points, normal) = if thin == 0 { ([end, foot], -out) } else { ([foot, end], out) };
    Some(Feature {
        points,
        normal,
        separation,
        triangles: segment.triangles,
        origin: Origin::Vertex {
            side: thin as u8,
            vertex,
        },
    })
}
