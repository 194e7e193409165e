//! Apps with contacts on a GPU: what `tests/plugin` asks of those on the CPU, and what is read later.

#[path = "../../plugin/bakes.rs"]
mod bakes;
#[path = "../../plugin/contacts.rs"]
#[allow(dead_code)]
mod contacts;
#[path = "../../plugin/driven.rs"]
#[allow(dead_code)]
mod driven;
#[path = "../../plugin/hooks.rs"]
#[allow(dead_code)]
mod hooks;
#[path = "../../plugin/sensors.rs"]
#[allow(dead_code)]
mod sensors;

use crate::app::{ON_GPU, STEP, Sim, resting};
use crate::gpu::Test;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::plugin::settings::LATENCY;
use bevy_faceoff::prelude::*;

/// Apps run on a GPU for as long as this lives.
struct OnGpu;

impl OnGpu {
    fn new() -> Self {
        ON_GPU.set(true);
        Self
    }
}

impl Drop for OnGpu {
    fn drop(&mut self) {
        ON_GPU.set(false);
    }
}

macro_rules! tests {
    ($($name:ident: $work:expr;)*) => {
        [$((stringify!($name), (|_| {
            let _on_gpu = OnGpu::new();
            $work
        }) as fn(&Gpu))),*]
    };
}

pub const TESTS: &[Test] = &tests! {
    what_lies_still_falls_asleep: contacts::what_lies_still_falls_asleep_and_does_not_move_at_all();
    a_sleeper_wakes_when_the_mesh_under_it_goes: contacts::a_sleeper_wakes_when_the_mesh_under_it_goes();
    who_may_not_sleep_does_not: contacts::who_may_not_sleep_does_not();
    collisions_hold_points_and_the_weight_on_them: contacts::collisions_hold_points_and_the_weight_on_them();
    every_corner_carries_a_quarter_of_the_weight:
        contacts::every_corner_carries_a_quarter_of_the_weight_on_meshes_and_planes();
    points_of_several_intervals_add_up: contacts::points_of_a_step_in_several_intervals_add_up_to_the_whole_impulse();
    without_response_points_lie_where_the_surfaces_are:
        contacts::without_response_points_lie_where_the_surfaces_are();
    a_body_tells_its_centre_of_mass: contacts::a_body_tells_its_centre_of_mass();
    without_response_there_are_points_too: contacts::without_response_there_are_points_too();
    damping_limits_and_locks_hold: contacts::damping_limits_and_locks_hold();
    forces_go_on_and_impulses_act_once: contacts::forces_go_on_and_impulses_act_once();
    a_platform_that_moves_carries: contacts::a_platform_that_moves_carries_what_stands_on_it();
    a_bullet_is_stopped_on_the_cpu: contacts::a_bullet_flagged_so_does_not_pass_a_sheet();
    a_snapshot_of_a_pile_goes_on_to_the_bit: contacts::a_snapshot_of_a_pile_goes_on_to_the_bit();
    a_ball_dropped_in_a_room_rests_on_its_floor: bakes::a_ball_dropped_in_a_room_rests_on_its_floor();
    the_walls_of_a_room_push_inward: bakes::the_walls_of_a_room_push_inward();
    the_same_mesh_as_a_solid_is_the_outward_one: bakes::the_same_mesh_as_a_solid_is_the_outward_one();
    no_ray_slips_through_a_seam: bakes::no_ray_slips_through_a_seam();
    a_lift_moved_by_its_transform_carries: driven::a_lift_moved_by_its_transform_carries_what_stands_on_it();
    a_door_turned_by_its_transform_sweeps: driven::a_door_turned_by_its_transform_sweeps_a_ball_away();
    a_slab_that_teleports_pushes_nothing: driven::a_slab_that_teleports_pushes_nothing_and_one_that_is_moved_does();
    a_tray_of_several_colliders_is_moved: driven::a_body_of_several_colliders_is_moved_by_its_transform_too();
    what_is_put_elsewhere_ends_its_collisions:
        driven::a_dynamic_body_that_is_put_elsewhere_ends_its_collisions_at_once();
    a_belt_carries_beside_a_gpu: hooks::a_belt_carries_a_crate_at_its_speed();
    a_sleeper_wakes_when_the_filter_changes: hooks::a_sleeper_wakes_when_the_filter_changes_its_mind();
    planes_obey_layers: contacts::planes_obey_layers();
    a_lift_carries_whenever_results_come: lifts();
    steps_come_back_from_the_cpu: there_and_back();
    a_sensor_keeps_what_falls_asleep_in_it: sensors::a_sensor_keeps_what_falls_asleep_in_it();
    a_sensor_spawned_over_sleepers_reports_them: sensors::a_sensor_spawned_over_sleepers_reports_them_until_it_goes();
    a_dynamic_sensor_that_sleeps_reports: sensors::a_dynamic_sensor_that_falls_asleep_goes_on_reporting();
    who_sleeps_beside_a_wall_does_not_touch_it: sensors::who_falls_asleep_beside_a_wall_does_not_begin_to_touch_it();
    what_is_fast_is_noticed_by_a_sensor_on_the_cpu:
        sensors::what_is_fast_and_flagged_is_noticed_by_a_sensor_and_not_stopped();
    touches_that_come_and_go_are_told_once:
        sensors::touches_that_come_and_go_are_told_once_unless_they_are_to_be_exact();
    results_are_those_of_waiting_steps_two_steps_later: later();
    what_stays_on_the_gpu_comes_to_rest_there: resident();
    a_response_may_change_between_steps: responses();
};

/// A game raises a slab with a body on it by 1 m in a second, by writing its `Transform`.
fn lifts() {
    for readback in [Readback::Lockstep, Readback::Latent, Readback::Resident] {
        let (mut sim, bodies) = heap(readback);
        let slab = bodies[0];
        sim.set(slab, RigidBody::Kinematic);
        sim.step(32);
        for step in 0..64 {
            let mut transform = sim.get::<Transform>(slab);
            transform.translation.y += 1.0 / 64.0;
            *sim.world().get_mut::<Transform>(slab).unwrap() = transform;
            sim.step(1);
            assert_eq!(sim.get::<Transform>(slab), transform, "{readback:?}");
            if step == 48 {
                let moving = Snapshot::take(sim.world());
                let (_, rider) = moving.bodies().find(|&(entity, _)| entity == bodies[1]).unwrap();
                let speed = rider.linear_velocity.y;
                assert!((speed - 1.0).abs() < 0.02, "{readback:?}: {speed} m/s");
            }
        }
        sim.step(32);
        let end = Snapshot::take(sim.world());
        for (i, &body) in bodies.iter().enumerate() {
            let (_, motion) = end.bodies().find(|&(entity, _)| entity == body).unwrap();
            let height = motion.position.y - (1.52 + i as f32);
            assert!(height.abs() < 0.03, "{readback:?}: {i} at {height} m");
            assert!(motion.linear_velocity.length() < 0.02, "{readback:?}: {motion:?}");
        }
    }
}

/// A body of two colliders, with which steps run on the CPU, falls beside a heap at rest, and goes again. The heap does
/// not notice.
fn there_and_back() {
    for readback in [Readback::Lockstep, Readback::Latent] {
        let (mut sim, cubes) = heap(readback);
        sim.step(64);
        let before: Vec<_> = cubes.iter().map(|&cube| sim.position(cube)).collect();
        let cube = sim.mesh(&shapes::cube(1.0));
        let root = sim.spawn((RigidBody::Dynamic, Transform::from_xyz(8.0, 2.0, 0.0)));
        for x in [-1.0, 1.0] {
            sim.spawn((cube.clone(), Transform::from_xyz(x, 0.0, 0.0), ChildOf(root)));
        }
        sim.step(96);
        let landed = sim.position(root);
        assert!((landed.y - 0.5).abs() < 0.01, "{readback:?}: {landed}");
        sim.world().despawn(root);
        sim.step(64);
        for (&cube, &at) in cubes.iter().zip(&before) {
            let moved = (sim.position(cube) - at).length();
            assert!(moved < 0.01, "{readback:?}: moved {moved} m");
        }
    }
}

/// A heap of cubes over ground, one of them kinematic, and what is on its way after `readback`.
fn heap(readback: Readback) -> (Sim, Vec<Entity>) {
    let mut sim = Sim::with_step(StepPlugin {
        backend: Backend::Gpu,
        threads: 1,
        readback,
    });
    while sim.app.world().resource::<ActiveBackend>().name() == "opening" {
        std::thread::sleep(STEP);
        sim.step(1);
    }
    sim.world().insert_resource(Gravity(Vec3::NEG_Y * 10.0));
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let cube = sim.mesh(&shapes::cube(1.0));
    let bodies = (0..4)
        .map(|i| {
            let at = Vec3::new(0.2 * i as f32, 0.52 + 1.02 * i as f32, 0.0);
            sim.spawn((resting(&cube, at), ExternalForces::default()))
        })
        .collect();
    (sim, bodies)
}

type Seen = (Vec<(Transform, Vec3, Sleeping)>, String);

fn seen(sim: &Sim, bodies: &[Entity]) -> Seen {
    let of = |&body: &Entity| (sim.get(body), sim.velocity(body), sim.get(body));
    let collisions: Vec<_> = sim.collisions().iter().collect();
    let report = sim.report();
    let counts = (report.contact_points, report.sleeping, report.touching_pairs);
    (bodies.iter().map(of).collect(), format!("{collisions:?} {counts:?}"))
}

fn later() {
    let [mut waits, mut latent] = [Readback::Lockstep, Readback::Latent].map(heap);
    assert_eq!(waits.1, latent.1);
    let bodies = waits.1.clone();
    let mut history = Vec::new();
    let (mut slept, mut woken) = (0, 0);
    for step in 0..170 {
        for (sim, _) in [&mut waits, &mut latent] {
            if step == 150 {
                let impulse = Vec3::X * 0.4;
                sim.set(bodies[3], ExternalForces { impulse, ..default() });
            }
            sim.step(1);
            assert_eq!(sim.get::<ExternalForces>(bodies[3]).impulse, Vec3::ZERO, "given once");
        }
        history.push(seen(&waits.0, &bodies));
        if step >= LATENCY {
            assert!(seen(&latent.0, &bodies) == history[step - LATENCY], "step {step}");
        }
        let asleep = waits.0.report().sleeping;
        slept += usize::from(asleep == 4);
        woken += usize::from(step >= 150 && asleep == 0);
    }
    assert!(slept > 20 && woken > 10, "{slept} {woken}");
    // A user wakes one whose results still say that it sleeps.
    let (sim, bodies) = &mut latent;
    sim.step(100);
    assert_eq!(sim.report().sleeping, 4);
    sim.set(bodies[0], Sleeping(false));
    sim.step(LATENCY + 1);
    assert_eq!(sim.report().sleeping, 0);
    assert!(!sim.get::<Sleeping>(bodies[3]).0);
}

fn resident() {
    let (mut sim, bodies) = heap(Readback::Resident);
    let start = seen(&sim, &bodies).0;
    sim.step(200);
    assert_eq!(seen(&sim, &bodies).0, start, "components stay");
    let report = sim.report();
    assert!(report.contact_points >= 16 && report.touching_pairs >= 3, "{report:?}");
    let snapshot = Snapshot::take(sim.world());
    for (entity, motion) in snapshot.bodies() {
        let number = bodies.iter().position(|&body| body == entity).unwrap();
        let at = motion.position - Vec3::Y * (0.5 + 1.005 * number as f32);
        assert!(at.y.abs() < 0.03, "{number} lies at {}", motion.position);
        assert!(motion.linear_velocity.length() < 0.01);
    }
}

fn responses() {
    for readback in [Readback::Lockstep, Readback::Latent] {
        let (mut sim, bodies) = heap(readback);
        for (response, steps) in [
            (Response::Contacts, 60),
            (Response::Impulse, 2),
            (Response::Contacts, 60),
            (Response::None, 2),
            (Response::Contacts, 60),
        ] {
            sim.world().insert_resource(response);
            sim.step(steps);
        }
        sim.step(LATENCY);
        for (i, &body) in bodies.iter().enumerate() {
            let height = sim.position(body).y - (0.5 + 1.005 * i as f32);
            assert!(height.abs() < 0.03, "{readback:?}: {i} at {}", sim.position(body));
            assert!(sim.velocity(body).length() < 0.02);
        }
    }
}
