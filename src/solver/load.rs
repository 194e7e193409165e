//! How many substeps an island needs so that its contact springs hold their loads.
//!
//! A contact gives way by a distance that is proportional to its load, and to the square of the length of a substep. A
//! heavy body on a light one would press it flat; with shorter substeps the springs are stiffer.

use super::batch::Batches;
use super::colors::LANES;
use super::constraints::BundlesMut;
use super::group::Group;
use super::pace::Pace;
use super::prepare::Source;
use crate::simd::lanes::lane_of;
use std::f32::consts::TAU;

/// A contact at rest may give way by this fraction of D: a little more than the gap that it keeps.
pub(super) const MAX_COMPRESSION: f32 = 0.0007;
/// Largest factor on the number of substeps.
pub(super) const MAX_FACTOR: f32 = 16.0;
/// Points times factor of an island.
pub(super) const POINT_BUDGET: f32 = 2000.0;

/// Factors on the number of substeps of the islands of a bundle with this pace and so many points. The points have the
/// impulses of the last collision substep.
pub(super) fn substep_factors(
    bundle: &mut BundlesMut,
    group: &Group,
    point_counts: &[u32; LANES],
    source: &Source,
    pace: Pace,
) -> [u32; LANES] {
    let h = pace.h();
    let stiffness = (TAU * source.settings.frequency / h).powi(2);
    let gravity = source.gravity;
    let mut compressions = [0.0f32; LANES];
    let mut pairs = bundle.pairs.iter();
    for (batch, points) in Batches::new(bundle.batches, bundle.lanes) {
        for (lane, pair) in pairs.by_ref().take(batch.pairs).enumerate() {
            if pair.depenetrating {
                continue;
            }
            let inverse_masses = pair
                .slots
                .map(|slot| bundle.states.masses[slot as usize].inverse_mass.max_element());
            for point in points.iter().filter(|point| point.valid >> lane & 1 == 1) {
                // Acceleration of the bodies by the load.
                let impulse = point.normal_impulse.0[lane];
                let load = if impulse > 0.0 {
                    impulse * point.inverse_effective_mass[0].0[lane] / h
                } else if !pair.known && point.separation.0[lane] <= pair.rest_offset {
                    // The load is not known yet. The upper body rests on the lower one with at least its own weight.
                    let down = -lane_of(&point.rows[0].direction, lane).dot(gravity);
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
                let compression = load / (stiffness * MAX_COMPRESSION * pair.diameter);
                let island = group.island(lane);
                compressions[island] = compressions[island].max(compression);
            }
        }
    }
    std::array::from_fn(|island| {
        let most = (POINT_BUDGET / point_counts[island] as f32).clamp(1.0, MAX_FACTOR);
        compressions[island].sqrt().clamp(1.0, most).ceil() as u32
    })
}
