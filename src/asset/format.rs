//! The `.faceoff` file format: a baked mesh as bytes.
//!
//! All numbers are little-endian. A fixed header of [`HEADER_LENGTH`] bytes identifies the source and the settings. The
//! rest is one lz4 frame with the mesh, its mass properties, its support heights and its encoded face table.
//!
//! | offset | bytes | content |
//! |---|---|---|
//! | 0 | 8 | magic `FACEOFF\0` |
//! | 8 | 4 | format version |
//! | 12 | 4 | baker version |
//! | 16 | 28 | settings: faces (0 or 1), degrees, image, weld tolerance, inward (0 for a room, 1 for a solid), shell thickness, rounding |
//! | 44 | 32 | blake3 of the source file |
//! | 76 | 8 | length of the frame's content |
//! | 84 | 32 | blake3 of everything else in the file |
//! | 116 | | lz4 frame |
//!
//! The reader is safe for untrusted input. It checks lengths against the remaining bytes before it allocates, and
//! checks the range of all numbers. The checksum detects corruption by a disk or a network. It is not a signature: a
//! forged file can state a wrong mass, for example. That gives wrong results, but neither a panic nor excessive memory.
//! Connectivity and other data that follows from the triangles is not stored; the reader recomputes it.

use super::bytes::{Reader, put};
use super::collision_mesh::{BakedMesh, CollisionMesh};
pub use super::format_error::{FORMAT_VERSION, FormatError};
use crate::geometry::{MassBasis, MassProperties, MeshParts, OneSided, TriMesh};
use crate::projection::{BakeSettings, FaceTable, Inward, SupportHeights};
use glam::{Mat3, Vec3};
use lz4_flex::frame::{BlockMode, BlockSize, FrameDecoder, FrameEncoder, FrameInfo};
use std::io::{Read, Write};

/// The first bytes of each `.faceoff` file.
pub const MAGIC: [u8; 8] = *b"FACEOFF\0";
/// The version of the baker. It changes when the same source and settings give another result. Files of older versions
/// still load, but are not up to date.
pub const BAKER_VERSION: u32 = 4;
/// Length of the header in bytes; enough for [`read_header`].
pub const HEADER_LENGTH: usize = 116;

/// The bases of a mass, by their number in a file.
const BASES: [MassBasis; 6] = [
    MassBasis::Solid,
    MassBasis::Room,
    MassBasis::Capped,
    MassBasis::Winding,
    MassBasis::Shell,
    MassBasis::Box,
];
const CHECKSUM_AT: usize = 84;
/// The start of each frame that this module writes: lz4's magic, version 1, independent blocks of at most 256 KiB, no
/// options.
const FRAME_START: [u8; 6] = [0x04, 0x22, 0x4d, 0x18, 0x60, 0x50];
/// One byte of an lz4 block decompresses to at most 255 bytes.
const MAX_EXPANSION: u64 = 255;

/// A blake3 hash.
pub type Hash = [u8; 32];

/// The hash by which a `.faceoff` file identifies its source: blake3 of the mesh file's bytes.
pub fn source_hash(source: &[u8]) -> Hash {
    *blake3::hash(source).as_bytes()
}

/// The origin of a baked file: source, settings and version of the baker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Header {
    /// The [`BAKER_VERSION`] of the build that baked the file.
    pub baker_version: u32,
    /// The settings of the bake.
    pub settings: BakeSettings,
    /// [`source_hash`] of the mesh file.
    pub source_hash: Hash,
}

impl Header {
    /// Whether a bake of this source with these settings would now give the same file.
    pub fn is_up_to_date(&self, source_hash: &Hash, settings: &BakeSettings) -> bool {
        self.baker_version == BAKER_VERSION && self.source_hash == *source_hash && self.settings == *settings
    }
}

/// Writes a baked mesh as a file. The same mesh, settings and source give the same bytes.
pub fn to_bytes(mesh: &CollisionMesh, source_hash: Hash) -> Vec<u8> {
    let body = body(mesh);
    let mut out = Vec::with_capacity(HEADER_LENGTH + body.len() / 2);
    out.extend_from_slice(&MAGIC);
    put(&mut out, [FORMAT_VERSION, BAKER_VERSION]);
    let BakeSettings {
        faces,
        degrees,
        image,
        weld_tolerance,
        inward,
        shell_thickness,
        rounding,
    } = mesh.settings;
    put(&mut out, [u32::from(faces), degrees, image]);
    put(&mut out, [weld_tolerance]);
    put(&mut out, [u32::from(inward == Inward::Solid)]);
    put(&mut out, [shell_thickness, rounding]);
    out.extend_from_slice(&source_hash);
    put(&mut out, [body.len() as u64]);
    out.resize(HEADER_LENGTH, 0);

    let info = FrameInfo::new()
        .block_mode(BlockMode::Independent)
        .block_size(BlockSize::Max256KB);
    let mut encoder = FrameEncoder::with_frame_info(info, out);
    let mut out = encoder
        .write_all(&body)
        .map_err(lz4_flex::frame::Error::from)
        .and_then(|()| encoder.finish())
        .expect("writing to memory cannot fail");
    debug_assert!(out[HEADER_LENGTH..].starts_with(&FRAME_START));
    let sum = checksum(&out);
    out[CHECKSUM_AT..HEADER_LENGTH].copy_from_slice(&sum);
    out
}

/// Reads only the header, to check whether a file is up to date. The first [`HEADER_LENGTH`] bytes suffice. The
/// checksum is not verified.
///
/// # Errors
/// If the bytes are not the start of a `.faceoff` file of this version.
pub fn read_header(bytes: &[u8]) -> Result<Header, FormatError> {
    if bytes.len() < MAGIC.len() && MAGIC.starts_with(bytes) && !bytes.is_empty() {
        return Err(FormatError::Truncated { what: "the header" });
    }
    let mut reader = Reader::new(bytes.strip_prefix(&MAGIC).ok_or(FormatError::Magic)?);
    let version = reader.u32("the format version")?;
    if version != FORMAT_VERSION {
        return Err(FormatError::Version(version));
    }
    if bytes.len() < HEADER_LENGTH {
        return Err(FormatError::Truncated { what: "the header" });
    }
    let baker_version = reader.u32("the baker version")?;
    let faces = flag(reader.u32("the settings")?)?;
    let settings = BakeSettings {
        faces,
        degrees: reader.u32("the settings")?,
        image: reader.u32("the settings")?,
        weld_tolerance: f32::from_bits(reader.u32("the settings")?),
        inward: if flag(reader.u32("the settings")?)? {
            Inward::Solid
        } else {
            Inward::Room
        },
        shell_thickness: f32::from_bits(reader.u32("the settings")?),
        rounding: f32::from_bits(reader.u32("the settings")?),
    };
    settings
        .validate()
        .map_err(|_| FormatError::Damaged("its settings are invalid"))?;
    Ok(Header {
        baker_version,
        settings,
        source_hash: reader.array("the source's hash")?,
    })
}

/// Reads a file. Safe for any input: it does not panic, and its allocations are bounded by a small multiple of what a
/// valid file of this length needs.
///
/// # Errors
/// If the bytes are not a valid `.faceoff` file of this version.
pub fn from_bytes(bytes: &[u8]) -> Result<(CollisionMesh, Header), FormatError> {
    let header = read_header(bytes)?;
    if checksum(bytes) != bytes[CHECKSUM_AT..HEADER_LENGTH] {
        return Err(FormatError::Checksum);
    }
    let length = Reader::new(&bytes[CHECKSUM_AT - 8..]).u64("the length")?;
    let body = decompress(&bytes[HEADER_LENGTH..], length)?;
    let mut reader = Reader::new(&body);
    let baked = read_body(&mut reader, header.settings)?;
    if !reader.is_empty() {
        return Err(FormatError::Damaged("there are bytes after its end"));
    }
    Ok((baked.into(), header))
}

/// Checks a baked file without building its mesh. Returns the header and the number of triangles.
///
/// The checksum covers the whole file, so that a file which a disk or a network has damaged is found. Whether the
/// content makes a mesh only [`from_bytes`] checks.
///
/// # Errors
/// If the bytes are not a `.faceoff` file of this version, or are damaged.
pub fn verify(bytes: &[u8]) -> Result<(Header, u32), FormatError> {
    let header = read_header(bytes)?;
    if checksum(bytes) != bytes[CHECKSUM_AT..HEADER_LENGTH] {
        return Err(FormatError::Checksum);
    }
    let failed = |e: std::io::Error| FormatError::Compression(e.to_string());
    // The triangles follow the vertices; see `body`.
    let mut content = FrameDecoder::new(&bytes[HEADER_LENGTH..]);
    let mut count = [0; 4];
    content.read_exact(&mut count).map_err(failed)?;
    let vertices = u64::from(u32::from_le_bytes(count)) * size_of::<[f32; 3]>() as u64;
    std::io::copy(&mut content.by_ref().take(vertices), &mut std::io::sink()).map_err(failed)?;
    content.read_exact(&mut count).map_err(failed)?;
    Ok((header, u32::from_le_bytes(count)))
}

fn checksum(file: &[u8]) -> Hash {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&file[..CHECKSUM_AT]);
    hasher.update(&file[HEADER_LENGTH..]);
    *hasher.finalize().as_bytes()
}

fn decompress(frame: &[u8], length: u64) -> Result<Vec<u8>, FormatError> {
    if !frame.starts_with(&FRAME_START) {
        return Err(FormatError::Damaged("its frame has unknown options"));
    }
    if length > (frame.len() as u64).saturating_mul(MAX_EXPANSION) {
        return Err(FormatError::Damaged("it claims more content than its bytes can hold"));
    }
    // The buffer grows with the actual output, and decompression stops one byte after the stated length.
    let mut body = Vec::with_capacity(length.min(frame.len() as u64 * 4) as usize);
    let mut decoder = FrameDecoder::new(frame).take(length + 1);
    decoder
        .read_to_end(&mut body)
        .map_err(|e| FormatError::Compression(e.to_string()))?;
    if body.len() as u64 != length || !decoder.into_inner().into_inner().is_empty() {
        return Err(FormatError::Damaged("its content does not have the stated length"));
    }
    Ok(body)
}

fn body(baked: &BakedMesh) -> Vec<u8> {
    let mesh = &baked.mesh;
    let mut out = Vec::new();
    put(&mut out, [mesh.vertices().len() as u32]);
    put(&mut out, mesh.vertices().iter().flat_map(|v| v.to_array()));
    put(&mut out, [mesh.triangles().len() as u32]);
    put(&mut out, mesh.triangles().iter().flatten().copied());
    put(&mut out, mesh.face_ids().iter().copied());
    put(&mut out, [mesh.dropped()]);
    put(&mut out, mesh.dropped_faces().iter().flatten().copied());
    put_flags(&mut out, mesh.turned());
    let (kind, some): (u32, &[bool]) = match &baked.one_sided {
        OneSided::All => (0, &[]),
        OneSided::None => (1, &[]),
        OneSided::Some(some) => (2, some),
    };
    put(&mut out, [kind]);
    put_flags(&mut out, some);

    let mass = &baked.mass;
    put(&mut out, [mass.volume, mass.thickness, baked.radius]);
    put(&mut out, mass.center.to_array());
    put(&mut out, mass.second_moment.to_cols_array());
    put(&mut out, [mass.basis as u32, u32::from(mass.approximate)]);
    put(&mut out, [mass.error]);

    put(&mut out, [baked.heights.heights().len() as u32]);
    put(&mut out, baked.heights.heights().iter().copied());
    if let Some(faces) = &baked.faces {
        let table = faces.encode();
        put(&mut out, [table.len() as u64]);
        out.extend_from_slice(&table);
    }
    out
}

fn read_body(reader: &mut Reader, settings: BakeSettings) -> Result<BakedMesh, FormatError> {
    let mesh = read_mesh(reader, settings.weld_tolerance)?;
    let count = mesh.triangles().len();
    let kind = reader.u32("the sides of its faces")?;
    let some = read_flags(reader, count, "the sides of its faces")?;
    let one_sided = match (kind, some.is_empty()) {
        (0, true) => OneSided::All,
        (1, true) => OneSided::None,
        (2, false) => OneSided::Some(some),
        _ => return Err(FormatError::Damaged("the sides of its faces are invalid")),
    };
    let [volume, thickness, radius] = reader.floats("the mass")?;
    let center = Vec3::from(reader.floats::<3>("the centre of mass")?);
    let second_moment = Mat3::from_cols_array(&reader.floats("the second moment")?);
    let basis = reader.u32("the mass")?;
    let basis = BASES.get(basis as usize).copied();
    let mass = MassProperties {
        basis: basis.ok_or(FormatError::Damaged("it names no basis of its mass"))?,
        volume,
        center,
        second_moment,
        thickness,
        approximate: flag(reader.u32("the mass")?)?,
        error: reader.floats::<1>("the mass")?[0],
    };
    if [volume, thickness, radius].iter().any(|x| *x <= 0.0) || second_moment != second_moment.transpose() {
        return Err(FormatError::Damaged("its mass is invalid"));
    }
    let count = reader.u32("the support heights")?;
    let heights: Vec<f32> = reader
        .list::<1>(count, "the support heights")?
        .map(|[h]| f32::from_bits(h))
        .collect();
    let heights =
        SupportHeights::from_heights(heights).ok_or(FormatError::Damaged("its support heights are invalid"))?;
    let faces = if settings.faces {
        let length = reader.u64("the face table")?;
        let table = reader.bytes(length, "the face table")?;
        Some(FaceTable::decode(table, mesh.triangles().len() as u32, &settings)?)
    } else {
        None
    };
    Ok(BakedMesh {
        mesh,
        one_sided,
        mass,
        radius,
        heights,
        faces,
        settings,
    })
}

fn read_mesh(reader: &mut Reader, weld_tolerance: f32) -> Result<TriMesh, FormatError> {
    let count = reader.u32("the vertices")?;
    let vertices = reader
        .list(count, "the vertices")?
        .map(|v: [u32; 3]| Vec3::from(v.map(f32::from_bits)))
        .collect();
    let count_of_triangles = reader.u32("the triangles")?;
    let triangles = reader.list(count_of_triangles, "the triangles")?.collect();
    let face_ids = reader
        .list(count_of_triangles, "the face ids")?
        .map(|[id]| id)
        .collect();
    let count = reader.u32("the dropped faces")?;
    let dropped = reader.list(count, "the dropped faces")?.collect();
    let faces = u64::from(count_of_triangles) + u64::from(count);
    let faces = usize::try_from(faces).map_err(|_| FormatError::Damaged("the number of faces is impossible"))?;
    let turned = read_flags(reader, faces, "the winding of its faces")?;
    TriMesh::from_parts(MeshParts {
        vertices,
        triangles,
        face_ids,
        dropped,
        turned,
        weld_tolerance,
    })
    .map_err(FormatError::Damaged)
}

/// Writes flags, 32 to a word, after the number of words.
fn put_flags(out: &mut Vec<u8>, flags: &[bool]) {
    put(out, [flags.len().div_ceil(32) as u32]);
    let words = flags
        .chunks(32)
        .map(|run| (0..).zip(run).fold(0, |word, (i, flag)| word | u32::from(*flag) << i));
    put(out, words);
}

/// Reads `count` flags, or none if none are stored.
fn read_flags(reader: &mut Reader, count: usize, what: &'static str) -> Result<Vec<bool>, FormatError> {
    let length = reader.u32(what)?;
    if length == 0 {
        return Ok(Vec::new());
    }
    if length as usize != count.div_ceil(32) {
        return Err(FormatError::Damaged("it has flags for another number of faces"));
    }
    let words: Vec<u32> = reader.list::<1>(length, what)?.map(|[word]| word).collect();
    Ok((0..count).map(|i| words[i / 32] >> (i % 32) & 1 == 1).collect())
}

fn flag(word: u32) -> Result<bool, FormatError> {
    match word {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(FormatError::Damaged("a flag is neither 0 nor 1")),
    }
}
