//! A list in two parts: what rests, which steps share, and what moves, which each step lists anew.

use std::ops::Index;
use std::sync::Arc;

/// Elements of static colliders, followed by those of others.
#[derive(Clone, Debug)]
pub(crate) struct Split<T> {
    fixed: Arc<Vec<T>>,
    moving: Vec<T>,
}

impl<T> Default for Split<T> {
    fn default() -> Self {
        Self {
            fixed: Arc::default(),
            moving: Vec::new(),
        }
    }
}

impl<T> Split<T> {
    /// Removes all.
    pub fn clear(&mut self) {
        self.moving.clear();
        match Arc::get_mut(&mut self.fixed) {
            // With the larger memory.
            Some(fixed) => {
                fixed.clear();
                if fixed.capacity() > self.moving.capacity() {
                    std::mem::swap(fixed, &mut self.moving);
                }
            }
            None => self.fixed = Arc::default(),
        }
    }

    /// What has been pushed so far is the part that rests.
    pub fn end_fixed(&mut self) {
        match Arc::get_mut(&mut self.fixed) {
            Some(fixed) => std::mem::swap(fixed, &mut self.moving),
            None => self.fixed = Arc::new(std::mem::take(&mut self.moving)),
        }
        self.moving.clear();
    }

    /// Takes the part that rests from another list, and has none that moves.
    pub fn begin_moving(&mut self, other: &Self) {
        self.fixed = Arc::clone(&other.fixed);
        self.moving.clear();
    }

    pub fn push(&mut self, element: T) {
        self.moving.push(element);
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
            Some(i) => self.moving[i] = element,
            None => {
                if let Some(fixed) = Arc::get_mut(&mut self.fixed) {
                    fixed[i] = element;
                }
            }
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = &T> + Clone {
        self.fixed.iter().chain(&self.moving)
    }

    /// Both parts.
    pub fn parts(&self) -> [&[T]; 2] {
        [&self.fixed, &self.moving]
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
