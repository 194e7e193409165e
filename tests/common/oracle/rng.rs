//! A small random number generator, so that a case is reproducible from its seed for ever.

use glam::{DVec3, Quat};

/// xorshift64*.
pub struct Rng(u64);

impl Rng {
    /// Streams of different `seed` or `stream` are independent.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut rng = Self((seed.wrapping_mul(0xA076_1D64_78BD_642F) ^ stream.wrapping_mul(0xE703_7ED1_A0B4_28DB)) | 1);
        // Discards the first numbers: those of similar seeds are similar.
        for _ in 0..16 {
            rng.next();
        }
        rng
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// Uniform in `low..high`.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Uniform in `0..count`.
    pub fn below(&mut self, count: usize) -> usize {
        (((self.next() >> 32) * count as u64) >> 32) as usize
    }

    /// One of `items`.
    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }

    /// True with the given probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.range(0.0, 1.0) < probability
    }

    /// Uniform in the ball of the given radius.
    pub fn in_ball(&mut self, radius: f64) -> DVec3 {
        loop {
            let p = DVec3::new(self.range(-1.0, 1.0), self.range(-1.0, 1.0), self.range(-1.0, 1.0));
            if p.length_squared() <= 1.0 {
                return p * radius;
            }
        }
    }

    /// Uniform in the cube of the given half side.
    pub fn in_cube(&mut self, half: f64) -> DVec3 {
        DVec3::new(
            self.range(-half, half),
            self.range(-half, half),
            self.range(-half, half),
        )
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let p = self.in_ball(1.0);
            if p.length_squared() > 1e-3 {
                return p.normalize();
            }
        }
    }

    /// A uniform rotation: a direction in four dimensions, rounded to `f32` and so not quite of unit length.
    pub fn rotation(&mut self) -> Quat {
        loop {
            let q = [(); 4].map(|()| self.range(-1.0, 1.0));
            let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
            if (0.1..1.0).contains(&length) {
                let [x, y, z, w] = q.map(|c| (c / length) as f32);
                return Quat::from_xyzw(x, y, z, w);
            }
        }
    }
}
