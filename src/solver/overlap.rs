//! Overlaps whose contact points disagree about the separating direction.

use super::warm_start::LastContact;
use crate::state::ManifoldPoint;
use crate::state::margins::SAFETY;
use crate::state::pairs::DEFAULT_DIRECTION;
use crate::types::solver_settings::SolverSettings;
use glam::Vec3;

/// Normals are opposed if the cosine of the angle between them is below this.
pub(super) const OPPOSED: f32 = -0.5;
/// Only points deeper than this fraction of D start a conflict.
pub(super) const CONFLICT_DEPTH: f32 = 0.01;
/// A conflict lasts until no point is deeper than this fraction of D.
pub(super) const RESOLVED_DEPTH: f32 = 0.0;
/// Vectors shorter than this fraction of D do not give a direction.
pub(super) const MIN_DIRECTION_LENGTH: f32 = 1.0e-4;

/// How a pair overlaps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Overlap {
    /// The contact points are reliable.
    Ordinary,
    /// The pair overlapped deeply at its first contact, and still does. It is pushed apart along this unit vector.
    Deep(Vec3),
    /// The bodies touched before they overlapped, and now have points with opposed normals. Only points whose normals
    /// agree with this unit vector count.
    Conflicting(Vec3),
}

/// Relative position and motion of the bodies of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativeMotion {
    /// From the first collider's centre of mass to the second's.
    pub center_offset: Vec3,
    /// How far the first centre moves relative to the second within the collision substep.
    pub approach: Vec3,
    /// Upper bound for how far the surfaces move meanwhile because the bodies rotate.
    pub angular_travel: f32,
    /// Whether impulses move each body.
    pub has_mass: [bool; 2],
}

/// Classifies a pair whose smaller body has the bounding diameter `diameter`.
///
/// If a pair overlaps deeply at its first contact, its bodies were placed there and the normals may be wrong. If their
/// motion explains the depth, it is an ordinary impact that came too late for a speculative contact, because a third
/// body deflected one of the two.
pub(super) fn classify(
    points: &[ManifoldPoint],
    last: Option<&LastContact>,
    diameter: f32,
    motion: &RelativeMotion,
    settings: &SolverSettings,
) -> Overlap {
    let &RelativeMotion {
        center_offset,
        approach,
        angular_travel,
        has_mass,
    } = motion;
    let deeper_than = |depth: f32| points.iter().any(|p| p.separation < -depth * diameter);
    if !deeper_than(0.0) {
        return Overlap::Ordinary;
    }
    let is_deep = match last {
        Some(last) => last.pair.depenetrating,
        None => {
            let explained =
                |p: &ManifoldPoint| -p.separation <= SAFETY * (approach.dot(p.normal).max(0.0) + angular_travel);
            let deep = |p: &&ManifoldPoint| p.separation < -settings.deep_penetration * diameter;
            points.iter().filter(deep).any(|p| !explained(p)) || has_opposed_normals(points, 0.0)
        }
    };
    if is_deep {
        return Overlap::Deep(depenetration_direction(points, diameter, center_offset, has_mass));
    }
    let Some(last) = last else {
        return Overlap::Ordinary;
    };
    let conflicting = if last.separating_direction() == Vec3::ZERO {
        has_opposed_normals(points, CONFLICT_DEPTH * diameter)
    } else {
        deeper_than(RESOLVED_DEPTH)
    };
    if !conflicting {
        return Overlap::Ordinary;
    }
    let candidates = [last.separating_direction(), last.normal_impulse(), center_offset];
    let direction = candidates.into_iter().find_map(Vec3::try_normalize);
    Overlap::Conflicting(direction.unwrap_or(DEFAULT_DIRECTION.as_vec3()))
}

/// Whether two points, both deeper than `depth`, have opposed normals.
fn has_opposed_normals(points: &[ManifoldPoint], depth: f32) -> bool {
    let deep = || points.iter().filter(move |p| p.separation < -depth);
    deep().any(|p| deep().any(|q| p.normal.dot(q.normal) < OPPOSED))
}

/// The line of centres. If one body has no mass it is the depth-weighted mean normal, because that body's centre says
/// little about where its surface is.
fn depenetration_direction(points: &[ManifoldPoint], diameter: f32, center_offset: Vec3, has_mass: [bool; 2]) -> Vec3 {
    let unit = |v: Vec3| (v.length() > MIN_DIRECTION_LENGTH * diameter).then(|| v.normalize_or_zero());
    let normals = || points.iter().map(|p| p.normal * (-p.separation).max(0.0)).sum();
    let mean = if has_mass == [true; 2] { None } else { unit(normals()) };
    mean.or_else(|| unit(center_offset))
        .filter(|v| v.is_normalized())
        .unwrap_or(DEFAULT_DIRECTION.as_vec3())
}
