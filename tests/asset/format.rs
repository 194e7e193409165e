//! The `.faceoff` file: what is written is read, and nothing else is.

use bevy_faceoff::asset::format::{
    BAKER_VERSION, FORMAT_VERSION, FormatError, HEADER_LENGTH, from_bytes, read_header, source_hash, to_bytes,
};
use bevy_faceoff::asset::{CollisionMesh, import_bytes};
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::projection::{BakeSettings, Progress};
use glam::Vec3;
use proptest::prelude::*;

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

fn with_table(mesh: &TriMesh) -> CollisionMesh {
    let settings = BakeSettings {
        faces: true,
        degrees: 30,
        image: 32,
        ..BakeSettings::default()
    };
    CollisionMesh::bake(mesh, settings, &pool(2), &Progress::default()).unwrap()
}

/// Puts the checksum right after a change, as someone who means harm would.
fn resigned(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&bytes[..84]);
    hasher.update(&bytes[HEADER_LENGTH..]);
    bytes[84..HEADER_LENGTH].copy_from_slice(hasher.finalize().as_bytes());
    bytes
}

/// The file with its content replaced.
fn with_body(file: &[u8], change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    use lz4_flex::frame::{BlockSize, FrameDecoder, FrameEncoder, FrameInfo};
    use std::io::{Read, Write};
    let mut body = Vec::new();
    FrameDecoder::new(&file[HEADER_LENGTH..])
        .read_to_end(&mut body)
        .unwrap();
    change(&mut body);
    let mut out = file[..HEADER_LENGTH].to_vec();
    out[76..84].copy_from_slice(&(body.len() as u64).to_le_bytes());
    let mut encoder = FrameEncoder::with_frame_info(FrameInfo::new().block_size(BlockSize::Max256KB), out);
    encoder.write_all(&body).unwrap();
    resigned(encoder.finish().unwrap())
}

#[test]
fn round_trip() {
    let degenerate = import_bytes(
        "a.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nf 1 1 2\nf 1 2 3\nf 3 3 3 3 3 3\n",
    )
    .unwrap();
    for mesh in [
        shapes::torus_240(),
        shapes::knot_1120(),
        shapes::cube(1e-3),
        shapes::ball(5e8, 1),
        degenerate,
    ] {
        for baked in [CollisionMesh::new(&mesh), with_table(&mesh)] {
            let bytes = to_bytes(&baked, source_hash(b"source"));
            let (read, header) = from_bytes(&bytes).unwrap();
            assert!(read == baked, "{read:?} is not {baked:?}");
            assert_eq!(to_bytes(&read, header.source_hash), bytes);
            assert_eq!(header, read_header(&bytes[..HEADER_LENGTH]).unwrap());
            assert_eq!(header.baker_version, BAKER_VERSION);
            assert!(header.is_up_to_date(&source_hash(b"source"), &baked.settings));
            assert!(!header.is_up_to_date(&source_hash(b"other"), &baked.settings));
            let other = BakeSettings {
                image: 128,
                ..baked.settings
            };
            assert!(!header.is_up_to_date(&source_hash(b"source"), &other));
            // Whoever reads the mesh alone gets the faces under their numbers.
            let again = import_bytes("x.faceoff", &bytes).unwrap();
            let mut ids = again.face_ids().to_vec();
            ids.sort_unstable();
            assert_eq!(ids, mesh.face_ids());
        }
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let settings = BakeSettings {
        faces: true,
        degrees: 15,
        image: 64,
        ..BakeSettings::default()
    };
    let make = |threads| {
        let mesh = shapes::torus_240();
        let baked = CollisionMesh::bake(&mesh, settings, &pool(threads), &Progress::default()).unwrap();
        to_bytes(&baked, source_hash(b"torus"))
    };
    let first = make(1);
    assert!(first == make(1) && first == make(4));
}

#[test]
fn every_truncation_is_an_error() {
    let baked = with_table(&shapes::cube(1.0));
    let bytes = to_bytes(&baked, [7; 32]);
    for n in 0..bytes.len() {
        let error = from_bytes(&bytes[..n]).unwrap_err();
        let expected = match n {
            0 => error == FormatError::Magic,
            1..HEADER_LENGTH => matches!(error, FormatError::Truncated { .. }),
            HEADER_LENGTH.. => error == FormatError::Checksum,
        };
        assert!(expected, "{n}: {error:?}");
        // With the checksum put right, what may be missing is the mark at the frame's end, which says nothing.
        match from_bytes(&resigned_if_possible(&bytes[..n])) {
            Ok((mesh, _)) => assert!(mesh == baked && n + 4 >= bytes.len(), "{n}"),
            Err(error) => assert_ne!(error, FormatError::Checksum),
        }
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert_eq!(from_bytes(&longer), Err(FormatError::Checksum));
    assert!(from_bytes(&resigned(longer)).is_err());
    // Content cut off inside a frame that is right.
    let length = u64::from_le_bytes(bytes[76..84].try_into().unwrap()) as usize;
    for n in 0..length {
        from_bytes(&with_body(&bytes, |body| body.truncate(n))).unwrap_err();
    }
    from_bytes(&with_body(&bytes, |body| body.push(0))).unwrap_err();
}

fn resigned_if_possible(bytes: &[u8]) -> Vec<u8> {
    if bytes.len() >= HEADER_LENGTH {
        resigned(bytes.to_vec())
    } else {
        bytes.to_vec()
    }
}

#[test]
fn every_bit_flip_is_an_error() {
    let bytes = to_bytes(&CollisionMesh::new(&shapes::cube(1.0)), [7; 32]);
    for i in 0..bytes.len() * 8 {
        let mut flipped = bytes.clone();
        flipped[i / 8] ^= 1 << (i % 8);
        assert!(from_bytes(&flipped).is_err(), "bit {i}");
        // With the checksum put right it may be read, but must not panic, and what is read must be sound.
        if let Ok((mesh, _)) = from_bytes(&resigned(flipped)) {
            sound(&mesh);
        }
    }
}

#[test]
fn flips_in_the_content_are_found_or_harmless() {
    let bytes = to_bytes(&with_table(&shapes::cube(1.0)), [7; 32]);
    let length = u64::from_le_bytes(bytes[76..84].try_into().unwrap()) as usize;
    for i in 0..length * 8 {
        if let Ok((mesh, _)) = from_bytes(&with_body(&bytes, |body| body[i / 8] ^= 1 << (i % 8))) {
            sound(&mesh);
        }
    }
    for i in 0..length.saturating_sub(3) {
        for word in [0u32, 1, 0x7fff_ffff, 0x8000_0000, u32::MAX, 0x7fc0_0000] {
            let changed = with_body(&bytes, |body| body[i..i + 4].copy_from_slice(&word.to_le_bytes()));
            if let Ok((mesh, _)) = from_bytes(&changed) {
                sound(&mesh);
            }
        }
    }
}

/// What everybody relies on.
fn sound(baked: &CollisionMesh) {
    let mesh = &baked.mesh;
    assert!(mesh.vertices().iter().all(|v| v.is_finite()));
    let n = mesh.vertices().len() as u32;
    assert!(mesh.triangles().iter().flatten().all(|&v| v < n));
    assert!(mesh.component_vertices().iter().all(|&v| v < n));
    assert_eq!(mesh.face_ids().len(), mesh.triangles().len());
    let mass = &baked.mass;
    assert!(mass.volume.is_finite() && mass.center.is_finite() && mass.second_moment.is_finite());
    assert!(mass.volume > 0.0 && mass.thickness > 0.0 && mass.thickness.is_finite());
    assert!(baked.radius > 0.0 && baked.radius.is_finite());
    assert!(baked.heights.heights().iter().all(|h| h.is_finite()));
    assert_eq!(baked.faces.is_some(), baked.settings.faces);
}

#[test]
fn other_versions_and_other_files_are_named() {
    let bytes = to_bytes(&CollisionMesh::new(&shapes::cube(1.0)), [7; 32]);
    let mut newer = bytes.clone();
    newer[8] += 1;
    let error = from_bytes(&newer).unwrap_err();
    assert_eq!(error, FormatError::Version(FORMAT_VERSION + 1));
    assert!(error.to_string().contains("bake the mesh again"));
    // Another baker's file still loads, but is not up to date.
    let mut older = bytes.clone();
    older[12] ^= 0x80;
    let (_, header) = from_bytes(&resigned(older)).unwrap();
    assert!(!header.is_up_to_date(&[7; 32], &BakeSettings::default()));
    assert_eq!(from_bytes(b"glTF and so on").unwrap_err(), FormatError::Magic);
    assert_eq!(from_bytes(b"").unwrap_err(), FormatError::Magic);
    for (offset, value) in [
        (16, 2),
        (20, 0),
        (20, 7),
        (24, 15),
        (24, 5000),
        (28, f32::NAN.to_bits()),
        (28, 0.011f32.to_bits()),
        (28, (-1e-6f32).to_bits()),
        (32, 2),
        (36, f32::NAN.to_bits()),
        (36, 0.0f32.to_bits()),
        (36, 0.6f32.to_bits()),
        (40, f32::NAN.to_bits()),
        (40, (-0.1f32).to_bits()),
    ] {
        let mut bad = bytes.clone();
        bad[offset..offset + 4].copy_from_slice(&u32::to_le_bytes(value));
        assert!(matches!(from_bytes(&resigned(bad)), Err(FormatError::Damaged(_))));
    }
}

#[test]
fn hostile_lengths_allocate_nothing() {
    let bytes = to_bytes(&CollisionMesh::new(&shapes::cube(1.0)), [7; 32]);
    // The content's length as announced by the header.
    for length in [0, 1, 1 << 32, u64::MAX, u64::MAX / 255] {
        let mut bad = bytes.clone();
        bad[76..84].copy_from_slice(&length.to_le_bytes());
        assert!(
            matches!(from_bytes(&resigned(bad)), Err(FormatError::Damaged(_))),
            "{length}"
        );
    }
    // The number of vertices, then of triangles, then of dropped faces.
    for at in [0, 4 + 8 * 12, 4 + 8 * 12 + 4 + 12 * 16] {
        for count in [u32::MAX, u32::MAX / 3, 1 << 30, 9] {
            let bad = with_body(&bytes, |body| body[at..at + 4].copy_from_slice(&count.to_le_bytes()));
            assert!(from_bytes(&bad).is_err(), "{at} {count}");
        }
    }
}

#[test]
fn a_bomb_is_not_set_off() {
    use lz4_flex::frame::{BlockSize, FrameEncoder, FrameInfo};
    use std::io::Write;
    let bytes = to_bytes(&CollisionMesh::new(&shapes::cube(1.0)), [7; 32]);
    let frame = |size: usize, block| {
        let mut out = bytes[..HEADER_LENGTH].to_vec();
        let mut encoder = FrameEncoder::with_frame_info(FrameInfo::new().block_size(block), Vec::new());
        encoder.write_all(&vec![0; size]).unwrap();
        out.extend(encoder.finish().unwrap());
        out
    };
    // 256 MiB of zeros in 1 MiB, announced as the little that the file says: reading stops there.
    let start = std::time::Instant::now();
    let bomb = resigned(frame(1 << 28, BlockSize::Max256KB));
    assert!(bomb.len() < 2 << 20);
    assert!(matches!(from_bytes(&bomb), Err(FormatError::Damaged(_))));
    assert!(start.elapsed().as_secs() < 10);
    // Other block sizes mean larger buffers, so they are refused.
    let other = resigned(frame(1 << 20, BlockSize::Max4MB));
    assert!(matches!(from_bytes(&other), Err(FormatError::Damaged(_))));
}

#[test]
fn loading_is_quick() {
    let mesh = shapes::torus(1000, 500, 1.0, 0.3);
    let start = std::time::Instant::now();
    let baked = CollisionMesh::new(&mesh);
    let bake = start.elapsed();
    let start = std::time::Instant::now();
    let bytes = to_bytes(&baked, [0; 32]);
    let write = start.elapsed();
    let start = std::time::Instant::now();
    let (read, _) = from_bytes(&bytes).unwrap();
    eprintln!(
        "10^6 triangles: bake {bake:?}, write {write:?} ({} MB), read {:?}",
        bytes.len() >> 20,
        start.elapsed()
    );
    assert!(read == baked);
    let small = to_bytes(&CollisionMesh::new(&shapes::knot_1120()), [0; 32]);
    let start = std::time::Instant::now();
    from_bytes(&small).unwrap();
    eprintln!("knot: {} bytes read in {:?}", small.len(), start.elapsed());
}

#[test]
fn rebaking_changes_the_table_only() {
    let mesh = shapes::torus_240();
    let plain = CollisionMesh::new(&mesh);
    let baked = with_table(&mesh);
    let again = plain.rebake(baked.settings, &pool(1), &Progress::default()).unwrap();
    assert!(again == baked);
    assert!(again.rebake(plain.settings, &pool(1), &Progress::default()).unwrap() == plain);
    let progress = Progress::default();
    progress.cancel();
    assert!(plain.rebake(baked.settings, &pool(1), &progress).is_err());
}

#[test]
fn debug_output_is_short() {
    let text = format!("{:?}", with_table(&shapes::knot_1120()));
    assert!(text.len() < 120 && text.contains("1120 triangles"), "{text}");
}

#[test]
fn no_vertex_is_outside_the_radius() {
    for mesh in [shapes::knot_1120(), shapes::cube(3.0), shapes::ball(1e8, 2)] {
        let baked = CollisionMesh::new(&mesh);
        let center = baked.mass.center.as_dvec3();
        let reach = baked
            .mesh
            .used_positions()
            .map(|p| p.as_dvec3().distance(center))
            .fold(0.0, f64::max);
        assert!(reach <= f64::from(baked.radius) && f64::from(baked.radius) < reach * 1.000001);
    }
}

#[test]
fn warnings_say_what_is_wrong() {
    assert!(CollisionMesh::new(&shapes::cube(1.0)).warnings().is_empty());
    let open = import_bytes("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n").unwrap();
    let warnings = CollisionMesh::new(&open).warnings();
    assert_eq!(warnings.len(), 2);
    assert!(warnings[0].starts_with("1 of 2 faces"));
    assert!(warnings[1].contains("open"));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    #[test]
    fn any_mesh_survives(
        points in proptest::collection::vec(proptest::array::uniform3(-1e6f32..1e6), 3..30),
        picks in proptest::collection::vec(proptest::array::uniform3(0u32..1000), 1..60),
        hash in any::<[u8; 32]>(),
    ) {
        let n = points.len() as u32;
        let faces = picks.iter().map(|t| t.map(|i| i % n)).collect();
        if let Ok(mesh) = TriMesh::new(points.into_iter().map(Vec3::from).collect(), faces) {
            let baked = CollisionMesh::new(&mesh);
            let bytes = to_bytes(&baked, hash);
            let (read, header) = from_bytes(&bytes).unwrap();
            prop_assert!(read == baked);
            prop_assert_eq!(header.source_hash, hash);
        }
    }

    #[test]
    fn no_damage_panics(changes in proptest::collection::vec((0usize..10_000, any::<u8>()), 1..20)) {
        let bytes = to_bytes(&CollisionMesh::new(&shapes::torus(4, 3, 1.0, 0.3)), [1; 32]);
        let damaged = with_body(&bytes, |body| for (at, value) in &changes {
            let n = body.len();
            body[at % n] = *value;
        });
        let _ = from_bytes(&damaged);
        let mut damaged = bytes;
        for (at, value) in &changes {
            let n = damaged.len();
            damaged[at % n] = *value;
        }
        prop_assert!(from_bytes(&resigned(damaged.clone())).is_err() || damaged.len() > HEADER_LENGTH);
    }
}
