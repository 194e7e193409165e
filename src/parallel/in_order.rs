//! Parallel appending to a list, in the order of the items.

use super::loops;
use rayon::prelude::*;

/// One list per task. The lists are reused, so that a step similar to the last one allocates nothing. (rayon's
/// `par_extend` of a filtered iterator allocates new lists each time.)
pub(crate) struct InOrder<T> {
    lists: Vec<Vec<T>>,
}

impl<T> Default for InOrder<T> {
    fn default() -> Self {
        Self { lists: Vec::new() }
    }
}

impl<T: Copy + Send> InOrder<T> {
    /// Calls `add` for each of `items` in parallel, and appends to `all` what it pushes, in the order of the items.
    /// `add` gets the index of the item, the item, and the list to push to. Each task handles `task` items.
    pub fn extend<I: Sync>(
        &mut self,
        all: &mut Vec<T>,
        items: &[I],
        task: usize,
        add: impl Fn(usize, &I, &mut Vec<T>) + Sync,
    ) {
        let tasks = items.len().div_ceil(task);
        if self.lists.len() < tasks {
            self.lists.resize_with(tasks, Vec::new);
        }
        let lists = &mut self.lists[..tasks];
        let tasks = lists.par_iter_mut().zip(items.par_chunks(task)).enumerate();
        loops::for_each(tasks, 1, |(number, (list, items))| {
            list.clear();
            for (i, item) in items.iter().enumerate() {
                add(number * task + i, item, list);
            }
        });
        for list in lists {
            all.extend_from_slice(list);
        }
    }
}
