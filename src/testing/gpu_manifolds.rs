//! Contact generation on the GPU by itself: bodies and pairs in, manifolds out.

use crate::gpu::arena::{Arena, Change};
use crate::gpu::buffers::TooLarge;
use crate::gpu::commands::Commands;
use crate::gpu::device::{Gpu, NoGpu};
use crate::gpu::layout::{
    self, ACTIVE_PAIRS, CONTACT_COUNTERS, CONTACT_PAIRS, CONTACT_POINTS, CONTACTS_CUT_SHORT, CONTACTS_SKIPPED,
    ContactPair, ContactPoint, FLAT_RADIUS, MARGIN_PAIRS,
};
use crate::gpu::program::{Calls, Population, Program};
use crate::gpu::readback::{DeviceError, read_words, scoped};
use crate::manifolds::gpu::record::{record_lists, record_points};
use crate::manifolds::gpu::{BatchSize, ContactBuffers, ContactCapacity, ContactScratch, SHADERS};
use crate::manifolds::{Manifold, ManifoldPoint, Manifolds, MarginPair};
use crate::state::StepInput;
use crate::step::gpu::StepError;
use crate::step::gpu::record::all_modules;
use crate::step::gpu::upload::Input;
use crate::types::stage::Stage;
use bytemuck::{Pod, bytes_of, cast_slice};
use glam::Vec3;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferUsages};

/// Contact generation on the GPU.
pub struct GpuManifolds {
    gpu: Gpu,
    capacity: ContactCapacity,
    batch_size: BatchSize,
    /// Number of times that lists were made longer.
    repeats: usize,
}

/// Initial capacity. Lists grow as needed.
const START: ContactCapacity = ContactCapacity {
    batches: 1,
    margin_pairs: 256,
    slots: 1024,
    near_triangles: 1 << 16,
    pieces: 256,
    features: 1 << 14,
    segments: 1 << 13,
    staged_points: 4096,
    pairs: 256,
    points: 4096,
};

/// Each repetition makes at least one list longer. The overflow of an early list can hide what later ones need.
const REPEATS: usize = 12;

impl GpuManifolds {
    /// Compiles the kernels.
    ///
    /// # Errors
    /// If the device cannot run them.
    pub fn new(gpu: &Gpu) -> Result<Self, NoGpu> {
        Self::with_capacity(gpu, START)
    }

    /// With this initial capacity. Results do not depend on it.
    ///
    /// # Errors
    /// If the device cannot run the kernels.
    pub fn with_capacity(gpu: &Gpu, capacity: ContactCapacity) -> Result<Self, NoGpu> {
        let kernels = crate::gpu::SHADERS.kernels.iter().chain(SHADERS.kernels).copied();
        match gpu.compile(all_modules(), kernels) {
            Ok(()) => Ok(Self {
                gpu: gpu.clone(),
                capacity,
                batch_size: BatchSize::of(gpu),
                repeats: 0,
            }),
            Err(reason) => Err(NoGpu::Failed {
                adapter: gpu.info.name.clone(),
                reason: reason.to_string(),
            }),
        }
    }

    /// Current capacity of the lists.
    pub fn capacity(&self) -> ContactCapacity {
        self.capacity
    }

    /// Number of times that a list was too short and the run was repeated.
    pub fn repeats(&self) -> usize {
        self.repeats
    }

    /// The contact points of `pairs`, which must ascend, and of the bodies of `state` on its planes, ascending by
    /// the numbers of bodies. Plane `i` is numbered `bodies.len() + i`. Invalid pairs have no points. A margin
    /// that is negative or NaN counts as 0.
    ///
    /// # Errors
    /// If the device cannot hold the lists, or fails.
    pub fn run(&mut self, state: &StepInput, pairs: &[MarginPair]) -> Result<Manifolds, StepError> {
        let scene = self.upload(state)?;
        let own = |pair: &MarginPair| layout::MarginPair {
            a: pair.bodies[0],
            b: pair.bodies[1],
            margin: pair.margin,
            padding: 0,
        };
        let pairs: Vec<layout::MarginPair> = pairs.iter().map(own).collect();
        let count = pairs.len() as u32;
        let Population { bodies, planes, .. } = scene.population;
        let slots = bodies.saturating_mul(planes).saturating_add(count);
        self.capacity = self.capacity.grown(ContactCapacity {
            margin_pairs: count,
            slots,
            ..ContactCapacity::default()
        });
        for _ in 0..REPEATS {
            let buffers = self.scoped(|gpu| ContactBuffers::new(gpu, self.capacity))??;
            let scratch = self.scoped(|gpu| ContactScratch::new(gpu, self.capacity))??;
            let counters = self.attempt(&scene, &buffers, &scratch, &pairs)?;
            if counters[CONTACTS_CUT_SHORT as usize] != 0 {
                return Err(StepError::CutShort);
            }
            if counters[CONTACTS_SKIPPED as usize] == 0 {
                return self.read(&buffers, &counters);
            }
            let needed = self.batch_size.needed(&counters, self.capacity.batches);
            self.capacity = self.capacity.grown(needed);
            self.repeats += 1;
        }
        Err(StepError::Device(DeviceError::failed(
            "lists stay too short however long they are made",
        )))
    }

    fn scoped<T>(&self, work: impl FnOnce(&Gpu) -> T) -> Result<T, StepError> {
        scoped(&self.gpu, || work(&self.gpu)).map_err(StepError::Device)
    }

    fn upload(&self, state: &StepInput) -> Result<Scene, StepError> {
        let input = Input::new(state, &[]);
        let mut arena = Arena::with_features();
        let (mut headers, mut words) = (vec![layout::Mesh::default(); state.meshes.len().max(1)], Vec::new());
        for change in arena.update(&state.meshes)? {
            match change {
                Change::Words(at, own) => {
                    words.resize(words.len().max(at as usize + own.len()), 0);
                    words[at as usize..at as usize + own.len()].copy_from_slice(&own);
                }
                Change::Header(slot, header) => headers[slot as usize] = header,
            }
        }
        let limit = self.gpu.device.limits().max_storage_buffer_binding_size;
        let bytes = 4 * words.len() as u64;
        if bytes > limit {
            return Err(TooLarge {
                what: "mesh data",
                bytes,
                limit,
            }
            .into());
        }
        self.scoped(|_| Scene {
            step: self.buffer(&[*input.step()], BufferUsages::UNIFORM),
            bodies_at: self.buffer(input.bodies(), BufferUsages::STORAGE),
            planes_at: self.buffer(input.planes(), BufferUsages::STORAGE),
            meshes: self.buffer(&headers, BufferUsages::STORAGE),
            words: self.buffer(&words, BufferUsages::STORAGE),
            population: input.population(),
        })
    }

    /// An array with these elements, or with one zero.
    fn buffer<T: Pod>(&self, elements: &[T], usage: BufferUsages) -> Buffer {
        let none = [T::zeroed()];
        let elements = if elements.is_empty() { &none } else { elements };
        self.gpu.device.create_buffer_init(&BufferInitDescriptor {
            label: Some("contact input"),
            contents: cast_slice(elements),
            usage,
        })
    }

    /// Runs contact generation once, and returns the counters.
    fn attempt(
        &self,
        scene: &Scene,
        buffers: &ContactBuffers,
        scratch: &ContactScratch,
        pairs: &[layout::MarginPair],
    ) -> Result<Vec<u32>, StepError> {
        self.scoped(|gpu| {
            let limits = buffers
                .capacity
                .limits(scene.population.bodies, scene.population.planes);
            let mut counters = [0u32; CONTACT_COUNTERS as usize];
            for counter in [MARGIN_PAIRS, ACTIVE_PAIRS] {
                counters[counter as usize] = pairs.len() as u32;
            }
            gpu.queue.write_buffer(&buffers.limits, 0, bytes_of(&limits));
            gpu.queue
                .write_buffer(&buffers.contact_counters, 0, cast_slice(&counters));
            gpu.queue.write_buffer(&buffers.margin_pairs, 0, cast_slice(pairs));
            // Not in the order of the pairs: none is needed.
            let active: Vec<u32> = (0..pairs.len() as u32).rev().collect();
            gpu.queue.write_buffer(&buffers.active_pairs, 0, cast_slice(&active));
            let program = self.program(scene, buffers, scratch);
            let mut commands = Commands::new(gpu, "test");
            program.record(Stage::Manifolds, &mut commands, scene.population, None);
            commands.submit();
        })?;
        self.words(&buffers.contact_counters, CONTACT_COUNTERS as usize)
    }

    fn program(&self, scene: &Scene, buffers: &ContactBuffers, scratch: &ContactScratch) -> Program {
        let mut calls = Calls::new(Stage::Manifolds);
        record_points(&mut calls, &buffers.capacity);
        record_lists(&mut calls, &buffers.capacity);
        let scene = [
            ("step", &scene.step),
            ("bodies", &scene.bodies_at),
            ("planes", &scene.planes_at),
            ("meshes", &scene.meshes),
            ("words", &scene.words),
        ];
        Program::new(&self.gpu, &calls, &[&scene, buffers, scratch])
    }

    fn words(&self, buffer: &Buffer, words: usize) -> Result<Vec<u32>, StepError> {
        read_words(&self.gpu, buffer, words).map_err(StepError::Device)
    }

    fn read(&self, buffers: &ContactBuffers, counters: &[u32]) -> Result<Manifolds, StepError> {
        let [pairs, points] = [
            (CONTACT_PAIRS, size_of::<ContactPair>()),
            (CONTACT_POINTS, size_of::<ContactPoint>()),
        ]
        .map(|(counter, size)| counters[counter as usize] as usize * size / 4);
        let pairs = self.words(&buffers.contact_pairs, pairs)?;
        let points = self.words(&buffers.contact_points, points)?;
        Ok(Manifolds {
            pairs: cast_slice(&pairs).iter().map(Manifold::from).collect(),
            points: cast_slice(&points).iter().map(ManifoldPoint::from).collect(),
            surfaces: Vec::new(),
        })
    }
}

/// The input on the device.
struct Scene {
    step: Buffer,
    bodies_at: Buffer,
    planes_at: Buffer,
    meshes: Buffer,
    words: Buffer,
    population: Population,
}

impl From<&ContactPair> for Manifold {
    fn from(pair: &ContactPair) -> Self {
        Self {
            bodies: [pair.a, pair.b],
            first_point: pair.first_point,
            point_count: pair.point_count,
        }
    }
}

impl From<&ContactPoint> for ManifoldPoint {
    fn from(point: &ContactPoint) -> Self {
        // The device has no infinity.
        let radius = |r: f32| if r >= FLAT_RADIUS { f32::INFINITY } else { r };
        Self {
            anchors: [Vec3::from(point.anchor_a), Vec3::from(point.anchor_b)],
            normal: Vec3::from(point.normal),
            separation: point.separation,
            bulge: point.bulge,
            curvature_radii: [radius(point.curvature_radius_a), radius(point.curvature_radius_b)],
            normal_rotation: point.normal_rotation,
            faces: [point.face_a, point.face_b],
        }
    }
}
