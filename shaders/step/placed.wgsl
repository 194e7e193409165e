#define_import_path faceoff::placed

// From the solver's two-part states to poses in single precision.

#import faceoff::math::rotate
#import faceoff::solver_types as s

fn rotation_of(state: s::MotionState) -> vec4<f32> {
    let rotation = state.rotation + state.rotation_low;
    return rotation / sqrt(dot(rotation, rotation));
}

// Where the mesh's origin lies; `center` is the centre of mass, scaled, in the mesh's own axes.
fn position_of(state: s::MotionState, center: vec3<f32>) -> vec3<f32> {
    return state.center + (state.center_low - rotate(rotation_of(state), center));
}
