//! Boxes around runs of triangles, and around runs of such boxes, for searches while a mesh is baked.

use crate::geometry::Aabb;
use crate::geometry::cluster::compact_order;
use glam::Vec3;

/// Children per node, and items per leaf.
const WIDTH: usize = 8;

/// A box hierarchy over items: boxes around runs of eight items, then around runs of eight such boxes, and so on. It is
/// correct for any order of the items, and fast if neighbours in the list are neighbours in space.
pub struct BoxTree {
    count: usize,
    /// The items in the order of the tree; `None` if that is their own order.
    order: Option<Vec<u32>>,
    /// From the leaves up; the last level has one box.
    levels: Vec<Vec<Aabb>>,
}

impl BoxTree {
    /// A tree over items that may come in any order, by their middles and a function that gives the box of each. There
    /// must be at least one.
    pub fn of_scattered(middles: &[Vec3], around: impl Fn(usize) -> Aabb) -> Self {
        let order = compact_order(middles);
        let tree = Self::new(order.iter().map(|&item| around(item as usize)));
        Self {
            order: Some(order),
            ..tree
        }
    }

    /// A tree over items with these boxes, in this order. There must be at least one.
    pub fn new(boxes: impl IntoIterator<Item = Aabb>) -> Self {
        let boxes: Vec<Aabb> = boxes.into_iter().collect();
        let above = |boxes: &[Aabb]| -> Vec<Aabb> {
            let runs = boxes.chunks(WIDTH);
            runs.map(|run| run.iter().copied().fold(Aabb::EMPTY, Aabb::union))
                .collect()
        };
        let mut levels = vec![above(&boxes)];
        while levels[levels.len() - 1].len() > 1 {
            levels.push(above(&levels[levels.len() - 1]));
        }
        Self {
            count: boxes.len(),
            order: None,
            levels,
        }
    }

    /// Calls `found` with each item in a leaf whose box and all boxes above it are `met`. Both get `state`.
    pub fn visit<S>(&self, state: &mut S, met: impl Fn(&S, &Aabb) -> bool, mut found: impl FnMut(&mut S, usize)) {
        let mut waiting = vec![(self.levels.len() - 1, 0)];
        while let Some((level, i)) = waiting.pop() {
            if !met(state, &self.levels[level][i]) {
                continue;
            }
            let below = if level > 0 {
                self.levels[level - 1].len()
            } else {
                self.count
            };
            let children = i * WIDTH..below.min((i + 1) * WIDTH);
            if level > 0 {
                waiting.extend(children.map(|child| (level - 1, child)));
            } else {
                let item_at = |place: usize| self.order.as_ref().map_or(place, |order| order[place] as usize);
                children.for_each(|place| found(state, item_at(place)));
            }
        }
    }
}
