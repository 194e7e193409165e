//! The time of impact of two moving bodies, and where they first touch.

use super::search::{Outcome, Scratch, Search, SweptMesh};
use super::triangle_pair::TargetDistance;
use super::{Sweep, spheres};
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Contact};
use glam::DVec3;

/// Tolerance of the target distance, as a fraction of it.
const TOLERANCE: f64 = 0.125;

/// The tolerance is at least this fraction of the smaller body's radius, even if the target distance is 0.
const MIN_TOLERANCE: f64 = 1.0e-6;

/// The time, 0 to 1, at which two moving bodies of `bodies` first come nearer to each other than `target_distance`
/// metres; `None` if they do not. Their own poses are ignored: `sweeps` have their poses and motion. `pair` names two
/// colliders; `sweeps` are those of their bodies.
///
/// * The time is never late: before it no two points of the two surfaces are nearer than `target_distance`, up to
///   rounding.
/// * At that time some points are nearer than 5/4 of `target_distance`, or than `target_distance` plus two millionths
///   of the smaller body's radius if that is more. So bodies that pass each other within that distance may be stopped,
///   too.
/// * If they are nearer than that at the start the result is `None`, even if other parts of the same meshes meet later.
///   Contacts must keep such bodies apart, so contacts need a margin of at least 5/4 of `target_distance`.
/// * The time is rounded down to single precision: by at most 0.06 mm on a path of a kilometre.
/// * A search that takes too long returns the time it has reached, which is early and may be 0. That needs thousands of
///   rotations in one collision substep, or thousands of pairs of triangles that stay just outside the target distance
///   for long.
///
/// A body inside another counts as separate if their surfaces are: it is stopped at the wall from inside. A negative
/// `target_distance` counts as 0. Numbers that do not name two bodies, and sweeps with numbers that are not finite,
/// give `None`.
pub fn time_of_impact(
    bodies: &Bodies,
    meshes: &MeshArena,
    pair: [u32; 2],
    sweeps: [&Sweep; 2],
    target_distance: f32,
    scratch: &mut Scratch,
) -> Option<f32> {
    match advance(bodies, meshes, pair, sweeps, target_distance, scratch) {
        Outcome::Hit(hit) => Some(rounded_down(hit.time)),
        Outcome::InitiallyClose | Outcome::Apart => None,
    }
}

/// Where two moving bodies first touch, with the unit vector from the first to the second. `None` if they do not touch,
/// if they touch at the start, or if the search takes too long. For the rest see [`time_of_impact`].
pub fn first_touch(
    bodies: &Bodies,
    meshes: &MeshArena,
    pair: [u32; 2],
    sweeps: [&Sweep; 2],
    scratch: &mut Scratch,
) -> Option<Contact> {
    let search = search(bodies, meshes, pair, sweeps, 0.0)?;
    let Outcome::Hit(hit) = search.run(scratch) else {
        return None;
    };
    let [point, normal] = search.contact(&hit)?;
    let [a, b] = sweeps.map(|sweep| sweep.at(hit.time).center);
    Some(Contact {
        point: point.as_vec3(),
        normal: normal
            .try_normalize()
            .unwrap_or_else(|| (b - a).normalize_or(DVec3::X))
            .as_vec3(),
    })
}

/// [`time_of_impact`], with the distinction whether the bodies are close at the start.
pub(super) fn advance(
    bodies: &Bodies,
    meshes: &MeshArena,
    pair: [u32; 2],
    sweeps: [&Sweep; 2],
    target_distance: f32,
    scratch: &mut Scratch,
) -> Outcome {
    search(bodies, meshes, pair, sweeps, target_distance).map_or(Outcome::Apart, |search| search.run(scratch))
}

/// Sets up the search; `None` if the bounding spheres never meet.
pub(super) fn search<'a>(
    bodies: &Bodies,
    meshes: &'a MeshArena,
    pair: [u32; 2],
    sweeps: [&'a Sweep; 2],
    target_distance: f32,
) -> Option<Search<'a>> {
    let [a, b] = pair.map(|i| i as usize);
    let valid = a != b && a.max(b) < bodies.len() && sweeps.iter().all(|sweep| sweep.is_valid());
    if !valid || target_distance.is_nan() {
        return None;
    }
    let offset = |i: u32| {
        bodies
            .part(i)
            .map_or(DVec3::ZERO, |part| part.pose.rotation.inverse() * part.offset)
    };
    let offsets = pair.map(offset);
    let radii = [(a, offsets[0]), (b, offsets[1])].map(|(i, offset)| f64::from(bodies.radius[i]) + offset.length());
    let target_distance = f64::from(target_distance.clamp(0.0, f32::MAX));
    let tolerance = (TOLERANCE * target_distance).max(MIN_TOLERANCE * radii[0].min(radii[1]));
    let roundings = [a, b].map(|i| f64::from(bodies.rounding[i]));
    let rounding = roundings[0] + roundings[1];
    let target = TargetDistance {
        aim: rounding + target_distance + 0.5 * tolerance,
        reached: rounding + target_distance + tolerance,
    };
    let span = spheres::overlap(sweeps, radii[0] + radii[1] + target.reached)?;
    let swept = |number: usize, i: usize| {
        Some(SweptMesh {
            mesh: &meshes.get(bodies.mesh[i])?.mesh,
            sweep: bodies
                .part(i as u32)
                .map_or(*sweeps[number], |part| sweeps[number].turned(part.pose.rotation)),
            scale: bodies.scale[i],
            offset: offsets[number],
            radius: radii[number],
            rounding: roundings[number],
        })
    };
    let surface_speed = |side: usize| sweeps[side].turn.length() * radii[side];
    Some(Search {
        meshes: [swept(0, a)?, swept(1, b)?],
        target,
        span,
        speed: (sweeps[0].travel - sweeps[1].travel).length() + surface_speed(0) + surface_speed(1),
    })
}

/// `time` rounded down to single precision.
pub(super) fn rounded_down(time: f64) -> f32 {
    let near = time as f32;
    if f64::from(near) > time { near.next_down() } else { near }
}
