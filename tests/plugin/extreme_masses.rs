//! Masses and inertias near the ends of single precision.

use crate::app::{Sim, resting};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use bevy_faceoff::state::fault::BodyFault;

#[test]
fn a_mass_without_an_inverse_takes_a_body_of_several_colliders_out() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let body = sim.spawn((resting(&cube, Vec3::ZERO), Mass(1e-40)));
    let child = sim.spawn((cube.clone(), Transform::from_xyz(2.0, 0.0, 0.0)));
    sim.world().entity_mut(body).add_child(child);
    sim.step(1);
    let faults: Vec<_> = sim.rejected.iter().map(|r| (r.entity, r.fault)).collect();
    assert_eq!(faults, [(body, BodyFault::Mass(1e-40))]);
}

#[test]
fn inertia_of_any_size_and_direction_is_valid() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let rod = |moment: f32| {
        let turn = Mat3::from_quat(Quat::from_xyzw(0.1, 0.7, 0.3, 0.6).normalize());
        [
            Mat3::from_diagonal(Vec3::splat(moment)),
            turn * Mat3::from_diagonal(moment * Vec3::new(1.5e-4, 1.0, 1.0)) * turn.transpose(),
            turn * Mat3::from_diagonal(moment * Vec3::new(1.0, 1.0, 1.5e-4)) * turn.transpose(),
        ]
    };
    for (i, moment) in [1e-20, 1e-13, 1.0, 2e19, 1e25].into_iter().enumerate() {
        for (j, inertia) in rod(moment).into_iter().enumerate() {
            let at = Vec3::new(3.0 * i as f32, 3.0 * j as f32, 0.0);
            sim.spawn((resting(&cube, at), AngularInertia(inertia)));
        }
    }
    sim.step(1);
    assert!(sim.rejected.is_empty(), "{:?}", sim.rejected);
    assert_eq!(sim.report().bodies, 15);
}
