#define_import_path faceoff::friction

// Coulomb friction at a point: an impulse across the normal, no larger than the friction coefficient times the normal one.

#import faceoff::contact as c
#import faceoff::solver_math::across
#import faceoff::solver_types as s

// What stops the points from sliding, shortened to `limit`: pushes by the difference and returns the new impulse.
fn rub(local: ptr<function, c::Local>, point: s::PointState, give: f32, so_far: vec2<f32>, part: f32, limit: f32) -> vec2<f32> {
    let side = across(point.normal);
    let first = c::row((*local).mass_a, (*local).mass_b, point, side);
    let second = c::row((*local).mass_a, (*local).mass_b, point, cross(point.normal, side));
    if !(give > 0.0) {
        return so_far;
    }
    var wanted = so_far - (part / give) * vec2(c::parting(local, first), c::parting(local, second));
    let square = dot(wanted, wanted);
    if square > limit * limit {
        wanted *= limit / sqrt(square);
    }
    c::push(local, first, wanted.x - so_far.x);
    c::push(local, second, wanted.y - so_far.y);
    return wanted;
}
