//! Creates buffers, and makes lists longer.

use super::buffers::StepCapacity;
use super::contact_programs::{ContactPrograms, START};
use super::record::{all_kernels, all_modules, impulse_program};
use super::{GpuStep, StepError};
use crate::gpu::arena::Change;
use crate::gpu::buffers::{Buffers, Capacity, TooLarge};
use crate::gpu::layout;
use crate::gpu::readback::scoped;

impl GpuStep {
    /// Compiles the kernels for contact points, creates their buffers, and includes topology in the meshes.
    pub(super) fn ensure_contacts(&mut self) -> Result<(), StepError> {
        if self.contacts.is_some() {
            return Ok(());
        }
        self.finish_all()?;
        let Self {
            gpu,
            buffers,
            has_features,
            ..
        } = self;
        let made = scoped(gpu, || {
            if !*has_features {
                gpu.compile(all_modules(), all_kernels())?;
            }
            Ok::<_, String>(ContactPrograms::new(gpu, buffers, START))
        });
        let contacts = made.and_then(|made| made).map_err(StepError::Device)?;
        if !self.has_features {
            self.has_features = true;
            self.arena = self.empty_arena();
        }
        self.contacts = Some(contacts?);
        Ok(())
    }

    /// Whether some list is too short.
    pub(super) fn needs_growth(&self, needed: Capacity, for_contacts: Option<StepCapacity>) -> bool {
        let contact_capacity = self.contacts.as_ref().map(ContactPrograms::capacity);
        self.buffers.capacity.grown(needed) != self.buffers.capacity
            || contact_capacity
                .zip(for_contacts)
                .is_some_and(|(capacity, needed)| capacity.grown(needed) != capacity)
    }

    /// Makes lists longer where needed, and returns whether the meshes were written again.
    pub(super) fn reserve(&mut self, needed: Capacity, for_contacts: Option<StepCapacity>) -> Result<bool, StepError> {
        if !self.needs_growth(needed, for_contacts) {
            return Ok(false);
        }
        let grown = self.buffers.capacity.grown(needed);
        let longer = grown != self.buffers.capacity;
        let made = scoped(&self.gpu, || {
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            let buffers = if longer {
                let buffers = Buffers::new(&self.gpu, grown)?;
                // The only buffer in this set that persists between steps.
                let (from, to) = (&self.buffers.moved, &buffers.moved);
                encoder.copy_buffer_to_buffer(from, 0, to, 0, from.size().min(to.size()));
                Some((impulse_program(&self.gpu, &buffers), buffers))
            } else {
                None
            };
            let contacts = match (&self.contacts, for_contacts) {
                (Some(old), Some(needed)) => {
                    let buffers = buffers.as_ref().map_or(&self.buffers, |(_, buffers)| buffers);
                    let contacts = ContactPrograms::new(&self.gpu, buffers, old.capacity().grown(needed))?;
                    contacts.copy_memory(old, &mut encoder);
                    Some(contacts)
                }
                _ => None,
            };
            self.gpu.queue.submit([encoder.finish()]);
            Ok::<_, TooLarge>((buffers, contacts))
        });
        let (buffers, contacts) = made.map_err(StepError::Device)??;
        if let Some((program, buffers)) = buffers {
            (self.program, self.buffers) = (program, buffers);
        }
        self.contacts = contacts;
        self.spare.clear();
        if longer {
            self.write(self.arena.contents())?;
        }
        Ok(longer)
    }

    /// Writes meshes.
    pub(super) fn write(&self, changes: Vec<Change>) -> Result<(), StepError> {
        if changes.is_empty() {
            return Ok(());
        }
        scoped(&self.gpu, || {
            for change in changes {
                let queue = &self.gpu.queue;
                match change {
                    Change::Words(at, words) => {
                        queue.write_buffer(&self.buffers.words, 4 * u64::from(at), bytemuck::cast_slice(&words));
                    }
                    Change::Header(slot, header) => {
                        let at = u64::from(slot) * size_of::<layout::Mesh>() as u64;
                        queue.write_buffer(&self.buffers.meshes, at, bytemuck::bytes_of(&header));
                    }
                }
            }
        })
        .map_err(StepError::Device)
    }
}
