//! Creates buffers, and makes lists longer.

use super::buffers::StepCapacity;
use super::contact_programs::{ContactPrograms, START};
use super::peak_usage::PeakUsage;
use super::record::{all_kernels, all_modules, impulse_program, report_kernels};
use super::{Compiled, GpuStep, StepError};
use crate::gpu::arena::{Arena, Change};
use crate::gpu::buffers::{Buffers, Capacity, TooLarge};
use crate::gpu::commands::Commands;
use crate::gpu::layout;
use crate::gpu::readback::{DeviceError, scoped};
use wgpu::Buffer;

impl GpuStep {
    /// Compiles the kernels for contact points, and with `solves` those of the solver. Creates the buffers, and
    /// includes topology in the meshes.
    pub(super) fn ensure_contacts(&mut self, solves: bool) -> Result<(), StepError> {
        let wanted = if solves { Compiled::All } else { Compiled::Points };
        if self.contacts.is_some() && self.compiled >= wanted {
            return Ok(());
        }
        self.finish_all()?;
        let Self {
            gpu,
            buffers,
            contacts,
            compiled,
            ..
        } = self;
        let made = scoped(gpu, || {
            // Kernels that the device has are not compiled again.
            match wanted {
                Compiled::All => gpu.compile(all_modules(), all_kernels())?,
                _ => gpu.compile(all_modules(), report_kernels())?,
            }
            let missing = contacts.is_none();
            Ok::<_, DeviceError>(missing.then(|| ContactPrograms::new(gpu, buffers, START)))
        });
        let made = made.and_then(|made| made).map_err(StepError::Device)?.transpose()?;
        if *compiled < Compiled::Points {
            self.arena = Arena::with_features();
        }
        self.compiled = self.compiled.max(wanted);
        self.contacts = self.contacts.take().or(made);
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
        let has = self.contacts.as_ref().map(ContactPrograms::capacity);
        let grown_for_contacts = has.zip(for_contacts).map(|(has, needed)| has.grown(needed));
        self.resize(grown, grown_for_contacts)
    }

    /// Makes lists shorter that steps have used little of for a while.
    pub(super) fn shrink(&mut self) -> Result<(), StepError> {
        if !self.peak_usage.is_full() {
            return Ok(());
        }
        if self.shrunk().is_some() {
            self.finish_all()?;
            // Steps that were in flight may have used more.
            if let Some((capacity, for_contacts)) = self.shrunk() {
                self.resize(capacity, for_contacts)?;
            }
        }
        self.peak_usage = PeakUsage::default();
        Ok(())
    }

    fn shrunk(&self) -> Option<(Capacity, Option<StepCapacity>)> {
        let for_contacts = self.contacts.as_ref().map(ContactPrograms::capacity);
        self.peak_usage
            .shrunk(self.buffers.capacity, for_contacts, super::START)
    }

    /// Replaces the buffers, and returns whether the meshes were written again. `for_contacts` is given if there are
    /// buffers for contact points.
    fn resize(&mut self, capacity: Capacity, for_contacts: Option<StepCapacity>) -> Result<bool, StepError> {
        let differs = capacity != self.buffers.capacity;
        let made = scoped(&self.gpu, || {
            let mut commands = Commands::new(&self.gpu, "other lists");
            let buffers = if differs {
                let buffers = Buffers::new(&self.gpu, capacity)?;
                // The only buffer in this set that persists between steps.
                commands.copy(&self.buffers.moved, &buffers.moved);
                Some((impulse_program(&self.gpu, &buffers), buffers))
            } else {
                None
            };
            let contacts = match (&self.contacts, for_contacts) {
                (Some(old), Some(capacity)) => {
                    let buffers = buffers.as_ref().map_or(&self.buffers, |(_, buffers)| buffers);
                    let contacts = ContactPrograms::new(&self.gpu, buffers, capacity)?;
                    contacts.copy_memory(old, &mut commands);
                    Some(contacts)
                }
                _ => None,
            };
            Ok::<_, TooLarge>((buffers, contacts, commands.submit().1))
        });
        let (buffers, contacts, work) = made.map_err(StepError::Device)??;
        if let Some((program, buffers)) = buffers {
            (self.program, self.buffers) = (program, buffers);
        }
        self.contacts = contacts;
        self.buffer_contents.clear();
        self.between = work.after(&self.between);
        self.spare.clear();
        if differs {
            self.write(self.arena.contents())?;
        }
        Ok(differs)
    }

    /// Writes meshes.
    pub(super) fn write(&mut self, changes: Vec<Change>) -> Result<(), StepError> {
        if changes.is_empty() {
            return Ok(());
        }
        let Self {
            gpu, buffers, between, ..
        } = self;
        let mut write = |buffer: &Buffer, at: u64, bytes: &[u8]| {
            gpu.queue.write_buffer(buffer, at, bytes);
            between.uploaded_bytes += bytes.len() as u64;
        };
        scoped(gpu, || {
            for change in changes {
                match change {
                    Change::Words(at, words) => {
                        write(&buffers.words, 4 * u64::from(at), bytemuck::cast_slice(&words));
                    }
                    Change::Header(slot, header) => {
                        let at = u64::from(slot) * size_of::<layout::Mesh>() as u64;
                        write(&buffers.meshes, at, bytemuck::bytes_of(&header));
                    }
                }
            }
        })
        .map_err(StepError::Device)
    }
}
