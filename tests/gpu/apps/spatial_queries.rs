//! Questions about bodies whose results are read later, or that stay on the GPU.

use super::readback::{app, await_device, opening};
use crate::app::{Sim, assert_near, ball_like};
use crate::gpu::Test;
use bevy::ecs::system::SystemState;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::plugin::queries::{SpatialQueryError, update_spatial_queries_from};
use bevy_faceoff::prelude::*;

pub const TESTS: &[Test] = &[
    ("bodies_are_where_their_components_say", components),
    ("resident_bodies_are_asked_through_a_snapshot", resident),
    ("what_was_read_before_the_device_was_ready_is_forgotten", stale),
];

fn look_down(sim: &mut Sim) -> (Option<RayHitData>, Result<(), SpatialQueryError>) {
    let mut state = SystemState::<SpatialQuery>::new(sim.world());
    let world = state.get(sim.app.world()).unwrap();
    let filter = SpatialQueryFilter::default();
    let hit = world.cast_ray(Vec3::new(0.3, 50.0, 0.2), Dir3::NEG_Y, 100.0, &filter);
    (hit, world.check())
}

fn rising_cube(sim: &mut Sim) -> Entity {
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.spawn(ball_like(&cube, Vec3::ZERO, Vec3::Y * 8.0))
}

fn components(_: &Gpu) {
    for readback in [Readback::Lockstep, Readback::Latent] {
        let mut sim = app(Backend::Gpu, readback);
        let cube = rising_cube(&mut sim);
        for step in 0..12 {
            sim.step(1);
            let (hit, answers) = look_down(&mut sim);
            assert_eq!(answers, Ok(()));
            let at = sim.position(cube);
            let hit = hit.unwrap_or_else(|| panic!("{readback:?}, step {step}: {at}"));
            assert_eq!(hit.collider, cube);
            assert_near(hit.point, sim.position(cube) + Vec3::new(0.3, 0.5, 0.2), 1e-5);
        }
        // Results that are published while the clock is paused.
        sim.world().resource_mut::<Time<Physics>>().pause();
        sim.step(4);
        let hit = look_down(&mut sim).0.unwrap();
        assert_near(hit.point, sim.position(cube) + Vec3::new(0.3, 0.5, 0.2), 1e-5);
    }
}

fn stale(_: &Gpu) {
    let mut sim = opening(Backend::Gpu, Readback::Resident);
    let cube = rising_cube(&mut sim);
    let (hit, answers) = look_down(&mut sim);
    assert_eq!((hit.map(|hit| hit.collider), answers), (Some(cube), Ok(())));
    await_device(&mut sim);
    sim.step(4);
    assert_eq!(look_down(&mut sim), (None, Err(SpatialQueryError::Resident)));
}

fn resident(_: &Gpu) {
    let mut sim = app(Backend::Gpu, Readback::Resident);
    let cube = rising_cube(&mut sim);
    sim.step(4);
    assert_eq!(look_down(&mut sim), (None, Err(SpatialQueryError::Resident)));
    sim.step(4);
    let snapshot = Snapshot::take(sim.world());
    update_spatial_queries_from(sim.world(), snapshot.bodies());
    let (_, motion) = snapshot.bodies().find(|(entity, _)| *entity == cube).unwrap();
    for _ in 0..2 {
        let (hit, answers) = look_down(&mut sim);
        assert_eq!(answers, Ok(()));
        assert_near(hit.unwrap().point, motion.position + Vec3::new(0.3, 0.5, 0.2), 1e-5);
        assert!(motion.position.y > 0.5);
        // It answers from the snapshot until the next one.
        sim.step(4);
    }
}
