//! What `faceoff simulate` can run: the paper's box, and scenes in which bodies rest, hang, slide, pour and screw.

use bevy::prelude::*;
use bevy_faceoff::geometry::Aabb;
use bevy_faceoff::prelude::*;
use bevy_faceoff::testing::scenes::paper::Paper;
use bevy_faceoff::testing::scenes::{Body, Scene, Shape, chain, incline, pour, rest, thread};
use clap::ValueEnum;
use std::collections::HashMap;

/// Distance of the centres of neighbouring rings, metres: a little less than at rest.
const LINK: f32 = 0.75;

/// Gap between the cubes of a stack, metres.
const GAP: f32 = 0.02;

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

/// The part of a scene that pictures show.
#[derive(Clone, Copy, Debug)]
pub struct Framing {
    /// The box that is shown.
    pub bounds: Aabb,
    /// Whether its edges are drawn.
    pub edges: bool,
}

impl Framing {
    /// The corners of the box. Bit k of a number chooses the larger coordinate k.
    pub fn corners(&self) -> [Vec3; 8] {
        let Aabb { min, max } = self.bounds;
        std::array::from_fn(|i| Vec3::from_array([0, 1, 2].map(|k| if i >> k & 1 == 1 { max[k] } else { min[k] })))
    }
}

/// Stands between the camera and what is to be seen: left out of pictures.
#[derive(Component)]
pub struct Unseen;

/// Spawns a scene of so many bodies, and tells what to show. `mesh` is what moves, where the scene leaves that open.
pub fn spawn(world: &mut World, choice: SceneChoice, paper: &Paper, mesh: Option<&CollisionMesh>) -> Framing {
    match (choice, mesh) {
        (SceneChoice::Box, Some(mesh)) => spawn_paper(world, paper, mesh),
        (SceneChoice::Pour, Some(mesh)) => spawn_heap(world, paper, mesh),
        (SceneChoice::Chain, _) => {
            spawn_all(world, &chain::chain(paper.bodies + 1, LINK));
            let length = LINK * paper.bodies as f32;
            upright(-1.02 * length - 0.5, 0.5, 0.5)
        }
        (SceneChoice::Stack, _) => {
            spawn_all(world, &rest::stack(paper.bodies, GAP));
            let height = (1.0 + GAP) * paper.bodies as f32;
            upright(-0.5, height, 1.5)
        }
        (SceneChoice::Nut, _) => {
            spawn_all(world, &thread::nut_on_bolt());
            upright(0.0, thread::LENGTH, 1.2)
        }
        (SceneChoice::Incline | SceneChoice::Box | SceneChoice::Pour, _) => {
            spawn_all(world, &incline::frictions());
            framing(Vec3::new(11.2, 6.0, 5.5))
        }
    }
}

/// A box about the origin with half of these edges.
fn framing(half: Vec3) -> Framing {
    Framing {
        bounds: Aabb { min: -half, max: half },
        edges: false,
    }
}

/// A box about the y axis, as wide as deep.
fn upright(low: f32, high: f32, half: f32) -> Framing {
    Framing {
        bounds: Aabb {
            min: Vec3::new(-half, low, -half),
            max: Vec3::new(half, high, half),
        },
        edges: false,
    }
}

/// Spawns the bodies of a scene in their order.
fn spawn_all(world: &mut World, scene: &Scene) -> Vec<Entity> {
    let mut meshes: HashMap<Shape, MeshCollider> = HashMap::new();
    let spawn = |body: &Body| {
        let collider = meshes.entry(body.shape).or_insert_with(|| {
            let mut assets = world.resource_mut::<Assets<CollisionMesh>>();
            MeshCollider(assets.add(body.shape.mesh().clone()))
        });
        world
            .spawn((
                if body.fixed {
                    RigidBody::Static
                } else {
                    RigidBody::Dynamic
                },
                collider.clone(),
                Transform {
                    translation: body.position,
                    rotation: body.rotation,
                    scale: body.scale,
                },
                AngularVelocity(body.spin),
                body.friction,
            ))
            .id()
    };
    scene.bodies.iter().map(spawn).collect()
}

/// The paper's box.
fn spawn_paper(world: &mut World, paper: &Paper, mesh: &CollisionMesh) -> Framing {
    let handle = world.resource_mut::<Assets<CollisionMesh>>().add(mesh.clone());
    for (point, normal) in paper.walls() {
        world.spawn((PlaneCollider::through(point, normal), Restitution::new(1.0)));
    }
    let mut random = fastrand::Rng::with_seed(paper.seed);
    for body in paper.flyers(mesh, || random.f32()) {
        world.spawn((
            RigidBody::Dynamic,
            MeshCollider(handle.clone()),
            Transform {
                translation: body.position,
                rotation: body.rotation,
                scale: Vec3::splat(body.scale),
            },
            LinearVelocity(body.velocity),
            Restitution::new(1.0),
        ));
    }
    Framing {
        edges: true,
        ..framing(Vec3::splat(0.5 * paper.side))
    }
}

/// Bodies of diameter 1 above a bin.
fn spawn_heap(world: &mut World, paper: &Paper, mesh: &CollisionMesh) -> Framing {
    let heap = pour::heap(paper.bodies);
    let bin = spawn_all(world, &heap.bin);
    for wall in [bin[1], bin[3]] {
        world.entity_mut(wall).insert(Unseen);
    }
    let collider = MeshCollider(world.resource_mut::<Assets<CollisionMesh>>().add(mesh.clone()));
    let scale = 1.0 / (2.0 * mesh.radius);
    let mut random = fastrand::Rng::with_seed(paper.seed);
    for (center, rotation) in heap.poses(paper.bodies, &mut || random.f32()) {
        world.spawn((
            RigidBody::Dynamic,
            collider.clone(),
            Transform {
                translation: center - rotation * (scale * mesh.mass.center),
                rotation,
                scale: Vec3::splat(scale),
            },
        ));
    }
    // With its floor and walls, which are 1 m thick.
    upright(-1.0, heap.height, 0.5 * heap.width + 1.0)
}
