//! The harness of tests that need a GPU, real or emulated on the CPU as by Mesa's lavapipe.
//!
//! Without one every test is reported as *ignored*, or fails where one is required: see `no_device.rs`. The device is
//! opened once per thread. Two tests run at a time unless configured otherwise: lavapipe uses all cores for a large
//! dispatch, but one for small ones and to compile kernels.

#![allow(dead_code)]

#[path = "no_device.rs"]
mod no_device;

use bevy_faceoff::gpu::device::{self, Gpu, NoGpu};
use bevy_faceoff::types::kernel_cache::KernelCache;
use libtest_mimic::{Arguments, Completion, Trial};
use no_device::ignored_or_failed;
use std::cell::OnceCell;
use std::time::Instant;

/// Name and function of a test that needs the device.
pub type Test = (&'static str, fn(&Gpu));

/// Name and function of a test that needs no device.
pub type Plain = (&'static str, fn());

thread_local! {
    /// Never closed: NVIDIA's driver crashes when a thread closes a device while the process exits.
    static DEVICE: OnceCell<&'static Result<Gpu, NoGpu>> = const { OnceCell::new() };
}

/// Runs the tests that the command line selects, and exits the process. Each test has its group's name as a prefix.
/// `prepare` runs before each test on the device.
pub fn run(on_device: &[(&str, &[Test])], anywhere: &[(&str, &[Plain])], prepare: fn(&Gpu)) -> ! {
    let mut arguments = Arguments::from_args();
    arguments.test_threads = arguments.test_threads.or(Some(2));
    let mut trials = Vec::new();
    for (group, tests) in anywhere {
        trials.extend(tests.iter().map(|&(name, test)| {
            Trial::test(format!("{group}::{name}"), move || {
                test();
                Ok(())
            })
        }));
    }
    for (group, tests) in on_device {
        trials.extend(tests.iter().map(|&(name, test)| {
            let name = format!("{group}::{name}");
            Trial::ignorable_test(name.clone(), move || {
                DEVICE.with(|device| match device.get_or_init(|| Box::leak(Box::new(open()))) {
                    Ok(gpu) => {
                        let start = Instant::now();
                        prepare(gpu);
                        test(gpu);
                        println!("{name}: {:.1} s", start.elapsed().as_secs_f32());
                        Ok(Completion::Completed)
                    }
                    Err(reason) => ignored_or_failed(reason),
                })
            })
        }));
    }
    libtest_mimic::run(&arguments, trials).exit()
}

fn open() -> Result<Gpu, NoGpu> {
    let gpu = device::open(true, &KernelCache::Off)?;
    println!("on {} ({:?})", gpu.info.name, gpu.info.device_type);
    Ok(gpu)
}
