//! GPU or CPU: where the stages run, when results arrive, and what happens if a device fails.
//!
//! # Where the stages run
//!
//! [`Backend::Auto`], the default, uses a Vulkan, Metal or DirectX 12 GPU if there is one, and else the CPU. Only
//! Vulkan has been tested. [`ActiveBackend`] and a log line say which of them runs the stages, and why. Software
//! adapters, such as Mesa's llvmpipe, are used only with [`Backend::Gpu`].
//!
//! `error: XDG_RUNTIME_DIR is invalid` on standard error comes from Mesa when it lists GPUs. It is harmless;
//! `NODEVICE_SELECT=1` in the environment avoids it.
//!
//! # When a GPU pays
//!
//! A GPU pays with many bodies. With one body or a small pile a step on a GPU waits for a hundred short dispatches,
//! and the CPU is faster: choose [`Backend::Cpu`] there.
//!
//! With 100,000 tori a step on an NVIDIA H200 is this many times as fast as on 16 CPU cores, depending on the
//! [`Response`](crate::types::settings::Response):
//!
//! | readback | times as fast |
//! |---|---|
//! | `Lockstep` | 3.0 to 3.9 |
//! | `Latent` | 3.7 to 5.3 |
//! | `Resident` | 6.7 to 14.5 |
//!
//! # What the CPU still does
//!
//! The GPU has no hooks yet: steps with [`ActiveCollisionHooks`](crate::types::hooks::ActiveCollisionHooks) run on the
//! CPU. Sleep states and the solver's impulses go from the GPU to the CPU and back. With `Latent`, components jump two
//! steps ahead when the CPU takes over, and stand still for two steps when the GPU continues.
//!
//! Steps with a [`ContinuousCollision`](crate::plugin::components::ContinuousCollision) body stay on the GPU, but the
//! CPU stops such bodies. Then each collision substep and the end of the step wait for the GPU, whatever the
//! `Readback`.
//!
//! # Differences in results
//!
//! CPU and GPU find the same pairs, up to rounding. Where single precision cannot decide whether two faces touch, the
//! CPU decides in double precision: what it calls touching is at most 1e-14 of the bodies' size apart, the rounding of
//! their corners. The GPU counts such faces as touching; they may be some millionths of the bodies' size apart.
//!
//! # Readback
//!
//! [`Readback`] sets when results of a GPU reach components:
//!
//! | | results | for |
//! |---|---|---|
//! | `Lockstep` | every step waits for them | tests, tools, servers |
//! | `Latent` | the same results, two steps later, while the app continues | games |
//! | `Resident` | bodies stay on the GPU | drawing from the GPU |
//! | `Auto`, the default | `Latent` on the renderer's device, else `Lockstep` | |
//!
//! Systems write components as always. A written value takes effect in the next step, and no older result overwrites
//! it. What was not written continues from its state on the GPU. Insert a component to place, stop or hold a body;
//! change a field to push or rotate it. The documentation of [`Readback`] has a table.
//!
//! With `Latent` and `Resident`, kernels are compiled in the background, and bodies stand still until
//! [`BackendReady`](crate::plugin::backend::BackendReady) is written.
//!
//! # The renderer's device
//!
//! A game whose steps run on a GPU wants the feature `bevy_render`: the stages then share the device of Bevy's
//! renderer, and frames need not wait for their results. Without the feature, or without a renderer, the plugin opens
//! its own device.
//!
//! # If the device fails
//!
//! | device | what happens |
//! |---|---|
//! | our own, lost | it is opened again, with the same step: up to three times if the losses soon follow each other; after the fourth the CPU takes over |
//! | ours or shared, without memory left | the CPU takes over at once |
//! | shared and lost, Bevy's default | Bevy ends the app |
//! | shared and lost, with `RenderErrorHandler(recover_from_device_loss)` | bodies stand still until Bevy has a new device, and continue from the state in their components |
//!
//! A [`BackendFailed`](crate::plugin::backend::BackendFailed) message reports all of them. `recover_from_device_loss`
//! is in [`plugin::backend`](crate::plugin::backend). Write your own handler if your `RenderPlugin` has its own
//! settings.
//!
//! # How it is tested
//!
//! The kernels are tested on Mesa's software Vulkan, and were measured on an NVIDIA H200. `docs/RELIABILITY.md` has
//! the details, and `BENCHMARKS.md` the figures.
//!
//! [`ActiveBackend`]: crate::plugin::backend::ActiveBackend
//! [`Backend::Auto`]: crate::plugin::settings::Backend::Auto
//! [`Backend::Cpu`]: crate::plugin::settings::Backend::Cpu
//! [`Backend::Gpu`]: crate::plugin::settings::Backend::Gpu
//! [`Readback`]: crate::plugin::settings::Readback
