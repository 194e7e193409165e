//! `queries::check` against brute force on shapes of this crate, and on third-party meshes if they lie beside the checkout.

use crate::oracle::body::{Body, Mesh};
use crate::oracle::brute;
use crate::oracle::compare::{Tally, compare};
use crate::oracle::data;
use crate::oracle::parallel;
use crate::oracle::product::Product;
use crate::oracle::rng::Rng;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::testing::external::NUT_AND_BOLT;
use bevy_faceoff::testing::scenes::Shape;
use bevy_faceoff::testing::scenes::thread::PITCH;
use glam::{DVec3, Quat};
use std::sync::Arc;
use std::time::Instant;

const POSES: u64 = 100;

/// Compares the given pairs of bodies. At least `touching` of them must touch, else the test would prove nothing.
fn compare_pairs(name: &str, touching: usize, pairs: Vec<[Body; 2]>) -> Tally {
    let product = Product::default();
    let one = |case: usize| {
        let bodies = &pairs[case];
        let start = Instant::now();
        let worlds = bodies.each_ref().map(Body::world);
        let truth = brute::check(&worlds);
        let oracle_done = Instant::now();
        let answer = product.check(bodies);
        let seconds = [(oracle_done - start).as_secs_f64(), oracle_done.elapsed().as_secs_f64()];
        Tally {
            seconds,
            ..compare(&format!("{name} case {case}"), bodies, &worlds, &truth, &answer)
        }
    };
    let tally: Tally = parallel::map(pairs.len(), one).into_iter().sum();
    println!("{}\n{}", Tally::head(), tally.row(name));
    tally.require_no_failures();
    tally.require_none_missed();
    assert!(tally.touching >= touching, "only {} pairs touch", tally.touching);
    tally
}

/// `a` as it is, and `b` in random rotations such that a vertex of one is close to a vertex of the other.
fn random_poses(a: &Arc<Mesh>, b: &Arc<Mesh>) -> Vec<[Body; 2]> {
    let still = |mesh: &Arc<Mesh>| Body::new(mesh, DVec3::ZERO, Quat::IDENTITY, 1.0);
    let reach = 0.05 * still(a).world().radius.min(still(b).world().radius);
    (0..POSES)
        .map(|case| {
            let mut rng = Rng::new(0xDA7A, case);
            let turned = Body {
                rotation: rng.rotation(),
                ..still(b)
            };
            let [vertex_a, vertex_b] = [a, b].map(|mesh| rng.pick(&mesh.vertices).as_dvec3());
            let by = vertex_a + rng.in_ball(reach) - turned.place(vertex_b);
            [still(a), turned.moved(by)]
        })
        .collect()
}

/// A mesh of this crate.
fn built_in(name: &str, mesh: &TriMesh) -> Arc<Mesh> {
    Mesh::new(name, mesh.vertices().to_vec(), mesh.triangles().to_vec())
}

/// A mesh without its faces on one side of a plane, so that it is open.
fn opened(name: &str, mesh: &TriMesh) -> Arc<Mesh> {
    let below = |face: &&[u32; 3]| face.iter().any(|&v| mesh.vertices()[v as usize].y < 0.1);
    let faces: Vec<_> = mesh.triangles().iter().filter(below).copied().collect();
    assert!(faces.len() < mesh.triangles().len());
    Mesh::new(name, mesh.vertices().to_vec(), faces)
}

#[test]
fn shapes_of_this_crate_open_and_closed() {
    let meshes = [
        built_in("torus", &shapes::torus_240()),
        built_in("ring", &shapes::ring()),
        built_in("cube", &shapes::cube(1.0)),
        opened("open ball", &shapes::ball_320()),
        opened("open torus", &shapes::torus_240()),
    ];
    for (i, a) in meshes.iter().enumerate() {
        for b in &meshes[i..] {
            let name = format!("{} {}", a.name, b.name);
            compare_pairs(&name, 10, random_poses(a, b)).require_few_forgiven();
        }
    }
}

/// Threads of 9,680 and 2,640 triangles: where one leaves room for the other, and where not.
#[test]
fn a_nut_on_a_bolt_of_this_crate() {
    let [bolt, nut] =
        [("bolt", Shape::Bolt), ("nut", Shape::Nut)].map(|(name, shape)| built_in(name, &shape.mesh().mesh));
    let still = Body::new(&bolt, DVec3::ZERO, Quat::IDENTITY, 1.0);
    // Half of the pitch further crest is upon crest. Between that and where it fits the flanks meet. A slight turn keeps rows
    // of vertices from falling on each other, where rounding decides.
    let turn = Quat::from_rotation_y(0.03);
    let on_the_thread = [0.0, 0.23, 0.11, 0.47].map(|part| {
        let nut = Body::new(&nut, DVec3::NEG_Y * part * f64::from(PITCH), turn, 1.0);
        [still.clone(), nut]
    });
    compare_pairs("nut on bolt", 2, on_the_thread.into()).require_few_forgiven();
}

#[test]
fn a_robot_among_open_obstacles() {
    let (Some(scene), Some(robot)) = (data::mesh("fcl_env.obj"), data::mesh("fcl_rob.obj")) else {
        return;
    };
    compare_pairs("robot in open scene", 20, random_poses(&scene, &robot)).require_few_forgiven();
}

#[test]
fn a_bunny_and_a_bar_and_stairs() {
    let names = ["parry_low_poly_bunny.obj", "parry_bar.obj", "parry_stairs.obj"];
    let meshes: Vec<_> = names.iter().filter_map(|name| data::mesh(name)).collect();
    if meshes.len() < names.len() {
        return;
    }
    for (i, a) in meshes.iter().enumerate() {
        for b in &meshes[i..] {
            compare_pairs(&format!("{} {}", short(a), short(b)), 10, random_poses(a, b)).require_few_forgiven();
        }
    }
}

fn short(mesh: &Mesh) -> &str {
    mesh.name
        .trim_start_matches("parry_")
        .trim_start_matches("low_poly_")
        .trim_end_matches(".obj")
}

/// Millimetre threads of 15,080 and 25,668 triangles in metres.
#[test]
fn a_nut_on_a_bolt() {
    let [nut, bolt] = NUT_AND_BOLT.map(data::mesh);
    let (Some(nut), Some(bolt)) = (nut, bolt) else { return };
    let still = Body::new(&bolt, DVec3::ZERO, Quat::IDENTITY, 1.0);
    let nut_at = |height: f64| Body::new(&nut, DVec3::Z * height, Quat::from_rotation_z(0.4), 1.0);
    // At one of these positions the thread leaves room for the nut, which then neither touches nor contains anything.
    let on_the_thread = [0.0007, 0.0053, 0.0101].map(|height| [still.clone(), nut_at(height)]);
    compare_pairs("nut on bolt", 2, on_the_thread.into()).require_few_forgiven();
    // As modelled it rests on the bolt's head face to face, so rounding decides about those faces.
    compare_pairs("nut on the bolt's head", 1, vec![[still, nut_at(0.0)]]);
}
