//! Contact points that move with the bodies.
//!
//! The points of bodies that overlap deeply are expensive to find, and need not be exact: they only push the bodies
//! apart. So in a step of several collision substeps such a pair keeps its points until its surfaces have moved
//! relative to each other about twice as far as they may in one collision substep. Until then other surfaces of the
//! pair may come near without having points. Other pairs do not keep theirs: a corner that comes over a face has a
//! point that it did not have when it was beside it.

use super::kept::RelativePose;
use super::pair::Pair;
use crate::state::{Bodies, ManifoldPoint};
use glam::{DMat3, DVec3};

/// When points that were found earlier in the same step will do.
#[derive(Clone, Copy, Debug)]
pub struct Reuse {
    /// The step in which they must have been found.
    pub step: u64,
    /// Upper bound of the distance that the surfaces may have moved relative to each other since, metres.
    pub travel: f32,
    /// Lower bound of the pair's overlap, metres.
    pub depth: f32,
}

/// The contact points of a pair, and when and where they were found.
#[derive(Clone, Debug, Default)]
pub struct CachedPoints {
    points: Vec<ManifoldPoint>,
    /// The deepest overlap, metres.
    depth: f32,
    step: u64,
    margin: f32,
    at: Option<Poses>,
}

/// The poses of both bodies.
#[derive(Clone, Debug)]
struct Poses {
    relative: RelativePose,
    rotations: [DMat3; 2],
    /// From the centre of mass of the first body to that of the second.
    center_offset: DVec3,
    /// From each body's centre of mass to that of its collider.
    offsets: [DVec3; 2],
}

impl Poses {
    fn of(pair: &Pair, bodies: &Bodies, [a, b]: [u32; 2]) -> Self {
        let [a, b] = [a, b].map(|i| &bodies.frame[i as usize]);
        Self {
            relative: RelativePose::of(pair),
            rotations: [a.rotation, b.rotation],
            center_offset: b.body_center - a.body_center,
            offsets: [a.offset(), b.offset()],
        }
    }
}

impl CachedPoints {
    /// Forgets the points and keeps their memory.
    pub fn clear(&mut self) {
        self.at = None;
    }

    /// Remembers the points of a pair, for use in the same step.
    pub fn set(
        &mut self,
        pair: &Pair,
        bodies: &Bodies,
        numbers: [u32; 2],
        margin: f32,
        step: u64,
        points: &[ManifoldPoint],
    ) {
        self.points.clear();
        self.points.extend_from_slice(points);
        self.depth = points.iter().fold(0.0, |depth, point| depth.max(-point.separation));
        (self.step, self.margin) = (step, margin);
        self.at = Some(Poses::of(pair, bodies, numbers));
    }

    /// Appends the points as they have moved with the bodies, if they will do. Tells whether it did.
    pub fn move_to(
        &self,
        pair: &Pair,
        bodies: &Bodies,
        numbers: [u32; 2],
        reuse: &Reuse,
        points: &mut Vec<ManifoldPoint>,
    ) -> bool {
        let is_usable = self.step == reuse.step && self.depth >= reuse.depth;
        let Some(at) = self.at.as_ref().filter(|_| is_usable) else {
            return false;
        };
        let motion = at.relative.motion_to(pair, f64::from(self.margin));
        if motion.is_none_or(|motion| motion > f64::from(reuse.travel)) {
            return false;
        }
        let now = Poses::of(pair, bodies, numbers);
        let turns = [0, 1].map(|i| (now.rotations[i] * at.rotations[i].transpose() - DMat3::IDENTITY).as_mat3());
        let travel = (now.center_offset - at.center_offset).as_vec3();
        let offsets = at.offsets.map(|offset| offset.as_vec3());
        points.extend(self.points.iter().map(|point| {
            let [a, b] = point.curvature_centers(offsets);
            let changes = [turns[0] * a, turns[1] * b];
            let displacement = travel + changes[1] - changes[0];
            ManifoldPoint {
                anchors: [point.anchors[0] + changes[0], point.anchors[1] + changes[1]],
                separation: point.separation + point.normal.dot(displacement),
                ..*point
            }
        }));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::pair::Worker;
    use super::super::pair_of_bodies;
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::shapes;
    use crate::manifolds::MarginPair;
    use crate::manifolds::cpu::{Kept, PairRequest, add_points};
    use crate::state::Body;
    use crate::state::mesh_arena::MeshArena;
    use crate::testing::scenes::any_vector;
    use glam::{Quat, Vec3};

    const MARGIN: f32 = 0.1;

    /// The points of two bodies, reused if they may be.
    fn points(meshes: &MeshArena, poses: &[(Vec3, Quat); 2], kept: &mut Kept, reuse: Reuse) -> Vec<ManifoldPoint> {
        let mut bodies = Bodies::default();
        for (mesh, (at, turn)) in (0..).zip(poses) {
            bodies
                .push(&Body::at_rest(mesh, *at, *turn, Vec3::ONE), meshes)
                .unwrap();
        }
        let request = PairRequest {
            pair: MarginPair {
                bodies: [0, 1],
                margin: MARGIN,
            },
            reuse: Some(reuse),
            motion: None,
            rest: None,
        };
        let mut points = Vec::new();
        assert!(pair_of_bodies(&bodies, meshes, [0, 1]).is_some());
        add_points(&bodies, meshes, &request, &mut Worker::default(), kept, 1, &mut points);
        points
    }

    #[test]
    fn points_of_deep_overlaps_move_with_their_bodies() {
        let mut meshes = MeshArena::default();
        for shape in [shapes::knot_1120(), shapes::cube(0.8)] {
            meshes.add(CollisionMesh::new(&shape));
        }
        let centers = [0, 1].map(|mesh| meshes.get(mesh).unwrap().mesh.mass.center);
        let mut random = fastrand::Rng::with_seed(4);
        let (mut moved, mut shallow) = (0, 0);
        for round in 0..300 {
            let before = [0, 1].map(|_| {
                let turn = Quat::from_scaled_axis(3.0 * any_vector(&mut || random.f32()));
                (0.5 * any_vector(&mut || random.f32()), turn)
            });
            let reuse = Reuse {
                step: 7,
                travel: 0.02,
                depth: 0.01,
            };
            let mut kept = Kept::default();
            let first = points(&meshes, &before, &mut kept, reuse);
            let step = [1.0e-3, 4.0e-3][round % 2];
            let after = before.map(|(at, turn)| {
                let turned = Quat::from_scaled_axis(step * any_vector(&mut || random.f32())) * turn;
                (at + step * any_vector(&mut || random.f32()), turned.normalize())
            });
            let now = points(&meshes, &after, &mut kept.clone(), reuse);
            let afresh = points(&meshes, &after, &mut Kept::default(), reuse);
            if first.iter().all(|point| point.separation > -reuse.depth) {
                assert_eq!(now, afresh, "round {round}");
                shallow += 1;
                continue;
            }
            assert_eq!(now.len(), first.len(), "round {round}");
            for (p, q) in first.iter().zip(&now) {
                if p.curvature_radii
                    .iter()
                    .any(|&radius| radius > 0.0 && radius.is_finite())
                {
                    continue;
                }
                let ways = [0, 1].map(|i| {
                    let local = centers[i] + before[i].1.inverse() * p.anchors[i];
                    let place = |(at, turn): (Vec3, Quat)| at + turn * local;
                    place(after[i]) - place(before[i])
                });
                let separation = p.separation + p.normal.dot(ways[1] - ways[0]);
                assert!((q.separation - separation).abs() < 1.0e-5, "round {round}: {q:?}");
                moved += 1;
            }
            for other in [Reuse { step: 8, ..reuse }, Reuse { travel: 0.0, ..reuse }] {
                let found = points(&meshes, &after, &mut kept.clone(), other);
                assert_eq!(found, afresh, "round {round}: {other:?}");
            }
        }
        println!("{moved} points moved, {shallow} pairs were not deep");
        assert!(moved > 100 && shallow > 20, "{moved} moved, {shallow} shallow");
    }
}
