//! Sharing the device of Bevy's renderer.

#[cfg(feature = "bevy_render")]
pub use shared::recover_from_device_loss;
#[cfg(feature = "bevy_render")]
pub(crate) use shared::{is_coming, new_device};

#[cfg(feature = "bevy_render")]
mod shared {
    use crate::gpu::device::Gpu;
    use bevy::prelude::*;
    use bevy::render::RenderPlugin;
    use bevy::render::error_handler::{ErrorType, RenderError, RenderErrorHandler, RenderErrorPolicy};
    use bevy::render::renderer::{RenderAdapterInfo, RenderDevice, RenderQueue, WgpuWrapper};
    use bevy::render::settings::RenderCreation;
    use std::sync::{Arc, Weak};
    use wgpu::{InstanceFlags, Queue};

    /// The renderer's queue when its device was returned last.
    ///
    /// It identifies the device, because each device has its own queue. Devices of wgpu do not compare reliably:
    /// devices of two instances may be equal, and the renderer recovers with a new instance.
    #[derive(Resource)]
    struct SharedQueue(Weak<WgpuWrapper<Queue>>);

    /// Whether the renderer may have a device once all plugins are finished.
    pub(crate) fn is_coming(app: &App) -> bool {
        app.is_plugin_added::<RenderPlugin>()
    }

    /// The renderer's device, if it was not returned before.
    pub(crate) fn new_device(world: &mut World) -> Option<Gpu> {
        let device = world.get_resource::<RenderDevice>()?;
        let queue = world.get_resource::<RenderQueue>()?;
        let info = world.get_resource::<RenderAdapterInfo>()?;
        let now = Arc::downgrade(&queue.0);
        let before = world.get_resource::<SharedQueue>();
        if before.is_some_and(|SharedQueue(before)| before.ptr_eq(&now)) {
            return None;
        }
        // The device does not tell. By default it checks indirect dispatches.
        let flags = InstanceFlags::default().with_env();
        let gpu = Gpu::new(
            device.wgpu_device().clone(),
            (**queue.0).clone(),
            (*info.0).clone(),
            flags,
        );
        world.insert_resource(SharedQueue(now));
        Some(gpu)
    }

    /// A `RenderErrorHandler` that recovers from a lost device with Bevy's default settings. The stages continue on the
    /// new device. All other errors go to Bevy's default handler, which ends the app.
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

/// Without the feature there is no renderer.
#[cfg(not(feature = "bevy_render"))]
pub(crate) fn is_coming(_: &bevy::prelude::App) -> bool {
    false
}
