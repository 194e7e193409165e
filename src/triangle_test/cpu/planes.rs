//! Contacts of bodies that penetrate planes.

use crate::parallel::in_order::InOrder;
use crate::simd::lanes::{SimdBase, bitmask, bits, dot, lane_of, load_points, splat, splat_point};
use crate::simd::level::baseline;
use crate::simd::levels::visit;
use crate::simd::rounding::PAD;
use crate::state::mesh_arena::{BoxGroup, MeshArena};
use crate::state::{Bodies, Plane, PlaneContact};
use glam::{DVec3, Vec3};

/// Memory kept between steps.
pub type Scratch = InOrder<PlaneContact>;

/// Bodies per task.
const TASK: usize = 64;

/// Appends the contacts of `wanted` pairs of bodies with planes that detect them, ascending by body, then plane. Plane
/// `i` has the number `bodies.len() + i`.
pub fn find(
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    wanted: impl Fn([u32; 2]) -> bool + Sync,
    scratch: &mut Scratch,
    contacts: &mut Vec<PlaneContact>,
) {
    if planes.is_empty() {
        return;
    }
    scratch.extend(contacts, &bodies.list_of_movers(), TASK, |_, &body, contacts| {
        let body = body as usize;
        let wanted = |&(i, _): &(usize, &Plane)| wanted([body as u32, (bodies.len() + i) as u32]);
        let planes = planes.iter().enumerate().filter(wanted);
        contacts.extend(planes.filter_map(|(i, plane)| contact(bodies, meshes, body, i as u32, plane)));
    });
}

fn contact(bodies: &Bodies, meshes: &MeshArena, body: usize, index: u32, plane: &Plane) -> Option<PlaneContact> {
    if !plane.detects(bodies.kind[body], bodies.layers[body]) {
        return None;
    }
    let frame = &bodies.frame[body];
    let normal = plane.normal.as_dvec3();
    let height = (normal.dot(frame.center) - plane.distance as f64) as f32;
    if height >= bodies.radius[body] {
        return None;
    }
    let rounding = bodies.rounding[body];
    let height = height - rounding;
    let local = frame.scale * (frame.rotation.transpose() * normal);
    let simd = baseline();
    let direction = splat_point(simd, local.as_vec3());
    // Depth-weighted mean of the penetrating vertices: a body that lies flat is supported over its whole face, one on
    // its corner there. Each vertex counts once, however many triangles share it, so a cube that lands flat does not
    // start to rotate.
    let (mut deepest, mut weight, mut sum) = (0f32, 0f32, Vec3::ZERO);
    let lanes = &meshes[bodies.mesh[body]].lanes;
    // Only penetrating vertices contribute, so skipping the others changes no bit of the sums.
    let size = splat_point(simd, local.as_vec3().abs());
    let limit = splat(simd, PAD * bodies.radius[body] - height);
    let reaches = |group: &BoxGroup| {
        let (center, half) = (load_points(simd, &group.center), load_points(simd, &group.half));
        let lowest = dot(center, direction) - dot(half, size);
        bitmask(lowest.simd_lt(limit))
    };
    visit(&lanes.vertex_levels, reaches, |group| {
        let (vertices, lanes) = &lanes.vertices[group as usize];
        let heights = dot(load_points(simd, vertices), direction);
        for lane in bits(*lanes) {
            let depth = -(heights[lane] + height);
            if depth > 0.0 {
                let p = lane_of(vertices, lane);
                deepest = deepest.max(depth);
                weight += depth;
                sum += depth * p;
            }
        }
        true
    });
    let offset: DVec3 = frame.rotation * (frame.scale * (sum / weight).as_dvec3()) - normal * f64::from(rounding);
    (deepest > 0.0).then(|| PlaneContact {
        body: body as u32,
        plane: index,
        point: (frame.center + offset).as_vec3(),
        normal: -plane.normal,
        depth: deepest,
        first_point: 0,
        point_count: 0,
        impulse: 0.0,
    })
}
