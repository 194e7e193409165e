//! [`SolverSettings`]: parameters of the contact solver.

#[cfg(feature = "bevy")]
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// The largest [`SolverSettings::max_collision_substeps`].
pub const MAX_COLLISION_SUBSTEPS: u32 = 64;

/// The largest [`SolverSettings::substeps`], and the largest number of iterations.
pub const MAX_PASSES: u32 = 256;

/// Parameters of the contact solver, for all bodies. Used with
/// [`Response::Contacts`](crate::types::settings::Response::Contacts).
///
/// A step is divided into *collision substeps*: contact points are computed anew in each of them. A collision substep
/// is divided into the solver's *substeps*. Lengths in D are fractions of the bounding diameter of the smaller of the
/// two bodies, so that small and large bodies behave alike.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Resource, Reflect),
    reflect(Resource, Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[serde(default, deny_unknown_fields)]
pub struct SolverSettings {
    /// Substeps per step, distributed over its collision substeps. Default 8, at most [`MAX_PASSES`].
    ///
    /// Halving the substep helps stiff stacks and large mass ratios more than doubling the iterations, at the same cost
    /// (Macklin et al., "Small Steps in Physics Simulation", 2019).
    pub substeps: u32,
    /// Smallest number of passes over all pairs per substep with a bias velocity that pushes overlapping bodies apart.
    /// Default 2.
    pub bias_iterations: u32,
    /// Smallest number of passes per substep without bias velocity, after the bodies have moved. They remove the
    /// velocity that the bias added. Default 2. Without them chains break.
    pub relax_iterations: u32,
    /// Most passes of either kind. Default 64. Small islands get as many as they need to converge. Large ones get
    /// fewer, and so do islands under heavy loads on a GPU. On the CPU, chains and other sparse islands whose passes do
    /// not converge are solved directly.
    pub max_iterations: u32,
    /// An island has converged if no pass changes the velocity at a contact by more than this, in m/s.
    /// Default 0.001. Small bodies, and light ones below heavy ones, are solved more exactly.
    pub convergence_speed: f32,
    /// Frequency of the contact spring as a fraction of the substep rate. Default 0.25, the stiffest value that the
    /// time step supports with a margin (Catto, "Solver2D", 2024).
    pub frequency: f32,
    /// Damping ratio of the contact spring. Default 10: strongly overdamped, so that pushing bodies out of an overlap
    /// does not throw them. In an island of more than 285 points, which gets few passes, it is at most 1.5: with more,
    /// large piles would never come to rest.
    pub damping_ratio: f32,
    /// Largest speed at which overlapping bodies are pushed apart, in m/s. Default 3.
    pub max_depenetration_speed: f32,
    /// Largest speed at which deeply overlapping pairs are pushed apart, in m/s; see
    /// [`SolverSettings::deep_penetration`]. Default 1.
    pub deep_depenetration_speed: f32,
    /// Depth of deep penetration, in D. Default 0.04.
    ///
    /// A pair that overlaps more deeply when it first meets is pushed apart along the line of centres, without
    /// friction, until it separates: the contact points of meshes that overlap so deeply may disagree about the
    /// direction.
    pub deep_penetration: f32,
    /// Distance between surfaces within which contact points are computed, in D, in addition to the distance that the
    /// surfaces may move in the meantime. Default 0.01, so that bodies push each other before they overlap. Values
    /// below twice [`SolverSettings::rest_offset`] count as that.
    pub contact_margin: f32,
    /// Gap between bodies at rest, in D, before their weight closes a part of it. Default 0.0005.
    pub rest_offset: f32,
    /// Bodies that meet more slowly than this do not bounce, in m/s. Default 0.5: the speed that gravity adds within a
    /// few steps must not keep a pile awake.
    pub restitution_threshold: f32,
    /// Passes over all pairs that resolve impacts. Default 4.
    ///
    /// Each substep with impacts makes at least this many, until the impulses have converged, so that impacts of
    /// elastic bodies keep the energy. A single pair is exact after one pass.
    pub restitution_iterations: u32,
    /// Warm starting: a point keeps the impulse of a point of the last collision substep that is at most this far away.
    /// In D, default 0.05.
    pub match_distance: f32,
    /// Warm starting: the smallest cosine of the angle between the normals of two such points. Default 0.7.
    pub match_normal: f32,
    /// How far two surfaces may move relative to each other in one collision substep, as a fraction of the thickness of
    /// the thinnest body. Faster bodies cause more collision substeps.
    ///
    /// Default 0.25: contacts are searched for again before a surface has moved by a quarter of the thinnest body's
    /// thickness, also if a third body has deflected it. The contact points of two bodies that overlap deeply are found
    /// anew after twice this distance, or in the next step.
    pub collision_substep_travel: f32,
    /// Largest number of collision substeps per step. Default 8, at most [`MAX_COLLISION_SUBSTEPS`].
    pub max_collision_substeps: u32,
    /// Whether islands of bodies at rest fall asleep. Default true.
    pub sleeping: bool,
    /// A body is not at rest while one of its points moves faster than this, in m/s. Default 0.05.
    pub sleep_speed: f32,
    /// How long all bodies of an island must be at rest before they sleep, in seconds. Default 0.5: longer than a
    /// thrown body is slow at the top of its path. However short, it takes two collision substeps.
    ///
    /// A body is at rest if it goes nearly nowhere, however slow it is: in half of this time less than 0.1 % of its
    /// bounding diameter (of 2 m, if that is less), and in the second half as far as in the first. If the halves differ
    /// by more than 0.02 % and the body does not slow down, it is watched for three times as long. A body that touches
    /// nothing is at rest only if it does not move.
    pub sleep_time: f32,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self {
            substeps: 8,
            bias_iterations: 2,
            relax_iterations: 2,
            max_iterations: 64,
            convergence_speed: 0.001,
            frequency: 0.25,
            damping_ratio: 10.0,
            max_depenetration_speed: 3.0,
            deep_depenetration_speed: 1.0,
            deep_penetration: 0.04,
            contact_margin: 0.01,
            rest_offset: 0.0005,
            restitution_threshold: 0.5,
            restitution_iterations: 4,
            match_distance: 0.05,
            match_normal: 0.7,
            collision_substep_travel: 0.25,
            max_collision_substeps: 8,
            sleeping: true,
            sleep_speed: 0.05,
            sleep_time: 0.5,
        }
    }
}

impl SolverSettings {
    /// Number of substeps in each of `detections` collision substeps.
    pub fn substeps_per_collision_substep(&self, detections: u32) -> u32 {
        self.substeps.div_ceil(detections.max(1)).max(1)
    }

    /// The contact margin in D, large enough that bodies at rest have contact points.
    pub(crate) fn margin(&self) -> f32 {
        self.contact_margin.max(2.0 * self.rest_offset)
    }

    /// The name of the first invalid setting, if there is one: a number that is negative or not finite, or a count
    /// above [`MAX_PASSES`] or [`MAX_COLLISION_SUBSTEPS`], with which a step would take too long.
    pub fn fault(&self) -> Option<&'static str> {
        let Self {
            substeps,
            bias_iterations,
            relax_iterations,
            max_iterations,
            convergence_speed,
            frequency,
            damping_ratio,
            max_depenetration_speed,
            deep_depenetration_speed,
            deep_penetration,
            contact_margin,
            rest_offset,
            restitution_threshold,
            restitution_iterations,
            match_distance,
            match_normal,
            collision_substep_travel,
            max_collision_substeps,
            sleeping: _,
            sleep_speed,
            sleep_time,
        } = *self;
        let counts = [
            ("substeps", substeps, MAX_PASSES),
            ("bias_iterations", bias_iterations, MAX_PASSES),
            ("relax_iterations", relax_iterations, MAX_PASSES),
            ("max_iterations", max_iterations, MAX_PASSES),
            ("restitution_iterations", restitution_iterations, MAX_PASSES),
            ("max_collision_substeps", max_collision_substeps, MAX_COLLISION_SUBSTEPS),
        ];
        if let Some((name, ..)) = counts.into_iter().find(|&(_, count, most)| count > most) {
            return Some(name);
        }
        [
            ("convergence_speed", convergence_speed),
            ("frequency", frequency),
            ("damping_ratio", damping_ratio),
            ("max_depenetration_speed", max_depenetration_speed),
            ("deep_depenetration_speed", deep_depenetration_speed),
            ("deep_penetration", deep_penetration),
            ("contact_margin", contact_margin),
            ("rest_offset", rest_offset),
            ("restitution_threshold", restitution_threshold),
            ("match_distance", match_distance),
            ("match_normal", match_normal),
            ("collision_substep_travel", collision_substep_travel),
            ("sleep_speed", sleep_speed),
            ("sleep_time", sleep_time),
        ]
        .into_iter()
        .find_map(|(name, value)| (!(0.0..f32::INFINITY).contains(&value)).then_some(name))
    }
}
