//! Mean and longest times of several steps, which change slowly enough to read.

use crate::plugin::collisions::StepReport;
use crate::types::stage::Stage;
use bevy::prelude::*;
use std::time::Duration;

/// Times of the steps since the last refresh.
#[derive(Resource, Default)]
pub(super) struct Averages {
    /// The number of the step that was added last.
    last: u64,
    /// Number of steps that have run, and of steps whose times were added.
    run: u64,
    added: u32,
    stages: [Spread; Stage::COUNT],
    total: Spread,
}

/// Sum and largest of times.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Spread {
    sum: Duration,
    longest: Duration,
}

/// Mean and longest time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Times {
    pub mean: Duration,
    pub longest: Duration,
}

/// Times of the steps between two refreshes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct StepTimes {
    /// Number of steps.
    pub steps: u64,
    pub stages: [Times; Stage::COUNT],
    pub total: Times,
}

/// Adds the last step.
pub(super) fn sample(mut averages: ResMut<Averages>, report: Option<Res<StepReport>>) {
    if let Some(report) = report {
        averages.add(&report);
    }
}

impl Averages {
    /// Adds a step, unless it was added before.
    pub fn add(&mut self, report: &StepReport) {
        if report.step == self.last {
            return;
        }
        self.run += report.step.saturating_sub(self.last);
        self.last = report.step;
        self.added += 1;
        for (spread, &time) in self.stages.iter_mut().zip(&report.stages) {
            spread.add(time);
        }
        self.total.add(report.total);
    }

    /// Begins anew after `step`: earlier ones ran while nobody looked.
    pub fn restart(&mut self, step: u64) {
        *self = Self {
            last: step,
            ..Self::default()
        };
    }

    /// The times since the last call. `None` if no step has run.
    pub fn take(&mut self) -> Option<StepTimes> {
        let Self {
            last,
            run,
            added,
            stages,
            total,
        } = std::mem::take(self);
        self.last = last;
        (added > 0).then(|| StepTimes {
            steps: run,
            stages: stages.map(|spread| spread.times(added)),
            total: total.times(added),
        })
    }
}

impl Spread {
    fn add(&mut self, time: Duration) {
        self.sum += time;
        self.longest = self.longest.max(time);
    }

    fn times(&self, count: u32) -> Times {
        Times {
            mean: self.sum / count,
            longest: self.longest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(step: u64, millis: u64) -> StepReport {
        StepReport {
            step,
            total: Duration::from_millis(millis),
            stages: [Duration::from_millis(millis); Stage::COUNT],
            ..default()
        }
    }

    #[test]
    fn times_are_those_of_the_steps_since_the_last_call() {
        let mut averages = Averages::default();
        assert_eq!(averages.take(), None);
        for (step, millis) in [(1, 2), (2, 6), (2, 6), (4, 4)] {
            averages.add(&report(step, millis));
        }
        let times = averages.take().unwrap();
        let expected = Times {
            mean: Duration::from_millis(4),
            longest: Duration::from_millis(6),
        };
        // The third step was not seen.
        assert_eq!(times.steps, 4);
        assert_eq!((times.total, times.stages), (expected, [expected; Stage::COUNT]));

        averages.add(&report(4, 100));
        assert_eq!(averages.take(), None);
        averages.restart(9);
        averages.add(&report(10, 1));
        assert_eq!(averages.take().unwrap().steps, 1);
    }
}
