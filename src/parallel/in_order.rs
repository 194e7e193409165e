//! Lists that threads fill side by side and that are joined in order.

use rayon::prelude::*;

/// A list for each task; memory is kept, so that a step like the last one allocates nothing. (rayon's `par_extend` of a
/// filtered iterator gathers new lists each time.)
pub(crate) struct InOrder<T> {
    lists: Vec<Vec<T>>,
}

impl<T> Default for InOrder<T> {
    fn default() -> Self {
        Self { lists: Vec::new() }
    }
}

impl<T: Copy + Send> InOrder<T> {
    /// Appends to `all` what `add` pushes for each of `items`, which it gets with their numbers, in their order. `task` items
    /// go to a thread at once.
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
        lists
            .par_iter_mut()
            .zip(items.par_chunks(task))
            .enumerate()
            .for_each(|(number, (list, items))| {
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
