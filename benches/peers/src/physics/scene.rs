//! A scene of physics as plain data: which bodies lie where, how they move, what they are made of and what they weigh.

use bevy::math::{DMat3, DVec3, Quat, Vec3};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use std::sync::OnceLock;

/// Kilograms per cubic metre, of all bodies.
const DENSITY: f64 = 1.0;

/// Thickness of the bin's walls and floor before scaling.
pub const BIN_WALL: f32 = 0.3;

/// What bodies look like before scaling.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// 5,120 faces with all corners on a sphere of radius 0.5.
    Ball,
    /// Edge 1.
    Cube,
    /// 384 faces: a torus about z of radius [`RING_LINE`], as thick as twice [`RING_TUBE`].
    Ring,
    /// 1,120 faces, diameter 1.
    Knot,
    /// Open above; the inside is a unit cube whose floor is at height 0.
    Bin,
}

/// Radius of a ring's centre line.
pub const RING_LINE: f64 = 0.44;

/// Radius of a ring's tube.
pub const RING_TUBE: f64 = 0.06;

/// A scene.
#[derive(Clone, Default)]
pub struct Scene {
    /// Acceleration, m/s^2.
    pub gravity: Vec3,
    /// All that is in it.
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
    /// Of the shape's origin.
    pub position: Vec3,
    /// A unit quaternion.
    pub rotation: Quat,
    /// Of the centre of mass, m/s.
    pub velocity: Vec3,
    /// World axes, rad/s.
    pub spin: Vec3,
    /// Coulomb's coefficient.
    pub friction: f32,
    /// 0 to 1.
    pub restitution: f32,
}

/// How a body resists being moved. All engines are given the same.
#[derive(Clone, Copy, Debug)]
pub struct Mass {
    /// Kilograms.
    pub mass: f64,
    /// Of mass, from the shape's origin, in the body's own axes.
    pub center: DVec3,
    /// About the centre, in the body's own axes, kg m^2.
    pub inertia: DMat3,
}

impl Shape {
    /// The triangles, baked once.
    pub fn mesh(self) -> &'static CollisionMesh {
        static MESHES: [OnceLock<CollisionMesh>; 5] = [const { OnceLock::new() }; 5];
        MESHES[self as usize].get_or_init(|| {
            CollisionMesh::new(&match self {
                Self::Ball => shapes::ball(0.5, 4),
                Self::Cube => shapes::cube(1.0),
                Self::Ring => shapes::ring(),
                Self::Knot => shapes::knot_1120(),
                Self::Bin => bin(),
            })
        })
    }
}

impl Scene {
    /// An empty one, in which things fall or not.
    pub fn new(gravity: bool) -> Self {
        Self {
            gravity: if gravity { Vec3::NEG_Y * 9.81 } else { Vec3::ZERO },
            bodies: Vec::new(),
        }
    }

    /// Adds a static box whose top is at height 0, turned about the origin.
    pub fn floor(&mut self, size: Vec3, turn: Quat) -> &mut Body {
        let mut floor = Body::new(Shape::Cube, turn * Vec3::NEG_Y * (0.5 * size.y), turn);
        (floor.scale, floor.fixed) = (size, true);
        self.add(floor)
    }

    /// Adds a body, for changes.
    pub fn add(&mut self, body: Body) -> &mut Body {
        self.bodies.push(body);
        self.bodies.last_mut().expect("one was pushed")
    }
}

impl Body {
    /// A dynamic body at rest.
    pub fn new(shape: Shape, position: Vec3, rotation: Quat) -> Self {
        Self {
            shape,
            scale: Vec3::ONE,
            fixed: false,
            position,
            rotation,
            velocity: Vec3::ZERO,
            spin: Vec3::ZERO,
            friction: 0.5,
            restitution: 0.0,
        }
    }

    /// What it weighs.
    pub fn mass(&self) -> Mass {
        let (baked, scale) = (&self.shape.mesh().mass, self.scale.as_dvec3());
        let mass = DENSITY * f64::from(baked.volume) * scale.element_product();
        Mass {
            mass,
            center: scale * baked.center.as_dvec3(),
            inertia: baked.inertia(scale, mass),
        }
    }
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
    use bevy_faceoff::geometry::Orientation;

    #[test]
    fn the_bin_is_closed_and_weighs_what_its_walls_do() {
        let mesh = Shape::Bin.mesh();
        assert_eq!(mesh.mesh.orientation(), Orientation::Outward);
        assert!(
            (mesh.mass.volume - (1.6 * 1.6 * 1.3 - 1.0)).abs() < 1e-4,
            "{}",
            mesh.mass.volume
        );
    }
}
