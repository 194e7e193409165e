//! Shards: parts of a library, baked by different processes or machines.

use bevy_faceoff::asset::format;
use serde::Serialize;
use std::env;
use std::num::NonZeroU64;
use std::str::FromStr;

/// One of several parts of a library.
///
/// Which part a mesh belongs to follows from its path alone, through a hash. So shards that start at different times
/// agree although meshes were added in between: none is baked twice or missed. Shares by position in the list would be
/// more even, but each new file would move all files after it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shard {
    /// From 1 to `count`.
    index: u64,
    count: NonZeroU64,
}

impl Shard {
    /// Whether the entry of this key belongs to this part. What has no key belongs to all.
    pub fn holds(self, key: &str) -> bool {
        let [a, b, c, d, e, f, g, h, ..] = format::source_hash(key.as_bytes());
        key.is_empty() || u64::from_le_bytes([a, b, c, d, e, f, g, h]) % self.count == self.index - 1
    }

    fn new(index: u64, count: NonZeroU64) -> Result<Self, String> {
        if (1..=count.get()).contains(&index) {
            Ok(Self { index, count })
        } else {
            Err(format!(
                "shards of {count} are counted from 1/{count} to {count}/{count}"
            ))
        }
    }
}

impl FromStr for Shard {
    type Err = String;

    /// Parses `I/N`, `auto` or `auto/N`. The latter two read variables of the environment.
    fn from_str(text: &str) -> Result<Self, String> {
        let (index, count) = match text.split_once('/') {
            Some((index, count)) => {
                let count: NonZeroU64 = count.parse().map_err(|_| usage())?;
                (index, Some(count))
            }
            None => (text, None),
        };
        match (index, count) {
            ("auto", count) => automatic(count),
            (index, Some(count)) => Self::new(index.parse().map_err(|_| usage())?, count),
            (_, None) => Err(usage()),
        }
    }
}

fn usage() -> String {
    "give I/N, such as 1/4, or auto or auto/N in an array of Slurm or an indexed job of Kubernetes".into()
}

/// The shard of this task of an array. It is used only if asked for: an array may as well bake a library per task.
fn automatic(count: Option<NonZeroU64>) -> Result<Shard, String> {
    match (number(SLURM_ID)?, number(KUBERNETES_INDEX)?) {
        (Some(_), Some(_)) => Err(format!("both {SLURM_ID} and {KUBERNETES_INDEX} are set: give I/N")),
        (Some(id), None) => slurm(id, count),
        (None, Some(index)) => match count {
            Some(count) => Shard::new(index.saturating_add(1), count)
                .map_err(|_| format!("{KUBERNETES_INDEX} is {index}, but must be less than {count}: give auto/N with the completions of the job as N")),
            None => Err(format!(
                "{KUBERNETES_INDEX} is set, but Kubernetes does not tell the number of tasks: give auto/N with the completions of the job as N"
            )),
        },
        (None, None) => Err(format!("neither {SLURM_ID} nor {KUBERNETES_INDEX} is set: give I/N")),
    }
}

const SLURM_ID: &str = "SLURM_ARRAY_TASK_ID";
const KUBERNETES_INDEX: &str = "JOB_COMPLETION_INDEX";

/// The ids of an array need not begin with 0, but must have equal steps: else the place of one is unknown.
fn slurm(id: u64, wanted: Option<NonZeroU64>) -> Result<Shard, String> {
    let need = |name: &str| number(name)?.ok_or_else(|| format!("{name} is not set, but {SLURM_ID} is: give I/N"));
    let min = need("SLURM_ARRAY_TASK_MIN")?;
    let count = NonZeroU64::new(need("SLURM_ARRAY_TASK_COUNT")?).ok_or("SLURM_ARRAY_TASK_COUNT is 0: give I/N")?;
    let step = number("SLURM_ARRAY_TASK_STEP")?.unwrap_or(1).max(1);
    if let Some(wanted) = wanted.filter(|wanted| *wanted != count) {
        return Err(format!(
            "the array has {count} tasks, not {wanted}: give auto alone, or I/N to run single tasks again"
        ));
    }
    let place = |id: u64| {
        id.checked_sub(min)
            .filter(|from| from % step == 0)
            .map(|from| from / step)
    };
    let last = number("SLURM_ARRAY_TASK_MAX")?.map(place);
    match place(id) {
        Some(place) if place < count.get() && last.is_none_or(|last| last == Some(count.get() - 1)) => {
            Shard::new(place + 1, count)
        }
        _ => Err(format!(
            "the array of {count} tasks from {min} has gaps, or no task {id}: use an array such as --array=1-{count}, or give I/N"
        )),
    }
}

/// The value of a variable, if it is set.
fn number(name: &str) -> Result<Option<u64>, String> {
    match env::var(name) {
        Err(env::VarError::NotPresent) => Ok(None),
        Ok(text) => text
            .trim()
            .parse()
            .map(Some)
            .map_err(|_| format!("{name} is {text:?}, not a number")),
        Err(error) => Err(format!("{name}: {error}")),
    }
}
