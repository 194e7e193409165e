//! JSON to a file or standard output.

use crate::Outcome;
use serde::Serialize;
use std::fs::File;
use std::io::{BufWriter, Write, stdout};
use std::path::Path;

/// Opens `path` for writing, or standard output if that is `-`.
pub fn create(path: &Path) -> Outcome<Box<dyn Write>> {
    if path == Path::new("-") {
        return Ok(Box::new(stdout().lock()));
    }
    let file = File::create(path).map_err(|e| format!("cannot write {}: {e}", path.display()))?;
    Ok(Box::new(BufWriter::new(file)))
}

/// Makes a folder and those it lies in.
pub fn folder(path: &Path) -> Outcome {
    std::fs::create_dir_all(path).map_err(|e| format!("cannot make the folder {}: {e}", path.display()).into())
}

/// Writes `value` to `path`, or to standard output if that is `-`.
pub fn json(path: &Path, value: &impl Serialize) -> Outcome {
    let mut out = create(path)?;
    let name = path.display();
    serde_json::to_writer(&mut out, value).map_err(|e| format!("cannot write {name}: {e}"))?;
    writeln!(out)
        .and_then(|()| out.flush())
        .map_err(|e| format!("cannot write {name}: {e}").into())
}

/// Prints for people: to standard output, or to standard error where that carries the JSON.
pub fn table(json: Option<&Path>, text: &str) {
    if json == Some(Path::new("-")) {
        eprint!("{text}");
    } else {
        // A closed pipe, as with `| head`, is the reader's choice.
        let _ = stdout().write_all(text.as_bytes());
    }
}
