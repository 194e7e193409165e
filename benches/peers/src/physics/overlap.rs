//! How deep two closed meshes lie in each other: slow, in double precision, from triangles alone.

use super::world::State;
use crate::judge::{Triangle, above, edges, intersect};
use bevy::math::DVec3;
use bevy_faceoff::testing::scenes::Shape;

/// A mesh in the world.
pub struct Solid {
    triangles: Vec<Triangle>,
    /// Points all over the surface.
    samples: Vec<DVec3>,
    /// Corners of its box.
    pub low: DVec3,
    pub high: DVec3,
}

impl Solid {
    /// A body that is not scaled.
    pub fn new(shape: Shape, state: &State) -> Self {
        let baked = shape.mesh();
        let (mesh, center) = (&baked.mesh, baked.mass.center.as_dvec3());
        let placed = |t: usize| {
            mesh.corners(t)
                .map(|p| state.center + state.rotation * (p.as_dvec3() - center))
        };
        let triangles: Vec<Triangle> = (0..mesh.triangles().len()).map(placed).collect();
        let mut samples = Vec::new();
        for (corners, t) in mesh.triangles().iter().zip(&triangles) {
            samples.push((t[0] + t[1] + t[2]) / 3.0);
            for (k, [from, to]) in edges(t).enumerate() {
                // Both triangles of an edge have it.
                if corners[k] < corners[(k + 1) % 3] {
                    samples.extend([0.0, 0.25, 0.5, 0.75].map(|part| from.lerp(to, part)));
                }
            }
        }
        let (low, high) = bounds(triangles.iter().flatten());
        Self {
            triangles,
            samples,
            low,
            high,
        }
    }

    /// Whether a point is inside: a ray from there leaves once more than it enters.
    fn contains(&self, p: DVec3) -> bool {
        let crosses = |t: &&Triangle| {
            let [a, b, c] = t.map(|q| q - p);
            let sides = [[a, b], [b, c], [c, a]].map(|[u, v]| u.y * v.z - u.z * v.y);
            let all = |sign: f64| sides.iter().all(|s| s * sign > 0.0);
            let x = (a.x * sides[1] + b.x * sides[2] + c.x * sides[0]) / sides.iter().sum::<f64>();
            (all(1.0) || all(-1.0)) && x > 0.0
        };
        self.triangles.iter().filter(crosses).count() % 2 == 1
    }

    fn distance(&self, p: DVec3) -> f64 {
        let to_edge = |[from, to]: [DVec3; 2]| {
            let along = ((p - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
            p.distance(from.lerp(to, along))
        };
        let to_triangle = |t: &Triangle| edges(t).map(to_edge).fold(above(p, t), f64::min);
        self.triangles.iter().map(to_triangle).fold(f64::INFINITY, f64::min)
    }

    /// How deep the deepest of the other's samples is in here.
    fn deepest(&self, other: &Self) -> f64 {
        let near = |p: &DVec3| p.cmpgt(self.low).all() && p.cmplt(self.high).all();
        let inside = other.samples.iter().copied().filter(|p| near(p) && self.contains(*p));
        inside.map(|p| self.distance(p)).fold(0.0, f64::max)
    }
}

/// How deep two lie in each other, in metres; `None` if their surfaces do not intersect.
pub fn depth(a: &Solid, b: &Solid) -> Option<f64> {
    let (low, high) = (a.low.max(b.low), a.high.min(b.high));
    let within = |solid: &Solid| -> Vec<Triangle> {
        let near = |t: &&Triangle| {
            let (l, h) = bounds(t.iter());
            l.cmple(high).all() && h.cmpge(low).all()
        };
        solid.triangles.iter().filter(near).copied().collect()
    };
    let apart = low.cmpgt(high).any() || !intersect(&within(a), &within(b), DVec3::ZERO);
    (!apart).then(|| a.deepest(b).max(b.deepest(a)))
}

fn bounds<'a>(points: impl Iterator<Item = &'a DVec3>) -> (DVec3, DVec3) {
    let all = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    points.fold(all, |(low, high), p| (low.min(*p), high.max(*p)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::DQuat;

    #[test]
    fn balls_are_as_deep_as_their_centres_say() {
        let ball = |x: f64| {
            let state = State {
                center: DVec3::new(x, 0.01, 0.02),
                rotation: DQuat::from_rotation_y(0.1),
                velocity: DVec3::ZERO,
                spin: DVec3::ZERO,
            };
            Solid::new(Shape::Ball, &state)
        };
        assert!(depth(&ball(0.0), &ball(1.01)).is_none());
        let deep = depth(&ball(0.0), &ball(0.9)).unwrap();
        assert!((deep - 0.1).abs() < 0.005, "{deep}");
    }
}
