#define_import_path faceoff::pair_contact

// The contact of a pair, from the sums over its contour. All 64 threads of a workgroup work on one pair. The twin of
// `src/triangle_test/cpu/contact.rs`.

#import faceoff::agree::agree
#import faceoff::arena::meshes
#import faceoff::constants::triangle_test::SIGNIFICANT
#import faceoff::containment::{contains, unfinished}
#import faceoff::math::rotate
#import faceoff::placed_pair::{Pair, bodies, placed_a, placed_b, to_world}
#import faceoff::types as t

@group(0) @binding(3) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> results: array<t::PairResult>;
@group(0) @binding(7) var<storage, read_write> touching: array<t::Touching>;

// Sums over a contour, or a part of it.
struct Sums {
    // Midpoints weighted by length, with the length.
    middle: vec4<f32>,
    area: vec3<f32>,
    // Offset from each start to its end.
    closing: vec3<f32>,
}

var<workgroup> sum_middle: array<vec4<f32>, 64>;
var<workgroup> sum_area: array<vec3<f32>, 64>;
var<workgroup> sum_closing: array<vec3<f32>, 64>;

// The sums of all threads, for the first one.
fn total(own: Sums, thread: u32) -> Sums {
    sum_middle[thread] = own.middle;
    sum_area[thread] = own.area;
    sum_closing[thread] = own.closing;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            sum_middle[thread] += sum_middle[thread + half];
            sum_area[thread] += sum_area[thread + half];
            sum_closing[thread] += sum_closing[thread + half];
        }
        workgroupBarrier();
    }
    return Sums(sum_middle[0], sum_area[0], sum_closing[0]);
}

// Writes the result of a pair. `own` are the sums of this thread, relative to `origin`.
fn report(index: u32, pair: Pair, hit_count: u32, own: Sums, origin: vec3<f32>, thread: u32) {
    var contained = false;
    if agree(thread, hit_count) == 0u {
        contained = any_inside(pair, true, thread);
        if !contained {
            contained = any_inside(pair, false, thread);
        }
    }
    if unfinished {
        atomicOr(&counters[t::CUT_SHORT], 1u);
    }
    let sums = total(own, thread);
    if thread != 0u {
        return;
    }
    let touches = hit_count > 0u || contained;
    results[index].touching = u32(touches);
    if touches {
        let local = contact(pair, hit_count, sums, origin);
        let rotation = bodies[pair.a].rotation;
        let normal = rotate(rotation, local.normal);
        results[index].point = rotate(rotation, local.point / pair.unit);
        results[index].normal = normal;
        results[index].a = pair.a;
        results[index].b = pair.b;
        let at = atomicAdd(&counters[t::TOUCHING], 1u);
        touching[at] = t::Touching(
            to_world(pair, local.point), pair.a, normal, pair.b, index, hit_count, u32(contained), 0u
        );
    }
}

struct Contact {
    point: vec3<f32>,
    normal: vec3<f32>,
}

// The contact in a's axes and the pair's unit: the contour's centroid, and its area vector as the normal.
fn contact(pair: Pair, hit_count: u32, sums: Sums, origin: vec3<f32>) -> Contact {
    let translation = pair.translation;
    let apart = sqrt(dot(translation, translation));
    var centers = vec3(0.0, 1.0, 0.0);
    if apart > 0.0 {
        centers = translation / apart;
    }
    if hit_count == 0u {
        // Containment: the centre of the smaller body, along the line of centres.
        return Contact(select(translation, vec3(0.0), bodies[pair.a].radius < bodies[pair.b].radius), centers);
    }
    let length = sums.middle.w;
    var middle = sums.middle.xyz / length;
    if !(length > 0.0) {
        middle = vec3(0.0);
    }
    let area = sums.area - 0.5 * cross(middle, sums.closing);
    let sign = sign_of(pair.a) * sign_of(pair.b);
    let size = sqrt(dot(area, area));
    var normal = centers;
    if size > SIGNIFICANT * length * length * 0.07957747 && sign != 0.0 {
        normal = area * (sign / size);
    }
    return Contact(middle + origin, normal);
}

// The orientation of a body's faces: 1 as in its mesh, -1 if the scale mirrors, 0 if it is inconsistent.
fn sign_of(body: u32) -> f32 {
    let scale = bodies[body].scale;
    let mirrored = (scale.x < 0.0) != ((scale.y < 0.0) != (scale.z < 0.0));
    let orientation = meshes[bodies[body].mesh].flags & t::ORIENTATION_MASK;
    if orientation == t::MIXED {
        return 0.0;
    }
    return select(1.0, -1.0, mirrored);
}

// Whether one body is solid and contains a component of the other. `of_a`: a component of a inside b.
fn any_inside(pair: Pair, of_a: bool, thread: u32) -> bool {
    let inner = select(pair.mesh_b, pair.mesh_a, of_a);
    let outer = meshes[select(pair.mesh_a, pair.mesh_b, of_a)];
    if (outer.flags & t::SOLID) == 0u {
        return false;
    }
    for (var k = 0u; k < meshes[inner].component_count; k += 1u) {
        let vertex = meshes[inner].components + 3u * k;
        var p: vec3<f32>;
        if of_a {
            p = ((placed_a(pair, vertex) - pair.translation) * pair.rotation) / pair.scale_b;
        } else {
            p = placed_b(pair, vertex) / pair.scale_a;
        }
        if any(abs(p - outer.box_center) > outer.box_half * 1.00001 + outer.radius * 1.0e-5) {
            continue;
        }
        if contains(outer, select(0u, 1u, of_a), p, thread) {
            return true;
        }
    }
    return false;
}
