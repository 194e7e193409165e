//! Contact points of meshes that are apart: the least distance of their points is that of the meshes.

use crate::support::{Random, nearest_on_triangle, segments};
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::queries::{ContactWorker, MeshContact, Placed};
use glam::{DMat3, DQuat, DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

pub struct Shape {
    pub name: &'static str,
    pub mesh: TriMesh,
    pub baked: CollisionMesh,
}

fn shape(name: &'static str, mesh: TriMesh) -> Shape {
    let baked = CollisionMesh::new(&mesh);
    Shape { name, mesh, baked }
}

fn mesh(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> TriMesh {
    let vertices = vertices.iter().copied().map(Vec3::from).collect();
    TriMesh::new(vertices, triangles.to_vec()).unwrap()
}

/// Some of a cube's faces.
fn part_of_cube(triangles: usize) -> TriMesh {
    let cube = shapes::cube(1.0);
    TriMesh::new(cube.vertices().to_vec(), cube.triangles()[..triangles].to_vec()).unwrap()
}

/// A sheet of two triangles.
fn card() -> TriMesh {
    let corners = [[-0.5, 0.0, -0.5], [0.5, 0.0, -0.5], [0.5, 0.0, 0.5], [-0.5, 0.0, 0.5]];
    mesh(&corners, &[[0, 2, 1], [0, 3, 2]])
}

/// A tetrahedron with two edges that are perpendicular and level.
fn tetrahedron() -> TriMesh {
    let corners = [[-0.5, 0.3, 0.0], [0.5, 0.3, 0.0], [0.0, -0.3, -0.5], [0.0, -0.3, 0.5]];
    mesh(&corners, &[[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
}

/// Two cubes joined to an L by a third, closed and concave.
fn angle() -> TriMesh {
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.4], [0.4, 0.4], [0.4, 1.0], [0.0, 1.0]];
    let vertices: Vec<[f32; 3]> = [-0.3, 0.3]
        .iter()
        .flat_map(|z| outline.map(|[x, y]| [x - 0.4, y - 0.4, *z]))
        .collect();
    let caps = [[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]];
    let mut triangles: Vec<[u32; 3]> = caps.iter().map(|&[a, b, c]| [a, c, b]).collect();
    triangles.extend(caps.iter().map(|t| t.map(|v| v + 6)));
    for i in 0..6 {
        let j = (i + 1) % 6;
        triangles.extend([[i, j, j + 6], [i, j + 6, i + 6]]);
    }
    mesh(&vertices, &triangles)
}

/// A bent sheet.
fn bent() -> TriMesh {
    let vertices: Vec<[f32; 3]> = (0..9)
        .map(|i| {
            let (x, z) = ((i % 3) as f32 - 1.0, (i / 3) as f32 - 1.0);
            [0.5 * x, 0.3 * x * x - 0.2 * z * z, 0.5 * z]
        })
        .collect();
    let cell = |i: u32| {
        let a = i % 2 + i / 2 * 3;
        [[a, a + 3, a + 4], [a, a + 4, a + 1]]
    };
    mesh(&vertices, &(0..4).flat_map(cell).collect::<Vec<_>>())
}

pub fn all_shapes() -> Vec<Shape> {
    vec![
        shape("cube", shapes::cube(1.0)),
        shape("tetrahedron", tetrahedron()),
        shape("angle", angle()),
        shape("icosahedron", shapes::ball(0.5, 0)),
        shape("card", card()),
        shape("box without a lid", part_of_cube(10)),
        shape("three sides of a cube", part_of_cube(6)),
        shape("bent sheet", bent()),
        shape(
            "triangle",
            mesh(&[[0.5, 0.0, 0.0], [0.0, 0.1, 0.6], [-0.4, 0.0, 0.0]], &[[0, 1, 2]]),
        ),
    ]
}

#[derive(Clone, Copy, Debug)]
pub struct At {
    pub translation: DVec3,
    pub rotation: DQuat,
}

fn placed(mesh: &CollisionMesh, at: At) -> Placed<'_> {
    Placed::new(mesh, at.translation, at.rotation, Vec3::ONE).unwrap()
}

fn triangles(mesh: &TriMesh, at: At) -> Vec<[DVec3; 3]> {
    let axes = DMat3::from_quat(at.rotation.normalize());
    let place = |p: Vec3| axes * p.as_dvec3() + at.translation;
    (0..mesh.triangles().len())
        .map(|t| mesh.corners(t).map(place))
        .collect()
}

/// The least distance of two meshes that do not intersect.
fn distance(some: &[[DVec3; 3]], others: &[[DVec3; 3]]) -> f64 {
    let mut least = f64::INFINITY;
    for s in some {
        let sphere = |t: &[DVec3; 3]| {
            let middle = (t[0] + t[1] + t[2]) / 3.0;
            (middle, t.iter().map(|p| p.distance(middle)).fold(0.0, f64::max))
        };
        let (middle, radius) = sphere(s);
        for t in others {
            let (other, other_radius) = sphere(t);
            if middle.distance(other) - radius - other_radius > least {
                continue;
            }
            for k in 0..3 {
                least = least.min(s[k].distance(nearest_on_triangle(s[k], t)));
                least = least.min(t[k].distance(nearest_on_triangle(t[k], s)));
                for l in 0..3 {
                    least = least.min(segments([s[k], s[(k + 1) % 3]], [t[l], t[(l + 1) % 3]]));
                }
            }
        }
    }
    least
}

/// The way between the points of a contact.
fn way(contact: &MeshContact, at: [At; 2]) -> DVec3 {
    (at[1].translation + contact.anchors[1]) - (at[0].translation + contact.anchors[0])
}

fn contacts(shapes: [&Shape; 2], at: [At; 2], margin: f64) -> Vec<MeshContact> {
    let mut points = Vec::new();
    let [a, b] = [0, 1].map(|i| placed(&shapes[i].baked, at[i]));
    ContactWorker::new().points(&a, &b, margin as f32, &mut points);
    points
}

/// A random rotation, often one that makes faces and edges parallel, or all but parallel.
fn rotation(random: &mut Random) -> DQuat {
    let eighths = |random: &mut Random, part: f64| part * f64::from(random.0.u8(0..8));
    let some = [0.0, 1.0e-9, 1.0e-6, 1.0e-4, 1.0e-3][random.0.usize(0..5)];
    match random.0.u8(0..4) {
        0 => DQuat::from_rotation_y(eighths(random, FRAC_PI_2)) * DQuat::from_rotation_x(eighths(random, FRAC_PI_2)),
        1 => {
            DQuat::from_scaled_axis(random.vector() * some)
                * DQuat::from_rotation_y(eighths(random, FRAC_PI_2))
                * DQuat::from_rotation_x(eighths(random, FRAC_PI_4))
        }
        _ => random.rotation(),
    }
}

/// Two meshes that are near each other.
pub struct Near<'a> {
    pub shapes: [&'a Shape; 2],
    pub at: [At; 2],
    /// Their distance.
    pub least: f64,
    pub margin: f64,
}

/// A random pair, perhaps. Poses are rounded as wanted.
pub fn near<'a>(shapes: &'a [Shape], random: &mut Random, rounded: impl Fn(At) -> At) -> Option<Near<'a>> {
    let pair = [0, 1].map(|_| &shapes[random.0.usize(0..shapes.len())]);
    let mut at = [0, 1].map(|_| {
        rounded(At {
            translation: DVec3::ZERO,
            rotation: rotation(random),
        })
    });
    let aim = match random.0.u8(0..3) {
        0 => DVec3::AXES[random.0.usize(0..3)],
        1 => (DVec3::AXES[random.0.usize(0..3)] + DVec3::AXES[random.0.usize(0..3)]).normalize(),
        _ => random.direction(),
    };
    let aside = random.vector() * [0.0, 0.3, 1.0][random.0.usize(0..3)];
    at[1].translation = aim * 4.0 + aside;
    let first = triangles(&pair[0].mesh, at[0]);
    let gap = [1.0e-5, 1.0e-4, 1.0e-3, 0.01, 0.1][random.0.usize(0..5)];
    // The second body comes nearer, never nearer than the gap.
    for _ in 0..8 {
        let second = triangles(&pair[1].mesh, at[1]);
        let least = distance(&first, &second);
        if least < 1.001 * gap {
            break;
        }
        at[1].translation -= aim * (least - gap);
    }
    at[1] = rounded(at[1]);
    let second = triangles(&pair[1].mesh, at[1]);
    let least = distance(&first, &second);
    let margin = least * (1.01 + random.0.f64());
    (at[1].translation.dot(aim) >= -2.0).then_some(Near {
        shapes: pair,
        at,
        least,
        margin,
    })
}

fn random_pairs(rounds: usize, seed: u64) {
    let shapes = all_shapes();
    let mut random = Random::new(seed);
    let mut tested = 0;
    for round in 0..rounds {
        let Some(Near {
            shapes: pair,
            at,
            least,
            margin,
        }) = near(&shapes, &mut random, |at| at)
        else {
            continue;
        };
        let names = pair.map(|shape| shape.name);
        tested += 1;
        let found = contacts(pair, at, margin);
        let nearest = found.iter().map(|contact| way(contact, at).length());
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        let error = (nearest - least) / (1.0e-7 + 1.0e-5 * least);
        assert!(
            error.abs() < 1.0,
            "round {round}, {names:?}: {nearest} for {least}, margin {margin}, {at:?}"
        );
        for contact in &found {
            let way = way(contact, at);
            let along = way.dot(contact.normal.as_dvec3());
            let apart = f64::from(contact.separation);
            assert!(
                (along - apart).abs() < 1.0e-5 && apart > 0.99 * least - 1.0e-5,
                "round {round}, {names:?}: {contact:?}, {least}"
            );
        }
    }
    assert!(10 * tested > 5 * rounds, "{tested}");
}

#[test]
fn the_nearest_points_of_meshes_are_among_their_contact_points() {
    random_pairs(10_000, 31);
}

#[test]
#[ignore = "a minute"]
fn the_nearest_points_of_many_meshes_are_among_their_contact_points() {
    random_pairs(100_000, 32);
}
