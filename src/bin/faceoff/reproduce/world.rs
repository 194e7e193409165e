//! The paper's box, filled again and again in one app.

use super::{Plan, median};
use crate::headless::{self, Headless};
use crate::scenes::{self, Framing, SceneChoice};
use crate::{BackendChoice, CullingChoice, Outcome};
use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use bevy_faceoff::testing::scenes::paper::{Paper, default_side};
use bevy_faceoff::types::stage::Stage;

/// A shape of the paper, with its face table.
pub struct Shape {
    pub name: &'static str,
    pub mesh: CollisionMesh,
    /// Largest speed in the paper, m/s.
    pub speed: f32,
}

/// An app that holds one box of bodies at a time. One app serves all boxes, because a device is opened and its kernels
/// are compiled once for each app.
pub struct World {
    pub app: App,
}

/// Medians over the steps that were measured.
pub struct Measured {
    pub sphere_pairs: f64,
    pub touching: f64,
    pub broad_ms: f64,
    pub narrow_ms: f64,
}

impl World {
    pub fn new(backend: BackendChoice) -> Outcome<Self> {
        let app = Headless {
            backend,
            readback: Readback::Lockstep,
            threads: 0,
            culling: CullingChoice::Exact,
            response: Response::Impulse,
            gravity: Gravity(Vec3::ZERO),
        };
        Ok(Self { app: app.app()? })
    }

    /// The adapter of a world on a GPU.
    pub fn adapter(&self) -> Option<String> {
        match self.app.world().resource() {
            ActiveBackend::Gpu { adapter, .. } => Some(adapter.clone()),
            _ => None,
        }
    }

    /// Replaces what is in the world by a box of bodies, and takes two steps, which allocate.
    pub fn fill(&mut self, plan: &Plan, shape: &Shape, bodies: usize, culling: CullingChoice) -> Outcome<Framing> {
        let world = self.app.world_mut();
        let old: Vec<Entity> = world
            .query_filtered::<Entity, Or<(With<RigidBody>, With<PlaneCollider>)>>()
            .iter(world)
            .collect();
        for entity in old {
            world.despawn(entity);
        }
        world.insert_resource(Culling::from(culling));
        let paper = Paper {
            bodies,
            side: default_side(bodies),
            speed: shape.speed,
            seed: plan.seed,
        };
        let framing = scenes::spawn(world, SceneChoice::Box, &paper, Some(&shape.mesh));
        for _ in 0..2 {
            headless::step(&mut self.app)?;
        }
        Ok(framing)
    }

    /// Takes so many steps.
    pub fn measure(&mut self, steps: usize) -> Outcome<Measured> {
        let reports = (0..steps)
            .map(|_| headless::step(&mut self.app).cloned())
            .collect::<Outcome<Vec<StepReport>>>()?;
        let of = |value: &dyn Fn(&StepReport) -> f64| median(reports.iter().map(value));
        let ms = |r: &StepReport, stage| r.time(stage).as_secs_f64() * 1e3;
        Ok(Measured {
            sphere_pairs: of(&|r| r.sphere_pairs as f64),
            touching: of(&|r| r.touching_pairs as f64),
            broad_ms: of(&|r| ms(r, Stage::BroadPhase)),
            narrow_ms: of(&|r| ms(r, Stage::Angles) + ms(r, Stage::TriangleTest)),
        })
    }
}
