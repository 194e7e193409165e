//! The first time at which two moving meshes reach the target distance: conservative advancement over their trees.
//!
//! Each pair of nodes of the two trees advances separately and has a time of its own, until which it is certainly
//! apart. The search always continues with the pair of the earliest time. If its nodes are far apart, their safe time
//! is computed again at that time. Otherwise the larger node is opened and pairs of its children are added, down to
//! pairs of triangles, which advance step by step. The first of these to reach the target distance ends the search,
//! because all other pairs are apart until then. Pairs that reach the end of the collision substep are dropped. For
//! most parts of the meshes this happens a few levels below the root.

use super::nodes::{self, NodePlacer, Nodes};
use super::relative::{Relative, Rounded};
use super::triangle_pair::{TargetDistance, safe_time};
use super::triangles::Triangles;
use super::{Pose, Sweep};
use crate::asset::CollisionMesh;
use crate::geometry::cluster::CLUSTER;
use crate::geometry::distance::nearest;
use crate::simd::lanes::{Simd, bits};
use crate::simd::level::with_simd;
use crate::simd::rounding::unit_of;
use crate::state::mesh_arena::{BoxGroup, points};
use glam::{DMat3, DVec3, Mat3, Vec3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Largest number of visited pairs of nodes or triangles. Then the search stops and returns the time it has reached.
const MAX_VISITS: u32 = 1 << 16;

/// After this many visits the search restarts from the roots, at the time it has reached, with a larger limit. Small
/// nodes are efficient if a hit follows soon. But when bodies rotate, many small parts approach and recede before any
/// two meet, and larger nodes suffice for receding parts.
const VISITS_BEFORE_RESTART: u32 = 192;

/// Memory that is reused between searches.
#[derive(Default)]
pub struct Scratch {
    pub(super) queue: BinaryHeap<Entry>,
}

/// The mesh of one body of a pair, and how it moves.
#[derive(Clone, Copy)]
pub struct SweptMesh<'a> {
    pub mesh: &'a CollisionMesh,
    /// Along the collider's axes, about the body's centre of mass.
    pub sweep: Sweep,
    pub scale: Vec3,
    /// From the body's centre of mass to the collider's, in the collider's axes, metres.
    pub offset: DVec3,
    /// Radius of the bounding sphere around the body's centre of mass, metres.
    pub radius: f64,
    /// Radius of the rounding, metres.
    pub rounding: f64,
}

/// The search for the first hit of one pair of bodies.
pub struct Search<'a> {
    pub meshes: [SweptMesh<'a>; 2],
    pub target: TargetDistance,
    /// First and last time at which the bounding spheres are within the target distance.
    pub span: [f64; 2],
    /// Upper bound for the relative speed of any two points of the bodies, metres per collision substep.
    pub speed: f64,
}

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The bodies stay apart.
    Apart,
    /// The meshes are within the target distance at the start.
    InitiallyClose,
    /// The meshes reach the target distance.
    Hit(Hit),
}

/// When and where two bodies reach the target distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// As a fraction of the collision substep.
    pub time: f64,
    /// The first triangles that reach it; `None` if the search stopped before.
    pub triangles: Option<[u32; 2]>,
}

/// A pair of nodes or of triangles, and the time until which it is certainly apart.
#[derive(Clone, Copy)]
pub(super) struct Entry {
    /// See [`Search::tick`].
    pub tick: u64,
    pub time: f64,
    /// Triangles have level 0, clusters level 1, and the roots the highest level.
    pub level: [u8; 2],
    pub number: [u32; 2],
    /// Compute the safe time again before the nodes are opened.
    pub far: bool,
}

impl Search<'_> {
    /// Finds the first pair of triangles that reaches the target distance.
    pub fn run(&self, scratch: &mut Scratch) -> Outcome {
        with_simd!(simd => self.run_with(simd, scratch))
    }

    #[inline(always)]
    fn run_with<S: Simd>(&self, simd: S, scratch: &mut Scratch) -> Outcome {
        let queue = &mut scratch.queue;
        let [start, end] = self.span;
        let mut relative = self.relative(start);
        let mut placement = None;
        let mut visits_before_restart = VISITS_BEFORE_RESTART;
        let (mut visits, mut visits_since_restart, mut restart_time) = (0, 0, start);
        queue.clear();
        queue.push(self.roots(start));
        while let Some(entry) = queue.pop() {
            visits += 1;
            visits_since_restart += 1;
            if visits > MAX_VISITS {
                return self.hit(&entry, None);
            }
            if visits_since_restart > visits_before_restart {
                let time = self.time_of_tick(entry.tick);
                // Without progress in time many pairs are near at once, and more visits are needed.
                visits_before_restart = if time > restart_time {
                    visits_before_restart * 5 / 4
                } else {
                    visits_before_restart * 2
                };
                (visits_since_restart, restart_time) = (0, time);
                queue.clear();
                queue.push(self.roots(time));
                continue;
            }
            if relative.time != entry.time {
                (relative, placement) = (self.relative(entry.time), None);
            }
            let mut add = |next: Entry, safe_time: f64| {
                let time = entry.time + safe_time;
                if time <= end {
                    queue.push(Entry {
                        time,
                        tick: self.tick(time),
                        ..next
                    });
                }
            };
            if entry.level == [0, 0] {
                match self.safe_time(entry.number, &relative) {
                    Some(safe_time) => add(entry, safe_time),
                    // A pair that reaches the target in the first tick was there at the start.
                    None if entry.tick == 0 => return Outcome::InitiallyClose,
                    None => return self.hit(&entry, Some(entry.number)),
                }
                continue;
            }
            let placement = match &placement {
                Some(placement) => placement,
                None => placement.insert(self.placement(simd, relative)),
            };
            self.advance(simd, &entry, placement, &mut add);
        }
        Outcome::Apart
    }

    /// Computes safe times for the children of a pair of nodes, or again for the pair itself.
    #[inline(always)]
    pub(super) fn advance<S: Simd>(
        &self,
        simd: S,
        entry: &Entry,
        placement: &Placement<S>,
        add: &mut impl FnMut(Entry, f64),
    ) {
        if entry.level == [1, 1] && !entry.far {
            self.open_clusters(simd, entry, placement, add);
        } else {
            self.open(entry, placement, add);
        }
    }

    fn hit(&self, entry: &Entry, triangles: Option<[u32; 2]>) -> Outcome {
        let time = self.time_of_tick(entry.tick);
        Outcome::Hit(Hit { time, triangles })
    }

    /// The pair of roots, from which a search starts at a time until which the bodies are apart.
    pub(super) fn roots(&self, time: f64) -> Entry {
        Entry {
            tick: self.tick(time),
            time,
            level: [0, 1].map(|i| self.meshes[i].root() as u8),
            number: [0, 0],
            far: true,
        }
    }

    pub(super) fn relative(&self, time: f64) -> Relative {
        Relative::at([&self.meshes[0].sweep, &self.meshes[1].sweep], time)
    }

    /// Times are compared in ticks, and within a tick lower levels come first. In one tick distances shrink by no more
    /// than a fraction of the tolerance. Without ticks, if whole faces arrive at the same time, every pair of nodes
    /// would be opened before the first pair of triangles is visited.
    pub(super) fn tick(&self, time: f64) -> u64 {
        (time * self.ticks()) as u64
    }

    /// The start of a tick. All pairs in the queue are apart until then.
    fn time_of_tick(&self, tick: u64) -> f64 {
        (tick as f64 / self.ticks()).clamp(self.span[0], self.span[1])
    }

    fn ticks(&self) -> f64 {
        let tolerance = self.target.reached - self.target.aim;
        (2.0 * self.speed / tolerance).clamp(1.0, 1.0e15)
    }

    /// What is common to all nodes that are visited at one time.
    #[inline(always)]
    pub(super) fn placement<S: Simd>(&self, simd: S, relative: Relative) -> Placement<S> {
        let size = self.meshes[0].radius + self.meshes[1].radius;
        let unit = unit_of(size as f32);
        let rounded = relative.rounded(unit, size, self.target.aim);
        Placement {
            placers: [
                self.placer(simd, 0, unit, &rounded),
                self.placer(simd, 1, unit, &rounded),
            ],
            relative,
            rounded,
            unit,
        }
    }

    #[inline(always)]
    fn placer<S: Simd>(&self, simd: S, i: usize, unit: f32, rounded: &Rounded) -> NodePlacer<S> {
        let SweptMesh {
            scale, offset, radius, ..
        } = self.meshes[i];
        let offset = (f64::from(unit) * offset).as_vec3();
        NodePlacer::new(simd, i, unit * scale, offset, unit * radius as f32, rounded)
    }

    /// Computes safe times for the children of the larger node, or again for the pair itself if it is far apart.
    #[inline(always)]
    fn open<S: Simd>(&self, entry: &Entry, placement: &Placement<S>, add: &mut impl FnMut(Entry, f64)) {
        let [size_a, size_b] = [0, 1].map(|i| self.meshes[i].size(entry.level[i]));
        let first = entry.level[1] == 1 || (entry.level[0] > 1 && size_a >= size_b);
        let opened = (!entry.far).then_some(usize::from(!first));
        let a = self.nodes(entry, placement, 0, opened == Some(0));
        let b = self.nodes(entry, placement, 1, opened == Some(1));
        let safe = nodes::safe_times(&a, &b, &placement.rounded);
        let lanes = if opened.is_some() { a.lanes & b.lanes } else { 1 };
        for lane in bits(lanes) {
            let mut next = Entry {
                far: safe.far >> lane & 1 == 1,
                ..*entry
            };
            if let Some(i) = opened {
                next.level[i] -= 1;
                next.number[i] = child(entry.number[i], lane);
            }
            add(next, f64::from(safe.times[lane]));
        }
    }

    /// The children of a body's node, or the node itself in all lanes.
    #[inline(always)]
    fn nodes<S: Simd>(&self, entry: &Entry, placement: &Placement<S>, i: usize, opened: bool) -> Nodes<S> {
        let (swept, placer) = (&self.meshes[i], &placement.placers[i]);
        let (level, number) = (entry.level[i], entry.number[i] as usize);
        if opened {
            placer.nodes(&swept.boxes(level - 1, number))
        } else {
            let group = placer.nodes(&swept.boxes(level, number / CLUSTER));
            group.single(number % CLUSTER)
        }
    }

    /// Computes safe times for all pairs of triangles of two clusters.
    #[inline(always)]
    fn open_clusters<S: Simd>(
        &self,
        simd: S,
        entry: &Entry,
        placement: &Placement<S>,
        add: &mut impl FnMut(Entry, f64),
    ) {
        let a = self.triangles(simd, entry, placement, 0);
        let b = self.triangles(simd, entry, placement, 1);
        for i in bits(a.lanes) {
            let times = a.safe_times(i, &b, &placement.rounded);
            for j in bits(b.lanes) {
                let next = Entry {
                    level: [0, 0],
                    number: [child(entry.number[0], i), child(entry.number[1], j)],
                    far: false,
                    ..*entry
                };
                add(next, f64::from(times[j]));
            }
        }
    }

    /// The triangles of a body's cluster.
    #[inline(always)]
    fn triangles<S: Simd>(&self, simd: S, entry: &Entry, placement: &Placement<S>, i: usize) -> Triangles<S> {
        let rotations = [DMat3::IDENTITY, placement.relative.rotation];
        let swept = &self.meshes[i];
        let cluster = &swept.mesh.lanes().clusters[entry.number[i] as usize];
        let unit = f64::from(placement.unit);
        let matrix = rotations[i] * DMat3::from_diagonal(swept.scale.as_dvec3() * unit);
        let origin = rotations[i] * (swept.about_center(cluster.origin) * unit);
        let matrix: Mat3 = matrix.as_mat3();
        Triangles::new(simd, i, cluster, matrix, origin.as_vec3(), &placement.rounded)
    }

    /// The safe time of two triangles; `None` if they have reached the target distance.
    fn safe_time(&self, triangles: [u32; 2], relative: &Relative) -> Option<f64> {
        let [a, b] = [0, 1].map(|i| self.meshes[i].triangle(triangles[i]));
        safe_time(&a, &b.map(|corner| relative.rotation * corner), relative, self.target)
    }

    /// Where the bodies touch at a hit, and the direction from the first body to the second there.
    pub fn contact(&self, hit: &Hit) -> Option<[DVec3; 2]> {
        let triangles = hit.triangles?;
        let [a, b] = [0, 1].map(|i| {
            let swept = &self.meshes[i];
            let Pose { center, rotation } = swept.sweep.at(hit.time);
            swept.triangle(triangles[i]).map(|corner| center + rotation * corner)
        });
        let nearest = nearest(&a, &b);
        let [own, other] = self.meshes.map(|swept| swept.rounding);
        let gap = nearest.distance - own - other;
        Some([nearest.from + (own + 0.5 * gap) * nearest.direction, nearest.direction])
    }
}

/// Poses and motion of both bodies at one time.
pub(super) struct Placement<S: Simd> {
    pub relative: Relative,
    rounded: Rounded,
    placers: [NodePlacer<S>; 2],
    unit: f32,
}

fn child(number: u32, lane: usize) -> u32 {
    number * CLUSTER as u32 + lane as u32
}

impl SweptMesh<'_> {
    /// The level of the root.
    fn root(&self) -> usize {
        self.mesh.lanes().levels.len() + 1
    }

    /// Approximate size of the nodes of a level, metres.
    fn size(&self, level: u8) -> f32 {
        let lanes = self.mesh.lanes();
        let size = lanes.sizes.get(usize::from(level) - 1);
        self.scale.abs().max_element() * size.copied().unwrap_or(lanes.aabb.half_size().length())
    }

    /// A group of nodes of a level. The group of the root has it in all lanes.
    fn boxes(&self, level: u8, group: usize) -> BoxGroup {
        let lanes = self.mesh.lanes();
        match lanes.levels.get(usize::from(level) - 1) {
            Some(level) => level[group],
            None => BoxGroup {
                center: points(|_| lanes.aabb.center()),
                half: points(|_| lanes.aabb.half_size()),
            },
        }
    }

    /// The corners of a triangle relative to the body's centre of mass, in the collider's axes, scaled.
    fn triangle(&self, number: u32) -> [DVec3; 3] {
        let corners = self.mesh.mesh.corners(number as usize);
        corners.map(|corner| self.about_center(corner))
    }

    /// A point of the mesh relative to the body's centre of mass, in the collider's axes, scaled.
    fn about_center(&self, point: Vec3) -> DVec3 {
        self.offset + self.scale.as_dvec3() * (point.as_dvec3() - self.mesh.mass.center.as_dvec3())
    }
}

/// The heap pops the greatest entry: the earliest tick, and within it the lowest level.
impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        let height = |entry: &Self| entry.level[0] + entry.level[1];
        other
            .tick
            .cmp(&self.tick)
            .then_with(|| height(other).cmp(&height(self)))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}
