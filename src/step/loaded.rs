//! Memory that comes from outside, for example from a file: whether it can be used, and other keys for its bodies.

use super::memory::{SavedBody, StepMemory};
use crate::solver::PLANE_KEY;
use crate::state::manifolds::pair_order;
use crate::state::memory_fault::MemoryFault;
use crate::state::{ManifoldPoint, Manifolds};
use crate::types::body::RigidBody;

impl StepMemory {
    /// Checks what a step relies on, in this memory and in the manifolds of the same step. Wrong values that pass give
    /// wrong contacts, as a wrong pose does.
    ///
    /// # Errors
    /// The first fault.
    pub(crate) fn check(&self, manifolds: &Manifolds) -> Result<(), MemoryFault> {
        let (count, planes) = (self.keys.len(), self.planes.len());
        if self.bodies.len() != count {
            return Err(MemoryFault::Count {
                keys: count,
                bodies: self.bodies.len(),
            });
        }
        if count + planes > u32::MAX as usize {
            return Err(MemoryFault::Reference("planes"));
        }
        let mut sorted = self.keys.clone();
        sorted.sort_unstable();
        let are_keys =
            sorted.is_sorted_by(|one, next| one < next) && sorted.last().is_none_or(|&last| !self.is_of_plane(last));
        // Static colliders come first.
        let places: Vec<_> = (0..count).map(|i| self.place(i, &self.keys)).collect();
        if !are_keys || !places.is_sorted() {
            return Err(MemoryFault::Order("keys of colliders"));
        }
        for (i, saved) in self.bodies.iter().enumerate() {
            self.check_body(i, saved)?;
        }
        if !self.left_out.is_sorted_by(|one, next| one < next) {
            return Err(MemoryFault::Order("pairs that hooks left out"));
        }
        self.warm.check()?;
        check_manifolds(manifolds, count as u32, planes as u32)
    }

    fn check_body(&self, i: usize, saved: &SavedBody) -> Result<(), MemoryFault> {
        let number = saved.body as usize;
        // A body has the number of its first collider.
        let is_number = match saved.inputs.place {
            None => number == i,
            Some(_) => {
                let first = self.bodies.get(number).filter(|_| number <= i);
                first.is_some_and(|first| first.body == saved.body && first.inputs.place.is_some())
            }
        };
        if !is_number {
            return Err(MemoryFault::Reference("bodies of colliders"));
        }
        let inputs = &saved.inputs;
        let place = inputs.place.is_none_or(|(place, center)| {
            place.translation.is_finite() && place.rotation.is_finite() && center.is_finite()
        });
        let vectors = [inputs.position, inputs.inputs.scale, inputs.inputs.center];
        let rotation = inputs.rotation.is_finite() && inputs.rotation.length_squared() > 0.0;
        let sleep = &saved.sleep;
        let rest = sleep.rest_time.is_finite() && sleep.way.is_finite() && sleep.last_way.is_finite();
        if place && rotation && vectors.iter().all(|vector| vector.is_finite()) && rest {
            Ok(())
        } else {
            Err(MemoryFault::Number("states of bodies"))
        }
    }

    /// What decides the place of a collider among others, if they have these keys.
    fn place(&self, i: usize, keys: &[u64]) -> (bool, u64) {
        (self.bodies[i].inputs.inputs.kind != RigidBody::Static, keys[i])
    }

    /// Whether a key is that of a plane.
    fn is_of_plane(&self, key: u64) -> bool {
        key > PLANE_KEY - self.planes.len() as u64
    }

    /// Gives colliders new keys, and renumbers colliders in this memory and in the `manifolds` of the same step.
    /// Forgets everything if two colliders get the same key.
    pub(crate) fn rekey(&mut self, manifolds: &mut Manifolds, new_key: impl Fn(u64) -> u64) {
        let new_key = {
            let planes = self.planes.len() as u64;
            move |key| if key > PLANE_KEY - planes { key } else { new_key(key) }
        };
        let keys: Vec<u64> = self.keys.iter().map(|&key| new_key(key)).collect();
        if keys == self.keys {
            return;
        }
        let mut order: Vec<u32> = (0..keys.len() as u32).collect();
        order.sort_unstable_by_key(|&number| self.place(number as usize, &keys));
        let mut unique = keys.clone();
        unique.sort_unstable();
        if !unique.is_sorted_by(|one, next| one < next) || unique.last().is_some_and(|&key| self.is_of_plane(key)) {
            self.forget();
            manifolds.clear();
            return;
        }
        let mut numbers = vec![0; keys.len()];
        for (now, &before) in (0..).zip(&order) {
            numbers[before as usize] = now;
        }
        // A body has the number of its first collider, which may be another one now.
        let mut first = vec![u32::MAX; keys.len()];
        for (saved, &number) in self.bodies.iter().zip(&numbers) {
            let first = &mut first[saved.body as usize];
            *first = number.min(*first);
        }
        let bodies = order.iter().map(|&before| {
            let saved = self.bodies[before as usize];
            SavedBody {
                body: first[saved.body as usize],
                ..saved
            }
        });
        self.bodies = bodies.collect();
        self.keys = order.iter().map(|&number| keys[number as usize]).collect();
        for pair in &mut self.left_out {
            *pair = pair.map(&new_key);
            pair.sort_unstable();
        }
        self.left_out.sort_unstable();
        self.warm.rekey(new_key);
        renumber(manifolds, &numbers);
    }
}

/// Checks the manifolds of a step with this many colliders and planes.
fn check_manifolds(manifolds: &Manifolds, count: u32, planes: u32) -> Result<(), MemoryFault> {
    let Manifolds {
        pairs,
        points,
        surfaces,
    } = manifolds;
    let is_pair = |[a, b]: [u32; 2]| a < b && a < count && b < count + planes;
    let order = |bodies| pair_order(bodies, count);
    if !pairs.is_sorted_by(|one, next| order(one.bodies) < order(next.bodies)) {
        return Err(MemoryFault::Order("pairs with contact points"));
    }
    for pair in pairs {
        let end = pair.first_point as usize + pair.point_count as usize;
        if !is_pair(pair.bodies) || end > points.len() {
            return Err(MemoryFault::Reference("pairs with contact points"));
        }
    }
    if !surfaces.is_sorted_by(|(one, _), (next, _)| one < next) {
        return Err(MemoryFault::Order("surfaces of pairs"));
    }
    if !surfaces.iter().all(|&(pair, _)| is_pair(pair)) {
        return Err(MemoryFault::Reference("surfaces of pairs"));
    }
    let is_finite = |point: &ManifoldPoint| {
        let vectors = [point.anchors[0], point.anchors[1], point.normal];
        let numbers = [point.separation, point.bulge, point.normal_rotation];
        vectors.iter().all(|vector| vector.is_finite())
            && numbers.iter().all(|number| number.is_finite())
            // A flat surface has an infinite radius.
            && !point.curvature_radii.iter().any(|radius| radius.is_nan())
    };
    let valid = surfaces.iter().all(|(_, surface)| {
        let [friction, restitution] = [surface.friction, surface.restitution];
        friction.is_finite()
            && friction >= 0.0
            && (0.0..=1.0).contains(&restitution)
            && surface.tangent_velocity.is_finite()
    });
    if points.iter().all(is_finite) && valid {
        Ok(())
    } else {
        Err(MemoryFault::Number("contact points"))
    }
}

/// Gives colliders other numbers. Planes, whose numbers follow, keep theirs.
fn renumber(manifolds: &mut Manifolds, numbers: &[u32]) {
    let count = numbers.len() as u32;
    let number_of = |number: u32| numbers.get(number as usize).copied().unwrap_or(number);
    let Manifolds {
        pairs,
        points,
        surfaces,
    } = manifolds;
    for pair in pairs.iter_mut() {
        pair.bodies = pair.bodies.map(number_of);
        if pair.bodies[0] > pair.bodies[1] {
            pair.bodies.reverse();
            let first = pair.first_point as usize;
            for point in &mut points[first..][..pair.point_count as usize] {
                *point = point.flipped();
            }
        }
    }
    pairs.sort_unstable_by_key(|pair| pair_order(pair.bodies, count));
    for (pair, surface) in surfaces.iter_mut() {
        *pair = pair.map(number_of);
        if pair[0] > pair[1] {
            pair.reverse();
            surface.tangent_velocity = -surface.tangent_velocity;
        }
    }
    surfaces.sort_unstable_by_key(|&(pair, _)| pair);
}
