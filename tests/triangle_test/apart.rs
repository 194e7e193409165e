//! Bodies that are close to each other and do not touch. Flush faces of blocks side by side lie in common planes but
//! for the rounding of their poses, so that signs of heights alone decide nothing.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::geometry::triangle::intersect;
use bevy_faceoff::queries::{Placed, Placement, QueryShape, check, touching};
use glam::{DQuat, DVec3, Quat, Vec3};

fn unit(random: &mut fastrand::Rng) -> f64 {
    2.0 * random.f64() - 1.0
}

fn rotation(random: &mut fastrand::Rng) -> DQuat {
    loop {
        let q = DQuat::from_xyzw(unit(random), unit(random), unit(random), unit(random));
        if (0.1..1.0).contains(&q.length()) {
            return q.normalize();
        }
    }
}

fn block(mesh: &CollisionMesh, size: Vec3, translation: Vec3, rotation: Quat) -> Placement {
    Placement {
        mesh: mesh.clone(),
        translation,
        rotation,
        scale: size,
    }
}

const SIZES: [Vec3; 5] = [
    Vec3::ONE,
    Vec3::splat(2.0),
    Vec3::new(1.0, 2.0, 3.0),
    Vec3::new(0.1, 1.0, 0.3),
    Vec3::splat(10.0),
];

#[test]
fn blocks_side_by_side_with_a_gap_of_1e_5_do_not_touch() {
    let cube = CollisionMesh::new(&shapes::cube(1.0));
    let mut random = fastrand::Rng::with_seed(7);
    for size in SIZES {
        let about_x = Quat::from_rotation_x(0.3);
        let beside = Vec3::X * size.x + Vec3::new(1e-5, 1e-12, 7e-13);
        let pair = [
            block(&cube, size, Vec3::ZERO, about_x),
            block(&cube, size, beside, about_x),
        ];
        assert_eq!(check(&pair).unwrap(), [], "{size}");
        assert_eq!(touching(&pair).unwrap(), [[0u32; 2]; 0], "{size}");
        for _ in 0..100 {
            let turn = Quat::from_rotation_z(random.f32() * 6.0);
            let beside = turn.as_dquat() * DVec3::X * (f64::from(size.x) + 1e-5);
            let pair = [
                block(&cube, size, Vec3::ZERO, turn),
                block(&cube, size, beside.as_vec3(), turn),
            ];
            assert_eq!(check(&pair).unwrap(), [], "{size}, {turn}");
            assert_eq!(touching(&pair).unwrap(), [[0u32; 2]; 0], "{size}, {turn}");
        }
    }
}

/// Poses in double precision keep 2e-12 m at 10 km.
#[test]
fn blocks_within_ten_kilometres_touch_if_they_overlap_by_1e_9_and_not_if_they_are_1e_9_apart() {
    let cube = CollisionMesh::new(&shapes::cube(1.0));
    let mut random = fastrand::Rng::with_seed(8);
    for case in 0..1000 {
        let turn = if case % 2 == 0 {
            rotation(&mut random)
        } else {
            DQuat::from_rotation_z(random.f64() * 6.0)
        };
        let size = SIZES[case % 5];
        let at = DVec3::new(unit(&mut random), unit(&mut random), unit(&mut random)) * 1e4;
        let placed = Placed::new(&cube, at, turn, size).unwrap();
        let axis = case % 3;
        for (gap, touches) in [
            (1e-5, false),
            (1e-7, false),
            (1e-9, false),
            (-1e-9, true),
            (-1e-5, true),
        ] {
            let shape = QueryShape::Mesh(&cube, size);
            let beside = at + turn * DVec3::AXES[axis] * (f64::from(size[axis]) + gap);
            assert_eq!(placed.overlaps(&shape, beside, turn), touches, "{case}: {gap:e}");
        }
    }
}

/// The band in which triangles count as touching, as the documentation states it: the rounding of their corners.
#[test]
fn triangles_in_one_plane_but_for_rounding_are_apart_from_a_millionth_of_a_millionth_of_their_size() {
    let mut random = fastrand::Rng::with_seed(9);
    for case in 0..20_000 {
        let (turn, at) = (
            rotation(&mut random),
            DVec3::new(unit(&mut random), unit(&mut random), unit(&mut random)),
        );
        let corner = |x: f64, y: f64| turn * DVec3::new(x, y, 0.0) + at;
        let gap = 10f64.powf(-12.0 + 10.0 * random.f64());
        let below = [-random.f64(), -random.f64(), -random.f64()];
        let above = [random.f64() + gap, random.f64() + gap, gap];
        let a = [(0.0, below[0]), (1.0, below[1]), (random.f64(), 0.0)].map(|(x, y)| corner(x, y));
        let b = [(0.0, above[0]), (1.0, above[1]), (random.f64(), above[2])].map(|(x, y)| corner(x, y));
        assert_eq!(intersect(&a, &b), None, "{case}: {gap:e} apart");
        assert_eq!(intersect(&b, &a), None, "{case}: {gap:e} apart");
        // With a corner in common they touch.
        let b = [b[0], b[1], a[2]];
        assert!(intersect(&a, &b).is_some() && intersect(&b, &a).is_some(), "{case}");
    }
}
