//! The paper's scene as plain data, for engines that know neither Bevy nor bevy_faceoff.

use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use bevy_faceoff::testing::scenes::paper::{self, Paper};
use clap::ValueEnum;
use serde::Serialize;
use std::time::Duration;

/// Length of a step.
pub const STEP: Duration = Duration::from_nanos(15_625_000);

/// Half the thickness of the box's walls where they are boxes: more than a body, none of which is larger than 2 m.
const WALL: f32 = 4.0;

/// The meshes of the paper's scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Shape {
    /// 240 triangles.
    Torus,
    /// 1120 triangles.
    Knot,
}

/// Which scene.
#[derive(Clone, Copy)]
pub struct Choice {
    /// The mesh of all bodies.
    pub shape: Shape,
    /// Number of bodies.
    pub bodies: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Coefficient of restitution of bodies and walls.
    pub restitution: f32,
}

impl Choice {
    /// The paper's number of bodies, elastic.
    pub fn new(shape: Shape) -> Self {
        Self {
            shape,
            bodies: 2200,
            seed: 1,
            restitution: 1.0,
        }
    }
}

/// All that an engine needs.
pub struct Scene {
    /// What was asked for.
    pub paper: Paper,
    /// The mesh of all bodies.
    pub mesh: CollisionMesh,
    /// In the order of their indices.
    pub bodies: Vec<Body>,
    /// Coefficient of restitution of bodies and walls.
    pub restitution: f32,
}

/// One body.
pub struct Body {
    /// Uniform scale.
    pub pose: Transform,
    /// Velocity of the centre of mass.
    pub velocity: Vec3,
}

impl Body {
    /// Its pose after this number of steps in which nothing stops it.
    pub fn pose_after(&self, steps: usize) -> Transform {
        let way = self.velocity * (steps as f32 * STEP.as_secs_f32());
        self.pose.with_translation(self.pose.translation + way)
    }
}

impl Shape {
    /// As the command line and tables write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Torus => "torus",
            Self::Knot => "knot",
        }
    }

    /// `faceoff simulate`'s default for `--speed`.
    fn speed(self) -> f32 {
        match self {
            Self::Torus => 0.5,
            Self::Knot => 3.0,
        }
    }
}

impl Scene {
    /// The scene of `faceoff simulate --shape SHAPE --bodies BODIES --seed SEED`.
    pub fn new(choice: &Choice) -> Self {
        let Choice {
            shape,
            bodies,
            seed,
            restitution,
        } = *choice;
        let mesh = CollisionMesh::new(&match shape {
            Shape::Torus => shapes::torus_240(),
            Shape::Knot => shapes::knot_1120(),
        });
        let paper = Paper {
            bodies,
            side: paper::default_side(bodies),
            speed: shape.speed(),
            seed,
        };
        let mut random = fastrand::Rng::with_seed(seed);
        let bodies = paper
            .flyers(&mesh, || random.f32())
            .map(|body| Body {
                pose: Transform {
                    translation: body.position,
                    rotation: body.rotation,
                    scale: Vec3::splat(body.scale),
                },
                velocity: body.velocity,
            })
            .collect();
        Self {
            paper,
            mesh,
            bodies,
            restitution,
        }
    }

    /// The mesh's corners as a body scales them, and its triangles.
    pub fn scaled_mesh(&self, body: &Body) -> (impl Iterator<Item = Vec3>, Vec<[u32; 3]>) {
        let mesh = &self.mesh.mesh;
        let scale = body.pose.scale;
        (
            mesh.vertices().iter().map(move |&v| v * scale),
            mesh.triangles().to_vec(),
        )
    }

    /// Centres and half sizes of six boxes around the box. The peers run faster against these than against planes,
    /// whose bounding boxes are endless.
    pub fn walls(&self) -> impl Iterator<Item = (Vec3, Vec3)> {
        let half = 0.5 * self.paper.side;
        [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(move |axis| {
            let size = (half + 2.0 * WALL) * (Vec3::ONE - axis) + WALL * axis;
            [axis, -axis].map(|out| (out * (half + WALL), size))
        })
    }
}
