//! Rounded meshes touch where their cores are no farther apart than both roundings.

use crate::geometry::cluster::CLUSTER;
use crate::geometry::distance::nearest;
use crate::simd::bounds::{Boxes, Near};
use crate::simd::lanes::splat_point;
use crate::simd::level::baseline;
use crate::simd::levels::visit;
use crate::simd::rounding::PAD;
use crate::state::mesh_arena::BoxGroup;
use crate::state::{Contact, PlacedMesh};
use glam::DVec3;

/// Triangles of both cores whose roundings touch.
pub struct Touch {
    pub triangles: [u32; 2],
    /// The distance of the cores there, metres.
    pub distance: f64,
    /// Between the surfaces, with the normal from the first body to the second.
    pub contact: Contact,
}

/// Calls `found` with all pairs of triangles that touch. It returns the distance of cores of interest from then on;
/// minus infinity ends the search. Cores that cross are left out: they have no direction.
pub fn touches(pair @ [a, b]: [&PlacedMesh; 2], mut found: impl FnMut(Touch) -> f64) {
    let rounding = f64::from(a.rounding) + f64::from(b.rounding);
    if rounding == 0.0 {
        return;
    }
    let count = |body: &PlacedMesh| body.mesh.mesh.triangles().len();
    // The larger tree is searched once for each triangle of the smaller.
    let outer = usize::from(count(b) > count(a));
    let search = Search {
        outer: pair[outer],
        inner: pair[1 - outer],
    };
    let mut reach = rounding;
    for triangle in 0..count(search.inner) {
        reach = search.near(triangle, reach, &mut |other, distance, [on_outer, way]| {
            let normal = if outer == 0 { way } else { -way };
            let own = triangle as u32;
            let triangles = if outer == 0 { [other, own] } else { [own, other] };
            let middle = on_outer + way * (f64::from(search.outer.rounding) + 0.5 * (distance - rounding));
            found(Touch {
                triangles,
                distance,
                contact: Contact {
                    point: middle.as_vec3(),
                    normal: normal.as_vec3(),
                },
            })
        });
        if reach < 0.0 {
            return;
        }
    }
}

struct Search<'a> {
    outer: &'a PlacedMesh<'a>,
    inner: &'a PlacedMesh<'a>,
}

impl Search<'_> {
    /// Calls `found` with the triangles of the outer mesh within `reach` of one of the inner mesh, their distance, the
    /// nearest point of the outer mesh, and the direction from there, in the world. Returns the reach that it returns.
    fn near(&self, triangle: usize, mut reach: f64, found: &mut impl FnMut(u32, f64, [DVec3; 2]) -> f64) -> f64 {
        let Self { outer, inner } = self;
        // In the outer mesh's axes, in metres, about its origin.
        let to_outer = outer.frame.rotation.transpose();
        let own = inner.mesh.mesh.corners(triangle).map(|p| {
            let from_origin = inner.frame.rotation * (inner.frame.scale * p.as_dvec3());
            to_outer * (from_origin + (inner.frame.position - outer.frame.position))
        });
        let center = outer.frame.scale * outer.mesh.mass.center.as_dvec3();
        let low = own[0].min(own[1]).min(own[2]) - center;
        let high = own[0].max(own[1]).max(own[2]) - center;
        let simd = baseline();
        let pad = PAD * (outer.radius + inner.radius);
        let near_box = Near::new(simd, 0.5 * (low + high), 0.5 * (high - low), pad);
        let (scales, most) = (splat_point(simd, outer.scale), (reach * (1.0 + 1.0e-6)) as f32);
        let met = |group: &BoxGroup| near_box.bounds(&Boxes::of(simd, group).scaled(scales), most).1;
        let mesh = &outer.mesh.mesh;
        visit(&outer.mesh.lanes().levels, met, |cluster| {
            let first = cluster as usize * CLUSTER;
            for t in first..mesh.triangles().len().min(first + CLUSTER) {
                let corners = mesh.corners(t).map(|p| outer.frame.scale * p.as_dvec3());
                let near = nearest(&corners, &own);
                if near.distance <= reach && near.distance > 0.0 {
                    let point = outer.frame.position + outer.frame.rotation * near.from;
                    reach = reach.min(found(
                        t as u32,
                        near.distance,
                        [point, outer.frame.rotation * near.direction],
                    ));
                }
            }
            reach >= 0.0
        });
        reach
    }
}
