//! A list in two parts, of what rests and of what moves. Steps share each part for as long as it stays the same.

use std::ops::Index;
use std::sync::Arc;

/// Elements of static colliders, followed by those of others.
#[derive(Clone, Debug)]
pub(crate) struct Split<T> {
    fixed: Arc<Vec<T>>,
    moving: Arc<Vec<T>>,
}

impl<T> Default for Split<T> {
    fn default() -> Self {
        Self {
            fixed: Arc::default(),
            moving: Arc::default(),
        }
    }
}

impl<T: Clone> Split<T> {
    /// Removes all.
    pub fn clear(&mut self) {
        empty(&mut self.fixed);
        empty(&mut self.moving);
        // The next elements go to the larger memory.
        if self.fixed.capacity() > self.moving.capacity() {
            std::mem::swap(&mut self.fixed, &mut self.moving);
        }
    }

    /// What has been pushed so far is the part that rests.
    pub fn end_fixed(&mut self) {
        std::mem::swap(&mut self.fixed, &mut self.moving);
        empty(&mut self.moving);
    }

    /// Takes the part that rests from another list, and has none that moves.
    pub fn begin_moving(&mut self, other: &Self) {
        self.fixed = Arc::clone(&other.fixed);
        empty(&mut self.moving);
    }

    pub fn push(&mut self, element: T) {
        Arc::make_mut(&mut self.moving).push(element);
    }

    /// Removes all elements from this index on, which are of what moves.
    pub fn truncate(&mut self, len: usize) {
        Arc::make_mut(&mut self.moving).truncate(len.saturating_sub(self.fixed.len()));
    }

    pub fn len(&self) -> usize {
        self.fixed.len() + self.moving.len()
    }

    pub fn get(&self, i: usize) -> Option<&T> {
        match i.checked_sub(self.fixed.len()) {
            None => self.fixed.get(i),
            Some(i) => self.moving.get(i),
        }
    }

    /// Replaces an element. One that rests must not be shared yet.
    pub fn set(&mut self, i: usize, element: T) {
        match i.checked_sub(self.fixed.len()) {
            Some(i) => Arc::make_mut(&mut self.moving)[i] = element,
            None => {
                if let Some(fixed) = Arc::get_mut(&mut self.fixed) {
                    fixed[i] = element;
                }
            }
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = &T> + Clone {
        self.fixed.iter().chain(self.moving.iter())
    }

    /// Both parts.
    pub fn parts(&self) -> [&[T]; 2] {
        [&self.fixed, &self.moving]
    }
}

/// Empties a list, and keeps its memory if no other has it.
fn empty<T>(list: &mut Arc<Vec<T>>) {
    match Arc::get_mut(list) {
        Some(own) => own.clear(),
        None => *list = Arc::default(),
    }
}

impl<T> Index<usize> for Split<T> {
    type Output = T;

    fn index(&self, i: usize) -> &T {
        match i.checked_sub(self.fixed.len()) {
            None => &self.fixed[i],
            Some(i) => &self.moving[i],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_share_what_rests() {
        let mut one = Split::default();
        [1, 2].into_iter().for_each(|x| one.push(x));
        one.end_fixed();
        one.push(3);
        let mut other = Split::default();
        other.push(7);
        other.begin_moving(&one);
        assert_eq!(other.iter().copied().collect::<Vec<_>>(), [1, 2]);
        [4, 5].into_iter().for_each(|x| other.push(x));
        assert_eq!((other[1], other[3], other.len(), other.get(4)), (2, 5, 4, None));
        assert_eq!(one.iter().copied().collect::<Vec<_>>(), [1, 2, 3]);
        one.clear();
        assert_eq!((one.len(), other.len()), (0, 4));
    }
}
