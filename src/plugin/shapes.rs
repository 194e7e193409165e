//! Colliders without a mesh asset: [`BallCollider`], [`CapsuleCollider`], [`CuboidCollider`], [`CylinderCollider`],
//! [`ConeCollider`].

use crate::asset::{CollisionMesh, ShapeError};
use crate::plugin::components::MeshCollider;
use crate::plugin::schedule::{FaceoffStep, FaceoffSystems};
use crate::plugin::sync::changes::any_changed;
use crate::plugin::sync::named;
use bevy::ecs::component::Mutable;
use bevy::ecs::lifecycle::HookContext;
use bevy::ecs::world::DeferredWorld;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// A ball about the origin of its entity: exactly round, whatever it rolls on.
///
/// Like a [`MeshCollider`] it is a body with a [`RigidBody`](crate::types::body::RigidBody), part of the body above it
/// on a child, and static without either. It sets the `MeshCollider` of its entity; colliders of one size share a mesh.
/// The `Transform` scales it: its radius by the smallest component of the scale.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_faceoff::prelude::*;
/// fn setup(mut commands: Commands) {
///     commands.spawn((RigidBody::Dynamic, BallCollider::new(0.5), Transform::from_xyz(0.0, 4.0, 0.0)));
///     commands.spawn((CuboidCollider::new(20.0, 1.0, 20.0), Transform::from_xyz(0.0, -0.5, 0.0)));
/// }
/// # let mut app = App::new();
/// # app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default())).add_systems(Startup, setup);
/// # app.update();
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
#[require(MeshCollider)]
#[component(on_insert = shape_inserted::<BallCollider>)]
#[serde(default, deny_unknown_fields)]
pub struct BallCollider {
    /// Metres. Default 0.5.
    pub radius: f32,
}

/// A capsule along the y axis about the origin of its entity: all that is within `radius` of a segment. Exactly round.
/// See [`BallCollider`].
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
#[require(MeshCollider)]
#[component(on_insert = shape_inserted::<CapsuleCollider>)]
#[serde(default, deny_unknown_fields)]
pub struct CapsuleCollider {
    /// Metres. Default 0.5.
    pub radius: f32,
    /// Length of the segment, without the half balls at its ends, metres. Default 1.
    pub length: f32,
}

/// A box about the origin of its entity. See [`BallCollider`].
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
#[require(MeshCollider)]
#[component(on_insert = shape_inserted::<CuboidCollider>)]
#[serde(default, deny_unknown_fields)]
pub struct CuboidCollider {
    /// Lengths of its edges, metres. Default 1.
    pub size: Vec3,
    /// Radius of its round edges and corners, metres. The box keeps its size. Default 0.
    pub rounding: f32,
}

/// A cylinder along the y axis about the origin of its entity: a prism of 64 sides that rolls as its smooth surface
/// would. See [`BallCollider`].
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
#[require(MeshCollider)]
#[component(on_insert = shape_inserted::<CylinderCollider>)]
#[serde(default, deny_unknown_fields)]
pub struct CylinderCollider {
    /// Metres. Default 0.5.
    pub radius: f32,
    /// Metres. Default 1.
    pub height: f32,
    /// Radius of its round rims, metres. The cylinder keeps its size. Default 0.
    pub rounding: f32,
}

/// A cone along the y axis with its tip up, a pyramid of 64 sides. Its centre of mass is at the origin of its entity,
/// its base a quarter of its height below. See [`BallCollider`].
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
#[require(MeshCollider)]
#[component(on_insert = shape_inserted::<ConeCollider>)]
#[serde(default, deny_unknown_fields)]
pub struct ConeCollider {
    /// Radius of the base, metres. Default 0.5.
    pub radius: f32,
    /// Metres. Default 1.
    pub height: f32,
    /// What is within this distance of the cone belongs to it, metres. Default 0.
    pub rounding: f32,
}

impl BallCollider {
    /// A ball of this radius, metres.
    pub fn new(radius: f32) -> Self {
        Self { radius }
    }
}

impl CapsuleCollider {
    /// A capsule of this radius around a segment of this length, metres.
    pub fn new(radius: f32, length: f32) -> Self {
        Self { radius, length }
    }
}

impl CuboidCollider {
    /// A box with edges of these lengths, metres.
    pub fn new(x: f32, y: f32, z: f32) -> Self {
        Self {
            size: Vec3::new(x, y, z),
            rounding: 0.0,
        }
    }

    /// This box with round edges.
    pub fn with_rounding(self, rounding: f32) -> Self {
        Self { rounding, ..self }
    }
}

impl CylinderCollider {
    /// A cylinder of this radius and height, metres.
    pub fn new(radius: f32, height: f32) -> Self {
        Self {
            radius,
            height,
            rounding: 0.0,
        }
    }

    /// This cylinder with round rims.
    pub fn with_rounding(self, rounding: f32) -> Self {
        Self { rounding, ..self }
    }
}

impl ConeCollider {
    /// A cone of this radius at its base and this height, metres.
    pub fn new(radius: f32, height: f32) -> Self {
        Self {
            radius,
            height,
            rounding: 0.0,
        }
    }

    /// This cone with a rounding.
    pub fn with_rounding(self, rounding: f32) -> Self {
        Self { rounding, ..self }
    }
}

impl Default for BallCollider {
    fn default() -> Self {
        Self::new(0.5)
    }
}

impl Default for CapsuleCollider {
    fn default() -> Self {
        Self::new(0.5, 1.0)
    }
}

impl Default for CuboidCollider {
    fn default() -> Self {
        Self::new(1.0, 1.0, 1.0)
    }
}

impl Default for CylinderCollider {
    fn default() -> Self {
        Self::new(0.5, 1.0)
    }
}

impl Default for ConeCollider {
    fn default() -> Self {
        Self::new(0.5, 1.0)
    }
}

/// A component that stands for a collision mesh.
trait ShapeCollider: Component<Mutability = Mutable> + Copy {
    const NAME: &'static str;

    /// Numbers that tell its meshes apart.
    fn lengths(&self) -> [f32; 4];

    fn mesh(&self) -> Result<CollisionMesh, ShapeError>;
}

impl ShapeCollider for BallCollider {
    const NAME: &'static str = "BallCollider";

    fn lengths(&self) -> [f32; 4] {
        [self.radius, 0.0, 0.0, 0.0]
    }

    fn mesh(&self) -> Result<CollisionMesh, ShapeError> {
        CollisionMesh::ball(self.radius)
    }
}

impl ShapeCollider for CapsuleCollider {
    const NAME: &'static str = "CapsuleCollider";

    fn lengths(&self) -> [f32; 4] {
        [self.radius, self.length, 0.0, 0.0]
    }

    fn mesh(&self) -> Result<CollisionMesh, ShapeError> {
        CollisionMesh::capsule(self.radius, self.length)
    }
}

impl ShapeCollider for CuboidCollider {
    const NAME: &'static str = "CuboidCollider";

    fn lengths(&self) -> [f32; 4] {
        self.size.extend(self.rounding).to_array()
    }

    fn mesh(&self) -> Result<CollisionMesh, ShapeError> {
        CollisionMesh::cuboid(self.size, self.rounding)
    }
}

impl ShapeCollider for CylinderCollider {
    const NAME: &'static str = "CylinderCollider";

    fn lengths(&self) -> [f32; 4] {
        [self.radius, self.height, self.rounding, 0.0]
    }

    fn mesh(&self) -> Result<CollisionMesh, ShapeError> {
        CollisionMesh::cylinder(self.radius, self.height, self.rounding)
    }
}

impl ShapeCollider for ConeCollider {
    const NAME: &'static str = "ConeCollider";

    fn lengths(&self) -> [f32; 4] {
        [self.radius, self.height, self.rounding, 0.0]
    }

    fn mesh(&self) -> Result<CollisionMesh, ShapeError> {
        CollisionMesh::cone(self.radius, self.height, self.rounding)
    }
}

/// The meshes of shapes by their kind and their lengths. They are dropped with the last collider that uses them.
#[derive(Resource, Default)]
struct ShapeMeshes(HashMap<ShapeKey, AssetId<CollisionMesh>>);

/// The kind of a shape and the bits of its lengths.
type ShapeKey = (&'static str, [u32; 4]);

impl ShapeMeshes {
    /// The mesh of a shape in `meshes`, made unless it is there.
    fn get<T: ShapeCollider>(
        &mut self,
        shape: &T,
        meshes: &mut Mut<Assets<CollisionMesh>>,
    ) -> Result<Handle<CollisionMesh>, ShapeError> {
        let key = (T::NAME, shape.lengths().map(f32::to_bits));
        let known = self.0.get(&key);
        let known = known.and_then(|id| meshes.bypass_change_detection().get_strong_handle(*id));
        if let Some(handle) = known {
            return Ok(handle);
        }
        let handle = meshes.add(shape.mesh()?);
        // A game that changes sizes all the time must not fill this table.
        if self.0.len() >= self.0.capacity() {
            self.0.retain(|_, id| meshes.contains(*id));
        }
        self.0.insert(key, handle.id());
        Ok(handle)
    }
}

/// Sets the meshes of shapes. New ones have theirs at once, changed ones before the next step.
pub(super) struct ShapePlugin;

impl Plugin for ShapePlugin {
    fn build(&self, app: &mut App) {
        let follow = (
            follow::<BallCollider>,
            follow::<CapsuleCollider>,
            follow::<CuboidCollider>,
            follow::<CylinderCollider>,
            follow::<ConeCollider>,
        );
        app.init_resource::<ShapeMeshes>()
            .register_type::<BallCollider>()
            .register_type::<CapsuleCollider>()
            .register_type::<CuboidCollider>()
            .register_type::<CylinderCollider>()
            .register_type::<ConeCollider>()
            .add_systems(
                FaceoffStep,
                follow.chain().before(FaceoffSystems::Collect).ambiguous_with_all(),
            );
    }
}

/// Sets the mesh of a new shape. An error is told by the first step.
fn shape_inserted<T: ShapeCollider>(mut world: DeferredWorld, context: HookContext) {
    let shape = world.get::<T>(context.entity).copied();
    let made = world.get_resource_mut::<ShapeMeshes>();
    // Without the resources the first step sets it.
    let (Some(shape), Some(mut made)) = (shape, made) else {
        return;
    };
    let mut known = std::mem::take(&mut *made);
    let meshes = world.get_resource_mut::<Assets<CollisionMesh>>();
    let handle = meshes.and_then(|mut meshes| known.get(&shape, &mut meshes).ok());
    *world.resource_mut::<ShapeMeshes>() = known;
    if let (Some(handle), Some(mut collider)) = (handle, world.get_mut::<MeshCollider>(context.entity)) {
        collider.0 = handle;
    }
}

/// Sets the meshes of shapes that have changed, or whose collider a scene has replaced.
fn follow<T: ShapeCollider>(
    mut shapes: ParamSet<(
        Query<(Entity, Ref<T>, Ref<MeshCollider>)>,
        Query<(Option<&Name>, Ref<T>, &mut MeshCollider)>,
    )>,
    mut changed: Local<Vec<Entity>>,
    made: Option<ResMut<ShapeMeshes>>,
    meshes: Option<ResMut<Assets<CollisionMesh>>>,
) {
    let (Some(mut made), Some(meshes)) = (made, meshes) else {
        return;
    };
    changed.clear();
    for (entities, shapes, colliders) in shapes.p0().contiguous_iter().into_iter().flatten() {
        let mut add = |i: usize| {
            changed.push(entities[i]);
            false
        };
        any_changed(shapes, &mut add);
        any_changed(colliders, &mut add);
    }
    let (mut shapes, mut meshes) = (shapes.p1(), Mut::from(meshes));
    for &entity in &*changed {
        let Ok((name, shape, mut collider)) = shapes.get_mut(entity) else {
            continue;
        };
        // If an entity has two shapes, the one that was set last counts.
        if !shape.is_changed() && collider.0 != Handle::default() {
            continue;
        }
        match made.get(&*shape, &mut meshes) {
            Ok(handle) => {
                if collider.0 != handle {
                    collider.0 = handle;
                }
            }
            Err(error) if shape.is_changed() => {
                error!("the {} of {} is no shape: {error}", T::NAME, named(entity, name));
                collider.0 = Handle::default();
            }
            Err(_) => {}
        }
    }
}
