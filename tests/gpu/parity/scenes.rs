//! Scenes of 500 bodies in every situation that the kernels treat differently.

use super::scene::{Scene, Shape};
use crate::oracle::rng::Rng;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, Plane, StepConfig};
use bevy_faceoff::types::body::{CollisionLayers, RigidBody};
use bevy_faceoff::types::settings::Culling;
use glam::{DVec3, Quat, Vec3};

/// Bodies in a scene.
pub const COUNT: usize = 500;

/// The meshes of all scenes, by slot.
pub struct Kit(pub Vec<Shape>);

/// Slots of the kit.
pub const TORUS: u32 = 0;
pub const KNOT: u32 = 1;
pub const RING: u32 = 2;
pub const CUBE: u32 = 3;
pub const BALL: u32 = 4;
/// Turned inside out.
pub const INWARD: u32 = 5;
/// Two components: a ball in a ball, the inner one looks inward.
pub const HOLLOW: u32 = 6;
/// Neither closed nor with a face table.
pub const OPEN: u32 = 7;

impl Kit {
    pub fn new() -> Self {
        let torus = shapes::torus_240();
        let ball = shapes::ball(0.5, 1);
        let inward = |mesh: &TriMesh, size: f32| {
            let faces = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
            TriMesh::new(mesh.vertices().iter().map(|v| v * size).collect(), faces).unwrap()
        };
        let inner = inward(&ball, 0.6);
        let first = ball.vertices().len() as u32;
        let moved = inner.triangles().iter().map(|t| t.map(|v| v + first));
        let hollow = TriMesh::new(
            ball.vertices().iter().chain(inner.vertices()).copied().collect(),
            ball.triangles().iter().copied().chain(moved).collect(),
        );
        let half = TriMesh::new(torus.vertices().to_vec(), torus.triangles()[..120].to_vec());
        // Coarse where images are dear: what is compared is the look-up.
        Self(vec![
            Shape::new("torus", &torus, Some((5, 32))),
            Shape::new("knot", &shapes::knot_1120(), Some((15, 64))),
            Shape::new("ring", &shapes::ring(), Some((15, 32))),
            Shape::new("cube", &shapes::cube(0.57), Some((1, 16))),
            Shape::new("ball", &ball, Some((10, 16))),
            Shape::new("inward torus", &inward(&torus, 1.0), Some((45, 32))),
            Shape::new("hollow ball", &hollow.unwrap(), Some((30, 32))),
            Shape::new("half torus", &half.unwrap(), None),
        ])
    }
}

/// Which culling modes the bodies of a scene use.
#[derive(Clone, Copy, Debug)]
pub enum Modes {
    All(Culling),
    /// Each body one of the three.
    Each,
}

pub const EXACT: Modes = Modes::All(Culling::Exact);
pub const FACES: Modes = Modes::All(Culling::FacesOfCollision);
pub const FRONT: Modes = Modes::All(Culling::FrontFacing);

/// A kind of scene, and in which modes it is tried.
pub struct Kind {
    pub name: &'static str,
    pub modes: &'static [Modes],
    make: fn(&mut Rng) -> Scene,
}

/// All of them: 24 scenes.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "tori",
        modes: &[EXACT, FACES, FRONT],
        make: |r| crowd(r, &[TORUS], 12.0),
    },
    Kind {
        name: "knots",
        modes: &[EXACT, FACES, FRONT],
        make: |r| crowd(r, &[KNOT], 16.0),
    },
    Kind {
        name: "all kinds",
        modes: &[EXACT, FACES, FRONT, Modes::Each],
        make: |r| crowd(r, ANY, 12.0),
    },
    Kind {
        name: "stretched, mirrored",
        modes: &[EXACT, FACES, FRONT, Modes::Each],
        make: stretched,
    },
    Kind {
        name: "far from the origin",
        modes: &[EXACT, Modes::Each],
        make: |r| {
            let mut scene = crowd(r, ANY, 12.0);
            let far = (r.direction() * 1.0e4).as_vec3();
            scene.bodies.iter_mut().for_each(|body| body.position += far);
            scene
        },
    },
    Kind {
        name: "tiny",
        modes: &[EXACT, Modes::Each],
        make: |r| {
            let mut scene = crowd(r, ANY, 12.0);
            for body in &mut scene.bodies {
                body.position *= 1.0e-3;
                body.scale *= 1.0e-3;
                body.linear_velocity *= 1.0e-3;
            }
            scene
        },
    },
    Kind {
        name: "links of chains",
        modes: &[EXACT, FACES, FRONT],
        make: chains,
    },
    Kind {
        name: "one inside another",
        modes: &[EXACT, Modes::Each],
        make: nested,
    },
    Kind {
        name: "sizes 1 to 100",
        modes: &[EXACT],
        make: |r| {
            let mut scene = crowd(r, ANY, 9.0);
            for body in &mut scene.bodies {
                body.scale *= (10.0f64.powf(r.range(-1.5, 0.5))) as f32;
            }
            scene
        },
    },
    Kind {
        name: "kinds, layers, planes",
        modes: &[EXACT, Modes::Each],
        make: mixed,
    },
];

pub const ANY: &[u32] = &[TORUS, KNOT, RING, RING, CUBE, CUBE, BALL, INWARD, HOLLOW, OPEN];

impl Kind {
    /// The scene, the same every time.
    pub fn scene(&self, kit: &Kit, modes: Modes) -> Scene {
        let seed = self
            .name
            .bytes()
            .fold(7u64, |h, b| h.wrapping_mul(31).wrapping_add(u64::from(b)));
        let mut rng = Rng::new(seed, 0);
        let mut scene = (self.make)(&mut rng);
        scene.shapes.clone_from(&kit.0);
        for body in &mut scene.bodies {
            body.culling = match modes {
                Modes::All(culling) => culling,
                Modes::Each => *rng.pick(&[Culling::Exact, Culling::FacesOfCollision, Culling::FrontFacing]),
            };
        }
        scene
    }
}

/// A moving body of a diameter of 0.25 to 2 somewhere in a cube of the given side.
fn anywhere(rng: &mut Rng, meshes: &[u32], side: f64) -> Body {
    let scale = Vec3::splat(rng.range(0.25, 2.0) as f32);
    let mesh = *rng.pick(meshes);
    let mut body = Body::at_rest(mesh, rng.in_cube(0.5 * side).as_vec3(), rng.rotation(), scale);
    body.linear_velocity = rng.in_cube(1.0).as_vec3();
    body.angular_velocity = rng.in_cube(1.0).as_vec3();
    body.restitution = rng.range(0.0, 1.0) as f32;
    body
}

/// Bodies in a cube of the given side.
pub fn crowd(rng: &mut Rng, meshes: &[u32], side: f64) -> Scene {
    Scene {
        bodies: (0..COUNT).map(|_| anywhere(rng, meshes, side)).collect(),
        ..Default::default()
    }
}

fn stretched(rng: &mut Rng) -> Scene {
    let mut scene = crowd(rng, ANY, 9.0);
    for body in &mut scene.bodies {
        let mut axis = || (rng.range(0.3, 1.0) * if rng.chance(0.5) { -1.0 } else { 1.0 }) as f32;
        body.scale *= Vec3::new(axis(), axis(), axis());
    }
    scene
}

/// 50 chains of 10 links, each through the next. Some links touch.
fn chains(rng: &mut Rng) -> Scene {
    let mut bodies = Vec::new();
    for _ in 0..COUNT / 10 {
        let mut at = rng.in_cube(5.0);
        let along = rng.rotation();
        for link in 0..10 {
            let quarter = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2 * (link % 2) as f32);
            let tilt = Quat::from_scaled_axis(rng.in_cube(0.25).as_vec3());
            let mesh = *rng.pick(&[RING, RING, RING, TORUS]);
            bodies.push(Body {
                linear_velocity: rng.in_cube(1.0).as_vec3(),
                ..Body::at_rest(mesh, at.as_vec3(), along * tilt * quarter, Vec3::ONE)
            });
            at += along.as_dquat().normalize() * DVec3::X * rng.range(0.45, 0.75);
        }
    }
    Scene {
        bodies,
        ..Default::default()
    }
}

/// 100 large bodies, each with four in or near it.
fn nested(rng: &mut Rng) -> Scene {
    let mut bodies = Vec::new();
    for i in 0..COUNT / 5 {
        // Apart from each other, so that what is found is the nesting.
        let place = DVec3::new((i % 5) as f64, (i / 5 % 5) as f64, (i / 25) as f64) * 2.1;
        let mesh = *rng.pick(&[BALL, BALL, CUBE, TORUS, INWARD, HOLLOW]);
        let outer = Body::at_rest(mesh, place.as_vec3(), rng.rotation(), Vec3::splat(2.0));
        bodies.push(outer);
        for _ in 0..4 {
            let mut inner = anywhere(rng, ANY, 1.0);
            inner.position += outer.position;
            inner.scale *= 0.15;
            bodies.push(inner);
        }
    }
    Scene {
        bodies,
        ..Default::default()
    }
}

/// Everything that decides whether a pair counts and who is pushed.
fn mixed(rng: &mut Rng) -> Scene {
    let mut scene = crowd(rng, ANY, 11.0);
    for body in &mut scene.bodies {
        body.kind = *rng.pick(&[
            RigidBody::Dynamic,
            RigidBody::Dynamic,
            RigidBody::Kinematic,
            RigidBody::Static,
        ]);
        body.sensor = rng.chance(0.2);
        body.layers = CollisionLayers {
            memberships: 1 << rng.below(3),
            filters: *rng.pick(&[u32::MAX, u32::MAX, 1, 2, 4, 6]),
        };
        body.mass = rng.chance(0.3).then(|| rng.range(0.1, 10.0) as f32);
        body.gravity_scale = *rng.pick(&[1.0, 1.0, 0.0, -0.5]);
    }
    scene.planes = half_spaces(rng, 4.0);
    scene.config = StepConfig {
        gravity: Vec3::NEG_Y * 9.81,
        ..Default::default()
    };
    scene
}

/// Five half-spaces, `distance` from the origin, solid away from it. The first does not collide with all layers.
pub fn half_spaces(rng: &mut Rng, distance: f32) -> Vec<Plane> {
    (0..5)
        .map(|i| Plane {
            normal: rng.direction().as_vec3().normalize(),
            distance: -distance,
            restitution: rng.range(0.0, 1.0) as f32,
            layers: CollisionLayers {
                memberships: u32::MAX,
                filters: if i == 0 { 3 } else { u32::MAX },
            },
            ..Plane::default()
        })
        .collect()
}
