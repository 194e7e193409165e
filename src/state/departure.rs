//! Kinematic bodies that must reach a given pose at the end of a step.

use super::bodies::{Bodies, Frame, bounding_radius, unit};
use glam::{DQuat, DVec3, Quat, Vec3};

/// Where the way of a kinematic body begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure {
    /// Number of the body.
    pub body: usize,
    /// Pose of the body in the world.
    pub position: Vec3,
    /// The rotation need not have unit length, but not be zero.
    pub rotation: Quat,
}

impl Bodies {
    /// Moves bodies back to their start poses, with the velocities that take them to their present poses within `dt`
    /// seconds. A body takes the shorter of two rotations.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn depart(&mut self, departures: &[Departure], dt: f32) {
        let mut moves_compounds = false;
        for departure in departures {
            let i = departure.body;
            let start = unit(departure.rotation);
            let turn = start.as_dquat().normalize();
            match self.part(i as u32).map(|part| part.compound as usize) {
                Some(compound) => {
                    let compound = &mut self.compounds[compound];
                    let center = departure.position.as_dvec3() + turn * compound.local_center;
                    let (v, w) = velocities([center, compound.center], [turn, compound.rotation], dt);
                    compound.set(center, turn, v, w);
                    moves_compounds = true;
                }
                None => {
                    let end = self.frame[i];
                    let arm = end.rotation.transpose() * (end.center - end.position);
                    let position = departure.position.as_dvec3();
                    let frame = Frame::from_arm(position, turn, end.scale, arm);
                    let end_turn = self.rotation[i].as_dquat().normalize();
                    let (v, w) = velocities([frame.center, end.center], [turn, end_turn], dt);
                    self.position[i] = departure.position;
                    self.rotation[i] = start;
                    self.linear_velocity[i] = v;
                    self.angular_velocity[i] = w;
                    self.frame[i] = frame;
                    self.center[i] = frame.center.as_vec3();
                    self.radius[i] = bounding_radius(self.unpadded_radius[i], self.center[i]);
                }
            }
        }
        if moves_compounds {
            self.place_parts(0..self.parts.len());
        }
    }
}

/// The linear velocity of the centre of mass and the angular velocity, from the first pose to the second.
fn velocities([start, end]: [DVec3; 2], [from, to]: [DQuat; 2], dt: f32) -> (Vec3, Vec3) {
    let turn = to * from.inverse();
    // `q` and `-q` are the same rotation. The one with positive `w` is the shorter way.
    let turn = if turn.w < 0.0 { -turn } else { turn };
    let dt = f64::from(dt);
    (((end - start) / dt).as_vec3(), (turn.to_scaled_axis() / dt).as_vec3())
}
