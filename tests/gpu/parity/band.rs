//! Where rounding may decide, by the oracle's double precision on the poses as they are.
//!
//! All bands are parts of the sum of the two bounding radii, as the kernels' error bounds are.

use super::scene::Scene;
use crate::oracle::body::World;
use crate::oracle::margin::{margin, point_to_triangle};
use crate::oracle::tritri::meet;
use bevy_faceoff::state::Frame;
use bevy_faceoff::step::StepState;
use bevy_faceoff::types::settings::Culling;
use glam::{DMat3, DVec3};
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

/// Two faces whose answer changes if one is moved by less. The kernels' own bound for a coordinate is 2.5e-6.
pub const FACES: f64 = 2.0e-5;

/// Two spheres whose distance differs from the sum of the radii by less.
pub const SPHERES: f64 = 1.0e-5;

/// A direction, in degrees, this near the border of a cell of the face table; if the centres are near each other
/// compared with the radii, or the body is stretched, it is known less well in proportion.
pub const BORDER: f64 = 1.0e-4;

/// A corner of a face this far off can turn the face to or away from the other body; so can a shift of either centre.
pub const EDGE_ON: f64 = 2.0e-6;

/// Centres nearer than this: the direction between them is rounding.
pub const COINCIDENT: f64 = 2.0e-5;

/// What the oracle says of the pairs of one scene.
pub struct Oracle<'s> {
    scene: &'s Scene,
    /// Any state of the scene: centres and radii are those before the step.
    state: &'s StepState,
    worlds: RefCell<HashMap<u32, Rc<World>>>,
    /// Added to [`FACES`], for poses that have drifted apart on both sides.
    pub drift: f64,
}

impl<'s> Oracle<'s> {
    pub fn new(scene: &'s Scene, state: &'s StepState) -> Self {
        Self {
            scene,
            state,
            worlds: RefCell::default(),
            drift: 0.0,
        }
    }

    fn world(&self, i: u32) -> Rc<World> {
        let mut worlds = self.worlds.borrow_mut();
        worlds.entry(i).or_insert_with(|| Rc::new(self.scene.world(i))).clone()
    }

    fn size(&self, pair: [u32; 2]) -> f64 {
        pair.iter()
            .map(|&i| f64::from(self.state.input.bodies.radius[i as usize]))
            .sum()
    }

    fn frame(&self, i: u32) -> &Frame {
        &self.state.input.bodies.frame[i as usize]
    }

    fn apart(&self, [a, b]: [u32; 2]) -> DVec3 {
        self.frame(b).center - self.frame(a).center
    }

    /// Whether two spheres just touch. The stages keep centres in single precision, which is coarse far away.
    pub fn spheres_in_band(&self, pair: [u32; 2]) -> bool {
        let far = pair.map(|i| self.frame(i).center.abs().max_element());
        let coarse = 2.0 * f64::from(f32::EPSILON) * far[0].max(far[1]);
        let size = self.size(pair);
        (self.apart(pair).length() - size).abs() < SPHERES * size + coarse
    }

    /// Whether two faces truly meet.
    pub fn faces_meet(&self, [a, b]: [u32; 2], [f, g]: [u32; 2]) -> bool {
        let (a, b) = (self.world(a), self.world(b));
        meet(a.triangle(f).expect("a face"), b.triangle(g).expect("a face"))
    }

    /// How far two faces are from changing their answer.
    pub fn margin(&self, pair: [u32; 2], [f, g]: [u32; 2]) -> f64 {
        let [a, b] = pair.map(|i| self.world(i));
        margin(a.triangle(f).expect("a face"), b.triangle(g).expect("a face")) / self.size(pair)
    }

    pub fn faces_in_band(&self, pair: [u32; 2], faces: [u32; 2]) -> bool {
        self.margin(pair, faces) < FACES + self.drift
    }

    /// Whether a body seen by its front shows one of these two faces so nearly from the side that rounding decides.
    pub fn edge_on(&self, pair: [u32; 2], faces: [u32; 2]) -> bool {
        let to = self.apart(pair);
        (0..2).any(|end| {
            let (i, face) = (pair[end], faces[end]);
            if self.scene.bodies[i as usize].culling != Culling::FrontFacing {
                return false;
            }
            let world = self.world(i);
            let [p, q, r] = *world.triangle(face).expect("a face");
            let normal = (q - p).cross(r - p);
            let longest = p.distance(q).max(q.distance(r)).max(r.distance(p));
            let altitude = normal.length() / longest;
            let cosine = normal.normalize().dot(to) / to.length();
            cosine.abs() < EDGE_ON * self.size(pair) * (1.0 / altitude + 1.0 / to.length())
        })
    }

    /// Whether rounding decides what a whole body shows: which group of its table, or whether there is a direction.
    pub fn view_in_band(&self, pair: [u32; 2]) -> bool {
        let to = self.apart(pair);
        let exact = pair
            .iter()
            .all(|&i| self.scene.bodies[i as usize].culling == Culling::Exact);
        if exact {
            return false;
        }
        if to.length() < COINCIDENT * self.size(pair) {
            return true;
        }
        self.near_border(pair[0], to, pair) || self.near_border(pair[1], -to, pair)
    }

    fn near_border(&self, i: u32, to_other: DVec3, pair: [u32; 2]) -> bool {
        let body = &self.scene.bodies[i as usize];
        let shape = &self.scene.shapes[body.mesh as usize];
        let Some(table) = shape
            .baked
            .faces
            .as_ref()
            .filter(|_| body.culling == Culling::FacesOfCollision)
        else {
            return false;
        };
        let frame = self.frame(i);
        let d = (DMat3::from_diagonal(1.0 / frame.scale) * frame.rotation.transpose() * to_other).normalize();
        let step = f64::from(table.grid().step());
        let (a, b) = (d.y.asin().to_degrees(), (-d.x).atan2(d.z).to_degrees());
        // Cells reach half a step from their direction.
        let to_border = |angle: f64| ((angle / step).rem_euclid(1.0) - 0.5).abs() * step;
        let scale = frame.scale.abs();
        let stretch = scale.max_element() / scale.min_element();
        let band = BORDER * stretch * (self.size(pair) / to_other.length()).max(1.0);
        to_border(a) < band || to_border(b) * d.x.hypot(d.z) < band
    }

    /// Whether some corner that decides about containment lies in the other's surface.
    pub fn inside_in_band(&self, pair: [u32; 2]) -> bool {
        let [a, b] = pair.map(|i| self.world(i));
        let band = (FACES + self.drift) * self.size(pair);
        let near = |points: &World, surface: &World| {
            (points.components.iter()).any(|&p| surface.triangles.iter().any(|t| point_to_triangle(p, t) < band))
        };
        near(&a, &b) || near(&b, &a)
    }
}
