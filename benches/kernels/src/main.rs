//! What a real card's compiler makes of each kernel, without the card:
//! `cargo run --release --manifest-path benches/kernels/Cargo.toml`.
//!
//! Mesa's driver for AMD, RADV, can be told that a card of some family is there. It then compiles with its production
//! compiler, ACO, and runs nothing. It tells registers, spills, occupancy, and estimates of the time of a wave. These
//! are not times on a card: compare them before and after a change.
//!
//! Debian and Ubuntu have the driver in `mesa-vulkan-drivers`, beside the one that runs kernels on the CPU.

mod driver;
mod spirv;
mod table;

use clap::Parser;
use std::error::Error;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use table::Compiled;

/// Where Debian and Ubuntu describe the driver.
const DRIVER: &str = "/usr/share/vulkan/icd.d/radeon_icd.x86_64.json";

/// Compile all kernels for cards that are not there, and print a table in Markdown.
#[derive(Parser)]
struct Options {
    /// Families of cards. RDNA1: NAVI14; RDNA2: NAVI21; RDNA3: GFX1100; GCN: VEGA10, POLARIS10.
    #[arg(long, value_delimiter = ',', default_value = "NAVI21,GFX1100")]
    family: Vec<String>,
    /// Only kernels whose names contain this.
    #[arg(long, default_value = "", hide_default_value = true)]
    kernel: String,
    /// The description of the driver.
    #[arg(long, default_value = DRIVER)]
    driver: PathBuf,
    /// Figures to compare with, as --json has written them.
    #[arg(long)]
    before: Option<PathBuf>,
    /// Write all figures as JSON to this file.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Compile for the family that the environment names, and print JSON.
    #[arg(long, hide = true)]
    compile: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    if options.compile {
        let kernels = spirv::all(&options.kernel)?;
        println!("{}", serde_json::to_string(&driver::compile(&kernels)?)?);
        return Ok(());
    }
    if !options.driver.is_file() {
        return Err(format!(
            "there is no driver at {}: install mesa-vulkan-drivers, or name it with --driver",
            options.driver.display()
        )
        .into());
    }
    let mut all = Vec::new();
    for family in &options.family {
        let compiled = compile(&options, family)?;
        all.push((family.clone(), compiled));
    }
    let before = match &options.before {
        Some(path) => serde_json::from_str(&std::fs::read_to_string(path)?)?,
        None => Vec::new(),
    };
    table::print(&all, &before);
    if let Some(path) = &options.json {
        std::fs::write(path, serde_json::to_string_pretty(&all)?)?;
    }
    Ok(())
}

/// Compiles in a process of its own: the driver reads the family when it is loaded.
fn compile(options: &Options, family: &str) -> Result<Vec<Compiled>, Box<dyn Error>> {
    let output = Command::new(std::env::current_exe()?)
        .args(["--compile", "--kernel", &options.kernel])
        .env("RADV_FORCE_FAMILY", family)
        .env("VK_ICD_FILENAMES", &options.driver)
        .env("VK_DRIVER_FILES", &options.driver)
        // What was compiled before would take no time.
        .env("MESA_SHADER_CACHE_DISABLE", "true")
        .stderr(Stdio::inherit())
        .output()?;
    if !output.status.success() {
        return Err(format!("{family}: the driver fails ({})", output.status).into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}
