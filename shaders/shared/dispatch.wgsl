#define_import_path faceoff::dispatch
#import faceoff::constants::shared::MAX_ROW

// One dimension of a dispatch has at most 65,535 workgroups; an indirect dispatch of more does nothing. So workgroups
// are laid out in rows, and the last row may have too many: kernels must compare the number of their workgroup with the
// number needed.

// The number of a workgroup.
fn group_index(id: vec3<u32>) -> u32 {
    return id.y * MAX_ROW + id.x;
}

// The dispatch size for a number of workgroups.
fn rows(groups: u32) -> vec3<u32> {
    return vec3(min(groups, MAX_ROW), (groups + MAX_ROW - 1u) / MAX_ROW, 1u);
}

fn divide_up(a: u32, b: u32) -> u32 {
    return (a + b - 1u) / b;
}
