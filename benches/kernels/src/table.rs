//! What the compiler tells of a kernel, and the table on standard output.

use serde::{Deserialize, Serialize};

/// What the compiler tells of a kernel.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Compiled {
    name: String,
    /// Vector registers of a thread.
    registers: f64,
    /// Registers of both kinds that had to go to memory.
    spilled: f64,
    /// Bytes of memory that a thread has for itself.
    scratch: f64,
    /// Bytes that a workgroup shares.
    shared: f64,
    /// Waves that fit a SIMD unit: occupancy.
    waves: f64,
    instructions: f64,
    /// Estimated cycles of a wave that is alone.
    latency: f64,
    /// Estimated cycles of a wave among as many as fit.
    throughput: f64,
    /// Time of the compilation.
    milliseconds: f64,
}

/// What is known of each family.
pub type Families = Vec<(String, Vec<Compiled>)>;

impl Compiled {
    /// Nothing is known but the time.
    pub fn new(name: &str, milliseconds: f64) -> Self {
        Self {
            name: name.to_owned(),
            milliseconds,
            ..Self::default()
        }
    }

    /// Takes a figure by the driver's name for it.
    pub fn note(&mut self, name: &str, value: f64) {
        match name {
            "VGPRs" => self.registers = value,
            "Spilled SGPRs" | "Spilled VGPRs" => self.spilled += value,
            "Scratch size" => self.scratch = value,
            "LDS size" => self.shared = value,
            "Subgroups per SIMD" => self.waves = value,
            "Instructions" => self.instructions = value,
            "Latency" => self.latency = value,
            "Inverse Throughput" => self.throughput = value,
            _ => {}
        }
    }

    fn cells(&self, before: Option<&Self>) -> String {
        let cell = |get: fn(&Self) -> f64| match before.map(get) {
            Some(old) if old != get(self) => format!("{:.0} → {:.0}", old, get(self)),
            _ => format!("{:.0}", get(self)),
        };
        let cells = [
            cell(|c| c.registers),
            cell(|c| c.spilled),
            cell(|c| c.scratch),
            cell(|c| c.shared),
            cell(|c| c.waves),
            cell(|c| c.instructions),
            cell(|c| c.latency),
            cell(|c| c.throughput),
            format!("{:.0}", self.milliseconds),
        ];
        cells.join(" | ")
    }
}

/// Prints a table for each family, the slowest kernels first.
pub fn print(families: &Families, before: &Families) {
    for (family, compiled) in families {
        let old = before.iter().find(|(name, _)| name == family).map(|(_, old)| old);
        let mut rows: Vec<&Compiled> = compiled.iter().collect();
        rows.sort_by(|a, b| b.latency.total_cmp(&a.latency));
        let total: f64 = rows.iter().map(|row| row.milliseconds).sum();
        println!(
            "\n{family}: {} kernels, compiled one after the other in {total:.0} ms\n",
            rows.len()
        );
        println!(
            "| kernel | registers | spilled | scratch, bytes | shared, bytes | waves | instructions | latency, cycles | a wave among \
             many, cycles | compiled in ms |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|");
        for row in rows {
            let old = old.and_then(|old| old.iter().find(|old| old.name == row.name));
            println!("| {} | {} |", row.name, row.cells(old));
        }
    }
}
