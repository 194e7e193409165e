//! The offline stage against independent answers.

use bevy_faceoff::geometry::direction::{Angles, DirectionGrid, rotation};
use bevy_faceoff::geometry::{Orientation, TriMesh};
use bevy_faceoff::projection::raster::Raster;
use bevy_faceoff::projection::{
    BakeSettings, Cancelled, FaceTable, HeightImage, Progress, SettingsError, SupportHeights, bake_pool,
};
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use std::f32::consts::TAU;
use std::sync::OnceLock;

// ---------- meshes ----------

/// A closed tube about a closed curve, `around * about * 2` triangles.
fn tube(around: u32, about: u32, radius: f32, center: impl Fn(f32) -> Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut vertices = Vec::new();
    for i in 0..around {
        let s = i as f32 / around as f32;
        let here = center(s);
        let tangent = (center(s + 1.0e-3) - center(s - 1.0e-3)).normalize();
        let normal = here.with_z(0.0).reject_from_normalized(tangent).normalize();
        let binormal = tangent.cross(normal);
        for j in 0..about {
            let (sin, cos) = (TAU * j as f32 / about as f32).sin_cos();
            vertices.push(here + radius * (cos * normal + sin * binormal));
        }
    }
    let at = |i: u32, j: u32| i % around * about + j % about;
    let mut faces = Vec::new();
    for (i, j) in (0..around).flat_map(|i| (0..about).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        faces.extend([[a, c, b], [a, d, c]]);
    }
    (vertices, faces)
}

fn torus() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    tube(12, 10, 0.4, |s| Vec3::new((TAU * s).cos(), (TAU * s).sin(), 0.0))
}

fn knot() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    tube(56, 10, 0.35, |s| {
        let (p, q) = (2.0 * TAU * s, 3.0 * TAU * s);
        Vec3::new((2.0 + q.cos()) * p.cos(), (2.0 + q.cos()) * p.sin(), -q.sin())
    })
}

/// A cube with corners `center +- half`, side k = triangles 2k and 2k + 1, in the order of [`SIDES`].
fn cube(center: Vec3, half: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let vertices = (0..8)
        .map(|i| {
            center + half * Vec3::new(i as f32 % 2.0, (i / 2) as f32 % 2.0, (i / 4) as f32) * 2.0 - Vec3::splat(half)
        })
        .collect();
    let quads = [
        [1, 3, 7, 5],
        [0, 4, 6, 2],
        [2, 6, 7, 3],
        [0, 1, 5, 4],
        [4, 5, 7, 6],
        [0, 2, 3, 1],
    ];
    let faces = quads
        .iter()
        .flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]])
        .collect();
    (vertices, faces)
}

const SIDES: [Vec3; 6] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];

fn mesh((vertices, faces): (Vec<Vec3>, Vec<[u32; 3]>)) -> TriMesh {
    TriMesh::new(vertices, faces).expect("a valid mesh")
}

fn flipped(faces: Vec<[u32; 3]>, which: impl Fn(usize) -> bool) -> Vec<[u32; 3]> {
    let flip = |(i, [a, b, c]): (usize, [u32; 3])| if which(i) { [a, c, b] } else { [a, b, c] };
    faces.into_iter().enumerate().map(flip).collect()
}

fn joined(a: (Vec<Vec3>, Vec<[u32; 3]>), b: (Vec<Vec3>, Vec<[u32; 3]>)) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let shift = a.0.len() as u32;
    let faces = a.1.into_iter().chain(b.1.into_iter().map(|t| t.map(|v| v + shift)));
    (a.0.into_iter().chain(b.0).collect(), faces.collect())
}

/// A fixed sequence of numbers in -1..1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

fn soup(count: u32, size: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut noise = Noise(5);
    let mut vertices = Vec::new();
    for _ in 0..count {
        let center = noise.vector();
        vertices.extend([0; 3].map(|_| center + size * noise.vector()));
    }
    (vertices, (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

fn settings(degrees: u32, image: u32) -> BakeSettings {
    BakeSettings {
        faces: true,
        degrees,
        image,
    }
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a pool")
}

fn bake(mesh: &TriMesh, settings: &BakeSettings) -> FaceTable {
    FaceTable::bake(mesh, settings, bake_pool(), &Progress::default()).expect("nobody cancels")
}

// ---------- the oracle: rays through pixel centres, in f64, from the documentation alone ----------

struct Oracle {
    /// Corners in pixels, height last.
    triangles: Vec<[DVec3; 3]>,
    size: usize,
}

/// Margin in pixels within which `f32` may decide either way.
const MARGIN: f64 = 2.0e-3;

#[derive(Default, Debug)]
struct Tally {
    directions: usize,
    visible: usize,
    undecided: usize,
    slivers: usize,
    slivers_seen: usize,
    slivers_missed: usize,
    extra: usize,
}

impl Oracle {
    fn new(mesh: &TriMesh, (a, b): (f64, f64), size: usize) -> Self {
        let (sa, ca, sb, cb) = (a.sin(), a.cos(), b.sin(), b.cos());
        let bounds = mesh.aabb();
        let center = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) / 2.0;
        let used: Vec<DVec3> = mesh.used_positions().map(|p| p.as_dvec3() - center).collect();
        let radius = used.iter().map(|p| p.length()).fold(0.0, f64::max);
        let scale = (size as f64 / 2.0 - 1.5) / radius;
        let middle = size as f64 / 2.0 - 0.5;
        let place = |p: DVec3| {
            // About y first, then about x.
            let (x, z) = (cb * p.x + sb * p.z, -sb * p.x + cb * p.z);
            let (y, z) = (ca * p.y - sa * z, sa * p.y + ca * z);
            DVec3::new(scale * x + middle, scale * y + middle, scale * z)
        };
        let triangles = used
            .chunks(3)
            .map(|t| [place(t[0]), place(t[1]), place(t[2])])
            .collect();
        Self { triangles, size }
    }

    /// Distance in pixels of (x, y) from the border of `t`, positive inside, and the height there.
    fn probe(t: &[DVec3; 3], x: f64, y: f64) -> Option<(f64, f64)> {
        let area = (t[1] - t[0]).cross(t[2] - t[0]).z;
        if area.abs() < 1.0e-9 {
            return None;
        }
        let point = DVec3::new(x, y, 0.0);
        let (mut inside, mut height) = (f64::INFINITY, 0.0);
        for k in 0..3 {
            let (p, q) = (t[(k + 1) % 3], t[(k + 2) % 3]);
            let weight = (q - p).cross(point - p).z / area;
            let edge = (q - p).truncate().length();
            inside = inside.min(weight * area.abs() / edge);
            height += weight * t[k].z;
        }
        Some((inside, height))
    }

    /// Highest point of all triangles but `except` that surely (`margin > 0`) or possibly (`< 0`) hold (x, y).
    fn highest(&self, x: f64, y: f64, except: usize, margin: f64) -> f64 {
        (0..self.triangles.len())
            .filter(|&k| k != except)
            .filter_map(|k| Self::probe(&self.triangles[k], x, y))
            .filter(|p| p.0 > margin)
            .map(|p| p.1)
            .fold(f64::NEG_INFINITY, f64::max)
    }

    fn check(&self, visible: &[u32], tally: &mut Tally) {
        let n = self.size;
        // Per pixel the two highest triangles that possibly cover it, and the highest that surely does.
        let mut possible = vec![[(f64::NEG_INFINITY, usize::MAX); 2]; n * n];
        let mut sure = vec![f64::NEG_INFINITY; n * n];
        let mut hits = vec![Vec::new(); self.triangles.len()];
        for (t, corners) in self.triangles.iter().enumerate() {
            let [low, high] = [DVec3::min, DVec3::max].map(|f| corners.iter().copied().reduce(f).unwrap());
            for y in (low.y - MARGIN).ceil() as usize..=(high.y + MARGIN) as usize {
                for x in (low.x - MARGIN).ceil() as usize..=(high.x + MARGIN) as usize {
                    let Some((inside, height)) = Self::probe(corners, x as f64, y as f64) else {
                        continue;
                    };
                    if inside < -MARGIN {
                        continue;
                    }
                    // Near its border a steep triangle's height is as uncertain as its slope is large.
                    let height = height.clamp(low.z, high.z);
                    let at = y * n + x;
                    hits[t].push((at, inside, height));
                    let pair = &mut possible[at];
                    if height > pair[0].0 {
                        *pair = [(height, t), pair[0]];
                    } else if height > pair[1].0 {
                        pair[1] = (height, t);
                    }
                    if inside > MARGIN {
                        sure[at] = sure[at].max(height);
                    }
                }
            }
        }
        tally.directions += 1;
        tally.visible += visible.len();
        for (t, hits) in hits.iter().enumerate() {
            let seen = visible.binary_search(&(t as u32)).is_ok();
            if hits.is_empty() {
                let corners = self.triangles[t];
                let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                if normal.z.abs() < 1.0e-5 * normal.length() {
                    assert!(
                        !seen || normal.z.abs() > 1.0e-7 * normal.length(),
                        "edge-on, but visible"
                    );
                    continue;
                }
                // A sliver: judged by what is really seen at points inside it.
                let mut top = false;
                for w in [[1.0, 1.0, 1.0], [4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]] {
                    let p = (corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2]) / (w[0] + w[1] + w[2]);
                    top |= p.z > self.highest(p.x, p.y, t, 0.0) + MARGIN;
                }
                tally.slivers += 1;
                tally.slivers_seen += usize::from(seen);
                tally.slivers_missed += usize::from(top && !seen);
                tally.extra += usize::from(seen && !top);
                continue;
            }
            let must = hits.iter().any(|&(at, inside, height)| {
                let other = possible[at].iter().find(|o| o.1 != t).expect("two of them");
                inside > MARGIN && height > other.0 + MARGIN
            });
            let may = hits.iter().any(|&(at, _, height)| height >= sure[at] - MARGIN);
            // Possibly covered, but not surely: the product may treat it as a sliver.
            let border = hits.iter().all(|h| h.1 <= MARGIN);
            assert!(seen || !must, "triangle {t} is visible but not found");
            if seen && !may && !border {
                // Steep triangles: their height at the border varies by more than the margin.
                tally.undecided += 1;
            }
        }
    }
}

/// Compares the visible sets of every `stride`-th direction with the oracle's.
fn against_oracle(name: &str, mesh: &TriMesh, size: u32, stride: usize) -> Tally {
    let grid = DirectionGrid::new(1).unwrap();
    let raster = Raster::new(mesh, size);
    let mut tally = Tally::default();
    for index in (0..grid.len()).step_by(stride) {
        let visible = raster.visible(&grid.rotation(index));
        let (a, b) = grid.degrees(index);
        let oracle = Oracle::new(
            mesh,
            (f64::from(a).to_radians(), f64::from(b).to_radians()),
            size as usize,
        );
        oracle.check(&visible, &mut tally);
        assert_eq!(
            visible,
            raster.visible_plainly(&grid.rotation(index)),
            "{name}: slow and fast form"
        );
    }
    println!("{name} at {size}: {tally:?}");
    assert!(tally.undecided * 2000 <= tally.visible, "{name}: {tally:?}");
    tally
}

#[test]
fn visible_sets_are_what_rays_see() {
    for (name, parts) in [("torus", torus()), ("knot", knot())] {
        for size in [64, 256] {
            let tally = against_oracle(name, &mesh(parts.clone()), size, 2003);
            assert!(tally.slivers_missed * 1000 <= tally.visible, "{name}: {tally:?}");
            assert!(tally.extra * 20 <= tally.visible, "{name}: {tally:?}");
        }
    }
}

#[test]
fn visible_sets_of_meshes_without_an_outside() {
    let (vertices, faces) = torus();
    let inward = mesh((vertices.clone(), flipped(faces.clone(), |_| true)));
    let mixed = mesh((vertices.clone(), flipped(faces.clone(), |i| i % 7 == 0)));
    let open = mesh((vertices.clone(), faces[..200].to_vec()));
    assert_eq!(inward.orientation(), Orientation::Inward);
    assert_eq!(mixed.orientation(), Orientation::Mixed);
    assert_eq!(open.orientation(), Orientation::Open);
    for (name, mesh) in [
        ("inward", &inward),
        ("mixed", &mixed),
        ("open", &open),
        ("soup", &mesh(soup(150, 0.4))),
    ] {
        let tally = against_oracle(name, mesh, 96, 1009);
        assert!(tally.slivers_missed * 200 <= tally.visible, "{name}: {tally:?}");
        assert!(tally.extra * 20 <= tally.visible, "{name}: {tally:?}");
    }
    // Orientation is a matter of speed only.
    let outward = mesh((vertices, faces));
    let grid = DirectionGrid::new(30).unwrap();
    for index in 0..grid.len() {
        let [a, b] = [&outward, &inward].map(|m| Raster::new(m, 128).visible(&grid.rotation(index)));
        assert_eq!(a, b);
    }
}

#[test]
fn surfaces_that_show_their_backs_are_drawn_from_both_sides() {
    // Closed, neighbours agree, positive volume: yet the small cube is inside out, and seen from outside.
    let small = cube(Vec3::new(3.0, 0.2, 0.1), 0.5);
    let turned = mesh(joined(
        cube(Vec3::ZERO, 1.0),
        (small.0.clone(), flipped(small.1.clone(), |_| true)),
    ));
    assert_eq!(turned.orientation(), Orientation::Outward);
    let straight = mesh(joined(cube(Vec3::ZERO, 1.0), small));
    // Two cubes that cross, and a cube with a cavity, whose wall is never seen.
    let crossing = mesh(joined(cube(Vec3::ZERO, 1.0), cube(Vec3::new(0.7, 0.6, 0.55), 1.0)));
    let inner = cube(Vec3::ZERO, 0.5);
    let hollow = mesh(joined(cube(Vec3::ZERO, 1.0), (inner.0, flipped(inner.1, |_| true))));
    let plain = mesh(cube(Vec3::ZERO, 1.0));
    let grid = DirectionGrid::new(10).unwrap();
    for index in 0..grid.len() {
        let view = grid.rotation(index);
        let see = |m: &TriMesh| Raster::new(m, 64).visible(&view);
        assert_eq!(see(&turned), see(&straight), "direction {:?}", grid.degrees(index));
        assert_eq!(see(&hollow), see(&plain));
    }
    against_oracle("crossing", &crossing, 64, 1511);
}

#[test]
fn a_cube_shows_its_outward_sides() {
    let (vertices, faces) = cube(Vec3::new(0.3, -0.2, 5.0), 0.7);
    let outward = mesh((vertices.clone(), faces.clone()));
    let inward = mesh((vertices.clone(), flipped(faces.clone(), |_| true)));
    let mixed = mesh((vertices, flipped(faces, |i| i == 3)));
    let mut counts = [0; 4];
    for (mesh, degrees, image) in [
        (&outward, 1, 256),
        (&inward, 15, 256),
        (&mixed, 15, 256),
        (&outward, 15, 16),
    ] {
        let grid = DirectionGrid::new(degrees).unwrap();
        let raster = Raster::new(mesh, image);
        for index in (0..grid.len())
            .step_by(if degrees == 1 { 7 } else { 1 })
            .chain([grid.len() - 1])
        {
            let direction = grid.direction(index);
            let expected: Vec<u32> = (0..12)
                .filter(|t| SIDES[t / 2].dot(direction) > 1.0e-6)
                .map(|t| t as u32)
                .collect();
            counts[expected.len() / 2] += 1;
            assert_eq!(
                raster.visible(&grid.rotation(index)),
                expected,
                "{:?} from {direction}",
                mesh.orientation()
            );
        }
    }
    println!("sides seen: {counts:?}");
    assert!(counts[1] > 0 && counts[2] > 0 && counts[3] > 0);
    // Along an axis one side only, on every pixel of the picture.
    for (side, direction) in SIDES.into_iter().enumerate() {
        for mesh in [&outward, &inward, &mixed] {
            let image = HeightImage::draw(mesh, direction, 200);
            let seen: Vec<u32> = image
                .faces
                .iter()
                .copied()
                .filter(|&f| f != HeightImage::NONE)
                .collect();
            assert!(seen.iter().all(|f| *f as usize / 2 == side), "from {direction}");
            assert_eq!(Raster::new(mesh, 200).visible(&rotation(direction)).len(), 2);
            let high = image.heights.iter().copied().fold(0.0, f32::max);
            assert!((high - 1.4).abs() < 1.0e-4, "the side is as high as the cube: {high}");
        }
    }
}

#[test]
fn the_picture_shows_visible_triangles() {
    for parts in [torus(), soup(300, 0.1)] {
        let mesh = mesh(parts);
        for direction in [Vec3::X, Vec3::new(0.3, 0.5, -0.7), Vec3::new(-1.0e-3, 1.0, 2.0e-3)] {
            let image = HeightImage::draw(&mesh, direction, 100);
            assert_eq!(
                (image.size, image.heights.len(), image.faces.len()),
                (100, 10_000, 10_000)
            );
            let visible = Raster::new(&mesh, 100).visible(&rotation(direction));
            let mut shown: Vec<u32> = image
                .faces
                .iter()
                .copied()
                .filter(|&f| f != HeightImage::NONE)
                .collect();
            shown.sort_unstable();
            shown.dedup();
            assert!(shown.iter().all(|t| visible.binary_search(t).is_ok()));
            // The rest are slivers next to something higher.
            assert!(
                shown.len() * 5 >= visible.len() * 4,
                "{} of {}",
                shown.len(),
                visible.len()
            );
            let reach = |u: Vec3| {
                mesh.used_positions()
                    .map(|p| p.dot(u))
                    .fold(f32::NEG_INFINITY, f32::max)
            };
            let extent = reach(direction.normalize()) + reach(-direction.normalize());
            assert!(image.heights.iter().all(|h| (0.0..=extent * 1.0001).contains(h)));
        }
    }
}

// ---------- directions ----------

#[test]
fn all_directions_convert_both_ways() {
    let grid = DirectionGrid::new(1).unwrap();
    assert_eq!(grid.len(), 64_442);
    let mut seen = vec![0_u32; grid.len() as usize];
    for a in 0..360 {
        for b in 0..360 {
            let index = grid.index_at(a, b);
            seen[index as usize] += 1;
            let (ra, rb) = (f64::from(a).to_radians(), f64::from(b).to_radians());
            let exact = DVec3::new(-ra.cos() * rb.sin(), ra.sin(), ra.cos() * rb.cos());
            let direction = grid.direction(index);
            assert!((direction.as_dvec3() - exact).length() < 1.0e-6, "({a}, {b})");
            assert_eq!(grid.index_of(direction), index);
            assert_eq!(grid.index_of(direction * 1.0e20), index);
            assert_eq!(grid.index_of(direction * 1.0e-20), index);
            let angles = Angles::of(direction);
            let (ga, gb) = grid.degrees(index);
            assert!((angles.a.to_degrees() - ga as f32).abs() < 1.0e-4);
            if ga.abs() < 90 {
                let off = (angles.b.to_degrees() - gb as f32).rem_euclid(360.0);
                assert!(off.min(360.0 - off) < 1.0e-4, "({a}, {b}): {off}");
            }
            assert!((angles.direction() - direction).length() < 1.0e-6);
            // The rotation brings the direction to +z and keeps lengths and hands.
            for matrix in [grid.rotation(index), rotation(direction)] {
                assert!((matrix * exact - DVec3::Z).length() < 1.0e-6);
                assert!((matrix.determinant() - 1.0).abs() < 1.0e-12);
            }
        }
    }
    // Both poles 720 times (360 columns of two rows), every other direction twice.
    let pole = |i: usize| i == 0 || i + 1 == seen.len();
    assert!(
        (0..seen.len()).all(|i| seen[i] == if pole(i) { 360 } else { 2 }),
        "{:?}",
        &seen[..3]
    );
    for odd in [
        Vec3::ZERO,
        Vec3::NAN,
        Vec3::splat(f32::MAX),
        Vec3::splat(f32::MIN_POSITIVE),
    ] {
        assert!(grid.index_of(odd) < grid.len());
        let _ = (Angles::of(odd), rotation(odd));
    }
    for step in 0..=400 {
        assert_eq!(DirectionGrid::new(step).is_some(), step > 0 && 90 % step == 0);
    }
}

// ---------- tables ----------

#[test]
fn tables_do_not_depend_on_the_number_of_threads() {
    let mesh = mesh(torus());
    let settings = settings(10, 64);
    let tables = [1, 2, 5].map(|n| FaceTable::bake(&mesh, &settings, &pool(n), &Progress::default()).unwrap());
    assert_eq!(tables[0], tables[1]);
    assert_eq!(tables[0], tables[2]);
    assert_eq!(tables[0].encode(), tables[1].encode());
}

#[test]
fn tables_hold_what_the_raster_sees() {
    for (parts, degrees, image) in [
        (torus(), 15, 33),
        (knot(), 30, 128),
        (soup(70, 0.3), 45, 16),
        (soup(5000, 0.02), 90, 4096),
    ] {
        let mesh = mesh(parts);
        let table = bake(&mesh, &settings(degrees, image));
        let decoded = FaceTable::decode(
            &table.encode(),
            mesh.triangles().len() as u32,
            &settings(degrees, image),
        )
        .unwrap();
        assert_eq!(decoded, table);
        let raster = Raster::new(&mesh, image);
        let grid = table.grid();
        for (a, b) in (0..grid.turn()).flat_map(|a| (0..grid.turn()).map(move |b| (a, b))) {
            let index = grid.index_at(a, b);
            let visible = raster.visible(&grid.rotation(index));
            let group = table.at(a, b);
            assert!(group.iter().eq(visible.iter().copied()));
            assert!(decoded.at(a, b) == group && table.group(grid.direction(index)) == group);
            assert_eq!((group.len(), group.is_empty()), (visible.len(), visible.is_empty()));
            for t in 0..mesh.triangles().len() as u32 + 10 {
                assert_eq!(group.contains(t), visible.binary_search(&t).is_ok());
            }
        }
        let stats = table.stats();
        assert_eq!(stats.directions, grid.len() as usize);
        assert!(stats.groups <= stats.runs && stats.runs <= stats.directions);
        assert!(stats.run_length_bytes <= stats.raw_bytes);
        assert!(stats.encoded_bytes <= stats.raw_bytes, "{stats:?}");
    }
}

/// A full bake is too slow without optimisation.
#[cfg(not(debug_assertions))]
#[test]
fn a_full_table_of_the_torus_is_small() {
    let mesh = mesh(torus());
    assert_eq!(mesh.triangles().len(), 240);
    let table = bake(&mesh, &settings(1, 256));
    let stats = table.stats();
    println!("{stats:?}");
    assert_eq!(stats.directions, 64_442);
    assert!(table.memory_bytes() <= 700_000, "{}", table.memory_bytes());
    assert_eq!(
        FaceTable::decode(&table.encode(), 240, &settings(1, 256)).unwrap(),
        table
    );
}

#[test]
fn a_bake_reports_progress_and_can_be_cancelled() {
    let mesh = mesh(knot());
    let progress = Progress::default();
    assert_eq!(progress.get(), (0, 0));
    let table = FaceTable::bake(&mesh, &settings(30, 64), bake_pool(), &progress).unwrap();
    assert_eq!(progress.get(), (table.grid().len(), table.grid().len()));

    // Before it begins.
    let progress = Progress::default();
    progress.cancel();
    assert_eq!(
        FaceTable::bake(&mesh, &settings(1, 256), bake_pool(), &progress),
        Err(Cancelled)
    );
    assert_eq!(progress.get().0, 0);

    // In the middle: a full bake of large images would take minutes.
    let progress = Progress::default();
    std::thread::scope(|scope| {
        let bake = scope.spawn(|| FaceTable::bake(&mesh, &settings(1, 2048), bake_pool(), &progress));
        while progress.get().0 == 0 {
            std::thread::yield_now();
        }
        progress.cancel();
        assert_eq!(bake.join().unwrap(), Err(Cancelled));
    });
    let (done, total) = progress.get();
    assert!(done < total / 10, "{done} of {total}");
}

#[test]
fn settings_are_checked() {
    assert_eq!(BakeSettings::default().validate(), Ok(()));
    for degrees in [0, 4, 7, 91, 180, u32::MAX] {
        assert_eq!(settings(degrees, 256).validate(), Err(SettingsError::Degrees(degrees)));
    }
    for image in [0, 15, 4097, u32::MAX] {
        assert_eq!(settings(1, image).validate(), Err(SettingsError::Image(image)));
    }
    for (degrees, image) in [(90, 16), (45, 4096), (2, 17)] {
        assert_eq!(settings(degrees, image).validate(), Ok(()));
    }
    // The bake brings others into range rather than panic or hang.
    let mesh = mesh(cube(Vec3::ZERO, 1.0));
    assert_eq!(bake(&mesh, &settings(100, 0)), bake(&mesh, &settings(90, 16)));
    assert_eq!(bake(&mesh, &settings(44, 16)), bake(&mesh, &settings(30, 16)));
    let table = bake(&mesh, &settings(30, 16));
    assert!(FaceTable::decode(&table.encode(), 12, &settings(0, 16)).is_err());
    assert!(FaceTable::decode(&table.encode(), 12, &settings(15, 16)).is_err());
    assert!(FaceTable::decode(&table.encode(), 13, &settings(30, 16)).is_err());
}

#[test]
fn extreme_meshes_can_be_baked() {
    let single = mesh((vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
    let needle = mesh((
        vec![Vec3::ZERO, Vec3::X * 1.0e9, Vec3::new(0.5, 1.0e-9, 0.0)],
        vec![[0, 1, 2]],
    ));
    let far = mesh(cube(Vec3::splat(9.0e8), 100.0));
    let tiny = mesh(cube(Vec3::ZERO, 1.0e-36));
    for (name, mesh, least) in [
        ("single", single, 1),
        ("needle", needle, 0),
        ("far", far, 2),
        ("tiny", tiny, 2),
    ] {
        let table = bake(&mesh, &settings(15, 64));
        let stats = table.stats();
        println!("{name}: {stats:?}");
        assert!(stats.max_visible >= least, "{name}");
        assert_eq!(
            FaceTable::decode(&table.encode(), mesh.triangles().len() as u32, &settings(15, 64)),
            Ok(table)
        );
    }
}

fn coarse_table() -> &'static (FaceTable, Vec<u8>) {
    static TABLE: OnceLock<(FaceTable, Vec<u8>)> = OnceLock::new();
    TABLE.get_or_init(|| {
        let table = bake(&mesh(torus()), &settings(30, 64));
        let bytes = table.encode();
        (table, bytes)
    })
}

#[test]
fn truncated_tables_are_refused() {
    let (_, bytes) = coarse_table();
    for len in 0..bytes.len() {
        assert!(FaceTable::decode(&bytes[..len], 240, &settings(30, 64)).is_err());
    }
    let longer: Vec<u8> = bytes.iter().copied().chain([0]).collect();
    assert!(FaceTable::decode(&longer, 240, &settings(30, 64)).is_err());
    // Many triangles, few bytes: one list with one triangle, then nothing changes in any other direction.
    let mut bomb = vec![0xff, 0xff, 0xff, 0xff, 0x0f, 1, 1, 1, 0];
    for _ in 0..64_441 {
        bomb.extend([2, 1, 0]);
    }
    assert!(FaceTable::decode(&bomb, u32::MAX, &settings(1, 64)).is_ok());
}

proptest! {
    #[test]
    fn damaged_tables_never_panic(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)) {
        let (_, bytes) = coarse_table();
        let mut bytes = bytes.clone();
        for (at, value) in flips {
            let at = at.index(bytes.len());
            bytes[at] ^= value;
        }
        if let Ok(table) = FaceTable::decode(&bytes, 240, &settings(30, 64)) {
            // Whatever was accepted is a table of this mesh.
            prop_assert!((0..12).all(|a| (0..12).all(|b| table.at(a, b).iter().all(|t| t < 240))));
            prop_assert_eq!(FaceTable::decode(&table.encode(), 240, &settings(30, 64)), Ok(table));
        }
    }

    #[test]
    fn random_bytes_never_panic(tail in prop::collection::vec(any::<u8>(), 0..400), triangles in any::<u32>()) {
        let mut bytes = Vec::new();
        let mut n = triangles;
        while n >= 0x80 {
            bytes.push(n as u8 | 0x80);
            n >>= 7;
        }
        bytes.extend([n as u8, 90]);
        bytes.extend(tail);
        let _ = FaceTable::decode(&bytes, triangles, &settings(90, 64));
    }
}

// ---------- support heights ----------

/// Directions of all lengths, on axes and borders of the baked triangles, and all over.
fn directions() -> Vec<Vec3> {
    let mut out = Vec::new();
    for x in -8_i32..=8 {
        for y in -8_i32..=8 {
            for z in -8_i32..=8 {
                let u = Vec3::new(x as f32, y as f32, z as f32);
                if u != Vec3::ZERO {
                    out.extend([u, u / 3.0, u * 1.0e20, u * 1.0e-20]);
                    out.push(u + Vec3::new(1.0e-7, -1.0e-7, 1.0e-7));
                }
            }
        }
    }
    let mut noise = Noise(11);
    while out.len() < 150_000 {
        let u = noise.vector();
        let flat = u * [Vec3::ONE, Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, -0.0, 1.0e-20)][out.len() % 3];
        if flat != Vec3::ZERO {
            out.push(flat);
        }
    }
    out
}

#[test]
fn support_heights_are_upper_bounds() {
    let flat: Vec<Vec3> = torus().0.iter().map(|v| v.with_y(0.0)).collect();
    let sets = [
        ("torus", torus().0, 0.02),
        ("knot", knot().0, 0.02),
        ("cube", cube(Vec3::ZERO, 1.0).0, 0.04),
        ("far", cube(Vec3::new(100.0, -40.0, 3.0), 1.0).0, 0.02),
        ("flat", flat, 0.02),
        ("one point", vec![Vec3::new(0.3, -2.0, 0.7); 3], 1.0e-5),
        ("segment", vec![Vec3::X, -Vec3::X], 0.04),
        ("origin", vec![Vec3::ZERO], 1.0),
        ("tiny", torus().0.iter().map(|v| *v * 1.0e-15).collect(), 0.02),
        ("huge", torus().0.iter().map(|v| *v * 1.0e9).collect(), 0.02),
    ];
    let directions = directions();
    for (name, points, most) in sets {
        let heights = SupportHeights::of(points.iter().copied());
        let radius = points.iter().map(|v| v.length()).fold(0.0, f32::max).max(1.0e-30);
        let (mut slack, mut count) = (0.0, 0);
        for &u in &directions {
            let p = heights.support(u);
            let bound = p.dot(u);
            let true_height = |e: DVec3| {
                points
                    .iter()
                    .map(|v| v.as_dvec3().dot(e))
                    .fold(f64::NEG_INFINITY, f64::max)
            };
            let height = true_height(u.as_dvec3());
            assert!(p.as_dvec3().dot(u.as_dvec3()) >= height, "{name}: {u}");
            // Products that underflow are no longer a matter of rounding.
            if u.length() * radius > 1.0e-30 {
                let in_f32 = points.iter().map(|v| v.dot(u)).fold(f32::NEG_INFINITY, f32::max);
                assert!(
                    bound >= in_f32 && f64::from(bound) >= height,
                    "{name}: {u}: {bound} < {height}"
                );
            }
            let length = u.as_dvec3().length();
            slack += (p.as_dvec3().dot(u.as_dvec3()) - height) / length / f64::from(radius);
            count += 1;
        }
        let mean = slack / f64::from(count);
        println!(
            "{name}: mean slack {:.3} % of the radius, {} bytes",
            100.0 * mean,
            heights.memory_bytes()
        );
        assert!(mean < most, "{name}: {mean}");
        assert_eq!(heights.heights().len(), 258);
        assert_eq!(
            SupportHeights::from_heights(heights.heights().to_vec()).as_ref(),
            Some(&heights)
        );
    }
}

#[test]
fn support_heights_survive_odd_input() {
    let heights = SupportHeights::of(torus().0.into_iter());
    for u in [
        Vec3::ZERO,
        -Vec3::ZERO,
        Vec3::NAN,
        Vec3::INFINITY,
        Vec3::splat(f32::MAX),
        Vec3::splat(-f32::MIN_POSITIVE),
        Vec3::X * f32::from_bits(1),
        Vec3::new(f32::MAX, f32::from_bits(1), -1.0),
        Vec3::new(f32::NAN, 1.0, 0.0),
    ] {
        assert!(heights.support(u).is_finite());
    }
    // Exact in f64, where neither end of f32's range matters.
    let points = torus().0;
    for scale in [f32::from_bits(40), 1.0e-38, 1.0e37, 1.0e38] {
        for u in [
            Vec3::new(1.0, -1.0, 0.5),
            Vec3::new(0.1, 0.7, 1.0),
            Vec3::ONE,
            Vec3::new(0.0, 1.0, -1.0),
        ] {
            let u = (u * scale).as_dvec3();
            let height = points
                .iter()
                .map(|v| v.as_dvec3().dot(u))
                .fold(f64::NEG_INFINITY, f64::max);
            assert!(heights.support(u.as_vec3()).as_dvec3().dot(u) >= height, "{u}");
        }
    }
    assert!(SupportHeights::from_heights(vec![]).is_none());
    assert!(SupportHeights::from_heights(vec![0.0; 257]).is_none());
    assert!(SupportHeights::from_heights(vec![f32::NAN; 258]).is_none());
    assert!(SupportHeights::from_heights(vec![1.0; 258]).is_some());
    assert!(SupportHeights::of(std::iter::empty()).support(Vec3::X).is_finite());
}

#[test]
fn the_background_pool_has_named_threads() {
    let pool = bake_pool();
    assert!(pool.current_num_threads() >= 1);
    let name = pool.install(|| std::thread::current().name().map(str::to_owned));
    assert!(name.is_some_and(|n| n.starts_with("faceoff bake")));
    assert!(std::ptr::eq(pool, bake_pool()));
}
