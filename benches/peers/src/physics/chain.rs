//! A chain of rings that hangs from a static one.

use super::scene::{Body, RING_LINE, RING_TUBE, Scene, Shape};
use super::world::{Engine, Run, State};
use super::{Case, HZ, mean};
use bevy::math::{DVec3, Quat, Vec3};
use std::f32::consts::FRAC_PI_2;

const SECONDS: usize = 10;

/// `count` rings, at least two, each through the next.
pub fn case(count: usize) -> Case {
    let count = count.max(2);
    Case {
        name: format!("chain of {count} rings, {SECONDS} s"),
        quantity: "links that open; error of the length, mean over the last s",
        steps: SECONDS * HZ,
        other: Some(Engine::Parts),
        scenes: Box::new(move |_| vec![chain(count)]),
        judge: Box::new(judge),
    }
}

fn chain(count: usize) -> Scene {
    let mut scene = Scene::new(true);
    for i in 0..count {
        let turn = Quat::from_rotation_y(if i % 2 == 0 { 0.0 } else { FRAC_PI_2 });
        // 2 cm short of where they hang.
        let at = Vec3::NEG_Y * (0.74 * i as f32);
        scene.add(Body::new(Shape::Ring, at, turn)).fixed = i == 0;
    }
    scene
}

fn judge(runs: &[Run]) -> String {
    let run = &runs[0];
    let links = run.scene.bodies.len() - 1;
    let mut first_open = vec![None; links];
    for (step, states) in run.states.iter().enumerate() {
        for (first_open, pair) in first_open.iter_mut().zip(states.windows(2)) {
            if first_open.is_none() && linking(&pair[0], &pair[1]) == 0 {
                *first_open = Some(step);
            }
        }
    }
    let open = first_open.iter().flatten().count();
    if let Some(first) = first_open.into_iter().flatten().min() {
        return format!(
            "**{open} of {links}, the first after {:.2} s**",
            first as f64 / HZ as f64
        );
    }
    // Two tubes lie on each other inside both rings.
    let wanted = links as f64 * 2.0 * (RING_LINE - RING_TUBE);
    let last = run.states.iter().rev().take(HZ);
    let length = mean(last.map(|states| states[0].center.distance(states[links].center)));
    format!("none; {:+.2} %", 100.0 * (length / wanted - 1.0))
}

/// The linking number of two rings' centre lines: how often the second goes through the disc of the first, less how often
/// it comes back.
fn linking(a: &State, b: &State) -> i32 {
    let (normal, from) = (a.rotation * DVec3::Z, a.center);
    // Heights of the second line's points over the disc's plane: mean + x cos(t) + y sin(t).
    let mean = normal.dot(b.center - from);
    let [x, y] = [DVec3::X, DVec3::Y].map(|axis| RING_LINE * normal.dot(b.rotation * axis));
    let swing = x.hypot(y);
    if mean.abs() >= swing {
        return 0;
    }
    let (middle, half) = (y.atan2(x), (-mean / swing).acos());
    let passes = |t: f64| {
        let point = b.center + b.rotation * (RING_LINE * DVec3::new(t.cos(), t.sin(), 0.0));
        i32::from(point.distance(from) < RING_LINE)
    };
    // Above the plane between the two, below it elsewhere.
    passes(middle - half) - passes(middle + half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_linking_number_tells_links_from_neighbours() {
        let place = |i: usize, y: f64| State {
            center: DVec3::Y * y,
            rotation: chain(3).bodies[i].rotation.as_dquat(),
            velocity: DVec3::ZERO,
            spin: DVec3::ZERO,
        };
        assert_eq!(linking(&place(0, 0.0), &place(1, -0.74)).abs(), 1);
        assert_eq!(linking(&place(0, 0.0), &place(2, -1.48)), 0);
        assert_eq!(linking(&place(0, 0.0), &place(1, -0.89)), 0, "just out of it");
    }
}
