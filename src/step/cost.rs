//! How long a stage takes, roughly: small work is not worth waking other threads.

use super::StepState;
use crate::types::settings::Response;
use crate::types::stage::Stage;

/// A stage that takes less than this on one thread runs on the calling thread, nanoseconds. Entering a thread pool and
/// waiting for its threads costs 10 to 50 microseconds, and on a busy machine far more.
const SMALL: u64 = 150_000;

// Times on one thread, nanoseconds, measured with `benches/small_games`.
const PER_BODY: u64 = 200;
const PER_SPHERE_PAIR: u64 = 150;
const PER_PLANE_OF_BODY: u64 = 200;
const PER_NEAR_PAIR: u64 = 1_000;
/// Cost of each triangle of a near pair, up to [`MAX_TRIANGLES`]: larger meshes are searched by trees. The part near
/// the other body costs much more; it is known from the last contact generation.
const PER_TRIANGLE: u64 = 20;
const MAX_TRIANGLES: usize = 1000;
const PER_CONTACT_POINT: u64 = 2_000;
/// Continuous collision detection against contact generation, per near pair.
const CONTINUOUS_FACTOR: u64 = 20;

/// Whether a stage of the next or present step is so small that one thread should run it. The last stage includes the
/// later collision substeps.
pub(crate) fn is_small(stage: Stage, step: &StepState) -> bool {
    // The first test is cheap, and most often decides.
    step.input.bodies.mover_count() as u64 * PER_BODY < SMALL && cost(stage, step) < SMALL
}

fn cost(stage: Stage, step: &StepState) -> u64 {
    let bodies = step.input.bodies.mover_count() as u64;
    let of_bodies = bodies * PER_BODY;
    match stage {
        Stage::BroadPhase => of_bodies,
        Stage::Angles => step.results.sphere_pairs.len() as u64 * PER_SPHERE_PAIR,
        Stage::TriangleTest => of_narrow_phase(step),
        Stage::Manifolds => of_contact_generation(step),
        Stage::ForceScan => of_bodies + step.results.manifolds.points.len() as u64 * PER_CONTACT_POINT,
        Stage::Integrate => {
            let of_contacts = step.input.config.response == Response::Contacts;
            let continuous = of_contacts && step.input.bodies.flags().continuous;
            let more_substeps = u64::from(step.results.collision_substeps.saturating_sub(1));
            let narrow_phase = of_narrow_phase(step);
            let later = [Stage::BroadPhase, Stage::Angles, Stage::Manifolds, Stage::ForceScan];
            let later: u64 = later.iter().map(|&stage| cost(stage, step)).sum::<u64>();
            let stops = if continuous {
                CONTINUOUS_FACTOR * narrow_phase
            } else {
                0
            };
            of_bodies + stops + more_substeps * (later + of_bodies)
        }
    }
}

/// A pair that is worth more than one thread is not small.
fn of_contact_generation(step: &StepState) -> u64 {
    let large = if step.scratch.manifolds.has_large_pair() {
        SMALL
    } else {
        0
    };
    large + of_narrow_phase(step)
}

/// The cost of the near pairs that are not asleep.
fn of_narrow_phase(step: &StepState) -> u64 {
    let StepState {
        input,
        results,
        scratch,
        ..
    } = step;
    let triangles = |body: u32| {
        let mesh = input.bodies.mesh[body as usize];
        input
            .meshes
            .get(mesh)
            .map_or(0, |slot| slot.mesh.mesh.triangles().len())
    };
    let awake = results
        .near_pairs
        .iter()
        .filter(|pair| !scratch.inactive.is_inactive(pair.bodies));
    let pairs: u64 = awake
        .map(|pair| {
            let [a, b] = pair.bodies.map(triangles);
            PER_NEAR_PAIR + PER_TRIANGLE * (a + b).min(MAX_TRIANGLES) as u64
        })
        .sum();
    pairs + (input.bodies.mover_count() * input.planes.len()) as u64 * PER_PLANE_OF_BODY
}
