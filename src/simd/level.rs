//! The instruction sets that vector code is compiled for: the one that every machine of the target has, and on x86 also
//! AVX2. The better one is chosen at run time.
//!
//! Vector code is generic over a token, `S: Simd`, which proves that the machine has the instructions. It takes effect
//! only in code that is inlined into the block of [`with_simd!`]: what is not inlined is compiled without the wider
//! instructions, and each vector operation in it becomes a call. So functions that take a token are
//! `#[inline(always)]`, and so are closures in which vectors are computed. The instruction sets give the same bits:
//! multiplications and additions are never fused.

use std::sync::atomic::{AtomicBool, Ordering};

pub use target::{Baseline, Wider};

#[cfg(target_feature = "sse2")]
mod target {
    use fearless_simd::{Level, x86};

    pub type Baseline = x86::Sse2;
    pub type Wider = x86::Avx2;

    #[inline(always)]
    pub fn baseline() -> Option<Baseline> {
        Level::baseline().as_sse2()
    }

    #[inline(always)]
    pub fn wider() -> Option<Wider> {
        Level::new().as_avx2()
    }
}

#[cfg(all(target_arch = "aarch64", target_feature = "neon"))]
mod target {
    use fearless_simd::{Level, aarch64};

    pub type Baseline = aarch64::Neon;
    pub type Wider = Baseline;

    #[inline(always)]
    pub fn baseline() -> Option<Baseline> {
        Level::baseline().as_neon()
    }

    #[inline(always)]
    pub fn wider() -> Option<Wider> {
        None
    }
}

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod target {
    use fearless_simd::{Level, wasm32};

    pub type Baseline = wasm32::WasmSimd128;
    pub type Wider = Baseline;

    #[inline(always)]
    pub fn baseline() -> Option<Baseline> {
        Level::baseline().as_wasm_simd128()
    }

    #[inline(always)]
    pub fn wider() -> Option<Wider> {
        None
    }
}

#[cfg(not(any(
    target_feature = "sse2",
    all(target_arch = "aarch64", target_feature = "neon"),
    all(target_arch = "wasm32", target_feature = "simd128")
)))]
mod target {
    pub type Baseline = fearless_simd::Fallback;
    pub type Wider = Baseline;

    #[inline(always)]
    pub fn baseline() -> Option<Baseline> {
        Some(Baseline::new())
    }

    #[inline(always)]
    pub fn wider() -> Option<Wider> {
        None
    }
}

/// The token of the instruction set that every machine of the target has. Code outside [`with_simd!`] may use it.
#[inline(always)]
pub fn baseline() -> Baseline {
    target::baseline().expect("the instructions that the target is built for")
}

/// The token of a wider instruction set, if this machine has one.
#[inline(always)]
pub fn wider() -> Option<Wider> {
    if BASELINE_ONLY.load(Ordering::Relaxed) {
        None
    } else {
        target::wider()
    }
}

static BASELINE_ONLY: AtomicBool = AtomicBool::new(false);

/// Makes `with_simd!` use the baseline, or again the widest instruction set. Tests and benches compare the two.
pub fn use_baseline_only(only: bool) {
    BASELINE_ONLY.store(only, Ordering::Relaxed);
}

/// `with_simd!(token => expression)` evaluates the expression with the token of the machine's widest instruction set.
macro_rules! with_simd {
    ($simd:ident => $body:expr) => {
        match $crate::simd::level::wider() {
            Some($simd) => $crate::simd::lanes::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            ),
            None => {
                let $simd = $crate::simd::level::baseline();
                $crate::simd::lanes::Simd::vectorize(
                    $simd,
                    #[inline(always)]
                    || $body,
                )
            }
        }
    };
}
pub(crate) use with_simd;

#[cfg(test)]
mod tests {
    use super::baseline;
    use crate::geometry::lanes::Stored;
    use crate::simd::lanes::{
        Points, Rows, Select, Simd, SimdBase, SimdFloat, bitmask, boxes_meet, cross, dot, lanes, largest, least, load,
        norm1, splat, store,
    };
    use glam::{Mat3, Vec3};

    /// Numbers at the ends of the range, and where operations change their behaviour.
    const EDGE_CASES: [f32; 16] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f32::MIN_POSITIVE,
        -f32::MIN_POSITIVE,
        1.0e-45,
        -1.0e-45,
        f32::MAX,
        f32::MIN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        f32::EPSILON,
        1.0 - f32::EPSILON,
        3.0e38,
    ];

    /// The results of all operations on the numbers and masks of eight lanes.
    #[inline(always)]
    fn results<S: Simd>(simd: S, numbers: &[Stored; 4]) -> (Vec<Stored>, Vec<u32>) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| load(simd, &numbers[i]));
        let (p, q): (Points<S>, Points<S>) = ([a, b, c], [c, d, b]);
        let masks = [a.simd_lt(b), a.simd_le(b), a.simd_gt(b), a.simd_ge(b)];
        let [less, less_or_equal, more, more_or_equal] = masks;
        let rows = Rows::new(simd, Mat3::from_diagonal(Vec3::new(2.0, -0.1, 0.3)));
        let vectors = [
            [a + b, a - b, a * b],
            [a / b, -a, a.abs()],
            [a.sqrt(), a.min(b), a.max(b)],
            // These would differ if additions and multiplications were fused.
            [a * b + c, a * b - c * d, splat(simd, 0.1) * a + b],
            [less.select(a, b), more_or_equal.select(c, d), more.select(d, a)],
            [dot(p, q), norm1(p), least(q)],
            cross(p, q),
            rows.times(p),
            [largest(p), a.copysign(b), lanes(simd, 0b1010_0110).select(a, b)],
        ];
        let combined = [
            less & more_or_equal,
            less_or_equal | more,
            less ^ more,
            !less,
            boxes_meet(p, q, q, p),
        ];
        (
            vectors.iter().flatten().map(|vector| store(*vector)).collect(),
            masks.iter().chain(&combined).map(|mask| bitmask(*mask)).collect(),
        )
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut known = 0;
        for round in 0..20_000 {
            let numbers = [(); 4].map(|()| {
                Stored([(); 8].map(|()| match round % 3 {
                    0 => EDGE_CASES[random.usize(..EDGE_CASES.len())],
                    1 => f32::from_bits(random.u32(..)),
                    _ => 2.0 * random.f32() - 1.0,
                }))
            });
            let narrow = results(baseline(), &numbers);
            let wide = with_simd!(simd => results(simd, &numbers));
            assert_eq!(narrow.1, wide.1, "masks of {numbers:?}");
            for (narrow, wide) in narrow.0.iter().zip(&wide.0) {
                for (narrow, wide) in narrow.0.iter().zip(wide.0) {
                    let same = narrow.to_bits() == wide.to_bits();
                    // An operation on two NaNs may return either: the compiler chooses.
                    assert!(
                        same || (narrow.is_nan() && wide.is_nan()),
                        "{narrow} {wide} of {numbers:?}"
                    );
                    known += u32::from(!narrow.is_nan());
                }
            }
        }
        assert!(known > 1_000_000, "most results are numbers");
    }
}
