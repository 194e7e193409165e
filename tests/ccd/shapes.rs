//! Meshes of these tests.

use bevy_faceoff::geometry::TriMesh;
use glam::{Quat, Vec3};

/// A flat rectangle in the plane z = 0 about the origin, of `cells` by `cells` squares of two triangles each.
pub fn sheet(width: f32, cells: u32) -> TriMesh {
    let across = cells + 1;
    let at = |i: u32| width * (i as f32 / cells as f32 - 0.5);
    let vertices = (0..across * across).map(|k| Vec3::new(at(k % across), at(k / across), 0.0));
    let faces = (0..cells * cells).flat_map(|k| {
        let corner = k % cells + k / cells * across;
        let [a, b, c, d] = [corner, corner + 1, corner + across + 1, corner + across];
        [[a, b, c], [a, c, d]]
    });
    TriMesh::new(vertices.collect(), faces.collect()).expect("a good mesh")
}

/// A box about the origin.
pub fn cuboid(size: Vec3) -> TriMesh {
    let cube = bevy_faceoff::geometry::shapes::cube(1.0);
    let vertices = cube.vertices().iter().map(|v| *v * size).collect();
    TriMesh::new(vertices, cube.triangles().to_vec()).expect("a good mesh")
}

/// A copy of the mesh, rotated and moved in its own axes, so that its origin is not its centre of mass.
pub fn moved(mesh: &TriMesh, rotation: Quat, by: Vec3) -> TriMesh {
    let vertices = mesh.vertices().iter().map(|v| rotation * *v + by).collect();
    TriMesh::new(vertices, mesh.triangles().to_vec()).expect("a good mesh")
}
