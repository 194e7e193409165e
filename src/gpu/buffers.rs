//! Every buffer of a step, and how large it is.

use super::layout::*;
use super::{device::Gpu, radix_sort, scan};
use thiserror::Error;
use wgpu::{Buffer, BufferDescriptor, BufferUsages};

/// How many of each thing fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
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

impl Sizes {
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

macro_rules! buffers {
    ($($name:ident: $what:literal, $element:ty, $usage:expr, |$sizes:ident| $count:expr;)*) => {
        /// Every buffer of a step; `shaders/shared/types.wgsl` explains their elements.
        #[derive(Debug)]
        #[allow(missing_docs)]
        pub struct Buffers {
            /// What fits.
            pub sizes: Sizes,
            $(pub $name: Buffer,)*
            /// Two pairs of arrays between which sorts move keys and values.
            pub keys: [Buffer; 2],
            pub values: [Buffer; 2],
        }

        impl Buffers {
            /// Makes all of them.
            ///
            /// # Errors
            /// If one is larger than the device allows; none is made then.
            pub fn new(gpu: &Gpu, sizes: Sizes) -> Result<Self, TooLarge> {
                let keys = u64::from(sizes.keys()) * 4;
                $(let $name = {
                    let $sizes = &sizes;
                    check(gpu, $what, u64::from($count) * size_of::<$element>() as u64)?
                };)*
                let keys = check(gpu, "sort keys", keys)?;
                $(let $name = make(gpu, $what, $name, $usage);)*
                let pair = |what| [make(gpu, what, keys, NONE), make(gpu, what, keys, NONE)];
                Ok(Self { sizes, $($name,)* keys: pair("sort keys"), values: pair("sort values") })
            }

            /// Bytes of all of them.
            pub fn bytes(&self) -> u64 {
                let keys = [&self.keys[0], &self.keys[1], &self.values[0], &self.values[1]];
                [$(&self.$name),*].into_iter().chain(keys).map(Buffer::size).sum()
            }
        }
    };
}

const NONE: BufferUsages = BufferUsages::empty();

buffers! {
    step: "step", Step, BufferUsages::UNIFORM, |_s| 1u32;
    bodies: "bodies", Body, NONE, |s| s.bodies;
    before: "bodies before the step", Body, NONE, |s| s.bodies;
    planes: "half-spaces", Plane, NONE, |s| s.planes;
    meshes: "meshes", Mesh, NONE, |s| s.meshes;
    words: "mesh data", u32, NONE, |s| s.words;
    counters: "counters", u32, NONE, |_s| COUNTERS;
    status: "status", u32, NONE, |_s| 4u32;
    arguments: "arguments", u32, BufferUsages::INDIRECT, |_s| 16u32;
    digits: "sort digits", u32, NONE, |s| 256 * s.keys().div_ceil(radix_sort::BLOCK) + 1;
    sums: "scan sums", u32, NONE, |s| s.bodies.div_ceil(scan::BLOCK).max(radix_sort::digit_groups(s.keys())) + 1;
    entries: "grid entries", GridEntry, NONE, |s| s.bodies;
    buckets: "grid buckets", [u32; 2], NONE, |s| s.buckets();
    pair_counts: "pair counts", u32, NONE, |s| s.bodies;
    sphere_pairs: "sphere pairs", [u32; 2], NONE, |s| s.pairs;
    near_pairs: "near pairs", NearPair, NONE, |s| s.pairs;
    results: "pair results", PairResult, NONE, |s| s.pairs;
    touching: "touching pairs", Touching, NONE, |s| s.pairs;
    hits: "intersecting faces", Hit, NONE, |s| s.hits;
    plane_contacts: "contacts with half-spaces", PlaneContact, NONE, |s| s.plane_contacts;
    body_contacts: "contacts by body", BodyContacts, NONE, |s| s.bodies;
    impulses: "impulses", Impulse, NONE, |s| s.bodies;
    moved: "moved bodies", Moved, NONE, |s| s.bodies;
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
