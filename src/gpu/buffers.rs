//! Every buffer of a step without contact points, how large it is, and how sets of buffers are declared.

use super::device::Gpu;
use super::layout::*;
use super::{radix_sort, scan};
use thiserror::Error;
use wgpu::{Buffer, BufferDescriptor, BufferUsages};

/// How many of each thing fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capacity {
    /// Body slots.
    pub bodies: u32,
    /// Half-spaces.
    pub planes: u32,
    /// Pairs of bodies whose spheres overlap.
    pub pairs: u32,
    /// Pairs of intersecting triangles.
    pub hits: u32,
    /// Contacts with half-spaces.
    pub plane_contacts: u32,
    /// Mesh slots.
    pub meshes: u32,
    /// Words of all meshes.
    pub words: u32,
}

/// Room for at least so many things: as it is, or with some to spare where it does not suffice, so that growing lists are made
/// anew a few times and not every step.
pub(crate) fn grow(has: u32, needs: u32) -> u32 {
    if needs > has {
        needs.saturating_add(needs / 4).saturating_add(64)
    } else {
        has
    }
}

/// A list that the device cannot hold.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the list of {what} takes {bytes} bytes, and the device binds at most {limit}")]
pub struct TooLarge {
    /// Of what.
    pub what: &'static str,
    /// How long it would be.
    pub bytes: u64,
    /// How long it may be.
    pub limit: u64,
}

impl Capacity {
    /// At least `needed` of each, with room to spare where these sizes do not suffice.
    pub fn grown(self, needed: Self) -> Self {
        Self {
            bodies: grow(self.bodies, needed.bodies),
            planes: grow(self.planes, needed.planes),
            pairs: grow(self.pairs, needed.pairs),
            hits: grow(self.hits, needed.hits),
            plane_contacts: grow(self.plane_contacts, needed.plane_contacts),
            meshes: grow(self.meshes, needed.meshes),
            words: grow(self.words, needed.words),
        }
    }

    /// The grid has at least twice as many buckets as bodies.
    pub fn buckets(&self) -> u32 {
        (2 * self.bodies).next_power_of_two().max(64)
    }

    /// Bits of a bucket's number.
    pub fn bucket_bits(&self) -> u32 {
        self.buckets().trailing_zeros()
    }

    /// Bits of a body's number, or of the one after the last.
    pub fn body_bits(&self) -> u32 {
        32 - self.bodies.leading_zeros()
    }

    /// Keys of the longest sort: one a body, two a pair.
    fn keys(&self) -> u32 {
        self.bodies.max(self.pairs.saturating_mul(2))
    }
}

/// A set of buffers. Each has a name, by which kernels find it, the kind of its elements, and how many there are by the sizes
/// of the set; the text says in errors what it holds.
///
/// Declares a struct with a public field `capacity`, one for each buffer, and the functions `new` and `bytes`.
macro_rules! buffers {
    ($(#[$doc:meta])* $set:ident($capacity_type:ty), |$capacity:ident| {
        $($(#[$buffer_doc:meta])* $name:ident: $usage:ident $element:ty, $count:expr, $what:literal;)*
    }) => {
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $set {
            /// What fits.
            pub capacity: $capacity_type,
            $($(#[$buffer_doc])* #[allow(missing_docs)] pub $name: wgpu::Buffer,)*
        }

        impl $set {
            /// Names of all, and what their elements are called in WGSL.
            pub const ELEMENTS: &'static [(&'static str, &'static str)] =
                &[$((stringify!($name), <$element as $crate::gpu::layout::Element>::WGSL)),*];

            /// Makes all of them.
            ///
            /// # Errors
            /// If one is larger than the device allows; none is made then.
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

            /// Bytes of all of them.
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

/// Of an array that kernels read and write.
pub(crate) const ARRAY: BufferUsages = BufferUsages::empty();
/// Of a struct that kernels read.
pub(crate) const UNIFORM: BufferUsages = BufferUsages::UNIFORM;
/// Of the arguments of indirect dispatches.
pub(crate) const INDIRECT: BufferUsages = BufferUsages::INDIRECT;

buffers! {
    /// Every buffer of a step without contact points; `shaders/shared/types.wgsl` explains their elements.
    Buffers(Capacity), |capacity| {
        /// What holds for all bodies.
        step: UNIFORM Step, 1u32, "step";
        bodies: ARRAY Body, capacity.bodies, "bodies";
        /// To draw from.
        before: ARRAY Body, capacity.bodies, "bodies before the step";
        planes: ARRAY Plane, capacity.planes, "half-spaces";
        meshes: ARRAY Mesh, capacity.meshes, "meshes";
        words: ARRAY u32, capacity.words, "mesh data";
        counters: ARRAY u32, COUNTERS, "counters";
        status: ARRAY u32, 4u32, "status";
        arguments: INDIRECT u32, 16u32, "arguments";
        /// Two pairs of arrays between which sorts move keys and values.
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
        hits: ARRAY Hit, capacity.hits, "intersecting faces";
        plane_contacts: ARRAY PlaneContact, capacity.plane_contacts, "contacts with half-spaces";
        body_contacts: ARRAY BodyContacts, capacity.bodies, "contacts by body";
        impulses: ARRAY Impulse, capacity.bodies, "impulses";
        /// Where the bodies are after the step. Outlives it.
        moved: ARRAY Moved, capacity.bodies, "moved bodies";
    }
}

/// The size of a buffer that the device can bind, at least one element of any kind.
pub(crate) fn check(gpu: &Gpu, what: &'static str, bytes: u64) -> Result<u64, TooLarge> {
    let limits = gpu.device.limits();
    let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    if bytes > limit {
        return Err(TooLarge { what, bytes, limit });
    }
    Ok(bytes.max(256))
}

/// A buffer of so many bytes.
pub(crate) fn make(gpu: &Gpu, what: &str, size: u64, usage: BufferUsages) -> Buffer {
    gpu.device.create_buffer(&BufferDescriptor {
        label: Some(what),
        size,
        usage: usage | BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
