//! Sharing the device of Bevy's renderer.

#[cfg(feature = "bevy_render")]
pub use shared::recover_from_device_loss;
#[cfg(feature = "bevy_render")]
pub(crate) use shared::{follow, is_coming};

#[cfg(feature = "bevy_render")]
mod shared {
    use crate::gpu::device::Gpu;
    use crate::plugin::sync::Step;
    use bevy::prelude::*;
    use bevy::render::RenderPlugin;
    use bevy::render::error_handler::{ErrorType, RenderError, RenderErrorHandler, RenderErrorPolicy};
    use bevy::render::renderer::{RenderAdapterInfo, RenderDevice, RenderQueue, WgpuWrapper};
    use bevy::render::settings::RenderCreation;
    use std::sync::{Arc, Weak};
    use wgpu::Queue;

    /// The renderer's queue when its device was shared last.
    ///
    /// It identifies the device, because each device has its own queue. Devices of wgpu do not compare reliably: devices of
    /// two instances may be equal, and the renderer recovers with a new instance.
    #[derive(Resource)]
    struct SharedQueue(Weak<WgpuWrapper<Queue>>);

    /// Whether the renderer may have a device once all plugins are finished.
    pub(crate) fn is_coming(app: &App) -> bool {
        app.is_plugin_added::<RenderPlugin>()
    }

    /// Shares the renderer's device, if it is a new one.
    pub(crate) fn follow(world: &mut World) {
        let (Some(device), Some(queue), Some(info)) = (
            world.get_resource::<RenderDevice>(),
            world.get_resource::<RenderQueue>(),
            world.get_resource::<RenderAdapterInfo>(),
        ) else {
            return;
        };
        let now = Arc::downgrade(&queue.0);
        let before = world.get_resource::<SharedQueue>();
        if before.is_some_and(|SharedQueue(before)| before.ptr_eq(&now)) {
            return;
        }
        let gpu = Gpu {
            device: device.wgpu_device().clone(),
            queue: (**queue.0).clone(),
            info: (*info.0).clone(),
        };
        world.insert_resource(SharedQueue(now));
        if let Some(mut step) = world.get_resource_mut::<Step>()
            && step.engine.share(gpu)
        {
            step.forget();
        }
    }

    /// A `RenderErrorHandler` that recovers from a lost device with Bevy's default settings. The stages continue on the new
    /// device. All other errors go to Bevy's default handler, which ends the app.
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// use bevy::render::error_handler::RenderErrorHandler;
    /// use bevy_faceoff::plugin::backend::recover_from_device_loss;
    ///
    /// # let mut app = App::new();
    /// app.insert_resource(RenderErrorHandler(recover_from_device_loss));
    /// ```
    ///
    /// If your app gives `RenderPlugin` its own settings, write a handler that returns them.
    pub fn recover_from_device_loss(
        error: &RenderError,
        main_world: &mut World,
        render_world: &mut World,
    ) -> RenderErrorPolicy {
        match error.ty {
            ErrorType::DeviceLost => RenderErrorPolicy::Recover(RenderCreation::default()),
            _ => RenderErrorHandler::default().0(error, main_world, render_world),
        }
    }
}

/// There is no renderer.
#[cfg(not(feature = "bevy_render"))]
pub(crate) fn is_coming(_: &bevy::prelude::App) -> bool {
    false
}

/// There is no renderer.
#[cfg(not(feature = "bevy_render"))]
pub(crate) fn follow(_: &mut bevy::prelude::World) {}
