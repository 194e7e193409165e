//! The meshes of the test cases, each within a sphere of diameter 1 about the origin unless stated otherwise.

use super::body::Mesh;
use super::rng::Rng;
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// All meshes.
pub struct Shapes {
    /// A thick torus of 240 triangles.
    pub torus: Arc<Mesh>,
    /// A trefoil of 1120 triangles.
    pub knot: Arc<Mesh>,
    /// A trefoil with a thin tube, which leaves room for links.
    pub thin_knot: Arc<Mesh>,
    /// A thin torus that links easily.
    pub ring: Arc<Mesh>,
    pub cube: Arc<Mesh>,
    pub tetrahedron: Arc<Mesh>,
    /// 128 triangles, convex.
    pub ball: Arc<Mesh>,
    /// The ball inside out.
    pub inward_ball: Arc<Mesh>,
    /// A shell: the ball, and inside it an inward-facing ball of 0.6 of its size.
    pub hollow_ball: Arc<Mesh>,
    /// Two balls of 0.3 of the size in one mesh, at x = -0.35 and 0.35.
    pub two_balls: Arc<Mesh>,
    /// A torus with separate corners for each face, and some degenerate faces in between.
    pub unwelded_torus: Arc<Mesh>,
    /// The torus split into two open meshes along two circles of shared edges.
    pub half_tori: [Arc<Mesh>; 2],
    pub triangle: Arc<Mesh>,
    /// Open triangle soups of 60 triangles.
    pub soups: Vec<Arc<Mesh>>,
    /// A cube with corners at -0.5 and 0.5, so larger than diameter 1: for exact stacks.
    pub unit_cube: Arc<Mesh>,
}

impl Shapes {
    pub fn new() -> Self {
        let torus = tube("torus", |t| (circle(t) * 0.7, circle(t), DVec3::Z), 12, 10, 0.3);
        let ball = ball();
        let (cube_vertices, cube_faces) = cube();
        let unit_cube = Mesh::new(
            "unit cube",
            cube_vertices.iter().map(|v| v.as_vec3()).collect(),
            cube_faces.clone(),
        );
        Self {
            unwelded_torus: unwelded(&torus),
            half_tori: [&torus.faces[..120], &torus.faces[120..]]
                .map(|half| Mesh::new("half torus", torus.vertices.clone(), half.to_vec())),
            torus,
            knot: tube("knot", trefoil, 56, 10, 0.42),
            thin_knot: tube("thin knot", trefoil, 56, 6, 0.12),
            ring: tube("ring", |t| (circle(t), circle(t), DVec3::Z), 24, 6, 0.08),
            cube: unit_sized("cube", cube_vertices, cube_faces, vec![]),
            tetrahedron: tetrahedron(),
            inward_ball: assembled("inward ball", &[(&ball, DVec3::ZERO, -1.0)]),
            hollow_ball: assembled("hollow ball", &[(&ball, DVec3::ZERO, 1.0), (&ball, DVec3::ZERO, -0.6)]),
            two_balls: assembled(
                "two balls",
                &[(&ball, -DVec3::X * 0.35, 0.3), (&ball, DVec3::X * 0.35, 0.3)],
            ),
            ball,
            triangle: Mesh::new(
                "triangle",
                vec![
                    Vec3::new(0.5, 0.0, 0.0),
                    Vec3::new(-0.25, 0.4, 0.0),
                    Vec3::new(-0.25, -0.4, 0.0),
                ],
                vec![[0, 1, 2]],
            ),
            soups: (0..8).map(soup).collect(),
            unit_cube,
        }
    }

    /// Meshes that are closed, outward and connected.
    pub fn solids(&self) -> [&Arc<Mesh>; 7] {
        [
            &self.torus,
            &self.knot,
            &self.thin_knot,
            &self.ring,
            &self.cube,
            &self.tetrahedron,
            &self.ball,
        ]
    }

    /// Two random meshes of diameter 1.
    pub fn two(&self, rng: &mut Rng) -> [&Arc<Mesh>; 2] {
        [self.any(rng), self.any(rng)]
    }

    /// A random mesh of diameter 1.
    pub fn any(&self, rng: &mut Rng) -> &Arc<Mesh> {
        let solids = self.solids();
        match rng.below(12) {
            0 => rng.pick(&self.soups),
            1 => &self.inward_ball,
            2 => &self.hollow_ball,
            3 => &self.two_balls,
            4 => &self.unwelded_torus,
            _ => solids[rng.below(solids.len())],
        }
    }
}

/// Moves the centre of the bounding box to the origin and scales the farthest vertex to the distance 0.5.
fn unit_sized(name: &str, vertices: Vec<DVec3>, faces: Vec<[u32; 3]>, core: Vec<DVec3>) -> Arc<Mesh> {
    let low = vertices.iter().copied().reduce(DVec3::min).unwrap();
    let high = vertices.iter().copied().reduce(DVec3::max).unwrap();
    let middle = (low + high) * 0.5;
    let radius = vertices.iter().map(|v| v.distance(middle)).fold(0.0, f64::max);
    let sized = |p: &DVec3| (p - middle) * (0.5 / radius);
    Mesh::with_core(
        name,
        vertices.iter().map(|p| sized(p).as_vec3()).collect(),
        faces,
        core.iter().map(sized).collect(),
    )
}

fn circle(t: f64) -> DVec3 {
    DVec3::new(t.cos(), t.sin(), 0.0)
}

/// A point of the trefoil and two directions perpendicular to it. The first is the normal of the torus on which the
/// curve lies.
fn trefoil(t: f64) -> (DVec3, DVec3, DVec3) {
    let on_torus = |t: f64| (2.0 + (3.0 * t).cos()) * circle(2.0 * t) + DVec3::Z * (3.0 * t).sin();
    let normal = (3.0 * t).cos() * circle(2.0 * t) + DVec3::Z * (3.0 * t).sin();
    let tangent = (on_torus(t + 1e-5) - on_torus(t - 1e-5)).normalize();
    (on_torus(t), normal, tangent.cross(normal))
}

/// A tube of `radius` about a closed curve that gives for each parameter a point and two perpendicular directions.
fn tube(name: &str, curve: impl Fn(f64) -> (DVec3, DVec3, DVec3), along: u32, around: u32, radius: f64) -> Arc<Mesh> {
    let mut vertices = vec![];
    let mut core = vec![];
    let mut faces = vec![];
    for i in 0..along {
        let (center, across, up) = curve(TAU * f64::from(i) / f64::from(along));
        core.push(center);
        for j in 0..around {
            let angle = TAU * f64::from(j) / f64::from(around);
            vertices.push(center + (across * angle.cos() + up * angle.sin()) * radius);
            let at = |i: u32, j: u32| (i % along) * around + j % around;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    turn_outward(&vertices, &mut faces);
    unit_sized(name, vertices, faces, core)
}

fn turn_outward(vertices: &[DVec3], faces: &mut [[u32; 3]]) {
    let at = |v: u32| vertices[v as usize];
    let volume: f64 = faces.iter().map(|&[a, b, c]| at(a).dot(at(b).cross(at(c)))).sum();
    if volume < 0.0 {
        faces.iter_mut().for_each(|face| face.swap(1, 2));
    }
}

fn cube() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) - 0.5;
    let vertices: Vec<DVec3> = (0..8).map(corner).collect();
    let sides = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let faces = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    (vertices, faces)
}

fn tetrahedron() -> Arc<Mesh> {
    let vertices = vec![
        DVec3::new(1.0, 1.0, 1.0),
        DVec3::new(1.0, -1.0, -1.0),
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(-1.0, -1.0, 1.0),
    ];
    let mut faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    turn_outward(&vertices, &mut faces);
    unit_sized("tetrahedron", vertices, faces, vec![])
}

/// An octahedron whose faces are split into 16 and projected onto the sphere.
fn ball() -> Arc<Mesh> {
    let mut vertices = vec![];
    let mut faces = vec![];
    for octant in 0..8 {
        let sign = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let first = vertices.len() as u32;
        let mut row_starts = vec![];
        for i in 0..=4u32 {
            row_starts.push(vertices.len() as u32 - first);
            for j in 0..=4 - i {
                let flat = [f64::from(i), f64::from(j), f64::from(4 - i - j)];
                vertices.push((DVec3::from_array(flat) * DVec3::new(sign(0), sign(1), sign(2))).normalize() * 0.5);
            }
        }
        let at = |i: u32, j: u32| first + row_starts[i as usize] + j;
        for i in 0..4 {
            for j in 0..4 - i {
                faces.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if j + 1 < 4 - i {
                    faces.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        if sign(0) * sign(1) * sign(2) < 0.0 {
            let from = faces.len() - 16;
            faces[from..].iter_mut().for_each(|face| face.swap(1, 2));
        }
    }
    turn_outward(&vertices, &mut faces);
    Mesh::new("ball", vertices.iter().map(|v| v.as_vec3()).collect(), faces)
}

/// Several meshes combined into one, each translated and scaled; a negative scale turns the copy inside out.
fn assembled(name: &str, parts: &[(&Arc<Mesh>, DVec3, f64)]) -> Arc<Mesh> {
    let mut vertices = vec![];
    let mut faces = vec![];
    for &(part, center, scale) in parts {
        let first = vertices.len() as u32;
        vertices.extend(part.vertices.iter().map(|v| (center + v.as_dvec3() * scale).as_vec3()));
        faces.extend(part.faces.iter().map(|face| face.map(|v| v + first)));
    }
    Mesh::new(name, vertices, faces)
}

/// Separate corners for every face, and a degenerate face after every seventh.
fn unwelded(mesh: &Mesh) -> Arc<Mesh> {
    let mut vertices = vec![];
    let mut faces = vec![];
    for (i, face) in mesh.faces.iter().enumerate() {
        let first = vertices.len() as u32;
        vertices.extend(face.map(|v| mesh.vertices[v as usize]));
        faces.push([first, first + 1, first + 2]);
        if i % 7 == 0 {
            faces.push([first, first + 1, first]);
        }
    }
    Mesh::new("unwelded torus", vertices, faces)
}

fn soup(number: u64) -> Arc<Mesh> {
    let mut rng = Rng::new(0x50, number);
    let mut vertices = vec![];
    for _ in 0..60 {
        let center = rng.in_ball(0.35);
        vertices.extend([(); 3].map(|()| (center + rng.in_ball(0.14)).as_vec3()));
    }
    Mesh::new(
        &format!("soup {number}"),
        vertices,
        (0..60).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    )
}
