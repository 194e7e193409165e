//! Writes the generated meshes and their bake recipes into `assets/`: `cargo run --example make_assets`.

use bevy_faceoff::asset::{Recipe, to_obj};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::projection::BakeSettings;
use std::path::Path;

/// Name and text of every file.
pub fn files() -> Vec<(String, String)> {
    [
        ("torus", shapes::torus_240(), true),
        ("knot", shapes::knot_1120(), true),
        ("ring", shapes::ring(), false),
        ("cube", shapes::cube(1.0), false),
        ("ball", shapes::ball_320(), false),
    ]
    .into_iter()
    .flat_map(|(name, mesh, faces)| {
        let recipe = Recipe {
            mesh: format!("{name}.obj"),
            part: None,
            settings: BakeSettings {
                faces,
                ..Default::default()
            },
        };
        [
            (format!("{name}.obj"), to_obj(&mesh)),
            (format!("{name}.bake.ron"), recipe.to_text()),
        ]
    })
    .collect()
}

#[allow(dead_code)] // A test includes this file to compare its output with the files in the repository.
fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    std::fs::create_dir_all(&folder)?;
    for (name, text) in files() {
        let path = folder.join(name);
        std::fs::write(&path, &text)?;
        println!("{} ({} bytes)", path.display(), text.len());
    }
    Ok(())
}
