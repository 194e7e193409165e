//! The `.faceoff` file: a baked mesh as bytes.
//!
//! All numbers are little-endian. A fixed header of [`HEADER_LENGTH`] bytes says what the file was made from; the rest is
//! one lz4 frame with the mesh, its figures and the run-length form of its face table.
//!
//! | offset | bytes | content |
//! |---|---|---|
//! | 0 | 8 | magic `FACEOFF\0` |
//! | 8 | 4 | format version |
//! | 12 | 4 | baker version |
//! | 16 | 20 | settings: faces (0 or 1), degrees, image, weld tolerance, inward (0 for a room, 1 for a solid) |
//! | 36 | 32 | blake3 of the source mesh's bytes |
//! | 68 | 8 | length of the frame's content |
//! | 76 | 32 | blake3 of everything else in the file |
//! | 108 | | lz4 frame |
//!
//! A file is believed only as far as its bytes go: lengths are checked against the bytes that are left before anything is
//! allocated, every number is checked for range, and the checksum finds what a disk or a network changed. The checksum is
//! no signature: who makes up a file can make it say that a mesh weighs what it does not, which spoils results, but
//! neither panics nor eats memory. What follows from the triangles alone, how they hang together say, is not in the file but
//! found again.

use super::bytes::{Reader, put};
use super::collision_mesh::{BakedMesh, CollisionMesh};
use crate::geometry::{MassProperties, MeshParts, TriMesh};
use crate::projection::{BakeSettings, FaceTable, Inward, SupportHeights, faces::TableError};
use glam::{Mat3, Vec3};
use lz4_flex::frame::{BlockMode, BlockSize, FrameDecoder, FrameEncoder, FrameInfo};
use std::io::{Read, Write};
use thiserror::Error;

/// The first bytes of every `.faceoff` file.
pub const MAGIC: [u8; 8] = *b"FACEOFF\0";
/// Changes when the meaning of a file's bytes changes. Files of another version are refused.
pub const FORMAT_VERSION: u32 = 3;
/// Changes when the same source and settings bake to something else. Older files still load, but are not up to date.
pub const BAKER_VERSION: u32 = 2;
/// Length of the header in bytes; enough for [`read_header`].
pub const HEADER_LENGTH: usize = 108;

const CHECKSUM_AT: usize = 76;
/// How every frame of ours begins: lz4's magic, version 1, independent blocks of at most 256 KiB, no extras.
const FRAME_START: [u8; 6] = [0x04, 0x22, 0x4d, 0x18, 0x60, 0x50];
/// One byte of an lz4 block stands for at most 255 bytes of content.
const MOST_EXPANSION: u64 = 255;

/// A blake3 hash.
pub type Hash = [u8; 32];

/// The hash by which a `.faceoff` file remembers its source: blake3 of the mesh file's bytes.
pub fn source_hash(source: &[u8]) -> Hash {
    *blake3::hash(source).as_bytes()
}

/// What a file was made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Header {
    /// The [`BAKER_VERSION`] that made it.
    pub baker_version: u32,
    /// What was asked for.
    pub settings: BakeSettings,
    /// [`source_hash`] of the mesh file.
    pub source_hash: Hash,
}

impl Header {
    /// Whether baking this source with these settings now would make the same file.
    pub fn is_up_to_date(&self, source_hash: &Hash, settings: &BakeSettings) -> bool {
        self.baker_version == BAKER_VERSION && self.source_hash == *source_hash && self.settings == *settings
    }
}

/// Why bytes are not a `.faceoff` file of this version.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FormatError {
    /// The first bytes are not [`MAGIC`].
    #[error("this is not a .faceoff file")]
    Magic,
    /// Another version of this library wrote it.
    #[error("the file has format version {0}, this build reads version {FORMAT_VERSION}: bake the mesh again")]
    Version(u32),
    /// The file ends too early.
    #[error("the file is cut off ({what} is missing): copy it again or bake the mesh again")]
    Truncated {
        /// What could not be read.
        what: &'static str,
    },
    /// The bytes are not those that were written.
    #[error("the file is damaged (its checksum does not match): copy it again or bake the mesh again")]
    Checksum,
    /// The checksum matches, but the content is impossible.
    #[error("the file is damaged ({0}): bake the mesh again")]
    Damaged(&'static str),
    /// The lz4 frame does not decompress.
    #[error("the file is damaged (its content does not decompress: {0}): bake the mesh again")]
    Compression(String),
    /// The face table is impossible.
    #[error("{0}: bake the mesh again")]
    Table(#[from] TableError),
}

/// The file for a baked mesh. The same mesh, settings and source give the same bytes.
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
    } = mesh.settings;
    put(&mut out, [u32::from(faces), degrees, image]);
    put(&mut out, [weld_tolerance]);
    put(&mut out, [u32::from(inward == Inward::Solid)]);
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

/// Reads the header alone, to find out whether a file is up to date: the first [`HEADER_LENGTH`] bytes are enough, and the
/// checksum is not looked at.
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
    };
    settings
        .validate()
        .map_err(|_| FormatError::Damaged("its settings are impossible"))?;
    Ok(Header {
        baker_version,
        settings,
        source_hash: reader.array("the source's hash")?,
    })
}

/// Reads a file. Never panics, whatever the bytes, and never allocates more than a small multiple of what an honest file of
/// that length holds.
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
        return Err(FormatError::Damaged("bytes are left over"));
    }
    Ok((baked.into(), header))
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
    if length > (frame.len() as u64).saturating_mul(MOST_EXPANSION) {
        return Err(FormatError::Damaged("it claims more content than its bytes can hold"));
    }
    // The buffer grows with what really comes out, and stops one byte beyond what was announced.
    let mut body = Vec::with_capacity(length.min(frame.len() as u64 * 4) as usize);
    let mut decoder = FrameDecoder::new(frame).take(length + 1);
    decoder
        .read_to_end(&mut body)
        .map_err(|e| FormatError::Compression(e.to_string()))?;
    if body.len() as u64 != length || !decoder.into_inner().into_inner().is_empty() {
        return Err(FormatError::Damaged("its content is not as long as announced"));
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
    put(&mut out, [u32::from(mesh.is_turned())]);

    let mass = &baked.mass;
    put(&mut out, [mass.volume, mass.thickness, baked.radius]);
    put(&mut out, mass.center.to_array());
    put(&mut out, mass.second_moment.to_cols_array());
    put(&mut out, [u32::from(mass.approximate)]);

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
    let [volume, thickness, radius] = reader.floats("the mass")?;
    let center = Vec3::from(reader.floats::<3>("the centre of mass")?);
    let second_moment = Mat3::from_cols_array(&reader.floats("the second moment")?);
    let mass = MassProperties {
        volume,
        center,
        second_moment,
        thickness,
        approximate: flag(reader.u32("the mass")?)?,
    };
    if [volume, thickness, radius].iter().any(|x| *x <= 0.0) || second_moment != second_moment.transpose() {
        return Err(FormatError::Damaged("its mass is impossible"));
    }
    let count = reader.u32("the heights")?;
    let heights: Vec<f32> = reader
        .list::<1>(count, "the heights")?
        .map(|[h]| f32::from_bits(h))
        .collect();
    let heights = SupportHeights::from_heights(heights).ok_or(FormatError::Damaged("its heights are impossible"))?;
    let faces = if settings.faces {
        let length = reader.u64("the face table")?;
        let table = reader.bytes(length, "the face table")?;
        Some(FaceTable::decode(table, mesh.triangles().len() as u32, &settings)?)
    } else {
        None
    };
    Ok(BakedMesh {
        mesh,
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
    let count = reader.u32("the triangles")?;
    let triangles = reader.list(count, "the triangles")?.collect();
    let face_ids = reader.list(count, "the face ids")?.map(|[id]| id).collect();
    let count = reader.u32("the dropped faces")?;
    let dropped = reader.list(count, "the dropped faces")?.collect();
    let is_turned = flag(reader.u32("which way its faces look")?)?;
    TriMesh::from_parts(MeshParts {
        vertices,
        triangles,
        face_ids,
        dropped,
        is_turned,
        weld_tolerance,
    })
    .map_err(FormatError::Damaged)
}

fn flag(word: u32) -> Result<bool, FormatError> {
    match word {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(FormatError::Damaged("a flag is neither 0 nor 1")),
    }
}
