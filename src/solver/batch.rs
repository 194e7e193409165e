//! Batches: up to eight pairs that are solved at once, each in a lane, and their points.
//!
//! The pairs of a batch have no body in common that impulses move. The data of pairs and points that passes need is
//! stored together, lane by lane; it is loaded when the collision substep begins and stored when it ends. A lane
//! without a pair, and a missing point of a pair, holds zeros and has no effect.

use super::colors::{BatchSize, LANES};
use super::contact::{Pair, Point};
use super::motion::Mass;
use crate::geometry::lanes::{Stored, StoredPoints};
use glam::{Vec3, Vec3A};

/// Pairs in lanes. Sets of lanes have one bit for each.
#[derive(Clone, Debug, Default)]
pub(super) struct Batch {
    /// Number of pairs: they have the first lanes.
    pub pairs: usize,
    /// The most points that one of them has; once they are loaded, the most valid points.
    pub points: usize,
    /// The sum of their points.
    pub all_points: usize,
    /// For each side, the numbers of the bodies within the bundle.
    pub slots: [[u32; LANES]; 2],
    /// For each side, lanes with a body that impulses move.
    pub movable: [u32; 2],
    /// The sum of the inverse masses of both sides along each world axis, 1/kg.
    pub inverse_mass: StoredPoints,
    /// Which part of it each side has.
    pub shares: [StoredPoints; 2],
    pub friction: Stored,
    pub restitution: Stored,
    /// See [`Pair::tangent_velocity`].
    pub tangent_velocity: StoredPoints,
    /// See [`Pair::rest_offset`].
    pub rest_offset: Stored,
    /// See [`Pair::diameter`].
    pub diameter: Stored,
    /// See [`Pair::mass_ratio`].
    pub mass_ratio: Stored,
    /// See [`Pair::softness`].
    pub softness: Stored,
    /// Lanes of pairs with another softness than 1.
    pub softened: u32,
    /// Lanes of pairs with a kinematic body that moves.
    pub driven: u32,
    /// Lanes of pairs in deep penetration.
    pub depenetrating: u32,
    /// Lanes of pairs that bounce.
    pub elastic: u32,
    /// Lanes of pairs that bounce off a body that impulses do not move.
    pub bounces_off: u32,
    /// Lanes with a point that is solved in this substep.
    pub active: u32,
}

/// A row of constraints: the normals or tangents of the points of several pairs, with the Jacobians along them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RowLanes {
    /// Unit vectors. The normal points from the first body to the second and is constant once the point has touched.
    pub direction: StoredPoints,
    /// The moments of unit impulses about each centre of mass: `r x direction`.
    pub moments: [StoredPoints; 2],
    /// The changes of angular velocity by these moments.
    pub angular_responses: [StoredPoints; 2],
}

/// What a pass aims at, and how far one impulse goes towards it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AimLanes {
    /// The normal velocity that is wanted, negated.
    pub bias: Stored,
    /// Change of the normal impulse by a unit of velocity error.
    pub normal_response: Stored,
    /// Fraction of the normal impulse that is subtracted.
    pub impulse_scale: Stored,
    /// Velocity of the surfaces along the tangents, in addition to the velocity of the bodies.
    pub surface_speed: [Stored; 2],
    /// Change of the friction impulse by a unit of sliding velocity.
    pub friction_response: Stored,
}

/// One point of each pair of a batch.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PointLanes {
    /// The normals and two tangents.
    pub rows: [RowLanes; 3],
    pub aim: AimLanes,
    /// Change of the relative velocity by a unit impulse along the normal, and along a tangent.
    pub inverse_effective_mass: [Stored; 2],
    /// Impulses of this substep, along the normal and along the tangents.
    pub normal_impulse: Stored,
    pub friction_impulse: [Stored; 2],
    /// The change of the three impulses in the last pass.
    pub change: [Stored; 3],
    /// The direction in which they are extrapolated.
    pub search: [Stored; 3],
    /// Separation beyond the rest offset now.
    pub separation: Stored,
    /// Relative velocity along the tangents by which the point drifts in a substep because its bodies rotate, and that
    /// of the surfaces.
    pub drift: [Stored; 2],
    /// Relative velocity of the surfaces along the tangents, in addition to the velocity of the bodies.
    pub surface_speed: [Stored; 2],
    /// The sum of the normal impulses of all earlier substeps; `normal_impulse` is not included.
    pub total_normal_impulse: Stored,
    /// The normal velocity before an impact, negative.
    pub impact_velocity: Stored,
    /// From each centre of mass to the point on the surface, at the start of the collision substep.
    pub anchors: [StoredPoints; 2],
    /// See [`Point::curvature_centers`].
    pub curvature_centers: [StoredPoints; 2],
    /// See [`Point::contact_fraction`].
    pub contact_fraction: Stored,
    /// From the first anchor to the second, at the start of the collision substep.
    pub anchor_offset: StoredPoints,
    /// The normal at the start of the collision substep.
    pub initial_normal: StoredPoints,
    /// See [`Point::normal_rotation`].
    pub normal_rotation: Stored,
    /// Separation beyond the rest offset at the start of the collision substep.
    pub initial_separation: Stored,
    /// See [`Point::friction_offset`].
    pub friction_offset: StoredPoints,
    /// Lanes whose numbers are valid.
    pub valid: u32,
    /// Lanes whose normal rotates as the surfaces slide.
    pub curved: u32,
    /// Lanes that are solved in this substep.
    pub active: u32,
    /// Lanes that had no impulse at the start of the substep, so an impulse now is an impact.
    pub may_impact: u32,
    /// Lanes that have an impact in this substep, with restitution.
    pub has_impact: u32,
    /// Lanes whose velocity after the impacts of this substep is at least the reversed one.
    pub rebounds: u32,
    /// Lanes that have had an impulse in this collision substep or at the end of the last one.
    pub touched: u32,
    /// Lanes that have had restitution in this collision substep: the bodies separate.
    pub bounced: u32,
}

impl Batch {
    /// A batch of this size, without pairs.
    pub fn new(size: BatchSize) -> Self {
        Self {
            pairs: size.pairs as usize,
            points: size.points as usize,
            all_points: size.all_points as usize,
            ..Self::default()
        }
    }

    /// Removes what was loaded.
    fn clear(&mut self) {
        *self = Self {
            pairs: self.pairs,
            points: 0,
            all_points: self.all_points,
            ..Self::default()
        };
    }

    fn load_pair(&mut self, lane: usize, pair: &Pair, masses: &[Mass]) {
        let masses = pair.slots.map(|slot| &masses[slot as usize]);
        let inverse_mass = masses[0].inverse_mass + masses[1].inverse_mass;
        put(&mut self.inverse_mass, lane, inverse_mass);
        for (side, mass) in masses.into_iter().enumerate() {
            self.slots[side][lane] = pair.slots[side];
            // Along an axis that is locked for both, impulses move neither.
            let share = mass.inverse_mass / inverse_mass;
            put(
                &mut self.shares[side],
                lane,
                Vec3A::select(inverse_mass.cmpgt(Vec3A::ZERO), share, Vec3A::ZERO),
            );
            set(&mut self.movable[side], lane, !mass.is_immovable());
        }
        let moves_both = masses.iter().all(|mass| !mass.is_immovable());
        put(&mut self.tangent_velocity, lane, pair.tangent_velocity.into());
        self.friction.0[lane] = if pair.depenetrating { 0.0 } else { pair.friction };
        self.restitution.0[lane] = pair.restitution;
        self.rest_offset.0[lane] = pair.rest_offset;
        self.diameter.0[lane] = pair.diameter;
        self.mass_ratio.0[lane] = pair.mass_ratio;
        self.softness.0[lane] = pair.softness;
        set(&mut self.softened, lane, pair.softness != 1.0);
        set(&mut self.driven, lane, pair.driven);
        let bounces = pair.restitution > 0.0;
        set(&mut self.depenetrating, lane, pair.depenetrating);
        set(&mut self.elastic, lane, bounces && !pair.depenetrating);
        set(&mut self.bounces_off, lane, bounces && !moves_both);
    }
}

/// Loads pairs and their valid points into the `wanted` lanes of batches.
pub(super) fn load_batches(
    batches: &mut [Batch],
    mut lanes: &mut [PointLanes],
    mut pairs: &[Pair],
    mut points: &[Point],
    masses: &[Mass],
    wanted: u32,
) {
    for batch in batches {
        let (own_pairs, own_points);
        (own_pairs, pairs) = pairs.split_at(batch.pairs);
        (own_points, points) = points.split_at(batch.all_points);
        batch.clear();
        let mut rest = own_points;
        for (lane, pair) in own_pairs.iter().enumerate() {
            let own;
            (own, rest) = rest.split_at(pair.count as usize);
            if wanted >> lane & 1 == 0 {
                continue;
            }
            batch.load_pair(lane, pair, masses);
            for (number, point) in own.iter().filter(|point| point.valid).enumerate() {
                if number == batch.points {
                    lanes[number] = PointLanes::default();
                    batch.points += 1;
                }
                lanes[number].load(lane, point);
            }
        }
        lanes = std::mem::take(&mut lanes).split_at_mut(batch.points).1;
    }
}

/// Stores what substeps have changed in the points of the `wanted` lanes.
pub(super) fn store_batches(
    batches: &[Batch],
    mut lanes: &[PointLanes],
    mut pairs: &[Pair],
    mut points: &mut [Point],
    wanted: u32,
) {
    for batch in batches {
        let (own_pairs, own_lanes);
        (own_pairs, pairs) = pairs.split_at(batch.pairs);
        (own_lanes, lanes) = lanes.split_at(batch.points);
        for (lane, pair) in own_pairs.iter().enumerate() {
            let (own, rest) = std::mem::take(&mut points).split_at_mut(pair.count as usize);
            points = rest;
            if wanted >> lane & 1 == 1 {
                let valid = own.iter_mut().filter(|point| point.valid);
                valid.zip(own_lanes).for_each(|(point, lanes)| lanes.store(lane, point));
            }
        }
    }
}

impl PointLanes {
    fn load(&mut self, lane: usize, point: &Point) {
        for side in 0..2 {
            put(&mut self.anchors[side], lane, point.anchors[side]);
            put(&mut self.curvature_centers[side], lane, point.curvature_centers[side]);
        }
        for (row, direction) in self.rows.iter_mut().zip(point.frame) {
            put(&mut row.direction, lane, direction);
        }
        put(&mut self.initial_normal, lane, point.normal());
        put(&mut self.anchor_offset, lane, point.anchor_offset);
        put(&mut self.friction_offset, lane, point.friction_offset);
        self.contact_fraction.0[lane] = point.contact_fraction;
        self.normal_rotation.0[lane] = point.normal_rotation;
        self.initial_separation.0[lane] = point.initial_separation;
        self.normal_impulse.0[lane] = point.normal_impulse;
        self.friction_impulse[0].0[lane] = point.friction_impulse[0];
        self.friction_impulse[1].0[lane] = point.friction_impulse[1];
        self.total_normal_impulse.0[lane] = point.total_normal_impulse;
        set(&mut self.valid, lane, true);
        set(&mut self.curved, lane, point.normal_rotation > 0.0);
        set(&mut self.touched, lane, point.touched);
    }

    fn store(&self, lane: usize, point: &mut Point) {
        for (direction, row) in point.frame.iter_mut().zip(&self.rows) {
            *direction = Vec3::from_array(row.direction.each_ref().map(|x| x.0[lane])).into();
        }
        point.normal_impulse = self.normal_impulse.0[lane];
        point.friction_impulse = self.friction_impulse.each_ref().map(|impulse| impulse.0[lane]);
        point.total_normal_impulse = self.total_normal_impulse.0[lane];
        point.touched = self.touched >> lane & 1 == 1;
        point.bounced = self.bounced >> lane & 1 == 1;
    }
}

/// Batches in order, each with its points.
pub(super) struct Batches<'a> {
    batches: std::slice::IterMut<'a, Batch>,
    points: &'a mut [PointLanes],
}

impl<'a> Batches<'a> {
    pub fn new(batches: &'a mut [Batch], points: &'a mut [PointLanes]) -> Self {
        Self {
            batches: batches.iter_mut(),
            points,
        }
    }
}

impl<'a> Iterator for Batches<'a> {
    type Item = (&'a mut Batch, &'a mut [PointLanes]);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        let batch = self.batches.next()?;
        let (own, others) = std::mem::take(&mut self.points).split_at_mut(batch.points);
        self.points = others;
        Some((batch, own))
    }
}

/// Values of the bodies on one side of a batch, lane by lane. `of` gives the values of a body by its slot.
#[inline(always)]
pub(super) fn gather<const N: usize>(batch: &Batch, side: usize, of: impl Fn(usize) -> [f32; N]) -> [Stored; N] {
    let mut gathered = [Stored::default(); N];
    for (lane, &slot) in batch.slots[side].iter().enumerate().take(batch.pairs) {
        for (to, from) in gathered.iter_mut().zip(of(slot as usize)) {
            to.0[lane] = from;
        }
    }
    gathered
}

fn put(to: &mut StoredPoints, lane: usize, v: Vec3A) {
    for (to, from) in to.iter_mut().zip(v.to_array()) {
        to.0[lane] = from;
    }
}

fn set(lanes: &mut u32, lane: usize, value: bool) {
    *lanes |= u32::from(value) << lane;
}
