//! The product's side of a comparison.

use super::body::{Body, Mesh};
use super::brute::Touch;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::projection::{BakeSettings, Inward};
use bevy_faceoff::queries::{self, Placement, check};
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// Runs the product, and bakes every mesh once.
#[derive(Default)]
pub struct Product {
    baked: Mutex<HashMap<usize, (Arc<Mesh>, CollisionMesh)>>,
}

impl Product {
    /// The result of `queries::check`. `queries::touching` must return the same pairs.
    pub fn check(&self, bodies: &[Body]) -> Vec<Touch> {
        let placements: Vec<Placement> = bodies.iter().map(|body| self.placement(body)).collect();
        let touching = check(&placements).unwrap_or_else(|error| panic!("{error}: {bodies:?}"));
        let first_hits = queries::touching(&placements).unwrap_or_else(|error| panic!("{error}: {bodies:?}"));
        let all: Vec<[u32; 2]> = touching.iter().map(|pair| [pair.a, pair.b]).collect();
        assert_eq!(first_hits, all, "the first hits of {bodies:?}");
        touching
            .into_iter()
            .map(|pair| Touch {
                a: pair.a,
                b: pair.b,
                contained: pair.contained,
                faces: pair.faces,
            })
            .collect()
    }

    /// A body in the product's form.
    pub fn placement(&self, body: &Body) -> Placement {
        let Body {
            mesh,
            translation,
            rotation,
            scale,
        } = body;
        // The address is a valid key as long as the entry keeps the mesh alive.
        let (_, baked) = self
            .baked
            .lock()
            .unwrap()
            .entry(Arc::as_ptr(mesh) as usize)
            .or_insert_with(|| (mesh.clone(), bake(mesh)))
            .clone();
        Placement {
            mesh: baked,
            translation: *translation,
            rotation: *rotation,
            scale: *scale,
        }
    }
}

/// Bakes a mesh with the oracle's rules: only corners at the same position are welded, and whatever is closed is solid.
fn bake(mesh: &Mesh) -> CollisionMesh {
    let mesh = TriMesh::new(mesh.vertices.clone(), mesh.faces.clone())
        .unwrap_or_else(|error| panic!("{}: {error}", mesh.name));
    let settings = BakeSettings {
        weld_tolerance: 0.0,
        inward: Inward::Solid,
        ..BakeSettings::default()
    };
    CollisionMesh::without_faces(&mesh, settings)
}
