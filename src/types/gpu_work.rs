//! What a step asked of a GPU: commands, bytes and memory.

/// What a step asked of a GPU. It is counted where the commands are recorded.
///
/// A step whose lists were too short is repeated. The counts then include all its attempts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub struct GpuWork {
    /// Calls of kernels.
    pub dispatches: u32,
    /// Dispatches whose number of workgroups is computed on the GPU.
    pub indirect: u32,
    /// Dispatches that wgpu adds: one before each indirect one, which checks its arguments. None on a device that this
    /// crate has opened itself, unless the environment variable `WGPU_VALIDATION_INDIRECT_CALL` is 1.
    pub validations: u32,
    /// Compute passes.
    pub passes: u32,
    /// Copies from buffer to buffer, and buffers set to zero.
    pub copies: u32,
    /// Submissions to the queue.
    pub submissions: u32,
    /// Bytes written from the CPU to the GPU, meshes included.
    pub uploaded_bytes: u64,
    /// Bytes copied for the CPU to read.
    pub read_back_bytes: u64,
    /// Size of all buffers after the step, bytes.
    pub memory_bytes: u64,
    /// Number of batches in which contact points were made of the pairs: more than one if there are hundreds of
    /// thousands of pairs near each other. Their lists share memory. None with
    /// [`Response::Impulse`](crate::types::settings::Response::Impulse).
    pub batches: u32,
    /// The lists whose length is known on the GPU only.
    pub lists: GpuLists,
}

impl GpuWork {
    /// Adds the work of an earlier attempt of the same step.
    pub fn after(self, earlier: &Self) -> Self {
        Self {
            dispatches: self.dispatches + earlier.dispatches,
            indirect: self.indirect + earlier.indirect,
            validations: self.validations + earlier.validations,
            passes: self.passes + earlier.passes,
            copies: self.copies + earlier.copies,
            submissions: self.submissions + earlier.submissions,
            uploaded_bytes: self.uploaded_bytes + earlier.uploaded_bytes,
            read_back_bytes: self.read_back_bytes + earlier.read_back_bytes,
            ..self
        }
    }
}

/// Lists that kernels fill: how long each was, and for how many elements there is room. Lists of contact points have no
/// room with [`Response::Impulse`](crate::types::settings::Response::Impulse).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub struct GpuLists {
    /// Pairs of bodies whose bounding spheres overlap. If several collision substeps may be needed, the list first
    /// holds the pairs that can meet within the step.
    pub sphere_pairs: GpuList,
    /// Intersecting face pairs.
    pub face_pairs: GpuList,
    /// Contacts with planes.
    pub plane_contacts: GpuList,
    /// Pieces of large pairs, such as two meshes of more than 1,024 triangles. Each has a workgroup of its own.
    pub pair_pieces: GpuList,
    /// Pairs of triangles near each other, of a batch.
    pub near_triangles: GpuList,
    /// Pieces of large pairs in the search for near triangles, of a batch.
    pub near_pieces: GpuList,
    /// Features from which contact points are made, of a batch.
    pub features: GpuList,
    /// Segments in which faces intersect, of a batch.
    pub segments: GpuList,
    /// Contact points before they are put in order.
    pub staged_points: GpuList,
    /// Manifolds.
    pub manifolds: GpuList,
    /// Contact points.
    pub contact_points: GpuList,
    /// Points of touching pairs, in all collision substeps.
    pub touches: GpuList,
}

/// The use of a list on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub struct GpuList {
    /// Number of elements; with several collision substeps or batches, of the one that had most. Which
    /// pairs share a batch may differ from run to run.
    pub length: u32,
    /// Number of elements for which there is room.
    pub capacity: u32,
}

impl GpuLists {
    /// Name and use of each list.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, GpuList)> {
        let Self {
            sphere_pairs,
            face_pairs,
            plane_contacts,
            pair_pieces,
            near_triangles,
            near_pieces,
            features,
            segments,
            staged_points,
            manifolds,
            contact_points,
            touches,
        } = *self;
        [
            ("sphere_pairs", sphere_pairs),
            ("face_pairs", face_pairs),
            ("plane_contacts", plane_contacts),
            ("pair_pieces", pair_pieces),
            ("near_triangles", near_triangles),
            ("near_pieces", near_pieces),
            ("features", features),
            ("segments", segments),
            ("staged_points", staged_points),
            ("manifolds", manifolds),
            ("contact_points", contact_points),
            ("touches", touches),
        ]
        .into_iter()
    }
}
