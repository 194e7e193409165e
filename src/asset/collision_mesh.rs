//! [`CollisionMesh`]: everything the stages need to know about a mesh.

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

/// A baked mesh. Cloning is cheap: the data is shared and never changes.
///
/// It comes with what the stages derive from a mesh, so that no step has to: making one, be it by a bake or from a file, takes
/// about a millisecond for a thousand triangles.
#[derive(Clone)]
#[cfg_attr(feature = "bevy", derive(Asset, TypePath))]
pub struct CollisionMesh {
    baked: Arc<BakedMesh>,
    features: Arc<MeshFeatures>,
    lanes: Arc<MeshLanes>,
}

/// What a bake produces.
#[derive(Clone, PartialEq)]
pub struct BakedMesh {
    /// The validated mesh, its triangles in cluster order.
    pub mesh: TriMesh,
    /// Volume, centre of mass, inertia, thickness.
    pub mass: MassProperties,
    /// Radius of the bounding sphere about the centre of mass, in mesh units; rounded up, so that no vertex is outside.
    pub radius: f32,
    /// Upper bounds of the reach in every direction, measured from the centre of mass.
    pub heights: SupportHeights,
    /// Faces of collision, if the settings asked for them; indices are triangles of `mesh`.
    pub faces: Option<FaceTable>,
    /// What was asked for.
    pub settings: BakeSettings,
}

impl Deref for CollisionMesh {
    type Target = BakedMesh;
    fn deref(&self) -> &BakedMesh {
        &self.baked
    }
}

impl PartialEq for CollisionMesh {
    /// All else follows from what was baked.
    fn eq(&self, other: &Self) -> bool {
        self.baked == other.baked
    }
}

impl From<BakedMesh> for CollisionMesh {
    /// Derives what the stages need.
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
    /// Bakes `mesh` on `pool`. The face table, if `settings` ask for one, takes seconds, which `progress` counts and may
    /// cut short; all else takes milliseconds. `settings` must be valid.
    ///
    /// The same mesh and settings give the same result, however many threads the pool has.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` was cancelled before the end.
    pub fn bake(
        mesh: &TriMesh,
        settings: BakeSettings,
        pool: &rayon::ThreadPool,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        Self::without_faces(mesh, settings).rebake(settings, pool, progress)
    }

    /// Whether both are the same bake, not merely equal.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.baked, &other.baked)
    }

    /// Bakes `mesh` with default settings: all but the face table, which takes milliseconds and no pool.
    pub fn new(mesh: &TriMesh) -> Self {
        Self::without_faces(mesh, BakeSettings::default())
    }

    /// Bakes `mesh` without a face table, whether `settings` ask for one or not. `settings` must be valid.
    pub fn without_faces(mesh: &TriMesh, settings: BakeSettings) -> Self {
        let settings = BakeSettings {
            faces: false,
            ..settings
        };
        prepare(mesh, settings).into()
    }

    /// Its vertices and edges, of which contact points are made.
    pub fn features(&self) -> &Arc<MeshFeatures> {
        &self.features
    }

    /// Its triangles in eights, as the CPU tests them.
    pub fn lanes(&self) -> &Arc<MeshLanes> {
        &self.lanes
    }

    /// The *faces of collision* that the mesh, placed by `pose`, shows a body whose centre of mass is at `point`, both in
    /// the world: triangles of [`BakedMesh::mesh`] that can be seen from there, along the line of centres. `None` without a
    /// face table, and where the centres coincide, since then there is no direction.
    #[cfg(feature = "bevy")]
    pub fn faces_towards(&self, pose: &Transform, point: Vec3) -> Option<Group<'_>> {
        let to_point = point - pose.transform_point(self.mass.center);
        // Directions between points of a mesh are scaled as the mesh is.
        let local = pose.rotation.inverse() * to_point / pose.scale;
        (local.is_finite() && local != Vec3::ZERO)
            .then(|| self.faces.as_ref())?
            .map(|table| table.group(local))
    }

    /// The same mesh baked with other settings; only what they change is made anew.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` was cancelled before the end.
    pub fn rebake(
        &self,
        settings: BakeSettings,
        pool: &rayon::ThreadPool,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        // A bake without a table can be cancelled as well.
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
    /// What its author may want to know about the mesh, one sentence each: faces that were dropped, a surface that is not
    /// closed. Empty for a mesh that is in order. Whoever loads a mesh logs these once, with the file's name.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let dropped = self.mesh.dropped();
        if dropped > 0 {
            let all = self.mesh.triangles().len() as u64 + u64::from(dropped);
            warnings.push(format!(
                "{dropped} of {all} faces have no area and were dropped; the others keep their numbers"
            ));
        }
        match self.mesh.orientation() {
            Orientation::Open => warnings.push(self.openness()),
            Orientation::Mixed => warnings.push(
                "some neighbouring faces disagree about the outside, so the mass is that of the bounding box; recalculate \
                 the normals or set the mass yourself"
                    .into(),
            ),
            Orientation::Inward => warnings.push(
                "its faces look inward, so it is a room: bodies inside are free, its walls push inward, and its mass is \
                 that of its inside; if it is meant to be solid, turn its faces or bake it with `inward: Solid`"
                    .into(),
            ),
            Orientation::Outward if self.mass.approximate => warnings.push(
                "the mesh encloses next to nothing, or its size does not fit single precision, so its mass is approximate; \
                 set the mass yourself"
                    .into(),
            ),
            Orientation::Outward => {}
        }
        warnings
    }

    /// What there is to say of an open mesh.
    fn openness(&self) -> String {
        let mut text = "the mesh is open".to_owned();
        if let Some(gaps) = self.mesh.gaps() {
            let edges = if gaps.edges == 1 { "edge has" } else { "edges have" };
            text += &format!(" ({} {edges} no partner", gaps.edges);
            if let (Some(nearest), Some(relative)) = (gaps.nearest, gaps.relative) {
                text += &format!(
                    "; the nearest corners there that no such edge joins are {nearest:.2e} apart, {relative:.1e} of its \
                     size, and `weld_tolerance` is {:.1e}",
                    self.settings.weld_tolerance
                );
            }
            text.push(')');
        }
        text + ": bodies inside it are not found, and its mass is that of its bounding box; close the holes, bake it with a \
                larger `weld_tolerance` if they are cracks, or set the mass yourself"
    }
}

/// All but the face table.
fn prepare(mesh: &TriMesh, settings: BakeSettings) -> BakedMesh {
    // Clusters first: thickness is found by rays that need neighbours to be neighbours in the list.
    let mut mesh = (mesh.reordered(&cluster_order(mesh))).with_weld_tolerance(settings.weld_tolerance);
    // What an earlier bake turned is judged as it was.
    if mesh.is_turned() {
        mesh = mesh.turned();
    }
    if settings.inward == Inward::Solid && mesh.orientation() == Orientation::Inward {
        mesh = mesh.turned();
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

/// Positions of the vertices that triangles use, each once: a vertex is used six times on average.
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
    // The root is exact to a part in 2^53, so the next f32 above whatever it rounds to is no smaller than the truth.
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
