//! Results of a step, converted to the host's arrays in an order that does not depend on the order of workgroups.

use super::contact_programs::ContactPrograms;
use super::fast_bodies::Impacts;
use super::readback_lengths::ReadbackLengths;
use super::upload::Input;
use crate::force_scan::touches::Touches;
use crate::gpu::buffers::Buffers;
use crate::gpu::commands::Commands;
use crate::gpu::layout::{
    APPROXIMATE, ASLEEP, AWAKE, COUNTERS, ContactPair, ContactPoint, HITS, Hit, LAST_APPROXIMATE, LAST_CONTACT_PAIRS,
    LAST_CONTACT_POINTS, LAST_SPHERE_PAIRS, MAX_NEGATED_VELOCITY, MAX_SPIN, MAX_VELOCITY, Moved, NEEDED_SUBSTEPS,
    PLANE_CONTACTS, PlaneContact, SCHEDULED_BODIES, SCHEDULED_SUBSTEPS, SKIPPED, SPHERE_PAIRS, TALLIES,
    TOTAL_NEAR_TRIANGLES, TOUCHES, TOUCHING, TOUCHING_NOW, TRIANGLE_TESTS, Touch, Touching,
};
use crate::gpu::program::Population;
use crate::gpu::timer::{self, Timer};
use crate::manifolds::report::report_points;
use crate::solver::speeds::Speeds;
use crate::state;
use crate::state::manifolds::pair_order;
use crate::state::{
    Contact, Contacts, Counts, FacePair, Manifold, ManifoldPoint, Manifolds, Motion, PairContact, StepResults,
};
use crate::step::StepState;
use crate::types::gpu_work::GpuWork;
use crate::types::settings::Response;
use crate::types::stage::Stage;
use bytemuck::Pod;
use glam::{Quat, Vec3};
use std::ops::Range;
use std::time::Duration;
use wgpu::Buffer;

/// Which results are read back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// Contacts and motions.
    #[default]
    All,
    /// Counts only.
    Counts,
}

/// The results of a step.
#[derive(Clone, Debug, Default)]
pub struct Output {
    /// Motions after the step: of all colliders, then of compounds; empty with [`Detail::Counts`].
    pub motions: Vec<Motion>,
    /// Pairs of bodies whose bounding spheres overlap, `a < b`, ascending; empty with [`Detail::Counts`].
    pub sphere_pairs: Vec<[u32; 2]>,
    /// Touching pairs; with [`Detail::Counts`] only the number of tests.
    pub contacts: Contacts,
    /// Contact points, with [`Response::None`] and [`Response::Contacts`]; empty with [`Detail::Counts`].
    pub manifolds: Manifolds,
    /// For each collider whether its body sleeps; empty with [`Detail::Counts`].
    pub asleep: Vec<bool>,
    /// Number of pairs of nearby triangles in contact generation, in the collision substep that had most.
    pub near_triangles: usize,
    /// Number of collision substeps.
    pub collision_substeps: u32,
    /// The mean number of the bodies that move.
    pub mean_collision_substeps: f32,
    /// Speeds of bodies after the step, with [`Response::Contacts`].
    pub speeds: Speeds,
    /// With [`Response::Contacts`], whether all bodies slept from the beginning of the step to its end.
    pub rests: bool,
    /// Sizes of the results.
    pub counts: Counts,
    /// Time of each stage on the device; zero if it has no time stamps.
    pub times: [Duration; Stage::COUNT],
    /// What was asked of the device.
    pub work: GpuWork,
}

/// The ranges of the results in the staging buffer.
pub(super) struct StagingRanges {
    counters: Range<u64>,
    times: Range<u64>,
    moved: Range<u64>,
    sphere_pairs: Range<u64>,
    touching: Range<u64>,
    hits: Range<u64>,
    planes: Range<u64>,
    tally: Range<u64>,
    contact_pairs: Range<u64>,
    contact_points: Range<u64>,
    touches: Range<u64>,
    /// Total size, bytes.
    pub total: u64,
}

impl StagingRanges {
    /// Ranges for lists of these lengths. `has_points` tells whether there are contact points, and `substeps` for how
    /// many collision substeps there are times.
    pub fn new(lengths: &ReadbackLengths, has_points: bool, input: &Input, substeps: u32, detail: Detail) -> Self {
        let mut total = 0;
        let mut part = |count: u32, size: usize| {
            let start = total;
            // Copies must be multiples of four bytes; all elements are.
            total += u64::from(count) * size as u64;
            start..total
        };
        let counters = part(COUNTERS, 4);
        let times = part(timer::BYTES * substeps, 1);
        let lists = |count: u32| if detail == Detail::All { count } else { 0 };
        let Population { bodies, compounds, .. } = input.population();
        let moved = part(lists(bodies + compounds), size_of::<Moved>());
        let sphere_pairs = part(lists(lengths.pairs), 8);
        let touching = part(lists(lengths.pairs), size_of::<Touching>());
        let hits = part(lists(input.listed_hits(lengths.hits)), size_of::<Hit>());
        let planes = part(lists(lengths.plane_contacts), size_of::<PlaneContact>());
        let of_points = |count: u32| if has_points { count } else { 0 };
        let tally = part(of_points(TALLIES), 4);
        let contact_pairs = part(lists(of_points(lengths.contact_pairs)), size_of::<ContactPair>());
        let contact_points = part(lists(of_points(lengths.contact_points)), size_of::<ContactPoint>());
        let touches = part(lists(of_points(lengths.touches)), size_of::<Touch>());
        Self {
            counters,
            times,
            moved,
            sphere_pairs,
            touching,
            hits,
            planes,
            tally,
            contact_pairs,
            contact_points,
            touches,
            total,
        }
    }

    /// Records the copies. Call it after the stages.
    pub fn copy(
        &self,
        buffers: &Buffers,
        contacts: Option<&ContactPrograms>,
        timer: Option<&Timer>,
        commands: &mut Commands,
        to: &Buffer,
    ) {
        let times = timer.map(|timer| (timer.resolved(), &self.times));
        let lists = [
            (&buffers.counters, &self.counters),
            (&buffers.moved, &self.moved),
            (&buffers.sphere_pairs, &self.sphere_pairs),
            (&buffers.touching, &self.touching),
            (&buffers.hits, &self.hits),
            (&buffers.plane_contacts, &self.planes),
        ];
        let found = contacts.map(|contacts| {
            [
                (&contacts.step.tally, &self.tally),
                (&contacts.contacts.contact_pairs, &self.contact_pairs),
                (&contacts.contacts.contact_points, &self.contact_points),
                (&contacts.step.touches, &self.touches),
            ]
        });
        for (from, range) in lists.into_iter().chain(found.into_iter().flatten()).chain(times) {
            if !range.is_empty() {
                commands.read_back(from, to, range);
            }
        }
    }

    /// Reads the ranges from `bytes`.
    pub fn read(&self, bytes: &[u8]) -> RawResults {
        let mut counters: Vec<u32> = list(bytes, &self.counters, COUNTERS as usize);
        let mut tally: Vec<u32> = list(bytes, &self.tally, TALLIES as usize);
        if tally.is_empty() {
            tally.resize(TALLIES as usize, 0);
        } else if counters[SKIPPED as usize] == 0 {
            // Collision substeps that the step did not need have found nothing.
            counters[SPHERE_PAIRS as usize] = tally[LAST_SPHERE_PAIRS as usize];
            counters[APPROXIMATE as usize] = tally[LAST_APPROXIMATE as usize];
        }
        // After an overflow the lists are invalid.
        let skipped = counters[SKIPPED as usize] != 0;
        let count = |counter: u32| {
            if skipped {
                0
            } else {
                counters[counter as usize] as usize
            }
        };
        let all = |many: u32| if skipped { 0 } else { many as usize };
        RawResults {
            contact_pairs: list(bytes, &self.contact_pairs, all(tally[LAST_CONTACT_PAIRS as usize])),
            contact_points: list(bytes, &self.contact_points, all(tally[LAST_CONTACT_POINTS as usize])),
            touches: list(bytes, &self.touches, all(tally[TOUCHES as usize])),
            tally,
            stamps: list(bytes, &self.times, usize::MAX),
            moved: list(bytes, &self.moved, usize::MAX),
            sphere_pairs: list(bytes, &self.sphere_pairs, count(SPHERE_PAIRS)),
            touching: list(bytes, &self.touching, count(TOUCHING)),
            hits: list(bytes, &self.hits, count(HITS)),
            planes: list(bytes, &self.planes, count(PLANE_CONTACTS)),
            counters,
        }
    }
}

/// Results as the device wrote them.
pub(super) struct RawResults {
    /// The counters.
    pub counters: Vec<u32>,
    /// Counters over all collision substeps.
    pub tally: Vec<u32>,
    contact_pairs: Vec<ContactPair>,
    contact_points: Vec<ContactPoint>,
    touches: Vec<Touch>,
    stamps: Vec<u64>,
    moved: Vec<Moved>,
    sphere_pairs: Vec<[u32; 2]>,
    touching: Vec<Touching>,
    hits: Vec<Hit>,
    planes: Vec<PlaneContact>,
}

impl RawResults {
    fn mean_collision_substeps(&self) -> f32 {
        let [bodies, substeps] = [SCHEDULED_BODIES, SCHEDULED_SUBSTEPS].map(|tally| self.tally[tally as usize]);
        if bodies > 0 {
            substeps as f32 / bodies as f32
        } else {
            self.counters[NEEDED_SUBSTEPS as usize] as f32
        }
    }

    /// Sorts the results, and converts numbers to those of the input.
    pub fn sort(mut self, input: &Input, impacts: &Impacts, timer: Option<&Timer>) -> Output {
        let count = |counter: u32| self.counters[counter as usize] as usize;
        let mut output = Output {
            counts: Counts {
                dormant: 0,
                sphere_pairs: count(SPHERE_PAIRS),
                approximate_pairs: count(APPROXIMATE),
                touching_pairs: count(TOUCHING),
                triangle_tests: count(TRIANGLE_TESTS) as u64,
                face_pairs: count(HITS),
                contact_points: self.tally[LAST_CONTACT_POINTS as usize] as usize,
                asleep: self.tally[ASLEEP as usize] as usize,
                crowded: 0,
            },
            times: timer.map_or_else(Default::default, |timer| timer.times(&self.stamps)),
            near_triangles: self.tally[TOTAL_NEAR_TRIANGLES as usize] as usize,
            collision_substeps: self.counters[NEEDED_SUBSTEPS as usize],
            mean_collision_substeps: self.mean_collision_substeps(),
            speeds: speeds(&self.tally),
            // The tally knows only the last of several collision substeps.
            rests: input.response == Response::Contacts
                && self.counters[NEEDED_SUBSTEPS as usize] == 1
                && self.tally[AWAKE as usize] == 0
                && impacts.velocities.is_empty()
                && impacts.sensor_touches.is_empty(),
            ..Default::default()
        };
        output.contacts.triangle_tests = output.counts.triangle_tests;
        output.contacts.lists_faces = input.face_lists;
        output.contacts.face_pairs = output.counts.face_pairs;
        self.sphere_pairs.sort_unstable();
        output.sphere_pairs = self.sphere_pairs;
        put_contacts(&mut output.contacts, input, self.touching, &self.hits);
        put_planes(&mut output.contacts, input, self.planes);
        output.motions = self.moved.iter().map(Motion::from).collect();
        let colliders = self.moved.iter().take(input.len() as usize);
        output.asleep = colliders.map(|moved| moved.asleep != 0).collect();
        let mut pairs: Vec<_> = self.contact_pairs.iter().map(Manifold::from).collect();
        pairs.sort_by_key(|pair| pair_order(pair.bodies, input.len()));
        output.manifolds = Manifolds {
            pairs,
            points: self.contact_points.iter().map(ManifoldPoint::from).collect(),
            surfaces: Vec::new(),
        };
        if input.response == Response::None && !output.motions.is_empty() {
            let center_of = |collider: u32| input.center_before(collider, &output.motions);
            report_points(&output.manifolds, input.len(), &mut output.contacts, center_of);
        }
        if input.response == Response::Contacts {
            if output.motions.is_empty() {
                // Faces were not tested.
                output.counts.touching_pairs = self.tally[TOUCHING_NOW as usize] as usize;
            } else {
                let mut touches = Touches::from_device(self.touches);
                for &(pair, contact) in &impacts.sensor_touches {
                    touches.record_sensor(pair, contact);
                }
                touches.report(input.len(), &mut output.contacts);
                output.counts.touching_pairs = output.contacts.pairs.len();
            }
        }
        output
    }
}

impl Output {
    /// Writes everything to where the CPU's stages would.
    pub fn put(self, state: &mut StepState) {
        let motions = self.put_lists(&mut state.results);
        state.input.bodies.set_motions(&motions);
    }

    /// Writes everything but the motions, which it returns.
    pub fn put_lists(self, results: &mut StepResults) -> Vec<Motion> {
        results.sphere_pairs = self.sphere_pairs;
        results.near_pairs.clear();
        results.approximate_pairs = self.counts.approximate_pairs;
        results.contacts = self.contacts;
        results.manifolds = self.manifolds;
        results.asleep = self.asleep;
        results.collision_substeps = self.collision_substeps;
        results.mean_collision_substeps = self.mean_collision_substeps;
        results.times = self.times;
        results.gpu = Some(self.work);
        results.crowd = Default::default();
        self.motions
    }
}

impl From<&Moved> for Motion {
    fn from(moved: &Moved) -> Self {
        Self {
            position: moved.position.into(),
            rotation: Quat::from_array(moved.rotation),
            linear_velocity: moved.linear_velocity.into(),
            angular_velocity: moved.angular_velocity.into(),
        }
    }
}

/// The first `count` elements of a range, or as many as it holds.
fn list<T: Pod>(bytes: &[u8], range: &Range<u64>, count: usize) -> Vec<T> {
    let part = &bytes[range.start as usize..range.end as usize];
    let size = count.saturating_mul(size_of::<T>()).min(part.len());
    bytemuck::pod_collect_to_vec(&part[..size])
}

fn put_contacts(contacts: &mut Contacts, input: &Input, mut touching: Vec<Touching>, hits: &[Hit]) {
    touching.sort_unstable_by_key(|t| [t.a, t.b]);
    // The rank and first face of each pair, by its number on the device.
    let most = touching.iter().map(|t| t.pair as usize + 1).max().unwrap_or(0);
    let mut starts = vec![(0, 0); most];
    let mut first_face = 0;
    for (rank, t) in touching.iter().enumerate() {
        starts[t.pair as usize] = (rank, first_face);
        contacts.pairs.push(PairContact {
            bodies: [t.a, t.b],
            contained: t.contained != 0,
            first_face,
            face_count: input.listed_hits(t.hits),
            contact: Contact {
                point: t.point.into(),
                normal: t.normal.into(),
            },
            first_point: 0,
            point_count: 0,
            impulse: 0.0,
            passing: false,
        });
        first_face += contacts.pairs[rank].face_count;
    }
    let none = FacePair {
        a: 0,
        b: 0,
        start: Vec3::ZERO,
        end: Vec3::ZERO,
    };
    contacts.faces.resize(first_face as usize, none);
    for hit in hits {
        let (rank, first) = starts[hit.pair as usize];
        let [a, b] = contacts.pairs[rank].bodies;
        let id = |body: u32, triangle: u32| {
            let mesh = input
                .mesh_of(body)
                .expect("the step's input holds the meshes of its bodies");
            mesh.mesh.face_ids()[triangle as usize]
        };
        contacts.faces[(first + hit.index) as usize] = FacePair {
            a: id(a, hit.a),
            b: id(b, hit.b),
            start: Vec3::new(hit.start_x, hit.start_y, hit.start_z),
            end: Vec3::new(hit.end_x, hit.end_y, hit.end_z),
        };
    }
}

fn put_planes(contacts: &mut Contacts, input: &Input, mut planes: Vec<PlaneContact>) {
    planes.retain(|contact| contact.depth > 0.0);
    planes.sort_unstable_by_key(|contact| [contact.body, contact.plane]);
    contacts.planes.extend(planes.iter().map(|contact| state::PlaneContact {
        body: contact.body,
        plane: contact.plane,
        point: contact.point.into(),
        normal: -Vec3::from_array(input.planes()[contact.plane as usize].normal),
        depth: contact.depth,
        first_point: 0,
        point_count: 0,
        impulse: 0.0,
    }));
}

/// The speeds in a tally.
fn speeds(tally: &[u32]) -> Speeds {
    let [highest, lowest] = [MAX_VELOCITY, MAX_NEGATED_VELOCITY].map(|first| {
        let axes = [0, 1, 2].map(|axis| descending(tally[(first + axis) as usize]));
        Vec3::from_array(axes.map(|speed| speed.unwrap_or(f32::NEG_INFINITY)))
    });
    Speeds::between(-lowest, highest, descending(tally[MAX_SPIN as usize]).unwrap_or(0.0))
}

/// The inverse of `ascending` in the kernels; `None` for 0, which stands for none.
fn descending(ascending: u32) -> Option<f32> {
    let bits = if ascending >> 31 == 1 {
        ascending ^ 0x8000_0000
    } else {
        !ascending
    };
    (ascending != 0).then(|| f32::from_bits(bits))
}
