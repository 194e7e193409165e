//! Saved impulses in the layout of the device, and back. They let a simulation move between the CPU and a device.

use super::layout;
use crate::solver::warm_start::{SavedPair, SavedPoint, WarmStart, sorted};
use crate::state::Manifolds;
use glam::{Quat, Vec3};

impl WarmStart {
    /// The saved pairs and points for a device. There is one pair for each of `manifolds`, with the same points.
    /// `key_of` gives the key of a body by its number.
    pub(crate) fn to_device(
        &self,
        manifolds: &Manifolds,
        key_of: impl Fn(u32) -> u64,
    ) -> (Vec<layout::SavedPair>, Vec<layout::SavedPoint>) {
        let mut points = vec![layout::SavedPoint::default(); manifolds.points.len()];
        let pairs = manifolds.pairs.iter().map(|manifold| {
            let [a, b] = manifold.bodies;
            let mut saved = layout::SavedPair {
                a,
                b,
                first: manifold.first_point,
                ..Default::default()
            };
            let last = self
                .find([a, b].map(&key_of))
                .filter(|last| last.points.len() == manifold.point_count as usize);
            if let Some(last) = last {
                saved.count = manifold.point_count;
                saved.separating_direction = last.pair.separating_direction.to_array();
                saved.depenetrating = u32::from(last.pair.depenetrating);
                saved.substep = last.pair.substep;
                [saved.rotation_a, saved.rotation_b] = last.pair.rotations.map(|rotation| rotation.to_array());
                let range = manifold.first_point as usize..(manifold.first_point + manifold.point_count) as usize;
                for (to, from) in points[range].iter_mut().zip(last.points) {
                    *to = (*from).into();
                }
            }
            saved
        });
        (pairs.collect(), points)
    }

    /// The impulses that a device has saved. `key_of` gives the key of a body by its number.
    pub(crate) fn from_device(
        pairs: &[layout::SavedPair],
        points: &[layout::SavedPoint],
        key_of: impl Fn(u32) -> Option<u64>,
    ) -> Self {
        let exist = |pair: &&layout::SavedPair| pair.count > 0 && (pair.first + pair.count) as usize <= points.len();
        let mut pairs: Vec<SavedPair> = pairs
            .iter()
            .filter(exist)
            .filter_map(|pair| {
                let keys = [key_of(pair.a)?, key_of(pair.b)?];
                Some(SavedPair {
                    keys: sorted(keys),
                    first: pair.first,
                    count: pair.count,
                    substep: pair.substep,
                    flipped: sorted(keys) != keys,
                    depenetrating: pair.depenetrating != 0,
                    separating_direction: pair.separating_direction.into(),
                    rotations: [pair.rotation_a, pair.rotation_b].map(Quat::from_array),
                })
            })
            .collect();
        pairs.sort_unstable_by_key(|pair| (pair.keys, pair.first));
        Self {
            pairs,
            points: points.iter().map(SavedPoint::from).collect(),
        }
    }
}

impl From<SavedPoint> for layout::SavedPoint {
    fn from(point: SavedPoint) -> Self {
        Self {
            anchor_a: point.anchors[0].to_array(),
            normal_impulse: point.normal_impulse,
            anchor_b: point.anchors[1].to_array(),
            normal: point.normal.to_array(),
            friction_impulse: point.friction_impulse.to_array(),
            ..Default::default()
        }
    }
}

impl From<&layout::SavedPoint> for SavedPoint {
    fn from(point: &layout::SavedPoint) -> Self {
        Self {
            anchors: [point.anchor_a, point.anchor_b].map(Vec3::from),
            normal: point.normal.into(),
            normal_impulse: point.normal_impulse,
            friction_impulse: point.friction_impulse.into(),
        }
    }
}
