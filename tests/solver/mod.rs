//! The solver against analytic solutions. Contact points come from spheres, boxes and planes of these tests.

#[macro_use]
mod physical;

mod bodies;
mod cloud;
mod friction;
mod overlap;
mod rest;
mod restitution;
mod same_bits;
pub mod shapes;
mod speeds;
mod spin;
mod warm_start;
pub mod world;

/// The physical tests on the CPU.
mod on_cpu {
    macro_rules! on_cpu {
        ($($module:ident { $($test:ident,)* })*) => {
            $(mod $module {
                $(#[test]
                fn $test() {
                    crate::solver::$module::$test();
                })*
            })*
        };
    }
    physical_tests!(on_cpu);
}
