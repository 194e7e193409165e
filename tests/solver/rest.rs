//! Bodies at rest: single boxes, stacks and piles.

use super::shapes::Shape;
use super::world::{World, check, check_below};
use glam::{DQuat, DVec3, Vec3};

/// The rest offset of unit cubes.
const GAP: f64 = 0.0005 * 1.7320508;

fn cube() -> Shape {
    Shape::Box(DVec3::splat(0.5))
}

pub fn a_box_stays_on_the_floor_for_a_minute() {
    let mut world = World::heavy();
    world.floor(0.0);
    let body = world.dynamic(cube(), 1.0, DVec3::Y * (0.5 + GAP));
    world.motion(body).rotation = DQuat::from_rotation_y(0.4);
    let start = *world.motion(body);
    world.seconds(60.0);
    let end = *world.motion(body);
    let aside = (end.center - start.center) * DVec3::new(1.0, 0.0, 1.0);
    check_below("moved aside, metres", aside.length(), 1.0e-3);
    check("height above rest, metres", end.center.y - start.center.y, 0.0, 0.01);
    check_below("turned, radians", end.rotation.angle_between(start.rotation), 1.0e-3);
    check_below("speed, m/s", end.linear_velocity.length() as f64, 1.0e-3);
}

pub fn a_box_far_from_the_origin_stays_too() {
    let mut world = World::heavy();
    world.floor(0.0);
    let at = DVec3::new(5.0e4, 0.0, -5.0e4);
    world.motion(0).center = at;
    let body = world.dynamic(cube(), 1.0, at + DVec3::Y * (0.5 + GAP));
    world.seconds(5.0);
    check_below(
        "moved, metres",
        world.center(body).distance(at + DVec3::Y * (0.5 + GAP)),
        2.0e-3,
    );
}

pub fn a_stack_of_ten_boxes_stands_for_half_a_minute() {
    let mut world = World::heavy();
    world.floor(0.0);
    let height = |i: usize| 0.5 + GAP + i as f64 * (1.0 + GAP);
    let boxes: Vec<usize> = (0..10)
        .map(|i| world.dynamic(cube(), 1.0, DVec3::Y * height(i)))
        .collect();
    world.seconds(30.0);
    let mut aside = 0.0f64;
    for &i in &boxes {
        let p = world.center(i);
        aside = aside.max(p.x.hypot(p.z));
    }
    let sunk = height(9) - world.center(boxes[9]).y;
    check("the top sank, metres", sunk, 0.0, 0.01);
    check_below("aside, metres", aside, 0.001);
    check_below("speed, m/s", world.velocity(boxes[9]).length() as f64, 5.0e-3);
    let tilt = world.motion(boxes[9]).rotation * DVec3::Y;
    check_below("tilt, radians", tilt.angle_between(DVec3::Y), 0.005);
    println!(
        "stack of 10: {:.1} us per step",
        world.time_solving.as_secs_f64() * 1.0e6 / 1920.0
    );
}

pub fn a_pyramid_stands() {
    let mut world = World::heavy();
    world.floor(0.0);
    let mut boxes = Vec::new();
    for row in 0..6 {
        for k in 0..6 - row {
            let x = (k as f64 - 0.5 * (5 - row) as f64) * 1.05;
            boxes.push(world.dynamic(cube(), 1.0, DVec3::new(x, 0.5 + GAP + row as f64 * (1.0 + GAP), 0.0)));
        }
    }
    let start: Vec<DVec3> = boxes.iter().map(|&i| world.center(i)).collect();
    world.seconds(10.0);
    let moved = boxes.iter().zip(&start).map(|(&i, s)| world.center(i).distance(*s));
    check_below("moved at most, metres", moved.fold(0.0, f64::max), 0.005);
}

pub fn a_heavy_box_rests_on_a_light_one() {
    for ratio in [10.0f32, 100.0] {
        let mut world = World::heavy();
        world.floor(0.0);
        let light = world.dynamic(cube(), 1.0, DVec3::Y * (0.5 + GAP));
        let heavy = world.dynamic(cube(), ratio, DVec3::Y * (1.5 + 2.0 * GAP));
        world.seconds(10.0);
        let start = DVec3::Y * (1.5 + 2.0 * GAP);
        check_below(
            &format!("1:{ratio}: the heavy one moved, metres"),
            world.center(heavy).distance(start),
            0.05,
        );
        check_below("speed, m/s", world.velocity(light).length() as f64, 0.01);
        // With the light box on top it must be easy.
        let mut world = World::heavy();
        world.floor(0.0);
        world.dynamic(cube(), ratio, DVec3::Y * (0.5 + GAP));
        let light = world.dynamic(cube(), 1.0, DVec3::Y * (1.5 + 2.0 * GAP));
        world.seconds(10.0);
        check_below(
            "the light one moved, metres",
            world.center(light).distance(start),
            0.005,
        );
    }
}

pub fn a_very_heavy_box_rests_on_five_light_ones() {
    let mut world = World::heavy();
    world.floor(0.0);
    let place = |number: usize| DVec3::Y * (0.5 + GAP + number as f64 * (1.0 + GAP));
    for number in 0..5 {
        world.dynamic(cube(), 1.0, place(number));
    }
    let heavy = world.dynamic(cube(), 1000.0, place(5));
    world.seconds(5.0);
    check_below("it moved, metres", world.center(heavy).distance(place(5)), 0.01);
    // On the GPU, which makes fewer passes, it sways a little.
    check_below("speed, m/s", world.velocity(heavy).length() as f64, 0.02);
}

pub fn a_dropped_stack_comes_to_rest() {
    let mut world = World::heavy();
    world.floor(0.0);
    let boxes: Vec<usize> = (0..5)
        .map(|i| {
            world.dynamic(
                cube(),
                1.0,
                DVec3::new(0.05 * (i % 2) as f64, 1.0 + 1.3 * i as f64, 0.0),
            )
        })
        .collect();
    world.seconds(10.0);
    for &i in &boxes {
        check_below("speed, m/s", world.velocity(i).length() as f64, 0.005);
    }
    check("the top", world.center(boxes[4]).y, 0.5 + GAP + 4.0 * (1.0 + GAP), 0.03);
    check_below("deepest overlap, metres", world.deepest() as f64, 0.002);
}

pub fn the_impulse_that_supports_a_box_is_its_weight() {
    let mut world = World::heavy();
    world.collision_substeps = Some(1);
    world.floor(0.0);
    world.dynamic(cube(), 3.0, DVec3::Y * (0.5 + GAP));
    world.seconds(2.0);
    let sum: f32 = world.solver.impulses(world.manifolds.points.len()).iter().sum();
    check("newton seconds per step", sum as f64, 3.0 * 9.81 / 64.0, 0.005);
    assert_eq!(world.velocity(0), Vec3::ZERO);
}

pub fn a_stack_stands_while_the_step_changes() {
    let mut world = World::heavy();
    world.floor(0.0);
    let height = |i: usize| 0.5 + GAP + i as f64 * (1.0 + GAP);
    for i in 0..6 {
        world.dynamic(cube(), 1.0, DVec3::Y * height(i));
    }
    world.seconds(1.0);
    let top = world.center(6);
    let mut off = 0.0f64;
    for i in 0..300 {
        world.dt = [1.0 / 64.0, 1.0 / 128.0, 1.0 / 60.0][i % 3];
        world.collision_substeps = Some([1, 2, 5][i / 10 % 3]);
        world.step(1);
        // Shorter substeps make stiffer contacts, so the stack stands higher.
        off = off.max(top.y - world.center(6).y);
    }
    check_below("the top sank, metres", off, 5.0e-5);
}
