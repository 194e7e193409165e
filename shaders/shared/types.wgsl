#define_import_path faceoff::types

// The structs that kernels share with the host. `src/gpu/layout.rs` declares the same structs; a test compares every
// offset. Constants are declared there and added to this module.

// Parameters of a step.
struct Step {
    gravity: vec3<f32>,
    dt: f32,
    bodies: u32,
    planes: u32,
    // Number of hash buckets of the grid, a power of two, minus one.
    bucket_mask: u32,
    // 0: bodies do not react to contacts.
    response: u32,
    // Lengths of the lists whose number of elements is not known in advance.
    pair_capacity: u32,
    hit_capacity: u32,
    plane_contact_capacity: u32,
    touch_capacity: u32,
    // Contact margin as a fraction of the smaller body's diameter; 0 if no contact points are needed.
    contact_margin: f32,
    // Factor on the travel of bodies in their margins; 0 if they do not move.
    travel_scale: f32,
    // Not 0: the half-spaces differ from those of the last step.
    planes_changed: u32,
    compounds: u32,
    // The common velocity of the bodies, m/s.
    drift: vec3<f32>,
    // Not 0: continuous collision needs every pair that may meet until the next detection.
    has_fast_bodies: u32,
    // Most hits before a list is too short: `hit_capacity`, or no limit where they are only counted.
    hit_limit: u32,
    // Not 0: bodies and half-spaces have the numbers that they had in the last step.
    same_numbers: u32,
    // The length of a further list.
    piece_capacity: u32,
    // Not 0: the step has passed through all collision substeps that it needs. Further recorded ones do nothing.
    is_over: u32,
    // Substeps of the contact solver in the whole step; 0 if it does not move the bodies.
    substeps: u32,
    // The gap that contacts keep, as a fraction of the smaller body's diameter.
    rest_offset: f32,
    padding_a: u32,
    padding_b: u32,
}

// Input and state of a body. Unused slots have a radius of zero.
struct Body {
    // Position of the mesh's origin.
    position: vec3<f32>,
    mesh: u32,
    // Unit quaternion.
    rotation: vec4<f32>,
    scale: vec3<f32>,
    // Radius of the bounding sphere about the centre of mass, rounded up. The kernel that places the body adds the
    // rounding error of its position.
    radius: f32,
    linear_velocity: vec3<f32>,
    inverse_mass: f32,
    angular_velocity: vec3<f32>,
    restitution: f32,
    // In the body's own axes: xx, yy, zz and xy, xz, yz.
    inverse_inertia: vec3<f32>,
    gravity_scale: f32,
    inverse_inertia_off_diagonal: vec3<f32>,
    // Two bits for the kind, one for sensors, two for culling, one each for colliders of compounds and for continuous
    // collision; see the constants.
    flags: u32,
    // Collision layers.
    memberships: u32,
    filters: u32,
    // Its number in the last step, and what carries over from it; see the constants.
    source: u32,
    carried: u32,
    // Radius of the sphere in which the broad phase searches for other bodies; it follows from velocity, radius and
    // margin.
    speculative_radius: f32,
    // Thickness of the thinnest part, metres.
    thickness: f32,
    // Not 0: its pairs with other inactive bodies keep the contact points of the last detection, where its number was
    // `source`. The constants tell why.
    inactive: u32,
    // Number of its body, which is the number of the body's first collider.
    body: u32,
    // How long it moves until the next detection, seconds; 0 if it has completed its step.
    travel_time: f32,
    // Distance of its centre of mass from its body's, metres: 0 unless the body has several colliders.
    center_offset: f32,
    // Upper bounds of how the external force and torque accelerate its surface, m/s².
    force_acceleration: f32,
    torque_acceleration: f32,
    // By gravity and the external force, m/s².
    acceleration: vec3<f32>,
    // Radius of the rounding, metres; 0 for most meshes. Without it the surface is that of the mesh; with it the mesh
    // is the core.
    rounding: f32,
}

// The collider is static or asleep, and nothing about it has changed since the last step.
const RESTS: u32 = 1u;
// The collider has completed its step, or it is static and the first collision substep is over.
const COMPLETED: u32 = 2u;

// A moving body whose colliders are placed in it. Its row in `moved` follows those of the colliders.
struct Compound {
    // Position of its origin.
    position: vec3<f32>,
    // Number of the compound, which is the number of its first collider.
    collider: u32,
    // Unit quaternion.
    rotation: vec4<f32>,
    // Centre of mass in its own axes, from its origin.
    center: vec3<f32>,
    // Distance of its farthest point from the centre of mass.
    radius: f32,
    // Velocity of the centre of mass.
    linear_velocity: vec3<f32>,
    // The range of its colliders among the parts.
    first_part: u32,
    angular_velocity: vec3<f32>,
    part_count: u32,
    // Its row in `moved` in the last step, and what carries over from it; see the constants.
    source: u32,
    carried: u32,
    // The number that it had in the last step.
    last_collider: u32,
    padding: u32,
}

// A collider of a compound, in the compound's axes.
struct CompoundPart {
    // From the compound's centre of mass to the origin of the mesh.
    translation: vec3<f32>,
    // Number of the collider.
    collider: u32,
    // Rotation from the axes of the mesh to the compound's.
    rotation: vec4<f32>,
    // From the compound's centre of mass to the collider's.
    offset: vec3<f32>,
    padding: u32,
}

// A half-space, solid where `dot(normal, p) < distance`.
struct Plane {
    normal: vec3<f32>,
    distance: f32,
    restitution: f32,
    // Collision layers.
    memberships: u32,
    filters: u32,
    // Not 0: it detects what is inside, and does not push it out.
    sensor: u32,
}

// Where the data of a mesh lies in the array of words. Coordinates are relative to the centre of mass.
struct Mesh {
    // Centre of mass in the coordinates of the mesh.
    center: vec3<f32>,
    radius: f32,
    // Nine words per triangle.
    triangles: u32,
    triangle_count: u32,
    // Six words per box, centre and half size. Level 0 has a box per eight triangles, each further level one per eight
    // boxes.
    boxes: u32,
    levels: u32,
    // Three words per vertex, each position once.
    vertices: u32,
    vertex_count: u32,
    // Three words per virtual support point.
    heights: u32,
    flags: u32,
    // One vertex of each connected component, three words each.
    components: u32,
    component_count: u32,
    // Face table: a word per direction, then the bit sets of the groups. Without a table there are 0 directions.
    directions: u32,
    direction_steps: u32,
    groups: u32,
    group_words: u32,
    // Topology as `side.wgsl` reads it; only if contact points are needed.
    features: u32,
    // Nine words per triangle, like `triangles`, but with welded corners; often the same words.
    corners: u32,
    // Bounding box: centre and half size.
    box_center: vec3<f32>,
    // Nine words per cap of a nearly closed mesh.
    caps: u32,
    box_half: vec3<f32>,
    cap_count: u32,
    // Equal meshes have the same two numbers, and no others have.
    fingerprint_low: u32,
    fingerprint_high: u32,
    padding_a: u32,
    padding_b: u32,
}

// The sphere that a collider sweeps over in a step, with the part of its margin that does not depend on a direction.
struct Sweep {
    center: vec3<f32>,
    radius: f32,
    // How far the centre moves.
    travel: vec3<f32>,
    // As in `Body`.
    flags: u32,
    // Upper bound of the speed of the body's surface relative to its centre of mass within the step, m/s; 0 if it needs
    // no collision substeps. `group_bodies.wgsl` writes it.
    spin: f32,
    padding_a: u32,
    padding_b: u32,
    padding_c: u32,
}

// For the first body of a group: its solid bodies, and what is static and in their way. Velocities and coordinates are
// integers in the order of the floats (`ascending`), 0 for none.
struct Meeting {
    // The largest velocity along each axis.
    highest: array<atomic<u32>, 3>,
    // Not 0: the group has two bodies, or one and something static.
    exists: atomic<u32>,
    // The largest negated velocity along each axis.
    highest_negated: array<atomic<u32>, 3>,
    // The largest speed of a surface relative to its body's centre of mass, as bits.
    spin: atomic<u32>,
    // Largest coordinates of the box that its bodies sweep over.
    high: array<atomic<u32>, 3>,
    // Thickness of the thinnest body, as bits.
    thinnest: atomic<u32>,
    // Largest negated coordinates of that box.
    high_negated: array<atomic<u32>, 3>,
    // The number of collision substeps that it needs.
    substeps: atomic<u32>,
}

// How a step is divided into collision substeps.
struct Division {
    // How far two surfaces may move relative to each other in one, in units of the thickness of the thinnest body.
    travel: f32,
    // The largest number.
    most: u32,
    // The number of collision substeps for which there are commands.
    recorded: u32,
    padding: u32,
}

// A body in the sorted grid.
struct GridEntry {
    center: vec3<f32>,
    // Speculative radius of the collider.
    radius: f32,
    body: u32,
    level: i32,
    flags: u32,
    padding: u32,
}

// A pair of bodies whose spheres overlap, with the results of Angles. Lengths are in the pair's unit, unless they are
// said to be in metres: a power of two per metre, such that the sum of the radii is between 1 and 2.
struct NearPair {
    a: u32,
    b: u32,
    // `FAR`, `NEAR` or `OVERLAPPING`.
    near: u32,
    // Speculative margin, metres.
    margin: f32,
    // Columns of the rotation from b's axes to a's.
    x: vec3<f32>,
    // Upper bound of a along the axis.
    a_below: f32,
    y: vec3<f32>,
    // Lower bound of b along the axis.
    b_above: f32,
    z: vec3<f32>,
    // Error bound of each placed coordinate.
    error: f32,
    // From a's centre of mass to b's, in a's axes.
    translation: vec3<f32>,
    // The visible triangles of a: all, a group plus `VIEW_GROUP`, or triangles that face along or against the
    // translation.
    view_a: u32,
    axis: vec3<f32>,
    view_b: u32,
}

const VIEW_ALL: u32 = 0u;
const VIEW_ALONG: u32 = 1u;
const VIEW_AGAINST: u32 = 2u;
const VIEW_GROUP: u32 = 3u;

// The result of TriangleTest for a pair.
struct PairResult {
    // Relative to a's centre of mass, in world axes.
    point: vec3<f32>,
    // 0: the bodies do not touch.
    touching: u32,
    // Unit vector from a to b.
    normal: vec3<f32>,
    padding: u32,
    a: u32,
    b: u32,
    // The range of a pair of large meshes among the pieces. It is empty if the pair is not split, and starts at
    // `NOTHING` if the pieces do not fit.
    first_piece: u32,
    pieces: u32,
}

// A piece of a pair of large meshes: the parts below two nodes, and what TriangleTest finds there. Sums over the
// contour are relative to `origin`, in the pair's unit.
struct Piece {
    // Midpoints of segments weighted by their length.
    middle: vec3<f32>,
    length: f32,
    area: vec3<f32>,
    pair: u32,
    // Offset from each start to its end.
    closing: vec3<f32>,
    // Number of intersecting triangles, and the number of the first within the pair.
    hits: u32,
    origin: vec3<f32>,
    first_hit: u32,
    node_a: u32,
    node_b: u32,
    padding_a: u32,
    padding_b: u32,
}

// The result for the host, for pairs that touch. The point is in the world.
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

// Two intersecting triangles: the pair, the number within the pair, the triangles, and the segment in which they
// intersect, in the world. The segment is stored as scalars, because vectors would be padded.
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

// A body that penetrates a half-space.
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

// The contacts of a collider.
struct BodyContacts {
    // The range of its entries among the sorted entries.
    first_entry: u32,
    last_entry: u32,
    // The range of its plane contacts. Some may not touch.
    first_plane: u32,
    planes: u32,
    // Number of contacts of both kinds that apply an impulse to its body.
    active_contacts: u32,
    // From the centre of mass of the body to the collider's, in world axes. Zero unless the collider belongs to a
    // compound.
    offset_x: f32,
    offset_y: f32,
    offset_z: f32,
}

// Motion of a body after a step. It persists until the next step.
struct Moved {
    position: vec3<f32>,
    // Not 0: it sleeps.
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

// Contact generation. Lengths are in the pair's unit, unless they are said to be in metres: a power of two per metre,
// such that the sum of the radii is between 1 and 2. Points are in the axes of the pair's first body, relative to the
// centre of mass of the smaller one.

// Lengths of its lists, and numbers of bodies and half-spaces.
struct ContactLimits {
    near_triangles: u32,
    features: u32,
    segments: u32,
    staged_points: u32,
    pairs: u32,
    points: u32,
    bodies: u32,
    planes: u32,
    padding: vec3<u32>,
    pieces: u32,
}

// A pair of bodies whose contact points are requested.
struct MarginPair {
    a: u32,
    b: u32,
    // Speculative margin, metres.
    margin: f32,
    padding: u32,
}

// The relative pose of a margin pair, and its ranges in the lists.
struct PairSetup {
    a: u32,
    b: u32,
    // 0: the pair does not exist.
    valid: u32,
    unit: f32,
    // Rotation of the first body.
    rotation: vec4<f32>,
    // Columns of the rotation from b's axes to a's.
    x: vec3<f32>,
    // Longest side of the smaller body's box.
    size: f32,
    y: vec3<f32>,
    // Largest distance of features: the speculative margin and both roundings.
    margin: f32,
    z: vec3<f32>,
    // Error bound of heights over planes.
    rounding: f32,
    // From each body's centre of mass to the reference point of the coordinates, in the body's own axes.
    offset_a: vec3<f32>,
    // A smaller overlap counts as touching.
    touch: f32,
    offset_b: vec3<f32>,
    mesh_a: u32,
    scale_a: vec3<f32>,
    mesh_b: u32,
    scale_b: vec3<f32>,
    patch_count: u32,
    // The window of overlapping features: a box, empty if no patch may have any; and their direction, or zero for any.
    window_min: vec3<f32>,
    first_near: u32,
    window_max: vec3<f32>,
    near_count: u32,
    window_direction: vec3<f32>,
    first_segment: u32,
    segment_count: u32,
    first_feature: u32,
    feature_count: u32,
    // Overlapping features.
    first_deep: u32,
    deep_count: u32,
    // Points from rays, or from containment.
    first_probe: u32,
    probe_count: u32,
    // Not 0: the pair is split, and `first_near` and `near_count` are its range among the pieces.
    is_split: u32,
    // With which b rotates relative to a, in a's axes.
    spin: vec3<f32>,
    // Features between nearest points.
    first_nearest: u32,
    nearest_count: u32,
    // Not 0: features do not count, because the bodies fly past each other there.
    has_dropped: u32,
    // The point of first contact of such bodies.
    first_meeting: u32,
    meeting_count: u32,
    // Radii of the roundings. Before the reduction all distances are those of the cores.
    rounded_a: f32,
    rounded_b: f32,
    padding_a: u32,
    padding_b: u32,
}

// A piece of a pair of large meshes: the parts below two nodes, and what is found there.
struct NearPiece {
    pair: u32,
    node_a: u32,
    node_b: u32,
    // Range of the piece among the pairs of triangles.
    first_near: u32,
    near_count: u32,
    // Numbers of features and segments; then the places of the first.
    first_feature: u32,
    first_segment: u32,
    padding: u32,
}

// A contact feature: vertex-face, edge-edge, between nearest points, or a point that stands for a deep overlap.
struct Feature {
    point_a: vec3<f32>,
    // Signed distance from the first point to the second along the normal; `DROPPED` if the feature does not count.
    separation: f32,
    point_b: vec3<f32>,
    // Distance to the selected points.
    distance: f32,
    // Unit vector from the first body to the second.
    normal: vec3<f32>,
    // Number of the vertex over a face, with the bit `OF_SECOND` if it belongs to the second body; `NOTHING` for other
    // features.
    vertex: u32,
    // Triangles on which the points lie.
    a: u32,
    b: u32,
    // What it was derived from; see the constants.
    origin: u32,
    padding: u32,
}

// Lower bits of `Feature::origin`.
const ORIGIN_MASK: u32 = 7u;
// A patch, containment, or first contact. Overlapping features have other things in this word.
const OF_PATCH: u32 = 0u;
// A vertex over a face.
const OF_VERTEX: u32 = 1u;
// Two edges.
const OF_EDGES: u32 = 2u;
// A vertex near an edge.
const OF_VERTEX_EDGE: u32 = 3u;
// Two vertices.
const OF_VERTICES: u32 = 4u;
// The vertex belongs to the second body.
const VERTEX_OF_SECOND: u32 = 8u;
// Where the positions of both edges in their triangles are.
const FIRST_EDGE_SHIFT: u32 = 4u;
const SECOND_EDGE_SHIFT: u32 = 6u;

// The segment in which two triangles cross, along the cross product of their normals. Each end has the number of the
// edge that pierces a triangle, with the bit `OF_SECOND` if it belongs to the second body.
struct Segment {
    start: vec3<f32>,
    start_edge: u32,
    end: vec3<f32>,
    end_edge: u32,
    a: u32,
    b: u32,
    padding: vec2<u32>,
}

// The part of both surfaces inside a closed contour, or at a rim of an open mesh where a contour ends. The patches of a
// pair start at the index of its first segment.
struct Patch {
    center: vec3<f32>,
    // Distance from the centre up to which features belong to the patch.
    reach: f32,
    // Unit vector from the first body to the second.
    normal: vec3<f32>,
    area: f32,
    // A node of the tree over the pair's patches: see `near_patches.wgsl`.
    node_center: vec3<f32>,
    node_radius: f32,
    // The segments that start at the extremes of the contour in four directions.
    extremes: vec4<u32>,
    // Length of the contour.
    length: f32,
    // Triangles of its first segment.
    a: u32,
    b: u32,
    // Not 0: the bodies overlap at the centre by more than features may. The patch gets its points from rays.
    too_deep: u32,
    // The middle of the part of a rim that is in the other body, its depth, and the way from there to one end.
    rim_middle: vec3<f32>,
    rim_depth: f32,
    rim_half: vec3<f32>,
    // Whose rim it is: 1 for the first body, 2 for the second; 0 for a closed contour.
    rim: u32,
}

const DROPPED: f32 = 3.0e38;

// A contact point, in world axes and metres.
struct ContactPoint {
    // From each body's centre of mass to the point on its surface.
    anchor_a: vec3<f32>,
    // Signed distance of the meshes along the normal; negative if the bodies overlap.
    separation: f32,
    anchor_b: vec3<f32>,
    // Radius of curvature of each surface: 0 on a crease, `FLAT_RADIUS` on a flat surface.
    curvature_radius_a: f32,
    // Unit vector from the first body to the second.
    normal: vec3<f32>,
    curvature_radius_b: f32,
    // Face numbers of the input meshes; `NOTHING` on half-spaces.
    face_a: u32,
    face_b: u32,
    // Rotation of the normal per distance that the surfaces slide along each other, radians per metre.
    normal_rotation: f32,
    // By how much the smooth surfaces are nearer to each other than the meshes. The solver keeps the smooth surfaces
    // apart.
    bulge: f32,
}

// The manifold of a pair. Half-spaces are numbered after the bodies.
struct ContactPair {
    a: u32,
    b: u32,
    first_point: u32,
    point_count: u32,
}

// A contact point of two bodies that touched in a collision substep: an impulse acted between them, or they were as
// near as bodies at rest.
struct Touch {
    // Midway between both surfaces, in the world.
    point: vec3<f32>,
    a: u32,
    // Unit vector from a to b.
    normal: vec3<f32>,
    // Half-spaces are numbered after the bodies.
    b: u32,
    separation: f32,
    // Along the normal, newton seconds.
    impulse: f32,
    // Number of the collision substep.
    collision_substep: u32,
    // Number of the point within the pair.
    index: u32,
}
