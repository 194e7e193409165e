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
/// From where the scene is seen.
const FROM: Vec3 = Vec3::new(0.98, 1.2, 2.0);
/// How much farther away the camera is than it must be to see the whole scene.
const MARGIN: f32 = 1.04;
/// What is nearer to the camera is not drawn, as a part of the distance of the scene.
const NEAREST: f32 = 0.02;
/// The colour of what does not move.
const FIXED: Vec3 = Vec3::splat(200.0);

/// Draws the bodies of a world and writes `DIR/frame_STEP.png`.
pub fn save(world: &mut World, framing: &Framing, step: usize, folder: &Path) -> Outcome {
    draw(world, framing).save(&folder.join(format!("frame_{step:06}.png")))
}

/// Draws the bodies of a world.
pub fn draw(world: &mut World, framing: &Framing) -> Canvas {
    let mut view = View::new(framing);
    let mut query = world.query_filtered::<(Entity, &MeshCollider, &Transform, &RigidBody), Without<Unseen>>();
    let mut bodies: Vec<_> = query.iter(world).collect();
    // A query has its own order, which changes when a body gets another component. Colours stay.
    bodies.sort_unstable_by_key(|(entity, ..)| *entity);
    let meshes = world.resource::<Assets<CollisionMesh>>();
    for (i, (_, collider, transform, kind)) in bodies.into_iter().enumerate() {
        let colour = if *kind == RigidBody::Static { FIXED } else { colour(i) };
        if let Some(mesh) = meshes.get(&collider.0) {
            view.body(mesh, transform, colour);
        }
    }
    if framing.edges {
        view.edges(&framing.corners());
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
    /// Distance of the nearest plane that is drawn.
    nearest: f32,
    light: Vec3,
    width: usize,
    height: usize,
    colours: Vec<[u8; 3]>,
    /// Inverse depth; 0 is at infinity.
    nearness: Vec<f32>,
    /// Corners of the body in hand, in the world and before the camera.
    corners: Vec<[Vec3; 2]>,
}

impl View {
    /// A view from above a corner of the scene's box, so near that it fills the image.
    fn new(framing: &Framing) -> Self {
        let [width, height] = SIZE.map(|n| (n * SAMPLES) as usize);
        let center = framing.bounds.center();
        let turned = Affine3A::look_to_rh(Vec3::ZERO, -FROM, Vec3::Y);
        let field = 0.5 * FIELD * Vec2::new(width as f32 / height as f32, 1.0);
        let corners = framing
            .corners()
            .map(|corner| turned.transform_vector3(corner - center));
        // What keeps each corner right of or above one edge of the image, and left of or below the other.
        let most = |sign: f32| {
            let needed = corners.map(|p| sign * p.truncate() + field * p.z);
            needed.into_iter().fold(Vec2::splat(f32::MIN), Vec2::max)
        };
        let (low, high) = (most(-1.0), most(1.0));
        let distance = MARGIN * (0.5 * (low + high) / field).max_element().max(f32::MIN_POSITIVE);
        let shift = 0.5 * (low - high);
        Self {
            to_camera: Affine3A::from_translation(shift.extend(-distance))
                * turned
                * Affine3A::from_translation(-center),
            nearest: NEAREST * distance,
            light: Vec3::new(0.4, 0.8, 0.55).normalize(),
            width,
            height,
            colours: vec![PAPER; width * height],
            nearness: vec![0.0; width * height],
            corners: Vec::new(),
        }
    }

    /// Projects a point before the camera to sample coordinates and inverse depth.
    fn project(&self, p: Vec3) -> Vec3 {
        let near = -1.0 / p.z;
        let scale = self.height as f32 * near / FIELD;
        Vec3::new(
            0.5 * self.width as f32 + p.x * scale,
            0.5 * self.height as f32 - p.y * scale,
            near,
        )
    }

    fn body(&mut self, mesh: &CollisionMesh, transform: &Transform, colour: Vec3) {
        self.corners.clear();
        for p in mesh.mesh.vertices() {
            let p = transform.transform_point(*p);
            self.corners.push([p, self.to_camera.transform_point3(p)]);
        }
        for t in mesh.mesh.triangles() {
            let [[p, from], [q, over], [r, to]] = t.map(|v| self.corners[v as usize]);
            let normal = (q - p).cross(r - p).normalize_or_zero();
            // Both sides are lit, because meshes may be open or inside out.
            let shade = 0.35 + 0.65 * (0.5 + 0.5 * normal.dot(self.light)).clamp(0.0, 1.0);
            let colour = (colour * shade).to_array().map(|c| c as u8);
            let (polygon, count) = before([from, over, to], -self.nearest);
            let polygon = polygon.map(|p| self.project(p));
            for i in 2..count {
                self.triangle([polygon[0], polygon[i - 1], polygon[i]], colour);
            }
        }
    }

    fn triangle(&mut self, [p, q, r]: [Vec3; 3], colour: [u8; 3]) {
        let area = (q - p).truncate().perp_dot((r - p).truncate());
        if area == 0.0 || !area.is_finite() {
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

    /// Draws the edges of a box with these corners.
    fn edges(&mut self, corners: &[Vec3; 8]) {
        let corners = corners.map(|corner| self.project(self.to_camera.transform_point3(corner)));
        for i in 0..8 {
            for k in (0..3).filter(|k| i >> k & 1 == 0) {
                let (from, to) = (corners[i], corners[i | 1 << k]);
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

/// The part of a triangle beyond the plane of this z, as a convex polygon: its corners, and how many they are.
fn before(triangle: [Vec3; 3], z: f32) -> ([Vec3; 4], usize) {
    let (mut polygon, mut count) = ([Vec3::NEG_Z; 4], 0);
    let mut push = |p| {
        polygon[count] = p;
        count += 1;
    };
    for i in 0..3 {
        let (from, to) = (triangle[i], triangle[(i + 1) % 3]);
        if from.z <= z {
            push(from);
        }
        if (from.z <= z) != (to.z <= z) {
            push(from.lerp(to, (z - from.z) / (to.z - from.z)));
        }
    }
    (polygon, count)
}
