//! What is made of overlaps whose contact points may disagree about the way out.

use super::warm_start::Kept;
use crate::state::ManifoldPoint;
use crate::state::margins::SAFETY;
use crate::types::solver_settings::SolverSettings;
use glam::Vec3;

/// Points are opposed if the cosine between their normals is below this.
pub(super) const OPPOSED: f32 = -0.5;
/// Points less deep than this part of D do not start a dispute.
pub(super) const DISPUTED_DEPTH: f32 = 0.01;
/// A dispute lasts until no point is deeper than this part of D.
pub(super) const SETTLED_DEPTH: f32 = 0.005;
/// The way out of a pair of bodies with a common centre: any, but always the same.
pub(super) const ANY_WAY: Vec3 = Vec3::new(0.36, 0.48, 0.8);
/// A way out that is shorter than this part of D has no direction.
pub(super) const LEAST_WAY: f32 = 1.0e-4;

/// How a pair overlaps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Overlap {
    /// Its points can be trusted.
    Usual,
    /// It overlapped deeply when it was first seen, and still overlaps: to be pushed apart along this unit vector.
    Tangled(Vec3),
    /// It came from outside and its points push both ways: only those count that agree with this vector.
    Disputed(Vec3),
}

/// How the bodies of a pair lie and move.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    /// From the first centre to the second.
    pub between: Vec3,
    /// How far the first centre comes towards the second within an interval.
    pub closing: Vec3,
    /// How far surfaces turn towards each other meanwhile, at most.
    pub swing: f32,
    /// Whether contacts push them.
    pub has_mass: [bool; 2],
}

/// Judges a pair whose smaller body has the bounding diameter `diameter`.
///
/// A pair that overlaps when it is first seen was put there, unless its motion explains the overlap: then it is an impact
/// that was not foreseen, because a third body turned one of the two, and is answered like any other.
pub(super) fn judge(
    points: &[ManifoldPoint],
    kept: Option<&Kept>,
    diameter: f32,
    ends: &Ends,
    settings: &SolverSettings,
) -> Overlap {
    let &Ends {
        between,
        closing,
        swing,
        has_mass,
    } = ends;
    let deeper_than = |depth: f32| points.iter().any(|p| p.separation < -depth * diameter);
    if !deeper_than(0.0) {
        return Overlap::Usual;
    }
    let tangled = match kept {
        Some(kept) => kept.pair.depenetrating,
        None => {
            let explained = |p: &ManifoldPoint| -p.separation <= SAFETY * (closing.dot(p.normal).max(0.0) + swing);
            let deep = |p: &&ManifoldPoint| p.separation < -settings.deep_penetration * diameter;
            points.iter().filter(deep).any(|p| !explained(p)) || opposed(points, 0.0)
        }
    };
    if tangled {
        return Overlap::Tangled(way_out(points, diameter, between, has_mass));
    }
    let Some(kept) = kept else {
        return Overlap::Usual;
    };
    let disputed = if kept.direction() == Vec3::ZERO {
        opposed(points, DISPUTED_DEPTH * diameter)
    } else {
        deeper_than(SETTLED_DEPTH)
    };
    if !disputed {
        return Overlap::Usual;
    }
    let sources = [kept.direction(), kept.push(), between];
    let direction = sources.into_iter().find_map(Vec3::try_normalize);
    Overlap::Disputed(direction.unwrap_or(ANY_WAY))
}

/// Whether two points, both deeper than `depth`, push against each other.
fn opposed(points: &[ManifoldPoint], depth: f32) -> bool {
    let deep = || points.iter().filter(move |p| p.separation < -depth);
    deep().any(|p| deep().any(|q| p.normal.dot(q.normal) < OPPOSED))
}

/// The line of centres; away from a body without mass the mean of normals, as its centre says little about its surface.
fn way_out(points: &[ManifoldPoint], diameter: f32, between: Vec3, has_mass: [bool; 2]) -> Vec3 {
    let unit = |v: Vec3| (v.length() > LEAST_WAY * diameter).then(|| v.normalize_or_zero());
    let normals = || points.iter().map(|p| p.normal * (-p.separation).max(0.0)).sum();
    let mean = if has_mass == [true; 2] { None } else { unit(normals()) };
    mean.or_else(|| unit(between))
        .filter(|v| v.is_normalized())
        .unwrap_or(ANY_WAY)
}
