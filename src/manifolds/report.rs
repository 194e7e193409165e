//! Reports contact points when no response is computed.

use crate::state::manifolds::pair_order;
use crate::state::{Contacts, Manifold, Manifolds};
use glam::Vec3;

/// Writes the contact points of all touching pairs for [`Response::None`]. `center_of` returns the centre of mass of a
/// body at the time of the search for contacts.
///
/// [`Response::None`]: crate::types::settings::Response::None
pub(crate) fn report_points(
    manifolds: &Manifolds,
    first_plane: u32,
    contacts: &mut Contacts,
    center_of: impl Fn(u32) -> Vec3,
) {
    let Contacts {
        pairs, planes, points, ..
    } = contacts;
    points.clear();
    let mut add = |pair: &Manifold| {
        let first = points.len() as u32;
        let center = center_of(pair.bodies[0]);
        points.extend(
            manifolds
                .points_of(pair)
                .iter()
                .map(|point| point.in_world(center, 0.0)),
        );
        (first, pair.point_count)
    };
    let mut all = manifolds.pairs.iter().peekable();
    for pair in pairs {
        while all
            .next_if(|m| pair_order(m.bodies, first_plane) < (false, pair.bodies))
            .is_some()
        {}
        if let Some(manifold) = all.next_if(|m| m.bodies == pair.bodies) {
            (pair.first_point, pair.point_count) = add(manifold);
        }
    }
    for plane in planes {
        let bodies = [plane.body, first_plane + plane.plane];
        while all
            .next_if(|m| pair_order(m.bodies, first_plane) < (true, bodies))
            .is_some()
        {}
        if let Some(manifold) = all.next_if(|m| m.bodies == bodies) {
            (plane.first_point, plane.point_count) = add(manifold);
        }
    }
}
