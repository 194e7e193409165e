//! Contact springs that hold their loads.
//!
//! A contact gives way by a distance that is proportional to its load, and to the square of the length of a substep. A
//! heavy body on a light one would press it flat. An island that can be solved directly gets stiffer springs. Passes
//! would not converge with these, so another island gets more substeps: springs of shorter substeps are stiffer.

use super::batch::{Batches, PointLanes, RowLanes};
use super::colors::LANES;
use super::constraints::BundlesMut;
use super::contact::Pair;
use super::direct::{Direct, DirectIslands};
use super::group::Group;
use super::pace::Pace;
use super::prepare::Source;
use crate::geometry::lanes::Stored;
use crate::simd::lanes::lane_of;
use glam::Vec3;
use std::f32::consts::TAU;

/// A contact at rest may give way by this fraction of D: a little more than the gap that it keeps.
pub(super) const MAX_COMPRESSION: f32 = 0.0007;
/// Springs that would give way by more than this multiple of what they may are under a heavy load. More substeps are
/// better for lighter ones: stiff springs make small bodies rock.
pub(super) const HEAVY: f32 = 32.0;
/// An island that is solved directly may have stiffer springs: they give way by this part of it.
pub(super) const SPARE: f32 = 8.0;
/// Largest factor on the number of substeps.
pub(super) const MAX_FACTOR: f32 = 16.0;
/// The impulse of a point counts up to this multiple of the impulse that its pair transmits.
///
/// The rest is stress between two wedged bodies, which push both ways at different points. Stress moves nothing and can
/// be arbitrarily large. Levers, as a peg in a hole, count in full up to this ratio.
pub(super) const MAX_STRESS: f32 = 10.0;
/// A pair with an immovable body that overlaps by more than this fraction of D does not count: the body was placed
/// there or is squeezed. Stiffer springs would only squeeze it with more force.
pub(super) const SQUEEZED: f32 = 0.01;
/// Points times factor of an island.
pub(super) const POINT_BUDGET: f32 = 2000.0;

/// Makes the springs of a bundle's islands hold their loads: those of islands that can be solved directly become
/// stiffer. Returns factors on the number of substeps of the islands, for others that need it. The islands have these
/// paces and numbers of points, and the points have the impulses of the last collision substep.
pub(super) fn hold(
    bundle: &mut BundlesMut,
    group: &Group,
    point_counts: &[u32; LANES],
    source: &Source,
    pace: Pace,
    direct: &mut DirectIslands,
) -> [u32; LANES] {
    let h = pace.h();
    let loads = Loads {
        stiffness: (TAU * source.settings.frequency / h).powi(2),
        gravity: source.gravity,
        h,
    };
    let mut compressions = [0.0f32; LANES];
    loads.for_each_pair(bundle, |_, lane, compression| {
        let of_island = &mut compressions[group.island(lane)];
        *of_island = of_island.max(compression);
    });
    let mut stiffer = 0u32;
    for (island, compression) in compressions.iter_mut().enumerate().filter(|(_, it)| **it > HEAVY) {
        let lane = group.is_side_by_side().then_some(island);
        if direct.add(island, Direct::new(bundle.batches, &bundle.states, lane, true)) {
            stiffer |= 1 << island;
            *compression = 1.0;
        }
    }
    if stiffer != 0 {
        loads.for_each_pair(bundle, |pair, lane, compression| {
            if stiffer >> group.island(lane) & 1 == 1 && compression > 1.0 {
                pair.softness /= compression * SPARE;
            }
        });
        bundle.load_constraints(group);
    }
    std::array::from_fn(|island| {
        let most = (POINT_BUDGET / point_counts[island] as f32).clamp(1.0, MAX_FACTOR);
        compressions[island].sqrt().clamp(1.0, most).ceil() as u32
    })
}

/// What loads depend on besides their pair.
struct Loads {
    /// Acceleration of a contact spring per metre, 1/s^2.
    stiffness: f32,
    gravity: Vec3,
    /// Length of a substep, seconds.
    h: f32,
}

impl Loads {
    /// Calls `f` with each pair that is not in deep penetration, its lane, and how far its springs give way, over how
    /// far they may.
    fn for_each_pair(&self, bundle: &mut BundlesMut, mut f: impl FnMut(&mut Pair, usize, f32)) {
        let mut pairs = bundle.pairs.iter_mut();
        for (batch, points) in Batches::new(bundle.batches, bundle.lanes) {
            for (lane, pair) in pairs.by_ref().take(batch.pairs).enumerate() {
                if pair.depenetrating {
                    continue;
                }
                let masses = pair.slots.map(|slot| &bundle.states.masses[slot as usize]);
                let inverse_masses = masses.map(|mass| mass.inverse_mass.max_element());
                let compression = self.compression(pair, inverse_masses, points, lane);
                f(pair, lane, compression);
            }
        }
    }

    /// How far the springs of the pair in a lane give way under their loads, over how far they may.
    fn compression(&self, pair: &Pair, inverse_masses: [f32; 2], points: &[PointLanes], lane: usize) -> f32 {
        let squeezed = |point: &PointLanes| point.separation.0[lane] < -SQUEEZED * pair.diameter;
        if inverse_masses.contains(&0.0) && valid_points(points, lane).any(squeezed) {
            return 0.0;
        }
        let compression = self.compression_by(pair, inverse_masses, points, lane, f32::INFINITY);
        // Nearly all pairs: their loads ask for no shorter substeps, whatever part of them is stress.
        if compression <= 1.0 {
            return compression;
        }
        let most_impulse = MAX_STRESS * transmitted_impulse(points, lane).length();
        self.compression_by(pair, inverse_masses, points, lane, most_impulse)
    }

    /// [`Loads::compression`] by impulses that count up to `most_impulse`.
    fn compression_by(
        &self,
        pair: &Pair,
        inverse_masses: [f32; 2],
        points: &[PointLanes],
        lane: usize,
        most_impulse: f32,
    ) -> f32 {
        let of = |point: &PointLanes| {
            // Acceleration of the bodies by the load.
            let impulse = point.normal_impulse.0[lane].min(most_impulse);
            let load = if impulse > 0.0 {
                impulse * point.inverse_effective_mass[0].0[lane] / self.h
            } else if !pair.known && point.separation.0[lane] <= pair.rest_offset {
                // The load is not known yet. The upper body rests on the lower one with at least its own weight.
                let down = -lane_of(&point.rows[0].direction, lane).dot(self.gravity);
                let upper = usize::from(down > 0.0);
                let weight = down.abs() / inverse_masses[upper];
                if weight.is_finite() {
                    weight * (inverse_masses[0] + inverse_masses[1])
                } else {
                    0.0
                }
            } else {
                0.0
            };
            load * pair.softness / (self.stiffness * MAX_COMPRESSION * pair.diameter)
        };
        valid_points(points, lane).map(of).fold(0.0, f32::max)
    }
}

/// The sum of the impulses of the pair in a lane.
fn transmitted_impulse(points: &[PointLanes], lane: usize) -> Vec3 {
    let of = |point: &PointLanes| {
        let [first, second] = &point.friction_impulse;
        let impulses = [&point.normal_impulse, first, second];
        let along = |(row, impulse): (&RowLanes, &Stored)| lane_of(&row.direction, lane) * impulse.0[lane];
        point.rows.iter().zip(impulses).map(along).sum::<Vec3>()
    };
    valid_points(points, lane).map(of).sum()
}

fn valid_points(points: &[PointLanes], lane: usize) -> impl Iterator<Item = &PointLanes> {
    points.iter().filter(move |point| point.valid >> lane & 1 == 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The compression of a pair of two points with these normals and the same impulse.
    fn compression(normals: [Vec3; 2]) -> f32 {
        let point = |normal: Vec3| {
            let mut point = PointLanes {
                valid: 1,
                ..Default::default()
            };
            for (lanes, x) in point.rows[0].direction.iter_mut().zip(normal.to_array()) {
                lanes.0[0] = x;
            }
            point.normal_impulse.0[0] = 1.0;
            point.inverse_effective_mass[0].0[0] = 1.0;
            point
        };
        let pair = Pair {
            diameter: 1.0,
            softness: 1.0,
            ..Default::default()
        };
        let loads = Loads {
            stiffness: 1.0e4,
            gravity: Vec3::ZERO,
            h: 1.0e-3,
        };
        loads.compression(&pair, [1.0, 1.0], &normals.map(point), 0)
    }

    #[test]
    fn what_a_pair_transmits_counts_and_stress_within_it_does_not() {
        let all = compression([Vec3::Y, Vec3::Y]);
        assert!(all > 100.0, "{all}");
        assert_eq!(compression([Vec3::Y, Vec3::X]), all, "two walls of a groove");
        assert_eq!(
            compression([Vec3::Y, Vec3::new(0.2, -0.979_795_9, 0.0)]),
            all,
            "a lever"
        );
        assert_eq!(compression([Vec3::Y, -Vec3::Y]), 0.0, "a wedge");
        let nearly = compression([Vec3::Y, Vec3::new(0.02, -0.999_8, 0.0)]);
        assert!((0.19 * all..0.21 * all).contains(&nearly), "{nearly} of {all}");
    }
}
