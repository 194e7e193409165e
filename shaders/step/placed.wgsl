#define_import_path faceoff::placed

// Converts the solver's two-part states to poses in single precision.

#import faceoff::math::rotate
#import faceoff::solver_types as s

fn rotation_of(state: s::MotionState) -> vec4<f32> {
    let rotation = state.rotation + state.rotation_low;
    return rotation / sqrt(dot(rotation, rotation));
}

// The position of the mesh's origin. `center` is the scaled centre of mass in the mesh's own axes.
fn position_of(state: s::MotionState, center: vec3<f32>) -> vec3<f32> {
    return state.center + (state.center_low - rotate(rotation_of(state), center));
}
