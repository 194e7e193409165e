//! The collision substeps of a step, and which bodies take part in them.
//!
//! Every body passes through the step in equal collision substeps, as many as it and the bodies that it can meet need.
//! All bodies begin with the first. A body with fewer than others completes its step early: it keeps its pose from then
//! on, its contacts keep their points, and no stage spends time on it.

use crate::solver::Pace;
use crate::state::{Bodies, StepConfig};

/// The number of collision substeps of each body.
#[derive(Default)]
pub(crate) struct Schedule {
    /// For each body that moves. Empty if all have the largest number.
    counts: Vec<u32>,
    most: u32,
}

impl Schedule {
    /// All bodies have `count`.
    pub fn set_all(&mut self, count: u32) {
        self.counts.clear();
        self.most = count;
    }

    /// Each body that moves has its own number, in the order of [`Bodies::movers`].
    pub fn set_each(&mut self, counts: impl Iterator<Item = u32>) {
        self.counts.clear();
        self.counts.extend(counts);
        self.most = self.counts.iter().copied().max().unwrap_or(0).max(1);
        if self.counts.iter().all(|&count| count == self.most) {
            self.counts.clear();
        }
    }

    /// The largest number.
    pub fn most(&self) -> u32 {
        self.most
    }

    /// The mean number of the bodies that move, and of `dormant` ones, which have one each.
    pub fn mean(&self, bodies: &Bodies) -> f32 {
        let dormant = bodies.dormant.count;
        let count = bodies.movers().count();
        let sum: u64 = match self.counts.is_empty() {
            true => u64::from(self.most) * count as u64,
            false => self.counts.iter().map(|&count| u64::from(count)).sum(),
        };
        if count + dormant == 0 {
            return self.most as f32;
        }
        (sum + dormant as u64) as f32 / (count + dormant) as f32
    }

    /// Adds bodies that were dormant at these places among [`Bodies::movers`], ascending.
    pub fn add_roused(&mut self, places: impl Iterator<Item = usize>, bodies: &Bodies) {
        if self.most == 1 {
            return;
        }
        let places: Vec<usize> = places.collect();
        if self.counts.is_empty() {
            let before = bodies.movers().count() - places.len();
            self.counts.resize(before, self.most);
        }
        for place in places {
            self.counts.insert(place, 1);
        }
    }

    /// Sets [`Bodies::travel_time`] for collision substep `number`.
    pub fn begin(&self, number: u32, config: &StepConfig, bodies: &mut Bodies) {
        let mut counts = self.counts.iter().copied();
        bodies.for_each_mover(|bodies, i| {
            let count = counts.next().unwrap_or(self.most);
            let time = if number < count { config.dt / count as f32 } else { 0.0 };
            // Searches by themselves have no more than spheres.
            if let Some(own) = bodies.travel_time.get_mut(i) {
                *own = time;
            }
        });
    }

    /// How body `i` passes through the present collision substep. Planes are numbered after the bodies.
    pub fn pace(&self, i: usize, config: &StepConfig, bodies: &Bodies) -> Pace {
        let dt = bodies.travel_time_of(i);
        if dt == 0.0 {
            return Pace::DONE;
        }
        let count = (config.dt / dt).round() as u32;
        Pace {
            dt,
            substeps: config.solver.substeps_per_collision_substep(count),
        }
    }
}
