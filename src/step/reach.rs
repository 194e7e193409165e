//! How many collision substeps a step needs: the largest number that any bodies need that can meet in it.
//!
//! Bodies whose spheres, swept over the whole step, overlap form a group; what is static joins nothing. Each group
//! needs the number that its own speeds and its thinnest body ask for, and a body that can meet nothing needs one,
//! however fast or thin it is. So a bullet in flight far away costs nothing. The speed of a body's rotation counts
//! where others may touch it, so that a nut that turns about its bolt needs no more than its thread does. Groups with
//! different numbers must stay apart for the whole step, see [`territories`](super::territories).

use super::dormant::{Dormant, MetColliders};
use super::territories::Territories;
use crate::broad_phase;
use crate::broad_phase::cpu::WideSearch;
use crate::geometry::union_find::UnionFind;
use crate::simd::lanes::{SimdBase, bitmask, load_points, splat_point};
use crate::simd::level::baseline;
use crate::simd::levels::visit;
use crate::solver::SolverBodies;
use crate::solver::speeds::Speeds;
use crate::state::margins::{SAFETY, SpeculativeMargins, arm_within, sway};
use crate::state::mesh_arena::{BoxGroup, MeshArena};
use crate::state::{Bodies, Plane, StepConfig, StepInput};
use crate::types::body::RigidBody;
use glam::{DVec3, Vec3};

/// How far bodies may travel in a step beyond the distance at their first velocities, in units of their radius, so that
/// later collision substeps need no search of their own.
const ROOM: f32 = 0.06;

/// Scratch memory.
#[derive(Default)]
pub(crate) struct Reach {
    broad_phase: broad_phase::cpu::Scratch,
    pairs: Vec<[u32; 2]>,
    groups: UnionFind,
    /// For the root of each group; others are not used.
    meetings: Vec<Meeting>,
    territories: Territories,
}

/// The solid bodies of a group, and what is static and in their way.
#[derive(Clone, Copy)]
pub(super) struct Meeting {
    pub speeds: Speeds,
    /// Thickness of the thinnest body, metres.
    thinnest: f32,
    /// Whether the group has two bodies, or one and something static.
    exists: bool,
    /// The number of collision substeps that it needs.
    pub collision_substeps: u32,
}

impl Reach {
    /// Finds the number of collision substeps that each body that moves needs. `drift` is their common velocity, m/s.
    /// `near_in_step` receives the pairs that come near each other within the step. Changes
    /// [`Bodies::speculative_radius`] and [`Bodies::travel_time`].
    ///
    /// # Errors
    /// The bodies that must be roused first, because others may meet them.
    pub fn search(
        &mut self,
        input: &mut StepInput,
        solver_bodies: &SolverBodies,
        drift: Vec3,
        near_in_step: &mut WideSearch,
        dormant: &Dormant,
    ) -> Result<(), MetColliders> {
        let StepInput {
            config,
            bodies,
            meshes,
            planes,
            ..
        } = input;
        let Self {
            broad_phase,
            pairs,
            groups,
            meetings,
            territories,
        } = self;
        bodies.for_each_mover(|bodies, i| bodies.travel_time[i] = config.dt);
        SpeculativeMargins::Moving { drift }.set_reach(bodies, config);
        bodies.for_each_mover(|bodies, i| bodies.speculative_radius[i] += ROOM * bodies.radius[i]);
        let crowd = broad_phase::cpu::run(bodies, config.limits.body_pairs, broad_phase, pairs);
        let is_crowded = crowd.bodies > 0;
        dormant.meet(bodies, pairs, is_crowded)?;
        if !is_crowded {
            near_in_step.set(bodies, pairs);
        }
        let moves = |i: u32| solver_bodies.bodies[i as usize].moves();
        let solid = |i: u32| solver_bodies.bodies[i as usize].solid;
        let sweep = |i: u32| Sweep::of(bodies, config, i);
        let spin_of = |i: u32| Speeds::spin_of(solver_bodies, bodies.body_of(i) as usize, config.dt);
        pairs.retain(|&[a, b]| sweep(a).meets(&sweep(b)));

        groups.reset_members(bodies.len(), bodies.movers());
        for part in &bodies.parts {
            groups.join(part.collider, bodies.body_of(part.collider));
        }
        for &[a, b] in pairs.iter().filter(|pair| pair.iter().all(|&i| moves(i))) {
            groups.join(a, b);
        }
        if is_crowded {
            // Pairs are missing, so that any two bodies may meet.
            let mut moving = bodies.movers().map(|i| i as u32);
            if let Some(first) = moving.next() {
                moving.for_each(|i| groups.join(first, i));
            }
        }
        meetings.resize(bodies.len(), Meeting::NONE);
        bodies.movers().for_each(|i| meetings[i] = Meeting::NONE);
        for i in bodies.movers().map(|i| i as u32).filter(|&i| solid(i)) {
            let meeting = &mut meetings[groups.root(i) as usize];
            meeting.include(solver_bodies, i as usize, config.dt);
            let own = sweep(i);
            let meets_plane = planes.iter().any(|plane| !plane.sensor && own.meets_plane(plane));
            if meets_plane {
                meeting.speeds.add(Vec3::ZERO);
            }
            if meets_plane || is_crowded {
                meeting.exists = true;
                meeting.speeds.spin_up(spin_of(i));
            }
        }
        for &[a, b] in pairs.iter().filter(|pair| pair.iter().all(|&i| solid(i))) {
            let [mover, other] = if moves(a) { [a, b] } else { [b, a] };
            let meeting = &mut meetings[groups.root(mover) as usize];
            if !moves(other) {
                if !sweep(mover).meets_mesh(bodies, meshes, other) {
                    continue;
                }
                meeting.include(solver_bodies, other as usize, config.dt);
            }
            meeting.exists = true;
            for pair in [[mover, other], [other, mover]] {
                let spin = spin_of(pair[0]);
                // Another surface of the group moves as fast.
                if spin > meeting.speeds.spin() {
                    meeting.speeds.spin_up(spin_near(bodies, meshes, config, pair, spin));
                }
            }
        }
        for i in bodies.movers() {
            meetings[i].count_collision_substeps(config);
        }
        let is_awake = |i: u32| !solver_bodies.sleep[i as usize].asleep;
        territories.separate(bodies, config, is_awake, groups, meetings);
        dormant.meet_boxes(|bounds| territories.reach(bounds, config, meetings))
    }

    /// The number of collision substeps of each body that moves, in the order of [`Bodies::movers`].
    pub fn collision_substeps(&mut self, bodies: &Bodies) -> impl Iterator<Item = u32> {
        let Self { groups, meetings, .. } = self;
        bodies
            .movers()
            .map(|i| meetings[groups.root(i as u32) as usize].collision_substeps)
    }
}

impl Meeting {
    const NONE: Self = Self {
        speeds: Speeds::NONE,
        thinnest: f32::INFINITY,
        exists: false,
        collision_substeps: 1,
    };

    /// Includes body `i` without its rotation.
    fn include(&mut self, bodies: &SolverBodies, i: usize, dt: f32) {
        self.speeds.include_velocity(bodies, i, dt);
        self.thinnest = self.thinnest.min(bodies.bodies[i].thickness);
    }

    /// Includes what the other group includes.
    pub fn join(&mut self, other: &Self, config: &StepConfig) {
        self.speeds = self.speeds.and(other.speeds);
        self.thinnest = self.thinnest.min(other.thinnest);
        self.exists |= other.exists;
        self.count_collision_substeps(config);
    }

    fn count_collision_substeps(&mut self, config: &StepConfig) {
        self.collision_substeps = if self.exists {
            self.speeds
                .collision_substeps_for(&config.solver, self.thinnest, config.dt)
        } else {
            1
        };
    }
}

/// Speed of the first body's surface relative to its centre of mass where the second may touch it within the step, m/s.
/// No part of the surface is faster than `most`.
fn spin_near(bodies: &Bodies, meshes: &MeshArena, config: &StepConfig, pair: [u32; 2], most: f32) -> f32 {
    let [i, _] = pair;
    if bodies.part(i).is_some_and(|part| part.offset != DVec3::ZERO) {
        // The axis of rotation does not pass through this collider's centre.
        return most;
    }
    let less = bodies.radius[i as usize] - arm_within(bodies, meshes, config, pair, config.dt);
    most - bodies.angular_velocity[i as usize].length() * less
}

/// The sphere that a body sweeps over in a step, with the part of its margin that does not depend on a direction.
#[derive(Clone, Copy)]
pub(super) struct Sweep {
    pub center: DVec3,
    /// How far the centre moves, metres.
    pub travel: Vec3,
    pub radius: f32,
}

impl Sweep {
    pub fn of(bodies: &Bodies, config: &StepConfig, i: u32) -> Self {
        let i = i as usize;
        let travel = match bodies.kind[i] {
            RigidBody::Static => Vec3::ZERO,
            _ => SAFETY * config.dt * bodies.linear_velocity[i],
        };
        let margin = config.solver.margin() * bodies.radius[i];
        Self {
            center: bodies.frame[i].center,
            travel,
            radius: bodies.radius[i] + margin + SAFETY * config.dt * sway(bodies, config, i, config.dt),
        }
    }

    /// The corners of a box around it.
    pub fn bounds(&self) -> [DVec3; 2] {
        let (radius, end) = (f64::from(self.radius), self.center + self.travel.as_dvec3());
        [self.center.min(end) - radius, self.center.max(end) + radius]
    }

    fn meets(&self, other: &Self) -> bool {
        let offset = (other.center - self.center).as_vec3();
        let travel = other.travel - self.travel;
        let part = -offset.dot(travel) / travel.length_squared().max(f32::MIN_POSITIVE);
        let nearest = offset + part.clamp(0.0, 1.0) * travel;
        nearest.length() < self.radius + other.radius
    }

    fn meets_plane(&self, plane: &Plane) -> bool {
        let height = plane.normal.as_dvec3().dot(self.center) as f32 - plane.distance;
        height + plane.normal.dot(self.travel).min(0.0) < self.radius
    }

    /// Whether its bounding box, in the axes of the static body `other`, overlaps the box of a cluster of triangles.
    /// Most of a level's bounding sphere is empty.
    fn meets_mesh(&self, bodies: &Bodies, meshes: &MeshArena, other: u32) -> bool {
        let other = other as usize;
        let Some(slot) = meshes.get(bodies.mesh[other]) else {
            return false;
        };
        let frame = &bodies.frame[other];
        let to_local = frame.rotation.transpose();
        let half_travel = 0.5 * (to_local * self.travel.as_dvec3());
        let center = to_local * (self.center - frame.center) + half_travel;
        let half = half_travel.abs() + f64::from(self.radius + bodies.rounding[other]);
        let simd = baseline();
        let [center, half, scale, size] =
            [center, half, frame.scale, frame.scale.abs()].map(|vector| splat_point(simd, vector.as_vec3()));
        let overlaps = |group: &BoxGroup| {
            let (middle, half_box) = (load_points(simd, &group.center), load_points(simd, &group.half));
            let near = |axis: usize| {
                let apart = (middle[axis] * scale[axis] - center[axis]).abs();
                bitmask(apart.simd_lt(half_box[axis] * size[axis] + half[axis]))
            };
            near(0) & near(1) & near(2)
        };
        !visit(&slot.lanes.levels, overlaps, |_| false)
    }
}
