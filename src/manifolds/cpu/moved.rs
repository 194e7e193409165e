//! Contact points that move with the bodies. In a step of several collision substeps a pair that is slower than the fastest
//! ones does not need new points in each: it keeps its points for as long as its surfaces move relative to each other no
//! farther than they may in one collision substep.

use super::kept::RelativePose;
use super::pair::Pair;
use crate::state::{Bodies, ManifoldPoint};
use glam::{DMat3, DVec3};

/// When points that were found earlier in the same step will do.
#[derive(Clone, Copy, Debug)]
pub struct Reuse {
    /// The step in which they must have been found.
    pub step: u64,
    /// The margin within which points are needed now, metres.
    pub margin: f32,
    /// Upper bound of the distance that the surfaces may have moved relative to each other since, metres.
    pub travel: f32,
}

/// The contact points of a pair, and when and where they were found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    points: Vec<ManifoldPoint>,
    /// Some normal rotates as the surfaces slide, until they touch; only the solver knows when.
    has_rotating_normal: bool,
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

impl Found {
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
        self.has_rotating_normal = points.iter().any(|point| point.normal_rotation > 0.0);
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
        let Some(at) = self
            .at
            .as_ref()
            .filter(|_| self.step == reuse.step && !self.has_rotating_normal)
        else {
            return false;
        };
        let motion = at.relative.motion_to(pair, f64::from(self.margin));
        let is_near = |motion: f64| {
            motion <= f64::from(reuse.travel) && motion + f64::from(reuse.margin) <= f64::from(self.margin)
        };
        if !motion.is_some_and(is_near) {
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
    use crate::manifolds::cpu::{Kept, Wanted, add_points};
    use crate::state::Body;
    use crate::state::manifolds::nearest;
    use crate::state::mesh_arena::MeshArena;
    use glam::{Quat, Vec3};

    const MARGIN: f32 = 0.1;

    fn vector(random: &mut fastrand::Rng) -> Vec3 {
        Vec3::from_array([0; 3].map(|_| 2.0 * random.f32() - 1.0))
    }

    /// The points of two bodies, reused if they may be.
    fn points(meshes: &MeshArena, poses: &[(Vec3, Quat); 2], kept: &mut Kept, reuse: Reuse) -> Vec<ManifoldPoint> {
        let mut bodies = Bodies::default();
        for (mesh, (at, turn)) in (0..).zip(poses) {
            bodies
                .push(&Body::at_rest(mesh, *at, *turn, Vec3::ONE), meshes)
                .unwrap();
        }
        let wanted = Wanted {
            pair: MarginPair {
                bodies: [0, 1],
                margin: MARGIN,
            },
            reuse: Some(reuse),
        };
        let mut points = Vec::new();
        assert!(pair_of_bodies(&bodies, meshes, [0, 1]).is_some());
        add_points(&bodies, meshes, &wanted, &mut Worker::default(), kept, 1, &mut points);
        points
    }

    #[test]
    fn points_move_with_their_bodies() {
        let mut meshes = MeshArena::default();
        for shape in [shapes::knot_1120(), shapes::cube(0.8)] {
            meshes.add(CollisionMesh::new(&shape));
        }
        let mut random = fastrand::Rng::with_seed(4);
        let (mut moved, mut compared, mut worst) = (0, 0, 0.0f32);
        for round in 0..600 {
            let mut poses = [0, 1].map(|_| {
                (
                    0.9 * vector(&mut random),
                    Quat::from_scaled_axis(3.0 * vector(&mut random)),
                )
            });
            let step = [1.0e-3, 4.0e-3][round % 2];
            let reuse = Reuse {
                step: 7,
                margin: 0.05,
                travel: 0.02,
            };
            let mut kept = Kept::default();
            let first = points(&meshes, &poses, &mut kept, reuse);
            for (at, turn) in &mut poses {
                *at += step * vector(&mut random);
                *turn = (Quat::from_scaled_axis(step * vector(&mut random)) * *turn).normalize();
            }
            let now = points(&meshes, &poses, &mut kept.clone(), reuse);
            let afresh = points(&meshes, &poses, &mut Kept::default(), reuse);
            let same_faces = now.len() == first.len() && now.iter().zip(&first).all(|(p, q)| p.faces == q.faces);
            assert!(same_faces, "round {round}: they are the points of the first pose");
            moved += usize::from(now != afresh);
            // The nearest point is found at either pose, unless bodies overlap, where points are those of patches.
            if let (Some(p), Some(q)) = (nearest(&now), nearest(&afresh))
                && p.separation > 0.0
                && q.separation > 0.0
            {
                let error = (p.separation - q.separation).abs();
                worst = worst.max(error / step);
                assert!(error < 0.05 * step, "round {round}: {error}");
                compared += 1;
            }
            for other in [
                Reuse { step: 8, ..reuse },
                Reuse {
                    margin: MARGIN,
                    ..reuse
                },
                Reuse { travel: 0.0, ..reuse },
            ] {
                assert_eq!(
                    points(&meshes, &poses, &mut kept.clone(), other),
                    afresh,
                    "round {round}: {other:?}"
                );
            }
        }
        println!("{moved} moved, {compared} compared, worst {worst}");
        assert!(moved > 100 && compared > 20, "{moved} moved, {compared} compared");
    }
}
