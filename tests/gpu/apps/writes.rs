//! What users write to components means the same whenever results are read: the table in the docs of `Readback`.

use crate::app::{STEP, Sim, ball_like};
use crate::gpu::Test;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::plugin::settings::LATENCY;
use bevy_faceoff::prelude::*;
use bevy_faceoff::state::Motion;

pub const TESTS: &[Test] = &[
    ("every_write_means_the_same_in_every_readback", table),
    ("every_write_means_the_same_among_contacts", table_with_contacts),
    ("what_is_held_by_changes_does_not_creep", held_by_changes),
];

/// What to do to a body before step `step`.
type Act = fn(&mut Case, usize);

/// One of the bodies.
struct Case<'a> {
    sim: &'a mut Sim,
    body: Entity,
    home: Transform,
    /// Whether components say nothing of where the body is, so that they can only be set, and nothing added to them.
    blind: bool,
    mesh: MeshCollider,
    /// Where it is in a world in which components say it.
    truth: Option<Motion>,
}

/// Steps of which the results are compared.
const STEPS: usize = 24;

/// The row of a platform whose velocity is that of its last move.
const PUT_EVERY_STEP: &str = "a platform that is put somewhere every step";

const TABLE: &[(&str, Act)] = &[
    ("nothing", |_, _| {}),
    ("turned every step", |case, step| {
        case.change(|transform: &mut Transform| transform.rotation = Quat::from_rotation_y(0.1 * step as f32));
    }),
    ("turned to one and the same rotation every step", |case, step| {
        if step == 0 {
            case.insert(AngularVelocity::default());
        }
        case.change(|transform: &mut Transform| transform.rotation = Quat::from_rotation_y(0.5));
    }),
    ("moved along x", |case, step| {
        if [8, 9, 15].contains(&step) {
            case.add(
                |transform: &mut Transform| &mut transform.translation.x,
                |truth| truth.position.x,
            );
        }
    }),
    ("pushed along y", |case, step| {
        if [8, 9, 15].contains(&step) {
            case.add(
                |velocity: &mut LinearVelocity| &mut velocity.0.y,
                |truth| truth.linear_velocity.y,
            );
        }
    }),
    ("spun about z", |case, step| {
        if step == 8 {
            case.add(
                |spin: &mut AngularVelocity| &mut spin.0.z,
                |truth| truth.angular_velocity.z,
            );
        }
    }),
    ("pose inserted", |case, step| {
        if step == 8 {
            let home = case.home;
            case.insert(home.with_rotation(Quat::from_rotation_x(1.0)));
        }
    }),
    ("velocities inserted", |case, step| {
        if step == 8 {
            case.insert(LinearVelocity(Vec3::new(6.4, 0.0, 0.0)));
            case.insert(AngularVelocity(Vec3::new(0.0, 0.0, 1.0)));
        }
    }),
    ("the velocity that it had at first inserted", |case, step| {
        if step == 8 {
            case.insert(LinearVelocity(VELOCITY));
        }
    }),
    ("respawned where it began", |case, step| {
        if step == 8 {
            let home = case.home;
            case.insert((home, LinearVelocity::default(), AngularVelocity::default()));
        }
    }),
    ("respawned twice in two steps", |case, step| {
        if step == 8 || step == 9 {
            let home = case.home;
            case.insert((home, LinearVelocity::default(), AngularVelocity::default()));
        }
    }),
    ("held", |case, _| {
        let home = case.home;
        case.insert((home, LinearVelocity::default(), AngularVelocity::default()));
    }),
    ("static from a step on", |case, step| {
        if step == 8 {
            case.insert(RigidBody::Static);
        }
    }),
    ("static for three steps", |case, step| match step {
        8 => case.insert(RigidBody::Static),
        11 => case.insert(RigidBody::Dynamic),
        _ => {}
    }),
    ("kinematic from a step on", |case, step| {
        if step == 8 {
            case.insert(RigidBody::Kinematic);
        }
    }),
    ("without collider for a step", |case, step| match step {
        8 => {
            case.sim.world().entity_mut(case.body).remove::<MeshCollider>();
        }
        9 => case.insert(case.mesh.clone()),
        _ => {}
    }),
    ("without mass for four steps", |case, step| match step {
        8 => case.insert(Mass(f32::NAN)),
        12 => case.insert(Mass(1.0)),
        _ => {}
    }),
    (PUT_EVERY_STEP, |case, step| {
        if step == 0 {
            case.insert((
                RigidBody::Kinematic,
                LinearVelocity::default(),
                AngularVelocity::default(),
            ));
        }
        let height = case.home.translation.y + (0.3 * step as f32).sin();
        case.change(|transform: &mut Transform| transform.translation.y = height);
    }),
    ("a lift that moves along x and is put to a height", |case, step| {
        if step == 0 {
            case.insert((
                RigidBody::Kinematic,
                LinearVelocity(Vec3::X),
                AngularVelocity::default(),
            ));
        }
        let height = case.home.translation.y + 0.1 * step as f32;
        case.change(|transform: &mut Transform| transform.translation.y = height);
    }),
];

const VELOCITY: Vec3 = Vec3::new(2.0, 0.0, 1.0);

impl Case<'_> {
    fn insert(&mut self, bundle: impl Bundle) {
        self.sim.set(self.body, bundle);
    }

    fn change<C: Component<Mutability = bevy::ecs::component::Mutable>>(&mut self, change: impl FnOnce(&mut C)) {
        change(&mut self.sim.world().get_mut::<C>(self.body).unwrap());
    }

    /// Adds 1 to a number, or sets it to what that comes to.
    fn add<C: Component<Mutability = bevy::ecs::component::Mutable>>(
        &mut self,
        field: fn(&mut C) -> &mut f32,
        truth: fn(&Motion) -> f32,
    ) {
        let truth = self.truth.as_ref().filter(|_| self.blind).map(truth);
        self.change(|component| {
            let field = field(component);
            *field = truth.unwrap_or(*field) + 1.0;
        });
    }
}

/// A world with a body for each line of the table.
struct World {
    sim: Sim,
    bodies: Vec<Entity>,
    blind: bool,
    mesh: MeshCollider,
}

impl World {
    fn new(backend: Backend, readback: Readback, response: Response) -> Self {
        let mut sim = Sim::with_step(StepPlugin {
            backend,
            threads: 1,
            readback,
            ..default()
        });
        sim.app.insert_resource(response).insert_resource(Gravity::default());
        while sim.app.world().resource::<ActiveBackend>().name() == "opening" {
            std::thread::sleep(STEP);
            sim.step(1);
        }
        let mesh = sim.mesh(&shapes::torus_240());
        let bodies = (0..TABLE.len()).map(|i| {
            let body = sim.spawn(ball_like(&mesh, home(i).translation, VELOCITY));
            sim.set(body, AngularVelocity(Vec3::new(0.3, 0.5, 0.0)));
            body
        });
        Self {
            bodies: bodies.collect(),
            blind: readback == Readback::Resident,
            sim,
            mesh,
        }
    }

    fn act(&mut self, step: usize, truth: Option<&[Motion]>) {
        for (i, (&body, (_, act))) in self.bodies.iter().zip(TABLE).enumerate() {
            let mut case = Case {
                sim: &mut self.sim,
                body,
                home: home(i),
                blind: self.blind,
                mesh: self.mesh.clone(),
                truth: truth.map(|truth| truth[i]),
            };
            act(&mut case, step);
        }
    }

    /// What components say, or where they say nothing the device.
    fn motions(&mut self) -> Vec<Motion> {
        let snapshot = Snapshot::take(self.sim.world());
        let seen = |&body: &Entity| Motion {
            position: self.sim.position(body),
            rotation: self.sim.get::<Transform>(body).rotation,
            linear_velocity: self.sim.velocity(body),
            angular_velocity: self.sim.spin(body),
        };
        let known = |body: &Entity| {
            let found = snapshot.bodies().find(|(entity, _)| entity == body);
            found.map_or_else(|| seen(body), |(_, motion)| *motion)
        };
        if self.blind {
            self.bodies.iter().map(known).collect()
        } else {
            self.bodies.iter().map(seen).collect()
        }
    }
}

fn home(i: usize) -> Transform {
    Transform::from_xyz(20.0 * i as f32, 50.0, 0.0)
}

fn table(_: &Gpu) {
    compare(Response::Impulse);
}

fn table_with_contacts(_: &Gpu) {
    compare(Response::Contacts);
}

fn compare(response: Response) {
    let mut cpu = World::new(Backend::Cpu, Readback::Lockstep, response);
    let mut truth = vec![cpu.motions()];
    for step in 0..STEPS {
        cpu.act(step, None);
        cpu.sim.step(1);
        truth.push(cpu.motions());
    }
    let mut wrong = Vec::new();
    for readback in [Readback::Lockstep, Readback::Latent, Readback::Resident] {
        let mut world = World::new(Backend::Gpu, readback, response);
        for (step, truth) in truth[..STEPS].iter().enumerate() {
            world.act(step, Some(truth));
            world.sim.step(1);
        }
        if readback == Readback::Latent {
            world.sim.step(LATENCY);
        }
        for (((name, _), found), wanted) in TABLE.iter().zip(world.motions()).zip(&truth[STEPS]) {
            let mut wanted = *wanted;
            if *name == PUT_EVERY_STEP && readback == Readback::Latent {
                // While the last results are awaited nobody moves it.
                wanted.linear_velocity = Vec3::ZERO;
            }
            let off = [
                found.position.distance(wanted.position),
                found.linear_velocity.distance(wanted.linear_velocity),
                found.angular_velocity.distance(wanted.angular_velocity),
                1.0 - found.rotation.dot(wanted.rotation).abs(),
            ];
            if off.iter().any(|&off| off.is_nan() || off > 1.0e-3) {
                wrong.push(format!("{readback:?}, {name}: {off:?}, {found:?} and not {wanted:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Changes are differences to what is seen, two steps late: a body that falls for three steps before that is answered
/// has three steps' velocity, and is three such steps away.
fn held_by_changes(_: &Gpu) {
    let mut world = World::new(Backend::Gpu, Readback::Latent, Response::Impulse);
    let (body, home) = (world.bodies[0], home(0));
    world
        .sim
        .set(body, (LinearVelocity::default(), AngularVelocity::default()));
    for _ in 0..100 {
        world.sim.world().get_mut::<Transform>(body).unwrap().translation = home.translation;
        world.sim.world().get_mut::<LinearVelocity>(body).unwrap().0 = Vec3::ZERO;
        world.sim.step(1);
        let drop = 9.81 * STEP.as_secs_f32().powi(2);
        let there = Snapshot::take(world.sim.world());
        let (_, motion) = there.bodies().find(|&(entity, _)| entity == body).unwrap();
        let off = home.translation - motion.position;
        assert!(
            off.y <= 9.0 * drop + 1.0e-4 && off.y >= 0.0 && off.xz() == Vec2::ZERO,
            "{off}"
        );
    }
}
