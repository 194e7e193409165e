//! The order in which the bodies of an island are eliminated, and which blocks that fills.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The blocks of a lower triangular matrix, column by column.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Pattern {
    /// The place of each body in the order.
    pub place: Vec<u32>,
    /// For each place, the later places with a block in its column, ascending.
    pub columns: Vec<Vec<u32>>,
}

impl Pattern {
    /// The pattern for `count` bodies, of which these `pairs` are in contact; `None` if more than `most` products of
    /// blocks were needed to factorise it.
    ///
    /// Bodies with the fewest neighbours are eliminated first (minimum degree), so a tree has no fill.
    pub fn new(count: usize, pairs: impl Iterator<Item = [u32; 2]>, most: usize) -> Option<Self> {
        let mut neighbors = vec![Vec::<u32>::new(); count];
        for [a, b] in pairs {
            neighbors[a as usize].push(b);
            neighbors[b as usize].push(a);
        }
        for list in &mut neighbors {
            list.sort_unstable();
            list.dedup();
        }
        let mut queue: BinaryHeap<_> = (0..count as u32)
            .map(|body| Reverse((neighbors[body as usize].len(), body)))
            .collect();
        let mut place = vec![u32::MAX; count];
        let mut columns = Vec::with_capacity(count);
        let mut products = 0;
        while let Some(Reverse((degree, body))) = queue.pop() {
            if place[body as usize] != u32::MAX || degree != neighbors[body as usize].len() {
                continue;
            }
            place[body as usize] = columns.len() as u32;
            products += degree * (degree + 1) / 2;
            if products > most {
                return None;
            }
            let own = std::mem::take(&mut neighbors[body as usize]);
            for &other in &own {
                let list = &mut neighbors[other as usize];
                list.retain(|&it| it != body);
                list.extend(own.iter().filter(|&&it| it != other));
                list.sort_unstable();
                list.dedup();
                queue.push(Reverse((list.len(), other)));
            }
            columns.push(own);
        }
        for column in &mut columns {
            for body in column.iter_mut() {
                *body = place[*body as usize];
            }
            column.sort_unstable();
        }
        Some(Self { place, columns })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fill(count: usize, pairs: &[[u32; 2]]) -> usize {
        let pattern = Pattern::new(count, pairs.iter().copied(), usize::MAX).unwrap();
        let mut places = pattern.place.clone();
        places.sort_unstable();
        assert!(places.into_iter().eq(0..count as u32), "a permutation");
        for [a, b] in pairs.iter().map(|pair| pair.map(|body| pattern.place[body as usize])) {
            assert!(pattern.columns[a.min(b) as usize].contains(&a.max(b)));
        }
        pattern.columns.iter().map(Vec::len).sum::<usize>() - pairs.len()
    }

    #[test]
    fn chains_and_trees_have_no_fill_and_a_ring_little() {
        let chain: Vec<_> = (0..99).map(|i| [i, i + 1]).collect();
        assert_eq!(fill(100, &chain), 0);
        let tree: Vec<_> = (1..100).map(|i| [(i - 1) / 3, i]).collect();
        assert_eq!(fill(100, &tree), 0);
        let ring: Vec<_> = (0..100).map(|i| [i, (i + 1) % 100]).collect();
        assert_eq!(fill(100, &ring), 97);
    }

    #[test]
    fn what_costs_too_much_has_no_pattern() {
        let all: Vec<_> = (0..30).flat_map(|a| (0..a).map(move |b| [a, b])).collect();
        assert!(Pattern::new(30, all.iter().copied(), 4000).is_none());
        assert!(Pattern::new(30, all.iter().copied(), 5000).is_some());
    }
}
