//! A search with wide spheres serves all collision substeps of a step, as long as the spheres of each are within the
//! wide ones.

use super::grid::SPHERE_SLACK;
use crate::state::Bodies;
use glam::Vec3;

/// Allowance for rounding, in units of a sphere's radius and of its distance from the origin.
const ROUNDING: f32 = 1.0e-6;

/// The spheres and pairs of a search.
#[derive(Default)]
pub(crate) struct WideSearch {
    /// Number of bodies.
    count: usize,
    /// Spheres of moving bodies.
    centers: Vec<Vec3>,
    radii: Vec<f32>,
    pairs: Vec<[u32; 2]>,
}

impl WideSearch {
    /// Forgets the search.
    pub fn clear(&mut self) {
        self.count = 0;
        self.centers.clear();
        self.radii.clear();
        self.pairs.clear();
    }

    /// Keeps what a search of these bodies has found: all pairs, ascending.
    pub fn set(&mut self, bodies: &Bodies, pairs: &[[u32; 2]]) {
        self.clear();
        self.count = bodies.len();
        self.centers.extend(bodies.movers().map(|i| bodies.center[i]));
        self.radii.extend(bodies.movers().map(|i| bodies.speculative_radius[i]));
        self.pairs.extend_from_slice(pairs);
    }

    /// Writes the pairs whose speculative spheres overlap now into `sphere_pairs`, as a new search would. Returns
    /// whether the wide search holds all of them; if not, the list is left as it is.
    pub fn find(&self, bodies: &Bodies, sphere_pairs: &mut Vec<[u32; 2]>) -> bool {
        if self.count != bodies.center.len() || self.count == 0 {
            return false;
        }
        // Spheres that all move alike overlap as before.
        let all_move = self.centers.len() == self.count;
        let holds = self.holds(bodies, Vec3::ZERO) || all_move && self.holds(bodies, self.common_travel(bodies));
        if !holds {
            return false;
        }
        sphere_pairs.clear();
        let overlaps = |&[a, b]: &[u32; 2]| {
            let [a, b] = [a, b].map(|i| i as usize);
            let reach = bodies.speculative_radius[a] + bodies.speculative_radius[b];
            let square = bodies.center[a].distance_squared(bodies.center[b]);
            square <= reach * reach * SPHERE_SLACK
        };
        sphere_pairs.extend(self.pairs.iter().copied().filter(overlaps));
        true
    }

    /// Whether all spheres of bodies that move, moved back by `travel`, are within those of the search.
    fn holds(&self, bodies: &Bodies, travel: Vec3) -> bool {
        let now = bodies.movers();
        now.zip(self.centers.iter().zip(&self.radii))
            .all(|(i, (wide_center, wide_radius))| {
                let (center, radius) = (bodies.center[i], bodies.speculative_radius[i]);
                let way = (center - travel).distance(*wide_center);
                let rounding = ROUNDING * (wide_radius + center.abs().max_element());
                // False for NaN.
                let way = if way == 0.0 { way } else { way + rounding };
                way + radius <= *wide_radius
            })
    }

    /// The middle of all ways since the search.
    fn common_travel(&self, bodies: &Bodies) -> Vec3 {
        let ways = bodies
            .movers()
            .zip(&self.centers)
            .map(|(i, then)| bodies.center[i] - *then);
        let bounds = ways.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), way| {
            (low.min(way), high.max(way))
        });
        0.5 * (bounds.0 + bounds.1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Scratch, run};
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::shapes;
    use crate::state::Body;
    use crate::state::mesh_arena::MeshArena;
    use crate::testing::scenes::any_vector;
    use crate::types::body::RigidBody;
    use glam::Quat;

    fn cloud(random: &mut fastrand::Rng) -> Bodies {
        let mut meshes = MeshArena::default();
        let slot = meshes.add(CollisionMesh::new(&shapes::cube(1.0)));
        let mut bodies = Bodies::default();
        for _ in 0..400 {
            let at = 9.0 * any_vector(&mut || random.f32());
            let body = Body::at_rest(slot, at, Quat::IDENTITY, Vec3::splat(0.2 + random.f32()));
            bodies.push(&body, &meshes).unwrap();
        }
        for kind in bodies.kind.iter_mut().step_by(7) {
            *kind = RigidBody::Static;
        }
        bodies.speculative_radius = bodies.radius.clone();
        bodies
    }

    #[test]
    fn a_wide_search_gives_the_pairs_of_a_new_one() {
        let mut random = fastrand::Rng::with_seed(4);
        let (mut scratch, mut wide) = (Scratch::default(), WideSearch::default());
        let (mut all, mut found, mut afresh) = (Vec::new(), Vec::new(), Vec::new());
        let (mut fewer, mut lost) = (0, 0);
        for round in 0..60 {
            let mut bodies = cloud(&mut random);
            if round % 2 == 1 {
                bodies.kind.fill(RigidBody::Dynamic);
            }
            let moving: Vec<usize> = (0..400).filter(|&i| bodies.kind[i] != RigidBody::Static).collect();
            moving.iter().for_each(|&i| bodies.speculative_radius[i] += 0.3);
            run(&bodies, usize::MAX, &mut scratch, &mut all);
            wide.set(&bodies, &all);
            // Without static bodies all move alike by far, and each by itself; in every third round some by too much.
            let common = 50.0 * any_vector(&mut || random.f32()) * (round % 2) as f32;
            let most = if round % 3 == 0 { 0.4 } else { 0.14 };
            for i in moving {
                bodies.center[i] += common + most * any_vector(&mut || random.f32());
                bodies.speculative_radius[i] = bodies.radius[i] + 0.01;
            }
            run(&bodies, usize::MAX, &mut scratch, &mut afresh);
            if wide.find(&bodies, &mut found) {
                assert_eq!(found, afresh, "round {round}");
                fewer += usize::from(found.len() < all.len());
            } else {
                lost += 1;
            }
        }
        assert!(fewer >= 30 && lost >= 10, "{fewer} {lost}");
    }

    #[test]
    fn without_a_search_of_as_many_bodies_nothing_is_known() {
        let mut bodies = cloud(&mut fastrand::Rng::with_seed(1));
        let (mut wide, mut found) = (WideSearch::default(), vec![[0, 1]]);
        assert!(!wide.find(&bodies, &mut found));
        wide.set(&bodies, &[]);
        bodies.center.truncate(10);
        assert!(!wide.find(&bodies, &mut found));
        assert_eq!(found, [[0, 1]]);
    }
}
