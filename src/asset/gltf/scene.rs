//! The triangles of a scene, or of a chosen part of a glTF file.

use super::accessor::Data;
use super::error::GltfError;
use super::schema::{Mesh, Node, Primitive, Root};
use crate::asset::import_error::ImportError;
use crate::asset::part::NameOrIndex;
use crate::geometry::TriMesh;
use glam::{DAffine3, DMat4, DQuat, DVec3, Vec3};

/// The triangles of the default scene: the meshes of all nodes, transformed by their nodes and the nodes above.
pub(super) fn read_scene(data: &Data) -> Result<TriMesh, ImportError> {
    let root = data.root;
    let scene = root.scene.unwrap_or(0);
    let Some(roots) = root.scenes.get(scene) else {
        return Err(match root.scene {
            None => GltfError::NoScene {
                meshes: root.meshes.len(),
            },
            Some(_) => wrong_scene("scene", scene, "it does not exist"),
        }
        .into());
    };
    // A stack of nodes to visit, each with the transform of its parent.
    let stack = roots.nodes.iter().rev().map(|&n| (n, DAffine3::IDENTITY)).collect();
    let soup = read_nodes(data, stack, None)?;
    soup.finish("the scene; does it contain only points, lines or curves?")
}

/// The triangles of a node and those below it, in the space of the node. It need not be in a scene.
pub(super) fn read_node(data: &Data, choice: &NameOrIndex) -> Result<TriMesh, ImportError> {
    let index = find("node", choice, &data.root.nodes, |node| node.name.as_deref())?;
    let soup = read_nodes(data, vec![(index, DAffine3::IDENTITY)], Some(index))?;
    soup.finish("the chosen node; does it contain only points, lines or curves?")
}

/// Warns of what the nodes and meshes of a document have that is not read, and that may change or place their shapes.
pub(super) fn warn_unread(root: &Root, warnings: &mut Vec<String>) {
    let with = |has: fn(&Node) -> bool| {
        root.nodes
            .iter()
            .filter(|&node| node.mesh.is_some() && has(node))
            .count()
    };
    let is_hidden = |node: &&Node| (node.extensions.visibility.as_ref()).is_some_and(|one| one.visible == Some(false));
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    for (count, what) in [
        (
            with(|node| node.extensions.instances.is_some()),
            "nodes have instances (EXT_mesh_gpu_instancing), which are not read: each mesh is there once; export them as nodes",
        ),
        (
            with(|node| node.skin.is_some()),
            "nodes have skins, which are not applied: their meshes are as they were modelled, not moved by nodes; export the pose \
             that is wanted as a mesh",
        ),
        (
            root.nodes.iter().filter(is_hidden).count(),
            "nodes are hidden (KHR_node_visibility), but read all the same; choose a part, or export without them",
        ),
        (
            primitives.filter(|primitive| primitive.targets.is_some()).count(),
            "primitives have morph targets, which are not applied: they have their first shape",
        ),
    ] {
        if count > 0 {
            warnings.push(format!("{count} {what}"));
        }
    }
}

/// The meshes of the nodes on a stack and of all nodes below them. Each has the transform of its parent beside it. The
/// transform of the node `origin` itself is not applied.
fn read_nodes<'a>(
    data: &'a Data<'a>,
    mut stack: Vec<(usize, DAffine3)>,
    origin: Option<usize>,
) -> Result<TriangleSoup<'a>, GltfError> {
    let root = data.root;
    let mut soup = TriangleSoup::new(data);
    let mut visited = vec![false; root.nodes.len()];
    while let Some((index, above)) = stack.pop() {
        let wrong = |reason| wrong_scene("node", index, reason);
        let node = root.nodes.get(index).ok_or(wrong("it does not exist"))?;
        // Without this check a cycle of nodes would never end, and nodes with two parents would double at each level.
        if std::mem::replace(&mut visited[index], true) {
            return Err(wrong("it occurs twice; a node has at most one parent"));
        }
        let transform = match origin {
            Some(origin) if origin == index => above,
            _ => above * local(node).map_err(wrong)?,
        };
        if let Some(mesh) = node.mesh {
            // The joints alone place a mesh with a skin.
            let transform = if node.skin.is_some() {
                DAffine3::IDENTITY
            } else {
                transform
            };
            let found = root.meshes.get(mesh).ok_or(wrong("its mesh does not exist"))?;
            for primitive in 0..found.primitives.len() {
                soup.add(mesh, found, primitive, Some((index, transform)))?;
            }
        }
        stack.extend(node.children.iter().rev().map(|&child| (child, transform)));
    }
    Ok(soup)
}

/// The triangles of one mesh, or of one of its primitives, without the transforms of nodes. It need not be in a scene.
pub(super) fn read_mesh(data: &Data, choice: &NameOrIndex, primitive: Option<u32>) -> Result<TriMesh, ImportError> {
    let meshes = &data.root.meshes;
    let index = find("mesh", choice, meshes, |mesh| mesh.name.as_deref())?;
    let mesh = &meshes[index];
    let mut soup = TriangleSoup::new(data);
    match primitive {
        None => {
            for primitive in 0..mesh.primitives.len() {
                soup.add(index, mesh, primitive, None)?;
            }
        }
        Some(primitive) if (primitive as usize) < mesh.primitives.len() => {
            soup.add(index, mesh, primitive as usize, None)?;
        }
        Some(primitive) => {
            return Err(GltfError::NoSuchPrimitive {
                mesh: label(index, mesh.name.as_deref()),
                primitive,
                count: mesh.primitives.len(),
            }
            .into());
        }
    }
    soup.finish("the chosen part; does it contain only points or lines?")
}

fn wrong_scene(place: &'static str, index: usize, reason: &'static str) -> GltfError {
    GltfError::Scene { place, index, reason }
}

/// The index of the chosen mesh or node; `name` tells the name of one.
fn find<T>(
    kind: &'static str,
    choice: &NameOrIndex,
    all: &[T],
    name: impl Fn(&T) -> Option<&str>,
) -> Result<usize, GltfError> {
    let index = match choice {
        NameOrIndex::Index(index) => Some(*index as usize).filter(|i| *i < all.len()),
        NameOrIndex::Name(wanted) => all.iter().position(|one| name(one) == Some(wanted)),
    };
    index.ok_or_else(|| {
        let first = all.iter().enumerate().take(20);
        let mut names: Vec<String> = first.map(|(i, one)| label(i, name(one))).collect();
        if all.len() > names.len() {
            names.push("...".into());
        }
        GltfError::NoSuchPart {
            kind,
            choice: choice.clone(),
            count: all.len(),
            names: names.join(", "),
        }
    })
}

/// An index with the name that belongs to it.
fn label(index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) => format!("{index} {:?}", shortened(name)),
        None => index.to_string(),
    }
}

fn shortened(name: &str) -> String {
    name.chars().take(40).collect()
}

/// The transform of a node relative to its parent.
fn local(node: &Node) -> Result<DAffine3, &'static str> {
    if let Some(matrix) = &node.matrix {
        return Ok(DAffine3::from_mat4(DMat4::from_cols_array(matrix)));
    }
    let rotation = match &node.rotation {
        None => DQuat::IDENTITY,
        Some(rotation) => {
            let rotation = DQuat::from_array(**rotation);
            let length = rotation.length();
            if !(length > 0.0 && length.is_finite()) {
                return Err("its rotation is not a valid quaternion");
            }
            rotation / length
        }
    };
    let vector = |v: &Option<Box<[f64; 3]>>, default| v.as_ref().map_or(default, |v| DVec3::from_array(**v));
    Ok(DAffine3::from_scale_rotation_translation(
        vector(&node.scale, DVec3::ONE),
        rotation,
        vector(&node.translation, DVec3::ZERO),
    ))
}

/// The vertices and triangles read so far.
struct TriangleSoup<'a> {
    data: &'a Data<'a>,
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl<'a> TriangleSoup<'a> {
    fn new(data: &'a Data<'a>) -> Self {
        Self {
            data,
            vertices: Vec::new(),
            triangles: Vec::new(),
        }
    }

    /// Adds the triangles of a primitive, transformed by a node if one is given.
    fn add(
        &mut self,
        mesh_index: usize,
        mesh: &Mesh,
        primitive_index: usize,
        placed: Option<(usize, DAffine3)>,
    ) -> Result<(), GltfError> {
        let primitive = &mesh.primitives[primitive_index];
        let wrong = |reason: &str| GltfError::Primitive {
            mesh: label(mesh_index, mesh.name.as_deref()),
            primitive: primitive_index,
            reason: reason.into(),
        };
        let wrong_accessor = |accessor: usize| {
            move |reason| GltfError::Accessor {
                mesh: label(mesh_index, mesh.name.as_deref()),
                primitive: primitive_index,
                accessor,
                reason,
            }
        };
        match primitive.mode {
            // Points and lines do not collide.
            0..=3 => return Ok(()),
            4..=6 => {}
            _ => return Err(wrong("its mode is not valid in glTF")),
        }
        let Some(position) = primitive.attributes.position else {
            return Err(wrong("it has no POSITION"));
        };
        if is_compressed(primitive, self.data) {
            return Err(wrong(
                "it is compressed with Draco, which is not supported; export without compression",
            ));
        }
        self.check_budget(primitive, position, wrong_accessor)?;
        let positions = self.data.positions(position).map_err(wrong_accessor(position))?;
        let indices = match primitive.indices {
            None => (0..positions.len() as u32).collect(),
            Some(accessor) => {
                let indices = self.data.indices(accessor).map_err(wrong_accessor(accessor))?;
                match indices.iter().position(|&i| i as usize >= positions.len()) {
                    None => indices,
                    Some(at) => {
                        let (index, count) = (indices[at], positions.len());
                        let reason = format!("element {at} is {index}, but there are {count} positions");
                        return Err(wrong_accessor(accessor)(reason));
                    }
                }
            }
        };
        if primitive.mode == 4 && indices.len() % 3 != 0 {
            let reason = format!("its {} corners do not make whole triangles", indices.len());
            return Err(wrong(&reason));
        }
        if let Some(vertex) = positions.iter().position(|p| !p.is_finite()) {
            return Err(wrong_accessor(position)(format!("position {vertex} is not finite")));
        }
        let first = self.vertices.len() as u32;
        // A mirroring transform reverses the winding, so flip the triangles.
        let mirrored = placed.is_some_and(|(_, transform)| transform.matrix3.determinant() < 0.0);
        self.triangles
            .extend(corners(primitive.mode, &indices).map(|[a, b, c]| {
                let [a, b, c] = [a + first, b + first, c + first];
                if mirrored { [a, c, b] } else { [a, b, c] }
            }));
        match placed {
            None => self.vertices.extend(positions),
            Some((node, transform)) => {
                for position in positions {
                    let position = transform.transform_point3(position.as_dvec3()).as_vec3();
                    if !position.is_finite() {
                        let reason = "its transform moves its mesh out of the range of single precision";
                        return Err(wrong_scene("node", node, reason));
                    }
                    self.vertices.push(position);
                }
            }
        }
        Ok(())
    }

    /// Limits the total size relative to the length of the file. A few bytes can repeat a mesh many times, or use the
    /// same accessor in many primitives.
    fn check_budget<F: FnOnce(String) -> GltfError>(
        &self,
        primitive: &Primitive,
        position: usize,
        wrong: impl Fn(usize) -> F,
    ) -> Result<(), GltfError> {
        let limit = self
            .data
            .length
            .saturating_mul(LIMIT_PER_BYTE)
            .max(MIN_LIMIT)
            .min(u32::MAX.into());
        let count = |accessor: usize| self.data.count(accessor).map_err(wrong(accessor));
        let vertices = count(position)?;
        let corners = primitive.indices.map_or(Ok(vertices), count)?;
        let triangles = if primitive.mode == 4 { corners / 3 } else { corners };
        for (what, there, more) in [
            ("vertices", self.vertices.len(), vertices),
            ("triangles", self.triangles.len(), triangles),
        ] {
            // If the first one is too large, its count is wrong, and reading the accessor gives a better error.
            if there > 0 && more.saturating_add(there as u64) > limit {
                return Err(GltfError::TooManyInstances { what, limit });
            }
        }
        Ok(())
    }

    fn finish(self, what: &'static str) -> Result<TriMesh, ImportError> {
        if self.triangles.is_empty() {
            return Err(GltfError::NoTriangles(what).into());
        }
        Ok(TriMesh::new(self.vertices, self.triangles)?)
    }
}

/// The number of vertices and of triangles that any file may have, however short it is.
const MIN_LIMIT: u64 = 1 << 20;
/// The number of vertices and of triangles that a long file may have for each of its bytes.
const LIMIT_PER_BYTE: u64 = 4;

/// The triangles of a list, strip or fan, with consistent winding.
fn corners(mode: u32, indices: &[u32]) -> impl Iterator<Item = [u32; 3]> + '_ {
    let count = match mode {
        4 => indices.len() / 3,
        _ => indices.len().saturating_sub(2),
    };
    (0..count).map(move |i| match mode {
        4 => [indices[3 * i], indices[3 * i + 1], indices[3 * i + 2]],
        5 if i % 2 == 1 => [indices[i], indices[i + 2], indices[i + 1]],
        5 => [indices[i], indices[i + 1], indices[i + 2]],
        _ => [indices[i + 1], indices[i + 2], indices[0]],
    })
}

/// Whether a primitive is available only in Draco compression. It may have uncompressed data as well.
fn is_compressed(primitive: &Primitive, data: &Data) -> bool {
    let has_view = |accessor: Option<usize>| {
        accessor
            .and_then(|a| data.root.accessors.get(a))
            .is_none_or(|a| a.buffer_view.is_some() || a.sparse.is_some())
    };
    primitive.extensions.draco.is_some() && !(has_view(primitive.attributes.position) && has_view(primitive.indices))
}
