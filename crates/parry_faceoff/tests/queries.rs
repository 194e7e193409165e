//! Queries about two shapes, without an engine.

use bevy_faceoff::geometry::shapes;
use bevy_faceoff::queries::{ContactWorker, MeshContact, PairMemory, Placed};
use bevy_faceoff::testing::scenes::Shape as Kind;
use glam::{DQuat, DVec3, Quat, Vec3};
use parry_faceoff::parry::math::{Pose, Rotation, Vector};
use parry_faceoff::parry::query::{
    ClosestPoints, ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, PersistentQueryDispatcher,
    QueryDispatcher, ShapeCastOptions,
};
use parry_faceoff::parry::shape::{
    Ball, Capsule, Compound, Cuboid, HalfSpace, HeightField, Shape, SharedShape, TriMesh,
};
use parry_faceoff::parry::utils::Array2;
use parry_faceoff::{ExactDispatcher, ExactMesh, bevy_faceoff};

/// Data of a point: what a solver keeps.
type Impulse = f32;
/// Data of a manifold: what a hook keeps.
type Note = u32;
type Manifolds = Vec<ContactManifold<Note, Impulse>>;

const MARGIN: f32 = 0.02;

fn vector(v: Vec3) -> Vector {
    Vector::from_array(v.to_array())
}

fn pose(translation: Vec3, rotation: Quat) -> Pose {
    Pose::from_parts(vector(translation), Rotation::from_array(rotation.to_array()))
}

fn exact(kind: Kind) -> ExactMesh {
    ExactMesh::from_baked(kind.mesh().clone()).expect("a valid mesh")
}

/// Poses of a second knot of diameter 1: near the first, far from it, and in it.
fn poses() -> impl Iterator<Item = (Vec3, Quat)> {
    (0..40).map(|i| {
        let i = i as f32;
        let way = Vec3::new((1.3 * i).sin(), (2.1 * i).cos(), (0.7 * i).sin());
        (
            way * (0.02 * i),
            Quat::from_euler(glam::EulerRot::XYZ, i, 2.0 * i, 0.3 * i),
        )
    })
}

fn manifolds(pos12: &Pose, a: &dyn Shape, b: &dyn Shape) -> Manifolds {
    let mut found = Vec::new();
    ExactDispatcher
        .contact_manifolds(pos12, a, b, MARGIN, &mut found, &mut None)
        .expect("a pair that it knows");
    found
}

/// Position on both shapes, normal on the first, and distance of every point, sorted.
fn sorted(manifolds: &Manifolds) -> Vec<[f32; 10]> {
    let mut points: Vec<[f32; 10]> = manifolds
        .iter()
        .flat_map(|m| {
            m.points.iter().map(|p| {
                let ([a, b, c], [d, e, f], [g, h, i]) =
                    (p.local_p1.to_array(), p.local_p2.to_array(), m.local_n1.to_array());
                [a, b, c, d, e, f, g, h, i, p.dist]
            })
        })
        .collect();
    points.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    points
}

#[test]
fn points_are_those_of_the_core() {
    let knot = exact(Kind::Knot);
    let mut found = 0;
    for (translation, rotation) in poses() {
        let turn = rotation.as_dquat();
        let core: [Placed; 2] = [(DVec3::ZERO, DQuat::IDENTITY), (translation.as_dvec3(), turn)]
            .map(|(at, turn)| Placed::new(knot.mesh(), at, turn, Vec3::ONE).expect("a valid pose"));
        let mut points: Vec<MeshContact> = Vec::new();
        ContactWorker::new().manifold(&core[0], &core[1], MARGIN, &mut PairMemory::default(), &mut points);
        let back = turn.inverse();
        let mut wanted: Vec<[f32; 10]> = points
            .iter()
            .map(|p| {
                let [a, b, c] = p.anchors[0].as_vec3().to_array();
                let [d, e, f] = (back * p.anchors[1]).as_vec3().to_array();
                let [g, h, i] = p.normal.to_array();
                [a, b, c, d, e, f, g, h, i, p.separation]
            })
            .collect();
        wanted.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        let ours = sorted(&manifolds(&pose(translation, rotation), &knot, &knot));
        assert_eq!(ours.len(), wanted.len());
        for (ours, wanted) in ours.iter().zip(&wanted) {
            let differs = ours.iter().zip(wanted).any(|(a, b)| (a - b).abs() > 2e-6);
            assert!(!differs, "{ours:?} instead of {wanted:?}");
        }
        found += ours.len();
    }
    assert!(found > 200, "{found}");
}

#[test]
fn a_manifold_has_one_normal_and_local_geometry() {
    let knot = exact(Kind::Knot);
    for (translation, rotation) in poses() {
        let pos12 = pose(translation, rotation);
        for manifold in manifolds(&pos12, &knot, &knot) {
            assert!((1..=4).contains(&manifold.points.len()));
            let opposite = pos12.rotation * manifold.local_n2;
            assert!((manifold.local_n1 + opposite).length() < 1e-5);
            assert!((manifold.local_n1.length() - 1.0).abs() < 1e-5);
            for point in &manifold.points {
                let apart = (pos12 * point.local_p2 - point.local_p1).dot(manifold.local_n1);
                // Round surfaces meet along other normals than their facets do.
                assert!((apart - point.dist).abs() < 1e-3, "{apart} instead of {}", point.dist);
                assert!(!point.fid1.is_unknown() && !point.fid2.is_unknown());
            }
        }
    }
}

#[test]
fn swapped_shapes_have_the_same_points() {
    let knot = exact(Kind::Knot);
    let (mut all, mut alike) = (0, 0);
    // Without the first, in which they coincide.
    for (translation, rotation) in poses().skip(1) {
        let pos12 = pose(translation, rotation);
        let one = manifolds(&pos12, &knot, &knot);
        let other = manifolds(&pos12.inverse(), &knot, &knot);
        let deepest = |found: &Manifolds| {
            found
                .iter()
                .flat_map(|m| &m.points)
                .map(|p| p.dist)
                .fold(f32::INFINITY, f32::min)
        };
        assert_eq!(one.is_empty(), other.is_empty());
        if one.is_empty() {
            continue;
        }
        assert!(
            (deepest(&one) - deepest(&other)).abs() < 1e-5,
            "{} {}",
            deepest(&one),
            deepest(&other)
        );
        // Among equally good points the reduction may choose others. Most are the same.
        let points = |found: &Manifolds| -> Vec<(Vector, Vector)> {
            found
                .iter()
                .flat_map(|m| m.points.iter().map(|p| (p.local_p1, p.local_p2)))
                .collect()
        };
        let others = points(&other);
        let same = points(&one)
            .into_iter()
            .filter(|(p, q)| others.iter().any(|(r, s)| p.distance(*s).max(q.distance(*r)) < 1e-4))
            .count();
        (all, alike) = (all + others.len(), alike + same);
    }
    assert!(all > 200 && 10 * alike > 8 * all, "{alike} of {all}");
}

#[test]
fn a_scaled_mesh_is_the_mesh_of_scaled_vertices() {
    let knot = exact(Kind::Knot);
    for scale in [Vec3::splat(2.0), Vec3::new(0.5, 1.5, 1.0), Vec3::new(-1.0, 0.7, 0.9)] {
        let scaled = knot.scaled(vector(scale)).expect("a valid scale");
        let surface = scaled.surface();
        let made = ExactMesh::new(surface.vertices().to_vec(), surface.indices().to_vec()).expect("a valid mesh");
        let [mass, wanted] = [&scaled, &made].map(|mesh| mesh.mass_properties(2.0));
        assert!((mass.mass() / wanted.mass() - 1.0).abs() < 1e-4);
        assert!(mass.local_com.distance(wanted.local_com) < 1e-5);
        let stock = surface.mass_properties(2.0);
        assert!(
            (mass.mass() / stock.mass() - 1.0).abs() < 1e-3,
            "{} {}",
            mass.mass(),
            stock.mass()
        );
        let moments = |m: &parry_faceoff::parry::mass_properties::MassProperties| {
            let mut all = m.principal_inertia().to_array();
            all.sort_by(f32::total_cmp);
            Vec3::from_array(all)
        };
        assert!((moments(&mass) / moments(&stock) - 1.0).abs().max_element() < 5e-3);
        let mut found = 0;
        for (translation, rotation) in poses() {
            let pos12 = pose(translation * scale.abs(), rotation);
            let [ours, wanted] = [&scaled, &made].map(|mesh| manifolds(&pos12, mesh, mesh));
            let deepest = |found: &Manifolds| found.iter().flat_map(|m| &m.points).map(|p| p.dist).fold(1.0, f32::min);
            assert!(
                (deepest(&ours) - deepest(&wanted)).abs() < 1e-4,
                "{} {}",
                deepest(&ours),
                deepest(&wanted)
            );
            found += ours.len();
        }
        assert!(found > 20, "{found}");
    }
}

/// Shapes that parry knows, and how to shift each so that it touches a knot about the origin.
fn others() -> Vec<(&'static str, Box<dyn Shape>, Vec3)> {
    let heights = Array2::new(3, 3, vec![0.0, 0.1, 0.0, 0.05, 0.0, 0.1, 0.0, 0.1, 0.0]);
    let torus = shapes::torus_240();
    let vertices = torus.vertices().iter().map(|&v| vector(v)).collect();
    let parts = [Vec3::ZERO, Vec3::X * 0.8].map(|at| (pose(at, Quat::IDENTITY), SharedShape::ball(0.4)));
    vec![
        ("ball", Box::new(Ball::new(0.3)), Vec3::Y * 0.4),
        ("cuboid", Box::new(Cuboid::new(Vector::splat(0.5))), Vec3::Y * 0.8),
        ("capsule", Box::new(Capsule::new_y(0.3, 0.2)), Vec3::X * 0.5),
        (
            "half-space",
            Box::new(HalfSpace::new(vector(Vec3::Y).normalize())),
            Vec3::Y * -0.3,
        ),
        (
            "height field",
            Box::new(HeightField::new(heights, Vector::splat(3.0))),
            Vec3::Y * -0.3,
        ),
        ("voxels", voxels(), Vec3::Y * 0.25),
        ("compound", Box::new(Compound::new(parts.to_vec())), Vec3::Y * 0.5),
        (
            "mesh",
            Box::new(TriMesh::new(vertices, torus.triangles().to_vec()).expect("a valid mesh")),
            Vec3::X * 0.5,
        ),
        (
            "cylinder",
            Box::new(parry_faceoff::parry::shape::Cylinder::new(0.3, 0.3)),
            Vec3::Y * 0.5,
        ),
        ("convex hull", convex_hull(), Vec3::Y * 0.5),
    ]
}

fn voxels() -> Box<dyn Shape> {
    SharedShape::voxels_from_points(Vector::splat(0.2), &[Vector::splat(0.0), Vector::splat(0.25)]).clone_dyn()
}

fn convex_hull() -> Box<dyn Shape> {
    let points: Vec<Vector> = shapes::ball_320().vertices().iter().map(|&v| vector(v)).collect();
    SharedShape::convex_hull(&points).expect("a hull").clone_dyn()
}

#[test]
fn a_mixed_pair_is_parrys() {
    let knot = exact(Kind::Knot);
    let surface = knot.surface();
    for (name, other, at) in others() {
        let mut touched = false;
        let is_grid = ["height field", "voxels"].contains(&name);
        let [mut ours, mut stock] = [Manifolds::new(), Manifolds::new()];
        let [mut our_workspace, mut stock_workspace]: [Option<ContactManifoldsWorkspace>; 2] = [None, None];
        for swapped in [false, true] {
            for step in 0..4 {
                let near = pose(
                    at * (1.0 - 0.02 * step as f32),
                    Quat::from_rotation_y(0.1 * step as f32),
                );
                let pos12 = if swapped { near.inverse() } else { near };
                let (ours_12, stock_12): ([&dyn Shape; 2], [&dyn Shape; 2]) = match swapped {
                    false => ([&knot, &*other], [surface, &*other]),
                    true => ([&*other, &knot], [&*other, surface]),
                };
                let [a, b] = ours_12;
                let [c, d] = stock_12;
                ExactDispatcher
                    .contact_manifolds(&pos12, a, b, MARGIN, &mut ours, &mut our_workspace)
                    .expect("a pair that parry knows");
                DefaultQueryDispatcher
                    .contact_manifolds(&pos12, c, d, MARGIN, &mut stock, &mut stock_workspace)
                    .expect("a pair that parry knows");
                // parry's mesh passes through a grid.
                if !is_grid {
                    assert_eq!(sorted(&ours), sorted(&stock), "{name}");
                }
                touched |= ours.iter().any(|m| !m.points.is_empty());

                let [e, s] = [
                    ExactDispatcher.contact(&pos12, a, b, MARGIN),
                    DefaultQueryDispatcher.contact(&pos12, c, d, MARGIN),
                ];
                assert_eq!(format!("{e:?}"), format!("{s:?}"), "{name}");
                let [e, s] = [
                    ExactDispatcher.intersection_test(&pos12, a, b),
                    DefaultQueryDispatcher.intersection_test(&pos12, c, d),
                ];
                assert_eq!(format!("{e:?}"), format!("{s:?}"), "{name}");
                let [e, s] = [
                    ExactDispatcher.distance(&pos12, a, b),
                    DefaultQueryDispatcher.distance(&pos12, c, d),
                ];
                assert_eq!(format!("{e:?}"), format!("{s:?}"), "{name}");
                let [e, s] = [
                    ExactDispatcher.closest_points(&pos12, a, b, 1.0),
                    DefaultQueryDispatcher.closest_points(&pos12, c, d, 1.0),
                ];
                assert_eq!(format!("{e:?}"), format!("{s:?}"), "{name}");
                let options = ShapeCastOptions::default();
                let velocity = vector(Vec3::Y);
                let [e, s] = [
                    ExactDispatcher.cast_shapes(&pos12, velocity, a, b, options),
                    DefaultQueryDispatcher.cast_shapes(&pos12, velocity, c, d, options),
                ];
                assert_eq!(format!("{e:?}"), format!("{s:?}"), "{name}");
            }
            ours.clear();
            stock.clear();
            (our_workspace, stock_workspace) = (None, None);
        }
        assert!(touched, "{name} touched nothing");
    }
}

#[test]
fn without_the_dispatcher_it_is_parrys_mesh() {
    let knot = exact(Kind::Knot);
    for (name, other, at) in others() {
        let mut found = Manifolds::new();
        let pos12 = pose(at, Quat::IDENTITY);
        let answer = DefaultQueryDispatcher.contact_manifolds(&pos12, &knot, &*other, MARGIN, &mut found, &mut None);
        assert!(answer.is_ok() && found.iter().any(|m| !m.points.is_empty()), "{name}");
    }
    let mut found = Manifolds::new();
    let pos12 = pose(Vec3::X * 0.4, Quat::from_rotation_y(0.5));
    let answer = DefaultQueryDispatcher.contact_manifolds(&pos12, &knot, &knot, MARGIN, &mut found, &mut None);
    assert!(answer.is_ok() && found.iter().any(|m| !m.points.is_empty()));
}

#[test]
fn what_lies_inside_a_solid_touches_it() {
    let [outer, inner] = [4.0, 0.2].map(|edge| {
        let scale = vector(Vec3::splat(edge));
        exact(Kind::Cube).scaled(scale).expect("a valid scale")
    });
    let pos12 = pose(Vec3::new(0.3, 0.2, 0.1), Quat::from_rotation_x(0.4));
    let touches =
        |pos12: &Pose| format!("{:?}", ExactDispatcher.intersection_test(pos12, &outer, &inner)).contains("true");
    assert!(touches(&pos12));
    let surfaces = DefaultQueryDispatcher.intersection_test(&pos12, outer.surface(), inner.surface());
    assert!(
        format!("{surfaces:?}").contains("false"),
        "parry compares surfaces: {surfaces:?}"
    );
    let contact = ExactDispatcher
        .contact(&pos12, &outer, &inner, 0.0)
        .expect("a known pair");
    assert!(contact.expect("a contact").dist < -1.0);
    assert!(!manifolds(&pos12, &outer, &inner).is_empty());
    let points = ExactDispatcher
        .closest_points(&pos12, &outer, &inner, 1.0)
        .expect("a known pair");
    assert_eq!(points, ClosestPoints::Intersecting);
    assert!(!touches(&pose(Vec3::X * 2.2, Quat::IDENTITY)));
    assert!(touches(&pose(Vec3::X * 2.05, Quat::IDENTITY)));
}

#[test]
fn the_deepest_point_of_exact_meshes_is_the_contact() {
    let knot = exact(Kind::Knot);
    let mut seen = 0;
    for (translation, rotation) in poses() {
        let pos12 = pose(translation, rotation);
        let contact = ExactDispatcher
            .contact(&pos12, &knot, &knot, MARGIN)
            .expect("a known pair");
        let found = manifolds(&pos12, &knot, &knot);
        assert_eq!(
            contact.map(|c| (c.point1, c.point2, c.dist)),
            found.first().map(|m| {
                let point = m.points[0];
                (point.local_p1, point.local_p2, point.dist)
            })
        );
        if let Some(contact) = contact {
            let apart = (pos12 * contact.point2 - contact.point1).dot(contact.normal1);
            assert!((apart - contact.dist).abs() < 1e-5);
            seen += 1;
        }
    }
    assert!(seen > 20);
}

#[test]
fn data_follow_their_points() {
    let knot = exact(Kind::Knot);
    let (mut found, mut workspace) = (Manifolds::new(), None);
    let mut step = |angle: f32, found: &mut Manifolds| {
        let pos12 = pose(Vec3::new(0.4, 0.02, 0.0), Quat::from_rotation_y(0.5 + angle));
        ExactDispatcher
            .contact_manifolds(&pos12, &knot, &knot, MARGIN, found, &mut workspace)
            .expect("a known pair");
    };
    step(0.0, &mut found);
    let count = found.iter().map(|m| m.points.len()).sum::<usize>();
    assert!(count > 3);
    for (i, manifold) in found.iter_mut().enumerate() {
        manifold.data = 1 + i as u32;
        for (k, point) in manifold.points.iter_mut().enumerate() {
            assert_eq!(point.data, 0.0, "a new point has no data");
            point.data = (1 + 10 * i + k) as f32;
        }
    }
    let before = found.clone();
    let data_of = |found: &Manifolds, (a, b)| {
        let points = found.iter().flat_map(|m| &m.points);
        points.clone().find(|p| (p.fid1, p.fid2) == (a, b)).map(|p| p.data)
    };
    step(0.001, &mut found);
    let mut same = 0;
    let mut data = Vec::new();
    for point in found.iter().flat_map(|m| &m.points) {
        if let Some(wanted) = data_of(&before, (point.fid1, point.fid2)) {
            assert_eq!(point.data, wanted);
            same += 1;
        }
        data.push(point.data);
    }
    assert!(2 * same > count, "{same} of {count}");
    // No datum is taken twice.
    data.retain(|&d| d != 0.0);
    data.sort_by(f32::total_cmp);
    let taken = data.len();
    data.dedup();
    assert_eq!(data.len(), taken);
    assert!(found.iter().any(|m| m.data != 0), "a manifold keeps its data");
}

#[test]
fn memory_changes_no_result() {
    let knot = exact(Kind::Knot);
    let (mut found, mut workspace) = (Manifolds::new(), None);
    for step in 0..200 {
        let angle = 0.002 * step as f32;
        let pos12 = pose(
            Vec3::new(0.42 - 0.1 * angle, 0.02, 0.0),
            Quat::from_rotation_y(0.5 + angle),
        );
        ExactDispatcher
            .contact_manifolds(&pos12, &knot, &knot, MARGIN, &mut found, &mut workspace)
            .expect("a known pair");
        assert_eq!(sorted(&found), sorted(&manifolds(&pos12, &knot, &knot)));
        // A copy of a world goes on as the world does.
        if step % 50 == 20 {
            workspace = workspace.clone();
        }
    }
}

#[test]
fn a_workspace_of_other_shapes_is_replaced() {
    let (knot, cuboid) = (exact(Kind::Knot), Cuboid::new(Vector::splat(0.5)));
    let pos12 = pose(Vec3::X * 0.6, Quat::IDENTITY);
    let (mut found, mut workspace) = (Manifolds::new(), None);
    for other in [&knot as &dyn Shape, &cuboid, &knot, &cuboid] {
        ExactDispatcher
            .contact_manifolds(&pos12, &knot, other, MARGIN, &mut found, &mut workspace)
            .expect("a known pair");
        assert_eq!(sorted(&found), sorted(&manifolds(&pos12, &knot, other)));
        assert!(found.iter().any(|m| !m.points.is_empty()));
    }
}

#[test]
fn what_is_invalid_is_refused_or_finds_nothing() {
    let knot = exact(Kind::Knot);
    for translation in [Vec3::splat(f32::NAN), Vec3::X * 1e30, Vec3::X * f32::INFINITY] {
        let pos12 = pose(translation, Quat::IDENTITY);
        // Manifolds of the last step do not stay.
        let mut found = manifolds(&pose(Vec3::X * 0.4, Quat::IDENTITY), &knot, &knot);
        assert!(!found.is_empty());
        let answer = ExactDispatcher.contact_manifolds(&pos12, &knot, &knot, MARGIN, &mut found, &mut None);
        assert!(answer.is_ok() && found.is_empty());
        assert!(
            ExactDispatcher
                .contact(&pos12, &knot, &knot, 0.1)
                .expect("a known pair")
                .is_none()
        );
    }
    let pos12 = pose(Vec3::X, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
    assert!(manifolds(&pos12, &knot, &knot).is_empty());
    for scale in [
        Vec3::ZERO,
        Vec3::new(1.0, 0.0, 1.0),
        Vec3::splat(f32::NAN),
        Vec3::splat(1e12),
    ] {
        let error = knot.scaled(vector(scale)).map(|_| ()).expect_err("an invalid scale");
        assert!(error.to_string().starts_with("the mesh cannot be scaled: "), "{error}");
        assert!(knot.scale_dyn(vector(scale), 0).is_none());
    }
    let corner = |x| Vector::new(x, 0.0, 0.0);
    for (vertices, indices) in [
        (vec![], vec![]),
        (vec![corner(0.0), corner(1.0)], vec![[0, 1, 2]]),
        (vec![corner(0.0), corner(1.0), corner(2.0)], vec![[0, 1, 2]]),
        (vec![corner(f32::NAN), corner(1.0), Vector::Y], vec![[0, 1, 2]]),
    ] {
        let error = ExactMesh::new(vertices, indices).map(|_| ()).expect_err("no mesh");
        assert!(error.to_string().starts_with("the triangles make no mesh: "), "{error}");
    }
}

#[test]
fn the_bounding_box_is_tight_and_holds_all_vertices() {
    let knot = exact(Kind::Knot)
        .scaled(Vector::new(1.0, 2.0, 0.5))
        .expect("a valid scale");
    let mut gain = 0.0;
    for (translation, rotation) in poses() {
        let place = pose(translation, rotation);
        let (ours, stock) = (knot.compute_aabb(&place), knot.surface().compute_aabb(&place));
        for &vertex in knot.surface().vertices() {
            let at = place * vertex;
            assert!(
                ours.mins.cmple(at).all() && ours.maxs.cmpge(at).all(),
                "{at} outside {ours:?}"
            );
        }
        gain += stock.volume() / ours.volume() - 1.0;
    }
    assert!(gain > 0.0);
}
