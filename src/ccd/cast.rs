//! The first touch of two meshes, one of which moves along a line without turning.
//!
//! The search is that of continuous collision detection. But where a pair of triangles would advance step by step to a
//! target distance, the caller computes in closed form when it touches. So the result has no tolerance, and meshes that
//! pass each other as closely as you like do not touch.

use super::search::{Entry, Hit, Outcome, Search, SweptMesh};
use super::triangle_pair::TargetDistance;
use super::{Pose, Scratch, Sweep};
use crate::asset::CollisionMesh;
use crate::simd::lanes::Simd;
use crate::simd::level::with_simd;
use glam::{DQuat, DVec3, Vec3};

/// Resolution of times: the meshes move by this fraction of the smaller radius. Times only give the search its order.
const TICK: f64 = 1.0e-3;

/// One mesh of a pair at the start.
pub(crate) struct Moving<'a> {
    pub mesh: &'a CollisionMesh,
    pub scale: Vec3,
    pub rotation: DQuat,
    /// Centre of mass, metres.
    pub center: DVec3,
    /// Radius of the bounding sphere around it, metres.
    pub radius: f64,
    /// Radius of the rounding, metres.
    pub rounding: f64,
}

/// Calls `touch` with pairs of triangles that may touch while the second mesh moves by `travel`, early ones first.
/// `touch` returns the fraction of the path, 0 to 1, beyond which pairs are no longer of interest.
pub(crate) fn cast([a, b]: &[Moving; 2], travel: DVec3, scratch: &mut Scratch, touch: &mut dyn FnMut([u32; 2]) -> f64) {
    let search = Search {
        meshes: [a.swept(DVec3::ZERO), b.swept(travel)],
        target: TargetDistance {
            aim: 0.0,
            reached: TICK * a.radius.min(b.radius),
        },
        span: [0.0, 1.0],
        speed: travel.length(),
    };
    with_simd!(simd => search.cast_with(simd, scratch, touch));
}

/// Where two meshes first touch.
pub(crate) struct RoundedTouch {
    /// Fraction of the path.
    pub time: f64,
    /// On the first surface.
    pub point: DVec3,
    /// From the first mesh to the second.
    pub normal: DVec3,
    /// `None` if they are within the tolerance at the start.
    pub triangles: Option<[u32; 2]>,
}

/// Tolerance of a rounded cast, in units of the smaller radius.
const TOLERANCE: f64 = 1.0e-6;

/// Where two meshes, apart at the start and at least one of them rounded, first touch while the second moves by
/// `travel`.
pub(crate) fn cast_rounded([a, b]: &[Moving; 2], travel: DVec3, scratch: &mut Scratch) -> Option<RoundedTouch> {
    let (rounding, tolerance) = (a.rounding + b.rounding, TOLERANCE * a.radius.min(b.radius));
    let search = Search {
        meshes: [a.swept(DVec3::ZERO), b.swept(travel)],
        target: TargetDistance {
            aim: rounding + 0.5 * tolerance,
            reached: rounding + tolerance,
        },
        span: [0.0, 1.0],
        speed: travel.length(),
    };
    let hit = match search.run(scratch) {
        Outcome::Hit(hit) => hit,
        Outcome::InitiallyClose => Hit {
            time: 0.0,
            triangles: None,
        },
        Outcome::Apart => return None,
    };
    let [point, normal] = search.contact(&hit).unwrap_or_default();
    Some(RoundedTouch {
        time: hit.time,
        point,
        normal,
        triangles: hit.triangles,
    })
}

impl<'a> Moving<'a> {
    fn swept(&self, travel: DVec3) -> SweptMesh<'a> {
        let before = Pose {
            center: self.center,
            rotation: self.rotation,
        };
        SweptMesh {
            mesh: self.mesh,
            sweep: Sweep {
                travel,
                ..Sweep::at_rest(before)
            },
            scale: self.scale,
            offset: DVec3::ZERO,
            radius: self.radius,
            rounding: self.rounding,
        }
    }
}

impl Search<'_> {
    #[inline(always)]
    fn cast_with<S: Simd>(&self, simd: S, scratch: &mut Scratch, touch: &mut dyn FnMut([u32; 2]) -> f64) {
        let queue = &mut scratch.queue;
        let [start, mut end] = self.span;
        let mut placement = self.placement(simd, self.relative(start));
        queue.clear();
        queue.push(self.roots(start));
        while let Some(entry) = queue.pop() {
            if entry.time > end {
                continue;
            }
            if entry.level == [0, 0] {
                end = end.min(touch(entry.number));
                continue;
            }
            if placement.relative.time != entry.time {
                placement = self.placement(simd, self.relative(entry.time));
            }
            let mut add = |next: Entry, safe_time: f64| {
                let time = entry.time + safe_time;
                if time <= end {
                    queue.push(Entry {
                        time,
                        tick: self.tick(time),
                        ..next
                    });
                }
            };
            self.advance(simd, &entry, &placement, &mut add);
        }
    }
}
