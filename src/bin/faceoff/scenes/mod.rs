//! What `faceoff simulate` can run: the paper's box, and scenes in which bodies rest, hang, slide, pour and screw.

mod contacts;
mod thread;

use crate::scene;
use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use clap::ValueEnum;

/// Which scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SceneChoice {
    /// The paper's: bodies in a box with random poses, sizes and velocities, without gravity.
    Box,
    /// Interlocked rings, hung from a fixed one.
    Chain,
    /// Cubes on each other.
    Stack,
    /// Knots that fall into a bin.
    Pour,
    /// Cubes of friction 0.1 to 0.9, and a ball, on a slope of 25 degrees.
    Incline,
    /// A nut that spins down a bolt.
    Nut,
}

impl SceneChoice {
    /// As the command line and JSON write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Chain => "chain",
            Self::Stack => "stack",
            Self::Pour => "pour",
            Self::Incline => "incline",
            Self::Nut => "nut",
        }
    }

    /// How many bodies move unless told otherwise; `None` where the scene says how many.
    pub fn bodies(self) -> Option<usize> {
        match self {
            Self::Box => Some(2200),
            Self::Chain => Some(50),
            Self::Stack => Some(10),
            Self::Pour => Some(100),
            Self::Incline | Self::Nut => None,
        }
    }

    /// What moves unless told otherwise; `None` where the scene says what.
    pub fn shape(self) -> Option<&'static str> {
        match self {
            Self::Box => Some("torus"),
            Self::Pour => Some("knot"),
            Self::Chain | Self::Stack | Self::Incline | Self::Nut => None,
        }
    }

    /// How many steps unless told otherwise.
    pub fn steps(self) -> usize {
        match self {
            Self::Box => 100,
            _ => 640,
        }
    }

    /// What happens to bodies that touch unless told otherwise.
    pub fn response(self) -> Response {
        match self {
            Self::Box => Response::Impulse,
            _ => Response::Contacts,
        }
    }
}

/// What of a scene pictures show.
#[derive(Clone, Copy, Debug)]
pub struct Framing {
    /// Middle of the box that is shown.
    pub center: Vec3,
    /// Its side, metres.
    pub side: f32,
    /// Whether its edges are drawn.
    pub edges: bool,
}

/// Stands between the camera and what is to be seen: left out of pictures.
#[derive(Component)]
pub struct Unseen;

/// Spawns a scene of so many bodies, and tells what to show. `mesh` is what moves, where the scene leaves that open.
pub fn spawn(world: &mut World, choice: SceneChoice, scene: &scene::Scene, mesh: Option<&CollisionMesh>) -> Framing {
    match (choice, mesh) {
        (SceneChoice::Box, Some(mesh)) => {
            let handle = world.resource_mut::<Assets<CollisionMesh>>().add(mesh.clone());
            scene::spawn(world, scene, mesh, &handle);
            Framing {
                center: Vec3::ZERO,
                side: scene.side,
                edges: true,
            }
        }
        (SceneChoice::Pour, Some(mesh)) => contacts::pour(world, scene, mesh),
        (SceneChoice::Chain, _) => contacts::chain(world, scene.bodies),
        (SceneChoice::Stack, _) => contacts::stack(world, scene.bodies),
        (SceneChoice::Nut, _) => thread::spawn(world),
        (SceneChoice::Incline | SceneChoice::Box | SceneChoice::Pour, _) => contacts::incline(world),
    }
}
