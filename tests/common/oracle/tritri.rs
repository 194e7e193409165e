//! Exact triangle-triangle test as closed sets, for `f64` corners in any position.
//!
//! Two triangles meet if and only if an edge of one meets the other: if their planes cross, the common part is a point
//! or a segment whose ends lie on edges; if they are coplanar, it is a polygon bounded by edges. Every decision is the
//! sign of an orientation determinant, which `robust` computes without rounding errors.

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Three corners that do not lie on one line.
pub type Triangle = [DVec3; 3];

/// Whether the closed triangles share a point. Neither may be degenerate.
pub fn meet(a: &Triangle, b: &Triangle) -> bool {
    let b_sides = b.map(|p| side(a, p));
    if strictly_one_side(b_sides) {
        return false;
    }
    let a_sides = a.map(|p| side(b, p));
    if strictly_one_side(a_sides) {
        return false;
    }
    (0..3).any(|i| {
        let j = (i + 1) % 3;
        edge_meets([b[i], b[j]], [b_sides[i], b_sides[j]], a) || edge_meets([a[i], a[j]], [a_sides[i], a_sides[j]], b)
    })
}

/// Whether both triangles lie in one plane.
pub fn coplanar(a: &Triangle, b: &Triangle) -> bool {
    b.iter().all(|&p| side(a, p) == 0.0)
}

/// Whether no corner of either lies in the plane of the other, so that the common segment is well conditioned.
pub fn general_position(a: &Triangle, b: &Triangle) -> bool {
    a.iter().all(|&p| side(b, p) != 0.0) && b.iter().all(|&p| side(a, p) != 0.0)
}

/// Whether the corners are collinear: they are if their projections on all three coordinate planes have no area.
pub fn degenerate(t: &Triangle) -> bool {
    (0..3).all(|axis| orient_2d(t.map(|p| drop_axis(p, axis))) == 0.0)
}

/// A number whose sign tells on which side of `t`'s plane `p` lies; zero in the plane.
pub fn side(t: &Triangle, p: DVec3) -> f64 {
    orient_3d(t[0], t[1], t[2], p)
}

fn strictly_one_side(sides: [f64; 3]) -> bool {
    sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0)
}

/// Whether the segment meets the closed triangle, given the sides of its plane on which the segment's ends lie.
pub fn edge_meets([p, q]: [DVec3; 2], [p_side, q_side]: [f64; 2], t: &Triangle) -> bool {
    if (p_side > 0.0 && q_side > 0.0) || (p_side < 0.0 && q_side < 0.0) {
        return false;
    }
    if p_side == 0.0 && q_side == 0.0 {
        return edge_meets_in_plane(p, q, t);
    }
    // The segment crosses the plane in one point, which is inside if and only if the triple products of the line with
    // all three edges have the same sign; zero means that the line meets the edge's line.
    let turns = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| orient_3d(p, q, t[i], t[j]));
    turns.iter().all(|&s| s >= 0.0) || turns.iter().all(|&s| s <= 0.0)
}

/// Whether a segment in the plane of `t` meets `t`. Both are projected on the coordinate plane in which the triangle is
/// largest: there the projection is one to one.
fn edge_meets_in_plane(p: DVec3, q: DVec3, t: &Triangle) -> bool {
    let area = |axis: usize| orient_2d(t.map(|c| drop_axis(c, axis))).abs();
    let axis = (0..3).max_by(|&i, &j| area(i).total_cmp(&area(j))).unwrap();
    let [p, q] = [p, q].map(|c| drop_axis(c, axis));
    let t = t.map(|c| drop_axis(c, axis));
    let inside = |x: [f64; 2]| {
        let turns = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| orient_2d([t[i], t[j], x]));
        turns.iter().all(|&s| s >= 0.0) || turns.iter().all(|&s| s <= 0.0)
    };
    inside(p)
        || inside(q)
        || [(0, 1), (1, 2), (2, 0)]
            .iter()
            .any(|&(i, j)| segments_meet(p, q, t[i], t[j]))
}

fn segments_meet(p: [f64; 2], q: [f64; 2], u: [f64; 2], v: [f64; 2]) -> bool {
    let [pu, pv] = [orient_2d([p, q, u]), orient_2d([p, q, v])];
    let [up, uq] = [orient_2d([u, v, p]), orient_2d([u, v, q])];
    let same_side = |x: f64, y: f64| (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0);
    if same_side(pu, pv) || same_side(up, uq) {
        return false;
    }
    if [pu, pv, up, uq] != [0.0; 4] {
        return true;
    }
    // Collinear segments meet if and only if their boxes do.
    (0..2).all(|k| p[k].min(q[k]) <= u[k].max(v[k]) && u[k].min(v[k]) <= p[k].max(q[k]))
}

fn drop_axis(p: DVec3, axis: usize) -> [f64; 2] {
    match axis {
        0 => [p.y, p.z],
        1 => [p.z, p.x],
        _ => [p.x, p.y],
    }
}

fn orient_2d([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let coord = |[x, y]: [f64; 2]| Coord { x, y };
    orient2d(coord(a), coord(b), coord(c))
}

fn orient_3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let coord = |DVec3 { x, y, z }: DVec3| Coord3D { x, y, z };
    orient3d(coord(a), coord(b), coord(c), coord(d))
}
