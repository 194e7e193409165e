//! [`CollisionMesh`]: a baked mesh, with all data that a step needs.

use crate::geometry::cluster::cluster_order;
use crate::geometry::features::MeshFeatures;
use crate::geometry::lanes::MeshLanes;
use crate::geometry::{MassProperties, Orientation, TriMesh};
#[cfg(feature = "bevy")]
use crate::projection::Group;
use crate::projection::{BakeSettings, Cancelled, FaceTable, Inward, Progress, SupportHeights};
#[cfg(feature = "bevy")]
use bevy::prelude::{Asset, Transform, TypePath};
use glam::Vec3;
use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

/// A baked mesh. Clones are cheap: they share the data, which never changes.
///
/// Besides the [`BakedMesh`] it holds data that the steps need and that follows from it. To derive that data, after a
/// bake or after loading, takes about a millisecond for a thousand triangles.
#[derive(Clone)]
#[cfg_attr(feature = "bevy", derive(Asset, TypePath))]
pub struct CollisionMesh {
    baked: Arc<BakedMesh>,
    features: Arc<MeshFeatures>,
    lanes: Arc<MeshLanes>,
}

/// The result of a bake.
#[derive(Clone, PartialEq)]
pub struct BakedMesh {
    /// The validated mesh, with its triangles in cluster order.
    pub mesh: TriMesh,
    /// Volume, centre of mass, inertia, thickness.
    pub mass: MassProperties,
    /// Radius of the bounding sphere about the centre of mass, in mesh units. It is rounded up, so that no vertex is
    /// outside.
    pub radius: f32,
    /// Support heights relative to the centre of mass: upper bounds on the extent in each direction.
    pub heights: SupportHeights,
    /// The faces of collision, if the settings ask for them. Indices are triangles of `mesh`.
    pub faces: Option<FaceTable>,
    /// The settings of the bake.
    pub settings: BakeSettings,
}

impl Deref for CollisionMesh {
    type Target = BakedMesh;
    fn deref(&self) -> &BakedMesh {
        &self.baked
    }
}

impl PartialEq for CollisionMesh {
    /// Compares the baked data; all other data follows from it.
    fn eq(&self, other: &Self) -> bool {
        self.baked == other.baked
    }
}

impl From<BakedMesh> for CollisionMesh {
    /// Derives the data that the steps need.
    fn from(baked: BakedMesh) -> Self {
        let features = MeshFeatures::of(&baked.mesh);
        Self {
            lanes: Arc::new(MeshLanes::new(&baked.mesh, &features, baked.mass.center)),
            features: Arc::new(features),
            baked: Arc::new(baked),
        }
    }
}

impl CollisionMesh {
    /// Bakes `mesh` on `pool`. `settings` must be valid.
    ///
    /// A face table takes seconds, which `progress` reports and can cancel. All else takes milliseconds. The same mesh
    /// and settings give the same result for any number of threads.
    ///
    /// # Errors
    /// [`Cancelled`] if the bake was cancelled through `progress`.
    pub fn bake(
        mesh: &TriMesh,
        settings: BakeSettings,
        pool: &rayon::ThreadPool,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        Self::without_faces(mesh, settings).rebake(settings, pool, progress)
    }

    /// Whether both are clones of the same bake, not merely equal.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.baked, &other.baked)
    }

    /// Bakes `mesh` with default settings, without a face table. This takes milliseconds and needs no thread pool.
    pub fn new(mesh: &TriMesh) -> Self {
        Self::without_faces(mesh, BakeSettings::default())
    }

    /// Bakes `mesh` without a face table, even if `settings` ask for one. `settings` must be valid.
    pub fn without_faces(mesh: &TriMesh, settings: BakeSettings) -> Self {
        let settings = BakeSettings {
            faces: false,
            ..settings
        };
        prepare(mesh, settings).into()
    }

    /// The vertices and edges of the mesh, from which contact points are computed.
    pub fn features(&self) -> &Arc<MeshFeatures> {
        &self.features
    }

    /// The SIMD layout of the mesh, for the CPU.
    pub fn lanes(&self) -> &Arc<MeshLanes> {
        &self.lanes
    }

    /// The *faces of collision* towards another body: the triangles of [`BakedMesh::mesh`] that are visible along the
    /// line of centres.
    ///
    /// `pose` places this mesh in the world, and `point` is the other body's centre of mass in the world. `None`
    /// without a face table, or if the centres coincide, because then there is no direction.
    #[cfg(feature = "bevy")]
    pub fn faces_towards(&self, pose: &Transform, point: Vec3) -> Option<Group<'_>> {
        let to_point = point - pose.transform_point(self.mass.center);
        // Differences of points are divided by the scale, as points are.
        let local = pose.rotation.inverse() * to_point / pose.scale;
        (local.is_finite() && local != Vec3::ZERO)
            .then(|| self.faces.as_ref())?
            .map(|table| table.group(local))
    }

    /// The same mesh baked with other settings. Only data that depends on the changed settings is recomputed.
    ///
    /// # Errors
    /// [`Cancelled`] if the bake was cancelled through `progress`.
    pub fn rebake(
        &self,
        settings: BakeSettings,
        pool: &rayon::ThreadPool,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        // A bake without a face table can be cancelled too.
        progress.advance(0)?;
        if settings == self.settings {
            return Ok(self.clone());
        }
        if (settings.weld_tolerance, settings.inward) != (self.settings.weld_tolerance, self.settings.inward) {
            return Self::without_faces(&self.mesh, settings).rebake(settings, pool, progress);
        }
        let mut baked = BakedMesh {
            mesh: self.mesh.clone(),
            heights: self.heights.clone(),
            faces: None,
            settings,
            ..*self.baked
        };
        if settings.faces {
            baked.faces = Some(FaceTable::bake(&baked.mesh, &settings, pool, progress)?);
        }
        Ok(Self {
            baked: Arc::new(baked),
            ..self.clone()
        })
    }
}

impl BakedMesh {
    /// Warnings for the author of the mesh, one sentence each: dropped faces, an open surface, and the like. Empty for
    /// a sound mesh. Code that loads a mesh should log them once, with the name of the file.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let dropped = self.mesh.dropped();
        if dropped > 0 {
            let all = self.mesh.triangles().len() as u64 + u64::from(dropped);
            warnings.push(format!(
                "{dropped} of {all} faces have zero area and were dropped; the others keep their indices"
            ));
        }
        match self.mesh.orientation() {
            Orientation::Open => warnings.push(self.open_warning()),
            Orientation::Mixed => warnings.push(
                "some neighbouring faces have opposite winding, so the mass is that of the bounding box; recalculate the \
                 normals or set the mass yourself"
                    .into(),
            ),
            Orientation::Inward => warnings.push(
                "its faces point inward, so it is a room: bodies inside are free, its walls push inward, and its mass is \
                 that of a solid that fills it; if it is meant to be solid, flip its faces or bake it with `inward: Solid`"
                    .into(),
            ),
            Orientation::Outward if self.mass.approximate => warnings.push(
                "the mesh encloses almost no volume, or its size does not fit single precision, so its mass is \
                 approximate; set the mass yourself"
                    .into(),
            ),
            Orientation::Outward => {}
        }
        warnings
    }

    /// The warning about an open mesh.
    fn open_warning(&self) -> String {
        let mut text = "the mesh is open".to_owned();
        if let Some(gaps) = self.mesh.gaps() {
            let edges = if gaps.edges == 1 { "edge has" } else { "edges have" };
            text += &format!(" ({} {edges} no partner", gaps.edges);
            if let (Some(nearest), Some(relative)) = (gaps.nearest, gaps.relative) {
                text += &format!(
                    "; the nearest corners of these that no such edge joins are {nearest:.2e} apart, {relative:.1e} of \
                     its size, and `weld_tolerance` is {:.1e}",
                    self.settings.weld_tolerance
                );
            }
            text.push(')');
        }
        text + ": bodies inside it are not found, and its mass is that of its bounding box; close the holes, bake it with a \
                larger `weld_tolerance` if they are cracks, or set the mass yourself"
    }
}

/// Bakes all but the face table.
fn prepare(mesh: &TriMesh, settings: BakeSettings) -> BakedMesh {
    // Clusters come first: the rays that measure thickness are fast only in cluster order.
    let mut mesh = (mesh.reordered(&cluster_order(mesh))).with_weld_tolerance(settings.weld_tolerance);
    // Undo the flip of an earlier bake, so that the result depends only on the source.
    if mesh.is_flipped() {
        mesh = mesh.flipped();
    }
    if settings.inward == Inward::Solid && mesh.orientation() == Orientation::Inward {
        mesh = mesh.flipped();
    }
    let mass = MassProperties::of(&mesh);
    let heights = SupportHeights::of(used_once(&mesh).map(|p| p - mass.center));
    BakedMesh {
        radius: radius_about(&mesh, mass.center),
        mesh,
        mass,
        heights,
        faces: None,
        settings,
    }
}

/// The position of each vertex that a triangle uses, once. A vertex is used six times on average.
fn used_once(mesh: &TriMesh) -> impl Iterator<Item = Vec3> + '_ {
    let mut used = vec![false; mesh.vertices().len()];
    for &v in mesh.triangles().iter().flatten() {
        used[v as usize] = true;
    }
    mesh.vertices()
        .iter()
        .zip(used)
        .filter_map(|(v, used)| used.then_some(*v))
}

fn radius_about(mesh: &TriMesh, center: Vec3) -> f32 {
    let center = center.as_dvec3();
    let squared = mesh
        .used_positions()
        .map(|p| p.as_dvec3().distance_squared(center))
        .fold(0.0, f64::max);
    // The root is exact to a part in 2^53, so the next f32 above the rounded value is an upper bound.
    (squared.sqrt() as f32).next_up()
}

impl fmt::Debug for BakedMesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} triangles, {:?}, radius {}, {}",
            self.mesh.triangles().len(),
            self.mesh.orientation(),
            self.radius,
            if self.faces.is_some() {
                "with face table"
            } else {
                "no face table"
            }
        )
    }
}

impl fmt::Debug for CollisionMesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "CollisionMesh({:?})", *self.baked)
    }
}
