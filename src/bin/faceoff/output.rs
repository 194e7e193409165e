//! What a command gives out: text to standard output, files that are there whole or not at all.

use crate::Outcome;
use serde::Serialize;
use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind, Write, stderr, stdout};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Stands for standard output where a file could be named.
const STANDARD_OUTPUT: &str = "-";

/// Whether `path` stands for standard output.
pub fn is_standard(path: &Path) -> bool {
    path == Path::new(STANDARD_OUTPUT)
}

/// Finds out whether [`save`] can write to `path`, and leaves what is there as it is. For work that takes long: what cannot be
/// written should be known before.
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

/// Makes a folder and those it lies in.
pub fn folder(path: &Path) -> Outcome {
    fs::create_dir_all(path).map_err(|e| format!("cannot make the folder {}: {e}", path.display()).into())
}

/// Writes a file, or to standard output if `path` is `-`. Whoever reads the file meanwhile sees the old one, and so does who
/// interrupts the program.
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

/// Prints for people: to standard output, or to standard error where that carries the JSON.
pub fn table(json: Option<&Path>, text: &str) -> Outcome {
    if json.is_some_and(is_standard) {
        reached(stderr().write_all(text.as_bytes())).map_err(|e| format!("cannot write to standard error: {e}").into())
    } else {
        print(text.as_bytes())
    }
}

/// Tells of an error or a warning. If even standard error is lost there is nobody left to tell.
pub fn tell(text: &str) {
    let _ = writeln!(stderr(), "{text}");
}

fn print(bytes: &[u8]) -> Outcome {
    let mut out = stdout().lock();
    reached(out.write_all(bytes).and_then(|()| out.flush()))
        .map_err(|e| format!("cannot write to standard output: {e}").into())
}

/// A closed pipe, as with `| head`, is the reader's choice.
pub fn reached(written: io::Result<()>) -> io::Result<()> {
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}

/// Where bytes go.
enum Target {
    /// A file that is there or is to be made; not a link to one.
    File(PathBuf),
    /// A device or a pipe, whose place no file may take.
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
        // Fails for a folder, and for a file that may not be written.
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

/// A file of a name that nobody else uses, in the folder of `path`; removed unless it takes that one's place.
fn beside(path: &Path) -> io::Result<NamedTempFile> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut partial = tempfile::Builder::new();
    // Bevy's asset folders leave out what begins with a dot.
    partial.prefix(".faceoff-").suffix(".partial");
    // The crate's default is for secrets; the system takes away what the user's mask says.
    #[cfg(unix)]
    partial.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    partial.tempfile_in(folder)
}

fn cannot_write(path: &Path, error: &io::Error) -> Box<dyn std::error::Error> {
    format!("cannot write {}: {error}", path.display()).into()
}
