//! Output of commands: text to standard output, and files that are written atomically.

use crate::{Outcome, Wrong};
use serde::Serialize;
use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind, Write, stderr, stdout};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::NamedTempFile;

/// The first part of the names of files that are no output. Bevy's asset server ignores names that begin with a dot.
const HIDDEN: &str = ".faceoff-";
/// The last part of the name of a file that is being written.
const PARTIAL: &str = ".partial";
/// The last part of the name of a file that claims an output.
pub const CLAIM: &str = ".claim";
/// The age from which a hidden file is left from a process that is gone.
const LEFT: Duration = Duration::from_secs(3600);

/// The path that stands for standard output.
const STANDARD_OUTPUT: &str = "-";

/// Whether `path` stands for standard output.
pub fn is_standard(path: &Path) -> bool {
    path == Path::new(STANDARD_OUTPUT)
}

/// Checks whether [`save`] can write to `path`, without changing the file. Long work calls this first, so that it does
/// not fail at the end.
pub fn check(path: &Path) -> Outcome {
    if is_standard(path) {
        return Ok(());
    }
    Target::of(path)
        .and_then(|target| match target {
            Target::Special(_) => Ok(()),
            Target::File(file) => beside(&file).map(drop),
        })
        .map_err(|e| cannot_write(path, &e))
}

/// Refuses an output that is one of these files, which the command reads or writes too, also by another path to it.
pub fn refuse(output: &Path, others: impl IntoIterator<Item = impl AsRef<Path>>) -> Outcome {
    let Some(there) = place(output) else { return Ok(()) };
    for other in others {
        let other = other.as_ref();
        if place(other).as_ref() == Some(&there) {
            return Err(Wrong(format!(
                "{} would be written over {}, which this command reads or writes too; give another name",
                output.display(),
                other.display()
            ))
            .into());
        }
    }
    Ok(())
}

/// Where a file is, or would be, whatever path leads to it. `None` for standard output, devices and pipes, and for a
/// file that cannot be.
fn place(path: &Path) -> Option<PathBuf> {
    if is_standard(path) {
        return None;
    }
    if let Ok(there) = fs::metadata(path) {
        return if there.is_file() {
            fs::canonicalize(path).ok()
        } else {
            None
        };
    }
    Some(fs::canonicalize(folder_of(path)).ok()?.join(path.file_name()?))
}

/// The folder of a file.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Creates a folder and its parents.
pub fn folder(path: &Path) -> Outcome {
    fs::create_dir_all(path).map_err(|e| format!("cannot create the folder {}: {e}", path.display()).into())
}

/// Writes a file atomically, or writes to standard output if `path` is `-`. Until the file is complete, other programs
/// see the old one. It also stays if the program is interrupted.
pub fn save(path: &Path, bytes: &[u8]) -> Outcome {
    if is_standard(path) {
        return print(bytes);
    }
    Target::of(path)
        .and_then(|target| target.write(bytes))
        .map_err(|e| cannot_write(path, &e))
}

/// Writes `value` to a file, or to standard output if `path` is `-`.
pub fn json(path: &Path, value: &impl Serialize) -> Outcome {
    let mut bytes = serde_json::to_vec(value).map_err(|e| cannot_write(path, &e.into()))?;
    bytes.push(b'\n');
    save(path, &bytes)
}

/// Prints human-readable text to standard output, or to standard error if standard output carries the JSON.
pub fn table(json: Option<&Path>, text: &str) -> Outcome {
    if json.is_some_and(is_standard) {
        reached(stderr().write_all(text.as_bytes())).map_err(|e| format!("cannot write to standard error: {e}").into())
    } else {
        print(text.as_bytes())
    }
}

/// Prints an error or a warning to standard error. A failure to do so is ignored.
pub fn log(text: &str) {
    let _ = writeln!(stderr(), "{text}");
}

fn print(bytes: &[u8]) -> Outcome {
    let mut out = stdout().lock();
    reached(out.write_all(bytes).and_then(|()| out.flush()))
        .map_err(|e| format!("cannot write to standard output: {e}").into())
}

/// Ignores a closed pipe, as with `| head`: the reader wants no more.
pub fn reached(written: io::Result<()>) -> io::Result<()> {
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}

/// The target of a write.
enum Target {
    /// A regular file, which may not exist yet. Links are resolved.
    File(PathBuf),
    /// A device or a pipe, which must not be replaced by a file.
    Special(PathBuf),
}

impl Target {
    fn of(path: &Path) -> io::Result<Self> {
        let there = match fs::metadata(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Self::File(path.to_owned())),
            there => there?,
        };
        if !there.is_file() && !there.is_dir() {
            return Ok(Self::Special(path.to_owned()));
        }
        // Fails for a folder, and for a file without write permission.
        OpenOptions::new().write(true).open(path)?;
        fs::canonicalize(path).map(Self::File)
    }

    fn write(self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Special(path) => {
                let mut special = OpenOptions::new().write(true).open(path)?;
                reached(special.write_all(bytes))
            }
            Self::File(path) => {
                let mut partial = beside(&path)?;
                partial.write_all(bytes)?;
                if let Ok(there) = fs::metadata(&path) {
                    partial.as_file().set_permissions(there.permissions())?;
                }
                partial.persist(&path).map_err(|e| e.error)?;
                Ok(())
            }
        }
    }
}

/// A temporary file with a unique name in the folder of `path`. It is removed unless it replaces that file.
fn beside(path: &Path) -> io::Result<NamedTempFile> {
    let mut partial = tempfile::Builder::new();
    partial.prefix(HIDDEN).suffix(PARTIAL);
    // The default permissions are those for secrets. The system applies the user's umask to these.
    #[cfg(unix)]
    partial.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    partial.tempfile_in(folder_of(path))
}

/// The name of a file that is no output, only a sign for other processes.
pub fn hidden(name: &str, suffix: &str) -> String {
    format!("{HIDDEN}{name}{suffix}")
}

/// Removes the hidden files that killed processes left in a folder. No process needs such a file for so long: writing
/// what is in memory takes seconds, and without its claim a mesh may be baked twice, with the same bytes.
pub fn remove_leftovers(folder: &Path) {
    let Ok(files) = fs::read_dir(folder) else { return };
    for file in files.flatten() {
        let name = file.file_name();
        let name = name.to_string_lossy();
        let is_hidden = name.starts_with(HIDDEN) && (name.ends_with(PARTIAL) || name.ends_with(CLAIM));
        let age = || file.metadata().ok()?.modified().ok()?.elapsed().ok();
        if is_hidden && age().is_some_and(|age| age > LEFT) {
            // Another process may have removed it.
            let _ = fs::remove_file(file.path());
        }
    }
}

fn cannot_write(path: &Path, error: &io::Error) -> Box<dyn std::error::Error> {
    format!("cannot write {}: {error}", path.display()).into()
}
