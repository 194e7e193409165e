//! Spatial queries: what does a ray hit, what is near a point, what does a shape overlap or run into?
//!
//! | to | see |
//! |---|---|
//! | query in a system | [`SpatialQuery`] |
//! | cast a ray or a shape from an entity after each step | [`RayCaster`], [`ShapeCaster`] |
//! | choose what counts | [`SpatialQueryFilter`] |
//! | query what moved in the same frame | [`update_spatial_queries`] |
//! | query where poses stay on the GPU | [`update_spatial_queries_from`] |
//! | query without an app | [`queries::Scene`](crate::queries::Scene) |

mod filter;
mod hits;
mod index;
mod ray_caster;
mod shape_caster;
mod spatial_query;
mod update;

pub use crate::queries::QueryShape;
pub use filter::SpatialQueryFilter;
pub use hits::{PointHitData, RayHitData, ShapeHitData};
pub use index::SpatialQueryError;
pub use ray_caster::{RayCaster, RayHits};
pub use shape_caster::{CasterShape, ShapeCaster, ShapeHits};
pub use spatial_query::SpatialQuery;
pub use update::{update_spatial_queries, update_spatial_queries_from};

pub(crate) use update::update_after_step;
#[cfg(feature = "bevy_picking")]
pub(crate) use update::update_while_time_stands;

use crate::plugin::schedule::{FaceoffStep, FaceoffSystems};
use bevy::prelude::*;
use index::SpatialIndex;

/// Keeps what [`SpatialQuery`] sees up to date. Part of [`FaceoffPlugins`](crate::plugin::FaceoffPlugins).
pub struct SpatialQueryPlugin;

impl Plugin for SpatialQueryPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<SpatialIndex>()
            .register_type::<SpatialQueryFilter>()
            .register_type::<PointHitData>()
            .register_type::<RayHitData>()
            .register_type::<ShapeHitData>()
            .register_type::<RayCaster>()
            .register_type::<RayHits>()
            .register_type::<ShapeCaster>()
            .register_type::<ShapeHits>();
        let update = (update::update_after_step, run_casters)
            .chain()
            .after(FaceoffSystems::Publish)
            .before(FaceoffSystems::Respond);
        // The results of a GPU may be published between two steps.
        let late = RunFixedMainLoopSystems::AfterFixedMainLoop;
        app.add_systems(FaceoffStep, update.ambiguous_with_all())
            .add_systems(RunFixedMainLoop, update::catch_up.in_set(FaceoffStep).in_set(late));
    }
}

/// Runs the casters. Their systems make the app run queries, so they are created only if there are casters.
pub(crate) fn run_casters(world: &mut World) {
    if !world.resource::<SpatialIndex>().has_casters {
        return;
    }
    let rays = world.run_system_cached(ray_caster::cast_rays);
    let shapes = world.run_system_cached(shape_caster::cast_shapes);
    for error in [rays.err(), shapes.err()].into_iter().flatten() {
        error!("{error}");
    }
}
