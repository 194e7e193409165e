#define_import_path faceoff::deepest

// Rays along a patch's normal from the vertices of both bodies that reach deepest, if they reach deeper than features
// and than the ray through its middle: the end of a slender body lies far from the middle. The twin of `deepest_probes`
// in `src/manifolds/cpu/pair.rs`, and of `deepest.rs` there.

#import faceoff::arena::{meshes, vector}
#import faceoff::constants::manifolds::{ASIDE, DEEPER, MAX_DEPTH, RAY_LENGTH}
#import faceoff::probes::{Probe, exit}
#import faceoff::sides
#import faceoff::tree
#import faceoff::types as t

// The device aborted a loop.
var<private> deepest_unfinished: bool = false;

// A probe, and where on the patch it passes.
struct Deepest {
    probe: Probe,
    place: vec3<f32>,
}

// The corner of a triangle that is farthest along a direction.
struct Farthest {
    position: vec3<f32>,
    triangle: u32,
}

// The rays from the vertex of the first body, `end` 0, or of the second. `middle` is the probe at the patch's centre.
fn probe_of_vertex(
    a: sides::Side, b: sides::Side, setup: t::PairSetup, of_patch: t::Patch, middle: Probe, end: u32
) -> Deepest {
    var result: Deepest;
    result.probe.separation = t::DROPPED;
    let is_second = end == 1u;
    var side = a;
    var other = b;
    if is_second {
        side = b;
        other = a;
    }
    let way = select(of_patch.normal, -of_patch.normal, is_second);
    let own = select(middle.ways.x, middle.ways.y, is_second);
    let known = select(own, 0.0, middle.separation == t::DROPPED);
    let far = farthest(side, end, way);
    let vertex = far.position - of_patch.center;
    let depth = dot(vertex, way);
    let aside = vertex - way * depth;
    if !(depth > max(MAX_DEPTH * setup.size, DEEPER * known) && depth <= RAY_LENGTH * setup.size)
        || length(aside) > of_patch.reach + ASIDE * depth {
        return result;
    }
    // Nothing of its own body lies beyond the vertex.
    let back = exit(other, 1u - end, far.position, -way, RAY_LENGTH * setup.size);
    let beyond = back.distance - depth;
    // Another part of the other body is another patch.
    if back.triangle == t::NOTHING || abs(beyond) > 0.5 * depth {
        return result;
    }
    result.probe.ways = select(vec2(depth, beyond), vec2(beyond, depth), is_second);
    result.probe.triangles = select(vec2(far.triangle, back.triangle), vec2(back.triangle, far.triangle), is_second);
    result.probe.separation = -back.distance;
    result.place = of_patch.center + aside;
    return result;
}

// The vertex that is farthest along a unit vector. `end` is the body's position in the pair.
fn farthest(side: sides::Side, end: u32, way: vec3<f32>) -> Farthest {
    // Heights of the mesh's points.
    let along = side.scale * (way * side.rotation);
    let size = abs(along);
    let pad = 4.0e-6 * dot(meshes[side.mesh].box_half, size);
    var best = Farthest(vec3(0.0), t::NOTHING);
    var height = -t::DROPPED;
    let levels = meshes[side.mesh].levels;
    var walk = tree::walk(levels);
    while !walk.is_done {
        var opened = 0u;
        for (var k = 0u; walk.is_new && k < 8u; k += 1u) {
            let child = 8u * walk.number + k;
            if walk.level == 0u {
                for (var corner = 0u; corner < 3u && child < side.triangle_count; corner += 1u) {
                    let position = vector(side.triangles + 9u * child + 3u * corner);
                    let own = dot(position, along);
                    if own > height || (own == height && child < best.triangle) {
                        height = own;
                        best = Farthest(position, child);
                    }
                }
            } else {
                let at = tree::box_of(end, tree::node(walk.level - 1u, child));
                if at != 0u && dot(vector(at), along) + dot(vector(at + 3u), size) + pad >= height {
                    opened |= 1u << k;
                }
            }
        }
        walk = tree::advance(walk, levels, opened);
    }
    deepest_unfinished = deepest_unfinished || !walk.is_done;
    best.position = sides::place(side, best.position);
    return best;
}
