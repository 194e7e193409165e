//! [`Poses`]: where colliders are on the device, for shaders that draw them.

use wgpu::Buffer;

/// Two poses of every collider, in the order of the last submitted step. Its results may not be known yet.
///
/// Draw what is between the two poses: at the part of the way that `plugin::drawn_part` tells. Then motion is smooth at
/// any frame rate, up to one step behind, although components stay as they were. [`Poses::WGSL`] has the functions for
/// that. A collider that was placed appears at its new place at once.
///
/// The next step overwrites both buffers, and growing worlds replace them. With Bevy's pipelined rendering the next
/// step may run before this frame is drawn: copy the buffers on the GPU when the frame is extracted, as the example
/// `swarm` does.
///
/// ```
/// use bevy_faceoff::plugin::Poses;
///
/// let shader = format!(
///     "{}
///     @group(0) @binding(0) var<storage, read> before: array<FaceoffBefore>;
///     @group(0) @binding(1) var<storage, read> after: array<FaceoffAfter>;
///     @group(0) @binding(2) var<uniform> part: f32;
///
///     @vertex
///     fn draw(@builtin(instance_index) i: u32, @location(0) point: vec3<f32>) -> @builtin(position) vec4<f32> {{
///         let pose = faceoff_pose(before[i], after[i], part);
///         return vec4(faceoff_point(pose, point), 1.0); // times the matrix of a camera
///     }}",
///     Poses::WGSL
/// );
/// # assert!(shader.contains("fn faceoff_point"));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Poses<'a> {
    /// Before that step: an array of `FaceoffBefore`.
    pub previous: &'a Buffer,
    /// After it: an array of `FaceoffAfter`.
    pub current: &'a Buffer,
    /// Number of colliders.
    pub bodies: u32,
}

impl Poses<'_> {
    /// The types of the buffers' elements, and functions that blend two poses and place a point, for the beginning of a
    /// shader.
    pub const WGSL: &'static str = include_str!("../../../shaders/draw/poses.wgsl");
}
