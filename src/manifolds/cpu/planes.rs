//! Contact points of bodies on planes: a few vertices, the lowest and widely spread. A finely tessellated curved
//! surface touches with its smooth surface.

use super::smooth::{AtVertex, RoundVertex};
use crate::geometry::cluster::CLUSTER;
use crate::manifolds::{Manifold, ManifoldPoint, Manifolds};
use crate::parallel::in_order::InOrder;
use crate::parallel::per_thread::PerThread;
use crate::simd::lanes::{SimdBase, bitmask, bits, dot, lane_of, load_points, splat, splat_point};
use crate::simd::level::baseline;
use crate::simd::levels::visit;
use crate::simd::rounding::PAD;
use crate::state::margins::{SAFETY, sway};
use crate::state::mesh_arena::{BoxGroup, MeshArena};
use crate::state::{Bodies, Plane, StepConfig};
use crate::types::body::RigidBody;
use glam::{DMat3, DVec3, Vec3};

/// Maximum number of points of a body and a plane.
pub const MAX_POINTS: usize = 8;
/// In place of a face index: the point lies on none.
pub const NO_FACE: u32 = u32::MAX;
/// Vertices within this part of the body's diameter above the lowest one count as equally low.
pub(crate) const LEVEL: f32 = 0.0025;
/// Margin of contact points as a part of the body's diameter, in addition to the body's travel.
pub(crate) const MARGIN: f32 = 0.01;

/// Memory kept between calls.
#[derive(Default)]
pub struct Scratch {
    lists: InOrder<PlaneManifold>,
    plane_manifolds: Vec<PlaneManifold>,
    vertices: PerThread<Vec<LowVertex>>,
}

/// A vertex that may reach the plane.
struct LowVertex {
    /// Separation of the smooth surface for which the vertex stands.
    separation: f32,
    /// The squared distance to the nearest selected vertex.
    apart: f32,
    /// Touching point relative to the centre of mass, in the mesh's axes. In these axes equal distances between
    /// vertices of a cube are exactly equal, so their order decides ties.
    position: Vec3,
    /// `position` in the world's axes.
    anchor: DVec3,
    /// Radius of curvature of the surface in the direction of rolling; 0 at a corner.
    curvature_radius: f32,
}

/// Bodies per task.
const TASK: usize = 64;

/// The contact points of a body and a plane.
#[derive(Clone, Copy)]
struct PlaneManifold {
    bodies: [u32; 2],
    points: [ManifoldPoint; MAX_POINTS],
    count: usize,
}

/// Appends a manifold for every solid dynamic body near a solid plane, ascending by body, then plane, if the pair is
/// `wanted`. Plane `i` has the index `bodies.len() + i`, and its centre is its point nearest to the world's origin.
///
/// Vertices that may reach the plane within the body's [`Bodies::travel_time`] are included.
pub fn find(
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    config: &StepConfig,
    wanted: impl Fn([u32; 2]) -> bool + Sync,
    scratch: &mut Scratch,
    manifolds: &mut Manifolds,
) {
    let Scratch {
        lists,
        plane_manifolds,
        vertices,
    } = scratch;
    plane_manifolds.clear();
    if planes.is_empty() {
        return;
    }
    let vertices = vertices.ready();
    lists.extend(
        plane_manifolds,
        &bodies.list_of_movers(),
        TASK,
        |_, &body, plane_manifolds| {
            let body = body as usize;
            if bodies.kind[body] != RigidBody::Dynamic || bodies.sensor[body] {
                return;
            }
            let margin = margin(bodies, body, config);
            let mut vertices = vertices.lock();
            let wanted = |&(i, _): &(usize, &Plane)| wanted([body as u32, (bodies.len() + i) as u32]);
            let near = |(i, plane)| manifold(bodies, meshes, body, i, plane, margin, &mut vertices);
            plane_manifolds.extend(planes.iter().enumerate().filter(wanted).filter_map(near));
        },
    );
    for manifold in plane_manifolds.iter() {
        manifolds.pairs.push(Manifold {
            bodies: manifold.bodies,
            first_point: manifolds.points.len() as u32,
            point_count: manifold.count as u32,
        });
        manifolds.points.extend(&manifold.points[..manifold.count]);
    }
}

/// Height over a plane below which vertices have contact points, metres.
pub(crate) fn margin(bodies: &Bodies, body: usize, config: &StepConfig) -> f32 {
    let dt = bodies.travel_time[body];
    let speed = bodies.linear_velocity[body].length() + sway(bodies, config, body, dt);
    2.0 * MARGIN * bodies.radius[body] + SAFETY * speed * dt
}

fn manifold(
    bodies: &Bodies,
    meshes: &MeshArena,
    body: usize,
    index: usize,
    plane: &Plane,
    margin: f32,
    vertices: &mut Vec<LowVertex>,
) -> Option<PlaneManifold> {
    if plane.sensor || !bodies.layers[body].interacts_with(plane.layers) {
        return None;
    }
    let (frame, radius) = (&bodies.frame[body], bodies.radius[body]);
    let normal = plane.normal.as_dvec3();
    let above = normal.dot(frame.center) - plane.distance as f64;
    let rounding = bodies.rounding[body];
    // The height of the rounded surface, if the core's vertices are at the centre.
    let height = (above - f64::from(rounding)) as f32;
    if above as f32 >= radius + margin {
        return None;
    }
    let local = frame.scale * (frame.rotation.transpose() * normal);
    let simd = baseline();
    let direction = splat_point(simd, local.as_vec3());
    let size = splat_point(simd, local.as_vec3().abs());
    let limit = splat(simd, PAD * radius + margin - height);
    let reaches = |group: &BoxGroup| {
        let (center, half) = (load_points(simd, &group.center), load_points(simd, &group.half));
        let lowest = dot(center, direction) - dot(half, size);
        bitmask(lowest.simd_lt(limit))
    };
    let slot = &meshes[bodies.mesh[body]];
    let lanes = &slot.lanes;
    let placement = frame.rotation * DMat3::from_diagonal(frame.scale);
    let spin = bodies.angular_velocity[body].as_dvec3();
    vertices.clear();
    // The lowest vertex that stands for a surface that touches elsewhere.
    let mut lowest: Option<LowVertex> = None;
    visit(&lanes.vertex_levels, reaches, |group| {
        let (eight, held) = &lanes.vertices[group as usize];
        let heights = dot(load_points(simd, eight), direction);
        for lane in bits(*held) {
            let separation = heights[lane] + height;
            if separation >= margin {
                continue;
            }
            let number = group as usize * CLUSTER + lane;
            let position = lane_of(eight, lane);
            let anchor = placement * position.as_dvec3() - normal * f64::from(rounding);
            let mut vertex = LowVertex {
                separation,
                apart: f32::INFINITY,
                position,
                anchor,
                curvature_radius: rounding,
            };
            let features = &slot.features;
            let own_normal = frame.rotation * (features.vertex_normals[number].as_dvec3() / frame.scale);
            let round = RoundVertex::new(&features.roundness[number], &placement, own_normal, frame.scale);
            match round.map_or(AtVertex::Corner, |round| round.contact(-normal, spin)) {
                AtVertex::Corner => vertices.push(vertex),
                AtVertex::Round(contact) => {
                    let way = contact.slide - normal * contact.bulge;
                    vertex.separation -= contact.bulge as f32;
                    vertex.position += (frame.rotation.transpose() * way / frame.scale).as_vec3();
                    vertex.anchor += way;
                    vertex.curvature_radius = contact.radius as f32 + rounding;
                    vertices.push(vertex);
                }
                AtVertex::Elsewhere => {
                    if lowest.as_ref().is_none_or(|lowest| separation < lowest.separation) {
                        lowest = Some(vertex);
                    }
                }
            }
        }
        true
    });
    if vertices.is_empty() {
        vertices.extend(lowest);
    }
    let chosen = choose(vertices, frame.scale.as_vec3(), 2.0 * LEVEL * radius);
    if chosen[0] == usize::MAX {
        return None;
    }
    let center = normal * plane.distance as f64;
    let none = ManifoldPoint {
        anchors: [Vec3::ZERO; 2],
        normal: -plane.normal,
        separation: 0.0,
        bulge: 0.0,
        curvature_radii: [0.0, f32::INFINITY],
        normal_rotation: 0.0,
        faces: [NO_FACE; 2],
    };
    let mut points = [none; MAX_POINTS];
    let mut count = 0;
    for &i in chosen.iter().take_while(|&&i| i != usize::MAX) {
        let LowVertex {
            separation,
            anchor,
            curvature_radius,
            ..
        } = vertices[i];
        let foot = frame.center + anchor - normal * separation as f64;
        let point = ManifoldPoint {
            anchors: [anchor.as_vec3(), (foot - center).as_vec3()],
            separation,
            curvature_radii: [curvature_radius, f32::INFINITY],
            ..none
        };
        points[count] = point.shifted([frame.offset().as_vec3(), Vec3::ZERO]);
        count += 1;
    }
    Some(PlaneManifold {
        bodies: [body as u32, (bodies.len() + index) as u32],
        points,
        count,
    })
}

/// Selects vertices: the lowest, then repeatedly the one farthest from those selected. The first half is selected among
/// those as low as the lowest, which support the body; the others are those onto which it may roll. Unused entries are
/// `usize::MAX`.
fn choose(vertices: &mut [LowVertex], scale: Vec3, level: f32) -> [usize; MAX_POINTS] {
    let mut chosen = [usize::MAX; MAX_POINTS];
    let lowest = vertices
        .iter()
        .enumerate()
        .min_by(|(_, a), (_, b)| a.separation.total_cmp(&b.separation));
    let Some((lowest, &LowVertex { separation: floor, .. })) = lowest else {
        return chosen;
    };
    chosen[0] = lowest;
    let mut count = 1;
    for (limit, ceiling) in [(MAX_POINTS / 2, floor + level), (MAX_POINTS, f32::INFINITY)] {
        while count < limit {
            let last = vertices[chosen[count - 1]].position;
            // The first of equal ones, so the result follows the order of the vertices.
            let mut farthest = (0, 0.0);
            for (i, vertex) in vertices.iter_mut().enumerate() {
                let apart = (scale * (vertex.position - last)).length_squared();
                vertex.apart = vertex.apart.min(apart);
                if vertex.separation <= ceiling && vertex.apart > farthest.1 {
                    farthest = (i, vertex.apart);
                }
            }
            // The remaining vertices coincide with selected ones.
            if farthest.1 <= level * level {
                break;
            }
            chosen[count] = farthest.0;
            count += 1;
        }
    }
    chosen
}
