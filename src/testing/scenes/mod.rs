//! Scenes shared by the command line, the tests and the benchmarks: bodies with poses, velocities and materials. Plain
//! data, without an engine. The caller passes a function that returns the next random number from 0 to 1, so this crate
//! needs no generator.

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
    /// Gravity, m/s^2.
    pub gravity: Vec3,
    /// Bodies, in the order in which engines add them.
    pub bodies: Vec<Body>,
}

/// A body.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Shape before scaling.
    pub shape: Shape,
    /// Scale along the shape's own axes.
    pub scale: Vec3,
    /// Whether the body is static.
    pub fixed: bool,
    /// Position of the shape's origin, metres.
    pub position: Vec3,
    /// A unit quaternion.
    pub rotation: Quat,
    /// Velocity of the centre of mass, m/s.
    pub velocity: Vec3,
    /// Angular velocity in world axes, rad/s.
    pub spin: Vec3,
    /// Friction of its surface.
    pub friction: Friction,
    /// Coefficient of restitution, 0 to 1.
    pub restitution: f32,
    /// Kilograms per cubic metre.
    pub density: f32,
}

/// The shape of a body before scaling.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// A sphere of radius 0.5 with 5,120 faces.
    Ball,
    /// A sphere of radius 0.6 with 5,120 faces.
    LargeBall,
    /// A cube of edge 1.
    Cube,
    /// A torus about z of 384 faces, of radius [`RING_LINE`] with a tube of radius [`RING_TUBE`].
    Ring,
    /// A trefoil knot of diameter 1 with 1,120 faces.
    Knot,
    /// A box that is open above. The inside is a unit cube whose floor is at height 0; the walls are [`BIN_WALL`]
    /// thick.
    Bin,
    /// A bolt along y that stands on the origin: see [`thread`].
    Bolt,
    /// A nut that fits the bolt, near its top.
    Nut,
}

/// Radius of a ring's centre line.
pub const RING_LINE: f64 = 0.44;

/// Radius of a ring's tube.
pub const RING_TUBE: f64 = 0.06;

/// Thickness of the bin's walls and floor before scaling.
pub const BIN_WALL: f32 = 0.3;

impl Shape {
    /// Its baked mesh, shared by all callers.
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
    /// An empty scene with the Earth's gravity along -y.
    pub fn new() -> Self {
        Self {
            gravity: Vec3::NEG_Y * 9.81,
            bodies: Vec::new(),
        }
    }

    /// An empty scene without gravity.
    pub fn weightless() -> Self {
        Self::default()
    }

    /// Adds a body, and returns it for changes.
    pub fn add(&mut self, body: Body) -> &mut Body {
        self.bodies.push(body);
        self.bodies.last_mut().expect("one was pushed")
    }

    /// Adds a static box of these edges, metres.
    pub fn block(&mut self, center: Vec3, edges: Vec3) -> &mut Body {
        self.add(Body {
            scale: edges,
            fixed: true,
            ..Body::new(Shape::Cube, center, Quat::IDENTITY)
        })
    }

    /// Adds a static box whose top is at height 0, rotated about the origin.
    pub fn floor(&mut self, edges: Vec3, turn: Quat) -> &mut Body {
        let floor = self.block(turn * Vec3::NEG_Y * (0.5 * edges.y), edges);
        floor.rotation = turn;
        floor
    }
}

impl Body {
    /// A dynamic body at rest with friction 0.5, restitution 0 and density 1.
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

/// A uniformly distributed rotation.
pub fn any_turn(random: &mut impl FnMut() -> f32) -> Quat {
    loop {
        let [x, y, z, w] = std::array::from_fn(|_| 2.0 * random() - 1.0);
        let turn = Quat::from_xyzw(x, y, z, w);
        // Rejection sampling in the unit ball gives a uniform direction; a length near zero has none.
        if (0.1..1.0).contains(&turn.length()) {
            return turn.normalize();
        }
    }
}

/// A uniformly distributed vector in the cube from -1 to 1.
pub fn any_vector(random: &mut impl FnMut() -> f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| 2.0 * random() - 1.0))
}

/// A box that is open above.
fn bin() -> TriMesh {
    // Corners of a box: x in bit 0, y in bit 1, z in bit 2. Sides are counter-clockwise seen from outside.
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
    // Inner sides have the opposite winding.
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
