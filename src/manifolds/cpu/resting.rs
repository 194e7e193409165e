//! The features of pairs at rest, which are not searched in each step.
//!
//! A pair whose surfaces hardly move is searched at the nearest pose of a fine grid. Until it leaves this cell, it has
//! the features that were found there, and only their points and normals are computed anew. Which features these are
//! depends on the present pose alone, not on earlier ones. So what is kept here saves work and changes no result: a
//! snapshot has nothing of it.

use super::arrival::{Arrival, PairMotion};
use super::feature::{Feature, Origin, TrianglePair};
use super::kept::{Kept, RelativePose};
use super::pair::{Pair, Worker};
use super::side::Triangle;
use crate::state::{Frame, PlacedMesh};
use glam::{DMat3, DQuat, DVec3};

/// Edge of a cell, in units of the smaller body's diameter. The gap between bodies at rest is larger than any motion
/// within a cell, so surfaces do not cross on the way.
const CELL: f64 = 1.0 / 8192.0;
/// Step of the components of the relative rotation. A point of the smaller body moves about as far with it as within a
/// cell.
const TURN: f64 = 0.25 * CELL;
/// Surfaces of a pair at rest move by less than this in a step, in cells.
const REST: f64 = 0.5;
/// Margins are rounded up to multiples of this part of the margin of pairs without motion.
const MARGIN: f32 = 0.125;
/// A feature is computed anew as it was found if the two normals differ by less than this.
const SAME_NORMAL: f64 = 1.0e-9;

/// Components of the direction that decides between the two quaternions of a rotation. No common rotation is
/// perpendicular to it.
const SIGN: DQuat = DQuat::from_xyzw(0.607, 0.431, 0.283, 0.805);

/// How little a pair moves.
#[derive(Clone, Copy, Debug)]
pub struct Rest {
    /// The margin of the pair without motion, metres.
    pub margin: f32,
    /// Upper bound of the motion of its surfaces relative to each other in the step, metres.
    pub travel: f32,
}

/// The features of a pair in a cell.
#[derive(Clone, Debug, Default)]
pub struct RestingFeatures {
    /// The cell, and the pair at its pose.
    found_at: Option<(Cell, RelativePose)>,
    /// The reduced features; `None` if they cannot be computed anew.
    features: Option<Vec<Identity>>,
}

/// A pose of the grid, and a margin: the place of the smaller body in the axes of the larger one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cell {
    center: [i64; 3],
    rotation: [i64; 4],
    margin: f32,
}

/// What a feature is derived from.
#[derive(Clone, Copy, Debug)]
struct Identity {
    triangles: [u32; 2],
    origin: Origin,
}

/// A pair that may be at rest.
pub struct RestingPair<'a> {
    pub pair: &'a Pair<'a>,
    /// Its two bodies.
    pub placed: [&'a PlacedMesh<'a>; 2],
    /// The margin within which features are wanted, metres.
    pub margin: f32,
    pub rest: &'a Rest,
    /// How the bodies move; `None` if all features count.
    pub motion: Option<&'a PairMotion>,
}

impl RestingPair<'_> {
    /// Finds the features, in [`Worker::resting`]. Returns `false` if the pair must be searched where it is.
    pub fn find(&self, worker: &mut Worker, kept: &mut Kept, threads: usize) -> bool {
        let &Self {
            pair,
            placed,
            margin,
            rest,
            motion,
        } = self;
        if !rest.is_rest_of(pair, margin) {
            return false;
        }
        let cell = Cell::of(pair, margin, rest);
        if !kept.resting.is_at(&cell, pair) {
            let frames = cell.frames(pair, placed);
            let [a, b] = [0, 1].map(|i| PlacedMesh {
                frame: &frames[i],
                ..*placed[i]
            });
            let at_cell = Pair::new([&a, &b]);
            let found = worker.reduced(&at_cell, cell.margin, kept, threads);
            kept.resting.set(cell, &at_cell, found);
        }
        let is_complete = kept.resting.compute(pair, margin, &mut worker.resting);
        // Points that may miss the surface are searched for.
        is_complete
            && motion.is_none_or(|motion| {
                let arrival = Arrival::new(pair, motion);
                worker.resting.iter().all(|feature| arrival.is_certain(feature))
            })
    }
}

impl Rest {
    /// Whether this pair is at rest, and of a kind whose features can be computed anew.
    fn is_rest_of(&self, pair: &Pair, margin: f32) -> bool {
        f64::from(self.travel) <= REST * CELL * pair.size
            && self.margin > 0.0
            && margin.is_finite()
            && pair
                .sides
                .iter()
                .all(|side| side.rounding == 0.0 && side.features.one_sided.all())
    }
}

impl Cell {
    /// The cell of a pair.
    fn of(pair: &Pair, margin: f32, rest: &Rest) -> Self {
        let unit = MARGIN * rest.margin;
        let (center, rotation) = smaller_in_larger(pair);
        let rotation = DQuat::from_mat3(&rotation);
        let rotation = if rotation.dot(SIGN) < 0.0 { -rotation } else { rotation };
        Self {
            center: (center / (CELL * pair.size)).to_array().map(|x| x.round() as i64),
            rotation: rotation.to_array().map(|x| (x / TURN).round() as i64),
            margin: (margin / unit).ceil() * unit,
        }
    }

    /// The frames of both bodies at the pose of the grid.
    fn frames(&self, pair: &Pair, placed: [&PlacedMesh; 2]) -> [Frame; 2] {
        let center = DVec3::from_array(self.center.map(|x| x as f64)) * (CELL * pair.size);
        let rotation = DQuat::from_array(self.rotation.map(|x| x as f64)).normalize();
        let larger = larger(pair);
        [0, 1].map(|i| {
            let PlacedMesh { mesh, frame, .. } = placed[i];
            let arm = frame.scale * mesh.mass.center.as_dvec3();
            let (center, rotation) = if i == larger {
                (DVec3::ZERO, DQuat::IDENTITY)
            } else {
                (center, rotation)
            };
            Frame::new(center - rotation * arm, rotation, frame.scale, mesh.mass.center)
        })
    }
}

/// Which body of a pair is the larger one. A point where the two touch is never far from the centre of the other.
fn larger(pair: &Pair) -> usize {
    usize::from(pair.radii[0] < pair.radii[1])
}

/// The centre and the rotation of the smaller body in the axes of the larger one.
fn smaller_in_larger(pair: &Pair) -> (DVec3, DMat3) {
    let (center, rotation) = (pair.sides[1].center, pair.relative_rotation);
    if larger(pair) == 0 {
        (center, rotation)
    } else {
        let back = rotation.transpose();
        (-(back * center), back)
    }
}

impl RestingFeatures {
    /// Forgets the features.
    pub fn clear(&mut self) {
        self.found_at = None;
    }

    fn is_at(&self, cell: &Cell, pair: &Pair) -> bool {
        self.found_at
            .as_ref()
            .is_some_and(|(found_at, pose)| found_at == cell && pose.is_of(pair))
    }

    /// Keeps the features of a pair in a cell.
    fn set(&mut self, cell: Cell, at_cell: &Pair, found: &[Feature]) {
        let mut features = self.features.take().unwrap_or_default();
        features.clear();
        features.extend(found.iter().map(|feature| Identity {
            triangles: feature.triangles,
            origin: feature.origin,
        }));
        let lasts = features.iter().zip(found).all(|(identity, found)| {
            let again = identity.compute(at_cell);
            again.is_some_and(|again| again.normal.dot(found.normal) > 1.0 - SAME_NORMAL)
        });
        self.features = lasts.then_some(features);
        self.found_at = Some((cell, RelativePose::of(at_cell)));
    }

    /// Writes the features within the margin as they are now. Returns `false` if they cannot be computed anew.
    fn compute(&self, pair: &Pair, margin: f32, to: &mut Vec<Feature>) -> bool {
        to.clear();
        let Some(features) = &self.features else {
            return false;
        };
        for identity in features {
            let Some(feature) = identity.compute(pair) else {
                return false;
            };
            if feature.separation <= f64::from(margin) {
                to.push(feature);
            }
        }
        true
    }
}

impl Identity {
    /// The feature at the pose of a pair; `None` if it must be searched.
    fn compute(&self, pair: &Pair) -> Option<Feature> {
        let triangles: [Triangle; 2] = [0, 1].map(|i| pair.sides[i].triangle(self.triangles[i]));
        let both = TrianglePair::new(&pair.sides, triangles.each_ref(), f64::INFINITY)?;
        match self.origin {
            Origin::Vertex { side, vertex } => {
                let side = usize::from(side);
                let own = pair.sides[side].features.triangles[self.triangles[side] as usize];
                Some(both.vertex_over_plane(side, own.iter().position(|&v| v == vertex)?))
            }
            Origin::Edges(places) => both.edge_lines(places.map(usize::from)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::shapes;
    use crate::manifolds::MarginPair;
    use crate::manifolds::cpu::{PairRequest, add_points, placed_bodies};
    use crate::state::mesh_arena::MeshArena;
    use crate::state::{Bodies, Body, ManifoldPoint};
    use crate::testing::scenes::any_vector;
    use glam::{Quat, Vec3};

    const MARGIN: f32 = 0.02;

    fn bodies(meshes: &MeshArena, mesh: [u32; 2], poses: [(Vec3, Quat); 2]) -> Bodies {
        let mut bodies = Bodies::default();
        for (mesh, (at, turn)) in mesh.into_iter().zip(poses) {
            bodies.push(&Body::at_rest(mesh, at, turn, Vec3::ONE), meshes).unwrap();
        }
        bodies
    }

    fn points(bodies: &Bodies, meshes: &MeshArena, rest: Option<Rest>, kept: &mut Kept) -> (Vec<ManifoldPoint>, usize) {
        let request = PairRequest {
            pair: MarginPair {
                bodies: [0, 1],
                margin: MARGIN,
            },
            reuse: None,
            motion: None,
            rest,
        };
        let (mut worker, mut points) = (Worker::default(), Vec::new());
        add_points(bodies, meshes, &request, &mut worker, kept, 1, &mut points);
        (points, worker.searches)
    }

    fn depth(points: &[ManifoldPoint]) -> f32 {
        points.iter().map(|point| point.separation).fold(MARGIN, f32::min)
    }

    /// Bodies that lie on each other and move by less than a cell a step, as those of a pile do.
    #[test]
    fn points_of_pairs_at_rest_depend_on_the_pose_alone() {
        let mut meshes = MeshArena::default();
        for shape in [
            shapes::cube(1.0),
            shapes::torus_240(),
            shapes::knot_1120(),
            shapes::cube(8.0),
        ] {
            meshes.add(CollisionMesh::new(&shape));
        }
        let mut random = fastrand::Rng::with_seed(3);
        let (mut calls, mut searches, mut with_points, mut error) = (0, 0, 0, 0.0f32);
        for round in 0..120 {
            let mesh = [[0, 0], [0, 3], [3, 0], [1, 0], [2, 1]][round % 5];
            let mut vector = || any_vector(&mut || random.f32());
            let turn = if round % 2 == 0 {
                Quat::IDENTITY
            } else {
                Quat::from_scaled_axis(3.0 * vector())
            };
            let start = (50.0 * vector(), Quat::from_scaled_axis(3.0 * vector()));
            let way = start.1 * (Vec3::new(0.3, 0.0, 0.2) * vector() + Vec3::Y);
            // The second body comes as near as to touch.
            let placed = |distance: f32| [start, (start.0 + way * distance, start.1 * turn)];
            let mut distance = [2.0, 9.0][usize::from(mesh.contains(&3))];
            for _ in 0..1000 {
                let bodies = bodies(&meshes, mesh, placed(distance));
                let (found, _) = points(&bodies, &meshes, None, &mut Kept::default());
                if depth(&found) < 1.0e-3 {
                    break;
                }
                distance -= 0.5 * depth(&found) + 1.0e-4;
            }
            let mut poses = placed(distance);
            let mut kept = Kept::default();
            for _ in 0..20 {
                let step = 1.0e-5 * any_vector(&mut || random.f32());
                poses[1].0 += step;
                poses[1].1 = (Quat::from_scaled_axis(step) * poses[1].1).normalize();
                let bodies = bodies(&meshes, mesh, poses);
                let rest = Some(Rest {
                    margin: 0.01,
                    travel: 1.0e-5,
                });
                let (now, own) = points(&bodies, &meshes, rest, &mut kept);
                let (afresh, _) = points(&bodies, &meshes, rest, &mut Kept::default());
                assert_eq!(now, afresh, "round {round}");
                let (exact, _) = points(&bodies, &meshes, None, &mut Kept::default());
                assert_eq!(now.is_empty(), exact.is_empty(), "round {round}");
                error = error.max((depth(&now) - depth(&exact)).abs());
                calls += 1;
                searches += own;
                with_points += usize::from(!now.is_empty());
            }
        }
        println!("{searches} searches in {calls} calls, {with_points} with points, depth within {error} m");
        assert!(with_points > calls / 2 && 2 * searches < calls, "{searches} of {calls}");
        assert!(error < 1.0e-4, "{error} m");
    }

    #[test]
    fn a_cell_holds_the_pose() {
        let mut meshes = MeshArena::default();
        for shape in [shapes::cube(1.0), shapes::cube(8.0)] {
            meshes.add(CollisionMesh::new(&shape));
        }
        let mut random = fastrand::Rng::with_seed(4);
        for round in 0..1000 {
            let mut vector = || any_vector(&mut || random.f32());
            let poses = [0, 1].map(|_| (10.0 * vector(), Quat::from_scaled_axis(4.0 * vector())));
            let bodies = bodies(&meshes, [[0, 1], [1, 0]][round % 2], poses);
            let placed = placed_bodies(&bodies, &meshes, [0, 1]).unwrap();
            let pair = Pair::new(placed.each_ref());
            let rest = Rest {
                margin: 0.01,
                travel: 0.0,
            };
            let frames = Cell::of(&pair, MARGIN, &rest).frames(&pair, placed.each_ref());
            let relative = frames[0].rotation.transpose() * frames[1].rotation;
            let center = frames[0].rotation.transpose() * (frames[1].center - frames[0].center);
            assert!(
                (relative - pair.relative_rotation).abs_diff_eq(DMat3::ZERO, 4.0 * TURN),
                "round {round}"
            );
            // The larger body's axes are those of the grid.
            let way = smaller_in_larger(&pair).0.length() * 4.0 * TURN;
            let error = center.distance(pair.sides[1].center);
            assert!(error < CELL * pair.size + way, "round {round}: {error}");
        }
    }
}
