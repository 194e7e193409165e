//! Optional third-party meshes, which are not part of the repository: they may lie beside the checkout.

use crate::asset::{CollisionMesh, import_file};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Once;

/// The file of this name, if it exists. Otherwise says once in a process that checks are left out.
pub fn file(name: &str) -> Option<PathBuf> {
    static SAID: Once = Once::new();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(name);
    if path.is_file() {
        return Some(path);
    }
    SAID.call_once(|| {
        // Not with `eprintln`, which the harness keeps to itself where a test passes.
        let text = format!(
            "Left out: checks of third-party data, which is not here: {} and others\n",
            path.display()
        );
        let _ = std::io::stderr().write_all(text.as_bytes());
    });
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
