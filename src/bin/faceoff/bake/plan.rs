//! Which meshes are baked, into which files, in which order.

use bevy_faceoff::asset::{Origin, Recipe};
use bevy_faceoff::projection::BakeSettings;
use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use walkdir::{DirEntry, WalkDir};

/// The extensions of the meshes in a folder. Files given by name may have others.
const EXTENSIONS: [&str; 7] = [".bake.ron", ".glb", ".gltf", ".obj", ".off", ".ply", ".stl"];

/// All that a run has to do.
#[derive(Default)]
pub struct Plan {
    /// Sorted by key.
    pub entries: Vec<Entry>,
    /// What was left out, and why.
    pub warnings: Vec<String>,
    /// Whether the user gave a folder.
    pub has_folders: bool,
}

/// A baked file to make, or something that cannot be baked.
pub struct Entry {
    /// The path of the baked file below the output folder, in lower case and with `/` between folders, so that it is
    /// the same on every system. It orders the entries and decides on their shard.
    pub key: String,
    /// What it is made of. Several files, if they clash.
    pub sources: Vec<PathBuf>,
    /// The baked file. `None` for a folder that could not be read.
    pub target: Option<PathBuf>,
    /// What to do.
    pub work: Work,
}

/// What to do for an [`Entry`].
pub enum Work {
    /// Bake the first source.
    Bake(Input),
    /// Nothing: the reason is known.
    Fail(String),
}

/// What a bake reads, as far as it is known before.
pub struct Input {
    /// The file with the triangles: the source, or what its recipe names.
    pub mesh: PathBuf,
    /// The settings of the recipe.
    pub settings: BakeSettings,
}

/// A mesh file, and its path below the folder that the user gave.
struct MeshFile {
    source: PathBuf,
    relative: PathBuf,
    input: Input,
    /// Whether it was found in a folder, not given by name.
    is_scanned: bool,
}

/// Finds all meshes of the files and folders that the user gave, and the target of each. A mesh that is given twice is
/// baked once. What depends on the content of files is found later, so that this takes little time.
pub fn plan(meshes: &[PathBuf], output: &Path) -> Plan {
    let mut plan = Plan::default();
    let mut files = Vec::new();
    for given in meshes {
        if fs::metadata(given).is_ok_and(|there| there.is_dir()) {
            plan.has_folders = true;
            let before = (files.len(), plan.entries.len());
            scan(given, &mut files, &mut plan);
            if before == (files.len(), plan.entries.len()) {
                let error = format!("{}: no mesh in this folder: {}", given.display(), EXTENSIONS.join(", "));
                plan.entries.push(unread(given, error));
            }
        } else {
            let name = given.file_name().unwrap_or_default();
            files.push(MeshFile::new(given.clone(), name.into(), false));
        }
    }
    drop_meshes_of_recipes(&mut files);
    plan.entries.extend(targets(files, output));
    plan.entries.sort_by(|a, b| a.key.cmp(&b.key));
    plan
}

/// Finds the meshes of a folder and its sub-folders, in the order of their names. Hidden files and folders are left
/// out. A link to a file is followed; a link to a folder is not, because it may lead back, or out of the library.
fn scan(folder: &Path, files: &mut Vec<MeshFile>, plan: &mut Plan) {
    let is_shown = |entry: &DirEntry| entry.depth() == 0 || !entry.file_name().to_string_lossy().starts_with('.');
    for entry in WalkDir::new(folder)
        .sort_by_file_name()
        .into_iter()
        .filter_entry(is_shown)
    {
        let entry = match entry {
            Ok(entry) => entry,
            Err(error) => {
                let path = error.path().unwrap_or(folder);
                let error = format!("{}: this folder cannot be read: {error}", path.display());
                plan.entries.push(unread(path, error));
                continue;
            }
        };
        let path = entry.path();
        if entry.path_is_symlink() && entry.depth() > 0 && path.is_dir() {
            plan.warnings.push(format!(
                "{}: links to folders are not followed; give the folder itself if its meshes are wanted",
                path.display()
            ));
        } else if !entry.file_type().is_dir() && is_mesh(&entry.file_name().to_string_lossy()) {
            let relative = path.strip_prefix(folder).unwrap_or(path).to_owned();
            files.push(MeshFile::new(path.to_owned(), relative, true));
        }
    }
}

/// The entry of a folder whose meshes are unknown. It belongs to every shard, because any of its meshes might.
fn unread(folder: &Path, error: String) -> Entry {
    Entry {
        key: String::new(),
        sources: vec![folder.to_owned()],
        target: None,
        work: Work::Fail(error),
    }
}

fn is_mesh(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    EXTENSIONS.iter().any(|extension| name.ends_with(extension))
}

fn is_recipe(path: &Path) -> bool {
    path.to_string_lossy().to_ascii_lowercase().ends_with(".bake.ron")
}

impl MeshFile {
    /// A recipe that cannot be read is reported when it is baked, or when its mesh clashes with it.
    fn new(source: PathBuf, relative: PathBuf, is_scanned: bool) -> Self {
        let read = |path: &Path| {
            fs::metadata(path)
                .is_ok_and(|there| there.is_file())
                .then(|| fs::read(path).ok())
        };
        let recipe = is_recipe(&source)
            .then(|| read(&source).flatten())
            .flatten()
            .and_then(|bytes| Recipe::parse(&bytes).ok());
        let input = match recipe {
            Some(recipe) => Input {
                mesh: source.with_file_name("").join(recipe.mesh),
                settings: recipe.settings,
            },
            None => Input {
                mesh: source.clone(),
                settings: BakeSettings::default(),
            },
        };
        Self {
            source,
            relative,
            input,
            is_scanned,
        }
    }

    /// The path of the baked file below the output folder.
    fn target(&self) -> PathBuf {
        self.relative
            .with_file_name(format!("{}.faceoff", stem(&self.relative)))
    }
}

/// Leaves out the meshes that a recipe of a scanned folder names: their recipes bake them, with settings of their own.
/// A mesh that the user gave by name stays.
fn drop_meshes_of_recipes(files: &mut Vec<MeshFile>) {
    let named: HashSet<PathBuf> = files
        .iter()
        .filter(|file| file.is_scanned && file.input.mesh != file.source)
        .filter_map(|file| fs::canonicalize(&file.input.mesh).ok())
        .collect();
    if named.is_empty() {
        return;
    }
    files.retain(|file| {
        let is_named = || fs::canonicalize(&file.source).is_ok_and(|path| named.contains(&path));
        !file.is_scanned || is_recipe(&file.source) || !is_named()
    });
}

/// The baked file of each mesh. Different meshes of one file fail.
fn targets(files: Vec<MeshFile>, output: &Path) -> impl Iterator<Item = Entry> {
    let mut targets: BTreeMap<String, (PathBuf, Vec<MeshFile>)> = BTreeMap::new();
    for file in files {
        let target = file.target();
        let parts: Vec<_> = target
            .iter()
            .map(|part| part.to_string_lossy().to_lowercase())
            .collect();
        let (_, there) = targets
            .entry(parts.join("/"))
            .or_insert_with(|| (output.join(&target), Vec::new()));
        if !there.iter().any(|other| is_same(&file.source, &other.source)) {
            there.push(file);
        }
    }
    targets.into_iter().map(|(key, (target, files))| {
        let (sources, mut inputs): (Vec<_>, Vec<_>) = files.into_iter().map(|file| (file.source, file.input)).unzip();
        let work = match inputs.pop() {
            Some(input) if inputs.is_empty() && is_own_mesh(&sources[0], &input, &target) => {
                Work::Fail(own_mesh(&sources[0], &target))
            }
            Some(input) if inputs.is_empty() => Work::Bake(input),
            _ => Work::Fail(faults(&sources).unwrap_or_else(|| clash(&sources, &target))),
        };
        Entry {
            key,
            sources,
            target: Some(target),
            work,
        }
    })
}

/// Whether the bake of a recipe would be written over the mesh that the recipe names.
fn is_own_mesh(source: &Path, input: &Input, target: &Path) -> bool {
    input.mesh != source && is_same(&input.mesh, target)
}

fn own_mesh(source: &Path, target: &Path) -> String {
    format!(
        "{} names {}, over which it would be baked: bake into another folder, or give the recipe another name",
        source.display(),
        target.display()
    )
}

/// What is wrong with the recipes among these files. A faulty one does not tell its mesh, which then seems to be a mesh
/// by itself.
fn faults(sources: &[PathBuf]) -> Option<String> {
    let recipes = sources.iter().filter(|source| is_recipe(source));
    let faults: Vec<String> = recipes
        .filter_map(|recipe| {
            let error = Origin::read(recipe).err()?;
            Some(format!("{}: this recipe cannot be used: {error}", recipe.display()))
        })
        .collect();
    (!faults.is_empty()).then(|| faults.join("; "))
}

fn clash(sources: &[PathBuf], target: &Path) -> String {
    let names: Vec<_> = sources.iter().map(|source| source.display().to_string()).collect();
    format!(
        "{} would be baked into the same file, {}: rename all but one, or bake into different folders (names that differ \
         only in case are the same on some systems)",
        names.join(" and "),
        target.display()
    )
}

/// The name of a mesh file without its extension.
fn stem(source: &Path) -> String {
    let name = source.file_name().unwrap_or_default().to_string_lossy();
    let length = if is_recipe(source) {
        name.len() - ".bake.ron".len()
    } else {
        name.rfind('.').unwrap_or(name.len())
    };
    name[..length].to_owned()
}

/// Whether two paths lead to the same file.
fn is_same(a: &Path, b: &Path) -> bool {
    a == b || fs::canonicalize(a).is_ok_and(|a| fs::canonicalize(b).is_ok_and(|b| a == b))
}
