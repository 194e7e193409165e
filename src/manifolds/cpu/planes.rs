//! Where bodies lie on half-spaces: a few vertices each, the lowest and spread wide. Of a finely cut round surface not the
//! vertices touch but the surface around them.

use super::smooth;
use crate::geometry::cluster::CLUSTER;
use crate::manifolds::{Manifold, ManifoldPoint, Manifolds};
use crate::parallel::in_order::InOrder;
use crate::parallel::per_thread::PerThread;
use crate::simd::lanes::{bits, dot, splat};
use crate::simd::levels::visit;
use crate::simd::rounding::PAD;
use crate::state::margins::SAFETY;
use crate::state::mesh_arena::{BoxGroup, MeshArena};
use crate::state::{Bodies, Plane, StepConfig};
use crate::types::body::RigidBody;
use glam::Vec3;
use wide::f32x8;

/// At most this many points of a body and a plane.
pub const MAX_POINTS: usize = 8;
/// The face of a point that lies on none.
pub const NO_FACE: u32 = u32::MAX;
/// Vertices this near the lowest one, as a part of the body's diameter, are as low as it.
pub(crate) const LEVEL: f32 = 0.0025;
/// Points are made this far from the surface, as a part of the body's diameter, beyond what the body moves.
pub(crate) const MARGIN: f32 = 0.01;

/// Memory kept between calls.
#[derive(Default)]
pub struct Scratch {
    lists: InOrder<Found>,
    found: Vec<Found>,
    vertices: PerThread<Vec<Low>>,
}

/// A vertex that may reach a plane.
struct Low {
    separation: f32,
    /// Relative to the centre of mass, in the mesh's axes.
    place: Vec3,
    number: u32,
}

/// Bodies per task.
const TASK: usize = 64;

/// A body and a plane, with the points they have.
#[derive(Clone, Copy)]
struct Found {
    bodies: [u32; 2],
    points: [ManifoldPoint; MAX_POINTS],
    count: usize,
}

/// Appends a manifold for every solid dynamic body near a plane, by body, then plane, but for pairs that are not `wanted`. In them plane `i` has the number
/// `bodies.len() + i`, and its centre is its point nearest to the world's origin.
///
/// `config.dt` is how long the points must serve: vertices are listed that may reach the plane within it.
pub fn find(
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    config: &StepConfig,
    wanted: impl Fn([u32; 2]) -> bool + Sync,
    scratch: &mut Scratch,
    manifolds: &mut Manifolds,
) {
    let Scratch { lists, found, vertices } = scratch;
    found.clear();
    if planes.is_empty() {
        return;
    }
    let vertices = vertices.ready();
    lists.extend(found, &bodies.kind, TASK, |body, _, found| {
        let mut vertices = vertices.lock();
        let wanted = |&(i, _): &(usize, &Plane)| wanted([body as u32, (bodies.len() + i) as u32]);
        let near = |(i, plane)| manifold(bodies, meshes, body, i, plane, config, &mut vertices);
        found.extend(planes.iter().enumerate().filter(wanted).filter_map(near));
    });
    for found in found.iter() {
        manifolds.pairs.push(Manifold {
            bodies: found.bodies,
            first_point: manifolds.points.len() as u32,
            point_count: found.count as u32,
        });
        manifolds.points.extend(&found.points[..found.count]);
    }
}

fn manifold(
    bodies: &Bodies,
    meshes: &MeshArena,
    body: usize,
    index: usize,
    plane: &Plane,
    config: &StepConfig,
    vertices: &mut Vec<Low>,
) -> Option<Found> {
    if bodies.kind[body] != RigidBody::Dynamic || bodies.sensor[body] {
        return None;
    }
    let (frame, radius) = (&bodies.frame[body], bodies.radius[body]);
    let normal = plane.normal.as_dvec3();
    let above = normal.dot(frame.center) - plane.distance as f64;
    let fall = config.gravity.length() * bodies.gravity_scale[body].abs() * config.dt;
    let speed = bodies.linear_velocity[body].length() + bodies.angular_velocity[body].length() * radius + fall;
    let margin = 2.0 * MARGIN * radius + SAFETY * speed * config.dt;
    let height = above as f32;
    if height >= radius + margin {
        return None;
    }
    let local = frame.scale * (frame.rotation.transpose() * normal);
    let direction = splat(local.as_vec3());
    let size = splat(local.as_vec3().abs());
    let limit = f32x8::splat(PAD * radius + margin - height);
    let reaches = |group: &BoxGroup| {
        let lowest = dot(group.center, direction) - dot(group.half, size);
        lowest.simd_lt(limit).to_bitmask()
    };
    let lanes = &meshes[bodies.mesh[body]].lanes;
    vertices.clear();
    visit(&lanes.vertex_levels, &reaches, &mut |group| {
        let (eight, held) = &lanes.vertices[group as usize];
        let heights = dot(*eight, direction);
        for lane in bits(*held) {
            let separation = heights.as_array()[lane] + height;
            if separation < margin {
                vertices.push(Low {
                    separation,
                    place: Vec3::from_array(eight.each_ref().map(|x| x.as_array()[lane])),
                    number: group * CLUSTER as u32 + lane as u32,
                });
            }
        }
        true
    });
    let scale = frame.scale.as_vec3();
    let chosen = choose(vertices, scale, 2.0 * LEVEL * radius);
    if chosen[0] == usize::MAX {
        return None;
    }
    let features = &meshes[bodies.mesh[body]].features;
    let size = f64::from(scale.abs().element_sum() / 3.0);
    let center = normal * plane.distance as f64;
    let none = ManifoldPoint {
        arms: [Vec3::ZERO; 2],
        normal: -plane.normal,
        separation: 0.0,
        roundness: [0.0, f32::INFINITY],
        turn: 0.0,
        faces: [NO_FACE; 2],
    };
    let mut points = [none; MAX_POINTS];
    let mut count = 0;
    for &i in chosen.iter().take_while(|&&i| i != usize::MAX) {
        let Low {
            separation,
            place,
            number,
        } = vertices[i];
        let arm = frame.rotation * (frame.scale * place.as_dvec3());
        let roundness = f64::from(features.vertex_curvature_radii[number as usize]) * size;
        let own_normal = frame.rotation * (features.vertex_normals[number as usize].as_dvec3() / frame.scale);
        // Others are corners, which turn with the body until they touch.
        let (arm, roundness) = match smooth::slide_of_vertex(own_normal, arm, -normal, roundness) {
            Some(slide) => (arm + slide, roundness),
            None => (arm, 0.0),
        };
        let foot = frame.center + arm - normal * separation as f64;
        points[count] = ManifoldPoint {
            arms: [arm.as_vec3(), (foot - center).as_vec3()],
            separation,
            roundness: [roundness as f32, f32::INFINITY],
            ..none
        };
        count += 1;
    }
    Some(Found {
        bodies: [body as u32, (bodies.len() + index) as u32],
        points,
        count,
    })
}

/// Picks vertices: the lowest one, then always that farthest from those picked. The first half comes from those as low as the
/// lowest, on which the body stands; the others tell what it will roll onto. Ends with `usize::MAX` if there are fewer.
fn choose(vertices: &[Low], scale: Vec3, level: f32) -> [usize; MAX_POINTS] {
    let mut chosen = [usize::MAX; MAX_POINTS];
    let lowest = vertices
        .iter()
        .enumerate()
        .min_by(|(_, a), (_, b)| a.separation.total_cmp(&b.separation));
    let Some((lowest, &Low { separation: floor, .. })) = lowest else {
        return chosen;
    };
    chosen[0] = lowest;
    let mut count = 1;
    for (limit, ceiling) in [(MAX_POINTS / 2, floor + level), (MAX_POINTS, f32::INFINITY)] {
        while count < limit {
            let apart = |low: &Low| {
                let distances = chosen[..count]
                    .iter()
                    .map(|&c| (scale * (low.place - vertices[c].place)).length_squared());
                distances.fold(f32::INFINITY, f32::min)
            };
            let farthest = vertices
                .iter()
                .enumerate()
                .filter(|(_, vertex)| vertex.separation <= ceiling)
                .map(|(i, vertex)| (i, apart(vertex)))
                // The first of equals, so that the order of vertices decides.
                .fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best });
            // What is left lies on what was picked.
            if farthest.1 <= level * level {
                break;
            }
            chosen[count] = farthest.0;
            count += 1;
        }
    }
    chosen
}
