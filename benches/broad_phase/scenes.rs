//! Spheres at the paper's density: about 0.7 pairs a body.

use bevy_faceoff::step::StepState;
use bevy_faceoff::types::body::{CollisionLayers, RigidBody};
use glam::Vec3;

/// Sizes and kinds of the bodies of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scene {
    /// All of the same size.
    Equal,
    /// Diameters from 1 to 100, as many between 1 and 10 as between 10 and 100.
    Spread,
    /// Equal ones, and a static one 1000 times as large that reaches into their midst.
    OneHuge,
    /// Equal ones of which every hundredth moves.
    MostlyStatic,
}

impl Scene {
    /// All of them; the first is what the others are compared with.
    pub const ALL: [Self; 4] = [Self::Equal, Self::Spread, Self::OneHuge, Self::MostlyStatic];

    /// Its name in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Equal => "equal sizes",
            Self::Spread => "sizes 1:100",
            Self::OneHuge => "one static body of 1000 x",
            Self::MostlyStatic => "99 of 100 static",
        }
    }

    /// `count` bodies. Only what the stage reads is filled in.
    pub fn state(self, count: usize) -> StepState {
        let mut random = fastrand::Rng::with_seed(7);
        let radius: Vec<f32> = (0..count)
            .map(|_| match self {
                Self::Spread => 0.5 * 100f32.powf(random.f32()),
                _ => 0.5,
            })
            .collect();
        // Two bodies at random places overlap with the probability volume of a ball of both radii / volume of the box.
        let mean = |f: &dyn Fn(f64) -> f64| radius.iter().map(|&r| f(r as f64)).sum::<f64>() / count as f64;
        let [m1, m2, m3] = [mean(&|r| r), mean(&|r| r * r), mean(&|r| r * r * r)];
        let ball = 4.0 / 3.0 * std::f64::consts::PI * (2.0 * m3 + 6.0 * m1 * m2);
        let side = (0.5 * count as f64 * ball / 0.7).cbrt() as f32;

        let mut state = StepState::default();
        for (i, radius) in radius.into_iter().enumerate() {
            let kind = match self {
                Self::MostlyStatic if i % 100 != 0 => RigidBody::Static,
                _ => RigidBody::Dynamic,
            };
            let center = Vec3::from_array([0; 3].map(|_| side * (random.f32() - 0.5)));
            push(&mut state, kind, center, radius);
        }
        if self == Self::OneHuge {
            // Its surface passes through the middle, nearly flat: a floor.
            push(&mut state, RigidBody::Static, Vec3::NEG_Y * 500.0, 500.0);
        }
        state
    }
}

fn push(state: &mut StepState, kind: RigidBody, center: Vec3, radius: f32) {
    let bodies = &mut state.input.bodies;
    bodies.center.push(center);
    bodies.radius.push(radius);
    bodies.kind.push(kind);
    bodies.layers.push(CollisionLayers::default());
    bodies.sensor.push(false);
}
