//! When two moving meshes come near each other first.
//!
//! Conservative advancement, but each pair of nodes of the two trees has a clock of its own: how long it stays apart for
//! certain. The pair whose clock shows the earliest time is next. If it is far apart it is looked at again at that time; else the
//! larger node is opened, and pairs of its children get clocks, down to pairs of triangles, which come nearer step by step.
//! When the first of those arrives, all others stay apart until then. What never comes near runs over the end and is forgotten,
//! and at most places of the meshes that is so a few levels below the root.

use super::approach::{self, Reach};
use super::distance::nearest;
use super::nodes::{self, Placing};
use super::relative::{Relative, Rounded};
use super::triangles::Triangles;
use super::{Pose, Sweep};
use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{bits, splat};
use crate::simd::rounding::unit_of;
use crate::state::mesh_arena::{BoxGroup, MeshSlot};
use glam::{DMat3, DVec3, Mat3, Vec3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// After so many looks at a pair of nodes or of triangles the search gives up, and takes the time it has got to.
const MOST_LOOKS: u32 = 1 << 16;

/// After so many looks the search begins anew, at the time it has got to, and is more patient next time. Clocks of small parts are
/// right for what comes near at once; but of bodies that spin, many small parts come and go before any two meet, and larger
/// ones would do for those that are gone.
const PATIENCE: u32 = 192;

/// Memory kept between searches.
#[derive(Default)]
pub struct Scratch {
    queue: BinaryHeap<Entry>,
}

/// One body of a pair.
#[derive(Clone, Copy)]
pub struct Side<'a> {
    pub slot: &'a MeshSlot,
    pub sweep: &'a Sweep,
    pub scale: Vec3,
    /// Of the bounding sphere, metres.
    pub radius: f64,
}

/// What a search is about.
pub struct Search<'a> {
    pub sides: [Side<'a>; 2],
    pub reach: Reach,
    /// When the bounding spheres are near, from when to when.
    pub span: [f64; 2],
    /// No point of either body moves faster towards one of the other's, metres per interval.
    pub speed: f64,
}

/// When two bodies come near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meeting {
    /// They do not.
    Never,
    /// They are at the start.
    Already,
    /// Within the interval.
    At(Encounter),
}

/// How two bodies come near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encounter {
    /// At this part of the interval.
    pub time: f64,
    /// The first triangles to arrive; `None` if the search gave up before any had.
    pub triangles: Option<[u32; 2]>,
}

/// Two nodes, or two triangles, and until when they stay apart.
#[derive(Clone, Copy)]
struct Entry {
    /// See [`Search::tick`].
    tick: u64,
    time: f64,
    /// Triangles are on level 0, clusters on level 1, and the roots on the highest.
    level: [u8; 2],
    number: [u32; 2],
    /// Look again before opening.
    far: bool,
}

impl Search<'_> {
    /// When any two triangles arrive within reach of each other.
    pub fn run(&self, scratch: &mut Scratch) -> Meeting {
        let queue = &mut scratch.queue;
        let [start, end] = self.span;
        let mut relative = self.relative(start);
        let mut moment = None;
        let mut patience = PATIENCE;
        let (mut looks, mut since, mut restart) = (0, 0, start);
        queue.clear();
        queue.push(self.roots(start));
        while let Some(entry) = queue.pop() {
            looks += 1;
            since += 1;
            if looks > MOST_LOOKS {
                return self.met(&entry, None);
            }
            if since > patience {
                let time = self.beginning(entry.tick);
                // Where no time was won, many things are near at once, and more have to be looked at.
                patience = if time > restart { patience * 5 / 4 } else { patience * 2 };
                (since, restart) = (0, time);
                queue.clear();
                queue.push(self.roots(time));
                continue;
            }
            if relative.time != entry.time {
                (relative, moment) = (self.relative(entry.time), None);
            }
            let mut add = |next: Entry, stay: f64| {
                let time = entry.time + stay;
                if time <= end {
                    queue.push(Entry {
                        time,
                        tick: self.tick(time),
                        ..next
                    });
                }
            };
            if entry.level == [0, 0] {
                match self.approach(entry.number, &relative) {
                    Some(stay) => add(entry, stay),
                    // What arrives within the first tick was there before.
                    None if entry.tick == 0 => return Meeting::Already,
                    None => return self.met(&entry, Some(entry.number)),
                }
                continue;
            }
            let moment = moment.get_or_insert_with(|| self.moment(relative));
            if entry.level == [1, 1] && !entry.far {
                self.open_clusters(&entry, moment, &mut add);
            } else {
                self.open(&entry, moment, &mut add);
            }
        }
        Meeting::Never
    }

    fn met(&self, entry: &Entry, triangles: Option<[u32; 2]>) -> Meeting {
        let time = self.beginning(entry.tick);
        Meeting::At(Encounter { time, triangles })
    }

    /// Where a search starts, at a time until which all is apart.
    fn roots(&self, time: f64) -> Entry {
        Entry {
            tick: self.tick(time),
            time,
            level: [0, 1].map(|i| self.sides[i].root() as u8),
            number: [0, 0],
            far: true,
        }
    }

    fn relative(&self, time: f64) -> Relative {
        Relative::at([self.sides[0].sweep, self.sides[1].sweep], time)
    }

    /// Times are compared by ticks so short that nothing comes nearer by more than a part of the tolerance, and within a tick
    /// what is lower in the trees is first. Else, where faces arrive all at once, every pair of nodes would be opened before
    /// the first two triangles are looked at.
    fn tick(&self, time: f64) -> u64 {
        (time * self.ticks()) as u64
    }

    /// When a tick begins. All that is not yet looked at is apart until then.
    fn beginning(&self, tick: u64) -> f64 {
        (tick as f64 / self.ticks()).clamp(self.span[0], self.span[1])
    }

    fn ticks(&self) -> f64 {
        let tolerance = self.reach.arrived - self.reach.aim;
        (2.0 * self.speed / tolerance).clamp(1.0, 1.0e15)
    }

    /// What is the same for all nodes that are looked at at one time.
    fn moment(&self, relative: Relative) -> Moment {
        let size = self.sides[0].radius + self.sides[1].radius;
        let unit = unit_of(size as f32);
        let rounded = relative.rounded(unit, size, self.reach.aim);
        Moment {
            placings: [0, 1].map(|i| {
                let side = &self.sides[i];
                Placing::new(i, unit * side.scale, unit * side.radius as f32, &rounded)
            }),
            relative,
            rounded,
            unit,
        }
    }

    /// Looks at the children of the larger node, or again at the pair itself.
    fn open(&self, entry: &Entry, moment: &Moment, add: &mut impl FnMut(Entry, f64)) {
        let [size_a, size_b] = [0, 1].map(|i| self.sides[i].size(entry.level[i]));
        let first = entry.level[1] == 1 || (entry.level[0] > 1 && size_a >= size_b);
        let opened = (!entry.far).then_some(usize::from(!first));
        let placed = [0, 1].map(|i| {
            let (side, placing) = (&self.sides[i], &moment.placings[i]);
            let (level, number) = (entry.level[i], entry.number[i] as usize);
            if opened == Some(i) {
                placing.nodes(&side.boxes(level - 1, number))
            } else {
                placing
                    .nodes(&side.boxes(level, number / CLUSTER))
                    .single(number % CLUSTER)
            }
        });
        let [a, b] = &placed;
        let stay = nodes::stay(a, b, &moment.rounded);
        let lanes = if opened.is_some() { a.lanes & b.lanes } else { 1 };
        for lane in bits(lanes) {
            let mut next = Entry {
                far: stay.far >> lane & 1 == 1,
                ..*entry
            };
            if let Some(i) = opened {
                next.level[i] -= 1;
                next.number[i] = child(entry.number[i], lane);
            }
            add(next, f64::from(stay.time[lane]));
        }
    }

    /// Looks at all pairs of triangles of two clusters.
    fn open_clusters(&self, entry: &Entry, moment: &Moment, add: &mut impl FnMut(Entry, f64)) {
        let relative = &moment.relative;
        let rotations = [DMat3::IDENTITY, relative.rotation];
        let unit = f64::from(moment.unit);
        let [a, b] = [0, 1].map(|i| {
            let side = &self.sides[i];
            let cluster = &side.slot.lanes.clusters[entry.number[i] as usize];
            let matrix = rotations[i] * DMat3::from_diagonal(side.scale.as_dvec3() * unit);
            let origin = matrix * side.about_center(cluster.origin);
            let matrix: Mat3 = matrix.as_mat3();
            Triangles::new(i, cluster, matrix, origin.as_vec3(), &moment.rounded)
        });
        for i in bits(a.lanes) {
            let stay = a.stay(i, &b, &moment.rounded);
            for j in bits(b.lanes) {
                let next = Entry {
                    level: [0, 0],
                    number: [child(entry.number[0], i), child(entry.number[1], j)],
                    far: false,
                    ..*entry
                };
                add(next, f64::from(stay[j]));
            }
        }
    }

    /// For how long two triangles stay apart, if they have not arrived.
    fn approach(&self, triangles: [u32; 2], relative: &Relative) -> Option<f64> {
        let [a, b] = [0, 1].map(|i| self.sides[i].triangle(triangles[i]));
        approach::stay(&a, &b.map(|corner| relative.rotation * corner), relative, self.reach)
    }

    /// Where the bodies touch when the first triangles arrive, and the direction from the first body to the second there.
    pub fn contact(&self, encounter: &Encounter) -> Option<[DVec3; 2]> {
        let triangles = encounter.triangles?;
        let [a, b] = [0, 1].map(|i| {
            let side = &self.sides[i];
            let Pose { center, rotation } = side.sweep.at(encounter.time);
            side.triangle(triangles[i]).map(|corner| center + rotation * corner)
        });
        let nearest = nearest(&a, &b);
        Some([
            nearest.from + 0.5 * nearest.distance * nearest.direction,
            nearest.direction,
        ])
    }
}

/// What a [`Search`] needs at one time.
struct Moment {
    relative: Relative,
    rounded: Rounded,
    placings: [Placing; 2],
    unit: f32,
}

fn child(number: u32, lane: usize) -> u32 {
    number * CLUSTER as u32 + lane as u32
}

impl Side<'_> {
    /// The level of the root.
    fn root(&self) -> usize {
        self.slot.lanes.levels.len() + 1
    }

    /// How large nodes of a level are, about, in metres.
    fn size(&self, level: u8) -> f32 {
        let lanes = &self.slot.lanes;
        let size = lanes.sizes.get(usize::from(level) - 1);
        self.scale.abs().max_element() * size.copied().unwrap_or(lanes.aabb.half_size().length())
    }

    /// A group of nodes of a level; that of the root holds it in all lanes.
    fn boxes(&self, level: u8, group: usize) -> BoxGroup {
        let lanes = &self.slot.lanes;
        match lanes.levels.get(usize::from(level) - 1) {
            Some(level) => level[group],
            None => BoxGroup {
                center: splat(lanes.aabb.center()),
                half: splat(lanes.aabb.half_size()),
            },
        }
    }

    /// The corners of a triangle, in the body's axes.
    fn triangle(&self, number: u32) -> [DVec3; 3] {
        let corners = self.slot.mesh.mesh.corners(number as usize);
        corners.map(|corner| self.scale.as_dvec3() * self.about_center(corner))
    }

    /// A point of the mesh, not scaled.
    fn about_center(&self, point: Vec3) -> DVec3 {
        point.as_dvec3() - self.slot.mesh.mass.center.as_dvec3()
    }
}

/// The greatest is looked at first: of the earliest tick the lowest.
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
