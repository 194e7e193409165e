//! Where compiled kernels are kept from one start to the next.

use std::path::PathBuf;

/// Where compiled kernels are kept on disk, so that the next start does not compile them again. Used for a device that
/// the plugin opens itself, through Vulkan.
///
/// The file is named after the adapter. One that is damaged, or comes from another driver, is ignored and replaced. A
/// folder that cannot be written costs a debug message and nothing else. Many drivers for desktops keep such files
/// themselves; then this saves little.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum KernelCache {
    /// In the folder `bevy_faceoff` of the user's cache directory: `XDG_CACHE_HOME` or `~/.cache`, on Windows
    /// `LOCALAPPDATA`.
    #[default]
    User,
    /// In this folder, which is created if needed.
    Folder(PathBuf),
    /// Nowhere.
    Off,
}

impl KernelCache {
    /// The folder; `None` if there is none.
    pub fn folder(&self) -> Option<PathBuf> {
        match self {
            Self::Folder(folder) => Some(folder.clone()),
            Self::User => Some(user_caches()?.join("bevy_faceoff")),
            Self::Off => None,
        }
    }
}

/// The user's cache directory. A relative path would depend on where the program was started.
fn user_caches() -> Option<PathBuf> {
    let variable = |name| {
        std::env::var_os(name)
            .map(PathBuf::from)
            .filter(|path| path.is_absolute())
    };
    if cfg!(windows) {
        variable("LOCALAPPDATA")
    } else {
        variable("XDG_CACHE_HOME").or_else(|| Some(variable("HOME")?.join(".cache")))
    }
}
