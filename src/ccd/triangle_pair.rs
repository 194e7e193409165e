//! How long one pair of triangles stays apart, in double precision.

use super::distance::nearest;
use super::relative::Relative;
use glam::DVec3;

/// Less what rounding may add to a time.
const ROUNDED_DOWN: f64 = 1.0 - 1.0e-9;

/// At which distances triangles are taken to be near, metres.
#[derive(Clone, Copy)]
pub struct Reach {
    /// To this distance they are brought,
    pub aim: f64,
    /// and from this one down they have arrived.
    pub arrived: f64,
}

/// For how long from `relative.time` on two triangles do not come nearer than `reach.aim`, in intervals; `None` if they have
/// arrived. The first triangle is about the first body's centre of mass, the second about the second's, both along the first's
/// axes.
pub fn stay(a: &[DVec3; 3], b: &[DVec3; 3], relative: &Relative, reach: Reach) -> Option<f64> {
    let placed = b.map(|corner| corner + relative.translation);
    let found = nearest(a, &placed);
    let n = found.direction;
    if found.distance <= reach.arrived {
        return None;
    }
    // The triangles lie on two sides of a slab across the direction. It is measured once more, because where rounding has
    // turned the direction a little, it is thinner than the distance.
    let lowest = placed.iter().map(|p| n.dot(*p)).fold(f64::INFINITY, f64::min);
    let highest = a.iter().map(|p| n.dot(*p)).fold(f64::NEG_INFINITY, f64::max);
    let gap = (lowest - highest).min(found.distance) - reach.aim;

    let [of_a, of_b] = [(a, relative.turns[0], n), (b, relative.turns[1], -n)]
        .map(|(triangle, turn, direction)| Turning::new(triangle, turn, direction));
    let approach = relative.velocity.dot(n);
    let time = part(gap, approach + of_a.fastest + of_b.fastest)
        .max(part(gap - of_a.farthest - of_b.farthest, approach))
        .max(accelerated(
            gap,
            approach + of_a.speed + of_b.speed,
            of_a.acceleration + of_b.acceleration,
        ));
    // Where rounding leaves no way to go, they are as near as can be told.
    (time > 0.0).then_some(time * ROUNDED_DOWN)
}

/// What a turn about the centre of mass does to a triangle along a direction, at most for any of its points. All are greatest
/// at a corner, as points between corners stay between them.
struct Turning {
    /// Speed now,
    speed: f64,
    /// how fast that grows,
    acceleration: f64,
    /// speed at any time,
    fastest: f64,
    /// and way over any time.
    farthest: f64,
}

impl Turning {
    fn new(triangle: &[DVec3; 3], turn: DVec3, direction: DVec3) -> Self {
        let rate = turn.length();
        let axis = turn / rate.max(f64::MIN_POSITIVE);
        // The part of the direction across the axis; along it nothing moves.
        let across = direction - axis * axis.dot(direction);
        let tilt = across.length();
        let arms = triangle.map(|corner| corner - axis * axis.dot(corner));
        let longest = arms.iter().map(|arm| arm.length()).fold(0.0, f64::max);
        let way = |arm: &DVec3| tilt * arm.length() - across.dot(*arm);
        let fastest = rate * tilt * longest;
        let speed = |corner: &DVec3| direction.dot(turn.cross(*corner));
        Self {
            speed: triangle.iter().map(speed).fold(f64::NEG_INFINITY, f64::max),
            acceleration: rate * fastest,
            fastest,
            farthest: if rate > 0.0 {
                arms.iter().map(way).fold(0.0, f64::max)
            } else {
                0.0
            },
        }
    }
}

/// How long a gap lasts that closes at a speed; for ever if it does not close.
fn part(gap: f64, speed: f64) -> f64 {
    if speed > 0.0 {
        gap / speed
    } else if gap > 0.0 {
        f64::INFINITY
    } else {
        0.0
    }
}

/// The same if the speed grows: the first root of `acceleration t^2 / 2 + speed t - gap`, without cancellation.
fn accelerated(gap: f64, speed: f64, acceleration: f64) -> f64 {
    if gap <= 0.0 {
        return 0.0;
    }
    part(2.0 * gap, speed + (speed * speed + 2.0 * acceleration * gap).sqrt())
}
