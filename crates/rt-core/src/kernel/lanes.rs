//! Eight `f32` lanes: the arithmetic of box tests, once portable and once for AVX2.

/// The operations of a box test on eight `f32` at once.
///
/// A value of an implementing type is the proof that the machine has the instructions: it can only be had inside
/// [`vectorize`](super::vectorize). Box tests only cull, so two implementations need not agree in the last bit; each
/// states how a product and a difference round.
pub trait Lanes: Copy {
    /// Eight lanes.
    type F: Copy;
    /// Whether [`mul_sub`](Lanes::mul_sub) rounds once.
    const FUSED: bool;
    /// The same value in all lanes.
    fn splat(self, x: f32) -> Self::F;
    /// The lanes of an array.
    fn load(self, from: &[f32; 8]) -> Self::F;
    /// The lanes as an array.
    fn store(self, x: Self::F) -> [f32; 8];
    /// `a + b`.
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a - b`.
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a * b`.
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a * b - c`, rounded once if [`FUSED`](Lanes::FUSED), otherwise twice.
    fn mul_sub(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `if a > b { a } else { b }`: `b` when either is NaN.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// `if a < b { a } else { b }`: `b` when either is NaN.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The lanes in which `a <= b`, one bit each, lane 0 the lowest.
    fn le(self, a: Self::F, b: Self::F) -> u32;
    /// Asks for the cache lines of a value that will be needed soon. Has no effect but on time.
    fn prefetch<T>(self, value: &T);
}

/// A computation that is generic over the lanes.
///
/// Implement [`run`](Vectorized::run) with `#[inline(always)]`, and so everything hot that it calls: it is then
/// compiled once for each instruction set.
pub trait Vectorized {
    /// What is computed.
    type Output;
    /// Computes it with these lanes.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Eight lanes without any assumption about the machine.
#[derive(Clone, Copy, Debug)]
pub struct PortableLanes;

#[inline(always)]
fn each(a: [f32; 8], b: [f32; 8], f: impl Fn(f32, f32) -> f32) -> [f32; 8] {
    core::array::from_fn(|i| f(a[i], b[i]))
}

impl Lanes for PortableLanes {
    type F = [f32; 8];
    const FUSED: bool = false;
    #[inline(always)]
    fn splat(self, x: f32) -> [f32; 8] {
        [x; 8]
    }
    #[inline(always)]
    fn load(self, from: &[f32; 8]) -> [f32; 8] {
        *from
    }
    #[inline(always)]
    fn store(self, x: [f32; 8]) -> [f32; 8] {
        x
    }
    #[inline(always)]
    fn add(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn mul_sub(self, a: [f32; 8], b: [f32; 8], c: [f32; 8]) -> [f32; 8] {
        self.sub(self.mul(a, b), c)
    }
    #[inline(always)]
    fn max(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(a, b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn min(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(a, b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn le(self, a: [f32; 8], b: [f32; 8]) -> u32 {
        (0..8).fold(0, |mask, i| mask | (((a[i] <= b[i]) as u32) << i))
    }
    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}
}
