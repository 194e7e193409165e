//! Compiled kernels on disk: kept, used, and never trusted.

use bevy_faceoff::gpu::device::{self, Gpu};
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::types::kernel_cache::KernelCache;
use std::fs;
use std::path::{Path, PathBuf};
use wgpu::Features;

/// Whether a start with this setting read stored kernels; `None` if it keeps none.
fn start(setting: &KernelCache) -> Option<bool> {
    let step = device::open(true, setting).and_then(GpuStep::new).unwrap();
    step.gpu().stored_kernels().map(|stored| stored.was_read)
}

fn files(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect()
}

fn can_keep(gpu: &Gpu) -> bool {
    let adapter_can = wgpu::util::pipeline_cache_key(&gpu.info).is_some();
    adapter_can && gpu.device.features().contains(Features::PIPELINE_CACHE)
}

pub fn kernels_are_kept_on_disk(gpu: &Gpu) {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("made/when/needed");
    let setting = KernelCache::Folder(inner.clone());
    if !can_keep(gpu) {
        assert_eq!(start(&setting), None);
        return;
    }
    assert_eq!(start(&setting), Some(false), "there is nothing yet");
    let [file] = files(&inner).try_into().unwrap();
    let sound = fs::read(&file).unwrap();
    let written = fs::metadata(&file).unwrap().modified().unwrap();
    assert_eq!(start(&setting), Some(true));
    let again = fs::metadata(&file).unwrap().modified().unwrap();
    assert_eq!(
        (files(&inner).len(), again),
        (1, written),
        "the same kernels are not written again"
    );

    let half = sound[..sound.len() / 2].to_vec();
    let mut changed = sound.clone();
    *changed.last_mut().unwrap() ^= 1;
    let longer = [sound.as_slice(), b"more"].concat();
    for damaged in [Vec::new(), b"garbage".to_vec(), vec![7; 100_000], half, changed, longer] {
        fs::write(&file, &damaged).unwrap();
        assert_eq!(start(&setting), Some(false), "{} bytes", damaged.len());
        assert_eq!(start(&setting), Some(true), "it was replaced");
    }
    // What is far too long is not even read.
    fs::File::create(&file).unwrap().set_len(1 << 40).unwrap();
    assert_eq!(start(&setting), Some(false));
}

pub fn a_folder_that_cannot_be_written_is_no_error(gpu: &Gpu) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a file");
    fs::write(&file, "not a folder").unwrap();
    let expected = can_keep(gpu).then_some(false);
    for _ in 0..2 {
        assert_eq!(start(&KernelCache::Folder(file.clone())), expected);
    }
    assert_eq!(fs::read(&file).unwrap(), b"not a folder");
    assert_eq!(start(&KernelCache::Off), None);
    assert_eq!(files(folder.path()).len(), 1);
}
