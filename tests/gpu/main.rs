//! The stages on a GPU, against the same stages on the CPU.

#[cfg(feature = "bevy")]
#[path = "../common/app.rs"]
mod app;
#[cfg(feature = "bevy")]
mod apps;
mod ccd;
#[cfg(feature = "cli")]
mod cli;
mod contract;
mod dynamics;
#[path = "../common/gpu.rs"]
mod gpu;
mod kernels;
mod manifolds;
#[path = "../common/oracle/mod.rs"]
mod oracle;
mod parity;
mod primitives;
mod solver;
#[allow(dead_code)]
#[path = "../core/support.rs"]
mod support;
#[path = "../common/world.rs"]
mod world;

fn main() {
    gpu::run(
        &[
            ("primitives", primitives::TESTS),
            ("parity", parity::TESTS),
            ("manifolds", manifolds::TESTS),
            ("solver", solver::TESTS),
            ("solver", solver::PHYSICAL_TESTS),
            ("dynamics", dynamics::TESTS),
            ("dynamics", dynamics::STEP_TESTS),
            #[cfg(feature = "bevy")]
            ("apps::backend", apps::backend::TESTS),
            #[cfg(feature = "bevy")]
            ("apps::bytes", apps::bytes::TESTS),
            #[cfg(feature = "bevy")]
            ("apps::changes", apps::changes::TESTS),
            #[cfg(feature = "bevy")]
            ("apps::clock", apps::clock::TESTS),
            #[cfg(feature = "bevy")]
            ("apps::with_contacts", apps::with_contacts::TESTS),
            #[cfg(feature = "bevy")]
            ("apps::drawn", apps::drawn::TESTS),
            #[cfg(feature = "bevy")]
            ("apps::every_readback", apps::every_readback::TESTS),
            #[cfg(feature = "bevy")]
            ("apps::fast_bodies", apps::fast_bodies::TESTS),
            #[cfg(feature = "bevy")]
            ("apps::readback", apps::readback::TESTS),
            #[cfg(feature = "bevy")]
            ("apps::soak", apps::soak::TESTS),
            #[cfg(feature = "bevy")]
            ("apps::spatial_queries", apps::spatial_queries::TESTS),
            #[cfg(feature = "bevy")]
            ("apps::writes", apps::writes::TESTS),
            #[cfg(feature = "cli")]
            ("cli", cli::TESTS),
        ],
        &[("contract", contract::TESTS), ("kernels", kernels::TESTS)],
        |_gpu| {
            #[cfg(feature = "bevy")]
            app::DEVICE.set(Some(_gpu.clone()));
        },
    );
}
