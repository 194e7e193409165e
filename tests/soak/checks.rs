//! What must be true after every step.

use crate::app::place;
use bevy::ecs::message::Messages;
use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::collections::HashMap;
use std::fmt;
use std::time::Duration;

/// Steps between the death of an entity and the end of its collisions, at most: one, and two more with later results.
const PATIENCE: u64 = 4;

/// How many steps may be slow when a device is opened or steps change place.
const SLOW_STEPS: usize = 4;

/// Checks of a run so far.
pub struct Checks {
    /// Pairs that have started and not ended, with the last step when one of them vanished.
    open: HashMap<[Entity; 2], Option<u64>>,
    /// Open pairs when a snapshot was taken: a world that is restored touches as it did then, without messages.
    open_at_snapshot: HashMap<[Entity; 2], Option<u64>>,
    starts: u64,
    rejected: u64,
    failures: u64,
    on_device: usize,
    /// Seconds of each step, and whether it may be slow.
    times: Vec<(f32, bool)>,
    /// How many of the next steps may be slow.
    slow: usize,
    is_latent: bool,
    /// The number of the last step. No step runs while the clock is paused, and what was reported stays.
    last_step: u64,
}

/// The result of a run without errors.
pub struct Report {
    pub starts: u64,
    pub rejected: u64,
    /// How often a device failed.
    pub failures: u64,
    /// Number of steps that ran on a device.
    pub on_device: usize,
    /// Seconds of the median step.
    pub median: f32,
    /// The slowest ordinary step, and how many took over 20 times the median.
    pub slowest: f32,
    pub outliers: usize,
    /// The slowest step in which a device was opened or steps changed place.
    pub slowest_disturbed: f32,
    /// How many more bytes an empty world had at the end than after half of the run, relative to those of the busy
    /// world.
    pub growth: Option<f32>,
    /// Bytes of the process in memory at the end, where the system tells.
    pub resident: Option<u64>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "{} collisions started and all ended; {} bodies rejected; {} steps on a device, which failed {} times; step {:.2} ms in the median, \
             at most {:.1} ms, {} over 20 times the median, {:.1} ms where a device was opened or steps changed place",
            self.starts,
            self.rejected,
            self.on_device,
            self.failures,
            1e3 * self.median,
            1e3 * self.slowest,
            self.outliers,
            1e3 * self.slowest_disturbed
        )?;
        if let Some(growth) = self.growth {
            write!(f, "; the heap grew by {:.2} %", 100.0 * growth)?;
        }
        match self.resident {
            Some(bytes) => write!(f, "; {} MiB in memory", bytes >> 20),
            None => Ok(()),
        }
    }
}

impl Checks {
    pub fn new(readback: Readback, steps: usize) -> Self {
        // All its pages are in use from the beginning, so that it does not count as growth of memory.
        let mut times = vec![(f32::NAN, false); steps];
        times.clear();
        Self {
            open: HashMap::new(),
            open_at_snapshot: HashMap::new(),
            starts: 0,
            rejected: 0,
            failures: 0,
            on_device: 0,
            times,
            // The first step on a device compiles kernels.
            slow: SLOW_STEPS,
            is_latent: readback == Readback::Latent,
            last_step: 0,
        }
    }

    /// A snapshot was taken.
    pub fn take(&mut self) {
        self.open_at_snapshot = self.open.clone();
    }

    /// The snapshot was restored.
    pub fn restore(&mut self) {
        self.open = self.open_at_snapshot.keys().map(|&pair| (pair, None)).collect();
    }

    /// Checks the world after a step. `spoiled` bodies got a place that is no number.
    ///
    /// # Panics
    /// If a message does not fit those before it, or if something stale or not finite is reported.
    pub fn step(&mut self, world: &mut World, number: usize, time: Duration, disturbed: bool, spoiled: &[Entity]) {
        self.messages(world, number);
        let last_step = world.resource::<StepReport>().step;
        let has_stepped = std::mem::replace(&mut self.last_step, last_step) != last_step;
        self.on_device += usize::from(has_stepped && world.resource::<StepReport>().gpu.is_some());
        for collision in world.resource::<Collisions>().iter() {
            let pair = [collision.collider1, collision.collider2];
            let Contact { point, normal, .. } = collision.contact;
            assert!(
                point.is_finite() && normal.is_finite(),
                "step {number}: {pair:?} touches at {point}"
            );
            let alive = pair.iter().all(|&entity| world.get_entity(entity).is_ok());
            assert!(
                alive || self.is_latent || !has_stepped,
                "step {number}: {pair:?} is reported after its end"
            );
        }
        let mut bodies = world.query_filtered::<(Entity, &Transform), With<RigidBody>>();
        for (entity, pose) in bodies.iter(world) {
            let is_known = spoiled.contains(&entity);
            assert!(
                is_known || pose.is_finite(),
                "step {number}: the step moved {entity} to {pose:?}"
            );
        }
        if disturbed {
            self.slow = SLOW_STEPS;
        }
        self.times.push((time.as_secs_f32(), self.slow > 0));
        self.slow = self.slow.saturating_sub(1);
    }

    /// Reads the messages of steps at the end, when nothing is there any more.
    pub fn drain(&mut self, world: &mut World) {
        let number = self.times.len();
        self.messages(world, number);
    }

    fn messages(&mut self, world: &mut World, number: usize) {
        for end in world.resource_mut::<Messages<CollisionEnd>>().drain() {
            let pair = [end.collider1, end.collider2];
            assert!(
                self.open.remove(&pair).is_some(),
                "step {number}: {pair:?} ended before it started"
            );
        }
        for start in world.resource_mut::<Messages<CollisionStart>>().drain() {
            let pair = [start.collider1, start.collider2];
            assert!(
                place(&pair[0]) < place(&pair[1]),
                "step {number}: {pair:?} is not in order"
            );
            assert!(
                self.open.insert(pair, None).is_none(),
                "step {number}: {pair:?} started twice"
            );
            self.starts += 1;
        }
        self.rejected += world.resource_mut::<Messages<BodyRejected>>().drain().count() as u64;
        self.failures += world.resource_mut::<Messages<BackendFailed>>().drain().count() as u64;
        let last_step = world.resource::<StepReport>().step;
        for (pair, vanished) in &mut self.open {
            if pair.iter().any(|&entity| world.get_entity(entity).is_err()) {
                let since = *vanished.get_or_insert(last_step);
                // A new device counts its steps anew.
                assert!(
                    last_step.saturating_sub(since) <= PATIENCE,
                    "step {number}: {pair:?} has not ended in {PATIENCE} steps"
                );
            }
        }
    }

    /// What a long run prints on its way.
    pub fn so_far(&self) -> String {
        let recent = &self.times[self.times.len().saturating_sub(1024)..];
        let mean = recent.iter().map(|time| time.0).sum::<f32>() / recent.len().max(1) as f32;
        let memory = resident().unwrap_or_default() >> 20;
        format!(
            "{:.1} ms a step lately, {} collisions, {memory} MiB",
            1e3 * mean,
            self.starts
        )
    }

    /// The report.
    ///
    /// # Panics
    /// If a collision has not ended.
    pub fn finish(self) -> Report {
        assert!(self.open.is_empty(), "{} collisions never ended", self.open.len());
        assert!(self.starts > 0, "nothing collided");
        let mut ordinary: Vec<f32> = self.times.iter().filter(|time| !time.1).map(|time| time.0).collect();
        ordinary.sort_unstable_by(f32::total_cmp);
        let median = ordinary.get(ordinary.len() / 2).copied().unwrap_or_default();
        let disturbed = self.times.iter().filter(|time| time.1).map(|time| time.0);
        Report {
            starts: self.starts,
            rejected: self.rejected,
            failures: self.failures,
            on_device: self.on_device,
            median,
            slowest: ordinary.last().copied().unwrap_or_default(),
            outliers: ordinary.iter().filter(|&&time| time > 20.0 * median).count(),
            slowest_disturbed: disturbed.fold(0.0, f32::max),
            growth: None,
            resident: resident(),
        }
    }
}

/// Bytes of this process in memory, where the system tells.
fn resident() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(1024 * line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()?)
}
