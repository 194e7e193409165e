//! The meshes on the device: all in one array of words, with a header for each.

use super::buffers::TooLarge;
use super::layout::{self, INWARD, MIXED, OPEN, OUTWARD, SOLID, SOME_TWO_SIDED, THIN};
use super::mesh_features;
use crate::asset::CollisionMesh;
use crate::geometry::Orientation;
use crate::state::mesh_arena::{MeshArena, MeshSlot, StoredPoints};
use glam::Vec3;
use std::ops::Range;

/// Allocates the array of words.
#[derive(Default)]
pub struct Arena {
    slots: Vec<Option<Resident>>,
    /// Unused ranges below `end`, ascending; no two are adjacent.
    free: Vec<Range<u32>>,
    end: u32,
    /// Whether meshes include their topology.
    features: bool,
}

struct Resident {
    mesh: CollisionMesh,
    words: Range<u32>,
    header: layout::Mesh,
}

/// Maximum number of levels of a mesh's bounding-volume tree. Each box has eight children.
pub const TREE_LEVELS: u32 = 8;

/// A pair of meshes is large, and may be split into pieces, if the product of their triangle counts is larger than
/// this: two meshes of 1,024 triangles. On an H200, 2,200 knots of 1,120 triangles took 7.9 ms in each contact
/// generation as whole pairs, and 2.3 ms in pieces: the step waits for the few pairs that overlap deeply.
pub const LARGE_PAIR: u32 = 1 << 20;

/// Pairs with a mesh of this many levels, which has more than 262,144 triangles, have larger pieces.
pub const VAST_LEVELS: u32 = 7;

/// Whether some mesh is so large that there may be large pairs.
pub fn has_large_meshes(meshes: &MeshArena) -> bool {
    let is_large = |slot: &MeshSlot| (slot.mesh.mesh.triangles().len() as u64).pow(2) > u64::from(LARGE_PAIR);
    (0..meshes.len() as u32).any(|number| meshes.get(number).is_some_and(is_large))
}

/// Capacity of such a tree.
const MAX_TRIANGLES: u64 = 1 << (3 * TREE_LEVELS);

/// A write to the device.
pub enum Change {
    /// Words from this index on.
    Words(u32, Vec<u32>),
    /// The header of this slot.
    Header(u32, layout::Mesh),
}

impl Arena {
    /// An arena whose meshes include the topology that contact generation needs.
    pub fn with_features() -> Self {
        Self {
            features: true,
            ..Self::default()
        }
    }

    /// Whether its contents equal those of `meshes`.
    pub fn holds(&self, meshes: &MeshArena) -> bool {
        let slots = self.slots.len().max(meshes.len()) as u32;
        (0..slots).all(|number| {
            match (
                meshes.get(number),
                self.slots.get(number as usize).and_then(Option::as_ref),
            ) {
                (Some(wanted), Some(held)) => wanted.mesh.is_same(&held.mesh),
                (None, None) => true,
                _ => false,
            }
        })
    }

    /// Updates the contents to match `meshes`, and returns the necessary writes. Known meshes keep their place.
    ///
    /// # Errors
    /// If the tree of a mesh has more levels than the kernels support.
    pub fn update(&mut self, meshes: &MeshArena) -> Result<Vec<Change>, TooLarge> {
        let mut changes = Vec::new();
        self.slots.resize_with(self.slots.len().max(meshes.len()), || None);
        for number in 0..self.slots.len() as u32 {
            let wanted = meshes.get(number);
            let held = &self.slots[number as usize];
            if let (Some(wanted), Some(held)) = (wanted, held)
                && wanted.mesh.is_same(&held.mesh)
            {
                continue;
            }
            if let Some(held) = self.slots[number as usize].take() {
                self.release(held.words);
            }
            if let Some(slot) = wanted {
                let triangles = slot.mesh.mesh.triangles().len() as u64;
                if triangles > MAX_TRIANGLES {
                    return Err(TooLarge {
                        what: "triangles of one mesh",
                        bytes: 36 * triangles,
                        limit: 36 * MAX_TRIANGLES,
                    });
                }
                let mut packed = Packed::default();
                let relative = packed.mesh(slot, self.features);
                let words = self.reserve(packed.0.len() as u32);
                let header = moved(relative, words.start);
                changes.push(Change::Words(words.start, packed.0));
                changes.push(Change::Header(number, header));
                self.slots[number as usize] = Some(Resident {
                    mesh: slot.mesh.clone(),
                    words,
                    header,
                });
            }
        }
        Ok(changes)
    }

    /// The writes of all contents, for a new, empty array.
    pub fn contents(&self) -> Vec<Change> {
        let mut changes = Vec::new();
        for (number, held) in (0..).zip(&self.slots) {
            if let Some(held) = held {
                let slot = MeshSlot::new(held.mesh.clone());
                let mut packed = Packed::default();
                packed.mesh(&slot, self.features);
                changes.push(Change::Words(held.words.start, packed.0));
                changes.push(Change::Header(number, held.header));
            }
        }
        changes
    }

    /// Number of slots.
    pub fn slots(&self) -> u32 {
        self.slots.len() as u32
    }

    /// Length of the array, with unused words between meshes.
    pub fn words(&self) -> u32 {
        self.end
    }

    /// The first free range that is long enough, or a new one at the end.
    fn reserve(&mut self, length: u32) -> Range<u32> {
        if let Some(at) = self.free.iter().position(|range| range.len() as u32 >= length) {
            let range = &mut self.free[at];
            let reserved = range.start..range.start + length;
            range.start = reserved.end;
            if range.start == range.end {
                self.free.remove(at);
            }
            return reserved;
        }
        let start = self.end;
        // No device holds that much: reserving buffers fails next.
        self.end = self.end.saturating_add(length);
        start..self.end
    }

    fn release(&mut self, words: Range<u32>) {
        let at = self.free.partition_point(|range| range.start < words.start);
        self.free.insert(at, words);
        // Merges adjacent ranges.
        self.free.dedup_by(|later, earlier| {
            let adjacent = earlier.end == later.start;
            if adjacent {
                earlier.end = later.end;
            }
            adjacent
        });
        if let Some(last) = self.free.pop_if(|range| range.end == self.end) {
            self.end = last.start;
        }
    }
}

/// A header with offsets relative to the mesh's first word, moved to where that is.
fn moved(mesh: layout::Mesh, by: u32) -> layout::Mesh {
    layout::Mesh {
        triangles: mesh.triangles + by,
        corners: mesh.corners + by,
        caps: mesh.caps + by,
        boxes: mesh.boxes + by,
        vertices: mesh.vertices + by,
        heights: mesh.heights + by,
        components: mesh.components + by,
        directions: mesh.directions + by,
        groups: mesh.groups + by,
        features: mesh.features + by,
        ..mesh
    }
}

/// The words of one mesh.
#[derive(Default)]
struct Packed(Vec<u32>);

impl Packed {
    fn points(&mut self, points: impl Iterator<Item = Vec3>) -> u32 {
        let start = self.0.len() as u32;
        self.0.extend(points.flat_map(|p| p.to_array().map(f32::to_bits)));
        start
    }

    fn mesh(&mut self, slot: &MeshSlot, with_features: bool) -> layout::Mesh {
        let baked = &slot.mesh;
        let mesh = &baked.mesh;
        let center = baked.mass.center;
        let count = mesh.triangles().len();
        let triangles = self.points((0..count).flat_map(|t| mesh.corners(t)).map(|p| p - center));
        // Most meshes have no welded corners.
        let is_joined = |t: usize| mesh.welded_corners(t) != mesh.corners(t);
        let corners = if (0..count).any(is_joined) {
            self.points((0..count).flat_map(|t| mesh.welded_corners(t)).map(|p| p - center))
        } else {
            triangles
        };

        let caps = self.points(mesh.caps().as_flattened().iter().map(|p| *p - center));

        // The last group of each level is padded with empty boxes.
        let mut nodes = count.div_ceil(8);
        let boxes = self.0.len() as u32;
        for level in &slot.lanes.levels {
            let all = level.iter().flat_map(|group| {
                (0..8).flat_map(move |lane| [lane_of(&group.center, lane), lane_of(&group.half, lane)])
            });
            self.points(all.take(2 * nodes));
            nodes = nodes.div_ceil(8);
        }
        // The root, a box around everything, has no level in `lanes`, unless there is a single cluster.
        let levels = if count > 8 {
            let aabb = slot.lanes.aabb;
            let middle = aabb.center();
            self.points([middle, (aabb.max - middle).max(middle - aabb.min)].into_iter());
            slot.lanes.levels.len() as u32 + 1
        } else {
            1
        };

        let mut vertex_count = 0;
        let held = slot.lanes.vertices.iter().flat_map(|(points, lanes)| {
            (0..8)
                .filter(move |lane| lanes >> lane & 1 == 1)
                .map(move |lane| lane_of(points, lane))
        });
        let vertices = self.points(held.inspect(|_| vertex_count += 1));
        let heights = self.points(baked.heights.points().iter().copied());
        let components = mesh.component_vertices();
        let component_start = self.points(components.iter().map(|&v| mesh.vertices()[v as usize] - center));

        let directions = self.0.len() as u32;
        let (mut direction_steps, mut groups) = (0, directions);
        let group_words = count.div_ceil(32);
        if let Some(table) = &baked.faces {
            direction_steps = table.grid().turn();
            self.0.extend(table.directions());
            groups = self.0.len() as u32;
            let mut scratch = Vec::new();
            for id in 0..table.distinct_len() as u32 {
                let masks = table.distinct(id).lane_masks(&mut scratch);
                self.0.extend((0..group_words).map(|word| {
                    let byte = |k: usize| u32::from(masks.get(4 * word + k).copied().unwrap_or(0));
                    byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24
                }));
            }
        }
        let features = self.0.len() as u32;
        if with_features {
            self.0.extend(mesh_features::words(slot));
        }
        let orientation = match mesh.orientation() {
            Orientation::Outward => OUTWARD,
            Orientation::Inward => INWARD,
            Orientation::Mixed => MIXED,
            Orientation::Open => OPEN,
        };
        let solid = if mesh.is_solid() { SOLID } else { 0 };
        let two_sided = if baked.one_sided.all() { 0 } else { SOME_TWO_SIDED };
        let thin = if mesh.is_thin() { THIN } else { 0 };
        let aabb = slot.lanes.aabb;
        layout::Mesh {
            center: center.to_array(),
            radius: baked.radius,
            triangles,
            triangle_count: count as u32,
            boxes,
            levels,
            vertices,
            vertex_count,
            heights,
            flags: orientation | solid | two_sided | thin,
            components: component_start,
            component_count: components.len() as u32,
            directions,
            direction_steps,
            groups,
            group_words: group_words as u32,
            features,
            corners,
            caps,
            cap_count: mesh.caps().len() as u32,
            box_center: aabb.center().to_array(),
            box_half: aabb.half_size().to_array(),
            fingerprint_low: baked.fingerprint() as u32,
            fingerprint_high: (baked.fingerprint() >> 32) as u32,
            ..Default::default()
        }
    }
}

fn lane_of(points: &StoredPoints, lane: usize) -> Vec3 {
    Vec3::from_array(points.each_ref().map(|x| x.0[lane]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn released_words_are_used_again_and_neighbours_join() {
        let mut arena = Arena::default();
        let [a, b, c] = [10, 20, 30].map(|n| arena.reserve(n));
        assert_eq!((a.clone(), b.clone(), c.clone()), (0..10, 10..30, 30..60));
        arena.release(a);
        arena.release(b);
        assert_eq!(arena.free, std::slice::from_ref(&(0..30)));
        assert_eq!(arena.reserve(25), 0..25);
        assert_eq!(arena.reserve(25), 60..85);
        arena.release(60..85);
        assert_eq!(arena.end, 60, "what is free at the end is given back");
        arena.release(c);
        arena.release(0..25);
        assert_eq!((arena.end, arena.free.len()), (0, 0));
    }
}
