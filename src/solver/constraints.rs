//! Contact constraints: one per pair, with one point per contact point, in flat lists.

use super::bodies::SolverBodies;
use super::motion::BodyStates;
use super::prepare::Source;
use super::restitution;
use super::solve::{self, Pass};
use super::warm_start::WarmStart;
use crate::state::Manifolds;
use crate::types::solver_settings::SolverSettings;
use glam::{Vec3, Vec3A};

/// Largest number of pairs per task.
const GRAIN: usize = 128;

/// An impulse on a body.
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

/// The contact constraint of two bodies.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    pub bodies: [u32; 2],
    /// Its points: first number and count.
    pub first: u32,
    pub count: u32,
    pub friction: f32,
    pub restitution: f32,
    /// The gap that the contact keeps, metres.
    pub rest_offset: f32,
    /// No impulse moves either body: the pair is not solved, and its saved impulses persist.
    pub frozen: bool,
    /// Some point is active.
    pub active: bool,
    /// In deep penetration: pushed apart along one direction, by its first point, until nothing overlaps.
    pub depenetrating: bool,
    /// The direction that resolves a conflict between contact points, in world axes; zero for other pairs. See
    /// [`Overlap::Conflicting`](super::overlap::Overlap::Conflicting).
    pub separating_direction: Vec3,
}

/// One row of a point's constraint: the normal or a tangent, with the Jacobian along it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Unit vector. The normal points from the first body to the second and is constant once the point has an impulse.
    pub direction: Vec3A,
    /// The moment of a unit impulse about each centre of mass: `r x direction`.
    pub moments: [Vec3A; 2],
    /// The change of angular velocity by that moment.
    pub angular_responses: [Vec3A; 2],
}

/// A contact point of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// From each centre of mass to the point on the surface, at the start of the collision substep.
    pub anchors: [Vec3A; 2],
    /// From each centre of mass to the centre of curvature, at the start of the collision substep. For a flat surface
    /// it is the anchor.
    pub curvature_centers: [Vec3A; 2],
    /// Where impulses act, as a fraction of the way from the first anchor to the second.
    pub contact_fraction: f32,
    /// From the first anchor to the second, at the start of the collision substep.
    pub anchor_offset: Vec3A,
    /// The normal at the start of the collision substep.
    pub initial_normal: Vec3A,
    /// How fast the normal rotates as the surfaces slide, radians per metre.
    pub normal_rotation: f32,
    /// The normal and two tangents.
    pub rows: [Row; 3],
    /// For each body: change of velocity by a unit impulse along the normal, and along a tangent.
    pub inverse_effective_mass: [[f32; 2]; 2],
    /// Separation beyond the rest offset at the start of the collision substep.
    pub initial_separation: f32,
    /// Separation beyond the rest offset now.
    pub separation: f32,
    /// Impulses of this substep, along the normal and along the tangents.
    pub normal_impulse: f32,
    pub friction_impulse: [f32; 2],
    /// Additional impulses by restitution, along the normal and along the tangents.
    pub restitution_impulse: f32,
    pub restitution_friction_impulse: [f32; 2],
    /// The largest normal impulse of any pass so far.
    pub max_normal_impulse: f32,
    /// The sum of the normal impulses of all earlier substeps; `normal_impulse` is not included.
    pub total_normal_impulse: f32,
    /// The normal velocity just before the first normal impulse, negative if the bodies approached each other.
    pub impact_velocity: f32,
    /// Its numbers are valid, and it is part of the constraint.
    pub valid: bool,
    /// It is solved in this substep.
    pub active: bool,
}

/// All constraints of a collision substep.
#[derive(Clone, Debug, Default)]
pub(super) struct Constraints {
    pairs: Vec<Pair>,
    points: Vec<Point>,
    /// The impulses of each pair on its two bodies in the last pass.
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

    /// The total normal impulse of a point over the collision substep.
    pub fn impulse_of(&self, index: usize) -> f32 {
        self.points.get(index).map_or(0.0, |p| {
            p.total_normal_impulse + p.normal_impulse + p.restitution_impulse
        })
    }

    /// Whether a point has an impulse. Points of frozen pairs have the impulse of their last solved substep.
    pub fn pushes(&self, index: usize) -> bool {
        let point = self.points.get(index);
        point.is_some_and(|p| {
            p.normal_impulse > 0.0 || p.total_normal_impulse + p.normal_impulse + p.restitution_impulse > 0.0
        })
    }

    /// Makes a constraint for every manifold, and warm starts it.
    pub fn prepare(
        &mut self,
        bodies: &SolverBodies,
        states: &BodyStates,
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
            // Points keep their indices. A manifold whose range overlaps an earlier one or exceeds the list gets no
            // points.
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
            states,
            manifolds,
            warm,
            settings,
            impulse_scale: warm.impulse_scale(h),
            dt,
        };
        self.for_each(|pair, points, _| source.fill(pair, points));
    }

    pub fn begin_substep(&mut self, states: &BodyStates, pass: &Pass) {
        self.for_each(|pair, points, out| *out = solve::begin_substep(pair, points, states, pass));
    }

    pub fn solve(&mut self, states: &BodyStates, pass: &Pass) {
        self.for_each(|pair, points, out| *out = solve::solve(pair, points, states, pass));
    }

    pub fn update_points(&mut self, states: &BodyStates) {
        self.for_each(|pair, points, _| solve::update_points(pair, points, states));
    }

    /// Makes only the pairs active that need restitution, and returns whether there are any.
    pub fn begin_restitution(&mut self, threshold: f32) -> bool {
        self.for_each(|pair, points, _| restitution::begin_restitution(pair, points, threshold));
        self.pairs.iter().any(|pair| pair.active)
    }

    pub fn apply_restitution(&mut self, states: &BodyStates) {
        self.for_each(|pair, points, out| *out = restitution::apply_restitution(pair, points, states));
    }

    /// Calls `f` with every pair, its points and its impulses, in parallel.
    fn for_each(&mut self, f: impl Fn(&mut Pair, &mut [Point], &mut [Impulse; 2]) + Sync) {
        halve(&mut self.pairs, &mut self.points, 0, &mut self.impulses, &f);
    }
}

/// Splits the pairs in half until they are few enough for one task. `first` is the number of the first of `points`.
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
            angular_responses: [Vec3A::ZERO; 2],
        }
    }

    /// Rows along `normal` and two tangents. [`solve::update_points`] sets the rest.
    pub fn frame(normal: Vec3) -> [Self; 3] {
        let (t, u) = normal.any_orthonormal_pair();
        [normal, t, u].map(|d| Self::along(d.into()))
    }
}

impl Point {
    /// A point without effect.
    pub const NONE: Self = Self {
        anchors: [Vec3A::ZERO; 2],
        curvature_centers: [Vec3A::ZERO; 2],
        contact_fraction: 0.5,
        anchor_offset: Vec3A::ZERO,
        initial_normal: Vec3A::X,
        normal_rotation: 0.0,
        rows: [Row::along(Vec3A::X), Row::along(Vec3A::Y), Row::along(Vec3A::Z)],
        inverse_effective_mass: [[0.0; 2]; 2],
        initial_separation: 0.0,
        separation: 0.0,
        normal_impulse: 0.0,
        friction_impulse: [0.0; 2],
        restitution_impulse: 0.0,
        restitution_friction_impulse: [0.0; 2],
        max_normal_impulse: 0.0,
        total_normal_impulse: 0.0,
        impact_velocity: 0.0,
        valid: false,
        active: false,
    };

    /// Rotates the normal of curved surfaces that have not touched yet, as that of two balls that pass each other:
    /// their impulse acts along the normal at the moment of contact. `displacement` is how far the second centre of
    /// curvature has moved relative to the first.
    pub fn rotate_normal(&mut self, displacement: Vec3A) {
        if self.normal_rotation > 0.0 && self.max_normal_impulse == 0.0 && self.normal_impulse == 0.0 {
            let normal = self.initial_normal + self.normal_rotation * displacement;
            self.rows = Row::frame(normal.normalize_or(self.initial_normal).into());
        }
    }

    /// The separation beyond the rest offset after such a displacement.
    pub fn separation_after(&self, displacement: Vec3A) -> f32 {
        let along = self.initial_separation + self.normal().dot(displacement);
        if self.normal_rotation > 0.0 {
            // The distance between the centres of curvature is shorter along the rotated normal.
            along - 0.5 * self.normal().distance_squared(self.initial_normal) / self.normal_rotation
        } else {
            along
        }
    }

    /// Unit vector from the first body to the second.
    pub fn normal(&self) -> Vec3A {
        self.rows[0].direction
    }

    /// The friction impulse in world axes.
    pub fn friction_vector(&self) -> Vec3A {
        self.rows[1].direction * self.friction_impulse[0] + self.rows[2].direction * self.friction_impulse[1]
    }
}
