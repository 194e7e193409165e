//! A list in two parts, of what rests and of what moves. Steps share each part for as long as it stays the same.

use std::ops::Index;
use std::sync::Arc;

/// Elements of static colliders, followed by elements of others.
#[derive(Clone, Debug)]
pub(crate) struct Split<T> {
    fixed: Arc<Vec<T>>,
    moving: Arc<Vec<T>>,
    /// What has been pushed and belongs to neither yet.
    open: Vec<T>,
}

impl<T> Default for Split<T> {
    fn default() -> Self {
        Self {
            fixed: Arc::default(),
            moving: Arc::default(),
            open: Vec::new(),
        }
    }
}

impl<T: Clone> Split<T> {
    /// Removes all.
    pub fn clear(&mut self) {
        empty(&mut self.fixed);
        empty(&mut self.moving);
        self.open.clear();
    }

    /// What has been pushed so far is the part that rests.
    pub fn end_fixed(&mut self) {
        close(&mut self.open, &mut self.fixed);
    }

    /// What has been pushed since then is the part that moves. Until this call it is not there.
    pub fn end_moving(&mut self) {
        close(&mut self.open, &mut self.moving);
    }

    /// Takes the part that rests from another list, and has none that moves.
    pub fn begin_moving(&mut self, other: &Self) {
        self.fixed = Arc::clone(&other.fixed);
        empty(&mut self.moving);
        self.open.clear();
    }

    pub fn push(&mut self, element: T) {
        self.open.push(element);
    }

    /// Opens the part that moves again, without its elements from this index of the whole list on.
    pub fn reopen(&mut self, len: usize) {
        let left = len.saturating_sub(self.fixed.len());
        self.open.clear();
        self.open.extend_from_slice(&self.moving[..left]);
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

/// Makes a list of what has been pushed. It keeps the memory of both if no other has it.
fn close<T>(open: &mut Vec<T>, list: &mut Arc<Vec<T>>) {
    match Arc::get_mut(list) {
        Some(own) => std::mem::swap(own, open),
        None => *list = Arc::new(std::mem::take(open)),
    }
    open.clear();
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
        one.end_moving();
        let mut other = Split::default();
        other.push(7);
        other.begin_moving(&one);
        assert_eq!(other.iter().copied().collect::<Vec<_>>(), [1, 2]);
        [4, 5].into_iter().for_each(|x| other.push(x));
        other.end_moving();
        assert_eq!((other[1], other[3], other.len(), other.get(4)), (2, 5, 4, None));
        assert_eq!(one.iter().copied().collect::<Vec<_>>(), [1, 2, 3]);
        let mut third = other.clone();
        third.reopen(3);
        third.push(6);
        third.end_moving();
        assert_eq!(third.iter().copied().collect::<Vec<_>>(), [1, 2, 4, 6]);
        assert_eq!(other.iter().copied().collect::<Vec<_>>(), [1, 2, 4, 5]);
        one.clear();
        assert_eq!((one.len(), other.len()), (0, 4));
    }
}
