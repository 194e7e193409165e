//! How far from the axis of a body's rotation another body may touch it.
//!
//! The surface of a body that turns moves fastest where it is farthest from the axis. But there it may have no
//! neighbour: a nut turns about its bolt, and only its thread is near it. So what bodies may do to each other follows
//! from the speed of their surfaces where both are.

use super::mesh_arena::MeshArena;
use super::placed_mesh::PlacedMesh;
use crate::state::Bodies;
use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Upper bound of the distance from the axis of rotation of collider `i`, through its centre of mass, at which `j` may
/// touch it, metres; no more than its bounding radius. `motion` bounds how far points of `j` move relative to the
/// centre of mass of `i`.
///
/// Points of `i` keep their distance from the axis. Seen along the axis, `j` lies in an octagon around it whose sides
/// are at the support heights of `j`. No point of an octagon is farther from the axis than the farthest of the eight
/// points in which two adjacent sides meet.
pub fn arm(bodies: &Bodies, meshes: &MeshArena, [i, j]: [u32; 2], motion: f32) -> f32 {
    let [own, other] = [i, j].map(|i| PlacedMesh::of(bodies, meshes, i));
    let Some(axis) = bodies.angular_velocity[i as usize].try_normalize() else {
        return own.radius;
    };
    let (u, v) = axis.any_orthonormal_pair();
    let center = (other.frame.center - own.frame.center).as_vec3();
    let most = own.radius - motion;
    let to_local = other.frame.rotation.transpose().as_mat3();
    let directions = {
        let (p, q) = ((u + v) * FRAC_1_SQRT_2, (v - u) * FRAC_1_SQRT_2);
        [u, p, v, q, -u, -p, -v, -q]
    };
    let height = |k: usize| {
        let direction = directions[k % 8];
        let local = other.scale * (to_local * direction);
        center.dot(direction) + local.dot(other.mesh.heights.support(local)) + other.rounding
    };
    // The side towards the centre of `j` is probably the farthest: beyond the radius nothing else matters.
    let first = octant(center.dot(u), center.dot(v));
    let (mut one, mut square) = (height(first), 0.0_f32);
    for k in first + 1..=first + 8 {
        let next = height(k);
        let corner = 2.0 * (one * one + next * next - SQRT_2 * one * next);
        if corner.is_nan() || corner.sqrt() >= most {
            return own.radius;
        }
        (one, square) = (next, square.max(corner));
    }
    square.sqrt() + motion
}

/// Number of the eighth of a turn, from the x axis to the y axis, in which a vector points.
fn octant(x: f32, y: f32) -> usize {
    let flat = usize::from(x.abs() < y.abs());
    match (x < 0.0, y < 0.0) {
        (false, false) => flat,
        (true, false) => 3 - flat,
        (true, true) => 4 + flat,
        (false, true) => 7 - flat,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::shapes;
    use crate::state::Body;
    use crate::testing::scenes::any_vector;
    use glam::{Quat, Vec3};

    #[test]
    fn no_point_of_the_other_body_within_reach_is_farther_from_the_axis() {
        let shapes = [shapes::torus_240(), shapes::cube(1.0), shapes::knot_1120()];
        let mut meshes = MeshArena::default();
        let slots = shapes.each_ref().map(|shape| meshes.add(CollisionMesh::new(shape)));
        let mut random = fastrand::Rng::with_seed(4);
        let (mut nearer, mut closest) = (0, f32::INFINITY);
        for round in 0..600 {
            let mut bodies = Bodies::default();
            let spin = any_vector(&mut || random.f32());
            for i in 0..2 {
                let at = [0.0, 0.5][i] * any_vector(&mut || random.f32());
                let turn = Quat::from_scaled_axis(3.0 * any_vector(&mut || random.f32()));
                let scale = [Vec3::splat(2.0), Vec3::new(0.3, -0.5, 0.8)][(round + i) % 2];
                let mut body = Body::at_rest(slots[(round + i) % 3], at, turn, scale);
                body.angular_velocity = spin;
                bodies.push(&body, &meshes).unwrap();
            }
            let arm = arm(&bodies, &meshes, [0, 1], 0.0);
            let own = bodies.frame[0].center;
            let other = &shapes[(round + 1) % 3];
            let frame = &bodies.frame[1];
            let axis = spin.normalize().as_dvec3();
            let from_axis = other.vertices().iter().map(|vertex| {
                let at = frame.position + frame.rotation * (frame.scale * vertex.as_dvec3());
                axis.cross(at - own).length() as f32
            });
            let farthest = from_axis.fold(0.0, f32::max);
            assert!(
                arm >= farthest.min(bodies.radius[0]) - 1.0e-5,
                "round {round}: {arm}, {farthest}"
            );
            if arm < bodies.radius[0] {
                nearer += 1;
                closest = closest.min(arm / farthest);
            }
        }
        assert!(nearer > 50 && closest < 1.1, "{nearer} nearer, {closest}");
    }
}
