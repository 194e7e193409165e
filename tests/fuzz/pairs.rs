//! Random meshes and poses from bytes: their faces against the oracle's, their contact points, and steps of them.

use crate::oracle::body::{Body, Mesh, World};
use crate::oracle::brute;
use crate::oracle::compare::compare;
use crate::oracle::product::Product;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{Orientation, TriMesh};
use bevy_faceoff::queries::{ContactWorker, PairMemory, Placed};
use bevy_faceoff::state;
use bevy_faceoff::step::{StepState, cpu};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::feature_id::FeatureKind;
use bevy_faceoff::types::settings::Response;
use glam::{DVec3, Quat, Vec3};
use std::cell::Cell;

thread_local! {
    /// What the targets have found on this thread. Where nothing touches they check nothing.
    pub static TOUCHES: Cell<u64> = const { Cell::new(0) };
}

fn count(touches: usize) {
    TOUCHES.set(TOUCHES.get() + touches as u64);
}

/// Reads values off the front of some bytes. After their end all are zero.
struct Source<'a>(&'a [u8]);

impl Source<'_> {
    fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        first
    }

    fn float(&mut self) -> f32 {
        f32::from_le_bytes([0; 4].map(|_| self.byte()))
    }

    /// A multiple of 1/16, so that corners, edges and planes often coincide.
    fn coarse(&mut self) -> f32 {
        f32::from(self.byte() as i8) / 64.0
    }

    fn vector(&mut self, mut coordinate: impl FnMut(&mut Self) -> f32) -> Vec3 {
        Vec3::from_array([0; 3].map(|_| coordinate(self)))
    }

    /// Three to ten corners and one to sixteen faces.
    fn mesh(&mut self) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let shape = self.byte();
        let (corners, faces) = (3 + shape % 8, 1 + (shape / 8) % 16);
        let vertices: Vec<Vec3> = (0..corners).map(|_| self.vector(Self::coarse)).collect();
        let faces = (0..faces).map(|_| [0; 3].map(|_| u32::from(self.byte() % corners)));
        (vertices, faces.collect())
    }

    fn rotation(&mut self) -> Quat {
        let parts = [0; 4].map(|_| self.coarse());
        match self.byte() % 4 {
            0 => Quat::IDENTITY,
            1 => Quat::from_rotation_y(std::f32::consts::FRAC_PI_2),
            _ => Some(Quat::from_array(parts))
                .filter(|q| q.length() > 0.1)
                .map_or(Quat::IDENTITY, Quat::normalize),
        }
    }

    fn scale(&mut self) -> Vec3 {
        match self.byte() % 5 {
            0 => Vec3::new(1.0, 2.0, 0.5),
            1 => Vec3::splat(0.01),
            2 => Vec3::splat(50.0),
            _ => Vec3::ONE,
        }
    }

    /// A body, unless the mesh has no face with an area.
    fn body(&mut self) -> Option<Body> {
        let (vertices, faces) = self.mesh();
        TriMesh::new(vertices.clone(), faces.clone()).ok()?;
        Some(Body {
            mesh: Mesh::new("random", vertices, faces),
            translation: self.vector(Self::coarse),
            rotation: self.rotation(),
            scale: self.scale(),
        })
    }

    fn bodies(&mut self) -> Option<[Body; 2]> {
        Some([self.body()?, self.body()?])
    }
}

/// The product finds the faces that the oracle finds.
pub fn same_faces(bytes: &[u8]) {
    let Some(bodies) = Source(bytes).bodies() else { return };
    let worlds: Vec<World> = bodies.iter().map(Body::world).collect();
    let mut truth = brute::check(&worlds);
    let mut answer = Product::default().check(&bodies);
    // Where neighbouring faces are wound oppositely, the oracle's winding number says nothing about the inside.
    let is_mixed = |body: &Body| {
        let mesh = TriMesh::new(body.mesh.vertices.clone(), body.mesh.faces.clone());
        mesh.is_ok_and(|mesh| mesh.with_weld_tolerance(0.0).orientation() == Orientation::Mixed)
    };
    if bodies.iter().any(is_mixed) {
        truth.retain(|touch| !touch.contained);
        answer.retain(|touch| !touch.contained);
    }
    let tally = compare("random meshes", &bodies, &worlds, &truth, &answer);
    count(tally.touching);
    tally.require_no_failures();
    tally.require_none_missed();
}

/// Contact points are finite, within the margin, and on both surfaces.
pub fn valid_contacts(bytes: &[u8]) {
    let mut source = Source(bytes);
    let Some(bodies) = source.bodies() else { return };
    let margin = 0.25 * source.coarse().abs();
    let meshes = bodies.each_ref().map(|body| {
        let mesh = TriMesh::new(body.mesh.vertices.clone(), body.mesh.faces.clone());
        CollisionMesh::new(&mesh.expect("the body exists"))
    });
    let placed: [_; 2] = std::array::from_fn(|i| {
        let body = &bodies[i];
        Placed::new(
            &meshes[i],
            body.translation.as_dvec3(),
            body.rotation.as_dquat(),
            body.scale,
        )
        .expect("is valid")
    });
    let size: f64 = bodies.iter().map(|body| body.world().radius).sum();
    let mut worker = ContactWorker::new();
    let (mut all, mut few) = (vec![], vec![]);
    worker.points(&placed[0], &placed[1], margin, &mut all);
    worker.manifold(&placed[0], &placed[1], margin, &mut PairMemory::default(), &mut few);
    assert!(few.len() <= ContactWorker::MAX_POINTS && few.is_empty() == all.is_empty());
    count(all.len());
    for point in all.iter().chain(&few) {
        assert!(point.normal.is_normalized(), "{point:?}");
        // Rays through an overlap begin a millionth of the size outside of both bodies.
        assert!(
            point.separation.is_finite() && f64::from(point.separation) <= 1.01 * f64::from(margin) + 2.1e-6 * size,
            "{point:?}"
        );
        for (i, placed) in placed.iter().enumerate() {
            let anchor = placed.translation() + point.anchors[i];
            let hit = placed
                .closest_point(anchor, f64::INFINITY)
                .expect("a mesh has a surface");
            let distance = DVec3::distance(hit.point, anchor);
            // A point that stands for a deep overlap need not lie on the surfaces.
            let is_deep = matches!(
                point.features[i].kind(),
                FeatureKind::Overlap { .. } | FeatureKind::Containment
            );
            assert!(
                is_deep && distance <= size || distance <= 1e-5 * size,
                "{distance:e} from surface {i} of size {size}: {point:?}"
            );
        }
    }
}

/// A step of any bodies that are accepted leaves them finite.
pub fn finite_step(bytes: &[u8]) {
    let mut source = Source(bytes);
    let mut step = StepState::default();
    let mut bodies = Vec::new();
    step.input.config.response =
        [Response::None, Response::Impulse, Response::Contacts][usize::from(source.byte() % 3)];
    step.input.config.gravity = source.vector(Source::coarse);
    for _ in 0..2 + source.byte() % 3 {
        let (vertices, faces) = source.mesh();
        let Ok(mesh) = TriMesh::new(vertices, faces) else {
            continue;
        };
        let slot = step.input.meshes.add(CollisionMesh::new(&mesh));
        let kinds = [
            RigidBody::Dynamic,
            RigidBody::Dynamic,
            RigidBody::Kinematic,
            RigidBody::Static,
        ];
        let mut body = state::Body {
            kind: kinds[usize::from(source.byte() % 4)],
            ..state::Body::at_rest(slot, source.vector(Source::coarse), source.rotation(), source.scale())
        };
        // Most bodies with values from any bits are refused, or too far away to touch others.
        let change = if source.byte() % 4 == 0 { source.byte() } else { 0 };
        if change & 1 != 0 {
            body.position = source.vector(Source::float);
        }
        if change & 2 != 0 {
            body.linear_velocity = source.vector(Source::float);
        }
        if change & 4 != 0 {
            body.angular_velocity = source.vector(Source::float);
        }
        if change & 8 != 0 {
            body.scale = source.vector(Source::float);
        }
        if change & 16 != 0 {
            (body.density, body.mass) = (source.float(), Some(source.float()));
        }
        if change & 32 != 0 {
            (body.restitution, body.gravity_scale) = (source.float(), source.float());
        }
        bodies.push(body);
    }
    for _ in 0..2 {
        // Bodies that are refused, maybe only because of where the last step has left them, are not there.
        step.input.bodies.clear();
        bodies.retain(|body| step.input.bodies.push(body, &step.input.meshes).is_ok());
        cpu::run_all(&mut step);
        for (i, body) in bodies.iter_mut().enumerate() {
            let moved = step.input.bodies.motion(i);
            (body.position, body.rotation) = (moved.position, moved.rotation);
            (body.linear_velocity, body.angular_velocity) = (moved.linear_velocity, moved.angular_velocity);
            let vectors = [moved.position, moved.linear_velocity, moved.angular_velocity];
            assert!(
                vectors.iter().all(|v| v.is_finite()) && moved.rotation.is_normalized(),
                "{moved:?}"
            );
        }
        count(step.results.contacts.pairs.len());
        let points = step.results.contacts.points.iter();
        assert!(
            points
                .clone()
                .all(|p| p.point.is_finite() && p.normal.is_finite() && p.separation.is_finite())
        );
    }
}
