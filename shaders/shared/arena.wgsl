#define_import_path faceoff::arena

// The meshes, all in one array of words. The bindings are declared here, because WGSL functions cannot take a storage
// array as an argument.

#import faceoff::constants::shared::HEIGHT_STEPS
#import faceoff::math::direction
#import faceoff::types::Mesh

@group(0) @binding(0) var<storage, read> meshes: array<Mesh>;
@group(0) @binding(1) var<storage, read> words: array<u32>;

fn vector(at: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(vec3(words[at], words[at + 1u], words[at + 2u]));
}

// The support point of a mesh along u, which may have any length but zero: a point p whose dot(p, u) is at least that
// of any vertex. Relative to the centre of mass, in the mesh's own axes. The twin of `src/projection/heights.rs`.
fn support(heights: u32, u: vec3<f32>) -> vec3<f32> {
    let d = abs(direction(u));
    let n = i32(HEIGHT_STEPS);
    let at = d.xy * (f32(n) / max(d.x + d.y + d.z, 1.0e-6));
    let i = min(i32(at.x), n - 1);
    let j = min(i32(at.y), n - 1 - i);
    let down = (at.x - f32(i)) + (at.y - f32(j)) > 1.0 && i + j < n - 1;
    let octant = i32(dot(bitcast<vec3<u32>>(u) >> vec3(31u), vec3(1u, 2u, 4u)));
    let triangle = octant * n * n + i * (2 * n - i) + 2 * j + select(0, 1, down);
    return vector(heights + 3u * u32(triangle));
}
