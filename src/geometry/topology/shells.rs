//! Orientation by shell: which faces to turn, so that neighbours agree and solids point outward.

use super::{Faces, volume};
use crate::geometry::Aabb;
use crate::geometry::box_tree::BoxTree;
use crate::geometry::crossing::crossing;
use crate::geometry::edges::{Edges, NO_EDGE, is_collapsed};
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// The number of points of a shell that are tested for being inside another. One of them may lie on the other's
/// surface.
const SAMPLES: usize = 5;

/// An open shell has an inside if it encloses, about its middle, more than this part of the volume of a ball of its
/// area. A sheet encloses nearly nothing.
const HOLLOW: f64 = 0.1;

/// Faces that hang together across edges of two faces each.
struct Shell {
    /// Numbers of its faces, in the order in which they were reached.
    faces: Vec<u32>,
    /// Whether its faces agree as they came.
    agrees: bool,
    /// Whether its faces can be made to agree.
    is_orientable: bool,
    /// Whether each edge has an even number of its faces.
    is_closed: bool,
    /// The signed volume once its faces agree.
    volume: f64,
    /// The closed shell directly around it, if it is closed.
    parent: Option<usize>,
}

/// The shells of a mesh.
struct Shells {
    shells: Vec<Shell>,
    /// For each face, whether to turn it.
    turn: Vec<bool>,
}

impl Faces<'_> {
    /// Which faces to turn, so that each shell is consistent and solids point outward; see [`TriMesh::oriented`]. First
    /// the triangles, then the dropped faces.
    ///
    /// [`TriMesh::oriented`]: crate::geometry::TriMesh::oriented
    pub fn faces_to_turn(&self, welded: &[u32]) -> Vec<bool> {
        let mut shells = self.shells(welded);
        shells.find_parents(self, welded);
        shells.turn_outward();
        self.turn_twins(welded, &mut shells.turn);
        shells.turn
    }

    /// A vertex of each closed shell that lies inside another and is wound alike: a solid inside a solid.
    pub fn solids_inside_solids(&self, welded: &[u32]) -> Vec<u32> {
        let mut shells = self.shells(welded);
        shells.find_parents(self, welded);
        let shells = &shells.shells;
        let inside = shells.iter().filter(|shell| {
            let parent = shell.parent.map(|parent| &shells[parent]);
            parent.is_some_and(|parent| parent.volume * shell.volume > 0.0)
        });
        // A closed shell with a volume has a face that was not dropped.
        let first = |shell: &Shell| shell.faces.iter().find_map(|&face| self.triangles.get(face as usize));
        inside.filter_map(first).map(|corners| corners[0]).collect()
    }

    /// The shells, each made consistent. Those whose faces cannot agree are left as they are.
    fn shells(&self, welded: &[u32]) -> Shells {
        let faces: Vec<[u32; 3]> = self.welded_faces(welded).collect();
        let edges = Edges::of(&faces, welded.len());
        let uses = Uses::of(&faces, &edges);
        let mut turn = vec![false; faces.len()];
        let mut reached = vec![false; faces.len()];
        let mut shells = Vec::new();
        // How often the faces of the shell at hand use each edge.
        let mut own_uses = vec![0u32; edges.ends.len()];
        for first in 0..faces.len() as u32 {
            if reached[first as usize] || is_collapsed(faces[first as usize]) {
                continue;
            }
            let mut shell = Shell {
                faces: vec![first],
                agrees: true,
                is_orientable: true,
                is_closed: true,
                volume: 0.0,
                parent: None,
            };
            reached[first as usize] = true;
            let mut next = 0;
            while let Some(&own) = shell.faces.get(next) {
                next += 1;
                for edge in edges.of_triangles[own as usize] {
                    own_uses[edge as usize] += 1;
                    let [a, b] = match uses.at(edge) {
                        [a, b] => [*a, *b],
                        _ => continue,
                    };
                    let other = if a.face == own { b.face } else { a.face };
                    let disagree = a.forward == b.forward;
                    let turned = turn[own as usize] ^ disagree;
                    if !std::mem::replace(&mut reached[other as usize], true) {
                        turn[other as usize] = turned;
                        shell.faces.push(other);
                    } else {
                        shell.is_orientable &= turn[other as usize] == turned;
                    }
                    shell.agrees &= !disagree;
                }
            }
            let own_edges = || shell.faces.iter().flat_map(|&face| edges.of_triangles[face as usize]);
            shell.is_closed = own_edges().all(|edge| own_uses[edge as usize].is_multiple_of(2));
            own_edges().for_each(|edge| own_uses[edge as usize] = 0);
            self.settle(&mut shell, &mut turn, welded);
            shells.push(shell);
        }
        Shells { shells, turn }
    }

    /// Which of the two consistent windings a shell gets, as far as it alone decides; and its volume.
    fn settle(&self, shell: &mut Shell, turn: &mut [bool], welded: &[u32]) {
        if !shell.is_orientable {
            shell.faces.iter().for_each(|&face| turn[face as usize] = false);
            return;
        }
        let place = |v: u32| self.vertices[welded[v as usize] as usize];
        // The faces after the triangles have no area.
        let triangles = |turn: &[bool]| -> Vec<[Vec3; 3]> {
            let own = shell
                .faces
                .iter()
                .filter(|&&face| (face as usize) < self.triangles.len());
            let placed = own.map(|&face| {
                let [a, b, c] = self.triangles[face as usize].map(place);
                if turn[face as usize] { [a, c, b] } else { [a, b, c] }
            });
            placed.collect()
        };
        let count = triangles(turn).len();
        if count == 0 {
            return;
        }
        let middle: DVec3 = triangles(turn).as_flattened().iter().map(|p| p.as_dvec3()).sum();
        let middle = middle / (3 * count) as f64;
        shell.volume = volume(triangles(turn).into_iter(), middle);
        if shell.agrees {
            return;
        }
        // The areas of the faces that are not turned, and of those that are.
        let mut areas = [0.0; 2];
        let own = shell
            .faces
            .iter()
            .filter(|&&face| (face as usize) < self.triangles.len());
        for (&face, [a, b, c]) in own.zip(triangles(turn)) {
            let area = (b - a).as_dvec3().cross((c - a).as_dvec3()).length() * 0.5;
            areas[usize::from(turn[face as usize])] += area;
        }
        let area: f64 = areas.iter().sum();
        let ball = area.powf(1.5) / (6.0 * std::f64::consts::PI.sqrt());
        let reverse = if shell.is_closed || shell.volume.abs() > HOLLOW * ball {
            shell.volume < 0.0
        } else {
            areas[1] > areas[0]
        };
        if reverse {
            shell.reverse(turn);
        }
    }

    /// The corners of a triangle after welding.
    pub fn placed(&self, t: usize, welded: &[u32]) -> [Vec3; 3] {
        self.triangles[t].map(|v| self.vertices[welded[v as usize] as usize])
    }
}

impl Shell {
    fn reverse(&mut self, turn: &mut [bool]) {
        self.faces.iter().for_each(|&face| turn[face as usize] ^= true);
        self.volume = -self.volume;
    }

    /// Whether it encloses a volume.
    fn encloses(&self) -> bool {
        self.is_closed && self.is_orientable && self.volume != 0.0
    }
}

impl Shells {
    /// Finds for each closed shell the one directly around it: the smallest that contains most of a few of its points,
    /// each by the number of times that a ray from there crosses the other shell. Returns the number of shells that
    /// were asked whether a point is inside.
    fn find_parents(&mut self, faces: &Faces, welded: &[u32]) -> usize {
        let shells = &mut self.shells;
        let closed: Vec<usize> = (0..shells.len()).filter(|&shell| shells[shell].encloses()).collect();
        if closed.len() < 2 {
            return 0;
        }
        let count = faces.triangles.len();
        // Faces of a shell that have an area.
        let triangles_of = |shell: &Shell| -> Vec<usize> {
            let own = shell.faces.iter().map(|&face| face as usize);
            own.filter(|&face| face < count).collect()
        };
        let around = |shell: usize| {
            let own = triangles_of(&shells[shell]);
            Aabb::around(own.iter().flat_map(|&t| faces.placed(t, welded)))
        };
        let boxes: Vec<Aabb> = closed.iter().map(|&shell| around(shell)).collect();
        let middles: Vec<Vec3> = boxes.iter().map(|b| b.center()).collect();
        let tree = BoxTree::of_scattered(&middles, |i| boxes[i]);
        // The surfaces of shells that were asked, made when first asked.
        let mut surfaces: BTreeMap<usize, Surface> = BTreeMap::new();
        let mut asked = 0;
        for &own in &closed {
            let triangles = triangles_of(&shells[own]);
            let step = triangles.len().div_ceil(SAMPLES);
            let samples: Vec<usize> = triangles.into_iter().step_by(step).collect();
            let size = |shell: usize| shells[shell].volume.abs();
            let mut votes: BTreeMap<usize, usize> = BTreeMap::new();
            for &t in &samples {
                let p: DVec3 = faces.placed(t, welded).map(|v| v.as_dvec3() / 3.0).iter().sum();
                let contains = |b: &Aabb| p.cmpge(b.min.as_dvec3()).all() && p.cmple(b.max.as_dvec3()).all();
                let mut candidates: Vec<usize> = Vec::new();
                tree.visit(
                    &mut candidates,
                    |_, b| contains(b),
                    |candidates, i| {
                        // Surfaces that cross may each contain points of the other; only the larger can be around the
                        // smaller.
                        if contains(&boxes[i]) && size(closed[i]) > size(own) {
                            candidates.push(closed[i]);
                        }
                    },
                );
                for other in candidates {
                    let surface = surfaces
                        .entry(other)
                        .or_insert_with(|| Surface::of(triangles_of(&shells[other]), faces, welded));
                    asked += 1;
                    if surface.contains(p, faces, welded) {
                        *votes.entry(other).or_default() += 1;
                    }
                }
            }
            let around = votes.into_iter().filter(|(_, votes)| 2 * votes > samples.len());
            let parent = around
                .map(|(other, _)| other)
                .min_by(|&a, &b| size(a).total_cmp(&size(b)));
            shells[own].parent = parent;
        }
        asked
    }

    /// Turns solids outward, with all that lies inside them, unless the mesh is a room.
    fn turn_outward(&mut self) {
        let (shells, turn) = (&mut self.shells, &mut self.turn);
        let is_outermost = |shell: &&Shell| shell.encloses() && shell.parent.is_none();
        let is_room = shells
            .iter()
            .filter(is_outermost)
            .all(|shell| shell.agrees && shell.volume < 0.0);
        if is_room {
            return;
        }
        let roots: Vec<usize> = (0..shells.len()).map(|own| root(shells, own)).collect();
        let reversed: Vec<bool> = (roots
            .iter()
            .map(|&root| shells[root].encloses() && shells[root].volume < 0.0))
        .collect();
        // Larger shells come first, so that a cavity sees the final winding of what is around it.
        let mut order: Vec<usize> = (0..shells.len()).collect();
        order.sort_by(|&a, &b| {
            shells[b]
                .volume
                .abs()
                .total_cmp(&shells[a].volume.abs())
                .then(a.cmp(&b))
        });
        for own in order {
            // What disagreed has no winding of its own: inside another shell it is a cavity.
            let alike = shells[own]
                .parent
                .is_some_and(|parent| shells[parent].volume * shells[own].volume > 0.0);
            let reverse = if shells[own].agrees { reversed[own] } else { alike };
            if reverse {
                shells[own].reverse(turn);
            }
        }
    }
}

/// The outermost shell around a shell, or itself.
fn root(shells: &[Shell], mut own: usize) -> usize {
    while let Some(parent) = shells[own].parent {
        own = parent;
    }
    own
}

/// The triangles of a closed shell.
struct Surface {
    triangles: Vec<usize>,
    tree: BoxTree,
}

impl Surface {
    fn of(triangles: Vec<usize>, faces: &Faces, welded: &[u32]) -> Self {
        let middle = |&t: &usize| faces.placed(t, welded).iter().map(|p| *p / 3.0).sum();
        let middles: Vec<Vec3> = triangles.iter().map(middle).collect();
        let tree = BoxTree::of_scattered(&middles, |i| Aabb::around(faces.placed(triangles[i], welded)));
        Self { triangles, tree }
    }

    /// Whether the ray from a point along +z crosses it an odd number of times.
    fn contains(&self, p: DVec3, faces: &Faces, welded: &[u32]) -> bool {
        let met = |_: &_, b: &Aabb| {
            let (low, high) = (b.min.as_dvec3(), b.max.as_dvec3());
            low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y && p.z <= high.z
        };
        let mut crossed = false;
        self.tree.visit(&mut crossed, met, |crossed, i| {
            let corners = faces.placed(self.triangles[i], welded).map(|v| v.as_dvec3() - p);
            *crossed ^= crossing(&corners).is_some();
        });
        crossed
    }
}

/// A face that uses an edge.
#[derive(Clone, Copy, Default)]
struct Use {
    face: u32,
    /// Whether it runs along the edge from its first end.
    forward: bool,
}

/// The faces of all edges.
struct Uses {
    /// For each edge, the start of its faces; one more entry marks the end.
    starts: Vec<u32>,
    uses: Vec<Use>,
}

impl Uses {
    /// Faces that collapsed use no edge.
    fn of(faces: &[[u32; 3]], edges: &Edges) -> Self {
        let sides = || {
            let whole = (0..)
                .zip(faces)
                .zip(&edges.of_triangles)
                .filter(|((_, face), _)| !is_collapsed(**face));
            whole.flat_map(|((number, face), edges)| (0..3).map(move |k| (number, face[k], edges[k] as usize)))
        };
        let mut starts = vec![0; edges.ends.len() + 1];
        for (_, _, edge) in sides() {
            starts[edge + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut uses = vec![Use::default(); starts[edges.ends.len()] as usize];
        for (face, from, edge) in sides() {
            uses[next[edge] as usize] = Use {
                face,
                forward: edges.ends[edge][0] == from,
            };
            next[edge] += 1;
        }
        Self { starts, uses }
    }

    fn at(&self, edge: u32) -> &[Use] {
        debug_assert_ne!(edge, NO_EDGE);
        &self.uses[self.starts[edge as usize] as usize..self.starts[edge as usize + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{TriMesh, shapes};

    /// How often a shell was asked whether it contains a point, and the shells with one around them.
    fn asked(mesh: &TriMesh) -> (usize, usize) {
        let welded: Vec<u32> = mesh.welded().to_vec();
        let faces = Faces {
            vertices: mesh.vertices(),
            triangles: mesh.triangles(),
            face_ids: mesh.face_ids(),
            dropped: &[],
            twins: &[],
        };
        let mut shells = faces.shells(&welded);
        let asked = shells.find_parents(&faces, &welded);
        (
            asked,
            shells.shells.iter().filter(|shell| shell.parent.is_some()).count(),
        )
    }

    fn balls(places: impl Iterator<Item = (Vec3, f32)>) -> TriMesh {
        let ball = shapes::ball(1.0, 1);
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for (at, size) in places {
            let first = vertices.len() as u32;
            vertices.extend(ball.vertices().iter().map(|p| *p * size + at));
            faces.extend(ball.triangles().iter().map(|t| t.map(|v| v + first)));
        }
        TriMesh::new(vertices, faces).unwrap()
    }

    #[test]
    fn shells_above_each_other_are_not_compared() {
        let column = |count: usize| balls((0..count).map(|i| (Vec3::Z * 3.0 * i as f32, 1.0)));
        assert_eq!(asked(&column(50)), (0, 0));
    }

    #[test]
    fn each_shell_in_a_box_is_compared_with_that_alone() {
        let small = (0..50).map(|i| (Vec3::Z * (i as f32 - 25.0), 0.3));
        let mesh = balls(small.chain([(Vec3::ZERO, 100.0)]));
        assert_eq!(asked(&mesh), (50 * SAMPLES, 50));
    }
}
