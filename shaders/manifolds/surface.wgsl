#define_import_path faceoff::surface

// Whether a body's surface is near a point.

#import faceoff::arena::{meshes, vector}
#import faceoff::closest::closest
#import faceoff::sides
#import faceoff::tree
#import faceoff::types as t

// The device aborted a loop.
var<private> surface_unfinished: bool = false;

// Whether the surface is no farther from `p` than `most`. `end` is the body's position in the pair.
fn is_near(side: sides::Side, end: u32, p: vec3<f32>, most: f32) -> bool {
    // In the body's own axes, scaled.
    let at = sides::to_own(side, p);
    let whole = abs(side.scale) * meshes[side.mesh].box_half;
    let reach = most + 4.0e-6 * (whole.x + whole.y + whole.z);
    let levels = meshes[side.mesh].levels;
    var walk = tree::walk(levels);
    var is_found = false;
    while !walk.is_done && !is_found {
        var opened = 0u;
        for (var k = 0u; walk.is_new && k < 8u; k += 1u) {
            let child = 8u * walk.number + k;
            if walk.level == 0u {
                is_found = is_found || (child < side.triangle_count && is_within(side, child, at, most));
            } else {
                let place = tree::box_of(end, tree::node(walk.level - 1u, child));
                if place != 0u && is_box_within(side, place, at, reach) {
                    opened |= 1u << k;
                }
            }
        }
        walk = tree::advance(walk, levels, opened);
    }
    surface_unfinished = surface_unfinished || !(walk.is_done || is_found);
    return is_found;
}

fn is_within(side: sides::Side, number: u32, p: vec3<f32>, most: f32) -> bool {
    let at = side.triangles + 9u * number;
    // Relative to the point, for precision.
    let corners = mat3x3(
        side.scale * vector(at) - p, side.scale * vector(at + 3u) - p, side.scale * vector(at + 6u) - p
    );
    let offset = closest(vec3(0.0), corners[0], corners[1], corners[2]);
    return dot(offset, offset) <= most * most;
}

fn is_box_within(side: sides::Side, at: u32, p: vec3<f32>, reach: f32) -> bool {
    let apart = abs(side.scale * vector(at) - p) - abs(side.scale) * vector(at + 3u);
    let outside = max(apart, vec3(0.0));
    return dot(outside, outside) <= reach * reach;
}
