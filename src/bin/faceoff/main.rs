//! The command line: simulate a scene, check placed meshes for interference, bake, draw and inspect meshes.

mod bake;
mod canvas;
mod check;
mod image;
mod inspect;
mod mesh;
mod output;
mod scene;
mod simulate;

use clap::{Parser, Subcommand, ValueEnum};
use std::error::Error;
use std::process::ExitCode;

/// Finds collisions between triangle meshes, triangle by triangle.
#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

// Each command's help stands with its options: a line here would hide all but the first sentence there.
#[derive(Subcommand)]
enum Command {
    Simulate(simulate::Options),
    Check(check::Options),
    Bake(bake::Options),
    /// Draw a mesh as the bake sees it: heights as colours, and the faces that are seen.
    Image(image::Options),
    /// Tell what a mesh file holds and what baking makes of it.
    Inspect(inspect::Options),
}

/// How triangles are chosen for the test.
#[derive(Clone, Copy, ValueEnum)]
enum CullingChoice {
    /// Conservative culls: nothing is missed.
    Exact,
}

/// Where the stages run.
#[derive(Clone, Copy, ValueEnum)]
enum BackendChoice {
    /// The best there is; at present the CPU.
    Auto,
    /// The CPU.
    Cpu,
}

/// What a command returns: nothing, or a message that names the file and what to do.
type Outcome<T = ()> = Result<T, Box<dyn Error>>;

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Simulate(options) => simulate::run(&options),
        Command::Check(options) => check::run(&options),
        Command::Bake(options) => bake::run(&options),
        Command::Image(options) => image::run(&options),
        Command::Inspect(options) => inspect::run(&options),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
