//! Which colliders are exact: [`ExactCollider`], [`ExactTrimesh`].

mod collider;
mod trimesh;
mod waiting;

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_faceoff::asset::CollisionMesh;

/// A collider whose contacts with others of its kind are exact: concave meshes, without ghost edges.
///
/// Where the entity has no [`Collider`], it gets one of the same triangles as soon as the mesh is there. Until then its
/// [`RigidBody`], which may be that of an ancestor, is disabled, so that it does not fall through what is not there
/// yet. A body waits for the meshes of all its colliders. A [`Collider`] of your own, or the removal of this component,
/// ends the wait, too.
///
/// A [`Collider`] of your own is kept, whether it comes before or later. It must enclose the mesh, because Avian looks
/// for contacts only where the boxes of colliders meet.
///
/// ```
/// # use avian3d::prelude::*;
/// # use avian_faceoff::prelude::*;
/// # use bevy::prelude::*;
/// fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
///     // A mesh file, or one that was baked before: OBJ, STL, glTF, .faceoff.
///     let knot = assets.load("knot.faceoff");
///     commands.spawn((RigidBody::Dynamic, ExactCollider(knot), Transform::from_xyz(0.0, 3.0, 0.0)));
/// }
/// ```
///
/// A negative scale does not mirror it, as it does not mirror Avian's colliders.
#[derive(Component, Reflect, Clone, Default, Debug, PartialEq, Eq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct ExactCollider(pub Handle<CollisionMesh>);

/// Makes the triangle mesh of the entity's [`Collider`] exact: its triangles are baked, and it gets an
/// [`ExactCollider`].
///
/// The collider may come later, from a [`ColliderConstructor`], and may change. The bake takes about as long as the
/// collider itself: a millisecond for a thousand triangles. Colliders that share their shape share the bake.
///
/// ```
/// # use avian3d::prelude::*;
/// # use avian_faceoff::prelude::*;
/// # use bevy::prelude::*;
/// # fn spawn(mut commands: Commands, vertices: Vec<avian3d::math::Vector>, triangles: Vec<[u32; 3]>) {
/// commands.spawn((RigidBody::Dynamic, Collider::trimesh(vertices, triangles), ExactTrimesh));
/// # }
/// ```
///
/// An observer makes all triangle meshes exact, those of a scene from a [`ColliderConstructorHierarchy`] among them:
///
/// ```
/// # use avian3d::prelude::*;
/// # use avian_faceoff::prelude::*;
/// # use bevy::prelude::*;
/// fn make_exact(added: On<Add, Collider>, colliders: Query<&Collider>, mut commands: Commands) {
///     if colliders.get(added.entity).is_ok_and(|collider| collider.shape().as_trimesh().is_some()) {
///         commands.entity(added.entity).insert(ExactTrimesh);
///     }
/// }
/// # fn add(app: &mut App) {
/// app.add_observer(make_exact);
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Default, Debug, PartialEq, Eq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct ExactTrimesh;

pub(crate) fn plugin(app: &mut App) {
    app.init_resource::<collider::Shapes>()
        .init_resource::<trimesh::Bakes>()
        .register_type::<ExactCollider>()
        .register_type::<ExactTrimesh>()
        .add_observer(collider::on_insert)
        .add_plugins(waiting::plugin)
        .add_systems(
            PreUpdate,
            (collider::follow_assets, collider::tell_failures, trimesh::forget),
        )
        .add_systems(PhysicsSchedule, trimesh::bake.in_set(PhysicsStepSystems::First));
}
