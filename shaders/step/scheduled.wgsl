#define_import_path faceoff::scheduled

// How a collider goes on between collision substeps.

#import faceoff::margins::with_speculative_radius
#import faceoff::paces::NO_PACE
#import faceoff::types as t

// Whether a body with this pace has completed its step after this many collision substeps; true for static bodies.
fn has_completed(pace: u32, collision_substeps: u32) -> bool {
    return pace == NO_PACE || collision_substeps > pace;
}

// The collider, moved to its new place, in the next collision substep. `rests`: it is static or asleep. If it has
// completed its step its sphere stays as it was, so that the pairs that keep contact points are found.
fn after_substep(step: t::Step, body: t::Body, rests: bool, completed: bool) -> t::Body {
    var next = body;
    if !rests {
        next.inactive &= ~t::RESTS;
    }
    if completed {
        next.inactive |= t::COMPLETED;
        next.travel_time = 0.0;
        return next;
    }
    return with_speculative_radius(step, next);
}
