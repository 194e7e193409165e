#define_import_path faceoff::dispatch
#import faceoff::constants::shared::MAX_ROW

// One dimension of a dispatch holds 65,535 groups, and an indirect one with more does nothing at all. So groups stand in
// rows; kernels turn to this module for their number, and must check it against the number wanted.

// The number of a workgroup.
fn group_index(id: vec3<u32>) -> u32 {
    return id.y * MAX_ROW + id.x;
}

// Rows for so many groups.
fn rows(groups: u32) -> vec3<u32> {
    return vec3(min(groups, MAX_ROW), (groups + MAX_ROW - 1u) / MAX_ROW, 1u);
}

fn divide_up(a: u32, b: u32) -> u32 {
    return (a + b - 1u) / b;
}
