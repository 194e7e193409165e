//! Collision meshes of Bevy's own meshes: baked in the background, once per mesh and settings.

use super::bevy_mesh::{BevyMeshError, Triangles};
use super::error::LoadError;
use super::jobs::{on_bake_pool, on_compute_pool};
use crate::asset::CollisionMesh;
use crate::projection::{BakeSettings, Inward};
use bevy::asset::io::AssetReaderError;
use bevy::asset::{AssetLoadError, AssetPath, AssetServerMode, LoadState};
use bevy::ecs::system::SystemParam;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, IoTaskPool, Task, block_on};
use std::sync::Arc;
use std::task::Poll;
use thiserror::Error;

/// Bytes of meshes that may be copied in a frame, about a millisecond of work. At least one bake begins in each.
const MAX_COPIED: usize = 1 << 22;

/// Why a Bevy mesh got no collision mesh.
#[derive(Clone, Debug, Error)]
pub enum MeshBakeError {
    /// The mesh is not usable.
    #[error(transparent)]
    Mesh(#[from] BevyMeshError),
    /// The handle is the default one.
    #[error("it names no mesh: its handle is Handle::default()")]
    NoMesh,
    /// Bevy could not load the mesh.
    #[error("its mesh is not loaded: {0}")]
    NotLoaded(Arc<AssetLoadError>),
    /// The baked mesh or recipe beside the mesh's file could not be loaded.
    #[error("{path}: {error}")]
    Beside {
        /// The baked mesh or the recipe.
        path: AssetPath<'static>,
        /// The reason.
        error: Arc<AssetLoadError>,
    },
    /// The bake failed.
    #[error(transparent)]
    Bake(#[from] Arc<LoadError>),
}

/// What to bake.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Source {
    /// The meshes, which are joined. Usually one.
    pub meshes: Vec<Handle<Mesh>>,
    /// `None` for the default.
    pub settings: Option<BakeSettings>,
    /// A path without extension: the baked mesh or recipe of this name is used if there is one.
    pub beside: Option<AssetPath<'static>>,
}

/// The meshes and the settings of a bake.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Key {
    meshes: Vec<AssetId<Mesh>>,
    settings: (bool, u32, u32, [u32; 3], Inward),
}

enum Bake {
    Running(Task<Result<CollisionMesh, MeshBakeError>>),
    Done(Handle<CollisionMesh>),
    Failed(MeshBakeError),
}

/// A baked mesh or recipe beside a mesh's file.
enum FileBeside {
    Looking(Task<Option<AssetPath<'static>>>),
    None,
    Found(AssetPath<'static>, Handle<CollisionMesh>),
}

/// The collision mesh of each Bevy mesh. An entry is dropped when its mesh is changed or removed.
#[derive(Resource, Default)]
pub(crate) struct MeshBakes {
    bakes: HashMap<Key, Bake>,
    beside: HashMap<AssetPath<'static>, (Vec<AssetId<Mesh>>, FileBeside)>,
    /// Meshes that could not be loaded.
    missing: HashSet<AssetId<Mesh>>,
    /// Files beside a mesh's file that could not be loaded, with the meshes that they are for.
    missing_beside: HashMap<AssetId<CollisionMesh>, Vec<AssetId<Mesh>>>,
    /// Files beside a mesh's file whose names fit several meshes.
    ambiguous: HashSet<AssetPath<'static>>,
    /// Meshes that changed since the last frame.
    pub changed: Vec<AssetId<Mesh>>,
    /// Bytes copied in this frame.
    copied: usize,
}

/// What bakes read and write.
#[derive(SystemParam)]
pub(crate) struct BakeAssets<'w> {
    server: Res<'w, AssetServer>,
    meshes: Res<'w, Assets<Mesh>>,
    baked: ResMut<'w, Assets<CollisionMesh>>,
}

/// Drops what was made of meshes that changed.
fn follow_changes(
    mut bakes: ResMut<MeshBakes>,
    mut changes: MessageReader<AssetEvent<Mesh>>,
    mut baked_changes: MessageReader<AssetEvent<CollisionMesh>>,
) {
    let MeshBakes {
        bakes,
        beside,
        missing,
        missing_beside,
        changed,
        copied,
        ..
    } = &mut *bakes;
    *copied = 0;
    changed.clear();
    // `Added` is a change only after an error: a bake may begin before Bevy writes that event.
    changed.extend(changes.read().filter_map(|change| match change {
        AssetEvent::Modified { id } | AssetEvent::Removed { id } => Some(*id),
        AssetEvent::Added { id } if missing.remove(id) => Some(*id),
        _ => None,
    }));
    for change in baked_changes.read() {
        if let AssetEvent::Added { id } = change {
            changed.extend(missing_beside.remove(id).into_iter().flatten());
        }
    }
    if !changed.is_empty() {
        let unchanged = |meshes: &[AssetId<Mesh>]| !meshes.iter().any(|id| changed.contains(id));
        bakes.retain(|key, _| unchanged(&key.meshes));
        beside.retain(|_, (meshes, _)| unchanged(meshes));
    }
}

impl Source {
    /// One mesh with default settings.
    pub fn of(mesh: &Handle<Mesh>) -> Self {
        Self {
            meshes: vec![mesh.clone()],
            settings: None,
            beside: None,
        }
    }

    pub fn ids(&self) -> impl Iterator<Item = AssetId<Mesh>> {
        self.meshes.iter().map(Handle::id)
    }

    /// The name of the first mesh in the log.
    pub fn name(&self) -> String {
        let Some(first) = self.meshes.first() else {
            return String::new();
        };
        first
            .path()
            .map_or_else(|| format!("mesh {:?}", first.id()), |path| path.to_string())
    }

    fn settings(&self) -> BakeSettings {
        self.settings.unwrap_or_default()
    }

    fn key(&self) -> Key {
        let BakeSettings {
            faces,
            degrees,
            image,
            weld_tolerance,
            inward,
            shell_thickness,
            rounding,
        } = self.settings();
        let tolerances = [weld_tolerance, shell_thickness, rounding].map(f32::to_bits);
        Key {
            meshes: self.ids().collect(),
            settings: (faces, degrees, image, tolerances, inward),
        }
    }
}

impl MeshBakes {
    /// Adds it to an app, in which it follows changes of meshes, unless it is there.
    pub fn register(app: &mut App) {
        if app.world().contains_resource::<Self>() {
            return;
        }
        let has_assets = resource_exists::<Assets<Mesh>>.and_then(resource_exists::<Assets<CollisionMesh>>);
        app.init_resource::<Self>()
            .add_systems(PreUpdate, follow_changes.run_if(has_assets));
    }

    /// The collision mesh of a source. It is looked up or baked in the background, the first time that it is asked for.
    pub fn get(
        &mut self,
        source: &Source,
        assets: &mut BakeAssets,
    ) -> Poll<Result<Handle<CollisionMesh>, MeshBakeError>> {
        // Waiting for such a mesh may last forever. The mesh is not remembered as missing: a game may insert one for
        // this handle.
        let is_missing = |handle: &Handle<Mesh>| *handle == Handle::default() && !assets.meshes.contains(handle);
        if source.meshes.iter().any(is_missing) {
            return Poll::Ready(Err(MeshBakeError::NoMesh));
        }
        if let Some(path) = &source.beside {
            match self.beside(path, source, assets) {
                Poll::Pending => return Poll::Pending,
                Poll::Ready(Some(found)) => return Poll::Ready(found),
                Poll::Ready(None) => {}
            }
        }
        let key = source.key();
        if !self.bakes.contains_key(&key) {
            let Some(bake) = self.begin(source, assets) else {
                return Poll::Pending;
            };
            self.bakes.insert(key.clone(), bake);
        }
        let Some(bake) = self.bakes.get_mut(&key) else {
            return Poll::Pending;
        };
        if let Bake::Running(task) = bake
            && task.is_finished()
        {
            *bake = match block_on(task) {
                Ok(mesh) => Bake::Done(assets.baked.add(mesh)),
                Err(error) => Bake::Failed(error),
            };
        }
        match bake {
            Bake::Running(_) => Poll::Pending,
            Bake::Done(mesh) => Poll::Ready(Ok(mesh.clone())),
            Bake::Failed(error) => Poll::Ready(Err(error.clone())),
        }
    }

    /// The baked mesh or recipe beside the mesh's file. `None` if there is none.
    fn beside(
        &mut self,
        path: &AssetPath<'static>,
        source: &Source,
        assets: &BakeAssets,
    ) -> Poll<Option<Result<Handle<CollisionMesh>, MeshBakeError>>> {
        let (meshes, beside) = self
            .beside
            .entry(path.clone())
            .or_insert_with(|| (source.ids().collect(), FileBeside::look(path, &assets.server)));
        if let FileBeside::Looking(task) = beside
            && task.is_finished()
        {
            *beside = match block_on(task) {
                Some(path) => FileBeside::Found(path.clone(), assets.server.load(path)),
                None => FileBeside::None,
            };
        }
        match beside {
            FileBeside::Looking(_) => Poll::Pending,
            FileBeside::None => Poll::Ready(None),
            FileBeside::Found(path, _) if !source.ids().eq(meshes.iter().copied()) => {
                if self.ambiguous.insert(path.clone()) {
                    warn!(
                        "{path} is used for one mesh only, and {} is baked: both have that name. Rename one of them",
                        source.name()
                    );
                }
                Poll::Ready(None)
            }
            // While a changed file has an error, the mesh that was there before stays.
            FileBeside::Found(_, handle) if assets.baked.contains(&*handle) => Poll::Ready(Some(Ok(handle.clone()))),
            FileBeside::Found(path, handle) => match assets.server.load_state(&*handle) {
                LoadState::Failed(error) => {
                    self.missing_beside.insert(handle.id(), meshes.clone());
                    Poll::Ready(Some(Err(MeshBakeError::Beside {
                        path: path.clone(),
                        error,
                    })))
                }
                _ => Poll::Pending,
            },
        }
    }

    /// Begins to bake. `None` if a mesh is not loaded yet, or if enough was begun in this frame.
    fn begin(&mut self, source: &Source, assets: &BakeAssets) -> Option<Bake> {
        let settings = source.settings();
        if let Err(error) = settings.validate() {
            return Some(Bake::Failed(Arc::new(LoadError::from(error)).into()));
        }
        let mut meshes = Vec::with_capacity(source.meshes.len());
        for handle in &source.meshes {
            match assets.meshes.get(handle) {
                Some(mesh) => meshes.push(mesh),
                None => match assets.server.load_state(handle) {
                    LoadState::Failed(error) => {
                        self.missing.insert(handle.id());
                        return Some(Bake::Failed(MeshBakeError::NotLoaded(error)));
                    }
                    _ => return None,
                },
            }
        }
        if self.copied > MAX_COPIED {
            return None;
        }
        let triangles = match Triangles::of_all(&meshes) {
            Ok(triangles) => triangles,
            Err(error) => return Some(Bake::Failed(error.into())),
        };
        self.copied += triangles.bytes();
        let name = source.name();
        Some(Bake::Running(
            AsyncComputeTaskPool::get_or_init(default).spawn(bake(triangles, settings, name)),
        ))
    }
}

/// Bakes a mesh. A face table is baked on the threads for bakes, after others.
async fn bake(triangles: Triangles, settings: BakeSettings, name: String) -> Result<CollisionMesh, MeshBakeError> {
    let without_faces = BakeSettings {
        faces: false,
        ..settings
    };
    let mesh = on_compute_pool(move || {
        let mesh = triangles.into_mesh().map_err(BevyMeshError::from);
        Ok(mesh.map(|mesh| CollisionMesh::without_faces(&mesh, without_faces)))
    });
    let mesh = mesh.await.map_err(Arc::new)??;
    for warning in mesh.warnings() {
        warn!("{name}: {warning}");
    }
    if !settings.faces {
        return Ok(mesh);
    }
    let mesh = on_bake_pool(move |pool, progress| Ok(mesh.rebake(settings, pool, progress)?));
    Ok(mesh.await.map_err(Arc::new)?)
}

impl FileBeside {
    /// Looks for `PATH.faceoff`, then for `PATH.bake.ron`.
    fn look(path: &AssetPath<'static>, server: &AssetServer) -> Self {
        let (path, server) = (path.clone(), server.clone());
        Self::Looking(IoTaskPool::get_or_init(default).spawn(async move {
            for extension in ["faceoff", "bake.ron"] {
                let mut name = path.path().as_os_str().to_owned();
                name.push(".");
                name.push(extension);
                let file = AssetPath::from_path_buf(name.into()).with_source(path.source().clone_owned());
                let source = server.get_source(file.source()).ok()?;
                let reader = match server.mode() {
                    AssetServerMode::Unprocessed => source.reader(),
                    AssetServerMode::Processed => source.processed_reader().ok()?,
                };
                // A file that cannot be read is there; its load tells why.
                if !matches!(reader.read(file.path()).await, Err(AssetReaderError::NotFound(_))) {
                    return Some(file);
                }
            }
            None
        }))
    }
}
