//! Warm steps allocate nothing: once every list has had its length, memory is kept.

use bevy::prelude::*;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::FaceoffStep;
use bevy_faceoff::prelude::*;
use bevy_faceoff::queries::{ContactWorker, PairMemory, Placed};
use bevy_faceoff::state::{Body, Counts, Plane};
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::stage::Stage;
use glam::{DQuat, DVec3};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, Stats, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

const STEPS: usize = 20;

/// Tori, knots and balls in a box over a plane, some static, some culled by their front.
fn scene(state: &mut StepState) -> Vec<Body> {
    let meshes = [shapes::torus_240(), shapes::knot_1120(), shapes::ball(0.5, 5)];
    let meshes = meshes.map(|mesh| state.input.meshes.add(CollisionMesh::new(&mesh)));
    state.input.config.gravity = Vec3::NEG_Y;
    state.input.planes.push(Plane {
        normal: Vec3::Y,
        distance: -2.0,
        restitution: 0.5,
        ..Plane::default()
    });
    let mut random = fastrand::Rng::with_seed(5);
    let mut vector = |reach: f32| Vec3::from_array([0; 3].map(|_| (random.f32() * 2.0 - 1.0) * reach));
    (0..300)
        .map(|i| Body {
            kind: if i % 10 == 0 {
                RigidBody::Static
            } else {
                RigidBody::Dynamic
            },
            linear_velocity: vector(3.0),
            angular_velocity: vector(3.0),
            restitution: 0.5,
            culling: if i % 7 == 0 {
                Culling::FrontFacing
            } else {
                Culling::Exact
            },
            ..Body::at_rest(
                meshes[i % 3],
                vector(4.0),
                Quat::from_scaled_axis(vector(3.0)),
                Vec3::splat(0.4 + 0.1 * (i % 5) as f32),
            )
        })
        .collect()
}

/// Makes [`STEPS`] steps from the start of the scene; `bodies` is overwritten.
fn steps(state: &mut StepState, scene: &[Body], bodies: &mut Vec<Body>, counts: &mut Vec<Counts>) {
    counts.clear();
    bodies.clear();
    bodies.extend_from_slice(scene);
    for _ in 0..STEPS {
        state.input.bodies.clear();
        for body in bodies.iter() {
            state
                .input
                .bodies
                .push(body, &state.input.meshes)
                .expect("a usable body");
        }
        for stage in Stage::ALL {
            bevy_faceoff::step::cpu::run(stage, state);
        }
        counts.push(state.results.counts());
        for (i, body) in bodies.iter_mut().enumerate() {
            let motion = state.input.bodies.motion(i);
            body.position = motion.position;
            body.rotation = motion.rotation;
            body.linear_velocity = motion.linear_velocity;
            body.angular_velocity = motion.angular_velocity;
        }
    }
}

/// What `work` allocated.
fn allocated(work: impl FnOnce()) -> Stats {
    let region = Region::new(ALLOCATOR);
    work();
    region.change()
}

/// The allocator counts for all threads, so there is one test.
#[test]
fn warm_steps_allocate_nothing() {
    // First, while no other thread runs: the allocator counts those of all threads.
    contacts();
    [1, 2].into_iter().for_each(stages);
    [1, 2].into_iter().for_each(app);
}

/// Rounds in a row that must be warm. A single one may be luck.
const IN_A_ROW: usize = 5;

/// Runs rounds until so many in a row are warm.
///
/// Each thread has memory of its own, and which one meets the largest pair is chance. So with several threads `most` rounds may
/// go by before all of them have met it. Memory that some rounds need and let go would break the row again and again.
fn warm_up(most: usize, what: &str, mut round: impl FnMut() -> Stats, is_warm: impl Fn(&Stats) -> bool) {
    let (mut row, mut cold) = (0, Vec::new());
    while row < IN_A_ROW {
        let stats = round();
        if is_warm(&stats) {
            row += 1;
        } else {
            row = 0;
            cold.push(stats);
        }
        assert!(
            cold.len() <= most,
            "{what}: {} rounds allocated, the last {:?}",
            cold.len(),
            cold.last()
        );
    }
    println!("{what}: {} rounds allocated, then {row} in a row did not", cold.len());
}

/// Rounds that may allocate after the first one. On one thread all rounds are alike.
fn most_cold_rounds(threads: usize) -> usize {
    if threads == 1 { 0 } else { 60 }
}

/// A worker for contacts, which goes through the same poses again and again.
fn contacts() {
    let mut random = fastrand::Rng::with_seed(6);
    let mut vector = |reach: f64| DVec3::from_array([0; 3].map(|_| (random.f64() * 2.0 - 1.0) * reach));
    let meshes = [shapes::torus_240(), shapes::knot_1120(), shapes::ball(0.5, 5)].map(|mesh| CollisionMesh::new(&mesh));
    let poses: Vec<_> = (0..600)
        .map(|i| (i % 3, vector(0.5), DQuat::from_scaled_axis(vector(3.0))))
        .collect();
    let place = |&(mesh, at, turn): &(usize, DVec3, DQuat)| {
        Placed::new(&meshes[mesh], at, turn, Vec3::ONE).expect("a usable pose")
    };
    let (mut worker, mut memory) = (ContactWorker::new(), PairMemory::default());
    let (mut all, mut few) = (Vec::new(), Vec::new());
    let mut round = || {
        all.clear();
        few.clear();
        for pair in poses.chunks(2) {
            let [a, b] = [0, 1].map(|i| place(&pair[i]));
            worker.points(&a, &b, 0.02, &mut all);
            worker.manifold(&a, &b, 0.02, &mut memory, &mut few);
        }
        (all.len(), few.len())
    };
    let mut first = (0, 0);
    let cold = allocated(|| first = round());
    assert!(cold.allocations > 10, "the allocator does not count: {cold:?}");
    let mut again = (0, 0);
    let warm = allocated(|| again = round());
    assert_eq!(first, again);
    assert!(first.1 > 1000, "{first:?}");
    assert_eq!((warm.allocations, warm.reallocations), (0, 0), "{warm:?}");
}

fn stages(threads: usize) {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads");
    pool.install(|| {
        let mut state = StepState::default();
        let scene = scene(&mut state);
        let (mut first, mut again, mut bodies) = (Vec::new(), Vec::with_capacity(STEPS), Vec::new());
        let cold = allocated(|| steps(&mut state, &scene, &mut bodies, &mut first));
        assert!(cold.allocations > 50, "the allocator does not count: {cold:?}");
        let is_warm = |stats: &Stats| (stats.allocations, stats.reallocations) == (0, 0);
        let round = || {
            let stats = allocated(|| steps(&mut state, &scene, &mut bodies, &mut again));
            assert_eq!(first, again);
            stats
        };
        warm_up(
            most_cold_rounds(threads),
            &format!("steps on {threads} threads"),
            round,
            is_warm,
        );
        // One allocation more than that is seen.
        let one_more = allocated(|| {
            steps(&mut state, &scene, &mut bodies, &mut again);
            std::hint::black_box(vec![0u8; 16]);
        });
        assert_eq!(one_more.allocations, 1, "{one_more:?}");
        assert!(
            first
                .iter()
                .all(|counts| counts.face_pairs > 100 && counts.approximate_pairs > 0)
        );
    });
}

/// Components in and results out included.
fn app(threads: usize) {
    let mut app = App::new();
    let step = StepPlugin {
        backend: Backend::Cpu,
        threads,
        ..default()
    };
    app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins { step, ..default() }))
        .insert_resource(Gravity(Vec3::ZERO))
        .insert_resource(Response::None);
    app.finish();
    app.cleanup();
    let world = app.world_mut();
    let torus = world
        .resource_mut::<Assets<CollisionMesh>>()
        .add(CollisionMesh::new(&shapes::torus_240()));
    world.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    for i in 0..100 {
        for height in [0.0, 0.2] {
            world.spawn((
                RigidBody::Dynamic,
                MeshCollider(torus.clone()),
                AngularVelocity(Vec3::Y),
                Transform::from_xyz((i % 10) as f32, height, (i / 10) as f32),
                CollidingEntities::default(),
            ));
        }
    }
    let mut steps = |count| {
        allocated(|| {
            for _ in 0..count {
                world.run_schedule(FaceoffStep);
            }
        })
    };
    let cold = steps(1);
    assert!(cold.allocations > 50, "the allocator does not count: {cold:?}");
    // The tori turn once in 402 steps, and come to each pose again.
    steps(420);
    // Five stages a step are handed to the pool, whose queue is allocated in blocks of 63 entries.
    let is_warm = |stats: &Stats| stats.allocations <= 60 * 5 / 63 + 1 && stats.reallocations == 0;
    let most = most_cold_rounds(threads);
    warm_up(most, &format!("an app on {threads} threads"), || steps(60), is_warm);
    assert!(app.world().resource::<Collisions>().len() >= 100);
}
