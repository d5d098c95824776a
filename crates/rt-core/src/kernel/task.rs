//! Functions compiled twice: with fused multiply-add and without, chosen at run time.

use super::level::is_avx2;
use super::{Level, level};
use crate::Interval;

/// How the exact product of two numbers is computed: the one thing that differs between instruction sets.
pub trait Product: Copy {
    /// `(p, e)` with `p = fl(a * b)` and `p + e = a * b` exactly, provided `|a|, |b| < 2^995` and
    /// `|a * b| >= 2^-968` or zero.
    fn two_product(a: f64, b: f64) -> (f64, f64);

    /// `c - a * b`, rounded once, provided that `c` and `fl(a * b)` differ by a factor of two at most (then their
    /// difference is exact) and that [`two_product`](Self::two_product) is exact.
    #[inline(always)]
    fn remainder(c: f64, a: f64, b: f64) -> f64 {
        let (p, e) = Self::two_product(a, b);
        (c - p) - e
    }
}

/// Products by fused multiply-add. Only inside a [`Task`] that [`run`] chose it for: elsewhere `mul_add` is a slow
/// library call (with the same result).
#[derive(Clone, Copy, Debug)]
pub struct Fused;

impl Product for Fused {
    #[inline(always)]
    fn two_product(a: f64, b: f64) -> (f64, f64) {
        let p = a * b;
        (p, fused(a, b, -p))
    }

    #[inline(always)]
    fn remainder(c: f64, a: f64, b: f64) -> f64 {
        fused(-a, b, c)
    }
}

#[inline(always)]
fn fused(a: f64, b: f64, c: f64) -> f64 {
    #[cfg(any(feature = "std", test))]
    return a.mul_add(b, c);
    #[cfg(not(any(feature = "std", test)))]
    return libm::fma(a, b, c);
}

/// Products by Veltkamp's splitting and Dekker's algorithm (Dekker 1971, doi:10.1007/BF01397083).
#[derive(Clone, Copy, Debug)]
pub struct Dekker;

impl Product for Dekker {
    #[inline(always)]
    fn two_product(a: f64, b: f64) -> (f64, f64) {
        let p = a * b;
        let (ah, al) = split(a);
        let (bh, bl) = split(b);
        (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
    }
}

/// `a` as a sum of two numbers of at most 26 bits each (Veltkamp's splitting by 2^27 + 1).
#[inline(always)]
fn split(a: f64) -> (f64, f64) {
    const SPLITTER: f64 = 134_217_729.0;
    let c = SPLITTER * a;
    let high = c - (c - a);
    (high, a - high)
}

/// A piece of arithmetic that is generic over the exact product.
///
/// Implement [`run`](Task::run) with `#[inline(always)]`: it is then compiled once for each instruction set.
pub trait Task {
    /// What the piece computes.
    type Output;
    /// Computes it with this kind of product.
    fn run<P: Product>(self) -> Self::Output;
}

/// Runs the task with fused multiply-add where the machine has it, otherwise with Dekker's products.
#[inline(always)]
pub fn run<T: Task>(task: T) -> T::Output {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    if level() >= Level::Avx2 {
        // SAFETY: the level is Avx2 only after run-time detection of AVX2 and FMA on this machine.
        return unsafe { run_fused(task) };
    }
    #[cfg(not(all(target_arch = "x86_64", feature = "std")))]
    let _ = (level, Level::Avx2);
    task.run::<Dekker>()
}

/// Runs the task with Dekker's products, whatever the machine has.
#[inline]
pub fn run_portable<T: Task>(task: T) -> T::Output {
    task.run::<Dekker>()
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[target_feature(enable = "avx2,fma")]
fn run_fused<T: Task>(task: T) -> T::Output {
    task.run::<Fused>()
}

/// A [`Task`] of the coefficients of a polynomial and an interval.
///
/// They travel in registers, each by itself. From memory the compiler would load two at once, and two that have just been
/// written apart (or not as the same pair) are not to be had before everything before them is done.
pub trait Solver {
    /// What is found.
    type Output;
    /// Computes it with this kind of product.
    fn solve<P: Product>(c: [f64; 5], within: Interval) -> Self::Output;
}

/// Solves with fused multiply-add where the machine has it, otherwise with Dekker's products.
#[inline(always)]
pub fn solve<S: Solver>([c0, c1, c2, c3, c4]: [f64; 5], within: Interval) -> S::Output {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    if is_avx2() {
        // SAFETY: the level is Avx2 only after run-time detection of AVX2 and FMA on this machine.
        return unsafe { solve_fused::<S>(c0, c1, c2, c3, c4, within) };
    }
    let _ = is_avx2;
    solve_otherwise::<S>(c0, c1, c2, c3, c4, within)
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[target_feature(enable = "avx2,fma")]
fn solve_fused<S: Solver>(c0: f64, c1: f64, c2: f64, c3: f64, c4: f64, within: Interval) -> S::Output {
    S::solve::<Fused>([c0, c1, c2, c3, c4], within)
}

/// Without fused multiply-add, or before it is known whether there is any.
#[inline(never)]
fn solve_otherwise<S: Solver>(c0: f64, c1: f64, c2: f64, c3: f64, c4: f64, within: Interval) -> S::Output {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    if level() >= Level::Avx2 {
        // SAFETY: as above.
        return unsafe { solve_fused::<S>(c0, c1, c2, c3, c4, within) };
    }
    S::solve::<Dekker>([c0, c1, c2, c3, c4], within)
}
