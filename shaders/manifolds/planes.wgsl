// Contact generation: contact points of bodies on half-spaces. A few vertices each, the lowest and widely spread. One
// workgroup per body. The twin of `src/manifolds/cpu/planes.rs`.
#import faceoff::arena::{meshes, vector}
#import faceoff::constants::manifolds::{LEVEL, MARGIN, MAX_PLANE_POINTS}
#import faceoff::constants::shared::SAFETY
#import faceoff::contact_slots::slot_of_plane
#import faceoff::dispatch::group_index
#import faceoff::margins::sway
#import faceoff::math::{conjugate, layers_interact, matrix, rotate}
#import faceoff::sides
#import faceoff::smooth
#import faceoff::types as t

@group(0) @binding(2) var<uniform> limits: t::ContactLimits;
@group(0) @binding(3) var<uniform> step: t::Step;
@group(0) @binding(4) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(6) var<storage, read> planes: array<t::Plane>;
@group(0) @binding(7) var<storage, read> margin_pairs: array<t::MarginPair>;
@group(0) @binding(8) var<storage, read_write> staged: array<t::ContactPoint>;
@group(0) @binding(9) var<storage, read_write> slots: array<t::ContactPair>;

var<workgroup> best: array<f32, 64>;
var<workgroup> best_vertex: array<u32, 64>;
var<workgroup> chosen: array<LowVertex, 8>;
var<workgroup> base: u32;

// A vertex that may reach the plane.
struct LowVertex {
    // Relative to the centre of mass, in the world's axes.
    anchor: vec3<f32>,
    // Separation of the smooth surface for which the vertex stands.
    separation: f32,
    // The anchor in the mesh's axes. In these axes equal distances between vertices of a cube are exactly equal, so
    // their order decides ties.
    position: vec3<f32>,
    // Radius of curvature of the surface in the direction of rolling; 0 at a corner.
    curvature_radius: f32,
    // Whether the vertex stands for a smooth surface that touches elsewhere.
    elsewhere: bool,
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= limits.bodies {
        return;
    }
    let before = pairs_up_to(index, atomicLoad(&contact_counters[t::MARGIN_PAIRS]));
    for (var k = 0u; k < limits.planes; k += 1u) {
        let slot = slot_of_plane(index, k, before, limits.planes);
        var count = 0u;
        if step.is_over == 0u && (bodies[index].inactive == 0u || step.planes_changed != 0u) {
            count = find(bodies[index], planes[k], thread);
        }
        if thread == 0u {
            base = atomicAdd(&contact_counters[t::STAGED_POINTS], count);
            let fits = base <= limits.staged_points && count <= limits.staged_points - base;
            slots[slot] = t::ContactPair(index, limits.bodies + k, base, select(0u, count, fits));
            base = select(t::NOTHING, base, fits);
        }
        workgroupBarrier();
        if base != t::NOTHING && thread < count {
            staged[base + thread] = point(bodies[index], planes[k], chosen[thread]);
        }
        workgroupBarrier();
    }
}

// Number of pairs of the ascending list whose first body is this one or an earlier one.
fn pairs_up_to(body: u32, pairs: u32) -> u32 {
    var low = 0u;
    var high = pairs;
    while low < high {
        let middle = (low + high) / 2u;
        if margin_pairs[middle].a <= body {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// Height of a body's centre of mass over a plane. Large terms are added first.
fn height_of(body: t::Body, plane: t::Plane) -> f32 {
    let anchor = rotate(body.rotation, body.scale * meshes[body.mesh].center);
    return (dot(plane.normal, body.position) - plane.distance) + dot(plane.normal, anchor);
}

// Selects vertices: the lowest, then repeatedly the one farthest from those selected. Returns their number.
fn find(body: t::Body, plane: t::Plane, thread: u32) -> u32 {
    let is_solid = plane.sensor == 0u && (body.flags & t::SENSOR) == 0u;
    if (body.flags & t::KIND_MASK) != t::DYNAMIC || !is_solid || !(body.radius > 0.0) {
        return 0u;
    }
    if !layers_interact(vec2(body.memberships, body.filters), vec2(plane.memberships, plane.filters)) {
        return 0u;
    }
    let above = height_of(body, plane);
    // Height of the rounded surface, if the core's vertices are at the centre.
    let height = above - body.rounding;
    let speed = length(body.linear_velocity) + sway(step, body, body.travel_time);
    let margin = 2.0 * MARGIN * body.radius + SAFETY * speed * body.travel_time;
    if above >= body.radius + margin {
        return 0u;
    }
    let along = body.scale * rotate(conjugate(body.rotation), plane.normal);
    let rotation = matrix(body.rotation);
    let vertices = meshes[body.mesh].vertices;
    let vertex_count = meshes[body.mesh].vertex_count;
    var last = t::NOTHING;
    // The lowest, if possible not one that stands for a surface that touches elsewhere.
    for (var stage = 0u; stage < 2u && last == t::NOTHING; stage += 1u) {
        var lowest = -t::DROPPED;
        var place = t::NOTHING;
        for (var v = thread; v < vertex_count; v += 64u) {
            let separation = dot(vector(vertices + 3u * v), along) + height;
            if separation < margin {
                let vertex = low_vertex(body, plane.normal, rotation, separation, v);
                if (stage == 1u || !vertex.elsewhere) && -vertex.separation > lowest {
                    lowest = -vertex.separation;
                    place = v;
                }
            }
        }
        greatest(lowest, place, thread);
        last = workgroupUniformLoad(&best_vertex[0]);
    }
    if last == t::NOTHING {
        return 0u;
    }
    let floor_height = -best[0];
    if thread == 0u {
        chosen[0] = low_vertex(body, plane.normal, rotation, dot(vector(vertices + 3u * last), along) + height, last);
    }
    workgroupBarrier();
    let level = 2.0 * LEVEL * body.radius;
    var count = 1u;
    // The first half of the points supports the body.
    for (var stage = 0u; stage < 2u; stage += 1u) {
        let limit = select(MAX_PLANE_POINTS / 2u, MAX_PLANE_POINTS, stage == 1u);
        let ceiling = select(floor_height + level, t::DROPPED, stage == 1u);
        while count < limit {
            var best_value = level * level;
            var number = t::NOTHING;
            for (var v = thread; v < vertex_count; v += 64u) {
                let separation = dot(vector(vertices + 3u * v), along) + height;
                if separation < margin {
                    let vertex = low_vertex(body, plane.normal, rotation, separation, v);
                    if !vertex.elsewhere && vertex.separation <= ceiling {
                        let distance = square_from_chosen(body.scale, vertex.position, count);
                        if distance > best_value {
                            best_value = distance;
                            number = v;
                        }
                    }
                }
            }
            greatest(best_value, number, thread);
            last = workgroupUniformLoad(&best_vertex[0]);
            // The remaining vertices coincide with selected ones.
            if last == t::NOTHING {
                break;
            }
            if thread == 0u {
                let separation = dot(vector(vertices + 3u * last), along) + height;
                chosen[count] = low_vertex(body, plane.normal, rotation, separation, last);
            }
            workgroupBarrier();
            count += 1u;
        }
    }
    return count;
}

// A vertex of this height over a plane. A finely tessellated curved surface touches with its smooth surface.
fn low_vertex(
    body: t::Body,
    normal: vec3<f32>,
    rotation: mat3x3<f32>,
    separation: f32,
    number: u32,
) -> LowVertex {
    let place = sides::smooth_vertex(meshes[body.mesh].features, number);
    let contact = smooth::vertex_contact(place, rotation, body.scale, -normal, body.angular_velocity);
    var result: LowVertex;
    let position = vector(meshes[body.mesh].vertices + 3u * number);
    let way = contact.slide - normal * contact.bulge;
    result.position = position + (transpose(rotation) * way) / body.scale;
    result.anchor = rotation * (body.scale * position) + way - normal * body.rounding;
    result.separation = separation - contact.bulge;
    result.curvature_radius = contact.radius + body.rounding;
    result.elsewhere = contact.state == smooth::ELSEWHERE;
    return result;
}

fn square_from_chosen(scale: vec3<f32>, p: vec3<f32>, count: u32) -> f32 {
    var least = t::DROPPED;
    for (var k = 0u; k < count; k += 1u) {
        let offset = scale * (p - chosen[k].position);
        least = min(least, dot(offset, offset));
    }
    return least;
}

// Reduction to the largest value of all threads; among equal ones, the first vertex's.
fn greatest(value: f32, number: u32, thread: u32) {
    best[thread] = value;
    best_vertex[thread] = number;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half && best_vertex[thread + half] != t::NOTHING {
            let other = best[thread + half];
            let first = best_vertex[thread + half] < best_vertex[thread];
            if other > best[thread] || (other == best[thread] && first) || best_vertex[thread] == t::NOTHING {
                best[thread] = other;
                best_vertex[thread] = best_vertex[thread + half];
            }
        }
        workgroupBarrier();
    }
}

fn point(body: t::Body, plane: t::Plane, vertex: LowVertex) -> t::ContactPoint {
    let own = rotate(body.rotation, body.scale * meshes[body.mesh].center);
    var result: t::ContactPoint;
    result.anchor_a = vertex.anchor;
    // Relative to the plane's point nearest to the world's origin.
    let foot = own + vertex.anchor - plane.normal * vertex.separation;
    result.anchor_b = (body.position - plane.normal * plane.distance) + foot;
    result.normal = -plane.normal;
    result.separation = vertex.separation;
    result.curvature_radius_a = vertex.curvature_radius;
    result.curvature_radius_b = t::FLAT_RADIUS;
    result.face_a = t::NOTHING;
    result.face_b = t::NOTHING;
    return result;
}
