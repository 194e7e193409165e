//! A scene that an engine moves, and a thread that it moves in: one that panics or hangs does not take the others along.

use super::{avian, ours, rapier};
use crate::engine::{Contacts, THREADS};
use crate::timing::{pool, time};
use bevy::math::{DQuat, DVec3};
use bevy_faceoff::testing::scenes::Scene;
use clap::ValueEnum;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// Steps that one engine does before it is the next one's turn: enough to have its data at hand.
const TURN: usize = 16;

/// Who moves a scene, and with which shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
pub enum Engine {
    /// bevy_faceoff, with contacts between meshes.
    Ours,
    /// rapier3d, with meshes.
    Meshes,
    /// rapier3d, with balls and cuboids.
    Primitives,
    /// rapier3d, with meshes cut into convex parts by V-HACD at its defaults.
    Parts,
    /// rapier3d, with the contacts of parry_faceoff.
    RapierFaceoff,
    /// rapier3d, with the contacts of parry_faceoff, found in every step: rapier's recycling is off.
    RapierFaceoffFresh,
    /// avian3d, with meshes whose internal edges are fixed.
    Avian,
    /// avian3d, with contacts between meshes from avian_faceoff.
    AvianFaceoff,
}

impl Engine {
    /// How far apart bodies rest, as a part of their diameter: scenes begin so that nothing has to fall first. Those of
    /// others begin a hair apart: on meshes that touch exactly parry's contacts fail, and a pyramid falls in the first
    /// steps.
    pub fn gap(self) -> f32 {
        match self {
            Self::Ours => bevy_faceoff::types::solver_settings::SolverSettings::default().rest_offset,
            _ => 1.0e-5,
        }
    }
}

/// Where a body is and how it moves.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Centre of mass, in the world.
    pub center: DVec3,
    /// A unit quaternion.
    pub rotation: DQuat,
    /// Velocity of the centre of mass, m/s.
    pub velocity: DVec3,
    /// World axes, rad/s.
    pub spin: DVec3,
}

/// A scene in an engine.
pub trait World {
    /// Does one step.
    fn step(&mut self);

    /// All bodies, in the scene's order.
    fn states(&self) -> Vec<State>;

    /// How many bodies it gave up.
    fn lost(&self) -> usize {
        0
    }
}

/// What became of a scene.
pub struct Run {
    /// As it began.
    pub scene: Scene,
    /// At the beginning and after every step done; empty if not even the beginning was reached.
    pub states: Vec<Vec<State>>,
    /// Seconds of each step.
    pub seconds: Vec<f64>,
    /// Why not all steps were done.
    pub failure: Option<String>,
}

/// What a thread tells: the first time of the beginning, then of each step.
struct News {
    seconds: f64,
    states: Vec<State>,
    lost: usize,
}

/// A scene on its way.
struct Runner {
    run: Run,
    orders: Sender<()>,
    news: Receiver<Result<News, String>>,
}

/// Has each engine do so many steps of its own form of a scene, in turns. Each may take as long as its limit says, which
/// becomes shorter by what it took.
pub fn run(contest: Vec<(Engine, Scene)>, steps: usize, limits: &mut [Duration]) -> Vec<Run> {
    let mut runners: Vec<Runner> = contest.into_iter().map(|(e, scene)| Runner::start(e, scene)).collect();
    // The one to build its shapes does so alone, too.
    for (runner, left) in runners.iter_mut().zip(&mut *limits) {
        runner.advance(1, steps, left);
    }
    for begin in (0..steps).step_by(TURN) {
        for (runner, left) in runners.iter_mut().zip(&mut *limits) {
            runner.advance(TURN.min(steps - begin), steps, left);
        }
    }
    runners.into_iter().map(|runner| runner.run).collect()
}

impl Runner {
    fn start(engine: Engine, scene: Scene) -> Self {
        let (orders, inbox) = channel();
        let (outbox, news) = channel();
        let own = scene.clone();
        std::thread::spawn(move || {
            let results = outbox.clone();
            let work = move || pool(THREADS).install(move || serve(engine, &own, &inbox, &results));
            if let Err(panic) = catch_unwind(AssertUnwindSafe(work)) {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                let text = text.or(panic.downcast_ref::<&str>().copied()).unwrap_or_default();
                // Nobody may be listening any more.
                let _ = outbox.send(Err(format!("panics: {text}")));
            }
        });
        let run = Run {
            scene,
            states: Vec::new(),
            seconds: Vec::new(),
            failure: None,
        };
        Self { run, orders, news }
    }

    /// Has `count` more results come.
    fn advance(&mut self, count: usize, steps: usize, left: &mut Duration) {
        for _ in 0..count {
            if self.run.failure.is_some() {
                return;
            }
            let start = Instant::now();
            // A thread that is gone is noticed by its silence.
            let _ = self.orders.send(());
            let answer = self.news.recv_timeout(*left);
            *left = left.saturating_sub(start.elapsed());
            let failure = match answer {
                Ok(Ok(news)) => self.run.add(news),
                Ok(Err(failure)) => Some(failure),
                Err(RecvTimeoutError::Timeout) => Some("out of time".into()),
                Err(RecvTimeoutError::Disconnected) => Some("ends".into()),
            };
            let done = self.run.seconds.len();
            self.run.failure = failure.map(|text| format!("{text} after {done} of {steps} steps"));
        }
    }
}

impl Run {
    /// Notes a step; says what is wrong with it.
    fn add(&mut self, news: News) -> Option<String> {
        let sound = |s: &State| [s.center, s.velocity, s.spin].iter().all(|v| v.is_finite());
        let unsound = news.states.iter().filter(|s| !sound(s)).count() + news.lost;
        if unsound > 0 {
            return Some(format!("{unsound} bodies are not finite"));
        }
        if !self.states.is_empty() {
            self.seconds.push(news.seconds);
        }
        self.states.push(news.states);
        None
    }

    /// The last states, if there are any.
    pub fn last(&self) -> &[State] {
        self.states.last().map_or(&[], Vec::as_slice)
    }
}

/// Builds a scene on the first order, and does a step on each after that.
fn serve(engine: Engine, scene: &Scene, inbox: &Receiver<()>, outbox: &Sender<Result<News, String>>) {
    let mut world: Option<Box<dyn World>> = None;
    while inbox.recv().is_ok() {
        let (seconds, world) = match &mut world {
            Some(world) => (time(|| world.step()).0, world),
            None => {
                let (seconds, new) = time(|| build(engine, scene));
                (seconds, world.insert(new))
            }
        };
        let news = News {
            seconds,
            states: world.states(),
            lost: world.lost(),
        };
        if outbox.send(Ok(news)).is_err() {
            return;
        }
    }
}

fn build(engine: Engine, scene: &Scene) -> Box<dyn World> {
    match engine {
        Engine::Ours => Box::new(ours::Faceoff::new(scene)),
        Engine::Avian => Box::new(avian::Avian::new(scene, Contacts::Own)),
        Engine::AvianFaceoff => Box::new(avian::Avian::new(scene, Contacts::Exact)),
        _ => Box::new(rapier::Rapier::new(engine, scene)),
    }
}
