//! What is baked, how often, and from which file.

use super::*;
use crate::asset_app::write;
use bevy_faceoff::asset::format;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::prefab::PrefabFault;

const COUNT: usize = 50;

/// A file of fifty different boxes in a row.
fn row() -> Vec<u8> {
    let mut gltf = Gltf::new();
    for i in 0..COUNT {
        let primitive = gltf.primitive(&shapes::cube(0.5 + 0.001 * i as f64), U16);
        let mesh = gltf.mesh(&format!("Box{i}"), vec![primitive]);
        gltf.root_node(json!({"name": format!("Node{i}"), "mesh": mesh, "translation": [i, 0, 0]}));
    }
    gltf.for_bevy().glb()
}

/// The collision meshes below an entity.
fn handles(sim: &mut Sim, root: Entity) -> Vec<Handle<CollisionMesh>> {
    let world = sim.app.world();
    let mut all = Vec::new();
    let mut open = vec![root];
    while let Some(entity) = open.pop() {
        all.extend(world.get::<MeshCollider>(entity).map(|collider| collider.0.clone()));
        open.extend(world.get::<Children>(entity).into_iter().flatten());
    }
    all
}

#[test]
fn fifty_meshes_are_baked_once() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "row.glb", row());
    let mut sim = sim(folder.path());
    made(&mut sim);
    let first = spawn(&mut sim, "row.glb", MeshColliderHierarchy::default());
    assert_eq!(ready(&mut sim, first).colliders.len(), COUNT);
    assert_eq!(made(&mut sim), COUNT);
    // The second one is complete in the frame in which Bevy spawns it.
    let second = spawn(
        &mut sim,
        "row.glb",
        (RigidBody::Dynamic, MeshColliderHierarchy::default()),
    );
    while sim.app.world().get::<Children>(second).is_none() {
        sim.step(1);
    }
    assert_eq!(handles(&mut sim, second), handles(&mut sim, first));
    assert_eq!(sim.app.world().resource::<Told>().0.len(), 2);
    sim.step(2);
    assert_eq!(sim.report().bodies, COUNT + 1);
    assert_eq!(made(&mut sim), 0, "the second one baked");

    // Bevy's meshes keep the bakes, whoever uses them. Other settings are another bake.
    let scene: Handle<WorldAsset> = sim.world().resource::<AssetServer>().load("row.glb#Scene0");
    for entity in [first, second] {
        sim.world().despawn(entity);
    }
    sim.step(3);
    let exact = BakeSettings {
        weld_tolerance: 0.0,
        ..default()
    };
    let settings = ColliderSettings {
        bake: Some(exact),
        ..default()
    };
    for (settings, bakes) in [(default(), 0), (settings.clone(), COUNT), (settings, 0), (default(), 0)] {
        let root = spawn(&mut sim, "row.glb", MeshColliderHierarchy::new(settings));
        ready(&mut sim, root);
        assert_eq!(made(&mut sim), bakes);
        sim.world().despawn(root);
        sim.step(3);
    }

    // When Bevy drops its meshes the bakes go too.
    drop(scene);
    sim.step(5);
    assert_eq!(sim.app.world().resource::<Assets<CollisionMesh>>().len(), 0);
}

#[test]
fn the_primitives_of_a_mesh_are_one_collider() {
    let folder = tempfile::tempdir().unwrap();
    // A cube of two materials, six triangles each.
    let cube = shapes::cube(1.0);
    let mut gltf = Gltf::new();
    let [wood, ice] = ["Wood", "Ice"].map(|name| gltf.material(name));
    let positions: Vec<[f32; 3]> = cube.vertices().iter().map(|v| v.to_array()).collect();
    let position = gltf.positions(&positions);
    let halves: Vec<Value> = cube
        .triangles()
        .chunks(6)
        .zip([wood, ice])
        .map(|(half, material)| {
            let indices = gltf.indices(half.as_flattened(), U16);
            json!({"attributes": {"POSITION": position}, "indices": indices, "material": material})
        })
        .collect();
    let mesh = gltf.mesh("Cube", halves);
    gltf.root_node(json!({"name": "Cube", "mesh": mesh}));
    let plain = gltf.clone();
    gltf.json["materials"][ice]["extras"] = json!({"faceoff_friction": 0.0});
    write(folder.path(), "plain.glb", plain.for_bevy().glb());
    write(folder.path(), "icy.glb", gltf.for_bevy().glb());
    let mut sim = sim(folder.path());

    let root = spawn(&mut sim, "plain.glb", MeshColliderHierarchy::default());
    let told = ready(&mut sim, root);
    assert_eq!(told.colliders.len(), 1);
    let whole = collision_mesh(&sim, told.colliders[0]);
    assert_eq!(whole.mesh.triangles().len(), 12);
    assert!(whole.mesh.is_closed() && (whole.mass.volume - 1.0).abs() < 1e-5);

    // Materials with settings of their own are colliders of their own.
    let root = spawn(&mut sim, "icy.glb", MeshColliderHierarchy::default());
    let told = ready(&mut sim, root);
    assert_eq!(told.colliders.len(), 2);
    let frictions: Vec<_> = told.colliders.iter().map(|&part| has::<Friction>(&sim, part)).collect();
    assert_eq!(frictions, [false, true]);
}

#[test]
fn baked_meshes_and_recipes_beside_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let cube = shapes::cube(1.0);
    let mut gltf = Gltf::new();
    for (i, name) in ["Baked", "Recipe.001", "Plain", "Broken"].into_iter().enumerate() {
        let primitive = gltf.primitive(&cube, U16);
        let mesh = gltf.mesh(name, vec![primitive]);
        gltf.root_node(json!({"name": format!("{name} node"), "mesh": mesh, "translation": [2 * i, 0, 0]}));
    }
    write(folder.path(), "levels/house.v2.glb", gltf.for_bevy().glb());
    let ball = CollisionMesh::new(&shapes::ball_320());
    let baked = format::to_bytes(&ball, format::Hash::default());
    write(folder.path(), "levels/house_v2_Baked.faceoff", baked);
    let recipe = "(mesh: \"house.v2.glb\", part: (mesh: \"Recipe.001\"), settings: (faces: true, degrees: 45))";
    write(folder.path(), "levels/house_v2_Recipe_001.bake.ron", recipe);
    write(folder.path(), "levels/house_v2_Broken.bake.ron", "(mesh: ");
    let mut sim = sim(folder.path());
    let root = spawn(&mut sim, "levels/house.v2.glb", MeshColliderHierarchy::default());
    let told = ready(&mut sim, root);
    let [baked, recipe, plain] = [0, 1, 2].map(|i| collision_mesh(&sim, told.colliders[i]));
    assert!(baked == ball);
    assert!(recipe.faces.is_some() && recipe.mesh.triangles().len() == 12);
    assert!(plain.faces.is_none() && plain.mesh.triangles().len() == 12);
    let [error] = &told.errors[..] else {
        panic!("{:?}", told.errors)
    };
    assert!(matches!(error.fault, PrefabFault::Mesh(_)));
    let text = error.to_string();
    for word in ["Broken node", "levels/house.v2.glb", "levels/house_v2_Broken.bake.ron"] {
        assert!(text.contains(word), "{text}");
    }

    // Once it is mended, its node gets a collider.
    let mended = "(mesh: \"house.v2.glb\", part: (mesh: \"Broken\"))";
    write(folder.path(), "levels/house_v2_Broken.bake.ron", mended);
    let server = sim.world().resource::<AssetServer>().clone();
    server.reload("levels/house_v2_Broken.bake.ron");
    let told = ready_again(&mut sim, root, 2);
    assert_eq!((told.colliders.len(), told.errors.len()), (1, 0));
    // A new error changes nothing for those that have a collider or get one.
    write(folder.path(), "levels/house_v2_Broken.bake.ron", "(mesh: ");
    server.reload("levels/house_v2_Broken.bake.ron");
    for _ in 0..50 {
        sim.step(1);
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let root = spawn(&mut sim, "levels/house.v2.glb", MeshColliderHierarchy::default());
    let told = ready(&mut sim, root);
    assert_eq!((told.colliders.len(), told.errors.len()), (4, 0));

    // With settings of its own each is baked from what Bevy has loaded.
    let settings = ColliderSettings {
        bake: Some(BakeSettings::default()),
        ..default()
    };
    let root = spawn(&mut sim, "levels/house.v2.glb", MeshColliderHierarchy::new(settings));
    let told = ready(&mut sim, root);
    assert_eq!((told.colliders.len(), told.errors.len()), (4, 0));
    assert!(
        told.colliders
            .iter()
            .all(|&part| collision_mesh(&sim, part).mesh.triangles().len() == 12)
    );
}

/// In file names both are the same.
#[test]
fn a_file_beside_is_that_of_one_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let scene = nodes(&[
        ("A.1", &shapes::cube(1.0), json!({})),
        ("A_1", &shapes::torus_240(), json!({})),
    ]);
    write(folder.path(), "scene.glb", scene.for_bevy().glb());
    let ball = CollisionMesh::new(&shapes::ball_320());
    let baked = format::to_bytes(&ball, format::Hash::default());
    write(folder.path(), "scene_A_1Mesh.faceoff", baked);
    let mut sim = sim(folder.path());
    let root = spawn(&mut sim, "scene.glb", MeshColliderHierarchy::default());
    let told = ready(&mut sim, root);
    assert_eq!((told.colliders.len(), told.errors.len()), (2, 0));
    let triangles = [0, 1].map(|i| collision_mesh(&sim, told.colliders[i]).mesh.triangles().len());
    assert_eq!(triangles, [320, 240]);
}

#[test]
fn what_cannot_collide_is_told_and_the_rest_collides() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = nodes(&[
        ("Solid", &shapes::cube(1.0), json!({})),
        ("Wire", &shapes::cube(1.0), json!({})),
    ]);
    scene.json["meshes"][1]["primitives"][0]["mode"] = json!(1);
    write(folder.path(), "scene.glb", scene.for_bevy().glb());
    let mut sim = sim(folder.path());
    let root = spawn(&mut sim, "scene.glb", MeshColliderHierarchy::default());
    let told = ready(&mut sim, root);
    assert_eq!(told.colliders, [entity(&mut sim, "SolidMesh")]);
    let errors = faults(&told.errors);
    assert_eq!((errors.len(), &*errors[0].0), (1, "Wire"));
    assert!(
        errors[0].1.contains("scene.glb") && errors[0].1.contains("LineList"),
        "{}",
        errors[0].1
    );

    // A scene that is not there is told too.
    let root = spawn(&mut sim, "nowhere.glb", MeshColliderHierarchy::default());
    let told = ready(&mut sim, root);
    assert!(matches!(told.errors[0].fault, PrefabFault::Scene(_)));
    assert!(told.errors[0].to_string().contains("nowhere.glb"));
}
