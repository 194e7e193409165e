//! The structs and constants that kernels share with the host. `shaders/shared/types.wgsl` has the same structs and
//! explains their fields.
//!
//! Vectors of three are followed by a scalar that fills their fourth word, so that the layouts of Rust and WGSL agree;
//! `tests/gpu/contract.rs` compares every offset. Structs are declared in both languages, because some of their fields
//! are atomic in WGSL. Constants are declared here only; the WGSL module `faceoff::types` imports them.

use bytemuck::{Pod, Zeroable};

/// The element type of an array on the device.
pub trait Element: Pod {
    /// Name of the type in WGSL.
    const WGSL: &'static str;
}

impl Element for u32 {
    const WGSL: &'static str = "u32";
}

impl Element for [u32; 2] {
    const WGSL: &'static str = "vec2<u32>";
}

impl Element for [u32; 4] {
    const WGSL: &'static str = "vec4<u32>";
}

macro_rules! layout {
    ($($(#[$doc:meta])* $name:ident { $($field:ident: $type:ty),* $(,)? })*) => {
        $(
            $(#[$doc])*
            #[repr(C)]
            #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
            #[allow(missing_docs)]
            pub struct $name {
                $(pub $field: $type,)*
            }

            impl $crate::gpu::layout::Element for $name {
                const WGSL: &'static str = stringify!($name);
            }
        )*

        /// Name, size and field offsets of every struct in this module.
        pub const STRUCTS: &[$crate::gpu::layout::Struct] = &[$($crate::gpu::layout::Struct {
            name: stringify!($name),
            size: size_of::<$name>(),
            fields: &[$((stringify!($field), std::mem::offset_of!($name, $field))),*],
        }),*];
    };
}

/// The layout of a struct.
#[derive(Clone, Copy, Debug)]
pub struct Struct {
    /// Name of the struct, the same in both languages.
    pub name: &'static str,
    /// Size, bytes.
    pub size: usize,
    /// Names and offsets, bytes.
    pub fields: &'static [(&'static str, usize)],
}

type Vec3 = [f32; 3];

layout! {
    /// Parameters of a step.
    Step {
        gravity: Vec3, dt: f32,
        bodies: u32, planes: u32, bucket_mask: u32, response: u32,
        pair_capacity: u32, hit_capacity: u32, plane_contact_capacity: u32, touch_capacity: u32,
        contact_margin: f32, travel_scale: f32, planes_changed: u32, compounds: u32,
        drift: Vec3, has_fast_bodies: u32,
        hit_limit: u32, same_numbers: u32, piece_capacity: u32, is_over: u32,
        substeps: u32, rest_offset: f32, padding_a: u32, padding_b: u32,
    }
    /// Input and state of a body.
    Body {
        position: Vec3, mesh: u32,
        rotation: [f32; 4],
        scale: Vec3, radius: f32,
        linear_velocity: Vec3, inverse_mass: f32,
        angular_velocity: Vec3, restitution: f32,
        inverse_inertia: Vec3, gravity_scale: f32,
        inverse_inertia_off_diagonal: Vec3, flags: u32,
        memberships: u32, filters: u32, source: u32, carried: u32,
        speculative_radius: f32, thickness: f32, inactive: u32, body: u32,
        travel_time: f32, center_offset: f32, force_acceleration: f32, torque_acceleration: f32,
        acceleration: Vec3, rounding: f32,
    }
    /// A moving body whose colliders are placed in it.
    Compound {
        position: Vec3, collider: u32,
        rotation: [f32; 4],
        center: Vec3, radius: f32,
        linear_velocity: Vec3, first_part: u32,
        angular_velocity: Vec3, part_count: u32,
        source: u32, carried: u32, last_collider: u32, padding: u32,
    }
    /// A collider of a compound.
    CompoundPart {
        translation: Vec3, collider: u32,
        rotation: [f32; 4],
        offset: Vec3, padding: u32,
    }
    /// A plane.
    Plane {
        normal: Vec3, distance: f32,
        restitution: f32, memberships: u32, filters: u32, sensor: u32,
    }
    /// Where the data of a mesh lies in the array of words.
    Mesh {
        center: Vec3, radius: f32,
        triangles: u32, triangle_count: u32, boxes: u32, levels: u32,
        vertices: u32, vertex_count: u32, heights: u32, flags: u32,
        components: u32, component_count: u32, directions: u32, direction_steps: u32,
        groups: u32, group_words: u32, features: u32, corners: u32,
        box_center: Vec3, caps: u32,
        box_half: Vec3, cap_count: u32,
        fingerprint_low: u32, fingerprint_high: u32, padding_a: u32, padding_b: u32,
    }
    /// The sphere that a collider sweeps over in a step.
    Sweep {
        center: Vec3, radius: f32,
        travel: Vec3, flags: u32,
        spin: f32, padding_a: u32, padding_b: u32, padding_c: u32,
    }
    /// The solid bodies of a group that can meet within a step.
    Meeting {
        highest: [u32; 3], exists: u32,
        highest_negated: [u32; 3], spin: u32,
        high: [u32; 3], thinnest: u32,
        high_negated: [u32; 3], substeps: u32,
    }
    /// How a step is divided into collision substeps.
    Division {
        travel: f32, most: u32, recorded: u32, padding: u32,
    }
    /// A body in the sorted grid.
    GridEntry {
        center: Vec3, radius: f32,
        body: u32, level: i32, flags: u32, padding: u32,
    }
    /// A pair of bodies whose spheres overlap, with the results of Angles.
    NearPair {
        a: u32, b: u32, near: u32, margin: f32,
        x: Vec3, a_below: f32,
        y: Vec3, b_above: f32,
        z: Vec3, error: f32,
        translation: Vec3, view_a: u32,
        axis: Vec3, view_b: u32,
    }
    /// The result of TriangleTest for a pair.
    PairResult {
        point: Vec3, touching: u32,
        normal: Vec3, padding: u32,
        a: u32, b: u32, first_piece: u32, pieces: u32,
    }
    /// A piece of a pair of large meshes, and what TriangleTest finds there.
    Piece {
        middle: Vec3, length: f32,
        area: Vec3, pair: u32,
        closing: Vec3, hits: u32,
        origin: Vec3, first_hit: u32,
        node_a: u32, node_b: u32, padding_a: u32, padding_b: u32,
    }
    /// The result for the host, for pairs that touch.
    Touching {
        point: Vec3, a: u32,
        normal: Vec3, b: u32,
        pair: u32, hits: u32, contained: u32, padding: u32,
    }
    /// Two intersecting triangles.
    Hit {
        pair: u32, index: u32, a: u32, b: u32,
        start_x: f32, start_y: f32, start_z: f32,
        end_x: f32, end_y: f32, end_z: f32,
    }
    /// A body that penetrates a plane.
    PlaneContact {
        anchor: Vec3, depth: f32,
        point: Vec3, body: u32,
        plane: u32, padding_a: u32, padding_b: u32, padding_c: u32,
    }
    /// The contacts of a body.
    BodyContacts {
        first_entry: u32, last_entry: u32, first_plane: u32, planes: u32,
        active_contacts: u32, offset_x: f32, offset_y: f32, offset_z: f32,
    }
    /// Motion of a body after a step.
    Moved {
        position: Vec3, asleep: u32,
        rotation: [f32; 4],
        linear_velocity: Vec3, padding_a: u32,
        angular_velocity: Vec3, padding_b: u32,
    }
    /// A change of velocity.
    Impulse {
        linear: Vec3, padding_a: f32,
        angular: Vec3, padding_b: f32,
    }
    /// Lengths of the lists of contact generation.
    ContactLimits {
        near_triangles: u32, features: u32, segments: u32, staged_points: u32,
        pairs: u32, points: u32, bodies: u32, planes: u32,
        padding: [u32; 3], pieces: u32,
    }
    /// A pair of bodies whose contact points are requested.
    MarginPair {
        a: u32, b: u32, margin: f32, padding: u32,
    }
    /// The relative pose of such a pair, and its ranges in the lists.
    PairSetup {
        a: u32, b: u32, valid: u32, unit: f32,
        rotation: [f32; 4],
        x: Vec3, size: f32,
        y: Vec3, margin: f32,
        z: Vec3, rounding: f32,
        offset_a: Vec3, touch: f32,
        offset_b: Vec3, mesh_a: u32,
        scale_a: Vec3, mesh_b: u32,
        scale_b: Vec3, patch_count: u32,
        window_min: Vec3, first_near: u32,
        window_max: Vec3, near_count: u32,
        window_direction: Vec3, first_segment: u32,
        segment_count: u32, first_feature: u32, feature_count: u32, first_deep: u32,
        deep_count: u32, first_probe: u32, probe_count: u32, is_split: u32,
        spin: Vec3, first_nearest: u32,
        nearest_count: u32, has_dropped: u32, first_meeting: u32, meeting_count: u32,
        rounded_a: f32, rounded_b: f32, padding_a: u32, padding_b: u32,
    }
    /// A piece of a pair of large meshes, and what contact generation finds there.
    NearPiece {
        pair: u32, node_a: u32, node_b: u32, first_near: u32,
        near_count: u32, first_feature: u32, first_segment: u32, padding: u32,
    }
    /// A contact feature.
    Feature {
        point_a: Vec3, separation: f32,
        point_b: Vec3, distance: f32,
        normal: Vec3, vertex: u32,
        a: u32, b: u32, origin: u32, padding: u32,
    }
    /// The segment in which two triangles cross.
    Segment {
        start: Vec3, start_edge: u32,
        end: Vec3, end_edge: u32,
        a: u32, b: u32, padding: [u32; 2],
    }
    /// The part of both surfaces inside a closed contour.
    Patch {
        center: Vec3, reach: f32,
        normal: Vec3, area: f32,
        node_center: Vec3, node_radius: f32,
        extremes: [u32; 4],
        length: f32, a: u32, b: u32, too_deep: u32,
        rim_middle: Vec3, rim_depth: f32,
        rim_half: Vec3, rim: u32,
    }
    /// A contact point, in world axes and metres.
    ContactPoint {
        anchor_a: Vec3, separation: f32,
        anchor_b: Vec3, curvature_radius_a: f32,
        normal: Vec3, curvature_radius_b: f32,
        face_a: u32, face_b: u32, normal_rotation: f32, bulge: f32,
    }
    /// The manifold of a pair.
    ContactPair {
        a: u32, b: u32, first_point: u32, point_count: u32,
    }
    /// A contact point of two bodies that touched in a collision substep.
    Touch {
        point: Vec3, a: u32,
        normal: Vec3, b: u32,
        separation: f32, impulse: f32, collision_substep: u32, index: u32,
    }
}

macro_rules! constants {
    ($($(#[$doc:meta])* $type:ident $name:ident = $value:expr;)*) => {
        $($(#[$doc])* #[allow(missing_docs)] pub const $name: $type = $value;)*

        /// Name and value of every constant in this module, for the WGSL.
        pub const CONSTANTS: &[(&str, $crate::gpu::shader::Value)] =
            &[$((stringify!($name), $crate::gpu::shader::shared_value!($type $name))),*];
    };
}

// The solver declares its own structs and constants with these macros.
pub(crate) use {constants, layout};

constants! {
    // Bits of `Body::flags`.
    u32 KIND_MASK = 3;
    u32 DYNAMIC = 0;
    u32 KINEMATIC = 1;
    u32 STATIC = 2;
    u32 SENSOR = 4;
    u32 CULLING_MASK = 24;
    u32 CULLING_FACES = 8;
    u32 CULLING_FRONT = 16;
    /// The collider belongs to a compound, which places it.
    u32 PART = 32;
    /// Continuous collision stops the body, so that its speed causes no collision substeps.
    u32 FAST = 64;

    // Bits of `Body::carried` and `Compound::carried`: what carries over from the last step, in which the body had the
    // number `source`.
    /// The rotation comes from `moved[source]`; otherwise from the host.
    u32 CARRIED_ROTATION = 1;
    /// The body was in that step, and its centre of mass is at the same place in its axes. If its pose is that of
    /// `moved[source]`, its centre of mass has not moved.
    u32 CONTINUES = 4;
    /// If it has not moved, its sleep state carries over. A static body then has not changed.
    u32 CARRIED_SLEEP = 8;
    /// The host wakes it.
    u32 WOKEN = 16;
    /// The first of three bits for x, y and z: along that axis the value is that of `moved[source]` plus what the host
    /// sent.
    u32 CARRIED_POSITION = 32;
    u32 CARRIED_LINEAR = 256;
    u32 CARRIED_ANGULAR = 2048;

    // `NearPair::near`.
    /// A support axis separates the bodies by more than the margin.
    u32 FAR = 0;
    /// A support axis separates them by less than the margin.
    u32 NEAR = 1;
    /// No separating support axis was found.
    u32 OVERLAPPING = 2;

    // Bits of `Mesh::flags`.
    /// The body can contain other bodies.
    u32 SOLID = 1;
    u32 ORIENTATION_MASK = 6;
    u32 OUTWARD = 0;
    u32 INWARD = 2;
    u32 MIXED = 4;
    u32 OPEN = 6;
    /// Some of its triangles are two-sided.
    u32 SOME_TWO_SIDED = 8;
    /// The mesh is a segment or a point.
    u32 THIN = 16;

    /// A triangle is one-sided: a bit of what it owns.
    u32 ONE_SIDED = 64;

    // Indices into `counters`. Before each step the host sets the first and zeroes the others. The results of the
    // triangle test are those of the first collision substep, the others those of the last.
    u32 BODIES = 0;
    /// Two words: one bit per level that has bodies.
    u32 LEVELS = 1;
    /// The number found, even if the list is shorter.
    u32 SPHERE_PAIRS = 3;
    u32 HITS = 4;
    u32 PLANE_CONTACTS = 5;
    u32 TOUCHING = 6;
    u32 TRIANGLE_TESTS = 7;
    u32 APPROXIMATE = 8;
    u32 ENTRIES = 9;
    /// Not 0: a list was too short, and the bodies were not moved.
    u32 SKIPPED = 10;
    /// The number of sphere pairs in the list; 0 if they do not fit.
    u32 PAIRS = 11;
    /// Not 0: the device aborted a loop.
    u32 CUT_SHORT = 12;
    /// Number of pairs whose contact points are requested.
    u32 SELECTED = 13;
    /// Pieces of pairs of large meshes.
    u32 PIECES = 14;
    /// Number of collision substeps that the step needs.
    u32 NEEDED_SUBSTEPS = 15;
    u32 COUNTERS = 16;

    // Slots of `arguments`: a workgroup per 64 pairs, per pair, per block of a sort of two entries per pair, per block
    // of the scan of that sort's digits.
    u32 GROUPS_PER_64_PAIRS = 0;
    u32 GROUPS_PER_PAIR = 1;
    u32 GROUPS_PER_SORT_BLOCK = 2;
    u32 GROUPS_PER_DIGIT_BLOCK = 3;

    /// Index into `status`. Not 0: a list was too short, in this step or in an earlier one that has not been repeated
    /// yet.
    u32 OVERFLOW = 0;

    /// This bit of `Hit::pair` marks the number of a piece.
    u32 OF_PIECE = 0x8000_0000;
    /// This bit of a vertex or edge number marks the second body of a pair.
    u32 OF_SECOND = 0x8000_0000;
    /// Stands for no vertex or triangle number.
    u32 NOTHING = 0xffff_ffff;
    /// In place of an infinite radius of curvature: infinity is not portable in WGSL.
    f32 FLAT_RADIUS = 1.0e30;

    // Indices into `contact_counters`. The host zeroes them, but sets the numbers of pairs if it lists the
    // pairs itself. If a list is shorter than its counter, its contents are invalid.
    u32 MARGIN_PAIRS = 0;
    u32 CONTACT_SLOTS = 1;
    u32 STAGED_POINTS = 2;
    u32 CONTACT_PAIRS = 3;
    u32 CONTACT_POINTS = 4;
    /// Not 0: the device aborted a loop.
    u32 CONTACTS_CUT_SHORT = 5;
    /// Not 0: a list was too short or a loop was aborted, and the results are invalid.
    u32 CONTACTS_SKIPPED = 6;
    /// So many counters tell the host what the results are.
    u32 CONTACT_RESULTS = 8;
    // Counters of the current batch of pairs; zeroed before the next.
    u32 BATCH_PAIRS = 8;
    u32 NEAR_TRIANGLES = 9;
    u32 FEATURES = 10;
    u32 SEGMENTS = 11;
    /// Pieces of pairs of large meshes, in the search for all features, and in that for features that overlap.
    u32 NEAR_PIECES = 12;
    u32 DEEP_PIECES = 13;
    // The maxima over batches, and the sums.
    u32 MAX_NEAR_TRIANGLES = 14;
    u32 MAX_FEATURES = 15;
    u32 MAX_SEGMENTS = 16;
    u32 MAX_NEAR_PIECES = 17;
    u32 TOTAL_NEAR_TRIANGLES = 18;
    u32 TOTAL_FEATURES = 19;
    u32 TOTAL_SEGMENTS = 20;
    u32 TOTAL_NEAR_PIECES = 21;
    /// Pairs whose contact points are found; the others keep theirs.
    u32 ACTIVE_PAIRS = 22;
    u32 CONTACT_COUNTERS = 24;

    // Slots of `contact_arguments`: a workgroup per pair of the current batch, per 64 of these, per 64 slots, per block
    // of the scan of slots.
    u32 GROUPS_PER_BATCH_PAIR = 0;
    u32 GROUPS_PER_64_BATCH_PAIRS = 1;
    u32 GROUPS_PER_64_SLOTS = 2;
    u32 GROUPS_PER_SLOT_BLOCK = 3;

    // Indices into `tally`, which covers all collision substeps of a step. The first entries are the maxima of
    // `contact_counters`, at the same indices.
    /// Number of collision substeps so far.
    u32 COLLISION_SUBSTEPS = 24;
    /// The number found, even if the list is shorter.
    u32 TOUCHES = 25;
    /// Number of touching pairs of meshes in the last collision substep.
    u32 TOUCHING_NOW = 26;
    /// Number of sleeping bodies after the step.
    u32 ASLEEP = 27;
    /// Number of sphere pairs in any collision substep.
    u32 MAX_SPHERE_PAIRS = 28;
    // Maxima over all bodies that are neither static nor `FAST`, after the step, m/s: of the velocity along each axis,
    // of the negated velocity, and of the surface speed relative to the centre of mass. The values are integers in the
    // order of the floats (`ascending`); 0 stands for none.
    u32 MAX_VELOCITY = 29;
    u32 MAX_NEGATED_VELOCITY = 32;
    u32 MAX_SPIN = 35;
    /// Not 0: a collider has not rested since the step began, or a body that can move is awake after it.
    u32 AWAKE = 36;
    // The last collision substep that the step needed: pairs and points in the lists, and the counters of these names.
    u32 LAST_CONTACT_PAIRS = 37;
    u32 LAST_CONTACT_POINTS = 38;
    u32 LAST_SPHERE_PAIRS = 39;
    u32 LAST_APPROXIMATE = 40;
    /// Colliders that are not static, and the sum of their numbers of collision substeps, if these are counted.
    u32 SCHEDULED_BODIES = 41;
    u32 SCHEDULED_SUBSTEPS = 42;
    u32 TALLIES = 44;
}
