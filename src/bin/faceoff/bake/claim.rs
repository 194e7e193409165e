//! Claims: how processes that bake into one folder share the work without locks.
//!
//! While a process bakes a mesh, an empty file beside its target says so. Other processes bake other meshes first. A
//! claim promises nothing: whoever has nothing else to do bakes a claimed mesh too, so a claim whose process was killed
//! stops nobody. Files are replaced atomically, and all processes write the same bytes.

use crate::output;
use std::collections::BTreeSet;
use std::fs::{self, OpenOptions};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The right to bake a mesh first. It ends when it is dropped.
pub struct Claim(PathBuf);

impl Claim {
    /// Claims a target; `None` if another process has claimed it. Where no file can be made, nothing is shared, and the
    /// claim holds.
    pub fn take(target: &Path) -> Option<Self> {
        let path = path(target);
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => None,
            _ => Some(Self(path)),
        }
    }

    /// Claims a target that may be claimed already.
    pub fn take_over(target: &Path) -> Self {
        Self(path(target))
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // The process whose claim was taken over has removed it, or will not miss it.
        let _ = fs::remove_file(&self.0);
    }
}

/// Whether a process has claimed a target.
pub fn is_claimed(target: &Path) -> bool {
    path(target).exists()
}

fn path(target: &Path) -> PathBuf {
    let name = target.file_stem().unwrap_or_default().to_string_lossy();
    target.with_file_name(output::hidden(&name, output::CLAIM))
}

/// Removes what killed processes left in the folders of these targets.
pub fn remove_leftovers<'a>(targets: impl Iterator<Item = &'a Path>) {
    let folders: BTreeSet<_> = targets.filter_map(Path::parent).collect();
    folders.into_iter().for_each(output::remove_leftovers);
}
