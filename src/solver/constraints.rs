//! Contact points as the solver works on them: flat, and ready to be solved again and again.

use super::bodies::SolverBodies;
use super::motion::Movers;
use super::overlap::{self, Overlap};
use super::pairs::{self, Pass};
use super::warm_start::{Match, WarmStart};
use crate::state::{ManifoldPoint, Manifolds};
use crate::types::material::CombineRule;
use crate::types::solver_settings::SolverSettings;
use glam::{DVec3, Vec3, Vec3A};

/// Pairs per task, at most.
const GRAIN: usize = 128;

/// What a pair does to one of its bodies.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Impulse {
    pub linear: Vec3A,
    /// About the centre of mass.
    pub angular: Vec3A,
}

impl Impulse {
    pub fn new(linear: Vec3, angular: Vec3) -> Self {
        Self {
            linear: linear.into(),
            angular: angular.into(),
        }
    }
}

/// Two bodies and what holds for all their points.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    pub bodies: [u32; 2],
    /// Its points.
    pub first: u32,
    pub count: u32,
    pub friction: f32,
    pub restitution: f32,
    /// The gap that is kept, metres.
    pub rest_offset: f32,
    /// Neither end moves: left alone, impulses and all.
    pub frozen: bool,
    /// Some point pushes, or may, in this substep.
    pub active: bool,
    /// Pushed apart along the line of centres, at its first point, until nothing overlaps.
    pub depenetrating: bool,
    /// The way out of an overlap whose points disagree, in the world; zero for other pairs.
    pub direction: Vec3,
}

/// A direction in which a point pushes, and what a unit impulse along it does to the two bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// From the first body to the second; stays as it is once the point pushes.
    pub direction: Vec3A,
    /// Its moment about each centre of mass.
    pub moments: [Vec3A; 2],
    /// The angular velocity that the moment causes.
    pub turns: [Vec3A; 2],
}

/// A point of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// From the centres of mass to the points on the surfaces, at the start of the interval.
    pub anchors: [Vec3A; 2],
    /// From the centres of mass to the centres of curvature, at the start of the interval; to the points where it is flat.
    pub rounds: [Vec3A; 2],
    /// How far from the first body's point to the second's impulses act: on that of the sharper body.
    pub along: f32,
    /// From the first body's point to the second's, at the start of the interval.
    pub offset: Vec3A,
    /// The normal at the start of the interval, and how fast it turns as the surfaces slide, radians per metre.
    pub first_normal: Vec3A,
    pub turn: f32,
    /// What impulses do along the normal and the tangents.
    pub rows: [Row; 3],
    /// Change of velocity that a unit impulse causes at each end, along the normal and across it.
    pub give: [[f32; 2]; 2],
    /// Beyond the rest offset, at the start of the interval and now.
    pub first_separation: f32,
    pub separation: f32,
    /// Impulses of this substep, along the normal and the tangents.
    pub impulse: f32,
    pub friction: [f32; 2],
    /// Impulses that made it bounce.
    pub bounce: f32,
    pub bounce_friction: [f32; 2],
    /// The largest normal impulse.
    pub largest: f32,
    /// The sum of the normal impulses of the substeps so far, less what is in `impulse`.
    pub total: f32,
    /// How fast the bodies parted at the point just before it first pushed; negative if they met.
    pub impact: f32,
    /// Not left out.
    pub usable: bool,
    /// Pushes, or may, in this substep.
    pub active: bool,
}

/// All points of an interval.
#[derive(Clone, Debug, Default)]
pub(super) struct Constraints {
    pairs: Vec<Pair>,
    points: Vec<Point>,
    /// What each pair does to its ends in a pass.
    impulses: Vec<[Impulse; 2]>,
}

impl Constraints {
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    pub fn points(&self) -> &[Point] {
        &self.points
    }

    pub fn impulses(&self) -> &[[Impulse; 2]] {
        &self.impulses
    }

    pub fn impulse_of(&self, index: usize) -> f32 {
        self.points.get(index).map_or(0.0, |p| p.total + p.impulse + p.bounce)
    }

    /// Frozen ones hold the impulse that they had last.
    pub fn pushes(&self, index: usize) -> bool {
        let point = self.points.get(index);
        point.is_some_and(|p| p.impulse > 0.0 || p.total + p.impulse + p.bounce > 0.0)
    }

    /// Makes a constraint of every manifold, with last interval's impulses where they fit.
    pub fn prepare(
        &mut self,
        bodies: &SolverBodies,
        movers: &Movers,
        manifolds: &Manifolds,
        warm: &WarmStart,
        settings: &SolverSettings,
        h: f32,
        dt: f32,
    ) {
        self.pairs.clear();
        self.points.clear();
        self.impulses.clear();
        for manifold in &manifolds.pairs {
            // Points keep their numbers; a manifold that names others' or none has none.
            let range = manifold.first_point as u64..manifold.first_point as u64 + manifold.point_count as u64;
            let fits = range.start >= self.points.len() as u64 && range.end <= manifolds.points.len() as u64;
            if fits {
                self.points.resize(range.end as usize, Point::NONE);
            }
            self.pairs.push(Pair {
                bodies: manifold.bodies,
                first: if fits {
                    manifold.first_point
                } else {
                    self.points.len() as u32
                },
                count: if fits { manifold.point_count } else { 0 },
                ..Pair::default()
            });
        }
        self.impulses.resize(self.pairs.len(), [Impulse::default(); 2]);
        let source = Source {
            bodies,
            movers,
            manifolds,
            warm,
            settings,
            growth: warm.growth(h),
            dt,
        };
        self.for_each(|pair, points, _| source.fill(pair, points));
    }

    pub fn begin_substep(&mut self, movers: &Movers, pass: &Pass) {
        self.for_each(|pair, points, out| *out = pairs::begin_substep(pair, points, movers, pass));
    }

    pub fn solve(&mut self, movers: &Movers, pass: &Pass) {
        self.for_each(|pair, points, out| *out = pairs::solve(pair, points, movers, pass));
    }

    pub fn begin_relaxing(&mut self, movers: &Movers) {
        self.for_each(|pair, points, _| pairs::measure(pair, points, movers));
    }

    /// Makes the pairs active that bounce; whether any does.
    pub fn begin_bounce(&mut self, threshold: f32) -> bool {
        self.for_each(|pair, points, _| pairs::begin_bounce(pair, points, threshold));
        self.pairs.iter().any(|pair| pair.active)
    }

    pub fn bounce(&mut self, movers: &Movers) {
        self.for_each(|pair, points, out| *out = pairs::bounce(pair, points, movers));
    }

    /// Calls `f` with every pair, its points and what it writes, in parallel.
    fn for_each(&mut self, f: impl Fn(&mut Pair, &mut [Point], &mut [Impulse; 2]) + Sync) {
        halve(&mut self.pairs, &mut self.points, 0, &mut self.impulses, &f);
    }
}

/// Halves the work until it is small enough for one task. `points` starts at the point of number `first`.
fn halve<F: Fn(&mut Pair, &mut [Point], &mut [Impulse; 2]) + Sync>(
    pairs: &mut [Pair],
    points: &mut [Point],
    first: usize,
    impulses: &mut [[Impulse; 2]],
    f: &F,
) {
    if pairs.len() <= GRAIN {
        for (pair, out) in pairs.iter_mut().zip(impulses) {
            let start = pair.first as usize - first;
            let points = &mut points[start..start + pair.count as usize];
            f(pair, points, out);
        }
        return;
    }
    let middle = pairs.len() / 2;
    let split = pairs[middle].first as usize;
    let (pairs, more_pairs) = pairs.split_at_mut(middle);
    let (points, more_points) = points.split_at_mut(split - first);
    let (impulses, more_impulses) = impulses.split_at_mut(middle);
    rayon::join(
        || halve(pairs, points, first, impulses, f),
        || halve(more_pairs, more_points, split, more_impulses, f),
    );
}

impl Row {
    const fn along(direction: Vec3A) -> Self {
        Self {
            direction,
            moments: [Vec3A::ZERO; 2],
            turns: [Vec3A::ZERO; 2],
        }
    }
}

impl Point {
    /// One that does nothing.
    const NONE: Self = Self {
        anchors: [Vec3A::ZERO; 2],
        rounds: [Vec3A::ZERO; 2],
        along: 0.5,
        offset: Vec3A::ZERO,
        first_normal: Vec3A::X,
        turn: 0.0,
        rows: [Row::along(Vec3A::X), Row::along(Vec3A::Y), Row::along(Vec3A::Z)],
        give: [[0.0; 2]; 2],
        first_separation: 0.0,
        separation: 0.0,
        impulse: 0.0,
        friction: [0.0; 2],
        bounce: 0.0,
        bounce_friction: [0.0; 2],
        largest: 0.0,
        total: 0.0,
        impact: 0.0,
        usable: false,
        active: false,
    };

    fn new(manifold: &ManifoldPoint, between: DVec3, rest_offset: f32) -> Self {
        let sound = manifold.normal.is_normalized()
            && manifold.separation.is_finite()
            && manifold.normal_rotation.is_finite()
            && manifold.anchors.iter().all(|arm| arm.is_finite());
        if !sound {
            return Self::NONE;
        }
        let [a, b] = manifold.anchors;
        let out = [manifold.normal, -manifold.normal];
        let rounds = [0, 1].map(|end| {
            let (arm, roundness) = (manifold.anchors[end], manifold.curvature_radii[end]);
            // No farther than to beside the centre of mass: of a ball that is just where its centre is.
            let inside = arm.dot(out[end]).max(0.0);
            let deep = if roundness < f32::INFINITY {
                roundness.min(inside)
            } else {
                0.0
            };
            Vec3A::from(arm - deep * out[end])
        });
        Self {
            anchors: manifold.anchors.map(Vec3A::from),
            rounds,
            along: along(manifold.curvature_radii),
            offset: (between + b.as_dvec3() - a.as_dvec3()).as_vec3a(),
            first_normal: manifold.normal.into(),
            turn: manifold.normal_rotation,
            rows: rows(manifold.normal),
            first_separation: manifold.separation - rest_offset,
            usable: true,
            ..Self::NONE
        }
    }

    /// The one point of a pair that is being untangled: pushes the centres themselves apart.
    fn depenetrating(normal: Vec3, separation: f32) -> Self {
        Self {
            rows: rows(normal),
            first_separation: separation,
            usable: true,
            ..Self::NONE
        }
    }

    /// Turns the normal of round surfaces that have not touched yet as that of balls that pass each other: they push along
    /// that at the moment of touching. `offset` is how far the second one's centre of curvature has moved, seen from the
    /// first one's.
    pub fn turn_with(&mut self, offset: Vec3A) {
        if self.turn > 0.0 && self.largest == 0.0 && self.impulse == 0.0 {
            let way = self.first_normal + self.turn * offset;
            self.rows = rows(way.normalize_or(self.first_normal).into());
        }
    }

    /// How far apart the surfaces are, beyond the rest offset.
    pub fn separation_after(&self, offset: Vec3A) -> f32 {
        let along = self.first_separation + self.normal().dot(offset);
        if self.turn > 0.0 {
            // By how much the way between the centres of curvature is shorter along the new normal.
            along - 0.5 * self.normal().distance_squared(self.first_normal) / self.turn
        } else {
            along
        }
    }

    /// From the first body to the second.
    pub fn normal(&self) -> Vec3A {
        self.rows[0].direction
    }

    /// The friction impulse in the world.
    pub fn friction_vector(&self) -> Vec3A {
        self.rows[1].direction * self.friction[0] + self.rows[2].direction * self.friction[1]
    }
}

/// What constraints are made of.
struct Source<'a> {
    bodies: &'a SolverBodies,
    movers: &'a Movers,
    manifolds: &'a Manifolds,
    warm: &'a WarmStart,
    settings: &'a SolverSettings,
    /// Of impulses since the last interval.
    growth: f32,
    /// Length of the interval, seconds.
    dt: f32,
}

impl Source<'_> {
    fn fill(&self, pair: &mut Pair, points: &mut [Point]) {
        let [a, b] = pair.bodies.map(|i| i as usize);
        let (count, settings) = (self.bodies.len(), self.settings);
        pair.frozen = true;
        if a >= count || b >= count || a == b || points.is_empty() {
            return;
        }
        let ends = [&self.bodies.bodies[a], &self.bodies.bodies[b]];
        let motions = [&self.bodies.motions[a], &self.bodies.motions[b]];
        if !motions.iter().all(|m| m.is_finite()) || !ends.iter().all(|body| body.solid) {
            return;
        }
        let pushed = self.movers.has_mass(a) || self.movers.has_mass(b);
        pair.frozen = !pushed;
        let diameter = diameter(ends[0].radius, ends[1].radius);
        pair.rest_offset = settings.rest_offset * diameter;
        pair.friction = CombineRule::combine(ends.map(|e| e.friction_combine), ends.map(|e| e.friction));
        pair.restitution =
            CombineRule::combine(ends.map(|e| e.restitution_combine), ends.map(|e| e.restitution)).min(1.0);

        let between = motions[1].center - motions[0].center;
        let swing = [0, 1].map(|end| motions[end].angular_velocity.length() * ends[end].radius);
        let first = pair.first as usize;
        let manifold = &self.manifolds.points[first..first + points.len()];
        let kept = self.warm.find([self.bodies.keys[a], self.bodies.keys[b]]);
        let ends = overlap::Ends {
            between: between.as_vec3(),
            closing: (motions[0].linear_velocity - motions[1].linear_velocity) * self.dt,
            swing: (swing[0] + swing[1]) * self.dt,
            has_mass: [a, b].map(|i| self.movers.has_mass(i)),
        };
        let overlap = overlap::judge(manifold, kept.as_ref(), diameter, &ends, settings);
        pair.depenetrating = false;
        pair.direction = Vec3::ZERO;
        match overlap {
            Overlap::Tangled(normal) if pushed => {
                pair.depenetrating = true;
                points.fill(Point::NONE);
                let deepest = manifold.iter().map(|p| p.separation).fold(0.0, f32::min);
                points[0] = Point::depenetrating(normal, deepest - pair.rest_offset);
                return;
            }
            Overlap::Disputed(direction) => pair.direction = direction,
            _ => {}
        }
        let mut matcher = Match::new(
            kept.as_ref(),
            [a, b].map(|i| self.movers.rotation(i)),
            settings,
            diameter,
            self.growth,
        );
        for (point, manifold) in points.iter_mut().zip(manifold) {
            let left_out = manifold.separation < 0.0 && manifold.normal.dot(pair.direction) < 0.0;
            *point = if left_out {
                Point::NONE
            } else {
                Point::new(manifold, between, pair.rest_offset)
            };
            if point.usable
                && let Some((impulse, friction)) = matcher.take(manifold)
            {
                point.impulse = impulse;
                // Belongs to the last interval.
                point.total = -impulse;
                point.friction = [1, 2].map(|i| point.rows[i].direction.dot(friction.into()));
            }
        }
    }
}

/// A point's rows, whose moments are found when it is measured.
fn rows(normal: Vec3) -> [Row; 3] {
    let (t, u) = normal.any_orthonormal_pair();
    [normal, t, u].map(|d| Row::along(d.into()))
}

/// 0 if the first surface is the sharper by far, 1 if the second is.
fn along([a, b]: [f32; 2]) -> f32 {
    let share = a / (a + b);
    if share.is_finite() {
        share
    } else if a.is_infinite() && !b.is_infinite() {
        1.0
    } else if b.is_infinite() && !a.is_infinite() {
        0.0
    } else {
        0.5
    }
}

/// The smaller bounding diameter; 0 if neither is a positive, finite number.
fn diameter(a: f32, b: f32) -> f32 {
    let smaller = 2.0 * a.min(b);
    if smaller > 0.0 && smaller.is_finite() {
        smaller
    } else {
        0.0
    }
}
