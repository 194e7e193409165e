//! An engine that runs whole steps, and the process it runs in.
//!
//! Each engine runs in its own process, which does one step for each line it reads. So the steps of different engines
//! alternate, and an engine that panics, hangs or takes too long does not stop the others.

use crate::scene::{Choice, Scene};
use crate::{avian, ours, rapier};
use bevy_faceoff::types::settings::Response;
use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The number of threads of each engine.
pub const THREADS: usize = 2;

/// Who finds contacts between meshes, in an engine that can have ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contacts {
    /// The engine.
    Own,
    /// avian_faceoff or parry_faceoff.
    Exact,
}

/// A simulation that runs whole steps.
pub trait Engine {
    /// Runs one step and returns its time in seconds.
    fn step(&mut self) -> f64;

    /// The pairs of bodies that touched in the last step, by the engine's own definition, without walls.
    fn touching(&mut self) -> Vec<[u32; 2]>;

    /// The kinetic energy of all bodies, joules, if it is looked at.
    fn kinetic_energy(&mut self) -> Option<f64> {
        None
    }
}

/// The engines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
#[value(rename_all = "lower")]
pub enum Kind {
    /// bevy_faceoff, with one impulse per pair.
    Ours,
    /// bevy_faceoff, with contact manifolds, as the others do.
    Contacts,
    /// rapier3d.
    Rapier,
    /// rapier3d with the contacts of parry_faceoff.
    RapierFaceoff,
    /// avian3d.
    Avian,
    /// avian3d with the contacts of avian_faceoff.
    AvianFaceoff,
}

/// The time and result of a step.
#[derive(Serialize, Deserialize)]
pub struct Step {
    /// Time of the step in seconds.
    pub seconds: f64,
    /// The pairs of bodies that touched, ascending, each with the smaller index first.
    pub touching: Vec<[u32; 2]>,
    /// The kinetic energy as a multiple of that at the start, if it is looked at.
    pub energy: Option<f64>,
}

/// Runs an engine in this process: one step for each line of standard input, one line of JSON for each step.
pub fn serve(kind: Kind, scene: &Scene) {
    let mut engine: Box<dyn Engine> = match kind {
        Kind::Ours => Box::new(ours::Faceoff::new(scene, Response::Impulse)),
        Kind::Contacts => Box::new(ours::Faceoff::new(scene, Response::Contacts)),
        Kind::Rapier => Box::new(rapier::Rapier::new(scene, Contacts::Own)),
        Kind::RapierFaceoff => Box::new(rapier::Rapier::new(scene, Contacts::Exact)),
        Kind::Avian => Box::new(avian::Avian::new(scene, Contacts::Own)),
        Kind::AvianFaceoff => Box::new(avian::Avian::new(scene, Contacts::Exact)),
    };
    let start = engine.kinetic_energy();
    let mut out = std::io::stdout();
    for _ in std::io::stdin().lines().map_while(Result::ok) {
        let seconds = engine.step();
        let mut touching = engine.touching();
        for pair in &mut touching {
            pair.sort_unstable();
        }
        touching.sort_unstable();
        touching.dedup();
        let energy = engine.kinetic_energy().zip(start).map(|(now, start)| now / start);
        let step = Step {
            seconds,
            touching,
            energy,
        };
        let line = serde_json::to_string(&step).expect("numbers");
        if writeln!(out, "{line}").and_then(|()| out.flush()).is_err() {
            return;
        }
    }
}

/// An engine in its own process.
pub struct Process {
    child: Child,
    orders: Option<ChildStdin>,
    answers: Receiver<String>,
    complaints: Option<JoinHandle<String>>,
    left: Duration,
}

impl Process {
    /// Starts an engine that may take `limit` in total.
    pub fn start(kind: Kind, world: &Choice, limit: Duration) -> std::io::Result<Self> {
        let mut child = Command::new(std::env::current_exe()?)
            .args(["--serve", name(kind), "--shape", world.shape.name()])
            .args(["--bodies", &world.bodies.to_string(), "--seed", &world.seed.to_string()])
            .args(["--restitution", &world.restitution.to_string()])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let (send, answers) = channel();
        let out = child.stdout.take().expect("it is piped");
        std::thread::spawn(move || {
            for line in BufReader::new(out).lines().map_while(Result::ok) {
                if send.send(line).is_err() {
                    return;
                }
            }
        });
        let mut errors = child.stderr.take().expect("it is piped");
        let complaints = std::thread::spawn(move || {
            let mut text = Vec::new();
            // A failure to read leaves the text incomplete.
            let _ = errors.read_to_end(&mut text);
            String::from_utf8_lossy(&text).into_owned()
        });
        Ok(Self {
            orders: child.stdin.take(),
            child,
            answers,
            complaints: Some(complaints),
            left: limit,
        })
    }

    /// Runs one step.
    ///
    /// # Errors
    /// A description of how the engine failed.
    pub fn step(&mut self) -> Result<Step, String> {
        let start = Instant::now();
        // If the process has ended, this fails, and so does the read below.
        let _ = self.orders.as_mut().map(|orders| orders.write_all(b"step\n"));
        let answer = self.answers.recv_timeout(self.left);
        self.left = self.left.saturating_sub(start.elapsed());
        match answer {
            Ok(line) => serde_json::from_str(&line).map_err(|e| format!("answers {line:?}: {e}")),
            Err(RecvTimeoutError::Timeout) => Err("out of time".into()),
            Err(RecvTimeoutError::Disconnected) => Err(self.last_words()),
        }
    }

    fn last_words(&mut self) -> String {
        let status = self.child.wait().map_or_else(|e| e.to_string(), |s| s.to_string());
        let text = self.complaints.take().and_then(|thread| thread.join().ok());
        let text = text.unwrap_or_default();
        let mut lines = text.lines().skip_while(|line| !line.contains("panicked at"));
        match (lines.next(), lines.next()) {
            (Some(_), Some(message)) => format!("panics ({status}): {message}"),
            _ => format!("ends ({status})"),
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.orders = None;
        // The process has no state to save, so it can be killed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn name(kind: Kind) -> &'static str {
    match kind {
        Kind::Ours => "ours",
        Kind::Contacts => "contacts",
        Kind::Rapier => "rapier",
        Kind::RapierFaceoff => "rapierfaceoff",
        Kind::Avian => "avian",
        Kind::AvianFaceoff => "avianfaceoff",
    }
}
