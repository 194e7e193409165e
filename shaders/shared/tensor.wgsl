#define_import_path faceoff::tensor

// Symmetric tensors of rank two, for inertia.

#import faceoff::math::{max_component, matrix}

struct Tensor {
    // xx, yy, zz.
    diagonal: vec3<f32>,
    // xy, xz, yz.
    off_diagonal: vec3<f32>,
}

fn no_tensor() -> Tensor {
    return Tensor(vec3(0.0), vec3(0.0));
}

fn is_zero(s: Tensor) -> bool {
    return all(s.diagonal == vec3(0.0)) && all(s.off_diagonal == vec3(0.0));
}

fn apply_tensor(s: Tensor, v: vec3<f32>) -> vec3<f32> {
    let d = s.diagonal;
    let m = s.off_diagonal;
    return vec3(
        d.x * v.x + m.x * v.y + m.y * v.z,
        m.x * v.x + d.y * v.y + m.z * v.z,
        m.y * v.x + m.z * v.y + d.z * v.z,
    );
}

// The tensor rotated by the unit quaternion q.
fn rotated_tensor(s: Tensor, q: vec4<f32>) -> Tensor {
    let axes = matrix(q);
    let d = s.diagonal;
    let m = s.off_diagonal;
    let own = mat3x3(vec3(d.x, m.x, m.y), vec3(m.x, d.y, m.z), vec3(m.y, m.z, d.z));
    let rotated = axes * own * transpose(axes);
    return Tensor(vec3(rotated[0].x, rotated[1].y, rotated[2].z), vec3(rotated[1].x, rotated[2].x, rotated[2].y));
}

// The inverse; zero if the tensor is singular.
fn inverse_tensor(s: Tensor) -> Tensor {
    // Scaled to the largest entry: the determinant of a small body's tensor would leave the range of f32.
    let size = max(max_component(abs(s.diagonal)), max_component(abs(s.off_diagonal)));
    if !(size > 0.0) {
        return no_tensor();
    }
    let d = s.diagonal / size;
    let m = s.off_diagonal / size;
    let diagonal = d.yxx * d.zzy - m.zyx * m.zyx;
    let off_diagonal = vec3(m.y * m.z - m.x * d.z, m.x * m.z - m.y * d.y, m.x * m.y - m.z * d.x);
    let determinant = d.x * diagonal.x + m.x * off_diagonal.x + m.y * off_diagonal.y;
    let scale = determinant * size;
    if !(abs(scale) > 0.0) {
        return no_tensor();
    }
    return Tensor(diagonal / scale, off_diagonal / scale);
}

// Without the rows and columns where the mask is 0.
fn masked_tensor(s: Tensor, mask: vec3<f32>) -> Tensor {
    return Tensor(s.diagonal * mask, s.off_diagonal * mask.xxy * mask.yzz);
}
