//! The buffers of a step without contact points, their capacity, and the macro that declares sets of buffers.

use super::device::Gpu;
use super::layout::*;
use super::{radix_sort, scan};
use thiserror::Error;
use wgpu::{Buffer, BufferDescriptor, BufferUsages};

/// Capacity of the lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capacity {
    /// Colliders.
    pub bodies: u32,
    /// Bodies whose colliders are placed in them.
    pub compounds: u32,
    /// Colliders of compounds.
    pub parts: u32,
    /// Planes.
    pub planes: u32,
    /// Pairs of bodies whose spheres overlap.
    pub pairs: u32,
    /// Pairs of intersecting triangles.
    pub hits: u32,
    /// Contacts with planes.
    pub plane_contacts: u32,
    /// Pieces of pairs of large meshes.
    pub pieces: u32,
    /// Mesh slots.
    pub meshes: u32,
    /// Words of all meshes.
    pub words: u32,
}

/// The new length of a list that needs `needs` elements. It grows by a quarter more than needed, so that growing lists
/// are not reallocated in every step.
pub(crate) fn grow(has: u32, needs: u32) -> u32 {
    if needs > has {
        needs.saturating_add(needs / 4).saturating_add(64)
    } else {
        has
    }
}

/// A list that exceeds the limits of the device.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the list of {what} takes {bytes} bytes, and the device binds at most {limit}")]
pub struct TooLarge {
    /// What it contains.
    pub what: &'static str,
    /// Length of the list, bytes.
    pub bytes: u64,
    /// The device's limit, bytes.
    pub limit: u64,
}

impl Capacity {
    /// At least `needed` of each, with some to spare where this capacity does not suffice.
    pub fn grown(self, needed: Self) -> Self {
        Self {
            bodies: grow(self.bodies, needed.bodies),
            compounds: grow(self.compounds, needed.compounds),
            parts: grow(self.parts, needed.parts),
            // Without some to spare: other lists have an element for each body and plane.
            planes: self.planes.max(needed.planes),
            pairs: grow(self.pairs, needed.pairs),
            hits: grow(self.hits, needed.hits),
            plane_contacts: grow(self.plane_contacts, needed.plane_contacts),
            pieces: grow(self.pieces, needed.pieces),
            meshes: grow(self.meshes, needed.meshes),
            words: grow(self.words, needed.words),
        }
    }

    /// The larger of two, list by list.
    pub fn max(self, other: Self) -> Self {
        Self {
            bodies: self.bodies.max(other.bodies),
            compounds: self.compounds.max(other.compounds),
            parts: self.parts.max(other.parts),
            planes: self.planes.max(other.planes),
            pairs: self.pairs.max(other.pairs),
            hits: self.hits.max(other.hits),
            plane_contacts: self.plane_contacts.max(other.plane_contacts),
            pieces: self.pieces.max(other.pieces),
            meshes: self.meshes.max(other.meshes),
            words: self.words.max(other.words),
        }
    }

    /// Number of grid buckets: at least twice the number of bodies.
    pub fn buckets(&self) -> u32 {
        (2 * self.bodies).next_power_of_two().max(64)
    }

    /// Number of bits of a bucket's index.
    pub fn bucket_bits(&self) -> u32 {
        self.buckets().trailing_zeros()
    }

    /// Number of bits of a body's index, or of the one after the last.
    pub fn body_bits(&self) -> u32 {
        32 - self.bodies.leading_zeros()
    }

    /// Keys of the longest sort: one per body, or two per pair.
    fn keys(&self) -> u32 {
        self.bodies.max(self.pairs.saturating_mul(2))
    }
}

/// Declares a set of buffers. Each has the name by which kernels find it, an element type, a length that depends on the
/// capacity of the set, and a description for error messages.
///
/// The result is a struct with a public field `capacity`, one field per buffer, and the functions `new` and `bytes`.
macro_rules! buffers {
    ($(#[$doc:meta])* $set:ident($capacity_type:ty), |$capacity:ident| {
        $($(#[$buffer_doc:meta])* $name:ident: $usage:ident $element:ty, $count:expr, $what:literal;)*
    }) => {
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $set {
            /// Capacity of the lists.
            pub capacity: $capacity_type,
            $($(#[$buffer_doc])* #[allow(missing_docs)] pub $name: wgpu::Buffer,)*
        }

        impl $set {
            /// Name and WGSL element type of each buffer.
            pub const ELEMENTS: &'static [(&'static str, &'static str)] =
                &[$((stringify!($name), <$element as $crate::gpu::layout::Element>::WGSL)),*];

            /// Description and size of each buffer with this capacity, bytes.
            pub fn sizes($capacity: &$capacity_type) -> Vec<(&'static str, u64)> {
                vec![$(($what, u64::from($count) * size_of::<$element>() as u64)),*]
            }

            /// Creates all buffers.
            ///
            /// # Errors
            /// If one exceeds the limits of the device. Then none is created.
            pub fn new(gpu: &$crate::gpu::device::Gpu, capacity: $capacity_type) -> Result<Self, $crate::gpu::buffers::TooLarge> {
                $(let $name = {
                    #[allow(unused_variables)]
                    let $capacity = &capacity;
                    $crate::gpu::buffers::check(gpu, $what, u64::from($count) * size_of::<$element>() as u64)?
                };)*
                Ok(Self {
                    capacity,
                    $($name: $crate::gpu::buffers::make(gpu, $what, $name, $crate::gpu::buffers::$usage),)*
                })
            }

            /// Total size, bytes.
            pub fn bytes(&self) -> u64 {
                [$(&self.$name),*].into_iter().map(wgpu::Buffer::size).sum()
            }
        }

        impl $crate::gpu::program::BufferSet for $set {
            fn find(&self, name: &str) -> Option<&wgpu::Buffer> {
                match name {
                    $(stringify!($name) => Some(&self.$name),)*
                    _ => None,
                }
            }
        }
    };
}

pub(crate) use buffers;

/// An array that kernels read and write.
pub(crate) const ARRAY: BufferUsages = BufferUsages::empty();
/// A struct that kernels read.
pub(crate) const UNIFORM: BufferUsages = BufferUsages::UNIFORM;
/// Arguments of indirect dispatches.
pub(crate) const INDIRECT: BufferUsages = BufferUsages::INDIRECT;

buffers! {
    /// The buffers of a step without contact points. `shaders/shared/types.wgsl` explains their elements.
    Buffers(Capacity), |capacity| {
        /// Parameters of the step.
        step: UNIFORM Step, 1u32, "step";
        /// The step as the host sends it. A step starts with a copy, because a kernel writes which collision substeps
        /// are needed.
        sent_step: ARRAY Step, 1u32, "step as sent";
        bodies: ARRAY Body, capacity.bodies, "bodies";
        /// Bodies as the host sends them. A step starts with a copy, because kernels write the poses.
        sent_bodies: ARRAY Body, capacity.bodies, "bodies as sent";
        /// Copy for rendering.
        before: ARRAY Body, capacity.bodies, "bodies before the step";
        compounds: ARRAY Compound, capacity.compounds, "compounds";
        /// Compounds as the host sends them.
        sent_compounds: ARRAY Compound, capacity.compounds, "compounds as sent";
        /// Colliders of compounds. Those of one compound are contiguous.
        parts: ARRAY CompoundPart, capacity.parts, "colliders of compounds";
        planes: ARRAY Plane, capacity.planes, "half-spaces";
        meshes: ARRAY Mesh, capacity.meshes, "meshes";
        words: ARRAY u32, capacity.words, "mesh data";
        counters: ARRAY u32, COUNTERS, "counters";
        status: ARRAY u32, 4u32, "status";
        arguments: INDIRECT u32, 16u32, "arguments";
        /// Kernels that `arguments` dispatches write these.
        piece_arguments: INDIRECT u32, 4u32, "arguments for pieces";
        /// Two pairs of arrays, between which sorts move keys and values.
        keys: ARRAY u32, capacity.keys(), "sort keys";
        values: ARRAY u32, capacity.keys(), "sort values";
        other_keys: ARRAY u32, capacity.keys(), "sort keys, scratch";
        other_values: ARRAY u32, capacity.keys(), "sort values, scratch";
        digits: ARRAY u32, radix_sort::DIGITS * capacity.keys().div_ceil(radix_sort::BLOCK) + 1, "sort digits";
        sums: ARRAY u32, capacity.bodies.div_ceil(scan::BLOCK).max(radix_sort::digit_groups(capacity.keys())) + 1, "scan sums";
        entries: ARRAY GridEntry, capacity.bodies, "grid entries";
        buckets: ARRAY [u32; 2], capacity.buckets(), "grid buckets";
        pair_counts: ARRAY u32, capacity.bodies, "pair counts";
        sphere_pairs: ARRAY [u32; 2], capacity.pairs, "sphere pairs";
        near_pairs: ARRAY NearPair, capacity.pairs, "near pairs";
        results: ARRAY PairResult, capacity.pairs, "pair results";
        touching: ARRAY Touching, capacity.pairs, "touching pairs";
        pieces: ARRAY Piece, capacity.pieces, "pieces of pairs";
        hits: ARRAY Hit, capacity.hits, "intersecting faces";
        plane_contacts: ARRAY PlaneContact, capacity.plane_contacts, "contacts with half-spaces";
        body_contacts: ARRAY BodyContacts, capacity.bodies, "contacts by body";
        impulses: ARRAY Impulse, capacity.bodies, "impulses";
        /// Motions after the step, first of colliders, then of compounds. They persist until the next step.
        moved: ARRAY Moved, capacity.bodies.saturating_add(capacity.compounds), "moved bodies";
    }
}

/// The size of a buffer: at least one element of any kind.
pub(crate) fn check(gpu: &Gpu, what: &'static str, bytes: u64) -> Result<u64, TooLarge> {
    let limit = longest_list(gpu);
    if bytes > limit {
        return Err(TooLarge { what, bytes, limit });
    }
    Ok(bytes.max(256))
}

/// The size of the longest list that the device holds, bytes.
pub(crate) fn longest_list(gpu: &Gpu) -> u64 {
    let limits = gpu.device.limits();
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

/// Creates a buffer of `size` bytes.
pub(crate) fn make(gpu: &Gpu, what: &str, size: u64, usage: BufferUsages) -> Buffer {
    gpu.device.create_buffer(&BufferDescriptor {
        label: Some(what),
        size,
        usage: usage | BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
