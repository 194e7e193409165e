#define_import_path faceoff::agree

// Barriers may stand only where all threads of a workgroup pass. Compilers of some APIs, such as FXC, refuse a kernel
// unless they see it: a condition around a barrier must come from constants, uniforms, workgroup ids, lists that
// nothing writes, or `workgroupUniformLoad`. A test of the host checks this for all kernels.

var<workgroup> agreed: u32;

// The first thread's value, for all threads. It has two barriers, so earlier writes to workgroup memory are visible
// afterwards.
fn agree(thread: u32, value: u32) -> u32 {
    if thread == 0u {
        agreed = value;
    }
    return workgroupUniformLoad(&agreed);
}
