//! Visible triangles of each body of a pair.

use crate::asset::BakedMesh;
use crate::geometry::Orientation;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, NearPair, View};
use crate::types::settings::Culling;
use glam::Vec3;

/// The views of both bodies. If the centres are closer than `pad`, rounding determines the direction between them, and
/// all triangles count.
pub fn of_pair(bodies: &Bodies, meshes: &MeshArena, pair: &NearPair, pad: f32) -> [View; 2] {
    let ends = pair.bodies.map(|i| i as usize);
    let exact = ends.iter().all(|&i| bodies.culling[i] == Culling::Exact);
    if exact || pair.translation.length_squared() <= pad * pad {
        return [View::All; 2];
    }
    let turn_back = pair.rotation.transpose();
    [(ends[0], pair.translation), (ends[1], -pair.translation)].map(|(body, to_other)| {
        let mesh = &*meshes[bodies.mesh[body]].mesh;
        let scale = bodies.scale[body];
        match (bodies.culling[body], &mesh.faces) {
            (Culling::FacesOfCollision, Some(table)) => {
                let turned = if body == ends[0] {
                    to_other
                } else {
                    turn_back * to_other
                };
                View::Group(table.group_id(turned / scale))
            }
            (Culling::FrontFacing, _) => facing(mesh, scale, to_other),
            // Without a face table the visible triangles are unknown.
            (Culling::FacesOfCollision, None) | (Culling::Exact, _) => View::All,
        }
    })
}

/// The front-facing triangles of a mesh with an outside. Mirroring reverses the winding.
fn facing(mesh: &BakedMesh, scale: Vec3, to_other: Vec3) -> View {
    let mirrored = scale.cmplt(Vec3::ZERO).bitmask().count_ones() % 2 == 1;
    match mesh.mesh.orientation() {
        Orientation::Outward => View::Facing(if mirrored { -to_other } else { to_other }),
        // A body inside a room sees every wall.
        Orientation::Inward | Orientation::Mixed | Orientation::Open => View::All,
    }
}
