//! The plugin on a GPU: what it says it takes, what it finds, and what happens when the device is lost.

mod app;
mod gpu;

use app::Sim;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use gpu::{Trial, run};

fn main() {
    run(vec![
        Trial::test("auto_does_not_take_an_adapter_that_computes_on_the_cpu", auto_is_a_real_one),
        Trial::test("an_app_finds_the_same_collisions_on_the_gpu", same_collisions),
        Trial::test("a_lost_device_is_opened_anew_and_no_step_is_lost", lost_device),
    ]);
}
