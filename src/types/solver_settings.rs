//! [`SolverSettings`]: how contacts are solved.

#[cfg(feature = "bevy")]
use bevy::prelude::*;

/// The largest [`SolverSettings::max_detections`].
pub const MOST_DETECTIONS: u32 = 64;

/// The largest [`SolverSettings::substeps`], and numbers of iterations and sweeps.
pub const MOST_PASSES: u32 = 256;

/// How contacts are solved; a resource, with what holds for all bodies.
///
/// A step of the world is cut into *detection intervals*, each with contact points of its own (see
/// [`SolverSettings::detections`]), and an interval into *substeps*. Lengths marked with D are parts of the bounding
/// diameter of the smaller of two bodies, so that small and large bodies behave alike.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Resource, Reflect),
    reflect(Resource, Default, Debug, PartialEq)
)]
pub struct SolverSettings {
    /// Substeps per step of the world, shared out among its detection intervals. Default 8: halving the substep helps
    /// stiff stacks and mass ratios more than doubling the iterations, at the same cost (Macklin et al., "Small Steps in
    /// Physics Simulation", 2019).
    pub substeps: u32,
    /// Passes over all pairs per substep that also push overlapping bodies apart. Default 2: a body in several pairs gets
    /// the mean of their answers in one pass, and it takes a second for them to agree.
    pub bias_iterations: u32,
    /// Passes per substep, after the bodies have moved, that take out again the velocity that the push gave. Default 2;
    /// without them chains break.
    pub relax_iterations: u32,
    /// Gauss-Seidel sweeps over the points of one pair within a pass. Default 2.
    pub sweeps: u32,
    /// Part of a point's correction that is applied at once, 0 to 1. Default 0.5: with 1, points of the same pair
    /// overshoot and a stack creeps.
    pub relaxation: f32,
    /// Frequency of the contact spring as a part of the rate of substeps. Default 0.25, the stiffest that a time step can
    /// carry with a margin (Catto, "Solver2D", 2024).
    pub frequency: f32,
    /// Damping ratio of the contact spring. Default 10: far overdamped, so that a push out of an overlap never throws.
    pub damping_ratio: f32,
    /// How fast overlapping bodies are pushed apart at most, m/s. Default 3.
    pub push_speed: f32,
    /// How fast pairs are pushed apart that overlapped deeply when they met, m/s. Default 1.
    pub untangle_speed: f32,
    /// Pairs that overlap deeper than this when they meet are untangled: pushed along their line of centres, without
    /// friction, until they part. In D, default 0.04: beyond, the contact points of meshes may disagree about the way out.
    pub untangle_depth: f32,
    /// How near surfaces must come for points to be found between them, beside what they may move meanwhile. In D, default
    /// 0.01: bodies push before they sink. Not less than twice the rest offset.
    pub contact_margin: f32,
    /// The gap that bodies at rest keep. In D, default 0.005: surfaces that do not cross have contact points that say more.
    pub rest_offset: f32,
    /// Bodies that meet slower than this do not bounce, m/s. Default 0.5: what gravity gives within a few steps must not
    /// keep a pile awake.
    pub restitution_threshold: f32,
    /// Passes over all pairs that bounce, once per detection interval. Default 4: of a cloud of 500 elastic balls that all
    /// meet at once 94 % of the energy was left; with 2 passes 75 %, and with 8 it had grown to 102 % (Newton's law of impact
    /// may gain energy where many bodies meet at once). A pair by itself is exact after one.
    pub restitution_iterations: u32,
    /// How far a point may have moved from where it was in the last interval to go on with the impulse it had. In D,
    /// default 0.05.
    pub match_distance: f32,
    /// Cosine of how far its normal may have turned meanwhile. Default 0.7.
    pub match_normal: f32,
    /// How far two surfaces may move against each other between two detections, in the thickness of the thinnest body. Default
    /// 0.25: what a third body turns aside never gets through more than a quarter of another unseen. Faster ones make the step
    /// be cut up.
    pub detection_travel: f32,
    /// At most this many detection intervals per step. Default 8.
    pub max_detections: u32,
    /// Whether islands of bodies at rest are frozen. Default true.
    pub sleeping: bool,
    /// A body is at rest if no point of it moves faster than this, m/s. Default 0.05; piles settle to 0.0001 to 0.001.
    pub sleep_speed: f32,
    /// How long all bodies of an island must have been at rest, seconds. Default 0.5: at the top of its path a thrown body
    /// is slow for a shorter time.
    pub sleep_time: f32,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self {
            substeps: 8,
            bias_iterations: 2,
            relax_iterations: 2,
            sweeps: 2,
            relaxation: 0.5,
            frequency: 0.25,
            damping_ratio: 10.0,
            push_speed: 3.0,
            untangle_speed: 1.0,
            untangle_depth: 0.04,
            contact_margin: 0.01,
            rest_offset: 0.005,
            restitution_threshold: 0.5,
            restitution_iterations: 4,
            match_distance: 0.05,
            match_normal: 0.7,
            detection_travel: 0.25,
            max_detections: 8,
            sleeping: true,
            sleep_speed: 0.05,
            sleep_time: 0.5,
        }
    }
}

impl SolverSettings {
    /// How many substeps each of `detections` intervals has.
    pub fn substeps_per_detection(&self, detections: u32) -> u32 {
        self.substeps.div_ceil(detections.max(1)).max(1)
    }

    /// The contact margin in D, no less than what bodies at rest need to be seen.
    pub(crate) fn margin(&self) -> f32 {
        self.contact_margin.max(2.0 * self.rest_offset)
    }

    /// What is wrong with these, if anything: the name of a setting that is negative or not finite, or a number of passes
    /// that would keep the step busy for ever: more than [`MOST_PASSES`], or [`MOST_DETECTIONS`].
    pub fn fault(&self) -> Option<&'static str> {
        let Self {
            substeps,
            bias_iterations,
            relax_iterations,
            sweeps,
            relaxation,
            frequency,
            damping_ratio,
            push_speed,
            untangle_speed,
            untangle_depth,
            contact_margin,
            rest_offset,
            restitution_threshold,
            restitution_iterations,
            match_distance,
            match_normal,
            detection_travel,
            max_detections,
            sleeping: _,
            sleep_speed,
            sleep_time,
        } = *self;
        let counts = [
            ("substeps", substeps, MOST_PASSES),
            ("bias_iterations", bias_iterations, MOST_PASSES),
            ("relax_iterations", relax_iterations, MOST_PASSES),
            ("sweeps", sweeps, MOST_PASSES),
            ("restitution_iterations", restitution_iterations, MOST_PASSES),
            ("max_detections", max_detections, MOST_DETECTIONS),
        ];
        if let Some((name, ..)) = counts.into_iter().find(|&(_, count, most)| count > most) {
            return Some(name);
        }
        [
            ("relaxation", relaxation),
            ("frequency", frequency),
            ("damping_ratio", damping_ratio),
            ("push_speed", push_speed),
            ("untangle_speed", untangle_speed),
            ("untangle_depth", untangle_depth),
            ("contact_margin", contact_margin),
            ("rest_offset", rest_offset),
            ("restitution_threshold", restitution_threshold),
            ("match_distance", match_distance),
            ("match_normal", match_normal),
            ("detection_travel", detection_travel),
            ("sleep_speed", sleep_speed),
            ("sleep_time", sleep_time),
        ]
        .into_iter()
        .find_map(|(name, value)| (!(0.0..f32::INFINITY).contains(&value)).then_some(name))
    }
}
