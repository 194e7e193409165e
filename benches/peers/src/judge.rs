//! An independent test for pairs on which two libraries disagree: all triangles of one body against all of the other,
//! in double precision, computed from the scene. It shares no code with either library.

use crate::scene::Scene;
use bevy::math::{DMat3, DVec3};
use serde::Serialize;

/// The error of a position in single precision relative to the pair's size: ten units in the last place of a coordinate
/// at the border of the box.
pub const ROUNDING: f64 = 1.0e-5;

/// A pair on which a peer and bevy_faceoff disagree.
#[derive(Serialize)]
pub struct Dispute {
    /// The two bodies.
    pub pair: [u32; 2],
    /// Whether bevy_faceoff reports a touch; the peer reports the opposite.
    pub ours: bool,
    /// The distance of the surfaces in metres; 0 if they intersect.
    pub distance: f64,
    /// Whether a displacement by [`ROUNDING`] changes the answer.
    pub rounding: bool,
}

impl Dispute {
    /// Decides who is right.
    pub fn new(scene: &Scene, pair: [u32; 2], ours: bool) -> Self {
        let [a, b] = pair.map(|i| triangles(scene, i as usize));
        let reach = ROUNDING
            * pair
                .map(|i| f64::from(scene.bodies[i as usize].pose.scale.x))
                .iter()
                .sum::<f64>();
        let touch = intersect(&a, &b, DVec3::ZERO);
        let distance = if touch { 0.0 } else { distance(&a, &b) };
        let apart = |i: i32| {
            let step = |k: i32| f64::from(i / k % 3 - 1);
            !intersect(&a, &b, reach * DVec3::new(step(1), step(3), step(9)))
        };
        Self {
            pair,
            ours,
            distance,
            rounding: if touch { (0..27).any(apart) } else { distance <= reach },
        }
    }

    /// Whether bevy_faceoff is wrong by more than rounding.
    pub fn is_our_fault(&self) -> bool {
        !self.rounding && self.ours != (self.distance == 0.0)
    }
}

/// The corners of a triangle.
pub type Triangle = [DVec3; 3];

fn triangles(scene: &Scene, body: usize) -> Vec<Triangle> {
    let pose = &scene.bodies[body].pose;
    let matrix = DMat3::from_quat(pose.rotation.as_dquat().normalize()) * DMat3::from_diagonal(pose.scale.as_dvec3());
    let mesh = &scene.mesh.mesh;
    (0..mesh.triangles().len())
        .map(|t| {
            mesh.corners(t)
                .map(|p| pose.translation.as_dvec3() + matrix * p.as_dvec3())
        })
        .collect()
}

/// Whether the surfaces intersect with `b` moved by `offset`: whether an edge of one pierces a triangle of the other.
pub fn intersect(a: &[Triangle], b: &[Triangle], offset: DVec3) -> bool {
    let bounds = |t: &Triangle| (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
    let a: Vec<_> = a.iter().map(|t| (*t, bounds(t))).collect();
    b.iter().any(|t| {
        let t = t.map(|p| p + offset);
        let (low, high) = bounds(&t);
        a.iter()
            .any(|(s, (min, max))| min.cmple(high).all() && low.cmple(*max).all() && (pierces(s, &t) || pierces(&t, s)))
    })
}

/// Whether an edge of `s` intersects `t`.
fn pierces(s: &Triangle, t: &Triangle) -> bool {
    let volume = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (b - a).cross(c - a).dot(d - a);
    edges(s).any(|[p, q]| {
        let sides = edges(t).map(|[u, v]| volume(p, q, u, v));
        let (low, high) = sides.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        volume(t[0], t[1], t[2], p) * volume(t[0], t[1], t[2], q) <= 0.0 && (low >= 0.0 || high <= 0.0)
    })
}

/// The distance between two surfaces that do not intersect.
fn distance(a: &[Triangle], b: &[Triangle]) -> f64 {
    let pairs = a.iter().flat_map(|s| b.iter().map(move |t| (s, t)));
    pairs.fold(f64::INFINITY, |least, (s, t)| {
        let corners = s.iter().map(|p| above(*p, t)).chain(t.iter().map(|p| above(*p, s)));
        let edges = edges(s).flat_map(|e| edges(t).map(move |f| between(e, f)));
        corners.chain(edges).fold(least, f64::min)
    })
}

/// The height of a point above a triangle; infinite if its projection is outside.
pub fn above(p: DVec3, t: &Triangle) -> f64 {
    let normal = (t[1] - t[0]).cross(t[2] - t[0]);
    let inside = edges(t).all(|[u, v]| (v - u).cross(p - u).dot(normal) >= 0.0);
    if inside {
        ((p - t[0]).dot(normal) / normal.length()).abs()
    } else {
        f64::INFINITY
    }
}

/// The distance between two segments (Ericson 2005, 5.1.9).
fn between([p, q]: [DVec3; 2], [u, v]: [DVec3; 2]) -> f64 {
    let (d, e, r) = (q - p, v - u, p - u);
    let (dd, ee, de, dr, er) = (d.dot(d), e.dot(e), d.dot(e), d.dot(r), e.dot(r));
    let denominator = dd * ee - de * de;
    let mut s = if denominator > 0.0 {
        ((de * er - dr * ee) / denominator).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let mut t = (de * s + er) / ee;
    if t < 0.0 {
        (s, t) = ((-dr / dd).clamp(0.0, 1.0), 0.0);
    } else if t > 1.0 {
        (s, t) = (((de - dr) / dd).clamp(0.0, 1.0), 1.0);
    }
    (p + d * s).distance(u + e * t)
}

/// The edges of a triangle, from each corner to the next.
pub fn edges(t: &Triangle) -> impl Iterator<Item = [DVec3; 2]> + use<> {
    let t = *t;
    (0..3).map(move |k| [t[k], t[(k + 1) % 3]])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(z: f64) -> [Triangle; 1] {
        [[
            DVec3::new(0.0, 0.0, z),
            DVec3::new(1.0, 0.0, z),
            DVec3::new(0.0, 1.0, z),
        ]]
    }

    #[test]
    fn knows_what_crosses_and_how_far_apart_the_rest_is() {
        let upright = [[
            DVec3::new(0.2, 0.2, -1.0),
            DVec3::new(0.3, 0.2, -1.0),
            DVec3::new(0.2, 0.2, 1.0),
        ]];
        assert!(intersect(&at(0.0), &upright, DVec3::ZERO));
        assert!(!intersect(&at(0.0), &upright, DVec3::X));
        assert!((distance(&at(0.0), &at(0.25)) - 0.25).abs() < 1e-12);
        // The vertical edge is 0.2 beyond the middle of the long edge.
        let beside =
            upright.map(|t| t.map(|p| p + DVec3::new(0.3, 0.3, 0.0) + DVec3::new(0.2, 0.2, 0.0) / 2f64.sqrt()));
        assert!((distance(&at(0.0), &beside) - 0.2).abs() < 1e-12);
    }
}
