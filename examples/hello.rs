//! Two tori collide.
//!
//! * `cargo run --release --example hello --features window` shows them in a window;
//! * `cargo run --release --example hello -- --headless` needs neither window nor GPU, and prints what happens.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that. The rest of the program is in
//! this file.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;

fn main() -> AppExit {
    common::app("hello", 64 * 6)
        .insert_resource(Gravity(Vec3::ZERO))
        .add_systems(Startup, spawn)
        // Runs after every step, not in every frame, because a slow frame has several steps.
        .add_systems(FixedLast, report)
        .run()
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    // A recipe names a mesh and the settings of its bake. Bodies start to move once their mesh is loaded.
    let torus: Handle<CollisionMesh> = assets.load("torus.bake.ron");
    for (name, side) in [("left", -1.0), ("right", 1.0)] {
        commands.spawn((
            Name::new(name),
            RigidBody::Dynamic,
            MeshCollider(torus.clone()),
            Transform::from_xyz(1.2 * side, 0.1 * side, 0.0).with_rotation(Quat::from_rotation_x(0.8 * side)),
            LinearVelocity(Vec3::X * -side),
            AngularVelocity(Vec3::new(0.4, 0.7 * side, 0.2)),
            Restitution::new(1.0),
        ));
    }
    common::spawn_box(&mut commands, 1.5);
}

/// Prints collisions of bodies. Walls have no name, so collisions with walls are not printed.
fn report(
    mut started: MessageReader<CollisionStart>,
    mut ended: MessageReader<CollisionEnd>,
    collisions: Res<Collisions>,
    names: Query<&Name>,
    time: Res<Time<Fixed>>,
) {
    let seconds = time.elapsed_secs();
    for &CollisionStart {
        collider1, collider2, ..
    } in started.read()
    {
        let Ok([one, other]) = names.get_many([collider1, collider2]) else {
            continue;
        };
        let points = collisions.get(collider1, collider2).map_or(0, |hit| hit.points.len());
        println!("{seconds:.2} s: {one} and {other} touch, at {points} points");
    }
    for &CollisionEnd {
        collider1, collider2, ..
    } in ended.read()
    {
        if let Ok([one, other]) = names.get_many([collider1, collider2]) {
            println!("{seconds:.2} s: {one} and {other} separate");
        }
    }
}
