//! Compiled kernels on disk: wgpu's [`PipelineCache`] in a file.
//!
//! A file begins with the BLAKE3 digest of the rest. The rest begins with wgpu's header, which tells the adapter and
//! the version of its driver.

use super::device::Gpu;
use super::readback::scoped;
use crate::types::kernel_cache::KernelCache;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::{Features, PipelineCache, PipelineCacheDescriptor};

/// Files that are longer are not read. All our kernels take a few megabytes.
const LONGEST: u64 = 64 << 20;

/// What makes a digest ours. Change the number if what is digested changes.
const CONTEXT: &str = "bevy_faceoff kernels on disk 1";

/// The length of a digest, bytes.
const DIGEST: usize = blake3::OUT_LEN;

/// The compiled kernels of a device, and the file that keeps them. Clones refer to the same kernels.
#[derive(Clone, Debug)]
pub struct StoredKernels {
    /// For the compilation of kernels.
    pub(super) cache: PipelineCache,
    file: PathBuf,
    /// Digest of what the file holds.
    stored: Arc<Mutex<Option<blake3::Hash>>>,
    /// Whether there was a sound file.
    pub was_read: bool,
}

impl StoredKernels {
    /// The kernels in the file of this device; `None` if the device cannot keep any. A file that is not sound is
    /// ignored.
    pub(super) fn open(gpu: &Gpu, setting: &KernelCache) -> Option<Self> {
        if !gpu.device.features().contains(Features::PIPELINE_CACHE) {
            return None;
        }
        let adapter = wgpu::util::pipeline_cache_key(&gpu.info)?;
        // Kernels of other versions would stay in it for ever.
        let file = setting
            .folder()?
            .join(format!("{adapter}_{}", env!("CARGO_PKG_VERSION")));
        let read = read(&file);
        let (digest, data) = match &read {
            Ok((digest, data)) => (Some(*digest), Some(data.as_slice())),
            Err(error) => {
                tracing::debug!("no compiled kernels are read from {}: {error}", file.display());
                (None, None)
            }
        };
        let cache = scoped(gpu, || create(gpu, data)).ok()?;
        Some(Self {
            cache,
            file,
            stored: Arc::new(Mutex::new(digest)),
            was_read: digest.is_some(),
        })
    }

    /// Writes the file if the kernels differ from those that it holds. A failure to write is no error.
    pub(super) fn store(&self, gpu: &Gpu) {
        let Ok(Some(data)) = scoped(gpu, || self.cache.get_data()) else {
            return;
        };
        let digest = digest(&data);
        let mut stored = self.stored.lock().unwrap_or_else(PoisonError::into_inner);
        if *stored == Some(digest) {
            return;
        }
        match write(&self.file, digest, &data) {
            Ok(()) => *stored = Some(digest),
            Err(error) => tracing::debug!("compiled kernels are not kept in {}: {error}", self.file.display()),
        }
    }
}

#[allow(
    unsafe_code,
    reason = "drivers trust what a cache holds, and wgpu has no other way to load one"
)]
fn create(gpu: &Gpu, data: Option<&[u8]>) -> PipelineCache {
    let descriptor = PipelineCacheDescriptor {
        label: Some("faceoff"),
        data,
        // What wgpu finds to be of another adapter or driver is not used.
        fallback: true,
    };
    // SAFETY: `data` must come from `PipelineCache::get_data`. `read` returns only bytes whose digest is right, with a
    // context that nothing but `write` uses, and `write` is given what `get_data` returned. A file that was damaged or
    // came from another program does not pass. Who could forge one on purpose can write the user's files.
    unsafe { gpu.device.create_pipeline_cache(&descriptor) }
}

fn digest(data: &[u8]) -> blake3::Hash {
    blake3::Hasher::new_derive_key(CONTEXT).update(data).finalize()
}

/// What `write` has written there, with its digest.
fn read(file: &Path) -> io::Result<(blake3::Hash, Vec<u8>)> {
    let length = fs::metadata(file)?.len();
    if length > LONGEST {
        return Err(io::Error::other(format!("{length} bytes are too many")));
    }
    let mut bytes = fs::read(file)?;
    let data = bytes.split_off(bytes.len().min(DIGEST));
    let digest = digest(&data);
    if bytes != digest.as_bytes() {
        return Err(io::Error::other("the file is damaged"));
    }
    Ok((digest, data))
}

/// Replaces the file as a whole, so that no other process reads half of it.
fn write(file: &Path, digest: blake3::Hash, data: &[u8]) -> io::Result<()> {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    let folder = file.parent().ok_or_else(|| io::Error::other("it is in no folder"))?;
    fs::create_dir_all(folder)?;
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    let new = folder.join(format!("{}.{number}.new", std::process::id()));
    let written = fs::write(&new, [digest.as_bytes(), data].concat()).and_then(|()| fs::rename(&new, file));
    if written.is_err() {
        // The file may not exist.
        let _ = fs::remove_file(&new);
    }
    written
}
