//! Apps with contacts on a GPU: what `tests/plugin` asks of those on the CPU, and what is read later.

#[path = "../../plugin/bakes.rs"]
mod bakes;
#[path = "../../plugin/compounds.rs"]
#[allow(dead_code)]
mod compounds;
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
#[path = "../../plugin/spatial_queries.rs"]
#[allow(dead_code)]
mod spatial_queries;
#[path = "../../plugin/stable_keys.rs"]
#[allow(dead_code)]
mod stable_keys;
#[path = "../../plugin/sudden.rs"]
mod sudden;

use crate::app::{ON_GPU, STEP, Sim, resting, sorted};
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
    a_bullet_that_is_fired_does_not_pass_a_plate: sudden::a_bullet_that_is_fired_does_not_pass_a_plate();
    a_push_counts_for_collision_substeps: sudden::a_push_counts_for_collision_substeps();
    a_flagged_kinematic_body_pushes: sudden::a_flagged_kinematic_body_pushes_what_is_in_its_way();
    an_impulse_into_a_sleeper_moves_it: sudden::an_impulse_into_a_sleeper_moves_it();
    a_sleeper_wakes_when_what_carries_it_is_replaced: sudden::a_sleeper_wakes_when_what_carries_it_is_replaced();
    a_sleeper_wakes_when_its_gravity_or_its_locks_change: sudden::a_sleeper_wakes_when_its_gravity_or_its_locks_change();
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
    a_bullet_is_stopped: contacts::a_bullet_flagged_so_does_not_pass_a_sheet();
    a_snapshot_of_a_pile_goes_on_to_the_bit: contacts::a_snapshot_of_a_pile_goes_on_to_the_bit();
    a_ball_dropped_in_a_room_rests_on_its_floor: bakes::a_ball_dropped_in_a_room_rests_on_its_floor();
    the_walls_of_a_room_push_inward: bakes::the_walls_of_a_room_push_inward();
    the_same_mesh_as_a_solid_is_the_outward_one: bakes::the_same_mesh_as_a_solid_is_the_outward_one();
    no_ray_slips_through_a_seam: bakes::no_ray_slips_through_a_seam();
    a_lift_moved_by_its_transform_carries: driven::a_lift_moved_by_its_transform_carries_what_stands_on_it();
    a_slab_that_is_moved_has_a_velocity: driven::a_slab_that_is_moved_has_a_velocity_and_goes_on_with_it();
    a_door_turned_by_its_transform_sweeps: driven::a_door_turned_by_its_transform_sweeps_a_ball_away();
    a_slab_that_teleports_pushes_nothing: driven::a_slab_that_teleports_pushes_nothing_and_one_that_is_moved_does();
    a_tray_of_several_colliders_is_moved: driven::a_body_of_several_colliders_is_moved_by_its_transform_too();
    parts_are_where_their_body_is: spatial_queries::parts_are_where_their_body_is();
    what_moved_is_seen_after_an_update: spatial_queries::what_moved_since_the_step_is_seen_after_an_update();
    what_is_put_elsewhere_ends_its_collisions:
        driven::a_dynamic_body_that_is_put_elsewhere_ends_its_collisions_at_once();
    a_belt_carries_beside_a_gpu: hooks::a_belt_carries_a_crate_at_its_speed();
    a_sleeper_wakes_when_the_filter_changes: hooks::a_sleeper_wakes_when_the_filter_changes_its_mind();
    planes_obey_layers: contacts::planes_obey_layers();
    worlds_with_the_same_keys_stay_equal:
        assert!(stable_keys::worlds_with_the_same_keys_stay_equal_for(80).0 > 20);
    a_lift_carries_whenever_results_come: lifts();
    a_hammer_of_two_children_flies_like_the_merged_mesh:
        compounds::a_hammer_of_two_children_flies_like_the_merged_mesh();
    it_falls_rests_sleeps_and_names_its_children: compounds::it_falls_rests_sleeps_and_names_its_children();
    events_reach_the_body_and_the_collider: compounds::events_reach_the_body_and_the_collider();
    a_scene_under_a_moved_turned_and_scaled_parent_is_one_body:
        compounds::a_scene_under_a_moved_turned_and_scaled_parent_is_one_body();
    a_dynamic_body_stays_in_place_while_its_parent_moves:
        compounds::a_dynamic_body_stays_in_place_while_its_parent_moves();
    static_and_kinematic_bodies_follow_their_parents: compounds::static_and_kinematic_bodies_follow_their_parents();
    what_lies_on_a_part_falls_when_the_part_goes: compounds::what_lies_on_a_part_falls_when_the_part_goes();
    a_part_moves_to_another_body: compounds::a_part_moves_to_another_body();
    a_child_that_is_added_or_enabled_takes_part_in_the_next_step:
        compounds::a_child_that_is_added_or_enabled_takes_part_in_the_next_step();
    parts_have_their_own_density_friction_and_layers: compounds::parts_have_their_own_density_friction_and_layers();
    a_sheared_part_has_a_mesh_of_its_own: compounds::a_sheared_part_has_a_mesh_of_its_own();
    a_snapshot_of_a_nested_hammer_repeats_to_the_bit: compounds::a_snapshot_of_a_nested_hammer_repeats_to_the_bit();
    a_body_without_colliders_of_its_own_waits_for_its_children:
        compounds::a_body_without_colliders_of_its_own_waits_for_its_children();
    steps_come_back_from_the_cpu: there_and_back();
    compounds_are_the_same_two_steps_later: compounds_later();
    the_parts_of_a_compound_change_in_flight: parts_change();
    a_compound_stays_on_the_gpu: resident_compound();
    a_plane_can_be_a_sensor: sensors::a_plane_can_be_a_sensor();
    a_sensor_keeps_what_falls_asleep_in_it: sensors::a_sensor_keeps_what_falls_asleep_in_it();
    a_sensor_spawned_over_sleepers_reports_them: sensors::a_sensor_spawned_over_sleepers_reports_them_until_it_goes();
    a_dynamic_sensor_that_sleeps_reports: sensors::a_dynamic_sensor_that_falls_asleep_goes_on_reporting();
    who_sleeps_beside_a_wall_does_not_touch_it: sensors::who_falls_asleep_beside_a_wall_does_not_begin_to_touch_it();
    what_is_fast_is_noticed_by_a_sensor:
        sensors::what_is_fast_and_flagged_is_noticed_by_a_sensor_and_not_stopped();
    a_bullet_is_noticed_up_to_where_it_is_stopped:
        sensors::a_bullet_that_is_stopped_is_noticed_up_to_there_and_no_farther();
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

/// A body of two colliders with hooks, with which steps run on the CPU, falls beside a heap at rest, and goes again.
/// The heap does not notice, nor does a body of two colliders that sleeps.
fn there_and_back() {
    for readback in [Readback::Lockstep, Readback::Latent] {
        let (mut sim, mut cubes) = heap(readback);
        sim.stays_on_gpu = false;
        let cube = sim.mesh(&shapes::cube(1.0));
        cubes.push(dumbbell(&mut sim, &cube, Vec3::new(-8.0, 0.502, 0.0)));
        sim.step(64);
        let before: Vec<_> = cubes.iter().map(|&cube| sim.position(cube)).collect();
        let root = sim.spawn((RigidBody::Dynamic, Transform::from_xyz(8.0, 2.0, 0.0)));
        for x in [-1.0, 1.0] {
            let hooks = ActiveCollisionHooks::FILTER_PAIRS;
            sim.spawn((cube.clone(), hooks, Transform::from_xyz(x, 0.0, 0.0), ChildOf(root)));
        }
        sim.step(96);
        assert!(sim.report().gpu.is_none(), "it ran on the CPU");
        let landed = sim.position(root);
        assert!((landed.y - 0.5).abs() < 0.01, "{readback:?}: {landed}");
        sim.world().despawn(root);
        sim.step(64);
        assert!(sim.report().gpu.is_some(), "it came back");
        for (&cube, &at) in cubes.iter().zip(&before) {
            let moved = (sim.position(cube) - at).length();
            assert!(moved < 0.01, "{readback:?}: moved {moved} m");
        }
    }
}

/// A body whose two colliders are children.
fn dumbbell(sim: &mut Sim, mesh: &MeshCollider, at: Vec3) -> Entity {
    let root = sim.spawn((RigidBody::Dynamic, Transform::from_translation(at)));
    for x in [-1.0, 1.0] {
        sim.spawn((mesh.clone(), Transform::from_xyz(x, 0.0, 0.0), ChildOf(root)));
    }
    root
}

/// A heap of cubes over ground, with a dumbbell on top and one beside that leans over.
fn heap_with_compounds(readback: Readback) -> (Sim, Vec<Entity>) {
    let (mut sim, mut bodies) = heap(readback);
    let cube = sim.mesh(&shapes::cube(1.0));
    bodies.push(dumbbell(&mut sim, &cube, Vec3::new(0.4, 4.8, 0.1)));
    let leaning = dumbbell(&mut sim, &cube, Vec3::new(5.0, 1.4, 0.0));
    sim.set(
        leaning,
        Transform::from_xyz(5.0, 1.4, 0.0).with_rotation(Quat::from_rotation_z(0.6)),
    );
    bodies.push(leaning);
    (sim, bodies)
}

/// Every start has had its end, but for the pairs that touch now.
fn assert_told(sim: &Sim) {
    let mut open: Vec<_> = sim.started.iter().map(|s| sorted(s.collider1, s.collider2)).collect();
    for end in &sim.ended {
        let pair = sorted(end.collider1, end.collider2);
        let at = open.iter().position(|&started| started == pair);
        open.remove(at.expect("an end without a start"));
    }
    for pair in sim.touching() {
        assert!(open.contains(&sorted(pair[0], pair[1])), "{pair:?} has no start");
    }
    assert!(
        open.iter()
            .flatten()
            .all(|&entity| sim.app.world().get_entity(entity).is_ok())
    );
}

fn compounds_later() {
    let [mut waits, mut latent] = [Readback::Lockstep, Readback::Latent].map(heap_with_compounds);
    assert_eq!(waits.1, latent.1);
    let bodies = waits.1.clone();
    let mut history = Vec::new();
    for step in 0..200 {
        for (sim, _) in [&mut waits, &mut latent] {
            // A push arrives on both sides in the same step.
            if step == 120 {
                let impulse = Vec3::new(0.4, 0.0, 2.0);
                sim.set(bodies[5], ExternalForces { impulse, ..default() });
            }
            sim.step(1);
        }
        history.push(seen(&waits.0, &bodies));
        if step >= LATENCY {
            assert!(seen(&latent.0, &bodies) == history[step - LATENCY], "step {step}");
        }
    }
    assert!(waits.0.velocity(bodies[5]).length() < 0.1);
    assert_told(&waits.0);
    assert_told(&latent.0);
}

/// Children come, go, move and change while results are on their way.
fn parts_change() {
    for readback in [Readback::Lockstep, Readback::Latent] {
        let (mut sim, bodies) = heap_with_compounds(readback);
        sim.step(150);
        let body = bodies[5];
        let at = sim.position(body);
        let cube = sim.mesh(&shapes::cube(1.0));
        let third = sim.spawn((cube.clone(), Transform::from_xyz(3.0, 0.0, 0.0), ChildOf(body)));
        sim.step(1 + LATENCY);
        assert!(
            sim.position(body).distance(at) < 0.05,
            "{readback:?}: {}",
            sim.position(body)
        );
        sim.step(60);
        assert!(
            sim.position(body).distance(at) < 0.2,
            "{readback:?}: {}",
            sim.position(body)
        );
        let lands = |sim: &Sim| {
            let count = sim.collisions().of(third).count();
            let report = sim.report();
            (count > 0, report.bodies)
        };
        assert_eq!(lands(&sim), (true, 6), "{readback:?}");
        sim.set(third, ColliderDisabled);
        sim.step(1 + LATENCY);
        assert_eq!(lands(&sim), (false, 6), "{readback:?}");
        sim.world().entity_mut(third).remove::<ColliderDisabled>();
        sim.step(20);
        let other = sim.mesh(&shapes::cube(1.0));
        sim.set(third, other);
        sim.step(20);
        assert_eq!(lands(&sim), (true, 6), "{readback:?}");
        // To another body, high above it.
        sim.set(third, (ChildOf(bodies[0]), Transform::from_xyz(0.0, 9.0, 0.0)));
        sim.step(1 + LATENCY);
        assert_eq!(lands(&sim), (false, 6), "{readback:?}");
        sim.world().despawn(third);
        sim.step(20);
        // Down to a single collider, which then stands for the whole body.
        let children: Vec<Entity> = sim.app.world().get::<Children>(body).unwrap().iter().collect();
        sim.world().despawn(children[0]);
        sim.set(body, LinearVelocity(Vec3::Z * 0.5));
        sim.step(1 + LATENCY);
        assert_eq!(sim.report().bodies, 6);
        sim.set(body, cube.clone());
        sim.step(1 + LATENCY);
        let before = sim.position(body);
        sim.world().despawn(children[1]);
        sim.step(1 + LATENCY);
        let moved = sim.position(body).distance(before);
        assert!(moved < 0.1, "{readback:?}: a jump of {moved} m");
        sim.world().despawn(body);
        sim.step(64);
        assert_eq!(sim.report().bodies, 5);
        assert_told(&sim);
    }
}

fn resident_compound() {
    let (mut sim, bodies) = heap_with_compounds(Readback::Resident);
    sim.step(200);
    let snapshot = Snapshot::take(sim.world());
    let of = |body: Entity| *snapshot.bodies().find(|(other, _)| *other == body).unwrap().1;
    let [low, high] = [bodies[5], bodies[0]].map(of);
    assert!((low.position.y - 0.5).abs() < 0.03, "{}", low.position);
    assert!(low.linear_velocity.length() < 0.05);
    assert!((high.position.y - 0.5).abs() < 0.03, "{}", high.position);
    let report = sim.report();
    assert_eq!(report.bodies, 6);
    assert!(report.sleeping <= 6 && report.contact_points >= 16, "{report:?}");
}

/// A heap of cubes over ground, one of them kinematic, and what is on its way after `readback`.
fn heap(readback: Readback) -> (Sim, Vec<Entity>) {
    let mut sim = Sim::with_step(StepPlugin {
        backend: Backend::Gpu,
        threads: 1,
        readback,
        ..default()
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
