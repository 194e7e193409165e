//! Hooks: what a caller decides about pairs of colliders that ask for it, in every collision substep.

use super::StepState;
use crate::manifolds::cpu::planes::margin;
use crate::state::{ContactSurface, ManifoldPoint, Plane, StepInput};
use crate::types::body::RigidBody;
use crate::types::hooks::ActiveCollisionHooks;
use crate::types::material::CombineRule;
use crate::types::settings::Response;

/// Decisions of a caller about pairs with [`ActiveCollisionHooks`]. They are called on the CPU, one after another, in
/// the order of pairs. Colliders have their numbers; plane `i` has the number `bodies.len() + i` and comes second.
///
/// Results depend on the answers alone. For the same bits in every run, answer the same for the same state.
pub trait StepHooks: Send {
    /// Whether two colliders near each other are tested. A pair that is left out does not touch.
    fn filter_pair(&mut self, pair: [u32; 2]) -> bool;

    /// Changes the contacts of a pair. Returns false to drop them: the pair does not push.
    fn modify_contacts(&mut self, contacts: &mut PairContacts) -> bool;
}

/// The contacts of a pair before they are solved.
#[derive(Debug)]
pub struct PairContacts<'a> {
    /// The colliders.
    pub pair: [u32; 2],
    /// The contact points. A point that is no longer valid has no effect.
    pub points: &'a mut [ManifoldPoint],
    /// How the surfaces touch.
    pub surface: &'a mut ContactSurface,
}

/// Every pair is tested, and its contacts are unchanged.
pub struct NoHooks;

impl StepHooks for NoHooks {
    fn filter_pair(&mut self, _: [u32; 2]) -> bool {
        true
    }

    fn modify_contacts(&mut self, _: &mut PairContacts) -> bool {
        true
    }
}

/// The pairs that a filter left out of a collision substep.
#[derive(Default)]
pub(crate) struct LeftOut {
    /// With planes, ascending.
    planes: Vec<[u32; 2]>,
    /// The keys of all of them, ascending.
    keys: Vec<[u64; 2]>,
    /// Scratch: pairs about which the filter changed its mind.
    changed: Vec<[u32; 2]>,
    /// Pairs whose contacts were dropped, ascending.
    dropped: Vec<[u32; 2]>,
}

impl LeftOut {
    /// Whether a pair with a plane was left out.
    pub fn contains_plane_pair(&self, pair: [u32; 2]) -> bool {
        !self.planes.is_empty() && self.planes.binary_search(&pair).is_ok()
    }

    /// Whether the contacts of a pair were dropped, or, of a pair with a plane, left out.
    pub fn has_dropped(&self, pair: [u32; 2]) -> bool {
        let is_dropped = !self.dropped.is_empty() && self.dropped.binary_search(&pair).is_ok();
        is_dropped || self.contains_plane_pair(pair)
    }
}

/// Leaves out pairs by the filter in collision substep `number`. A sleeping body wakes if the answer about one of its
/// pairs has changed since the last step.
pub(super) fn filter_pairs(step: &mut StepState, number: u32, hooks: &mut dyn StepHooks) {
    let StepState {
        input,
        results,
        memory,
        scratch,
    } = step;
    let filters = |hooks: ActiveCollisionHooks| hooks.filter_pairs;
    let left_out = &mut scratch.left_out;
    left_out.planes.clear();
    left_out.keys.clear();
    left_out.changed.clear();
    let (before, warm) = (&mut memory.left_out, &memory.warm);
    let StepInput { bodies, planes, .. } = &*input;
    if !bodies.flags().filters && !planes.iter().any(|plane| filters(plane.hooks)) {
        before.clear();
        return;
    }
    // Without contacts nothing sleeps. Later collision substeps leave out what sleeps.
    let may_wake = input.config.response == Response::Contacts && number == 0;
    let keys = &scratch.solver_bodies.keys;
    let mut decide = |pair: [u32; 2]| {
        let is_tested = hooks.filter_pair(pair);
        if !may_wake {
            return is_tested;
        }
        let mut keys = pair.map(|i| keys[i as usize]);
        keys.sort_unstable();
        if !is_tested {
            left_out.keys.push(keys);
        }
        let was_left_out = before.binary_search(&keys).is_ok();
        // What passes a sleeper and is left out changes nothing for it, unless the two had contact points.
        if is_tested && was_left_out || !is_tested && !was_left_out && warm.has(keys) {
            left_out.changed.push(pair);
        }
        is_tested
    };
    let asks = |pair: [u32; 2]| pair.iter().any(|&i| filters(bodies.params[i as usize].hooks));
    results.sphere_pairs.retain(|&pair| !asks(pair) || decide(pair));
    for i in bodies.movers() {
        for (number, plane) in (bodies.len()..).zip(planes) {
            let asks = filters(bodies.params[i].hooks) || filters(plane.hooks);
            let pair = [i, number].map(|i| i as u32);
            if asks && is_near(input, i, plane) && !decide(pair) {
                left_out.planes.push(pair);
            }
        }
    }
    if may_wake {
        left_out.keys.sort_unstable();
        before.clone_from(&left_out.keys);
    }
    for &i in left_out.changed.iter().flatten() {
        if scratch.solver_bodies.bodies[i as usize].kind == RigidBody::Dynamic {
            scratch.solver_bodies.wake(i);
            scratch.inactive.flags[i as usize] = false;
        }
    }
}

/// Whether a collider may come near a plane in this collision substep.
fn is_near(input: &StepInput, i: usize, plane: &Plane) -> bool {
    let bodies = &input.bodies;
    let height = plane.normal.as_dvec3().dot(bodies.frame[i].center) - f64::from(plane.distance);
    plane.detects(bodies.kind[i], bodies.layers[i])
        && height as f32 <= bodies.radius[i] + margin(bodies, i, &input.config)
}

/// Has the hook modify the contacts of new manifolds, and drops the contacts that it rejects.
pub(super) fn modify_contacts(step: &mut StepState, number: u32, hooks: &mut dyn StepHooks) {
    let StepState {
        input,
        results,
        scratch,
        ..
    } = step;
    let modifies = |hooks: ActiveCollisionHooks| hooks.modify_contacts;
    scratch.left_out.dropped.clear();
    let StepInput { bodies, planes, .. } = &*input;
    if !bodies.flags().modifies && !planes.iter().any(|plane| modifies(plane.hooks)) {
        return;
    }
    let manifolds = &mut results.manifolds;
    let (points, surfaces) = (&mut manifolds.points, &mut manifolds.surfaces);
    let dropped = &mut scratch.left_out.dropped;
    let mut end = 0;
    manifolds.pairs.retain_mut(|manifold| {
        let first = manifold.first_point as usize;
        let range = first..first + manifold.point_count as usize;
        let both = manifold.bodies.map(|i| SurfaceProperties::of(input, i));
        if both.iter().any(|own| modifies(own.hooks)) {
            let own = SurfaceProperties::combine(&both);
            let mut surface = own;
            let is_kept = hooks.modify_contacts(&mut PairContacts {
                pair: manifold.bodies,
                points: &mut points[range.clone()],
                surface: &mut surface,
            });
            if !is_kept {
                dropped.push(manifold.bodies);
                return false;
            }
            if surface != own {
                surfaces.push((manifold.bodies, surface.checked(&own)));
            }
        }
        points.copy_within(range.clone(), end);
        manifold.first_point = end as u32;
        end += range.len();
        true
    });
    points.truncate(end);
    surfaces.sort_unstable_by_key(|&(pair, _)| pair);
    dropped.sort_unstable();
    // The triangle test belongs to the first collision substep.
    if number == 0 && !dropped.is_empty() {
        let is_kept = |pair: [u32; 2]| dropped.binary_search(&pair).is_err();
        let contacts = &mut results.contacts;
        contacts.pairs.retain(|pair| is_kept(pair.bodies));
        let first_plane = bodies.len() as u32;
        contacts
            .planes
            .retain(|pair| is_kept([pair.body, first_plane + pair.plane]));
    }
}

/// What a collider or plane contributes to a contact.
struct SurfaceProperties {
    friction: (CombineRule, f32),
    restitution: (CombineRule, f32),
    hooks: ActiveCollisionHooks,
}

impl SurfaceProperties {
    fn of(input: &StepInput, i: u32) -> Self {
        let bodies = &input.bodies;
        let i = i as usize;
        if i < bodies.len() {
            let params = &bodies.params[i];
            return Self {
                friction: (params.friction.combine, params.friction.coefficient),
                restitution: (params.restitution_combine, bodies.restitution[i]),
                hooks: params.hooks,
            };
        }
        let plane = &input.planes[i - bodies.len()];
        Self {
            friction: (plane.friction.combine, plane.friction.coefficient),
            restitution: (plane.restitution_combine, plane.restitution),
            hooks: plane.hooks,
        }
    }

    fn combine([a, b]: &[Self; 2]) -> ContactSurface {
        let combined = |a: (CombineRule, f32), b: (CombineRule, f32)| CombineRule::combine([a.0, b.0], [a.1, b.1]);
        ContactSurface {
            friction: combined(a.friction, b.friction),
            restitution: combined(a.restitution, b.restitution).min(1.0),
            ..ContactSurface::default()
        }
    }
}
