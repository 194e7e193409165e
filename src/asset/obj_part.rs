//! The choice of an object or a group of an OBJ file.

use super::import_error::ImportError;
use super::part::MeshPart;
use super::text::{shown, words};

/// The chosen object or group, and the names of those that the file has.
pub(super) struct Choice<'a> {
    part: &'a MeshPart,
    name: Vec<u8>,
    /// The keyword of the lines that begin one.
    keyword: &'static [u8],
    /// Whether the faces that follow belong to it.
    pub inside: bool,
    /// Whether the file has it.
    found: bool,
    /// The first names in the file, for an error message.
    names: Vec<String>,
    /// Whether there are more names.
    more: bool,
}

/// The number of names in an error message.
const MAX_NAMES: usize = 20;

impl<'a> Choice<'a> {
    /// # Errors
    /// If the part is not one of an OBJ file.
    pub fn of(part: &'a MeshPart) -> Result<Self, ImportError> {
        let (keyword, name): (&[u8], _) = match part {
            MeshPart::Object(name) => (b"o", name),
            MeshPart::Group(name) => (b"g", name),
            MeshPart::Mesh { .. } | MeshPart::Node(_) => {
                return Err(ImportError::wrong_part(part, "an OBJ", "an object or a group"));
            }
        };
        let name = words(name.as_bytes()).collect::<Vec<_>>().join(&b' ');
        Ok(Self {
            // Faces before any `g` are in the default group.
            inside: keyword == b"g" && name == DEFAULT_GROUP,
            part,
            name,
            keyword,
            found: false,
            names: Vec::new(),
            more: false,
        })
    }

    /// Reads a line other than one of a vertex or a face.
    pub fn line<'t>(&mut self, keyword: &[u8], words: impl Iterator<Item = &'t [u8]>) {
        if keyword != self.keyword {
            return;
        }
        let words: Vec<&[u8]> = words.collect();
        // The name of an object is the whole line. A face may be in several groups, but some programs write names of
        // groups with spaces.
        let whole = words.join(&b' ');
        let is_default = self.keyword == b"g" && words.is_empty() && self.name == DEFAULT_GROUP;
        let among = self.keyword == b"g" && words.contains(&&*self.name);
        self.inside = whole == self.name || is_default || among;
        self.found |= self.inside;
        if self.found {
            return;
        }
        let names = if self.keyword == b"g" { words } else { vec![&whole[..]] };
        for name in names {
            let name = format!("\"{}\"", shown(name));
            if self.names.contains(&name) {
                continue;
            }
            if self.names.len() == MAX_NAMES {
                self.more = true;
                break;
            }
            self.names.push(name);
        }
    }

    /// Why there are no faces.
    pub fn error(self) -> ImportError {
        let (kind, name) = (self.part.kind(), shown(&self.name));
        if self.found {
            return ImportError::EmptyPart { kind, name };
        }
        let mut names = self.names;
        if self.more {
            names.push("...".into());
        }
        ImportError::NoSuchPart {
            kind,
            name,
            names: if names.is_empty() {
                "it has none with a name".into()
            } else {
                format!("it has {}", names.join(", "))
            },
        }
    }
}

/// The group of faces that are in no other.
const DEFAULT_GROUP: &[u8] = b"default";
