//! Brute force: every triangle of one body against every triangle of the other, every body against every other.
//!
//! The only shortcut is that triangles with disjoint boxes do not meet.

use super::body::{Body, World};
use super::inside::contained;
use super::tritri::meet;
use std::ops::ControlFlow;

/// Two bodies that touch, `a < b`.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch {
    pub a: u32,
    pub b: u32,
    pub contained: bool,
    /// Pairs of input faces, `a`'s first, ascending.
    pub faces: Vec<[u32; 2]>,
}

/// All bodies that touch, ascending.
pub fn check(worlds: &[World]) -> Vec<Touch> {
    let mut found = vec![];
    for (i, a) in worlds.iter().enumerate() {
        for (j, b) in worlds.iter().enumerate().skip(i + 1) {
            if !a.bounds.meets(&b.bounds) {
                continue;
            }
            let faces = face_pairs(a, b);
            let contained = faces.is_empty() && contained(a, b);
            if contained || !faces.is_empty() {
                found.push(Touch {
                    a: i as u32,
                    b: j as u32,
                    contained,
                    faces,
                });
            }
        }
    }
    found
}

/// All pairs of faces that meet, ascending.
pub fn face_pairs(a: &World, b: &World) -> Vec<[u32; 2]> {
    let mut found = vec![];
    let _ = for_each_meeting(a, b, |pair| {
        found.push(pair);
        ControlFlow::Continue(())
    });
    found.sort_unstable();
    found
}

/// Whether any two faces meet.
pub fn surfaces_meet(a: &Body, b: &Body) -> bool {
    for_each_meeting(&a.world(), &b.world(), |_| ControlFlow::Break(())).is_break()
}

fn for_each_meeting(a: &World, b: &World, mut visit: impl FnMut([u32; 2]) -> ControlFlow<()>) -> ControlFlow<()> {
    // Only triangles whose box meets the other body's box can meet it.
    let near = |body: &World, other: &World| -> Vec<usize> {
        (0..body.triangles.len())
            .filter(|&i| body.boxes[i].meets(&other.bounds))
            .collect()
    };
    let of_a = near(a, b);
    let mut of_b = near(b, a);
    of_b.sort_by(|&i, &j| b.boxes[i].low.x.total_cmp(&b.boxes[j].low.x));
    for &i in &of_a {
        // From the first box that starts beyond this one's end on, all are separated along x.
        let end = of_b.partition_point(|&j| b.boxes[j].low.x <= a.boxes[i].high.x);
        for &j in &of_b[..end] {
            if a.boxes[i].meets(&b.boxes[j]) && meet(&a.triangles[i], &b.triangles[j]) {
                visit([a.faces[i], b.faces[j]])?;
            }
        }
    }
    ControlFlow::Continue(())
}
