//! The generalised winding number: how far inside a surface a point is, even if the surface is open.
//!
//! It is the sum of the solid angles under which the point sees the triangles, in units of the full sphere (Jacobson,
//! Kavan and Sorkine-Hornung, "Robust Inside-Outside Segmentation using Generalized Winding Numbers", 2013). Inside a
//! closed surface whose faces point outward it is 1, outside 0; near an opening it lies between. Far triangles are
//! summed up as one dipole (Barill and others, "Fast Winding Numbers for Soups and Clouds", 2018).

use crate::geometry::TriMesh;
use glam::{DVec2, DVec3};
use std::cell::Cell;
use std::f64::consts::PI;

/// Children per node, and triangles per leaf.
const WIDTH: usize = 8;
/// A node counts as a dipole for points farther from its centre than this many of its radii. The error is then about a
/// hundredth.
const FAR: f64 = 2.5;

/// A mesh whose winding number can be asked for.
pub struct Winding {
    /// The corners of the triangles, after welding.
    corners: Vec<[DVec3; 3]>,
    /// Nodes over runs of eight, from the leaves up; the last level has one.
    levels: Vec<Vec<Node>>,
    /// The number of triangles and nodes that were looked at.
    work: Cell<u64>,
}

/// A run of triangles.
#[derive(Clone, Copy, Default)]
struct Node {
    /// The mean of the triangles' middles, weighted by area.
    center: DVec3,
    /// The sum of the triangles' area vectors.
    area_vector: DVec3,
    area: f64,
    /// No corner is farther from the centre than this.
    radius: f64,
}

impl Winding {
    /// Fast if the triangles are in cluster order.
    pub fn new(mesh: &TriMesh) -> Self {
        let count = mesh.triangles().len();
        let mut corners: Vec<[DVec3; 3]> = (0..count)
            .map(|t| mesh.welded_corners(t).map(|v| v.as_dvec3()))
            .collect();
        // A triangle that does not count is shrunk to a point.
        for [t, _] in mesh.twins() {
            corners[t] = [corners[t][0]; 3];
        }
        let leaves: Vec<Node> = (0..count.div_ceil(WIDTH))
            .map(|leaf| {
                let triangles = (leaf * WIDTH..count.min((leaf + 1) * WIDTH)).map(|t| corners[t]);
                Node::of(triangles.map(|t| {
                    let [a, b, c] = t;
                    let area_vector = (b - a).cross(c - a) * 0.5;
                    let center = (a + b + c) / 3.0;
                    Node {
                        center,
                        area_vector,
                        area: area_vector.length(),
                        radius: t.iter().map(|p| p.distance(center)).fold(0.0, f64::max),
                    }
                }))
            })
            .collect();
        let mut levels = vec![leaves];
        while levels[levels.len() - 1].len() > 1 {
            let runs = levels[levels.len() - 1].chunks(WIDTH);
            levels.push(runs.map(|run| Node::of(run.iter().copied())).collect());
        }
        Self {
            corners,
            levels,
            work: Cell::new(0),
        }
    }

    /// The winding number of a point, without the triangle `except`: seen from its own middle, a triangle adds a half
    /// on one side and takes a half away on the other.
    pub fn number(&self, p: DVec3, except: Option<usize>) -> f64 {
        let (mut sum, mut near, mut work) = (0.0, Turn::default(), 0);
        let mut waiting = vec![(self.levels.len() - 1, 0)];
        while let Some((level, i)) = waiting.pop() {
            let node = &self.levels[level][i];
            work += 1;
            let way = node.center - p;
            let distance = way.length();
            if distance > FAR * node.radius {
                sum += node.area_vector.dot(way) / (distance * distance * distance);
                continue;
            }
            if level > 0 {
                let end = self.levels[level - 1].len().min((i + 1) * WIDTH);
                waiting.extend((i * WIDTH..end).map(|child| (level - 1, child)));
                continue;
            }
            work += WIDTH as u64;
            for t in i * WIDTH..self.corners.len().min((i + 1) * WIDTH) {
                if except != Some(t) {
                    near.add(half_solid_angle(self.corners[t].map(|v| v - p)));
                }
            }
        }
        self.work.set(self.work.get() + work);
        (sum + 2.0 * near.angle()) / (4.0 * PI)
    }

    /// The number of triangles and nodes that all queries so far have looked at: a measure of time, about 20 ns each.
    pub fn work(&self) -> u64 {
        self.work.get()
    }
}

impl Node {
    fn of(parts: impl Iterator<Item = Node> + Clone) -> Self {
        let area: f64 = parts.clone().map(|part| part.area).sum();
        let weighted = |weight: fn(&Node) -> f64| parts.clone().map(|part| part.center * weight(&part)).sum::<DVec3>();
        let center = if area > 0.0 {
            weighted(|part| part.area) / area
        } else {
            weighted(|_| 1.0) / parts.clone().count() as f64
        };
        let reach = parts.clone().map(|part| part.center.distance(center) + part.radius);
        Self {
            center,
            area_vector: parts.clone().map(|part| part.area_vector).sum(),
            area,
            radius: reach.fold(0.0, f64::max),
        }
    }
}

/// A vector whose angle from the x axis is half the signed solid angle of a triangle seen from the origin, positive if
/// the origin is behind it (Van Oosterom and Strackee, "The Solid Angle of a Plane Triangle", 1983).
fn half_solid_angle([a, b, c]: [DVec3; 3]) -> DVec2 {
    let (x, y, z) = (a.length(), b.length(), c.length());
    DVec2::new(
        x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y,
        a.dot(b.cross(c)),
    )
}

/// A sum of the angles of vectors from the x axis. It turns one vector by the others, and so needs one arc tangent in
/// all.
struct Turn {
    vector: DVec2,
    /// Full turns, which the vector does not show.
    full: f64,
}

impl Default for Turn {
    fn default() -> Self {
        Self {
            vector: DVec2::X,
            full: 0.0,
        }
    }
}

impl Turn {
    fn add(&mut self, by: DVec2) {
        let turned = by.rotate(self.vector);
        let size = turned.abs().element_sum();
        // A vector without length has no angle: the point is a corner of the triangle.
        if size == 0.0 {
            return;
        }
        // Two angles of one sign add up to more than a half turn if the sign of the sum is the other.
        if self.vector.y >= 0.0 && by.y >= 0.0 && turned.y < 0.0 {
            self.full += 1.0;
        } else if self.vector.y < 0.0 && by.y < 0.0 && turned.y >= 0.0 {
            self.full -= 1.0;
        }
        self.vector = turned / size;
    }

    /// The sum, radians.
    fn angle(&self) -> f64 {
        self.vector.to_angle() + 2.0 * PI * self.full
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::cluster::cluster_order;
    use crate::geometry::shapes;
    use glam::Vec3;

    #[test]
    fn it_is_one_inside_and_zero_outside() {
        for mesh in [shapes::ball(1.0, 4), shapes::torus_240(), shapes::knot_1120()] {
            let mesh = mesh.reordered(&cluster_order(&mesh));
            let winding = Winding::new(&mesh);
            let plain = |p: DVec3| {
                let angles = (0..mesh.triangles().len())
                    .map(|t| 2.0 * half_solid_angle(winding.corners[t].map(|v| v - p)).to_angle());
                angles.sum::<f64>() / (4.0 * PI)
            };
            let mut inside = 0;
            for i in 0..2000 {
                let at = |k: f64| (f64::from(i) * k).fract() - 0.5;
                let p = DVec3::new(at(0.618_033_98), at(0.754_877_67), at(0.569_840_29)) * 2.2;
                let (exact, fast) = (plain(p), winding.number(p, None));
                assert!((exact - exact.round()).abs() < 1e-9, "{exact}");
                assert!((exact - fast).abs() < 0.05, "{exact} {fast}");
                inside += exact.round() as u32;
            }
            assert!((10..1990).contains(&inside), "{inside}");
        }
    }

    #[test]
    fn turns_are_counted() {
        for (step, count) in [(0.7, 100), (-0.7, 100), (3.0, 50), (-3.1, 50), (PI, 7)] {
            let mut turn = Turn::default();
            (0..count).for_each(|_| turn.add(DVec2::from_angle(step) * 1e-20));
            let sum = step * f64::from(count);
            assert!((turn.angle() - sum).abs() < 1e-9, "{} {sum}", turn.angle());
        }
    }

    #[test]
    fn in_a_hemisphere_it_is_a_half_at_the_middle_of_its_opening() {
        let ball = shapes::ball(1.0, 4);
        let upper = |t: &[u32; 3]| t.iter().all(|&v| ball.vertices()[v as usize].z >= -1e-6);
        let faces = ball.triangles().iter().copied().filter(upper).collect();
        let half = TriMesh::new(ball.vertices().to_vec(), faces).unwrap();
        let winding = Winding::new(&half);
        let at = |z: f32| winding.number(Vec3::new(0.01, 0.02, z).as_dvec3(), None);
        assert!((at(0.0) - 0.5).abs() < 0.02, "{}", at(0.0));
        assert!(at(0.8) > 0.8 && at(-2.0).abs() < 0.2);
    }
}
