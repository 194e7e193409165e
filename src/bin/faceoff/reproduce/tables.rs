//! What the paper does not show of its face table: recall by regime, sizes, and bake times.

#[path = "../../../../benches/recall/cases.rs"]
mod cases;
#[path = "../../../../benches/recall/recall.rs"]
mod recall;

use super::Plan;
use super::plot::{self, Series};
use super::report::{Report, Table};
use super::world::Shape;
use crate::Outcome;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::projection::{BakeSettings, Progress, bake_pool};
use serde_json::json;
use std::time::Instant;

/// Bakes a shape with a face table.
pub fn bake(shape: &CollisionMesh, degrees: u32, image: u32) -> Outcome<CollisionMesh> {
    let settings = BakeSettings {
        faces: true,
        degrees,
        image,
        ..BakeSettings::default()
    };
    Ok(shape.rebake(settings, bake_pool(), &Progress::default())?)
}

/// Recall of each approximate mode, by regime.
pub fn recall(plan: &Plan, shapes: &[Shape; 2], report: &mut Report) {
    let mut table = Table::new(
        "recall",
        &[
            "shape",
            "regime",
            "touching_pairs",
            "face_pairs",
            "faces_any",
            "faces_share",
            "front_any",
            "front_share",
            "eq4_any",
            "eq4_share",
        ],
    );
    for shape in shapes {
        // The table is that of the file's triangles: the regimes look faces up by their index in the file.
        let original = match shape.name {
            "knot" => bevy_faceoff::geometry::shapes::knot_1120(),
            _ => bevy_faceoff::geometry::shapes::torus_240(),
        };
        recall::measure(&original, &shape.mesh, plan.cases, |regime, tally| {
            let mut row = vec![
                json!(shape.name),
                json!(regime.name),
                json!(tally.pairs),
                json!(tally.faces),
            ];
            for found in &tally.found {
                row.push(json!(found.any as f64 / tally.pairs as f64));
                row.push(json!(found.faces as f64 / tally.faces as f64));
            }
            table.rows.push(row);
            plan.bar.inc(1);
        });
    }
    report.table(&table);
}

/// Sizes and bake times against the angular step and the size of the image.
pub fn sizes(plan: &Plan, shapes: &[Shape; 2], report: &mut Report) -> Outcome {
    let mut table = Table::new(
        "bakes",
        &[
            "shape",
            "degrees",
            "image_pixels",
            "bake_s",
            "groups",
            "mean_visible",
            "raw_bytes",
            "run_length_bytes",
            "deduplicated_bytes",
        ],
    );
    let (degrees, images) = (plan.degrees, plan.images);
    for shape in shapes {
        let bare = CollisionMesh::without_faces(&shape.mesh.mesh, BakeSettings::default());
        for &step in degrees {
            for &image in images {
                let start = Instant::now();
                let baked = bake(&bare, step, image)?;
                let seconds = start.elapsed().as_secs_f64();
                let stats = baked.faces.as_ref().ok_or("the bake left no face table")?.stats();
                table.rows.push(vec![
                    json!(shape.name),
                    json!(step),
                    json!(image),
                    json!(seconds),
                    json!(stats.groups),
                    json!(stats.mean_visible),
                    json!(stats.raw_bytes),
                    json!(stats.run_length_bytes),
                    json!(stats.memory_bytes),
                ]);
                plan.bar.inc(1);
            }
        }
    }
    let largest = f64::from(images.iter().copied().max().unwrap_or_default());
    let series = |column: &str, shape: &str, name: String| Series {
        name,
        points: table
            .rows
            .iter()
            .filter(|row| row[0] == shape && table.number(row, "image_pixels") == Some(largest))
            .filter_map(|row| table.number(row, "degrees").zip(table.number(row, column)))
            .collect(),
    };
    let mut bytes = Vec::new();
    let mut seconds = Vec::new();
    for shape in ["torus", "knot"] {
        for (column, name) in [
            ("raw_bytes", "raw"),
            ("run_length_bytes", "run-length"),
            ("deduplicated_bytes", "deduplicated"),
        ] {
            bytes.push(series(column, shape, format!("{shape}, {name}")));
        }
        seconds.push(series("bake_s", shape, shape.to_owned()));
    }
    let title = |what: &str| format!("{what}, images of {largest} x {largest} pixels");
    report.plot(
        "table_bytes",
        plot::svg(
            &title("Size of the face table"),
            "angular step in degrees",
            "bytes",
            &bytes,
        )?,
    );
    report.plot(
        "bake_time",
        plot::svg(&title("Time of a bake"), "angular step in degrees", "seconds", &seconds)?,
    );
    report.table(&table);
    Ok(())
}
