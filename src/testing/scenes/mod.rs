//! Scenes that the command line, the tests and the benchmarks share: which bodies lie where, how they move and what their
//! surfaces are like. Plain data, without an engine. Random numbers from 0 to 1 come from the caller, by a function that returns
//! the next one, so that this crate needs no generator.

pub mod chain;
pub mod flight;
pub mod incline;
pub mod paper;
pub mod pour;
pub mod rest;
pub mod thread;

use crate::asset::CollisionMesh;
use crate::geometry::{TriMesh, shapes};
use crate::types::material::Friction;
use glam::{Quat, Vec3};
use std::sync::OnceLock;

/// A scene.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Acceleration, m/s^2.
    pub gravity: Vec3,
    /// In the order in which engines get them.
    pub bodies: Vec<Body>,
}

/// A body.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Before scaling.
    pub shape: Shape,
    /// Along the shape's own axes.
    pub scale: Vec3,
    /// Whether nothing moves it.
    pub fixed: bool,
    /// Of the shape's origin, metres.
    pub position: Vec3,
    /// A unit quaternion.
    pub rotation: Quat,
    /// Of the centre of mass, m/s.
    pub velocity: Vec3,
    /// World axes, rad/s.
    pub spin: Vec3,
    /// Of its surface.
    pub friction: Friction,
    /// 0 to 1.
    pub restitution: f32,
    /// Kilograms per cubic metre.
    pub density: f32,
}

/// What a body looks like before scaling.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// 5,120 faces with all corners on a sphere of radius 0.5.
    Ball,
    /// The same of radius 0.6.
    LargeBall,
    /// Edge 1.
    Cube,
    /// 384 faces: a torus about z of radius [`RING_LINE`], as thick as twice [`RING_TUBE`].
    Ring,
    /// 1,120 faces, diameter 1.
    Knot,
    /// Open above; the inside is a unit cube whose floor is at height 0, the walls are [`BIN_WALL`] thick.
    Bin,
    /// Stands on the origin, along y: see [`thread`].
    Bolt,
    /// Fits the bolt near its top.
    Nut,
}

/// Radius of a ring's centre line.
pub const RING_LINE: f64 = 0.44;

/// Radius of a ring's tube.
pub const RING_TUBE: f64 = 0.06;

/// Thickness of the bin's walls and floor before scaling.
pub const BIN_WALL: f32 = 0.3;

impl Shape {
    /// Its triangles, baked once.
    pub fn mesh(self) -> &'static CollisionMesh {
        static MESHES: [OnceLock<CollisionMesh>; 8] = [const { OnceLock::new() }; 8];
        MESHES[self as usize].get_or_init(|| {
            CollisionMesh::new(&match self {
                Self::Ball => shapes::ball(0.5, 4),
                Self::LargeBall => shapes::ball(0.6, 4),
                Self::Cube => shapes::cube(1.0),
                Self::Ring => shapes::ring(),
                Self::Knot => shapes::knot_1120(),
                Self::Bin => bin(),
                Self::Bolt => thread::bolt(),
                Self::Nut => thread::nut(),
            })
        })
    }
}

impl Scene {
    /// An empty one under the gravity of the Earth, which pulls down y.
    pub fn new() -> Self {
        Self {
            gravity: Vec3::NEG_Y * 9.81,
            bodies: Vec::new(),
        }
    }

    /// An empty one without gravity.
    pub fn weightless() -> Self {
        Self::default()
    }

    /// Adds a body, and returns it for changes.
    pub fn add(&mut self, body: Body) -> &mut Body {
        self.bodies.push(body);
        self.bodies.last_mut().expect("one was pushed")
    }

    /// Adds a fixed box of these edges, metres.
    pub fn block(&mut self, center: Vec3, edges: Vec3) -> &mut Body {
        self.add(Body {
            scale: edges,
            fixed: true,
            ..Body::new(Shape::Cube, center, Quat::IDENTITY)
        })
    }

    /// Adds a fixed box whose top is at height 0, turned about the origin.
    pub fn floor(&mut self, edges: Vec3, turn: Quat) -> &mut Body {
        let floor = self.block(turn * Vec3::NEG_Y * (0.5 * edges.y), edges);
        floor.rotation = turn;
        floor
    }
}

impl Body {
    /// A dynamic body at rest, of friction 0.5, restitution 0 and density 1.
    pub fn new(shape: Shape, position: Vec3, rotation: Quat) -> Self {
        Self {
            shape,
            scale: Vec3::ONE,
            fixed: false,
            position,
            rotation,
            velocity: Vec3::ZERO,
            spin: Vec3::ZERO,
            friction: Friction::default(),
            restitution: 0.0,
            density: 1.0,
        }
    }
}

/// A rotation, all equally likely.
pub fn any_turn(random: &mut impl FnMut() -> f32) -> Quat {
    loop {
        let [x, y, z, w] = std::array::from_fn(|_| 2.0 * random() - 1.0);
        let turn = Quat::from_xyzw(x, y, z, w);
        // Inside the ball, so that the cube's corners do not come up more often; away from zero, to have a direction.
        if (0.1..1.0).contains(&turn.length()) {
            return turn.normalize();
        }
    }
}

/// A vector in the cube from -1 to 1.
pub fn any_vector(random: &mut impl FnMut() -> f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| 2.0 * random() - 1.0))
}

/// A box with a hole.
fn bin() -> TriMesh {
    // Corners of a box, its sides seen from outside: x in bit 0, y in bit 1, z in bit 2.
    let corners = |half: f32, low: f32| {
        (0..8).map(move |k: u32| {
            let side = |bit: u32| (k >> bit & 1) as f32;
            Vec3::new(
                half * (2.0 * side(0) - 1.0),
                low + (1.0 - low) * side(1),
                half * (2.0 * side(2) - 1.0),
            )
        })
    };
    let vertices = corners(0.5 + BIN_WALL, -BIN_WALL).chain(corners(0.5, 0.0));
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [0, 2, 3, 1], [4, 5, 7, 6]];
    let outside = sides;
    // The inside is seen from the other side.
    let inside = sides.map(|[a, b, c, d]| [d + 8, c + 8, b + 8, a + 8]);
    let rim = [[2, 6, 14, 10], [6, 7, 15, 14], [7, 3, 11, 15], [3, 2, 10, 11]];
    let faces = outside
        .into_iter()
        .chain(inside)
        .chain(rim)
        .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    TriMesh::new(vertices.collect(), faces.collect()).expect("a valid mesh")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Orientation;

    #[test]
    fn a_ball_has_as_many_faces_as_it_says() {
        assert_eq!(Shape::Ball.mesh().mesh.triangles().len(), 5120);
    }

    #[test]
    fn the_bin_is_closed_and_weighs_what_its_walls_do() {
        let mesh = Shape::Bin.mesh();
        assert_eq!(mesh.mesh.orientation(), Orientation::Outward);
        let volume = mesh.mass.volume;
        assert!((volume - (1.6 * 1.6 * 1.3 - 1.0)).abs() < 1e-4, "{volume}");
    }
}
