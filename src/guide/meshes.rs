//! Meshes and their files: formats, loading and baking, open and closed meshes, winding, welding.
//!
//! # Files
//!
//! | file | how |
//! |---|---|
//! | `.bake.ron`, a recipe: `(mesh: "knot.obj", settings: (faces: true))` | `asset_server.load("knot.bake.ron")`; the usual way |
//! | `.faceoff`, a baked mesh: loads in milliseconds, half a million triangles in a third of a second | `asset_server.load("knot.faceoff")`; made by `faceoff bake` |
//! | `.glb`, `.gltf` (the whole scene), `.obj`, `.stl`, `.ply`, `.off` | `asset_server.load::<CollisionMesh>("knot.glb")`, baked on load; not with `AssetMode::Processed` |
//! | one node of a glTF file with those below it, in its own space | a recipe: `(mesh: "machine.glb", part: (node: "Arm"))` |
//! | one mesh or primitive of a glTF file | a recipe: `(mesh: "machine.glb", part: (mesh: "Gear", primitive: 0))`, or by index: `part: (mesh: 0, primitive: 0)`. A label such as `Duck.glb#Mesh0/Primitive0` has no loader |
//! | one object or group of an OBJ file | a recipe: `(mesh: "car.obj", part: (object: "Wheel"))` or `part: (group: "rim")` |
//! | a Bevy `Mesh`, also of a `Cuboid` or `Capsule3d`, with the feature `bevy_mesh` | `MeshColliderFrom(mesh_handle)` on a body or a child |
//! | all meshes of a Bevy scene, with the feature `bevy_gltf` | `MeshColliderHierarchy`: see [`scenes`](super::scenes#a-scene-from-blender) |
//!
//! In a program a mesh is made by [`CollisionMesh::new`], from a [`TriMesh`](crate::geometry::TriMesh).
//!
//! # Loading
//!
//! Reading a mesh takes milliseconds. A face table takes seconds; it is baked on separate threads, so steps and other
//! assets do not wait for it.
//!
//! Two properties of Bevy matter, and recipes avoid both:
//!
//! * A path that is loaded twice with different settings gives one mesh, with the settings of the first load.
//! * A `.meta` file that names our loader hides its file from all other loaders.
//!
//! A recipe names its mesh relative to itself, without a leading `/`. Other files that a mesh names, such as the
//! buffers of a `.gltf` file, are read from the folder of the mesh and those below. They are read from elsewhere only
//! if the recipe has `read_outside: true`.
//!
//! # Baking ahead of time
//!
//! With `AssetMode::Processed`, Bevy's asset processor bakes recipes ahead of time. They keep their names. Changed
//! files are baked while the app runs, which then uses the new mesh. In this mode only recipes and `.faceoff` files
//! load, not raw meshes. The example `bake_assets` shows it.
//!
//! The command `faceoff bake` writes `.faceoff` files: see `docs/COMMAND_LINE.md`, and for whole libraries of meshes
//! `docs/LIBRARY.md`.
//!
//! # Round shapes
//!
//! A mesh may be *rounded*: its surface is then all that is within a radius of the mesh, its *core*. Edges and corners
//! are round, and a sheet becomes thick. A point with a radius is a ball, and a segment a capsule. These are exactly
//! round: they roll without bumps, touch flat ground in one point, and cost little.
//!
//! | shape | on an entity | as a mesh |
//! |---|---|---|
//! | a ball | [`BallCollider`] | [`CollisionMesh::ball`] |
//! | a capsule | [`CapsuleCollider`] | [`CollisionMesh::capsule`] |
//! | a box, with round edges if you like | [`CuboidCollider`] | [`CollisionMesh::cuboid`] |
//! | a cylinder or a cone: a mesh of 64 sides | [`CylinderCollider`], [`ConeCollider`] | [`CollisionMesh::cylinder`], [`CollisionMesh::cone`] |
//! | any mesh with round edges, or a thick sheet | | [`BakeSettings::rounding`], or a recipe: `settings: (rounding: 0.02)` |
//!
//! The rounding adds to the mesh: to keep the size of a part, make its core smaller first. A scale multiplies it by the
//! smallest of the scale's components, so a ball stays a ball. Rays, casts and nearest points are those of the round
//! surface.
//!
//! [`BallCollider`]: crate::plugin::shapes::BallCollider
//! [`CapsuleCollider`]: crate::plugin::shapes::CapsuleCollider
//! [`CuboidCollider`]: crate::plugin::shapes::CuboidCollider
//! [`CylinderCollider`]: crate::plugin::shapes::CylinderCollider
//! [`ConeCollider`]: crate::plugin::shapes::ConeCollider
//! [`CollisionMesh::ball`]: crate::asset::CollisionMesh::ball
//! [`CollisionMesh::capsule`]: crate::asset::CollisionMesh::capsule
//! [`CollisionMesh::cuboid`]: crate::asset::CollisionMesh::cuboid
//! [`CollisionMesh::cylinder`]: crate::asset::CollisionMesh::cylinder
//! [`CollisionMesh::cone`]: crate::asset::CollisionMesh::cone
//! [`BakeSettings::rounding`]: crate::projection::BakeSettings::rounding
//!
//! # Closed, open, inverted
//!
//! Meshes may be open or self-intersecting. When a mesh is loaded, a warning names what is unusual about it;
//! `faceoff inspect` counts all defects and says where they are.
//!
//! | mesh | inside | mass | faces push |
//! |---|---|---|---|
//! | closed | solid: a body wholly inside touches it | of what it encloses; a shell inside another, wound oppositely, is a cavity | outward |
//! | closed but for cracks, T-junctions and openings of at most a fiftieth of its area each and a fifth together | as if closed | as if closed, and how uncertain that is | outward, but for loose sheets |
//! | open: a sheet, a terrain, a box without a lid | nothing is inside | see [below](#mass-of-an-open-mesh) | to the side on which the other body is |
//! | closed, its faces look inward: a **room** | free, and nothing is ever inside *it* | of a solid in place of its interior, so give a moving room a `Mass` | inward |
//!
//! With `Response::Impulse` an open mesh pushes to the side from which its faces run counter-clockwise.
//!
//! ## Mass of an open mesh
//!
//! The first of these that applies:
//!
//! 1. If closing its openings takes at most 40 % of its area: the mass of what it then encloses.
//! 2. The mass of the volume in which its generalised winding number exceeds 1/2, if there is such a volume.
//! 3. The mass of a shell along its faces. The thickness of the shell is
//!    [`shell_thickness`](crate::projection::BakeSettings::shell_thickness) times the size of the mesh.
//!
//! A `Mass`, `AngularInertia` or `CenterOfMass` of your own always counts, for closed meshes too.
//!
//! # Winding
//!
//! The winding of a file need not be consistent. A *shell* is a set of faces that are connected across edges. The bake
//! makes the winding of each shell consistent. Then it turns the outermost shells outward, each together with the
//! shells inside it. But if the outermost shells all look inward in the file, the mesh is a room;
//! [`inward: Solid`](crate::projection::BakeSettings::inward) turns it outward. Faces keep their numbers, and a
//! warning tells what was turned.
//!
//! Polygons are triangulated as fans, or by cutting off ears where a fan would fold over.
//!
//! # Welding
//!
//! Corners closer than a millionth of the mesh's size count as one, so the seam of a Bevy `Torus` leaves no hole. The
//! original triangles are tested. [`weld_tolerance: 1e-5`](crate::projection::BakeSettings::weld_tolerance) in a
//! recipe's settings, or in [`BakeSettings`](crate::projection::BakeSettings), welds more; 0 welds only corners at the
//! same place.
//!
//! Faces that are there twice, wound alike or not, count once for mass and containment if the mesh is closed without
//! them; a warning tells how many.
//!
//! # Work ahead of steps
//!
//! Everything that the stages derive from a mesh is computed when it is baked or loaded, on background threads. On the
//! CPU the first step with half a million triangles of terrain takes as long as the next one. A GPU has to receive the
//! mesh first.
//!
//! [`CollisionMesh::new`] runs on the calling thread. It takes about two milliseconds per thousand triangles, or a few
//! if the mesh has openings or long slivers.
//!
//! [`CollisionMesh::new`]: crate::asset::CollisionMesh::new
