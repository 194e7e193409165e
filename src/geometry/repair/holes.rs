//! Holes: loops of boundary edges, and the triangles that close them.

use super::Work;
use super::fill::cost;
use super::large::fill_any;
use super::surface::{CountedEdges, Surface};
use crate::geometry::edges::is_collapsed;
use glam::{DVec3, Vec3};
use serde::Serialize;
use std::collections::{HashMap, HashSet};

/// Why a hole was not closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WhyLeft {
    /// It has more edges than were asked for.
    TooLong,
    /// Its edges form no loop: their faces disagree about the winding, or more than two meet at an edge.
    NoLoop,
    /// There are no triangles between its vertices that have an area and are not there yet.
    NoTriangles,
}

impl WhyLeft {
    /// The reason, as the end of a sentence.
    pub fn text(self) -> &'static str {
        match self {
            Self::TooLong => "it has more edges than asked for",
            Self::NoLoop => {
                "its edges form no loop: faces disagree about the winding, or more than two meet at an edge"
            }
            Self::NoTriangles => "no triangles fit in it",
        }
    }
}

/// A hole that was not closed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LeftHole {
    /// Why.
    pub why: WhyLeft,
    /// The number of its boundary edges.
    pub edges: usize,
    /// One of its vertices, in mesh space.
    pub position: [f32; 3],
}

/// Boundary edges, directed against the faces they belong to, so that faces that close the hole run along them.
struct Rim {
    edges: Vec<[u32; 2]>,
    /// The edges that begin at each vertex.
    at: HashMap<u32, Vec<usize>>,
    /// For each vertex at which several edges begin, the sum of its faces' normals, each as long as twice the face's
    /// area.
    normals: HashMap<u32, DVec3>,
}

/// Edges and faces that join vertices of the boundary already. The vertices of each are sorted.
struct JoinedVertices {
    edges: HashSet<[u32; 2]>,
    faces: HashSet<[u32; 3]>,
}

impl Surface {
    /// Closes holes of up to `most` edges. Returns the number of those that were closed.
    pub fn close_holes(&mut self, most: usize, work: &mut Work) -> usize {
        let before = work.closed_holes;
        work.left_holes.clear();
        let welded = self.welded();
        let faces = self.welded_faces(&welded);
        let counted = CountedEdges::of(&faces, self.vertices.len());
        let rim = self.rim(&faces, &counted);
        if rim.edges.is_empty() {
            return 0;
        }
        let mut joined = JoinedVertices::of(&faces, &rim);
        let left = |why: WhyLeft, hole: &[usize]| LeftHole {
            why,
            edges: hole.len(),
            position: self.vertices[rim.edges[hole[0]][0] as usize].to_array(),
        };
        let (holes, chains) = self.loops(&rim);
        work.left_holes
            .extend(chains.iter().map(|chain| left(WhyLeft::NoLoop, chain)));
        let mut added = Vec::new();
        for hole in &holes {
            if hole.len() > most {
                work.left_holes.push(left(WhyLeft::TooLong, hole));
                continue;
            }
            let vertices: Vec<u32> = hole.iter().map(|&edge| rim.edges[edge][0]).collect();
            match self.fill(&vertices, &mut joined) {
                Some(triangles) => {
                    work.closed_holes += 1;
                    work.added_faces += triangles.len();
                    added.extend(triangles);
                }
                None => work.left_holes.push(left(WhyLeft::NoTriangles, hole)),
            }
        }
        self.faces.extend(added);
        work.closed_holes - before
    }

    /// The triangles that close a hole with these vertices, if there are any.
    fn fill(&self, vertices: &[u32], joined: &mut JoinedVertices) -> Option<Vec<[u32; 3]>> {
        let places: Vec<Vec3> = vertices.iter().map(|&v| self.vertices[v as usize]).collect();
        let chord = |i: usize, j: usize| {
            let [u, v] = [vertices[i], vertices[j]];
            u != v && !joined.edges.contains(&sorted([u, v]))
        };
        let triangle = |corners: [usize; 3]| !joined.faces.contains(&sorted(corners.map(|i| vertices[i])));
        let triangles: Vec<[u32; 3]> = fill_any(&places, &chord, &triangle)?
            .into_iter()
            .map(|corners| corners.map(|i| vertices[i]))
            .collect();
        let mut chords: Vec<[u32; 2]> = triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .collect();
        chords.sort_unstable();
        // If the boundary visits vertices twice, so may a chord.
        let is_twice = chords.windows(2).any(|pair| pair[0] == pair[1]);
        // Not all chords and triangles of a large hole were asked about.
        let is_inside = |&[u, v]: &[u32; 2]| chords.binary_search(&[v, u]).is_ok();
        let crowds = |chord: &[u32; 2]| is_inside(chord) && joined.edges.contains(&sorted(*chord));
        let is_bad = |corners: &[u32; 3]| {
            joined.faces.contains(&sorted(*corners)) || cost(corners.map(|v| self.vertices[v as usize])).is_infinite()
        };
        if is_twice || chords.iter().any(crowds) || triangles.iter().any(is_bad) {
            return None;
        }
        joined.edges.extend(chords.into_iter().map(sorted));
        joined.faces.extend(triangles.iter().copied().map(sorted));
        Some(triangles)
    }

    /// The edges that exactly one face uses.
    fn rim(&self, faces: &[[u32; 3]], counted: &CountedEdges) -> Rim {
        let single = counted.edges.ends.iter().zip(&counted.uses);
        // An edge is directed as the first face that has it.
        let edges: Vec<[u32; 2]> = single
            .filter(|(_, uses)| uses.faces == 1)
            .map(|(&[from, to], uses)| if uses.balance > 0 { [to, from] } else { [from, to] })
            .collect();
        let mut at: HashMap<u32, Vec<usize>> = HashMap::new();
        for (number, &[from, _]) in edges.iter().enumerate() {
            at.entry(from).or_default().push(number);
        }
        let several = at.iter().filter(|(_, edges)| edges.len() > 1);
        let mut normals: HashMap<u32, DVec3> = several.map(|(&vertex, _)| (vertex, DVec3::ZERO)).collect();
        if !normals.is_empty() {
            for face in faces {
                let [a, b, c] = face.map(|v| self.vertices[v as usize].as_dvec3());
                for vertex in face {
                    if let Some(normal) = normals.get_mut(vertex) {
                        *normal += (b - a).cross(c - a);
                    }
                }
            }
        }
        Rim { edges, at, normals }
    }

    /// The loops of the boundary, and the chains of edges that close to no loop. Each is a list of edges.
    ///
    /// Where several holes meet at a vertex, the sector of each is bounded by an edge that ends there and one that
    /// begins there.
    fn loops(&self, rim: &Rim) -> (Vec<Vec<usize>>, Vec<Vec<usize>>) {
        let mut is_taken = vec![false; rim.edges.len()];
        let (mut loops, mut chains) = (Vec::new(), Vec::new());
        for first in 0..rim.edges.len() {
            if is_taken[first] {
                continue;
            }
            let mut path = vec![first];
            loop {
                let next = self.next(rim, path[path.len() - 1], &is_taken);
                let Some(next) = next else {
                    is_taken[first] = true;
                    chains.push(path);
                    break;
                };
                is_taken[next] = true;
                if next == first {
                    loops.push(path);
                    break;
                }
                path.push(next);
            }
        }
        (loops, chains)
    }

    /// The edge that follows another around the same hole: the first one clockwise, seen from outside. `None` if all
    /// that begin at its end are taken.
    fn next(&self, rim: &Rim, edge: usize, is_taken: &[bool]) -> Option<usize> {
        let [from, vertex] = rim.edges[edge];
        let free = rim.at.get(&vertex)?.iter().copied().filter(|&next| !is_taken[next]);
        let Some(&normal) = rim.normals.get(&vertex) else {
            return free.into_iter().next();
        };
        let place = |v: u32| self.vertices[v as usize].as_dvec3();
        let normal = normal.normalize_or(DVec3::Z);
        let back = place(from) - place(vertex);
        let angle = |next: usize| {
            let out = place(rim.edges[next][1]) - place(vertex);
            let angle = -normal.dot(back.cross(out)).atan2(back.reject_from(normal).dot(out));
            if angle > 0.0 {
                angle
            } else {
                angle + std::f64::consts::TAU
            }
        };
        free.min_by(|&a, &b| angle(a).total_cmp(&angle(b)))
    }
}

impl JoinedVertices {
    /// What joins vertices of the boundary.
    fn of(faces: &[[u32; 3]], rim: &Rim) -> Self {
        let is_boundary = |v: &u32| rim.at.contains_key(v);
        let mut joined = Self {
            edges: HashSet::new(),
            faces: HashSet::new(),
        };
        for &face in faces.iter().filter(|face| !is_collapsed(**face)) {
            let [a, b, c] = face;
            for edge in [[a, b], [b, c], [c, a]] {
                if edge.iter().all(is_boundary) {
                    joined.edges.insert(sorted(edge));
                }
            }
            if face.iter().all(is_boundary) {
                joined.faces.insert(sorted(face));
            }
        }
        joined
    }
}

fn sorted<const N: usize>(mut vertices: [u32; N]) -> [u32; N] {
    vertices.sort_unstable();
    vertices
}
