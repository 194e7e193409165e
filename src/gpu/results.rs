//! What a step found, brought back into the host's arrays, in an order that does not depend on which workgroup was first.

use super::buffers::Buffers;
use super::device::Gpu;
use super::layout::{
    APPROXIMATE, HITS, Hit, Moved, PLANE_CONTACTS, PlaneContact, SPHERE_PAIRS, TOUCHING, TRIANGLE_TESTS, Touching,
};
use super::readback::{map, scoped, staging};
use super::step::COUNTER_BYTES;
use crate::stages::state::{self, Contact, FacePair, StepState, TouchingPair};
use bytemuck::Pod;
use glam::{Quat, Vec3};
use std::ops::Range;
use wgpu::{Buffer, CommandEncoder};

/// Buffers to read from.
#[derive(Default)]
pub struct Results {
    counters: Option<Buffer>,
    lists: Option<Buffer>,
}

impl Results {
    /// To be recorded after the stages.
    pub fn copy_counters(&mut self, gpu: &Gpu, buffers: &Buffers, encoder: &mut CommandEncoder) {
        let to = self.counters.get_or_insert_with(|| staging(gpu, COUNTER_BYTES));
        encoder.copy_buffer_to_buffer(&buffers.counters, 0, to, 0, COUNTER_BYTES);
    }

    /// Waits for the step's counters.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn counters(&self, gpu: &Gpu) -> Result<Vec<u32>, String> {
        match &self.counters {
            Some(staging) => map(gpu, staging, COUNTER_BYTES, bytemuck::pod_collect_to_vec),
            None => Err("no step has run".into()),
        }
    }

    /// Copies what there is and puts it into `state`.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn fetch(
        &mut self,
        gpu: &Gpu,
        buffers: &Buffers,
        counters: &[u32],
        state: &mut StepState,
    ) -> Result<(), String> {
        let count = |counter: u32| counters[counter as usize] as usize;
        let mut end = 0;
        let mut range = |count: usize, size: usize| {
            let start = end;
            end += count * size;
            // Copies are made of words of four bytes, and these are all made of such.
            start..end
        };
        let moved = range(state.bodies.len(), size_of::<Moved>());
        let pairs = range(count(SPHERE_PAIRS), 8);
        let touching = range(count(TOUCHING), size_of::<Touching>());
        let hits = range(count(HITS), size_of::<Hit>());
        let planes = range(count(PLANE_CONTACTS), size_of::<PlaneContact>());
        let total = end as u64;
        let wanted = [
            (&buffers.moved, &moved),
            (&buffers.sphere_pairs, &pairs),
            (&buffers.touching, &touching),
            (&buffers.hits, &hits),
            (&buffers.plane_contacts, &planes),
        ];
        if self.lists.as_ref().is_none_or(|lists| lists.size() < total) {
            self.lists = None;
        }
        let lists = scoped(gpu, || {
            let lists = self.lists.get_or_insert_with(|| staging(gpu, total + total / 4));
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            for (from, range) in wanted {
                if !range.is_empty() {
                    encoder.copy_buffer_to_buffer(from, 0, lists, range.start as u64, range.len() as u64);
                }
            }
            gpu.queue.submit([encoder.finish()]);
            &*lists
        })?;
        map(gpu, lists, total, |bytes| {
            state.sphere_pairs = list(bytes, pairs);
            state.sphere_pairs.sort_unstable();
            state.near_pairs.clear();
            state.approximate_pairs = count(APPROXIMATE);
            state.contacts.triangle_tests = count(TRIANGLE_TESTS) as u64;
            put_contacts(state, list(bytes, touching), &list::<Hit>(bytes, hits));
            put_planes(state, list(bytes, planes));
            put_moved(state, &list::<Moved>(bytes, moved));
        })
    }
}

fn list<T: Pod>(bytes: &[u8], range: Range<usize>) -> Vec<T> {
    bytemuck::pod_collect_to_vec(&bytes[range])
}

fn put_contacts(state: &mut StepState, mut touching: Vec<Touching>, hits: &[Hit]) {
    touching.sort_unstable_by_key(|t| [t.a, t.b]);
    let contacts = &mut state.contacts;
    contacts.pairs.clear();
    // Where the faces of each pair begin, by the pair's number on the device.
    let most = touching.iter().map(|t| t.pair as usize + 1).max().unwrap_or(0);
    let mut starts = vec![(0, 0); most];
    let mut first_face = 0;
    for (rank, t) in touching.iter().enumerate() {
        starts[t.pair as usize] = (rank, first_face);
        contacts.pairs.push(TouchingPair {
            bodies: [t.a, t.b],
            contained: t.contained != 0,
            first_face,
            face_count: t.hits,
            contact: Contact {
                point: t.point.into(),
                normal: t.normal.into(),
            },
        });
        first_face += t.hits;
    }
    let none = FacePair {
        a: 0,
        b: 0,
        start: Vec3::ZERO,
        end: Vec3::ZERO,
    };
    contacts.faces.clear();
    contacts.faces.resize(first_face as usize, none);
    for hit in hits {
        let (rank, first) = starts[hit.pair as usize];
        let [mesh_a, mesh_b] = contacts.pairs[rank]
            .bodies
            .map(|i| &state.meshes[state.bodies.mesh[i as usize]].mesh.mesh);
        contacts.faces[(first + hit.index) as usize] = FacePair {
            a: mesh_a.face_ids()[hit.a as usize],
            b: mesh_b.face_ids()[hit.b as usize],
            start: Vec3::new(hit.start_x, hit.start_y, hit.start_z),
            end: Vec3::new(hit.end_x, hit.end_y, hit.end_z),
        };
    }
}

fn put_planes(state: &mut StepState, mut planes: Vec<PlaneContact>) {
    planes.retain(|contact| contact.depth > 0.0);
    planes.sort_unstable_by_key(|contact| [contact.body, contact.plane]);
    state.contacts.planes.clear();
    state
        .contacts
        .planes
        .extend(planes.iter().map(|contact| state::PlaneContact {
            body: contact.body,
            plane: contact.plane,
            point: state.bodies.center[contact.body as usize] + Vec3::from(contact.point),
            depth: contact.depth,
        }));
}

fn put_moved(state: &mut StepState, moved: &[Moved]) {
    let bodies = &mut state.bodies;
    for (i, moved) in moved.iter().enumerate() {
        bodies.position[i] = moved.position.into();
        bodies.rotation[i] = Quat::from_array(moved.rotation);
        bodies.linear_velocity[i] = moved.linear_velocity.into();
        bodies.angular_velocity[i] = moved.angular_velocity.into();
    }
}
