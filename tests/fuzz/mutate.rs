//! Random changes of bytes.

use fastrand::Rng;

/// Makes mutated copies.
pub struct Mutator {
    random: Rng,
}

/// Texts and numbers at the edges of what readers accept.
const HOSTILE: [&[u8]; 14] = [
    b"nan",
    b"-1",
    b"1e39",
    b"-inf",
    b"4294967295",
    b"18446744073709551616",
    b"0",
    b"\n",
    b"\0",
    b"\xff\xff\xff\xff",
    b"\0\0\x80\x7f",
    b"\0\0\xc0\x7f",
    b"\0\0\0\x80",
    b"\xff\xff\xff\x7f",
];

impl Mutator {
    pub fn new(seed: u64) -> Self {
        Self {
            random: Rng::with_seed(seed),
        }
    }

    /// One of the seeds with one to eight changes.
    pub fn mutated(&mut self, seeds: &[Vec<u8>]) -> Vec<u8> {
        let random = &mut self.random;
        let mut bytes = seeds[random.usize(..seeds.len())].clone();
        for _ in 0..random.usize(1..=8) {
            let at = random.usize(..=bytes.len());
            let end = (at + random.usize(1..=16)).min(bytes.len());
            match random.u8(..7) {
                0 if at < end => bytes[at] ^= 1 << random.u8(..8),
                1 if at < end => bytes[at] = random.u8(..),
                2 => drop(bytes.drain(at..end)),
                3 => bytes.truncate(at),
                4 => {
                    let hostile = HOSTILE[random.usize(..HOSTILE.len())];
                    drop(bytes.splice(at..(at + hostile.len()).min(bytes.len()), hostile.iter().copied()));
                }
                5 => {
                    let copied = bytes[at..end].to_vec();
                    let to = random.usize(..=bytes.len());
                    drop(bytes.splice(to..to, copied));
                }
                _ => {
                    let other = &seeds[random.usize(..seeds.len())];
                    let from = random.usize(..=other.len());
                    let part = &other[from..(from + random.usize(1..=32)).min(other.len())];
                    drop(bytes.splice(at..end, part.iter().copied()));
                }
            }
        }
        bytes
    }
}
