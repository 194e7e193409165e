//! A box tree over the meshes of a scene.

use crate::geometry::Aabb;
use crate::geometry::cluster::compact_order;
use crate::geometry::lanes::{BoxGroup, box_levels};
use crate::queries::placed::Placed;
use crate::simd::bounds::{Boxes, Near, Swept};
use crate::simd::level::with_simd;
use crate::simd::levels::visit_nearest;
use glam::{DVec3, Vec3};

/// An axis-aligned box in the world, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorldBox {
    pub center: DVec3,
    pub half: DVec3,
}

/// A tree over boxes. It works in single precision relative to its own origin, and allows for the rounding error.
#[derive(Default)]
pub(super) struct Tree {
    origin: DVec3,
    /// Half the diagonal of all boxes, metres.
    radius: f64,
    /// The numbers of the boxes in the order of the tree.
    order: Vec<u32>,
    levels: Vec<Vec<BoxGroup>>,
    /// The spread when the order was found.
    spread: Spread,
}

/// How large the boxes of the levels above the lowest are. The boxes of the lowest level do not depend on the order.
#[derive(Clone, Copy, Default)]
struct Spread {
    /// Mean half diagonal, metres.
    size: f32,
    /// Half the diagonal of all boxes, metres.
    all: f32,
}

/// The order is found anew if the mean box has grown by more than this factor since, or by as much relative to the
/// tree.
const MAX_SPREAD: f32 = 1.3;
/// Queries count as no farther away than this many times the size of the tree.
const FAR: f64 = 1000.0;

impl WorldBox {
    /// The box of one point.
    pub fn point(center: DVec3) -> Self {
        let half = DVec3::ZERO;
        Self { center, half }
    }

    /// See [`Placed::outer_box`].
    pub fn of(mesh: &Placed) -> Self {
        let [center, half] = mesh.outer_box();
        Self { center, half }
    }

    /// From least and largest coordinates.
    pub fn between([low, high]: [DVec3; 2]) -> Self {
        Self {
            center: 0.5 * (low + high),
            half: 0.5 * (high - low),
        }
    }
}

impl Spread {
    fn is_like(&self, first: &Self) -> bool {
        let limit = MAX_SPREAD * first.size;
        self.size <= limit && self.size * first.all <= limit * self.all
    }
}

impl Tree {
    /// A tree over boxes. It takes over the order of `last`, a tree over the same boxes at other places, if that is
    /// still good.
    pub fn new(boxes: &[WorldBox], last: Option<&Self>) -> Self {
        if boxes.is_empty() {
            return Self::default();
        }
        let (low, high) = (boxes.iter()).fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), b| {
            (low.min(b.center - b.half), high.max(b.center + b.half))
        });
        let all = WorldBox::between([low, high]);
        let (origin, radius) = (all.center, all.half.length());
        let centers: Vec<Vec3> = boxes.iter().map(|b| (b.center - origin).as_vec3()).collect();
        let aabb = |&number: &u32| {
            let (center, half) = (centers[number as usize], boxes[number as usize].half.as_vec3());
            Aabb {
                min: center - half,
                max: center + half,
            }
        };
        let in_order = |order: Vec<u32>| {
            let (levels, sizes) = box_levels(order.iter().map(aabb).collect());
            let spread = Spread {
                size: sizes.get(1).copied().unwrap_or_default(),
                all: radius as f32,
            };
            Self {
                origin,
                radius,
                order,
                levels,
                spread,
            }
        };
        let kept = last.filter(|last| last.order.len() == boxes.len()).and_then(|last| {
            let tree = in_order(last.order.clone());
            let spread = last.spread;
            tree.spread.is_like(&spread).then_some(Self { spread, ..tree })
        });
        kept.unwrap_or_else(|| in_order(compact_order(&centers)))
    }

    /// Upper bound of the rounding error of a coordinate, if those asked for are within `size` of the origin.
    fn error(&self, size: f64) -> f32 {
        8.0 * f32::EPSILON * (self.radius + size) as f32
    }

    /// Calls `visit` with the numbers of the boxes that a moving box may meet, nearer ones first. It returns the
    /// distance up to which to go on; minus infinity ends the visit. The box moves from `start` along the unit vector
    /// `way`.
    pub fn along(&self, start: WorldBox, way: DVec3, most: f64, visit: &mut dyn FnMut(u32) -> f64) {
        if self.order.is_empty() {
            return;
        }
        // The search begins at the sphere around the tree, so that single precision is enough, however far away the box
        // starts.
        let to_origin = self.origin - start.center;
        let middle = to_origin.dot(way);
        let radius = (self.radius + start.half.length()) * (1.0 + 1.0e-6);
        let (enter, leave) = ((middle - radius).max(0.0), middle + radius);
        let apart = (to_origin - middle * way).length();
        let rounding = 1.0e-12 * to_origin.length();
        if leave < 0.0 || enter > most || apart > radius + rounding {
            return;
        }
        let error = self.error(2.0 * radius) + rounding as f32;
        let limit = |most: f64| ((most.min(leave) - enter) * (1.0 + 1.0e-6)) as f32 + error;
        let from = way * enter - to_origin;
        with_simd!(simd => {
            let swept = Swept::new(simd, from, start.half, way.as_vec3(), error);
            visit_nearest(
                &self.levels,
                limit(most),
                #[inline(always)]
                |group, most| swept.bounds(&Boxes::of(simd, group), most),
                |_| {},
                #[inline(always)]
                |leaf| limit(visit(self.order[leaf as usize])),
            );
        });
    }

    /// Calls `visit` with the numbers of the boxes that may be within `most` metres of another one, nearer ones first.
    /// It returns the distance up to which to go on; minus infinity ends the visit.
    pub fn around(&self, near: WorldBox, most: f64, visit: &mut dyn FnMut(u32) -> f64) {
        if self.order.is_empty() {
            return;
        }
        // A box far away is moved nearer, so that single precision is enough. All distances shrink by that way, but for
        // a part of the size: b² / 2x if it is then x away, and what it is near to is up to b beside the way.
        let apart = near.center - self.origin;
        let size = self.radius + near.half.length();
        let outside = (apart.length() - FAR * size).max(0.0);
        let shortfall = if outside > 0.0 { size / FAR } else { 0.0 };
        let from = apart - outside * apart.normalize_or_zero();
        let error = self.error(from.length() + near.half.length());
        let limit = |most: f64| {
            let inside = most - outside + shortfall;
            if inside < 0.0 {
                f32::NEG_INFINITY
            } else {
                inside.min(1.0e30) as f32 * (1.0 + 1.0e-6) + error
            }
        };
        with_simd!(simd => {
            let near = Near::new(simd, from, near.half, error);
            visit_nearest(
                &self.levels,
                limit(most),
                #[inline(always)]
                |group, most| near.bounds(&Boxes::of(simd, group), most),
                |_| {},
                #[inline(always)]
                |leaf| limit(visit(self.order[leaf as usize])),
            );
        });
    }
}
