#define_import_path faceoff::paces

// How bodies pass through a step. The twin of `src/solver/pace.rs`.

#import faceoff::constants::solver::MAX_COLLISION_SUBSTEPS
#import faceoff::solver_types as s

// For a body with one collision substep in the step, with two, and so on.
@group(0) @binding(10) var<uniform> paces: array<s::Pace, MAX_COLLISION_SUBSTEPS>;

// In place of the number of a pace: the body is static or has completed its step.
const NO_PACE: u32 = 0xffffffffu;

// The pace of a body, by its flags.
fn pace_of(flags: u32) -> s::Pace {
    return paces[flags >> s::PACE_SHIFT];
}

// How long a body moves in this collision substep, seconds, by the number of its pace.
fn travel_time(number: u32) -> f32 {
    if number == NO_PACE {
        return 0.0;
    }
    return paces[number].dt;
}
