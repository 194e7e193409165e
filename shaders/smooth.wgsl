#define_import_path faceoff::smooth

// Where a round surface touches of which a mesh has only corners. `src/stages/manifolds/cpu/smooth.rs` says why.

#import faceoff::arena::words
#import faceoff::sides
#import faceoff::types as t

// How far, as a sine, the normal at a vertex may differ from a contact's.
const SMOOTH: f32 = 0.1;

// From where a feature with a vertex of `side` touches to where the smooth surface around the vertex does. `out` is the
// feature's normal away from the side, `roundness` the surface's.
fn slide(side: sides::Side, number: u32, out: vec3<f32>, roundness: f32) -> vec3<f32> {
    let corner = sides::vertex(side, number);
    let inward = toward_center(side, number, corner);
    let square = dot(inward, inward);
    let along = -dot(inward, out);
    if !(square > 0.0 && along > 0.0) {
        return vec3(0.0);
    }
    let across = (-inward - out * along) / sqrt(square);
    if dot(across, across) > SMOOTH * SMOOTH {
        return vec3(0.0);
    }
    // No farther round than to beside the centre of mass, as the solver takes it.
    let inside = max(dot(corner - side.center, out), 0.0);
    return -across * min(roundness, inside);
}

// Along the way from a vertex to the centre of the sphere that fits it and its neighbours best; zero if none does.
fn toward_center(side: sides::Side, number: u32, corner: vec3<f32>) -> vec3<f32> {
    var x = vec3(0.0);
    var y = vec3(0.0);
    var z = vec3(0.0);
    var sum = vec3(0.0);
    let range = sides::neighbors(side, number);
    for (var n = range.x; n < range.y; n++) {
        // From a point of a sphere to its centre `c` and another point `e`: 2 c . e = e . e.
        let edge = sides::vertex(side, words[n]) - corner;
        let square = dot(edge, edge);
        if square > 0.0 {
            x += edge * (edge.x / square);
            y += edge * (edge.y / square);
            z += edge * (edge.z / square);
        }
        sum += edge;
    }
    // The inverse of a symmetric matrix but for its determinant, which is positive.
    if dot(x, cross(y, z)) <= 0.0 {
        return vec3(0.0);
    }
    return vec3(dot(cross(y, z), sum), dot(cross(z, x), sum), dot(cross(x, y), sum));
}
