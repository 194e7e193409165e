//! The safe time of one pair of triangles, in double precision: for how long they certainly do not reach the target
//! distance.

use super::relative::Relative;
use crate::geometry::distance::nearest;
use glam::DVec3;

/// Factor that compensates the rounding of a time.
const ROUNDED_DOWN: f64 = 1.0 - 1.0e-9;

/// The distance of the cores at which two bodies are stopped, metres.
#[derive(Clone, Copy)]
pub struct TargetDistance {
    /// The advancement aims at this distance.
    pub aim: f64,
    /// At or below this distance, which is larger, the target counts as reached.
    pub reached: f64,
}

/// For how long after `relative.time` two triangles do not come nearer than `target.aim`, as a fraction of the
/// collision substep; `None` if they have reached the target. Corners are relative to the centres of mass of their own
/// bodies, along the first body's axes.
pub fn safe_time(a: &[DVec3; 3], b: &[DVec3; 3], relative: &Relative, target: TargetDistance) -> Option<f64> {
    let placed = b.map(|corner| corner + relative.translation);
    let found = nearest(a, &placed);
    let n = found.direction;
    if found.distance <= target.reached {
        return None;
    }
    // The triangles lie on both sides of a slab normal to the direction. Its thickness is computed anew: if rounding
    // has changed the direction a little, the slab is thinner than the distance.
    let lowest = placed.iter().map(|p| n.dot(*p)).fold(f64::INFINITY, f64::min);
    let highest = a.iter().map(|p| n.dot(*p)).fold(f64::NEG_INFINITY, f64::max);
    let gap = (lowest - highest).min(found.distance) - target.aim;

    let [bounds_a, bounds_b] = [(a, relative.turns[0], n), (b, relative.turns[1], -n)]
        .map(|(triangle, turn, direction)| RotationBounds::new(triangle, turn, direction));
    let approach = relative.velocity.dot(n);
    let time = closing_time(gap, approach + bounds_a.max_speed + bounds_b.max_speed)
        .max(closing_time(
            gap - bounds_a.max_distance - bounds_b.max_distance,
            approach,
        ))
        .max(accelerated_closing_time(
            gap,
            approach + bounds_a.initial_speed + bounds_b.initial_speed,
            bounds_a.max_acceleration + bounds_b.max_acceleration,
        ));
    // A time of 0 is due to rounding: the triangles are at the target, as far as can be computed.
    (time > 0.0).then_some(time * ROUNDED_DOWN)
}

/// Upper bounds for the motion of any point of a triangle along a direction, by a rotation about the centre of mass.
/// The bounds of the corners suffice: all other points lie between them.
struct RotationBounds {
    initial_speed: f64,
    max_acceleration: f64,
    /// At any time.
    max_speed: f64,
    /// Within any time.
    max_distance: f64,
}

impl RotationBounds {
    fn new(triangle: &[DVec3; 3], turn: DVec3, direction: DVec3) -> Self {
        let rate = turn.length();
        let axis = turn / rate.max(f64::MIN_POSITIVE);
        // The component of the direction normal to the axis. The rotation moves nothing along its axis.
        let normal_part = direction - axis * axis.dot(direction);
        let sine = normal_part.length();
        let offsets = triangle.map(|corner| corner - axis * axis.dot(corner));
        let radius = offsets.iter().map(|offset| offset.length()).fold(0.0, f64::max);
        let distance = |offset: &DVec3| sine * offset.length() - normal_part.dot(*offset);
        let max_speed = rate * sine * radius;
        let speed = |corner: &DVec3| direction.dot(turn.cross(*corner));
        Self {
            initial_speed: triangle.iter().map(speed).fold(f64::NEG_INFINITY, f64::max),
            max_acceleration: rate * max_speed,
            max_speed,
            max_distance: if rate > 0.0 {
                offsets.iter().map(distance).fold(0.0, f64::max)
            } else {
                0.0
            },
        }
    }
}

/// The time in which a gap closes at a constant speed; infinite if it does not close.
fn closing_time(gap: f64, speed: f64) -> f64 {
    if speed > 0.0 {
        gap / speed
    } else if gap > 0.0 {
        f64::INFINITY
    } else {
        0.0
    }
}

/// The time in which a gap closes at a constant acceleration: the first root of `acceleration t^2 / 2 + speed t - gap`,
/// without cancellation.
fn accelerated_closing_time(gap: f64, speed: f64, acceleration: f64) -> f64 {
    if gap <= 0.0 {
        return 0.0;
    }
    closing_time(2.0 * gap, speed + (speed * speed + 2.0 * acceleration * gap).sqrt())
}
