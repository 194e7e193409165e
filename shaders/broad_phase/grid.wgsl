#define_import_path faceoff::grid

// Cells of the broad phase. The level of a body has the smallest cells, of power-of-two size, that are no smaller than
// its diameter. So spheres that overlap lie in neighbouring cells of the larger one's level: division by a power of
// two, rounding down and the difference of the centres are exact, or rounded the same way for both.

#import faceoff::types::Body
#import faceoff::math::rotate

// Level 0 has cells of 2^-29 m, level 63 of 2^34 m; radii lie between 1e-9 m and 1e9 m.
const LEVEL_BIAS: i32 = 97;

fn level_of(radius: f32) -> i32 {
    // Slightly more than the diameter, because of the rounding of the sphere test. The exponent of the next power of
    // two.
    let above = i32(bitcast<u32>(radius * 2.0001) >> 23u) + 1;
    return clamp(above - LEVEL_BIAS, 0, 63);
}

fn cell_of(center: vec3<f32>, level: i32) -> vec3<i32> {
    let per_metre = bitcast<f32>(u32(254 - LEVEL_BIAS - level) << 23u);
    return vec3<i32>(clamp(floor(center * per_metre), vec3(-1.0e9), vec3(1.0e9)));
}

// The bucket of a cell. Several cells may share one.
fn bucket_of(cell: vec3<i32>, level: i32, mask: u32) -> u32 {
    let c = bitcast<vec3<u32>>(cell);
    var h = c.x * 0x8da6b343u + c.y * 0xd8163841u + c.z * 0xcb1ab31fu + u32(level) * 0x9e3779b9u;
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    return (h ^ (h >> 16u)) & mask;
}

// The centre of mass, in the world.
fn center_of(body: Body, mesh_center: vec3<f32>) -> vec3<f32> {
    return body.position + rotate(body.rotation, body.scale * mesh_center);
}
