//! Images of a running scene, drawn on the CPU: perspective, a depth buffer and flat shading.

use crate::Outcome;
use crate::canvas::{Canvas, PAPER};
use crate::scenes::{Framing, Unseen};
use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use glam::Affine3A;
use std::path::Path;

/// Width and height of an image in pixels.
const SIZE: [u32; 2] = [960, 720];
/// Samples per pixel along each axis.
const SAMPLES: u32 = 2;
/// The height of the view at distance 1.
const FIELD: f32 = 0.78;

/// Draws the bodies of a world and writes `DIR/frame_STEP.png`.
pub fn save(world: &mut World, framing: &Framing, step: usize, folder: &Path) -> Outcome {
    draw(world, framing).save(&folder.join(format!("frame_{step:06}.png")))
}

/// Draws the bodies of a world.
pub fn draw(world: &mut World, framing: &Framing) -> Canvas {
    let mut view = View::new(framing);
    let mut bodies = world.query_filtered::<(&MeshCollider, &Transform), Without<Unseen>>();
    let meshes = world.resource::<Assets<CollisionMesh>>();
    for (i, (collider, transform)) in bodies.iter(world).enumerate() {
        if let Some(mesh) = meshes.get(&collider.0) {
            view.body(mesh, transform, colour(i));
        }
    }
    if framing.edges {
        view.edges(framing.side);
    }
    view.finish()
}

/// A muted colour per body.
fn colour(i: usize) -> Vec3 {
    let wheel = colorous::SINEBOW.eval_continuous((i as f64 * 0.618_033_988_75).fract());
    let bright = Vec3::new(wheel.r.into(), wheel.g.into(), wheel.b.into());
    bright.lerp(Vec3::splat(205.0), 0.45)
}

/// The image so far, at sample resolution, and the camera.
struct View {
    to_camera: Affine3A,
    light: Vec3,
    width: usize,
    height: usize,
    colours: Vec<[u8; 3]>,
    /// Inverse depth; 0 is at infinity.
    nearness: Vec<f32>,
    corners: Vec<Vec3>,
}

impl View {
    /// A view of a box from above one of its corners.
    fn new(framing: &Framing) -> Self {
        let eye = framing.center + framing.side.max(f32::MIN_POSITIVE) * Vec3::new(0.98, 0.8, 2.0);
        let [width, height] = SIZE.map(|n| (n * SAMPLES) as usize);
        Self {
            to_camera: Affine3A::look_at_rh(eye, framing.center, Vec3::Y),
            light: Vec3::new(0.4, 0.8, 0.55).normalize(),
            width,
            height,
            colours: vec![PAPER; width * height],
            nearness: vec![0.0; width * height],
            corners: Vec::new(),
        }
    }

    /// Projects a point of the world to sample coordinates and inverse depth, which is not positive behind the camera.
    fn project(&self, point: Vec3) -> Vec3 {
        let p = self.to_camera.transform_point3(point);
        let near = -1.0 / p.z;
        let scale = self.height as f32 * near / FIELD;
        Vec3::new(
            0.5 * self.width as f32 + p.x * scale,
            0.5 * self.height as f32 - p.y * scale,
            near,
        )
    }

    fn body(&mut self, mesh: &CollisionMesh, transform: &Transform, colour: Vec3) {
        let place = |p: &Vec3| transform.transform_point(*p);
        let points: Vec<Vec3> = mesh.mesh.vertices().iter().map(place).collect();
        self.corners.clear();
        for p in &points {
            let projected = self.project(*p);
            self.corners.push(projected);
        }
        for t in mesh.mesh.triangles() {
            let [p, q, r] = t.map(|v| points[v as usize]);
            let normal = (q - p).cross(r - p).normalize_or_zero();
            // Both sides are lit, because meshes may be open or inside out.
            let shade = 0.35 + 0.65 * (0.5 + 0.5 * normal.dot(self.light)).clamp(0.0, 1.0);
            let [red, green, blue] = (colour * shade).to_array().map(|c| c as u8);
            self.triangle(t.map(|v| self.corners[v as usize]), [red, green, blue]);
        }
    }

    fn triangle(&mut self, [p, q, r]: [Vec3; 3], colour: [u8; 3]) {
        let area = (q - p).truncate().perp_dot((r - p).truncate());
        let behind = p.z <= 0.0 || q.z <= 0.0 || r.z <= 0.0;
        if behind || area == 0.0 || !area.is_finite() {
            return;
        }
        let range = |a: f32, b: f32, c: f32, limit: usize| {
            let low = a.min(b).min(c).max(0.0) as usize;
            let high = (a.max(b).max(c).max(-1.0) + 1.0) as usize;
            low..high.min(limit)
        };
        for y in range(p.y, q.y, r.y, self.height) {
            for x in range(p.x, q.x, r.x, self.width) {
                let s = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let share = |a: Vec3, b: Vec3| (b.truncate() - a.truncate()).perp_dot(s - a.truncate()) / area;
                let (u, v, w) = (share(q, r), share(r, p), share(p, q));
                if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                    self.sample(x, y, u * p.z + v * q.z + w * r.z, colour);
                }
            }
        }
    }

    fn sample(&mut self, x: usize, y: usize, near: f32, colour: [u8; 3]) {
        let at = y * self.width + x;
        if near > self.nearness[at] {
            self.nearness[at] = near;
            self.colours[at] = colour;
        }
    }

    /// Draws the edges of a cube about the origin.
    fn edges(&mut self, side: f32) {
        let corner =
            |i: usize| 0.5 * side * Vec3::from_array([0, 1, 2].map(|k| if i >> k & 1 == 1 { 1.0 } else { -1.0 }));
        for i in 0..8 {
            for k in (0..3).filter(|k| i >> k & 1 == 0) {
                let (from, to) = (self.project(corner(i)), self.project(corner(i | 1 << k)));
                let steps = (to - from).truncate().abs().max_element().min(1.0e4) as usize + 1;
                for step in 0..=steps {
                    // Inverse depth is linear on the screen.
                    let p = from.lerp(to, step as f32 / steps as f32);
                    for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)] {
                        let (x, y) = ((p.x + dx) as usize, (p.y + dy) as usize);
                        if p.z > 0.0 && x < self.width && y < self.height {
                            self.sample(x, y, p.z, [90; 3]);
                        }
                    }
                }
            }
        }
    }

    /// The final image: the mean of each pixel's samples.
    fn finish(&self) -> Canvas {
        let mut canvas = Canvas::new(SIZE[0], SIZE[1]);
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                let mut sum = [0u32; 3];
                for dy in 0..SAMPLES {
                    for dx in 0..SAMPLES {
                        let at = (y * SAMPLES + dy) as usize * self.width + (x * SAMPLES + dx) as usize;
                        for (sum, part) in sum.iter_mut().zip(self.colours[at]) {
                            *sum += u32::from(part);
                        }
                    }
                }
                canvas.set(x, y, sum.map(|s| (s / (SAMPLES * SAMPLES)) as u8));
            }
        }
        canvas
    }
}
