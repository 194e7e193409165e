//! Bodies that fall into a bin.

use super::{Body, Scene, Shape};
use glam::{Quat, Vec3};

/// Adds a floor of edge `floor` at height 0 and four walls, 1 m thick, around an interior of width `width`. The walls
/// at +x and +z are the second and the fourth body.
pub fn walls(scene: &mut Scene, floor: f32, width: f32, height: f32) {
    let (half, middle, edge) = (0.5 * width, 0.5 * height, width + 2.0);
    scene.block(Vec3::NEG_Y * 0.5, Vec3::new(floor, 1.0, floor));
    for normal in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
        let edges = Vec3::Y * height + (Vec3::ONE - Vec3::Y - normal.abs()) * edge + normal.abs();
        scene.block(normal * (half + 0.5) + Vec3::Y * middle, edges);
    }
}

/// Start positions of `count` bodies, `across` by `across` in a layer, without overlaps. `first` is the position of the
/// first, at a corner of the lowest layer.
pub fn layers(count: usize, across: usize, spacing: Vec3, first: Vec3) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let cell = [i % across, i / (across * across), i / across % across].map(|k| k as f32);
        Vec3::from_array(cell) * spacing + first
    })
}

/// Adds `count` knots of diameter 1, `across` by `across` in a layer, centred on the y axis.
pub fn knots(scene: &mut Scene, count: usize, across: usize, mut turn: impl FnMut() -> Quat) {
    let spacing = Vec3::new(1.1, 1.3, 1.1);
    let first = Vec3::Y - spacing * Vec3::new(1.0, 0.0, 1.0) * (0.5 * (across - 1) as f32);
    for at in layers(count, across, spacing, first) {
        scene.add(Body::new(Shape::Knot, at, turn()));
    }
}

/// Distance of layers and of neighbours in [`heap`], metres.
const SPACING: f32 = 1.05;

/// A bin that bodies of diameter 1 fill to about its width.
pub struct Heap {
    /// Floor and walls, without moving bodies.
    pub bin: Scene,
    /// Width of the interior, metres.
    pub width: f32,
    /// Height of the walls, metres.
    pub height: f32,
    /// Bodies per row.
    across: usize,
}

/// The bin for `count` bodies.
pub fn heap(count: usize) -> Heap {
    let across = (count as f32).cbrt().ceil().max(2.0) as usize;
    let width = SPACING * across as f32 + 0.3;
    let layers = count.div_ceil(across * across);
    let height = 1.0 + SPACING * layers as f32;
    let mut bin = Scene::new();
    walls(&mut bin, width + 2.0, width, height);
    Heap {
        bin,
        width,
        height,
        across,
    }
}

impl Heap {
    /// Centres of mass and rotations of `count` bodies above the bin.
    pub fn poses(&self, count: usize, random: &mut impl FnMut() -> f32) -> impl Iterator<Item = (Vec3, Quat)> {
        let low = 0.5 * SPACING - 0.5 * self.width + 0.15;
        layers(count, self.across, Vec3::splat(SPACING), Vec3::new(low, 1.0, low)).map(|center| {
            let turn = Vec3::from_array([0; 3].map(|_| 4.0 * random() - 2.0));
            (center, Quat::from_scaled_axis(turn))
        })
    }
}
