#define_import_path faceoff::sweep

// Which colliders can meet within a step. The twin of `Sweep` in `src/step/reach.rs`.

#import faceoff::constants::broad_phase::SPHERE_SLACK
#import faceoff::types as t

fn moves(sweep: t::Sweep) -> bool {
    return (sweep.flags & t::KIND_MASK) != t::STATIC;
}

fn is_solid(sweep: t::Sweep) -> bool {
    return (sweep.flags & t::SENSOR) == 0u;
}

// Whether the two spheres overlap at any time of the step.
fn meet(a: t::Sweep, b: t::Sweep) -> bool {
    let reach = a.radius + b.radius;
    // In units of the spheres: squares of tiny or huge lengths would leave the range of f32.
    let offset = (b.center - a.center) / reach;
    let travel = (b.travel - a.travel) / reach;
    let part = -dot(offset, travel) / max(dot(travel, travel), 1.0e-30);
    let nearest = offset + clamp(part, 0.0, 1.0) * travel;
    return dot(nearest, nearest) <= SPHERE_SLACK;
}
