//! Baked files whose source has changed since.
//!
//! Bevy's readers give no modification times, which would also be wrong after a checkout or an unpacked archive. But a
//! baked file holds the hash of its source. The source is looked for beside it: first the file that the recipe
//! `knot.bake.ron` of `knot.faceoff` names, else a mesh file of the same name. A game that is shipped without its
//! sources has nothing to compare.

use super::jobs::on_compute_pool;
use super::loader::{mesh_path, path_beside, read_file};
use crate::asset::MeshPart;
use crate::asset::format::{self, Hash, MAGIC};
use crate::asset::import::{Source, source_hash};
use crate::asset::recipe::Recipe;
use bevy::asset::{AssetPath, LoadContext};

/// Extensions of mesh files that may be the source of a baked file.
const SOURCES: [&str; 6] = ["glb", "gltf", "obj", "stl", "ply", "off"];

/// What is known of the source of a baked file.
pub(super) enum State {
    /// The source has not changed, or does not exist.
    Fresh,
    /// The recipe beside the baked file names another mesh than the baked one.
    Recipe {
        recipe_path: AssetPath<'static>,
        recipe: Recipe,
        mesh_path: AssetPath<'static>,
        mesh: Vec<u8>,
    },
    /// There is no recipe, and this file of the same name differs from the baked mesh. It may be an unrelated file.
    Other(AssetPath<'static>),
}

/// Compares the baked file at `path` with its source.
pub(super) async fn state(context: &mut LoadContext<'_>, path: &AssetPath<'static>, baked_from: Hash) -> State {
    // A browser would ask the server for each candidate file, and each miss is an error in its console.
    let asks_a_server = cfg!(target_arch = "wasm32");
    // The asset processor, and programs that bake at run time, write no hash.
    if asks_a_server || baked_from == Hash::default() {
        return State::Fresh;
    }
    let recipe_path = with_extension(path, "bake.ron");
    if let Ok(bytes) = read_file(context, &recipe_path).await {
        return of_recipe(context, recipe_path, bytes, baked_from)
            .await
            .unwrap_or(State::Fresh);
    }
    let mut other = None;
    for extension in SOURCES {
        let source = with_extension(path, extension);
        let Ok(bytes) = read_file(context, &source).await else {
            continue;
        };
        match hash(context, &source, bytes, None, false).await {
            Some(hash) if hash == baked_from => return State::Fresh,
            Some(_) if other.is_none() => other = Some(source),
            _ => {}
        }
    }
    other.map_or(State::Fresh, State::Other)
}

/// `None` if the recipe or its mesh cannot be read: then nothing tells that the baked file is old.
async fn of_recipe(
    context: &mut LoadContext<'_>,
    recipe_path: AssetPath<'static>,
    bytes: Vec<u8>,
    baked_from: Hash,
) -> Option<State> {
    // A processed recipe is itself a baked file.
    if bytes.starts_with(&MAGIC) {
        return None;
    }
    let recipe = Recipe::parse(&bytes).ok()?;
    let mesh_path = mesh_path(&recipe_path, &recipe.mesh).ok()?;
    let mesh = read_file(context, &mesh_path).await.ok()?;
    let found = hash(
        context,
        &mesh_path,
        mesh.clone(),
        recipe.part.clone(),
        recipe.read_outside,
    )
    .await?;
    Some(if found == baked_from {
        State::Fresh
    } else {
        State::Recipe {
            recipe_path,
            recipe,
            mesh_path,
            mesh,
        }
    })
}

/// The hash that a bake of this mesh would write.
async fn hash(
    context: &mut LoadContext<'_>,
    path: &AssetPath<'static>,
    bytes: Vec<u8>,
    part: Option<MeshPart>,
    read_outside: bool,
) -> Option<Hash> {
    let name = path.path().to_string_lossy().into_owned();
    let opened = on_compute_pool(move || {
        let source = Source::open(&name, &bytes[..])?;
        let files = source.files(read_outside)?.to_vec();
        Ok((bytes, files))
    });
    let (bytes, names) = opened.await.ok()?;
    let mut files = Vec::new();
    for name in &names {
        files.push(read_file(context, &path_beside(path, name).ok()?).await.ok()?);
    }
    let hash = on_compute_pool(move || {
        // A recipe may name a baked file, which is a source like any other.
        Ok(if bytes.starts_with(&MAGIC) {
            format::source_hash(&bytes)
        } else {
            source_hash(&bytes, part.as_ref(), &files)
        })
    });
    hash.await.ok()
}

/// `knot.faceoff` with the extension of another file.
fn with_extension(path: &AssetPath<'static>, extension: &str) -> AssetPath<'static> {
    AssetPath::from_path_buf(path.path().with_extension(extension)).with_source(path.source().clone_owned())
}
