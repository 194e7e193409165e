//! Large holes: first a coarse outline is closed, then what lies between it and the boundary.

use super::fill::fill;
use super::split::split_side;
use glam::Vec3;
use std::collections::BinaryHeap;

/// A hole of more edges is closed in steps.
const LARGE: usize = 256;
/// The outline has this many vertices at equal steps along the boundary, and as many at its corners.
const OUTLINE: usize = 64;
/// A piece of the boundary is straight if its vertices are no farther from the line between its ends than this,
/// relative to the length of that line.
const STRAIGHT: f64 = 1.0e-6;

/// Triangulates a boundary of any length as [`fill`] does, in nearly linear time. If there are more than [`LARGE`]
/// edges, the area of the triangles is not the smallest: some lie over others where the boundary bends into the hole.
pub(super) fn fill_any(
    boundary: &[Vec3],
    chord: &dyn Fn(usize, usize) -> bool,
    triangle: &dyn Fn([usize; 3]) -> bool,
) -> Option<Vec<[usize; 3]>> {
    let count = boundary.len();
    if count <= LARGE {
        return fill(boundary, chord, triangle);
    }
    let outline = outline(boundary);
    let places: Vec<Vec3> = outline.iter().map(|&i| boundary[i]).collect();
    let coarse = fill(
        &places,
        |i, j| chord(outline[i], outline[j]),
        |corners| {
            // Splitting an ear along straight pieces of the boundary joins the neighbours of its tip.
            let can_split = ear(corners, outline.len()).is_none_or(|tip| {
                let (before, after) = ((outline[tip] + count - 1) % count, (outline[tip] + 1) % count);
                chord(before.min(after), before.max(after))
            });
            can_split && triangle(corners.map(|i| outline[i]))
        },
    )?;
    // The triangle at each piece of the boundary, by the first vertex of the piece.
    let mut at_piece = vec![0; count];
    let mut pieces: Vec<Vec<[u32; 3]>> = Vec::with_capacity(coarse.len());
    for (number, corners) in coarse.iter().enumerate() {
        for k in 0..3 {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            if to == from + 1 || (from + 1 == outline.len() && to == 0) {
                at_piece[outline[from]] = number;
            }
        }
        pieces.push(vec![corners.map(|i| outline[i] as u32)]);
    }
    let mut triangles = Vec::with_capacity(count - 2);
    let ends = outline.iter().skip(1).copied().chain([count + outline[0]]);
    for (&from, to) in outline.iter().zip(ends) {
        let piece: Vec<usize> = (from..=to).map(|i| i % count).collect();
        if piece.len() == 2 {
            continue;
        }
        let places: Vec<Vec3> = piece.iter().map(|&i| boundary[i]).collect();
        let is_straight = farthest(&places).0 <= STRAIGHT * f64::from(places[0].distance(places[places.len() - 1]));
        let between = (!is_straight).then(|| {
            fill_any(
                &places,
                &|i, j| {
                    let (i, j) = (piece[i], piece[j]);
                    chord(i.min(j), i.max(j))
                },
                &|corners| triangle(corners.map(|i| piece[i])),
            )
        });
        match between.flatten() {
            Some(between) => triangles.extend(between.into_iter().map(|corners| corners.map(|i| piece[i]))),
            None => {
                let numbers: Vec<u32> = piece.iter().map(|&i| i as u32).collect();
                let [first, .., last] = numbers[..] else { continue };
                let inner = &numbers[1..numbers.len() - 1];
                split_side(&mut pieces[at_piece[from]], 0, [first, last], inner);
            }
        }
    }
    triangles.extend(pieces.concat().into_iter().map(|corners| corners.map(|i| i as usize)));
    Some(triangles)
}

/// The corner of a triangle at which two sides of a polygon of `count` vertices meet; `None` if there is none. Corners
/// are ascending.
fn ear([i, k, j]: [usize; 3], count: usize) -> Option<usize> {
    match (k - i, j - k, i + count - j) {
        (1, 1, _) => Some(k),
        (_, 1, 1) => Some(j),
        (1, _, 1) => Some(i),
        _ => None,
    }
}

/// Some of the vertices of a boundary, in their order: some at equal steps, and those where the boundary is farthest
/// from the line between its neighbours among them.
fn outline(boundary: &[Vec3]) -> Vec<usize> {
    let count = boundary.len();
    let mut outline: Vec<usize> = (0..OUTLINE).map(|k| k * count / OUTLINE).collect();
    // Distances are not negative, so their bits are in the same order.
    let mut pieces: BinaryHeap<(u64, usize, usize, usize)> = BinaryHeap::new();
    let piece = |from: usize, to: usize| {
        let places: Vec<Vec3> = (from..=to).map(|i| boundary[i % count]).collect();
        let (distance, at) = farthest(&places);
        (distance.to_bits(), from + at, from, to)
    };
    for (k, &from) in outline.iter().enumerate() {
        pieces.push(piece(from, outline.get(k + 1).copied().unwrap_or(count)));
    }
    while outline.len() < 2 * OUTLINE
        && let Some((distance, at, from, to)) = pieces.pop()
        && distance > 0
    {
        outline.push(at);
        pieces.extend([piece(from, at), piece(at, to)]);
    }
    outline.sort_unstable();
    outline
}

/// The largest distance of the vertices of a piece from the line between its ends, in the unit of the mesh, and the
/// vertex.
fn farthest(piece: &[Vec3]) -> (f64, usize) {
    let [first, .., last] = piece else { return (0.0, 0) };
    let (first, last) = (first.as_dvec3(), last.as_dvec3());
    let along = (last - first).normalize_or_zero();
    let length = first.distance(last);
    let distance = |p: &Vec3| {
        let p = p.as_dvec3() - first;
        (p - along * p.dot(along).clamp(0.0, length)).length()
    };
    let distances = piece.iter().map(distance).zip(0..);
    distances
        .skip(1)
        .take(piece.len() - 2)
        .fold((0.0, 0), |most, at| if at.0 > most.0 { at } else { most })
}
