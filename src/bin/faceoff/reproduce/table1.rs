//! Table 1 and figure 6: the paper's box in the product's own step.

use super::plot::{self, Series};
use super::report::{Report, Table};
use super::world::{Shape, World};
use super::{Plan, paper};
use crate::{CullingChoice, Outcome, frames};
use serde_json::json;

/// How triangles are chosen for the test.
pub const MODES: [CullingChoice; 2] = [CullingChoice::Exact, CullingChoice::Faces];

/// What a table is measured on.
pub struct Device {
    pub world: World,
    /// How tables and legends name it.
    pub name: &'static str,
    /// The rows of the paper's table that are measured.
    pub rows: Vec<&'static paper::Printed>,
    /// Steps of each row.
    pub steps: usize,
}

/// Table 1, with the paper's row beside ours.
pub fn table_1(plan: &Plan, devices: &mut [Device], shapes: &[Shape; 2], report: &mut Report) -> Outcome {
    let mut table = Table::new(
        "table1",
        &[
            "shape",
            "bodies",
            "backend",
            "culling",
            "sphere_pairs",
            "touching_pairs",
            "broad_ms",
            "narrow_ms",
            "both_ms",
            "steps",
            "us_per_sphere_pair",
            "paper_pairs",
            "paper_ms",
            "paper_us_per_pair",
            "paper_ms_over_ours",
        ],
    );
    for shape in shapes {
        let (mut ms, mut cost) = (Vec::new(), Vec::new());
        let printed = |row: &paper::Printed| {
            if shape.name == "knot" {
                row.knot_ms
            } else {
                row.torus_ms
            }
        };
        let line = |name: &str, points| Series {
            name: name.to_owned(),
            points,
        };
        let of_paper = |value: &dyn Fn(&paper::Printed) -> f64| {
            paper::TABLE_1
                .iter()
                .map(|row| (row.bodies as f64, value(row)))
                .collect()
        };
        ms.push(line("paper, GeForce 8800 GTX", of_paper(&printed)));
        cost.push(line(
            "paper, GeForce 8800 GTX",
            of_paper(&|row| 1e3 * printed(row) / f64::from(row.pairs)),
        ));
        for device in devices.iter_mut() {
            for culling in MODES {
                let (mut all, mut each) = (Vec::new(), Vec::new());
                for row in &device.rows {
                    device.world.fill(plan, shape, row.bodies, culling)?;
                    let m = device.world.measure(device.steps)?;
                    let both = m.broad_ms + m.narrow_ms;
                    let per_pair = 1e3 * both / m.sphere_pairs.max(1.0);
                    table.rows.push(vec![
                        json!(shape.name),
                        json!(row.bodies),
                        json!(device.name),
                        json!(culling.name()),
                        json!(m.sphere_pairs as u64),
                        json!(m.touching as u64),
                        json!(m.broad_ms),
                        json!(m.narrow_ms),
                        json!(both),
                        json!(device.steps),
                        json!(per_pair),
                        json!(row.pairs),
                        json!(printed(row)),
                        json!(1e3 * printed(row) / f64::from(row.pairs)),
                        json!(printed(row) / both),
                    ]);
                    all.push((row.bodies as f64, both));
                    each.push((row.bodies as f64, per_pair));
                    plan.bar.inc(1);
                }
                ms.push(line(&format!("{}, {}", device.name, culling.name()), all));
                cost.push(line(&format!("{}, {}", device.name, culling.name()), each));
            }
        }
        let name = shape.name;
        report.plot(
            &format!("table1_{name}"),
            plot::svg(
                &format!("Table 1, {name}: broad and narrow phase"),
                "bodies",
                "milliseconds per step",
                &ms,
            )?,
        );
        report.plot(
            &format!("cost_{name}"),
            plot::svg(
                &format!("Table 1, {name}: cost of a pair"),
                "bodies",
                "microseconds per sphere pair",
                &cost,
            )?,
        );
    }
    report.table(&table);
    Ok(())
}

/// Figure 6: the largest boxes of table 1.
pub fn figure_6(plan: &Plan, device: &mut Device, shapes: &[Shape; 2], report: &mut Report) -> Outcome {
    let bodies = paper::TABLE_1.iter().map(|row| row.bodies).max().unwrap_or_default();
    for shape in shapes {
        let framing = device.world.fill(plan, shape, bodies, CullingChoice::Exact)?;
        let picture = frames::draw(device.world.app.world_mut(), &framing);
        report.picture(&picture, &format!("{bodies} bodies of shape {} in the box", shape.name))?;
        plan.bar.inc(1);
    }
    Ok(())
}
