//! Optional third-party meshes, which are not part of the repository: they may lie beside the checkout.

use crate::asset::{CollisionMesh, import_file};
use std::path::{Path, PathBuf};

/// The file of this name, if it exists; otherwise prints what is skipped.
pub fn file(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(name);
    if path.is_file() {
        return Some(path);
    }
    println!("data not present, not run: {name}");
    None
}

/// Files in the folder `meshes`: a nut and the bolt that it fits, with an M16 thread along z. Metres.
pub const NUT_AND_BOLT: [&str; 2] = [
    "isaacgym_factory_nut_m16_loose_subdiv_3x.obj",
    "isaacgym_factory_bolt_m16_loose.obj",
];

/// Both meshes of [`NUT_AND_BOLT`].
pub fn nut_and_bolt() -> Option<[CollisionMesh; 2]> {
    let mesh = |name| {
        Some(CollisionMesh::new(
            import_file(file(&format!("meshes/{name}"))?).ok()?.mesh(),
        ))
    };
    let [nut, bolt] = NUT_AND_BOLT.map(mesh);
    Some([nut?, bolt?])
}
