//! The file that describes a scene for `faceoff check`.

use glam::{Quat, Vec3};
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// A scene file: see `faceoff check --help`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// The mesh file of each name.
    #[serde(deserialize_with = "each_once")]
    pub meshes: BTreeMap<String, PathBuf>,
    /// The bodies, in the order of the output.
    pub bodies: Vec<BodyEntry>,
}

/// A placed mesh.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyEntry {
    /// The name of its mesh.
    pub mesh: String,
    /// Position, metres.
    #[serde(default)]
    pub translation: Vec3,
    /// Rotation.
    #[serde(default)]
    pub rotation: Quat,
    /// Scale along each axis of the mesh.
    #[serde(default = "one")]
    pub scale: Vec3,
}

impl SceneFile {
    /// Reads the text of a file. Some programs begin it with a byte order mark.
    ///
    /// # Errors
    /// If the text is no scene.
    pub fn parse(text: &str) -> Result<Self, ron::error::SpannedError> {
        ron::from_str(text.strip_prefix('\u{feff}').unwrap_or(text))
    }
}

fn one() -> Vec3 {
    Vec3::ONE
}

/// Reads a map and rejects duplicate names, because bodies would silently get the wrong mesh.
fn each_once<'de, D: Deserializer<'de>>(input: D) -> Result<BTreeMap<String, PathBuf>, D::Error> {
    struct Meshes;
    impl<'de> Visitor<'de> for Meshes {
        type Value = BTreeMap<String, PathBuf>;
        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a map from names to mesh files")
        }
        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut meshes = BTreeMap::new();
            while let Some((name, file)) = map.next_entry::<String, PathBuf>()? {
                if meshes.contains_key(&name) {
                    return Err(A::Error::custom(format!(
                        "`meshes` has the name {name:?} twice; give each mesh a different name"
                    )));
                }
                meshes.insert(name, file);
            }
            Ok(meshes)
        }
    }
    input.deserialize_map(Meshes)
}
