//! A warning where Avian has joints but no solver for them.

use avian3d::prelude::*;
use bevy::prelude::*;
use std::any::TypeId;

/// Stands for Avian's module of the same name where its feature `xpbd_joints` is off.
mod xpbd {
    pub struct XpbdSolverPlugin;
}

/// Whether Avian was built with a solver for joints. A feature of Avian cannot be asked for, but a name exists only
/// with it.
fn are_solved() -> bool {
    // Avian's `xpbd`, if there is one, hides that of this file.
    let found = {
        #[allow(unused_imports, reason = "without the feature nothing in it is used")]
        use avian3d::dynamics::solver::*;
        TypeId::of::<xpbd::XpbdSolverPlugin>()
    };
    found != TypeId::of::<self::xpbd::XpbdSolverPlugin>()
}

pub(crate) fn plugin(app: &mut App) {
    if !are_solved() {
        app.add_observer(warn::<FixedJoint>)
            .add_observer(warn::<RevoluteJoint>)
            .add_observer(warn::<SphericalJoint>)
            .add_observer(warn::<PrismaticJoint>)
            .add_observer(warn::<DistanceJoint>);
    }
}

fn warn<J: Component>(joint: On<Add, J>) {
    warn_once!(
        "{}: a joint does nothing, because Avian was built without joints. Turn on the feature `xpbd_joints` of avian3d",
        joint.entity
    );
}
