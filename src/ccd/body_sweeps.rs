//! How bodies move after impacts: in groups that move together.

use super::Sweep;
use crate::state::{Bodies, Plane};
use glam::{DQuat, DVec3};
use std::cmp::Ordering;

/// How often a body may slide along others in a collision substep.
const MAX_SLIDES: u32 = 4;

/// The sweep of a body from some time on.
#[derive(Clone, Copy)]
pub(super) struct BodySweep {
    /// Number of the body.
    pub body: u32,
    /// Start of this sweep, 0 to 1.
    pub from: f64,
    /// From then to the end of the collision substep.
    pub sweep: Sweep,
    /// Bodies of the same group move together. The group's name is the place of the body that carries the others, if
    /// there is one, otherwise the smallest place in it.
    pub group: u32,
    /// Time of the first impact; infinite if there is none.
    pub first_impact: f64,
    /// How often it has slid along a body that it touches.
    pub slides: u32,
}

/// The sweeps of the bodies of the pairs.
#[derive(Default)]
pub(super) struct BodySweeps {
    pub all: Vec<BodySweep>,
    /// For each sweep, the next one in its group, in a ring, while the group is not carried.
    next: Vec<u32>,
    /// The places of sweeps that have changed in this impact.
    pub changed: Vec<u32>,
    /// Scratch: the places in some groups.
    group: Vec<u32>,
}

/// The planes, for bodies that others move.
pub(super) struct Ground<'a, F> {
    pub bodies: &'a Bodies,
    pub planes: &'a [Plane],
    /// Whether a body passes through a plane.
    pub pass: F,
}

impl BodySweeps {
    /// Sets the sweeps of all bodies, each of which is a group by itself.
    pub fn begin(&mut self, sweeps: impl Iterator<Item = BodySweep>) {
        let Self {
            all,
            next,
            changed,
            group,
        } = self;
        all.clear();
        all.extend(sweeps);
        next.clear();
        next.extend(0..all.len() as u32);
        changed.clear();
        group.clear();
    }

    /// Adds the places in a group that is not carried to `group`.
    fn add_group(&mut self, name: u32) {
        let mut place = name;
        loop {
            self.group.push(place);
            place = self.next[place as usize];
            if place == name {
                return;
            }
        }
    }

    /// Merges two groups of continuous bodies, which move together from `time` on. Two groups of the same size get the
    /// mean of their velocities, weighted by mass. Otherwise the smaller group adopts the velocity of the larger one,
    /// so that in a heap the times of all members need not be recomputed for each body that joins.
    pub fn merge_groups(&mut self, ground: &Ground<impl Fn([u32; 2]) -> bool>, groups: [u32; 2], time: f64) {
        self.group.clear();
        for name in groups {
            self.add_group(name);
        }
        // The order decides the last bits of the sums.
        self.group.sort_unstable();
        let bodies = ground.bodies;
        let (mut momentum, mut mass) = ([DVec3::ZERO; 2], [0.0; 2]);
        let mut members = [0, 0];
        for &place in &self.group {
            let body_sweep = &self.all[place as usize];
            let side = usize::from(body_sweep.group == groups[1]);
            let inverse_mass = bodies.inverse_mass[body_sweep.body as usize];
            // Bodies without a valid mass have equal weights.
            let own = if inverse_mass > 0.0 {
                1.0 / f64::from(inverse_mass)
            } else {
                1.0
            };
            momentum[side] += own * body_sweep.after(time).travel;
            mass[side] += own;
            members[side] += 1;
        }
        let travel = match members[0].cmp(&members[1]) {
            Ordering::Equal => (momentum[0] + momentum[1]) / (mass[0] + mass[1]),
            Ordering::Greater => momentum[0] / mass[0],
            Ordering::Less => momentum[1] / mass[1],
        };
        let mut common = travel;
        for &place in &self.group {
            let body_sweep = &self.all[place as usize];
            common = ground.limit_penetration(body_sweep.body as usize, &body_sweep.after(time), common);
        }
        let group = groups[0].min(groups[1]);
        for &place in &self.group {
            let body_sweep = &mut self.all[place as usize];
            let side = usize::from(body_sweep.group == groups[1]);
            if members[side] > members[1 - side] && common == travel {
                body_sweep.group = group;
            } else {
                let free = bodies.params[body_sweep.body as usize].locked_axes.free_translation();
                let free = free.as_dvec3();
                body_sweep.change(time, group, common * free, DVec3::ZERO);
                self.changed.push(place);
            }
        }
        // Makes one ring of two.
        let [a, b] = groups.map(|name| name as usize);
        self.next.swap(a, b);
    }

    /// From `time` on a group of continuous bodies is carried by the body at the place `carrier`.
    pub fn carry_group(&mut self, ground: &Ground<impl Fn([u32; 2]) -> bool>, carrier: u32, time: f64, group: u32) {
        self.group.clear();
        self.add_group(group);
        for at in 0..self.group.len() {
            self.carry(ground, carrier, time, self.group[at]);
        }
    }

    /// From `time` on the body at a place, a group of its own, slides along the body at the place `carrier`, whose
    /// surface it touches: it only does not come nearer. `normal` leads from that surface to the body, at the start of
    /// the collision substep. From its second slide on the body turns with the carrier, because the next corner of a
    /// spinning body would meet the surface at once.
    pub fn slide(
        &mut self,
        ground: &Ground<impl Fn([u32; 2]) -> bool>,
        carrier: u32,
        time: f64,
        place: u32,
        normal: DVec3,
    ) {
        let carrying = self.all[carrier as usize].sweep;
        let normal = DQuat::from_scaled_axis(carrying.turn) * normal;
        let carried = self.travel_with(carrier, time, place);
        let carried_turn = self.all[carrier as usize].after(time).turn;
        let body_sweep = &mut self.all[place as usize];
        let own = body_sweep.after(time);
        let body = body_sweep.body as usize;
        let locked = ground.bodies.params[body].locked_axes;
        let pushed = own.travel + normal * (carried - own.travel).dot(normal).max(0.0);
        let travel = ground.limit_penetration(body, &own, pushed) * locked.free_translation().as_dvec3();
        let turn = match body_sweep.slides {
            0 => own.turn,
            _ => carried_turn * locked.free_rotation().as_dvec3(),
        };
        let group = body_sweep.group;
        body_sweep.change(time, group, travel, turn);
        body_sweep.slides += 1;
        self.changed.push(place);
    }

    /// How far the body at a place travels after `time` if it is attached to that at the place `carrier`.
    fn travel_with(&self, carrier: u32, time: f64, place: u32) -> DVec3 {
        let carrying = self.all[carrier as usize].after(time);
        let offset = self.all[place as usize].after(time).before.center - carrying.before.center;
        // Exactly zero without rotation.
        if carrying.turn == DVec3::ZERO {
            return carrying.travel;
        }
        let rotation = carrying.at(1.0).rotation * carrying.before.rotation.inverse();
        carrying.travel + (rotation * offset - offset)
    }

    /// Whether a group has one member, which is not carried and may slide once more.
    pub fn may_slide(&self, group: u32) -> bool {
        self.next[group as usize] == group && self.all[group as usize].slides < MAX_SLIDES
    }

    /// From `time` on the body at a place is carried by that at the place `carrier`, as if rigidly attached to it.
    pub fn carry(&mut self, ground: &Ground<impl Fn([u32; 2]) -> bool>, carrier: u32, time: f64, place: u32) {
        let turn = self.all[carrier as usize].after(time).turn;
        let carried = self.travel_with(carrier, time, place);
        let body_sweep = &mut self.all[place as usize];
        let own = body_sweep.after(time);
        let body = body_sweep.body as usize;
        let locked = ground.bodies.params[body].locked_axes;
        let travel = ground.limit_penetration(body, &own, carried);
        let travel = travel * locked.free_translation().as_dvec3();
        body_sweep.change(time, carrier, travel, turn * locked.free_rotation().as_dvec3());
        self.changed.push(place);
    }
}

impl<F: Fn([u32; 2]) -> bool> Ground<'_, F> {
    /// Changes `travel` so that it moves body `i` no deeper into planes than its `own` motion does, which contacts
    /// have already limited.
    fn limit_penetration(&self, i: usize, own: &Sweep, mut travel: DVec3) -> DVec3 {
        let Self { bodies, planes, pass } = self;
        for (number, plane) in (bodies.len() as u32..).zip(*planes) {
            if plane.sensor || !bodies.layers[i].interacts_with(plane.layers) || pass([i as u32, number]) {
                continue;
            }
            let normal = plane.normal.as_dvec3();
            let height = normal.dot(own.before.center + travel) - f64::from(plane.distance);
            let lowest = normal.dot(own.travel).min(0.0);
            let radius = bodies
                .compound_of(i as u32)
                .map_or(bodies.radius[i], |body| body.radius);
            if height < f64::from(radius) {
                travel += normal * (lowest - normal.dot(travel)).max(0.0);
            }
        }
        travel
    }
}

impl BodySweep {
    /// The rest of the sweep, from `time` on.
    pub fn after(&self, time: f64) -> Sweep {
        let left = 1.0 - self.from;
        let done = if left > 0.0 { (time - self.from) / left } else { 0.0 };
        self.sweep.part(done.clamp(0.0, 1.0), 1.0)
    }

    /// Replaces the sweep from `time` on.
    fn change(&mut self, time: f64, group: u32, travel: DVec3, turn: DVec3) {
        *self = Self {
            body: self.body,
            from: time,
            sweep: Sweep {
                before: self.after(time).before,
                travel,
                turn,
            },
            group,
            first_impact: self.first_impact.min(time),
            slides: self.slides,
        };
    }
}
