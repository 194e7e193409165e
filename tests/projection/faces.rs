//! The offline stage against independent answers.

use bevy_faceoff::geometry::direction::{Angles, DirectionGrid, rotation};
use bevy_faceoff::geometry::{Orientation, TriMesh};
use bevy_faceoff::projection::raster::Raster;
use bevy_faceoff::projection::{BakeSettings, Cancelled, FaceTable, HeightImage, Progress, SettingsError, bake_pool};
use glam::{DVec3, Vec3};

use super::meshes::*;
use super::oracle::{Oracle, Tally};

fn settings(degrees: u32, image: u32) -> BakeSettings {
    BakeSettings {
        faces: true,
        degrees,
        image,
        ..BakeSettings::default()
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
            raster.visible_by_definition(&grid.rotation(index)),
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
fn small_and_large_triangles_are_drawn_as_defined() {
    // Eight triangles in a row are of one size, or one of them is much larger.
    let large = soup(40, 0.8);
    let small = soup(2000, 0.02);
    let (vertices, faces) = joined(large, small);
    let (large, small) = faces.split_at(40);
    let mut mixed = small.to_vec();
    large.iter().enumerate().for_each(|(i, &t)| mixed.insert(11 * i, t));
    let grid = DirectionGrid::new(15).unwrap();
    for mesh in [mesh((vertices.clone(), faces.clone())), mesh((vertices, mixed))] {
        for size in [16, 61, 200, 512] {
            let raster = Raster::new(&mesh, size);
            let mut found = 0;
            for index in (0..grid.len()).step_by(7) {
                let view = grid.rotation(index);
                let visible = raster.visible(&view);
                assert_eq!(
                    visible,
                    raster.visible_by_definition(&view),
                    "{size}, direction {index}"
                );
                found += visible.len();
            }
            assert!(found > 1000, "{found} visible at {size}");
        }
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

#[test]
fn the_background_pool_has_named_threads() {
    let pool = bake_pool();
    assert!(pool.current_num_threads() >= 1);
    let name = pool.install(|| std::thread::current().name().map(str::to_owned));
    assert!(name.is_some_and(|n| n.starts_with("faceoff bake")));
    assert!(std::ptr::eq(pool, bake_pool()));
}
