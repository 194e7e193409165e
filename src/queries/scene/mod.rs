//! [`Scene`]: many placed meshes and planes, and queries of all of them.

mod casts;
mod points;
mod rays;
mod segments;
mod tree;

pub use casts::SceneCastHit;
pub use points::ScenePointHit;
pub use rays::SceneRayHit;
pub use segments::SceneSegmentHit;

use super::placed::{Placed, PlacedPose};
use crate::asset::CollisionMesh;
use crate::geometry::mesh::MAX_COORDINATE;
use crate::state::fault::BodyFault;
use glam::{DQuat, DVec3, Vec3};
use std::sync::OnceLock;
use tree::{Tree, WorldBox};

/// Many placed meshes and planes, numbered in the order in which they were added.
///
/// The first query after a change builds a tree over the meshes. Queries may come from several threads at a time. Each
/// takes a filter: only what it returns true for counts.
#[derive(Default)]
pub struct Scene {
    items: Vec<Item>,
    /// Numbers of the planes.
    planes: Vec<u32>,
    tree: OnceLock<SceneTree>,
    /// The tree before the last change.
    last_tree: Option<SceneTree>,
}

#[expect(
    clippy::large_enum_variant,
    reason = "planes are few, and a box would cost each mesh a miss"
)]
enum Item {
    Mesh(SceneMesh),
    Plane(SolidPlane),
}

/// A placed mesh of a scene.
struct SceneMesh {
    mesh: CollisionMesh,
    pose: PlacedPose,
}

/// The points `p` with `normal . p <= distance` are solid.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SolidPlane {
    normal: DVec3,
    distance: f64,
}

/// The tree over the meshes of a scene.
struct SceneTree {
    tree: Tree,
    /// The numbers of the meshes.
    meshes: Vec<u32>,
}

impl Scene {
    /// Removes everything.
    pub fn clear(&mut self) {
        self.items.clear();
        self.planes.clear();
        self.forget_tree();
    }

    /// How many meshes and planes there are.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Adds a mesh, and returns its number. For the arguments see [`Placed::new`].
    ///
    /// # Errors
    /// As [`Placed::new`].
    pub fn add_mesh(
        &mut self,
        mesh: &CollisionMesh,
        translation: DVec3,
        rotation: DQuat,
        scale: Vec3,
    ) -> Result<usize, BodyFault> {
        let pose = Placed::new(mesh, translation, rotation, scale)?.pose();
        let mesh = mesh.clone();
        Ok(self.add(Item::Mesh(SceneMesh { mesh, pose })))
    }

    /// Adds a plane and returns its number. The points `p` with `normal . p <= distance` are solid. `normal` may have
    /// any length but zero; `distance` is along the unit normal, metres.
    ///
    /// # Errors
    /// If a number is not finite, the normal is zero, or the distance beyond 1e9 m.
    pub fn add_plane(&mut self, normal: DVec3, distance: f64) -> Result<usize, BodyFault> {
        let unit = normal.try_normalize().filter(|unit| unit.is_finite());
        let normal = unit.ok_or(BodyFault::PlaneNormal(normal.as_vec3()))?;
        if distance.is_nan() || distance.abs() > f64::from(MAX_COORDINATE) {
            return Err(BodyFault::PlaneDistance(distance as f32));
        }
        self.planes.push(self.items.len() as u32);
        Ok(self.add(Item::Plane(SolidPlane { normal, distance })))
    }

    /// The mesh of this number; `None` for a plane and for numbers that were not given.
    pub fn placed(&self, number: usize) -> Option<Placed<'_>> {
        match self.items.get(number)? {
            Item::Mesh(mesh) => Some(mesh.placed()),
            Item::Plane(_) => None,
        }
    }

    fn forget_tree(&mut self) {
        if let Some(tree) = self.tree.take() {
            self.last_tree = Some(tree);
        }
    }

    fn add(&mut self, item: Item) -> usize {
        self.forget_tree();
        self.items.push(item);
        self.items.len() - 1
    }

    fn tree(&self) -> &SceneTree {
        self.tree.get_or_init(|| {
            let meshes = self.items.iter().enumerate().filter_map(|(number, item)| match item {
                Item::Mesh(mesh) => Some((number as u32, WorldBox::of(&mesh.placed()))),
                Item::Plane(_) => None,
            });
            let (meshes, boxes): (Vec<u32>, Vec<WorldBox>) = meshes.unzip();
            SceneTree {
                tree: Tree::new(&boxes, self.last_tree.as_ref().map(|last| &last.tree)),
                meshes,
            }
        })
    }

    /// The planes with their numbers that pass a filter.
    fn planes<'s>(&'s self, filter: &'s impl Fn(usize) -> bool) -> impl Iterator<Item = (usize, SolidPlane)> + 's {
        self.planes
            .iter()
            .filter_map(move |&number| match self.items[number as usize] {
                Item::Plane(plane) if filter(number as usize) => Some((number as usize, plane)),
                _ => None,
            })
    }

    /// Calls `visit` with the meshes that pass a filter and that a moving box may meet, nearer ones first. See
    /// [`Tree::along`].
    fn meshes_along(
        &self,
        start: WorldBox,
        way: DVec3,
        most: f64,
        filter: &impl Fn(usize) -> bool,
        visit: &mut dyn FnMut(usize, Placed) -> f64,
    ) {
        let tree = self.tree();
        (tree.tree).along(start, way, most, &mut self.visitor(tree, most, filter, visit));
    }

    /// Calls `visit` with the meshes that pass a filter and may be within `most` metres of a box, nearer ones first.
    /// See [`Tree::around`].
    fn meshes_around(
        &self,
        near: WorldBox,
        most: f64,
        filter: &impl Fn(usize) -> bool,
        visit: &mut dyn FnMut(usize, Placed) -> f64,
    ) {
        let tree = self.tree();
        (tree.tree).around(near, most, &mut self.visitor(tree, most, filter, visit));
    }

    /// From the boxes of the tree to the meshes that pass a filter.
    fn visitor<'s>(
        &'s self,
        tree: &'s SceneTree,
        mut most: f64,
        filter: &'s impl Fn(usize) -> bool,
        visit: &'s mut dyn FnMut(usize, Placed) -> f64,
    ) -> impl FnMut(u32) -> f64 + 's {
        move |index| {
            let number = tree.meshes[index as usize] as usize;
            if filter(number)
                && let Some(mesh) = self.placed(number)
            {
                most = visit(number, mesh);
            }
            most
        }
    }
}

/// The first of the hits that were found so far: that of the least distance, and among those that of the lowest number.
struct First<H>(Option<(f64, usize, H)>);

impl<H> First<H> {
    const NONE: Self = Self(None);

    fn add(&mut self, distance: f64, number: usize, hit: H) {
        let is_first = (self.0.as_ref()).is_none_or(|(first, at, _)| (distance, number) < (*first, *at));
        if is_first {
            self.0 = Some((distance, number, hit));
        }
    }

    fn distance(&self) -> Option<f64> {
        self.0.as_ref().map(|&(distance, ..)| distance)
    }

    /// The distance beyond which hits are of no interest, if it was `limit` before there was any.
    fn most(&self, limit: f64) -> f64 {
        self.distance().map_or(limit, |distance| distance.min(limit))
    }

    fn hit(self) -> Option<H> {
        self.0.map(|(.., hit)| hit)
    }
}

impl SolidPlane {
    /// The height of a point above its surface, metres.
    fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.distance
    }
}

impl SceneMesh {
    fn placed(&self) -> Placed<'_> {
        Placed::again(&self.mesh, self.pose)
    }
}
