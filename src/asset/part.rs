//! [`MeshPart`]: the choice of a part of a glTF or OBJ file.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A part of a mesh file. In a recipe or a `.meta` file it reads as shown at each kind.
///
/// Face ids count the triangles of the part, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "Fields", into = "Fields")]
pub enum MeshPart {
    /// `(mesh: "Gear", primitive: 0)` or `(mesh: "Gear")`: one mesh of a glTF file or one of its primitives, without
    /// the transforms of nodes.
    Mesh {
        /// The mesh.
        mesh: NameOrIndex,
        /// The index of the primitive in the mesh; `None` for all of them.
        primitive: Option<u32>,
    },
    /// `(node: "Arm")`: one node of a glTF file with all nodes below it, an object of Blender with its children.
    ///
    /// The origin is that of the node, and so are the axes: its own transform is not applied, nor those of the nodes
    /// above, but those of the nodes below are. An entity with the transform of the node has the mesh where the scene
    /// shows it. The node need not be in a scene.
    Node(NameOrIndex),
    /// `(object: "Wheel")`: all faces of an OBJ file after a line `o Wheel`, up to the next line `o`. There may be
    /// several such lines. Vertices that these faces do not use are left out.
    Object(String),
    /// `(group: "rim")`: all faces of an OBJ file after a line `g` with this name among others, up to the next line
    /// `g`. There may be several such lines. Faces before any such line, and after one without a name, are in the group
    /// `default`. Vertices that these faces do not use are left out.
    Group(String),
}

/// A mesh or node of a glTF file, written as `0` or `"Body"`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(untagged)]
pub enum NameOrIndex {
    /// The one with this index.
    Index(u32),
    /// The first one with this name.
    Name(String),
}

impl MeshPart {
    /// The word that chooses it in a recipe.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Mesh { .. } => "mesh",
            Self::Node(_) => "node",
            Self::Object(_) => "object",
            Self::Group(_) => "group",
        }
    }
}

impl From<u32> for MeshPart {
    fn from(index: u32) -> Self {
        Self::Mesh {
            mesh: NameOrIndex::Index(index),
            primitive: None,
        }
    }
}

impl From<&str> for MeshPart {
    fn from(name: &str) -> Self {
        Self::Mesh {
            mesh: name.into(),
            primitive: None,
        }
    }
}

impl From<&str> for NameOrIndex {
    fn from(name: &str) -> Self {
        Self::Name(name.into())
    }
}

impl fmt::Display for NameOrIndex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index(index) => write!(f, "{index}"),
            Self::Name(name) => write!(f, "{name:?}"),
        }
    }
}

/// As RON, as in a recipe. The hash of a part's source covers this text, so it must not change.
impl fmt::Display for MeshPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = self.kind();
        match self {
            Self::Mesh {
                mesh,
                primitive: Some(primitive),
            } => write!(f, "({kind}: {mesh}, primitive: {primitive})"),
            Self::Mesh { mesh, primitive: None } => write!(f, "({kind}: {mesh})"),
            Self::Node(node) => write!(f, "({kind}: {node})"),
            Self::Object(name) | Self::Group(name) => write!(f, "({kind}: {name:?})"),
        }
    }
}

/// The text form of a [`MeshPart`]. An untagged enum would give errors without any reason.
#[derive(Default, Serialize, Deserialize)]
#[serde(rename = "MeshPart", default, deny_unknown_fields)]
struct Fields {
    #[serde(with = "bare", skip_serializing_if = "Option::is_none")]
    mesh: Option<NameOrIndex>,
    #[serde(skip_serializing_if = "Option::is_none")]
    primitive: Option<u32>,
    #[serde(with = "bare", skip_serializing_if = "Option::is_none")]
    node: Option<NameOrIndex>,
    #[serde(with = "bare", skip_serializing_if = "Option::is_none")]
    object: Option<String>,
    #[serde(with = "bare", skip_serializing_if = "Option::is_none")]
    group: Option<String>,
}

/// A value that is written without `Some` around it.
mod bare {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<T: Serialize, S: Serializer>(value: &Option<T>, serializer: S) -> Result<S::Ok, S::Error> {
        match value {
            Some(value) => value.serialize(serializer),
            None => serializer.serialize_none(),
        }
    }

    pub fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Option<T>, D::Error> {
        T::deserialize(deserializer).map(Some)
    }
}

impl TryFrom<Fields> for MeshPart {
    type Error = &'static str;

    fn try_from(fields: Fields) -> Result<Self, Self::Error> {
        let primitive = fields.primitive;
        match (fields.mesh, fields.node, fields.object, fields.group) {
            (Some(mesh), None, None, None) => Ok(Self::Mesh { mesh, primitive }),
            _ if primitive.is_some() => Err("a part with a primitive needs the mesh of it, and nothing else"),
            (None, Some(node), None, None) => Ok(Self::Node(node)),
            (None, None, Some(object), None) => Ok(Self::Object(object)),
            (None, None, None, Some(group)) => Ok(Self::Group(group)),
            _ => Err("a part is one mesh, node, object or group, as in (node: \"Arm\")"),
        }
    }
}

impl From<MeshPart> for Fields {
    fn from(part: MeshPart) -> Self {
        let mut fields = Self::default();
        match part {
            MeshPart::Mesh { mesh, primitive } => (fields.mesh, fields.primitive) = (Some(mesh), primitive),
            MeshPart::Node(node) => fields.node = Some(node),
            MeshPart::Object(name) => fields.object = Some(name),
            MeshPart::Group(name) => fields.group = Some(name),
        }
        fields
    }
}
