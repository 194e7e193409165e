//! Draws all tori in one call, where they are in the memory of the GPU.
//!
//! 1. When a frame is extracted, the poses are copied on the GPU, because the steps of the next frame run while this
//!    one is drawn.
//! 2. After the opaque meshes of Bevy, one call draws an instance of the mesh for each pose: `draw.wgsl`.

use crate::common::View;
use bevy::core_pipeline::core_3d::{CORE_3D_DEPTH_FORMAT, main_opaque_pass_3d, main_transparent_pass_3d};
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::mesh::VertexBufferLayout;
use bevy::prelude::*;
use bevy::render::render_resource::binding_types::{
    storage_buffer_read_only_sized, uniform_buffer, uniform_buffer_sized,
};
use bevy::render::render_resource::{
    BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries, Buffer, BufferDescriptor,
    BufferInitDescriptor, BufferUsages, ColorTargetState, ColorWrites, CommandEncoderDescriptor, CompareFunction,
    DepthStencilState, FragmentState, MultisampleState, PipelineCache, RenderPassDescriptor, RenderPipelineDescriptor,
    ShaderStages, SpecializedRenderPipeline, SpecializedRenderPipelines, StoreOp, TextureFormat, VertexFormat,
    VertexState, VertexStepMode,
};
use bevy::render::renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery};
use bevy::render::view::{ExtractedView, ViewDepthTexture, ViewTarget, ViewUniform, ViewUniformOffset, ViewUniforms};
use bevy::render::{ExtractSchedule, MainWorld, RenderApp, RenderStartup};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::{Poses, drawn_part, poses};

/// Adds the drawing to the renderer.
pub fn add_to(app: &mut App) {
    let Some(renderer) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    renderer
        .init_resource::<SpecializedRenderPipelines<SwarmPipeline>>()
        .add_systems(RenderStartup, make_pipeline)
        .add_systems(ExtractSchedule, copy_poses)
        .add_systems(
            Core3d,
            draw.after(main_opaque_pass_3d)
                .before(main_transparent_pass_3d)
                .in_set(Core3dSystems::MainPass),
        );
}

/// Turns the camera towards a box of half this side.
pub fn look_at_box(world: &mut World, half: f32) {
    let view = View {
        from: half * Vec3::new(1.2, 0.8, 2.5),
        at: Vec3::ZERO,
    };
    world.insert_resource(view);
    let mut cameras = world.query_filtered::<&mut Transform, With<Camera3d>>();
    for mut camera in cameras.iter_mut(world) {
        *camera = Transform::from_translation(view.from).looking_at(view.at, Vec3::Y);
    }
}

/// The poses of a frame.
#[derive(Resource)]
struct Swarm {
    before: Buffer,
    after: Buffer,
    /// Which part of the step after `before` has passed, from 0 to 1.
    part: Buffer,
    tori: u32,
}

/// Copies the poses from the buffers of the stages.
fn copy_poses(
    mut commands: Commands,
    main: Res<MainWorld>,
    swarm: Option<ResMut<Swarm>>,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    let Some((poses, _)) = poses(&main) else { return };
    let sizes = [poses.previous.size(), poses.current.size()];
    let mut swarm = match swarm {
        Some(swarm) if [swarm.before.size(), swarm.after.size()] == sizes => swarm,
        // The next frame has buffers.
        _ => {
            let buffer = |size, usage| {
                device.create_buffer(&BufferDescriptor {
                    label: Some("swarm"),
                    size,
                    usage: usage | BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                })
            };
            commands.insert_resource(Swarm {
                before: buffer(sizes[0], BufferUsages::STORAGE),
                after: buffer(sizes[1], BufferUsages::STORAGE),
                part: buffer(4, BufferUsages::UNIFORM),
                tori: 0,
            });
            return;
        }
    };
    queue.write_buffer(&swarm.part, 0, &drawn_part(&main).to_le_bytes());
    let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(poses.previous, 0, &swarm.before, 0, sizes[0]);
    encoder.copy_buffer_to_buffer(poses.current, 0, &swarm.after, 0, sizes[1]);
    queue.submit([encoder.finish()]);
    swarm.tori = poses.bodies;
}

/// What draws the tori.
#[derive(Resource)]
struct SwarmPipeline {
    shader: Handle<Shader>,
    bindings: BindGroupLayoutDescriptor,
    /// Three corners for each triangle of the torus.
    corners: Buffer,
    count: u32,
}

fn make_pipeline(mut commands: Commands, assets: Res<AssetServer>, device: Res<RenderDevice>) {
    let mesh = shapes::torus_240();
    let corners: Vec<_> = (0..mesh.triangles().len()).flat_map(|t| mesh.corners(t)).collect();
    let bytes: Vec<u8> = corners
        .iter()
        .flat_map(Vec3::to_array)
        .flat_map(f32::to_le_bytes)
        .collect();
    commands.insert_resource(SwarmPipeline {
        shader: assets.add(Shader::from_wgsl(
            format!("{}{}", Poses::WGSL, include_str!("draw.wgsl")),
            "swarm/draw.wgsl",
        )),
        bindings: BindGroupLayoutDescriptor::new(
            "swarm",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::VERTEX_FRAGMENT,
                (
                    uniform_buffer::<ViewUniform>(true),
                    storage_buffer_read_only_sized(false, None),
                    storage_buffer_read_only_sized(false, None),
                    uniform_buffer_sized(false, None),
                ),
            ),
        ),
        corners: device.create_buffer_with_data(&BufferInitDescriptor {
            label: Some("corners of the torus"),
            contents: &bytes,
            usage: BufferUsages::VERTEX,
        }),
        count: corners.len() as u32,
    });
}

impl SpecializedRenderPipeline for SwarmPipeline {
    /// The format of the picture, and samples per pixel.
    type Key = (TextureFormat, u32);

    fn specialize(&self, (format, count): Self::Key) -> RenderPipelineDescriptor {
        let corners = VertexBufferLayout::from_vertex_formats(VertexStepMode::Vertex, [VertexFormat::Float32x3]);
        RenderPipelineDescriptor {
            label: Some("swarm".into()),
            layout: vec![self.bindings.clone()],
            vertex: VertexState {
                shader: self.shader.clone(),
                buffers: vec![corners],
                ..default()
            },
            fragment: Some(FragmentState {
                shader: self.shader.clone(),
                targets: vec![Some(ColorTargetState {
                    format,
                    blend: None,
                    write_mask: ColorWrites::ALL,
                })],
                ..default()
            }),
            depth_stencil: Some(DepthStencilState {
                format: CORE_3D_DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(CompareFunction::GreaterEqual),
                stencil: default(),
                bias: default(),
            }),
            multisample: MultisampleState { count, ..default() },
            ..default()
        }
    }
}

fn draw(
    view: ViewQuery<(
        &ExtractedView,
        &ViewTarget,
        &ViewDepthTexture,
        &ViewUniformOffset,
        &Msaa,
    )>,
    swarm: Option<Res<Swarm>>,
    pipeline: Option<Res<SwarmPipeline>>,
    mut variants: ResMut<SpecializedRenderPipelines<SwarmPipeline>>,
    cache: Res<PipelineCache>,
    views: Res<ViewUniforms>,
    mut context: RenderContext,
) {
    let (extracted, target, depth, offset, msaa) = view.into_inner();
    let (Some(swarm), Some(pipeline), Some(views)) = (swarm, pipeline, views.uniforms.binding()) else {
        return;
    };
    let variant = variants.specialize(&cache, &pipeline, (extracted.target_format, msaa.samples()));
    let Some(compiled) = cache.get_render_pipeline(variant) else {
        return;
    };
    let bound = context.render_device().create_bind_group(
        "swarm",
        &cache.get_bind_group_layout(&pipeline.bindings),
        &BindGroupEntries::sequential((
            views,
            swarm.before.as_entire_binding(),
            swarm.after.as_entire_binding(),
            swarm.part.as_entire_binding(),
        )),
    );
    let mut pass = context.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("swarm"),
        color_attachments: &[Some(target.get_color_attachment())],
        depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
        ..default()
    });
    pass.set_render_pipeline(compiled);
    pass.set_bind_group(0, &bound, &[offset.offset]);
    pass.set_vertex_buffer(0, pipeline.corners.slice(..));
    pass.draw(0..pipeline.count, 0..swarm.tori);
}
