#define_import_path faceoff::types

// What passes between host and kernels. `src/gpu/layout.rs` holds the same structs, of which a test compares every offset;
// and it holds the constants of this module, which are added to it from there.

// What holds for all bodies in a step.
struct Step {
    gravity: vec3<f32>,
    dt: f32,
    bodies: u32,
    planes: u32,
    // Number of hash buckets of the grid, a power of two, less one.
    bucket_mask: u32,
    // 0: nothing is pushed.
    response: u32,
    // How many entries the lists of unknown length hold.
    pair_capacity: u32,
    hit_capacity: u32,
    plane_contact_capacity: u32,
    touch_capacity: u32,
    // How near bodies must come for contact points to be found, as a part of the smaller diameter; 0 if none are wanted.
    contact_margin: f32,
    // Bodies look as far as they move in this many seconds.
    speculative_time: f32,
    // Not 0: half-spaces are not those of the last step.
    planes_changed: u32,
    padding_a: u32,
    // The velocity that bodies have in common, m/s.
    drift: vec3<f32>,
    padding_b: u32,
}

// A body's input and state. A slot without a body has a radius of zero.
struct Body {
    // Where the mesh's origin lies.
    position: vec3<f32>,
    mesh: u32,
    // Unit quaternion.
    rotation: vec4<f32>,
    scale: vec3<f32>,
    // Of the bounding sphere about the centre of mass, rounded up; complete once the body is placed.
    radius: f32,
    linear_velocity: vec3<f32>,
    inverse_mass: f32,
    angular_velocity: vec3<f32>,
    restitution: f32,
    // Inverse inertia in the body's own axes: xx, yy, zz and xy, xz, yz.
    inverse_inertia: vec3<f32>,
    gravity_scale: f32,
    inverse_inertia_off_diagonal: vec3<f32>,
    // Two bits of kind, one of sensor, two of culling; see the constants.
    flags: u32,
    // Collision layers.
    memberships: u32,
    filters: u32,
    // Which body of the step before this is, and what of its state comes from there; see the constants.
    source: u32,
    carried: u32,
    // Of the sphere in which it looks for others; follows from the velocities, the radius and the margin.
    speculative_radius: f32,
    // Of its thinnest part, metres.
    thickness: f32,
    // Not 0: nothing about it has changed since it was last looked at, in which `source` was its number: it sleeps, or is
    // static.
    inactive: u32,
    padding: u32,
}

// A half-space, solid where `dot(normal, p) < distance`.
struct Plane {
    normal: vec3<f32>,
    distance: f32,
    restitution: f32,
    padding_a: f32,
    padding_b: f32,
    padding_c: f32,
}

// Where a mesh lies in the arena of words. Coordinates there are relative to the centre of mass.
struct Mesh {
    // Centre of mass in the mesh's own space.
    center: vec3<f32>,
    radius: f32,
    // Nine words a triangle.
    triangles: u32,
    triangle_count: u32,
    // Six words a box, centre and half size: level 0 has one per eight triangles, each next one per eight boxes.
    boxes: u32,
    levels: u32,
    // Three words a vertex, each position once.
    vertices: u32,
    vertex_count: u32,
    // Three words a virtual support point.
    heights: u32,
    flags: u32,
    // One vertex of each connected component, three words each.
    components: u32,
    component_count: u32,
    // Face table: a word per direction, then the groups' bits. 0 directions: there is no table.
    directions: u32,
    direction_steps: u32,
    groups: u32,
    group_words: u32,
    // Corners and edges with what lies around them, as `side.wgsl` reads them; only there if contact points are wanted.
    features: u32,
    // Nine words a triangle, like `triangles`, but corners that count as one are joined; often the same words.
    corners: u32,
    // Half size and centre of the box around all.
    box_center: vec3<f32>,
    padding_a: u32,
    box_half: vec3<f32>,
    padding_b: u32,
}

// A body in the order of grid buckets.
struct GridEntry {
    center: vec3<f32>,
    // How far it looks.
    radius: f32,
    body: u32,
    level: i32,
    flags: u32,
    padding: u32,
}

// A pair of bodies whose spheres overlap, and what Angles knows of it. Lengths are in the pair's unit unless they are
// called metres: a power of two per metre at which the sum of the radii lies between 1 and 2.
struct NearPair {
    a: u32,
    b: u32,
    // `FAR`, `NEAR` or `OVERLAPPING`.
    near: u32,
    unit: f32,
    // The columns of the rotation that turns b's axes into a's.
    x: vec3<f32>,
    // No point of a reaches above this along the axis.
    a_below: f32,
    y: vec3<f32>,
    // No point of b reaches below this along the axis.
    b_above: f32,
    z: vec3<f32>,
    // How wrong each placed coordinate can be.
    error: f32,
    // From a's centre to b's in a's axes.
    translation: vec3<f32>,
    // What of a is in view: all, the group less `VIEW_GROUP`, or what faces along or against the translation.
    view_a: u32,
    axis: vec3<f32>,
    view_b: u32,
}

const VIEW_ALL: u32 = 0u;
const VIEW_ALONG: u32 = 1u;
const VIEW_AGAINST: u32 = 2u;
const VIEW_GROUP: u32 = 3u;

// What TriangleTest found of a pair.
struct PairResult {
    // Relative to a's centre of mass, in world axes.
    point: vec3<f32>,
    // 0: they do not touch.
    touching: u32,
    // Unit vector from a to b.
    normal: vec3<f32>,
    padding_a: u32,
    a: u32,
    b: u32,
    padding: vec2<u32>,
}

// The same for the host, for pairs that touch; the point in the world.
struct Touching {
    point: vec3<f32>,
    a: u32,
    normal: vec3<f32>,
    b: u32,
    pair: u32,
    hits: u32,
    contained: u32,
    padding: u32,
}

// Two triangles that intersect: the pair, the number among the pair's, the triangles, their common segment in the
// world. Scalars, since vectors would be padded.
struct Hit {
    pair: u32,
    index: u32,
    a: u32,
    b: u32,
    start_x: f32,
    start_y: f32,
    start_z: f32,
    end_x: f32,
    end_y: f32,
    end_z: f32,
}

// A body that reaches into a half-space.
struct PlaneContact {
    // From the body's centre of mass to the point, in world axes.
    anchor: vec3<f32>,
    depth: f32,
    // The point in the world.
    point: vec3<f32>,
    body: u32,
    plane: u32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

// What pushes a body.
struct BodyContacts {
    // Its entries among those sorted by body.
    first_entry: u32,
    last_entry: u32,
    // Its run of plane contacts; some may turn out not to touch.
    first_plane: u32,
    planes: u32,
    // Contacts that close in, of both kinds.
    active_contacts: u32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

// Where a body is after the step. It stays here until the next one moves it.
struct Moved {
    position: vec3<f32>,
    // Not 0: frozen.
    asleep: u32,
    rotation: vec4<f32>,
    linear_velocity: vec3<f32>,
    padding_a: u32,
    angular_velocity: vec3<f32>,
    padding_b: u32,
}

// A change of velocity.
struct Impulse {
    linear: vec3<f32>,
    padding_a: f32,
    angular: vec3<f32>,
    padding_b: f32,
}

// Contact generation. Lengths of what follows are in the pair's unit unless they are called metres: a power of two per
// metre at which the sum of the radii lies between 1 and 2. Points are in the axes of the pair's first body, about the
// centre of mass of the smaller one.

// How many entries its lists hold, and how many bodies and half-spaces there are.
struct ContactLimits {
    near_triangles: u32,
    features: u32,
    segments: u32,
    staged_points: u32,
    pairs: u32,
    points: u32,
    bodies: u32,
    planes: u32,
}

// A pair of bodies whose contact points are wanted.
struct MarginPair {
    a: u32,
    b: u32,
    // Metres.
    margin: f32,
    // Not 0: both are still, and what was found last holds.
    inactive: u32,
}

// How the bodies of such a pair lie to each other, and where in the lists its share is.
struct PairSetup {
    a: u32,
    b: u32,
    // 0: there are no such bodies.
    valid: u32,
    unit: f32,
    // Of the first body.
    rotation: vec4<f32>,
    // The columns of the rotation that turns b's axes into a's.
    x: vec3<f32>,
    // The longest side of the smaller body's box.
    size: f32,
    y: vec3<f32>,
    margin: f32,
    z: vec3<f32>,
    // How wrong heights over planes can be.
    rounding: f32,
    // From the centre of mass to the origin, in each body's own axes.
    offset_a: vec3<f32>,
    // What overlaps by less touches.
    touch: f32,
    offset_b: vec3<f32>,
    mesh_a: u32,
    scale_a: vec3<f32>,
    mesh_b: u32,
    scale_b: vec3<f32>,
    patch_count: u32,
    // Where overlapping features can be, and along which way; zero for any.
    window_min: vec3<f32>,
    first_near: u32,
    window_max: vec3<f32>,
    near_count: u32,
    window_direction: vec3<f32>,
    first_segment: u32,
    segment_count: u32,
    first_feature: u32,
    feature_count: u32,
    // Features that overlap.
    first_deep: u32,
    deep_count: u32,
    // What stands for patches without one, or for a body inside the other.
    first_probe: u32,
    probe_count: u32,
    padding: u32,
}

// A point at which bodies push each other: a vertex over a face, an edge over an edge, or what stands for them.
struct Feature {
    point_a: vec3<f32>,
    // From the first point to the second along the normal; `DROPPED` if it does not count.
    separation: f32,
    point_b: vec3<f32>,
    // How far it is from the points that were chosen.
    distance: f32,
    // Unit vector from the first body to the second.
    normal: vec3<f32>,
    // The number of a vertex, with `OF_SECOND` if it is the second body's; or `NOTHING`.
    vertex: u32,
    // Triangles on which the points lie.
    a: u32,
    b: u32,
    padding: vec2<u32>,
}

// The segment in which two triangles cross, along the cross product of their normals; with the number of the edge that
// pierces a triangle at each end, and `OF_SECOND` if it is the second body's.
struct Segment {
    start: vec3<f32>,
    start_edge: u32,
    end: vec3<f32>,
    end_edge: u32,
    a: u32,
    b: u32,
    padding: vec2<u32>,
}

// The part of both surfaces inside a closed contour.
struct Patch {
    center: vec3<f32>,
    // It has a say so far from its centre.
    reach: f32,
    // Unit vector from the first body to the second.
    normal: vec3<f32>,
    area: f32,
    // From its centre to the contour's extremes in four directions.
    extreme_a: vec3<f32>,
    // Of the contour.
    length: f32,
    extreme_b: vec3<f32>,
    // Whether it keeps an overlapping feature.
    kept: u32,
    extreme_c: vec3<f32>,
    // Triangles of its first segment.
    a: u32,
    extreme_d: vec3<f32>,
    b: u32,
}

const DROPPED: f32 = 3.0e38;

// A point at which two bodies push each other, in world axes and metres.
struct ContactPoint {
    // From each body's centre of mass to the point on its surface.
    anchor_a: vec3<f32>,
    // From the first point to the second along the normal; negative where the bodies overlap.
    separation: f32,
    anchor_b: vec3<f32>,
    // Radius of curvature of each surface: 0 on a crease, `FLAT_RADIUS` where it is flat.
    curvature_radius_a: f32,
    // Unit vector from the first body to the second.
    normal: vec3<f32>,
    curvature_radius_b: f32,
    // By the numbers of the input meshes; `NOTHING` on half-spaces.
    face_a: u32,
    face_b: u32,
    // How fast the normal turns as the surfaces slide along each other, radians per metre.
    normal_rotation: f32,
    padding: u32,
}

// All points of a pair of bodies; half-spaces have the numbers after those of the bodies.
struct ContactPair {
    a: u32,
    b: u32,
    first_point: u32,
    point_count: u32,
}

// A point of two bodies that pushed each other in an interval of a step, or lay as near as bodies at rest.
struct Touch {
    // Halfway between both surfaces, in the world.
    point: vec3<f32>,
    a: u32,
    // Unit vector from a to b.
    normal: vec3<f32>,
    // Half-spaces have the numbers after those of the bodies.
    b: u32,
    separation: f32,
    // Along the normal, newton seconds.
    impulse: f32,
    // In which of the step's intervals.
    collision_substep: u32,
    // Which of the pair's points.
    index: u32,
}
