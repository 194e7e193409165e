//! Loops that use all threads of the current thread pool. On a thread outside of a pool they run on that thread alone,
//! so that small work wakes no other.

use rayon::iter::plumbing::{Producer, ProducerCallback};
use rayon::prelude::*;

/// Whether other threads can take a part of the work.
fn has_helpers() -> bool {
    rayon::current_thread_index().is_some() && rayon::current_num_threads() > 1
}

/// Number of threads that share the work.
pub(crate) fn threads() -> usize {
    match rayon::current_thread_index() {
        Some(_) => rayon::current_num_threads(),
        None => 1,
    }
}

/// Calls `f` with every item. A thread takes at least `min_items` at once.
pub(crate) fn for_each<I: IndexedParallelIterator>(items: I, min_items: usize, f: impl Fn(I::Item) + Send + Sync) {
    if has_helpers() && items.len() > min_items {
        items.with_min_len(min_items).for_each(f);
    } else {
        items.with_producer(ForEach(f));
    }
}

/// Whether `is_true` holds for every item. A thread takes at least `min_items` at once.
pub(crate) fn all<I: IndexedParallelIterator>(
    items: I,
    min_items: usize,
    is_true: impl Fn(I::Item) -> bool + Send + Sync,
) -> bool {
    if has_helpers() && items.len() > min_items {
        items.with_min_len(min_items).all(is_true)
    } else {
        items.with_producer(All(is_true))
    }
}

/// Replaces the contents of `list` by all items, in order. A thread takes at least `min_items` at once.
pub(crate) fn collect<I: IndexedParallelIterator>(items: I, min_items: usize, list: &mut Vec<I::Item>) {
    if has_helpers() && items.len() > min_items {
        items.with_min_len(min_items).collect_into_vec(list);
    } else {
        list.clear();
        items.with_producer(Append(list));
    }
}

/// Combines all items with `combine`, which must be associative.
pub(crate) fn reduce<I: IndexedParallelIterator>(
    items: I,
    identity: impl Fn() -> I::Item + Send + Sync,
    combine: impl Fn(I::Item, I::Item) -> I::Item + Send + Sync,
) -> I::Item {
    if has_helpers() && items.len() > 1 {
        items.reduce(identity, combine)
    } else {
        items.with_producer(Fold(identity(), combine))
    }
}

/// Runs both functions.
pub(crate) fn join(one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
    if has_helpers() {
        rayon::join(one, other);
    } else {
        one();
        other();
    }
}

/// Sorts by keys. The order of equal keys is not defined.
pub(crate) fn sort_unstable_by_key<T: Send, K: Ord>(list: &mut [T], key: impl Fn(&T) -> K + Sync) {
    if has_helpers() {
        list.par_sort_unstable_by_key(key);
    } else {
        list.sort_unstable_by_key(key);
    }
}

/// Sorts every run of neighbours with the same key.
pub(crate) fn sort_runs<T: Ord + Send, K: PartialEq>(list: &mut [T], key: impl Fn(&T) -> K + Send + Sync) {
    let is_same = |a: &T, b: &T| key(a) == key(b);
    if has_helpers() {
        list.par_chunk_by_mut(is_same).for_each(<[T]>::sort_unstable);
    } else {
        list.chunk_by_mut(is_same).for_each(<[T]>::sort_unstable);
    }
}

/// [`for_each`] on this thread.
struct ForEach<F>(F);

impl<T, F: Fn(T)> ProducerCallback<T> for ForEach<F> {
    type Output = ();

    fn callback<P: Producer<Item = T>>(self, producer: P) {
        producer.into_iter().for_each(self.0);
    }
}

/// [`all`] on this thread.
struct All<F>(F);

impl<T, F: Fn(T) -> bool> ProducerCallback<T> for All<F> {
    type Output = bool;

    fn callback<P: Producer<Item = T>>(self, producer: P) -> bool {
        producer.into_iter().all(self.0)
    }
}

/// [`collect`] on this thread.
struct Append<'a, T>(&'a mut Vec<T>);

impl<T> ProducerCallback<T> for Append<'_, T> {
    type Output = ();

    fn callback<P: Producer<Item = T>>(self, producer: P) {
        self.0.extend(producer.into_iter());
    }
}

/// [`reduce`] on this thread.
struct Fold<T, F>(T, F);

impl<T, F: Fn(T, T) -> T> ProducerCallback<T> for Fold<T, F> {
    type Output = T;

    fn callback<P: Producer<Item = T>>(self, producer: P) -> T {
        producer.into_iter().fold(self.0, self.1)
    }
}
