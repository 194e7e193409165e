//! Accessors: arrays of numbers in buffers. All lengths are checked before memory is allocated or read.

use super::schema::{Accessor, Root};
use glam::Vec3;

/// The document with the bytes of its buffers; `None` for a buffer without data.
pub(super) struct Data<'a> {
    pub(super) root: &'a Root,
    pub(super) buffers: Vec<Option<&'a [u8]>>,
    /// The total length of the file and the other files it refers to, in bytes.
    pub(super) length: u64,
}

/// The component type of an accessor.
#[derive(Clone, Copy, PartialEq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// The type for one of the OpenGL constants that glTF uses.
    fn of(constant: u32) -> Result<Self, String> {
        Ok(match constant {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            other => return Err(format!("there is no component type {other}")),
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn index(self, bytes: &[u8]) -> u32 {
        match (self, bytes) {
            (Self::U8, &[a]) => a.into(),
            (Self::U16, &[a, b]) => u16::from_le_bytes([a, b]).into(),
            (_, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]),
            _ => u32::MAX,
        }
    }

    /// Decodes a coordinate. Quantized coordinates are integers; normalized ones are divided by the largest integer.
    fn coordinate(self, bytes: &[u8], normalized: bool) -> f32 {
        let (number, largest) = match (self, bytes) {
            (Self::I8, &[a]) => (f32::from(a as i8), 127.0),
            (Self::U8, &[a]) => (f32::from(a), 255.0),
            (Self::I16, &[a, b]) => (f32::from(i16::from_le_bytes([a, b])), 32767.0),
            (Self::U16, &[a, b]) => (f32::from(u16::from_le_bytes([a, b])), 65535.0),
            (_, &[a, b, c, d]) => return f32::from_le_bytes([a, b, c, d]),
            _ => return f32::NAN,
        };
        if normalized {
            (number / largest).max(-1.0)
        } else {
            number
        }
    }
}

impl<'a> Data<'a> {
    /// The number of elements that an accessor claims to have. The data may be shorter.
    pub(super) fn count(&self, accessor: usize) -> Result<u64, String> {
        Ok(self.accessor(accessor)?.count)
    }

    pub(super) fn positions(&self, accessor: usize) -> Result<Vec<Vec3>, String> {
        let accessor = self.accessor(accessor)?;
        let component = Component::of(accessor.component_type)?;
        if accessor.shape != "VEC3" || component == Component::U32 {
            return Err("positions must be VEC3, of floats or of 8 or 16 bits".into());
        }
        self.all(accessor, component, 3, Vec3::ZERO, |bytes| {
            let mut numbers = bytes
                .chunks_exact(component.size())
                .map(|number| component.coordinate(number, accessor.normalized));
            Vec3::from(std::array::from_fn(|_| numbers.next().unwrap_or(f32::NAN)))
        })
    }

    pub(super) fn indices(&self, accessor: usize) -> Result<Vec<u32>, String> {
        let accessor = self.accessor(accessor)?;
        let component = Component::of(accessor.component_type)?;
        if accessor.shape != "SCALAR" || !is_index(component) {
            return Err("indices must be SCALAR, of 8, 16 or 32 bits without sign".into());
        }
        self.all(accessor, component, 1, 0, |bytes| component.index(bytes))
    }

    fn accessor(&self, accessor: usize) -> Result<&'a Accessor, String> {
        let all = &self.root.accessors;
        all.get(accessor)
            .ok_or_else(|| format!("it does not exist, there are {}", all.len()))
    }

    /// All elements of an accessor, with sparse values applied.
    fn all<T: Clone>(
        &self,
        accessor: &Accessor,
        component: Component,
        width: usize,
        zero: T,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, String> {
        let size = component.size() * width;
        let mut elements: Vec<T> = match accessor.buffer_view {
            Some(view) => self
                .elements(view, accessor.byte_offset, accessor.count, size)?
                .map(&read)
                .collect(),
            // All zeros. A valid file has no more of them than it has bytes.
            None if accessor.count <= self.length => vec![zero; accessor.count as usize],
            None => return Err(format!("it has {} elements, but no buffer view", accessor.count)),
        };
        let Some(sparse) = &accessor.sparse else {
            if accessor.buffer_view.is_none() {
                return Err("it has neither a buffer view nor sparse values".into());
            }
            return Ok(elements);
        };
        if sparse.count > accessor.count {
            return Err(format!(
                "it has {} elements and {} sparse values",
                accessor.count, sparse.count
            ));
        }
        let kind = Component::of(sparse.indices.component_type)?;
        if !is_index(kind) {
            return Err("sparse indices must have 8, 16 or 32 bits without sign".into());
        }
        let places = self.elements(
            sparse.indices.buffer_view,
            sparse.indices.byte_offset,
            sparse.count,
            kind.size(),
        )?;
        let values = self.elements(sparse.values.buffer_view, sparse.values.byte_offset, sparse.count, size)?;
        for (place, value) in places.zip(values) {
            let place = kind.index(place);
            *elements.get_mut(place as usize).ok_or_else(|| {
                format!(
                    "a sparse value has index {place}, but there are {} elements",
                    accessor.count
                )
            })? = read(value);
        }
        Ok(elements)
    }

    /// `count` elements of `size` bytes in a buffer view.
    fn elements(
        &self,
        view: usize,
        offset: u64,
        count: u64,
        size: usize,
    ) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, String> {
        let views = &self.root.buffer_views;
        let described = views
            .get(view)
            .ok_or_else(|| format!("its buffer view {view} does not exist, there are {}", views.len()))?;
        let buffer = self.buffers.get(described.buffer).ok_or_else(|| {
            let count = self.buffers.len();
            format!(
                "buffer view {view} is in buffer {}, but there are {count}",
                described.buffer
            )
        })?;
        let buffer = buffer.ok_or_else(|| {
            let buffer = described.buffer;
            format!("buffer view {view} is in buffer {buffer}, which has no data; is it compressed?")
        })?;
        let bytes = slice(buffer, described.byte_offset, described.byte_length).ok_or_else(|| {
            format!(
                "buffer view {view} has {} bytes from byte {} on, but buffer {} has {}",
                described.byte_length,
                described.byte_offset,
                described.buffer,
                buffer.len()
            )
        })?;
        // Zero is invalid in glTF, but some exporters write it for "none".
        let stride = described.byte_stride.filter(|s| *s != 0).unwrap_or(size as u64);
        if stride < size as u64 {
            return Err(format!(
                "its elements have {size} bytes, but its stride is {stride} bytes"
            ));
        }
        let needed = match count {
            0 => Some(0),
            _ => stride.checked_mul(count - 1).and_then(|n| n.checked_add(size as u64)),
        };
        let bytes = needed.and_then(|n| slice(bytes, offset, n)).ok_or_else(|| {
            let there = bytes.len();
            format!("its {count} elements from byte {offset} on do not fit the {there} bytes of buffer view {view}")
        })?;
        Ok(bytes.chunks(stride as usize).map(move |chunk| &chunk[..size]))
    }
}

fn is_index(component: Component) -> bool {
    matches!(component, Component::U8 | Component::U16 | Component::U32)
}

fn slice(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = start.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(start..end)
}
