//! Gizmos of contacts: normals, points with impulses, segments of intersection.

use super::config::FaceoffGizmos;
use super::outlines::Drawn;
use crate::plugin::collisions::Collisions;
use crate::plugin::settings::FaceLists;
use bevy::prelude::*;

pub(super) fn draw_contacts(
    mut gizmos: Drawn,
    collisions: Option<Res<Collisions>>,
    face_lists: Option<ResMut<FaceLists>>,
    mut before: Local<Option<FaceLists>>,
) {
    let &FaceoffGizmos {
        contacts,
        contact_length,
        contact_points,
        impulses,
        impulse_scale,
        intersections,
        marker_size,
        ..
    } = gizmos.config_ext;
    let kinds = [contacts, contact_points, impulses, intersections];
    if let Some(mut face_lists) = face_lists {
        if gizmos.config.enabled && intersections.is_some() {
            before.get_or_insert(*face_lists);
            face_lists.set_if_neq(FaceLists(true));
        } else if let Some(before) = before.take() {
            face_lists.set_if_neq(before);
        }
    }
    let Some(collisions) = collisions.filter(|_| gizmos.config.enabled) else {
        return;
    };
    if kinds.iter().all(Option::is_none) {
        return;
    }
    for hit in collisions.iter() {
        if let Some(color) = contacts {
            let point = hit.contact.point;
            gizmos.arrow(point, point + contact_length * hit.contact.normal, color);
        }
        for point in hit.points {
            if let Some(color) = contact_points {
                gizmos.cross(point.point, marker_size, color);
            }
            if let Some(color) = impulses
                && point.impulse > 0.0
            {
                let push = impulse_scale * point.impulse * point.normal;
                gizmos.line(point.point, point.point + push, color);
            }
        }
        if let Some(color) = intersections {
            for pair in hit.faces.into_iter().flatten() {
                gizmos.line(pair.start, pair.end, color);
            }
        }
    }
}
