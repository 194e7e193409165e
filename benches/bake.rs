//! Time to bake face tables, compared with a plain rasteriser on the same thread pool in the same run.
//!
//! The plain rasteriser implements what Aly & Elawady 2010 describe in the usual way: an image of heights and one of
//! face indices, scan-line spans, a depth test per pixel, and a search through the image for the remaining indices. It
//! draws the same half of the table, at pixel centres only.
//!
//! Run with `cargo bench --bench bake`, optionally followed by `-- <runs>`; the best run counts. With `-- sizes` it
//! only prints the sizes of tables and the times to load them.

use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::asset::format::{from_bytes, to_bytes};
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::geometry::direction::DirectionGrid;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::projection::raster::Raster;
use bevy_faceoff::projection::{BakeSettings, FaceTable, Progress, SupportHeights};
use glam::{DMat3, Vec3};
use rayon::prelude::*;
use std::f32::consts::TAU;
use std::hint::black_box;
use std::time::{Duration, Instant};

fn main() {
    let runs = std::env::args().filter_map(|a| a.parse().ok()).next().unwrap_or(2);
    let pool = rayon::ThreadPoolBuilder::new().build().expect("a pool");
    println!("{} threads, best of {runs}\n", pool.current_num_threads());
    let meshes = [("torus", torus(12, 10)), ("knot", knot(56, 10))];
    if std::env::args().any(|a| a == "sizes") {
        all_sizes(&meshes, &pool);
        return;
    }

    println!(
        "| mesh | image | visible, plain | by plain alone | visible, ours | directions that differ from the slow form |"
    );
    println!("|---|---|---|---|---|---|");
    for (name, mesh) in &meshes {
        for image in [64, 256] {
            compare(name, mesh, image);
        }
    }

    println!(
        "\n| mesh | degrees | image | plain, s | plain without back faces, s | ours, s | ratio | us per direction and thread |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (name, mesh) in &meshes {
        for image in [128, 256] {
            time(name, mesh, 1, image, &pool, runs);
        }
    }
    time("ball of 20,480", &shapes::ball(1.0, 5), 6, 256, &pool, runs);
    time(
        "torus of 50,000",
        &shapes::torus(250, 100, 0.7, 0.3),
        6,
        256,
        &pool,
        runs,
    );

    all_sizes(&meshes, &pool);

    println!("\n| mesh | heights, KB | slack of the radius, mean | support, ns |");
    println!("|---|---|---|---|");
    for (name, mesh) in &meshes {
        heights(name, mesh);
    }
}

/// Asserts that the fast implementation of visibility gives the same sets as the definition, and compares both with the
/// plain rasteriser. The plain one finds fewer triangles: it has no slivers and shows only one of several equally high
/// ones. Triangles that only it finds are back faces at silhouettes, which rounding raises.
fn compare(name: &str, mesh: &TriMesh, image: u32) {
    let grid = DirectionGrid::new(1).expect("1 divides 90");
    let raster = Raster::new(mesh, image);
    let mut buffers = Plain::default();
    let (mut plain_sum, mut alone, mut sum, mut differ, mut count) = (0, 0, 0, 0, 0);
    for direction in (0..grid.len()).step_by(211).chain([grid.len() - 1]) {
        let rotation = grid.rotation(direction);
        let visible = raster.visible(&rotation);
        differ += usize::from(visible != raster.visible_by_definition(&rotation));
        let plain = buffers.visible(mesh, &rotation, image as usize, false);
        plain_sum += plain.iter().map(|w| w.count_ones() as usize).sum::<usize>();
        let own = visible
            .iter()
            .filter(|&&t| plain[t as usize / 64] >> (t % 64) & 1 == 1)
            .count();
        alone += plain.iter().map(|w| w.count_ones() as usize).sum::<usize>() - own;
        sum += visible.len();
        count += 1;
    }
    let mean = |n: usize| n as f64 / count as f64;
    println!(
        "| {name} | {image} | {:.1} | {:.3} | {:.1} | {differ} of {count} |",
        mean(plain_sum),
        mean(alone),
        mean(sum)
    );
    assert_eq!(differ, 0, "the fast implementation gives another set");
}

fn time(name: &str, mesh: &TriMesh, degrees: u32, image: u32, pool: &rayon::ThreadPool, runs: usize) {
    let settings = BakeSettings {
        faces: true,
        degrees,
        image,
        ..BakeSettings::default()
    };
    let grid = DirectionGrid::new(degrees).expect("divides 90");
    let mut best = [f64::INFINITY; 3];
    for _ in 0..runs {
        for (kind, best) in best.iter_mut().enumerate() {
            let start = Instant::now();
            match kind {
                0 | 1 => drop(black_box(plain_table(mesh, grid, image as usize, kind == 1, pool))),
                _ => drop(black_box(FaceTable::bake(mesh, &settings, pool, &Progress::default()))),
            }
            *best = best.min(start.elapsed().as_secs_f64());
        }
    }
    let [plain, fronts, ours] = best;
    println!(
        "| {name} | {degrees} | {image} | {plain:.2} | {fronts:.2} | {ours:.2} | {:.2} | {:.1} |",
        plain / ours,
        ours * 1.0e6 * pool.current_num_threads() as f64 / f64::from(grid.len())
    );
}

fn all_sizes(meshes: &[(&str, TriMesh)], pool: &rayon::ThreadPool) {
    println!(
        "\n| mesh | groups | runs | visible | raw, MB | run-length, MB | table, MB | memory, MB | file, MB | decode, ms \
         | load the file, ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for (name, mesh) in meshes {
        sizes(name, mesh, pool);
    }
}

/// The shortest time of several calls.
fn best_of<T>(mut f: impl FnMut() -> T) -> Duration {
    (0..20)
        .map(|_| {
            let start = Instant::now();
            let made = black_box(f());
            let time = start.elapsed();
            drop(made);
            time
        })
        .min()
        .expect("some calls")
}

/// The face table of a mesh as after import, with its triangles in cluster order.
fn sizes(name: &str, mesh: &TriMesh, pool: &rayon::ThreadPool) {
    let settings = BakeSettings {
        faces: true,
        ..Default::default()
    };
    let baked = CollisionMesh::bake(mesh, settings, pool, &Progress::default()).expect("nobody cancels");
    let table = baked.faces.as_ref().expect("was asked for");
    let stats = table.stats();
    let bytes = table.encode();
    let triangles = mesh.triangles().len() as u32;
    assert!(FaceTable::decode(&bytes, triangles, &settings).as_ref() == Ok(table));
    let decode = best_of(|| FaceTable::decode(&bytes, triangles, &settings));
    let file = to_bytes(&baked, [0; 32]);
    assert!(from_bytes(&file).is_ok_and(|(read, _)| read == baked));
    let load = best_of(|| from_bytes(&file));
    let mb = |bytes: u64| bytes as f64 / 1.0e6;
    println!(
        "| {name} | {} | {} | {:.1} ({} to {}) | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.1} | {:.1} |",
        stats.groups,
        stats.runs,
        stats.mean_visible,
        stats.min_visible,
        stats.max_visible,
        mb(stats.raw_bytes),
        mb(stats.run_length_bytes),
        mb(stats.encoded_bytes),
        mb(stats.memory_bytes),
        mb(file.len() as u64),
        decode.as_secs_f64() * 1.0e3,
        load.as_secs_f64() * 1.0e3
    );
}

fn heights(name: &str, mesh: &TriMesh) {
    let heights = SupportHeights::of(mesh.used_positions());
    let radius = mesh.used_positions().map(Vec3::length).fold(0.0, f32::max);
    let mut state = 1_u64;
    let mut component = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    };
    let directions: Vec<Vec3> = (0..4096)
        .map(|_| Vec3::new(component(), component(), component()).normalize_or(Vec3::X))
        .collect();
    let slack: f32 = directions
        .iter()
        .map(|&u| {
            let reach = mesh
                .used_positions()
                .map(|v| v.dot(u))
                .fold(f32::NEG_INFINITY, f32::max);
            heights.support(u).dot(u) - reach
        })
        .sum();
    let mut best = Duration::MAX;
    for _ in 0..50 {
        let start = Instant::now();
        let sum: f32 = directions.iter().map(|&u| heights.support(u).dot(u)).sum();
        black_box(sum);
        best = best.min(start.elapsed());
    }
    println!(
        "| {name} | {:.1} | {:.2} % | {:.1} |",
        heights.memory_bytes() as f64 / 1.0e3,
        100.0 * slack / radius / directions.len() as f32,
        best.as_secs_f64() * 1.0e9 / directions.len() as f64
    );
}

/// The table of half of all angles by the plain rasteriser: one set of bits per direction.
fn plain_table(
    mesh: &TriMesh,
    grid: DirectionGrid,
    image: usize,
    fronts_only: bool,
    pool: &rayon::ThreadPool,
) -> Vec<Vec<u64>> {
    pool.install(|| {
        (0..grid.len())
            .into_par_iter()
            .with_min_len(128)
            .map_init(Plain::default, |buffers, direction| {
                buffers.visible(mesh, &grid.rotation(direction), image, fronts_only)
            })
            .collect()
    })
}

/// The plain rasteriser's buffers.
#[derive(Default)]
struct Plain {
    projected: Vec<Vec3>,
    heights: Vec<f32>,
    faces: Vec<u32>,
}

impl Plain {
    fn visible(&mut self, mesh: &TriMesh, rotation: &DMat3, size: usize, fronts_only: bool) -> Vec<u64> {
        self.heights.clear();
        self.heights.resize(size * size, f32::NEG_INFINITY);
        self.faces.clear();
        self.faces.resize(size * size, u32::MAX);
        let bounds = mesh.aabb();
        let center = bounds.center();
        let radius = mesh.vertices().iter().map(|v| v.distance(center)).fold(0.0, f32::max);
        let scale = (size as f32 * 0.5 - 1.5) / radius;
        let middle = size as f32 * 0.5 - 0.5;
        let map = (*rotation * f64::from(scale)).as_mat3();
        self.projected.clear();
        self.projected.extend(mesh.vertices().iter().map(|&v| {
            let p = map * (v - center);
            Vec3::new(p.x + middle, p.y + middle, p.z)
        }));
        for (t, corners) in mesh.triangles().iter().enumerate() {
            let corners = corners.map(|v| self.projected[v as usize]);
            let (ab, ac) = (corners[1] - corners[0], corners[2] - corners[0]);
            let area = ab.x * ac.y - ab.y * ac.x;
            if area == 0.0 || fronts_only && area < 0.0 {
                continue;
            }
            self.triangle(corners, ab.cross(ac), t as u32, size);
        }
        let mut visible = vec![0; mesh.triangles().len().div_ceil(64)];
        for &face in &self.faces {
            if face != u32::MAX {
                visible[face as usize / 64] |= 1_u64 << (face % 64);
            }
        }
        visible
    }

    fn triangle(&mut self, [mut a, mut b, mut c]: [Vec3; 3], normal: Vec3, t: u32, size: usize) {
        let dx = -normal.x / normal.z;
        // Sorted by y: the long edge from a to c is on one side, the edges through b on the other.
        if a.y > b.y {
            std::mem::swap(&mut a, &mut b);
        }
        if b.y > c.y {
            std::mem::swap(&mut b, &mut c);
        }
        if a.y > b.y {
            std::mem::swap(&mut a, &mut b);
        }
        for (low, high) in [(a, b), (b, c)] {
            let (first, last) = (up(low.y), high.y as i32);
            if first > last || low.y == high.y {
                continue;
            }
            let short = (high - low) / (high.y - low.y);
            let long = (c - a) / (c.y - a.y);
            for y in first..=last {
                let on_short = low + short * (y as f32 - low.y);
                let on_long = a + long * (y as f32 - a.y);
                let (left, right) = if on_short.x < on_long.x {
                    (on_short, on_long)
                } else {
                    (on_long, on_short)
                };
                let (x0, x1) = (up(left.x), right.x as i32);
                if x0 > x1 {
                    continue;
                }
                let start = y as usize * size + x0 as usize;
                let width = (x1 - x0) as usize + 1;
                let mut height = left.z + dx * (x0 as f32 - left.x);
                let row = self.heights[start..start + width].iter_mut();
                for (h, face) in row.zip(&mut self.faces[start..start + width]) {
                    if height > *h {
                        *h = height;
                        *face = t;
                    }
                    height += dx;
                }
            }
        }
    }
}

/// The smallest integer not below `x >= 0`.
fn up(x: f32) -> i32 {
    let t = x as i32;
    t + i32::from((t as f32) < x)
}

/// A torus of `around * about * 2` triangles. The radius of the tube is 0.4 of that of the ring.
fn torus(around: u32, about: u32) -> TriMesh {
    tube(around, about, 0.4, |s| Vec3::new((TAU * s).cos(), (TAU * s).sin(), 0.0))
}

/// A (2, 3) torus knot of `around * about * 2` triangles.
fn knot(around: u32, about: u32) -> TriMesh {
    tube(around, about, 0.35, |s| {
        let (p, q) = (2.0 * TAU * s, 3.0 * TAU * s);
        Vec3::new((2.0 + q.cos()) * p.cos(), (2.0 + q.cos()) * p.sin(), -q.sin())
    })
}

/// A closed tube of radius `radius` about the closed curve `center`.
fn tube(around: u32, about: u32, radius: f32, center: impl Fn(f32) -> Vec3) -> TriMesh {
    let mut vertices = Vec::new();
    for i in 0..around {
        let s = i as f32 / around as f32;
        let (here, ahead, behind) = (center(s), center(s + 1.0e-3), center(s - 1.0e-3));
        let tangent = (ahead - behind).normalize();
        // A normal that points away from the axis gives a frame that closes after a turn.
        let away = Vec3::new(here.x, here.y, 0.0);
        let normal = away.reject_from_normalized(tangent).normalize();
        let binormal = tangent.cross(normal);
        for j in 0..about {
            let (sin, cos) = (TAU * j as f32 / about as f32).sin_cos();
            vertices.push(here + radius * (cos * normal + sin * binormal));
        }
    }
    let at = |i: u32, j: u32| i % around * about + j % about;
    let faces = (0..around)
        .flat_map(|i| (0..about).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, c, b], [a, d, c]]
        })
        .collect();
    TriMesh::new(vertices, faces).expect("a valid mesh")
}
