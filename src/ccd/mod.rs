//! Continuous collision: when bodies that move far in one interval come near each other first, so that what is fast does not
//! pass what is thin.
//!
//! [`time_of_impact`] answers that for one pair, triangle by triangle: a bullet flies through the hole of a ring. [`clamp`] does
//! for all bodies that ask for it, and tells where they end up. [`first_touch`] tells where a pair touches on its way: what passes a
//! sensor.
//!
//! The method is conservative advancement (Mirtich 1996): two bodies at a distance stay apart for as long as the distance
//! divided by the speed at which their points can come nearer. As in Zhang, Lee and Kim (2006) the speed is that along the
//! direction in which they are apart, and as in Tang, Kim and Manocha, "C2A: Controlled conservative advancement for continuous
//! collision detection of polygonal models" (2009), parts of the bodies have bounds of their own. Here each pair of nodes has
//! even its own clock; see `search`.
//!
//! | file | holds |
//! |---|---|
//! | `sweep` | how a body moves |
//! | `clamp` | all pairs at once |
//! | `passes` | what passes through sensors |
//! | `search` | the order in which pairs of nodes and of triangles are looked at |
//! | `spheres` | when bounding spheres overlap |
//! | `relative` | how two bodies lie and move relative to each other at one time |
//! | `nodes` | how long boxes stay apart |
//! | `triangles` | how long triangles stay apart, in single precision |
//! | `approach` | the same in double precision |
//! | `distance` | how far triangles are apart |

mod approach;
mod clamp;
mod distance;
mod nodes;
mod passes;
mod relative;
mod search;
mod spheres;
pub(crate) mod stops;
mod sweep;
mod triangles;

pub use clamp::{ClampScratch, Stop, clamp};
pub use passes::{PassScratch, passes};
pub use search::Scratch;
pub use sweep::{Pose, Sweep};

use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Contact};
use approach::Reach;
use glam::DVec3;
use search::{Meeting, Search, Side};

/// Bodies are stopped at up to this part of the slack more than it.
const TOLERANCE: f64 = 0.125;

/// The tolerance is at least this part of the smaller body's radius, for where there is no slack.
const LEAST_TOLERANCE: f64 = 1.0e-6;

/// When, 0 to 1, two moving bodies of `bodies` first come nearer than `slack` metres to each other; `None` if they do not. Their
/// own poses are ignored: `sweeps` say where they are and how they move.
///
/// * Never late: until the returned time no two points of the two surfaces are nearer than `slack`, to rounding.
/// * At that time some are nearer than 5/4 of `slack`, or than `slack` and two millionths of the smaller body's radius if that is
///   more. So bodies that pass each other at up to that distance may be stopped, too.
/// * If they are nearer than that at the start, the answer is `None`: contact points must then keep them apart, so contacts
///   need a margin of at least 5/4 of `slack`. It is `None` even if other parts of the same two meshes meet on the way.
/// * The time is rounded down to single precision: on a way of a kilometre by 0.06 mm at most.
/// * A search that takes too long gives the time it has got to, which is early, and may even be 0. That takes thousands of turns
///   in one interval, or thousands of pairs of triangles that are near each other, but not as near as the slack, for long.
///
/// A body inside another counts as apart if their surfaces are: it is stopped at the wall from within. A negative `slack` is none.
/// Numbers that name no two bodies, and sweeps with numbers that are not finite, give `None`.
pub fn time_of_impact(
    bodies: &Bodies,
    meshes: &MeshArena,
    pair: [u32; 2],
    sweeps: [&Sweep; 2],
    slack: f32,
    scratch: &mut Scratch,
) -> Option<f32> {
    match meeting(bodies, meshes, pair, sweeps, slack, scratch) {
        Meeting::At(encounter) => Some(rounded_down(encounter.time)),
        Meeting::Already | Meeting::Never => None,
    }
}

/// Where two moving bodies first touch, and the unit vector from the first to the second there; `None` if they do not, if they
/// touch from the start, and if the search takes too long to tell. For what else see [`time_of_impact`].
pub fn first_touch(
    bodies: &Bodies,
    meshes: &MeshArena,
    pair: [u32; 2],
    sweeps: [&Sweep; 2],
    scratch: &mut Scratch,
) -> Option<Contact> {
    let search = search(bodies, meshes, pair, sweeps, 0.0)?;
    let Meeting::At(encounter) = search.run(scratch) else {
        return None;
    };
    let [point, normal] = search.contact(&encounter)?;
    let [a, b] = sweeps.map(|sweep| sweep.at(encounter.time).center);
    Some(Contact {
        point: point.as_vec3(),
        normal: normal
            .try_normalize()
            .unwrap_or_else(|| (b - a).normalize_or(DVec3::X))
            .as_vec3(),
    })
}

/// The same as [`time_of_impact`], and whether they are near at the start.
fn meeting(
    bodies: &Bodies,
    meshes: &MeshArena,
    pair: [u32; 2],
    sweeps: [&Sweep; 2],
    slack: f32,
    scratch: &mut Scratch,
) -> Meeting {
    search(bodies, meshes, pair, sweeps, slack).map_or(Meeting::Never, |search| search.run(scratch))
}

/// What to look for; `None` if not even bounding spheres meet.
fn search<'a>(
    bodies: &Bodies,
    meshes: &'a MeshArena,
    pair: [u32; 2],
    sweeps: [&'a Sweep; 2],
    slack: f32,
) -> Option<Search<'a>> {
    let [a, b] = pair.map(|i| i as usize);
    let valid = a != b && a.max(b) < bodies.len() && sweeps.iter().all(|sweep| sweep.is_valid());
    if !valid || slack.is_nan() {
        return None;
    }
    let radii = [a, b].map(|i| f64::from(bodies.radius[i]));
    let slack = f64::from(slack.clamp(0.0, f32::MAX));
    let tolerance = (TOLERANCE * slack).max(LEAST_TOLERANCE * radii[0].min(radii[1]));
    let reach = Reach {
        aim: slack + 0.5 * tolerance,
        arrived: slack + tolerance,
    };
    let span = spheres::overlap(sweeps, radii[0] + radii[1] + reach.arrived)?;
    let side = |end: usize, i: usize| {
        Some(Side {
            slot: meshes.get(bodies.mesh[i])?,
            sweep: sweeps[end],
            scale: bodies.scale[i],
            radius: radii[end],
        })
    };
    let turning = |end: usize| sweeps[end].turn.length() * radii[end];
    Some(Search {
        sides: [side(0, a)?, side(1, b)?],
        reach,
        span,
        speed: (sweeps[0].travel - sweeps[1].travel).length() + turning(0) + turning(1),
    })
}

/// In single precision, but no later.
fn rounded_down(time: f64) -> f32 {
    let near = time as f32;
    if f64::from(near) > time { near.next_down() } else { near }
}
