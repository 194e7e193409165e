//! Questions to the world: what does a ray hit, what is near a point, what does a shape overlap or run into?
//!
//! | to | see |
//! |---|---|
//! | ask in a system | [`SpatialQuery`] |
//! | cast a ray from an entity after each step | [`RayCaster`] |
//! | choose what counts | [`SpatialQueryFilter`] |
//! | ask about what moved in the same frame | [`update_spatial_queries`] |
//! | ask where poses stay on the GPU | [`update_spatial_queries_from`] |
//! | ask without an app | [`queries::Scene`](crate::queries::Scene) |

mod filter;
mod hits;
mod index;
mod ray_caster;
mod spatial_query;
mod update;

pub use crate::queries::QueryShape;
pub use filter::SpatialQueryFilter;
pub use hits::{PointHitData, RayHitData, ShapeHitData};
pub use index::SpatialQueryError;
pub use ray_caster::{RayCaster, RayHits};
pub use spatial_query::SpatialQuery;
pub use update::{update_spatial_queries, update_spatial_queries_from};

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
            .register_type::<RayHits>();
        let update = (update::catch_up, ray_caster::cast_rays)
            .chain()
            .after(FaceoffSystems::Publish);
        // The results of a GPU may be published between two steps.
        let late = RunFixedMainLoopSystems::AfterFixedMainLoop;
        app.add_systems(FaceoffStep, update.ambiguous_with_all())
            .add_systems(RunFixedMainLoop, update::catch_up.in_set(late));
    }
}
