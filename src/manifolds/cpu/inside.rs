//! Containment: the contact of a body inside another, along the shortest way out.

use super::feature::{Feature, Origin};
use super::side::Side;
use crate::geometry::cluster::CLUSTER;
use crate::geometry::distance::closest;
use crate::simd::lanes::{SimdBase, abs, bitmask, dot, load_points, max, mul, splat, splat_point, sub};
use crate::simd::level::baseline;
use crate::simd::levels::visit;
use crate::simd::rounding::PAD;
use crate::state::mesh_arena::BoxGroup;
use crate::triangle_test::cpu::containment::contains;
use glam::{DVec3, Vec3};
use std::cell::Cell;

/// The contact of two bodies whose surfaces do not intersect, if one is solid and contains a connected component of the
/// other. It leads from the nearest point of the outer surface to the far end of the contained part, on the line
/// through its middle.
pub fn contact(sides: &[Side; 2]) -> Option<Feature> {
    (0..2).find_map(|outer| {
        let (outer_side, inner_side) = (&sides[outer], &sides[1 - outer]);
        let start = component_inside(outer_side, inner_side)?;
        Some(push_out(outer_side, inner_side, start, outer == 0))
    })
}

/// Distance from the surface below which rounding decides whether a point is inside, in units of the bodies' size.
const ON_SURFACE: f64 = 1.0e-6;
/// Most vertices of a component that are tried until one lies off the surface.
const MAX_TRIED: usize = 64;

/// A point of `inner` inside `outer`: its centre of mass if that is inside, else a vertex.
fn component_inside(outer: &Side, inner: &Side) -> Option<DVec3> {
    if !outer.mesh.mesh.is_solid() {
        return None;
    }
    let vertices = inner.mesh.mesh.vertices();
    let mut points = inner.mesh.lanes().components.iter().map(|&v| vertices[v as usize]);
    let on_surface = ON_SURFACE * outer.diameter().min(inner.diameter());
    let is_off = |p: DVec3| nearest(outer, p).0.distance(p) > on_surface;
    let vertex = points.find_map(|p| {
        let placed = inner.place(p);
        if !is_inside(outer, placed) {
            return None;
        }
        if is_off(placed) {
            return Some(placed);
        }
        // This vertex touches the surface. Another vertex of its component decides.
        let features = inner.features;
        let first = features.vertices.iter().position(|vertex| *vertex == p)?;
        let same = |v: &u32| features.components[*v as usize] == features.components[first];
        let own: Vec<u32> = (0..features.vertices.len() as u32).filter(same).collect();
        let tried = own.iter().step_by(own.len().div_ceil(MAX_TRIED).max(1));
        let off = tried.map(|&v| inner.vertex(v)).find(|&p| is_off(p))?;
        is_inside(outer, off).then_some(off)
    })?;
    let center = inner.center;
    Some(if is_inside(outer, center) { center } else { vertex })
}

fn is_inside(outer: &Side, p: DVec3) -> bool {
    let p = outer.to_mesh(p);
    let aabb = outer.mesh.lanes().aabb;
    let from = (p - outer.mesh.mass.center.as_dvec3()).as_vec3();
    // The box test only saves work: a point barely outside the box is outside the body.
    from.cmpge(aabb.min).all() && from.cmple(aabb.max).all() && contains(outer.mesh, p)
}

fn push_out(outer: &Side, inner: &Side, start: DVec3, outer_is_first: bool) -> Feature {
    let (surface, triangle) = nearest(outer, start);
    let way = (surface - start).normalize_or(outer.normal(triangle));
    // With several components, only vertices inside determine the far end.
    let several = inner.mesh.lanes().components.len() > 1;
    let mut far = (0.0, 0);
    for (v, position) in (0..).zip(&inner.features.vertices) {
        let p = inner.place(*position);
        let along = way.dot(p - start);
        if along < far.0 && (!several || is_inside(outer, p)) {
            far = (along, v);
        }
    }
    let (end, vertex) = (start + way * far.0, far.1);
    let inner_triangle = inner.features.triangles.iter().position(|t| t.contains(&vertex));
    let inner_triangle = inner_triangle.unwrap_or(0) as u32;
    let separation = way.dot(end - surface);
    if outer_is_first {
        Feature {
            points: [surface, end],
            normal: way,
            separation,
            triangles: [triangle, inner_triangle],
            origin: Origin::Inside,
        }
    } else {
        Feature {
            points: [end, surface],
            normal: -way,
            separation,
            triangles: [inner_triangle, triangle],
            origin: Origin::Inside,
        }
    }
}

/// Nearest point of a body's surface to `p`, and its triangle.
fn nearest(side: &Side, p: DVec3) -> (DVec3, u32) {
    nearest_within(side, p, f64::INFINITY).unwrap_or((side.vertex(0), 0))
}

/// Whether a body's surface is no farther from `p` than `distance`.
pub fn is_near(side: &Side, p: DVec3, distance: f64) -> bool {
    nearest_within(side, p, distance).is_some()
}

/// Nearest point of a body's surface to `p`, and its triangle, if it is no farther than `most`.
fn nearest_within(side: &Side, p: DVec3, most: f64) -> Option<(DVec3, u32)> {
    let mesh = &side.mesh.mesh;
    let lanes = side.mesh.lanes();
    let local = side.to_mesh(p);
    // Distances are measured in the scaled mesh, in its own axes.
    let scale = side.scale.as_dvec3();
    let center = side.mesh.mass.center.as_dvec3();
    let simd = baseline();
    let from = splat_point(simd, ((local - center) * scale).as_vec3());
    let (scales, sizes) = (splat_point(simd, side.scale), splat_point(simd, side.scale.abs()));
    let pad = PAD * ((lanes.aabb.max - lanes.aabb.min) * side.scale).length();
    let pads = splat_point(simd, Vec3::splat(pad));
    let best = Cell::new((most * most, None));
    let met = |group: &BoxGroup| {
        let apart = sub(mul(load_points(simd, &group.center), scales), from);
        let half = load_points(simd, &group.half);
        let outside = sub(sub(abs(apart), mul(half, sizes)), pads);
        let outside = max(outside, splat_point(simd, Vec3::ZERO));
        let near = dot(outside, outside).simd_le(splat(simd, best.get().0 as f32 * 1.000_01));
        bitmask(near & splat(simd, 0.0).simd_le(half[0]))
    };
    visit(&lanes.levels, met, |cluster| {
        let first = cluster as usize * CLUSTER;
        for t in first..mesh.triangles().len().min(first + CLUSTER) {
            let corners = side.features.triangles[t].map(|v| side.vertex(v));
            let q = closest(p, &corners);
            let distance = q.distance_squared(p);
            if distance <= best.get().0 {
                best.set((distance, Some((q, t as u32))));
            }
        }
        true
    });
    best.get().1
}
