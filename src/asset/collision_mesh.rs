//! [`CollisionMesh`]: a baked mesh, with all data that a step needs.

use crate::geometry::cluster::cluster_order;
use crate::geometry::features::MeshFeatures;
use crate::geometry::lanes::MeshLanes;
use crate::geometry::{MassProperties, OneSided, TriMesh};
#[cfg(feature = "bevy")]
use crate::projection::Group;
use crate::projection::{BakeSettings, Cancelled, FaceTable, Inward, Progress, SupportHeights};
#[cfg(feature = "bevy")]
use bevy::prelude::{Asset, Reflect, Transform};
use glam::{BVec3, DMat3, DVec3, Vec3};
use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

/// A baked mesh. Clones are cheap: they share the data, which never changes.
///
/// Besides the [`BakedMesh`] it holds data that the steps need and that follows from it. To derive that data, after a
/// bake or after loading, takes about a millisecond for a thousand triangles, and some tens of milliseconds more where
/// the surface has openings.
#[derive(Clone)]
#[cfg_attr(feature = "bevy", derive(Asset, Reflect), reflect(opaque, Clone, Debug, PartialEq))]
pub struct CollisionMesh {
    baked: Arc<BakedMesh>,
    features: Arc<MeshFeatures>,
    lanes: Arc<MeshLanes>,
    fingerprint: u64,
}

/// The result of a bake.
#[derive(Clone, PartialEq)]
pub struct BakedMesh {
    /// The validated mesh, with its triangles in cluster order.
    pub mesh: TriMesh,
    /// Which triangles push only to the side of their normal.
    pub one_sided: OneSided,
    /// Volume, centre of mass, inertia, thickness.
    pub mass: MassProperties,
    /// Radius of the bounding sphere about the centre of mass, in mesh units, with the rounding. It is rounded up, so
    /// that nothing is outside.
    pub radius: f32,
    /// Support heights relative to the centre of mass, without the rounding: upper bounds on the extent in each
    /// direction.
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
        let features = MeshFeatures::of(&baked.mesh, baked.one_sided.clone());
        Self {
            lanes: Arc::new(MeshLanes::new(&baked.mesh, &features, baked.mass.center)),
            features: Arc::new(features),
            fingerprint: baked.fingerprint(),
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

    /// A hash of the surface and its mass, which tells different meshes apart on every machine. A face table does not
    /// change it.
    pub(crate) fn fingerprint(&self) -> u64 {
        self.fingerprint
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

    /// The axes on which all triangles are at 0; none for a rounded mesh.
    pub(crate) fn flat_axes(&self) -> BVec3 {
        if self.settings.rounding > 0.0 {
            return BVec3::FALSE;
        }
        // Coordinates of the layout are relative to the centre of mass.
        let (aabb, center) = (self.lanes.aabb, self.mass.center);
        aabb.min.cmpeq(Vec3::ZERO) & aabb.max.cmpeq(Vec3::ZERO) & center.cmpeq(Vec3::ZERO)
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

    /// A copy of the mesh baked with other settings. Only data that depends on the changed settings is recomputed.
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
        // A segment has no faces.
        let faces = settings.faces && !self.mesh.is_thin();
        let settings = BakeSettings { faces, ..settings };
        if settings == self.settings {
            return Ok(self.clone());
        }
        let of_mesh = |settings: &BakeSettings| {
            let lengths = [settings.weld_tolerance, settings.shell_thickness, settings.rounding];
            (lengths, settings.inward)
        };
        if of_mesh(&settings) != of_mesh(&self.settings) {
            return Self::without_faces(&self.mesh, settings).rebake(settings, pool, progress);
        }
        let mut baked = BakedMesh {
            mesh: self.mesh.clone(),
            one_sided: self.one_sided.clone(),
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
    /// The volume with this scale along the mesh's axes, cubic metres.
    ///
    /// It is exact for balls and capsules, and without a rounding. An uneven scale makes that of another rounded mesh
    /// too large, because the rounding has the smallest component of the scale.
    pub(crate) fn volume(&self, scale: DVec3) -> f64 {
        let mass = self.unevenly_scaled(scale);
        mass.map_or_else(
            || f64::from(self.mass.volume) * scale.element_product().abs(),
            |mass| f64::from(mass.volume),
        )
    }

    /// The inertia tensor about the centre of mass with this scale, for a mass in kilograms, kg m^2.
    pub(crate) fn inertia(&self, scale: DVec3, mass: f64) -> DMat3 {
        match self.unevenly_scaled(scale) {
            Some(own) => own.inertia(DVec3::ONE, mass),
            None => self.mass.inertia(scale, mass),
        }
    }

    /// The mass of a ball or a capsule with an uneven scale: its rounding has the smallest component.
    fn unevenly_scaled(&self, scale: DVec3) -> Option<MassProperties> {
        let sizes = scale.abs();
        if self.settings.rounding == 0.0 || sizes.max_element() == sizes.min_element() || !self.mesh.is_thin() {
            return None;
        }
        let [start, _, end] = self.mesh.corners(0).map(|p| scale * p.as_dvec3());
        let radius = f64::from(self.settings.rounding) * sizes.min_element();
        Some(MassProperties::of_segment([start, end], radius))
    }

    fn fingerprint(&self) -> u64 {
        let mut hash = blake3::Hasher::new();
        // Long pieces are hashed much faster than single numbers.
        let mut bytes = Vec::new();
        let vertices = self.mesh.vertices().iter();
        bytes.extend(vertices.flat_map(|vertex| vertex.to_array()).flat_map(f32::to_le_bytes));
        hash.update(&bytes);
        bytes.clear();
        bytes.extend(self.mesh.triangles().iter().flatten().flat_map(|v| v.to_le_bytes()));
        hash.update(&bytes);
        let BakeSettings {
            weld_tolerance, inward, ..
        } = self.settings;
        let rest = (self.mesh.vertices().len(), weld_tolerance, inward, self.mass);
        hash.update(format!("{rest:?}").as_bytes());
        let hash = hash.finalize();
        u64::from_le_bytes(std::array::from_fn(|i| hash.as_bytes()[i]))
    }
}

/// Bakes all but the face table.
fn prepare(mesh: &TriMesh, settings: BakeSettings) -> BakedMesh {
    // Clusters come first: the rays that measure thickness are fast only in cluster order.
    let ordered = mesh.reordered(&cluster_order(mesh));
    // The result depends only on the source, not on what an earlier bake turned.
    let mut mesh = ordered
        .with_weld_tolerance(settings.weld_tolerance)
        .as_input()
        .oriented();
    if settings.inward == Inward::Solid && mesh.is_room() {
        mesh = mesh.flipped();
    }
    let mass = MassProperties::rounded(&mesh, settings.shell_thickness, settings.rounding);
    let heights = SupportHeights::of(used_once(&mesh).map(|p| p - mass.center));
    BakedMesh {
        radius: radius_about(&mesh, mass.center, settings.rounding),
        one_sided: OneSided::of(&mesh),
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

fn radius_about(mesh: &TriMesh, center: Vec3, rounding: f32) -> f32 {
    let center = center.as_dvec3();
    let squared = mesh
        .used_positions()
        .map(|p| p.as_dvec3().distance_squared(center))
        .fold(0.0, f64::max);
    // The root is exact to a part in 2^53, so the next f32 above the rounded value is an upper bound.
    ((squared.sqrt() + f64::from(rounding)) as f32).next_up()
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
