#define_import_path faceoff::near_boxes

// Nodes of two trees that are near each other.

#import faceoff::arena::vector
#import faceoff::constants::manifolds::MAX_DEPTH
#import faceoff::math::absolute
#import faceoff::sides
#import faceoff::tree
#import faceoff::types as t

// Largest distance of what is near.
var<private> reach: f32;
// Rounding allowance.
var<private> pad: f32;
// Only features that overlap are searched, near patches.
var<private> windowed: bool;

// Sets what is near in a pair. `deep`: as deep as features may overlap, near patches.
fn set_reach(setup: t::PairSetup, deep: bool) {
    windowed = deep;
    pad = 2.0 * setup.rounding;
    reach = select(setup.margin + setup.touch, MAX_DEPTH * setup.size, deep) + pad;
}

// Whether a search is not needed. A margin wider than the largest overlap has found all pairs of triangles already.
fn is_done(setup: t::PairSetup, deep: bool) -> bool {
    return setup.valid == 0u || (deep && (!has_window(setup) || MAX_DEPTH * setup.size <= setup.margin));
}

// Whether features that overlap are searched at all.
fn has_window(setup: t::PairSetup) -> bool {
    return setup.patch_count > 0u && all(setup.window_min <= setup.window_max);
}

// Whether both nodes exist, are in the window, and their boxes are near along the axes of both.
fn boxes_near(setup: t::PairSetup, a: sides::Side, b: sides::Side, nodes: vec2<u32>) -> bool {
    let at_a = tree::box_of(0u, nodes.x);
    let at_b = tree::box_of(1u, nodes.y);
    if at_a == 0u || at_b == 0u {
        return false;
    }
    let center_a = sides::place(a, vector(at_a));
    let half_a = abs(a.scale) * vector(at_a + 3u) + pad;
    let center_b = sides::place(b, vector(at_b));
    let half_b = abs(b.scale) * vector(at_b + 3u) + pad;
    let spread = absolute(b.rotation);
    let around_b = spread * half_b;
    if any(abs(center_b - center_a) > half_a + around_b + reach) {
        return false;
    }
    if windowed {
        if any(center_a + half_a < setup.window_min) || any(center_a - half_a > setup.window_max)
            || any(center_b + around_b < setup.window_min) || any(center_b - around_b > setup.window_max) {
            return false;
        }
        let last = dot(center_a, setup.window_direction) + dot(half_a, abs(setup.window_direction));
        if dot(center_b, setup.window_direction) - dot(around_b, abs(setup.window_direction)) > last {
            return false;
        }
    }
    let apart = (center_a - center_b) * b.rotation;
    return all(abs(apart) <= half_b + half_a * spread + reach);
}
