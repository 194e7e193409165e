//! A solver of your own. The plugin finds contact points and moves bodies, and a system of this file decides with which
//! velocities: sequential impulses with friction and restitution, as in many game engines.
//!
//! * `cargo run --release --example custom_response --features window` shows it in a window;
//! * `cargo run --release --example custom_response -- --headless` prints how bodies come to rest. It ends with an
//!   error if one sinks into the ground or does not come to rest.
//!
//! The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::math::DVec3;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_faceoff::prelude::*;

/// A pile needs many, because each step begins anew: a warm start, with the impulses of the last step, would need
/// fewer.
const ITERATIONS: usize = 60;
const FRICTION: f32 = 0.6;
const RESTITUTION: f32 = 0.5;
/// Bodies that meet more slowly do not bounce, m/s.
const BOUNCE: f32 = 0.6;
/// How deep bodies may overlap, metres, so that contacts at rest persist, and which part of more is removed in a step.
const SLOP: (f32, f32) = (0.003, 0.2);
const STEPS: u32 = 64 * 8;

fn main() -> AppExit {
    // The solver needs the results of every step before the next one: not those of a GPU two steps later.
    let step = StepPlugin {
        readback: Readback::Lockstep,
        ..default()
    };
    let mut app = common::app_with("custom response", STEPS, step);
    app.insert_resource(Response::None)
        // With this response the margin does not grow with speed. It must be wide enough to see a contact one step
        // ahead.
        .insert_resource(SolverSettings {
            contact_margin: 0.25,
            ..default()
        })
        .insert_resource(common::View {
            from: Vec3::new(2.5, 3.0, 7.0),
            at: Vec3::new(0.0, 0.9, 0.0),
        })
        .add_systems(Startup, spawn)
        .add_systems(FaceoffStep, solve.in_set(FaceoffSystems::Respond));
    if app.world().resource::<common::Options>().headless {
        app.add_systems(FixedLast, print);
    }
    app.run()
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn(PlaneCollider::default());
    let meshes = ["torus", "cube", "knot", "ball"].map(|name| MeshCollider(assets.load(format!("{name}.bake.ron"))));
    for i in 0..16 {
        let (sin, cos) = (2.4 * i as f32).sin_cos();
        commands.spawn((
            RigidBody::Dynamic,
            meshes[i % meshes.len()].clone(),
            Transform::from_xyz(1.3 * cos, 1.0 + 0.35 * i as f32, 1.3 * sin)
                .with_rotation(Quat::from_scaled_axis(Vec3::new(cos, i as f32, sin))),
        ));
    }
}

/// A body as the solver sees it. The ground has infinite mass: zero inverse mass and inertia.
#[derive(Clone, Copy)]
struct Body {
    velocity: Vec3,
    spin: Vec3,
    inverse_mass: f32,
    inverse_inertia: Mat3,
}

impl Body {
    const GROUND: Self = Self {
        velocity: Vec3::ZERO,
        spin: Vec3::ZERO,
        inverse_mass: 0.0,
        // The default of a matrix is the identity, which would let the ground turn.
        inverse_inertia: Mat3::ZERO,
    };

    fn velocity_at(&self, anchor: Vec3) -> Vec3 {
        self.velocity + self.spin.cross(anchor)
    }

    fn push(&mut self, anchor: Vec3, impulse: Vec3) {
        self.velocity += self.inverse_mass * impulse;
        self.spin += self.inverse_inertia * anchor.cross(impulse);
    }

    /// Change of velocity along `way` at `anchor` for an impulse of 1 along it.
    fn yielding(&self, anchor: Vec3, way: Vec3) -> f32 {
        self.inverse_mass + way.dot((self.inverse_inertia * anchor.cross(way)).cross(anchor))
    }
}

/// A contact point between two bodies, by their numbers.
struct Row {
    bodies: [usize; 2],
    anchors: [Vec3; 2],
    normal: Vec3,
    /// Velocity along the normal that the point must have at least, m/s.
    least: f32,
    pushed: f32,
    rubbed: Vec3,
}

/// Changes velocities so that no contact closes in the next step.
fn solve(
    collisions: Res<Collisions>,
    meshes: Res<Assets<CollisionMesh>>,
    gravity: Res<Gravity>,
    time: Res<Time>,
    mut query: Query<(
        Entity,
        &Transform,
        &MeshCollider,
        &mut LinearVelocity,
        &mut AngularVelocity,
    )>,
) {
    let dt = time.delta_secs();
    // The next step adds gravity before it moves the bodies, so the solver must know of it.
    let fall = gravity.0 * dt;
    let mut bodies = vec![Body::GROUND];
    let mut numbers = HashMap::new();
    for (entity, pose, collider, velocity, spin) in &query {
        let Some(mesh) = meshes.get(&collider.0) else { continue };
        let mass = mesh.mass.volume * pose.scale.element_product();
        let inertia = mesh
            .mass
            .inertia(DVec3::ONE * f64::from(pose.scale.x), f64::from(mass))
            .as_mat3();
        let turn = Mat3::from_quat(pose.rotation);
        numbers.insert(entity, bodies.len());
        bodies.push(Body {
            velocity: velocity.0 + fall,
            spin: spin.0,
            inverse_mass: mass.recip(),
            inverse_inertia: turn * inertia.inverse() * turn.transpose(),
        });
    }
    let mut rows = Vec::new();
    for (one, other, points) in collisions.manifolds() {
        // Entities without a number are the ground.
        let pair = [one, other].map(|entity| numbers.get(&entity).copied().unwrap_or(0));
        let [a, b] = pair.map(|i| bodies[i]);
        for point in points {
            let closing = (b.velocity_at(point.anchors[1]) - a.velocity_at(point.anchors[0])).dot(point.normal);
            // Points are from before the bodies moved, and they moved without the gravity of the next step.
            let gravity = [a, b].map(|body| if body.inverse_mass > 0.0 { fall } else { Vec3::ZERO });
            let moved = closing - (gravity[1] - gravity[0]).dot(point.normal);
            let separation = point.separation + dt * moved;
            let bounces = closing < -BOUNCE && separation + dt * closing < 0.0;
            let least = match separation {
                _ if bounces => -RESTITUTION * closing,
                apart @ 0.0.. => -apart / dt,
                depth => (SLOP.1 * (-depth - SLOP.0).max(0.0) / dt).min(2.0),
            };
            rows.push(Row {
                bodies: pair,
                anchors: point.anchors,
                normal: point.normal,
                least,
                pushed: 0.0,
                rubbed: Vec3::ZERO,
            });
        }
    }
    for _ in 0..ITERATIONS {
        for row in &mut rows {
            row.solve(&mut bodies);
        }
    }
    for (entity, _, _, mut velocity, mut spin) in &mut query {
        if let Some(&i) = numbers.get(&entity) {
            velocity.0 = bodies[i].velocity - fall;
            spin.0 = bodies[i].spin;
        }
    }
}

impl Row {
    fn solve(&mut self, bodies: &mut [Body]) {
        let ([i, j], [at, other]) = (self.bodies, self.anchors);
        let sliding = bodies[j].velocity_at(other) - bodies[i].velocity_at(at);
        let yielding = |way: Vec3| bodies[i].yielding(at, way) + bodies[j].yielding(other, way);

        // A contact pushes and never pulls: over all iterations, not in each of them.
        let speed = sliding.dot(self.normal);
        let pushed = (self.pushed + (self.least - speed) / yielding(self.normal)).max(0.0);
        let tangent = sliding - speed * self.normal;
        let rub = tangent / yielding(tangent.normalize_or(self.normal));
        let rubbed = (self.rubbed - rub).clamp_length_max(FRICTION * pushed);
        let impulse = (pushed - self.pushed) * self.normal + (rubbed - self.rubbed);
        (self.pushed, self.rubbed) = (pushed, rubbed);
        bodies[i].push(at, -impulse);
        bodies[j].push(other, impulse);
    }
}

/// Prints once a second how fast bodies are, and how deep they overlap.
fn print(
    bodies: Query<(&Transform, &LinearVelocity)>,
    collisions: Res<Collisions>,
    report: Res<StepReport>,
    mut exit: MessageWriter<AppExit>,
) {
    if report.step == 0 || !report.step.is_multiple_of(64) {
        return;
    }
    let fastest = bodies.iter().map(|(_, velocity)| velocity.length()).fold(0.0, f32::max);
    let points = collisions.manifolds().flat_map(|(.., points)| points);
    let deepest = points.map(|point| -point.separation).fold(0.0, f32::max);
    println!(
        "step {}: the fastest body has {fastest:.2} m/s, the deepest overlap is {:.1} mm",
        report.step,
        1e3 * deepest
    );
    let sunk = bodies
        .iter()
        .any(|(pose, _)| pose.translation.y.is_nan() || pose.translation.y < 0.0);
    if sunk || report.step == u64::from(STEPS) && fastest > 0.5 {
        eprintln!("a body is in the ground, or has not come to rest");
        exit.write(AppExit::error());
    }
}
