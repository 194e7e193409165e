//! Reading and writing of little-endian numbers. The reader checks all lengths.

use super::format_error::FormatError;

/// A number that can be written as little-endian bytes.
pub(super) trait Number {
    fn push(self, out: &mut Vec<u8>);
}

impl Number for u32 {
    fn push(self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.to_le_bytes());
    }
}

impl Number for u64 {
    fn push(self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.to_le_bytes());
    }
}

impl Number for f32 {
    fn push(self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.to_le_bytes());
    }
}

/// Appends numbers.
pub(super) fn put<T: Number>(out: &mut Vec<u8>, numbers: impl IntoIterator<Item = T>) {
    for n in numbers {
        n.push(out);
    }
}

/// Reads from a slice. Each read has a name, `what`, so that an error can say what is missing.
pub(super) struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn bytes(&mut self, length: u64, what: &'static str) -> Result<&'a [u8], FormatError> {
        let (head, tail) = usize::try_from(length)
            .ok()
            .and_then(|n| self.0.split_at_checked(n))
            .ok_or(FormatError::Truncated { what })?;
        self.0 = tail;
        Ok(head)
    }

    pub(super) fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], FormatError> {
        let (head, tail) = self.0.split_first_chunk().ok_or(FormatError::Truncated { what })?;
        self.0 = tail;
        Ok(*head)
    }

    pub(super) fn u32(&mut self, what: &'static str) -> Result<u32, FormatError> {
        self.array(what).map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self, what: &'static str) -> Result<u64, FormatError> {
        self.array(what).map(u64::from_le_bytes)
    }

    /// Reads `N` numbers. They must be finite.
    pub(super) fn floats<const N: usize>(&mut self, what: &'static str) -> Result<[f32; N], FormatError> {
        let mut out = [0.0; N];
        for x in &mut out {
            *x = f32::from_bits(self.u32(what)?);
        }
        if out.iter().all(|x| x.is_finite()) {
            Ok(out)
        } else {
            Err(FormatError::Damaged("a number is not finite"))
        }
    }

    /// Reads `count` groups of `N` words. Fails without any allocation if the input is too short.
    pub(super) fn list<const N: usize>(
        &mut self,
        count: u32,
        what: &'static str,
    ) -> Result<impl ExactSizeIterator<Item = [u32; N]> + use<'a, N>, FormatError> {
        let bytes = self.bytes(u64::from(count) * N as u64 * 4, what)?;
        Ok(bytes.chunks_exact(N * 4).map(|group| {
            std::array::from_fn(|i| {
                let word = &group[i * 4..i * 4 + 4];
                u32::from_le_bytes([word[0], word[1], word[2], word[3]])
            })
        }))
    }
}
