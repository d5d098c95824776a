//! Which instruction set this process uses.

use core::sync::atomic::{AtomicU8, Ordering};

/// An instruction set that the library has code for, in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
#[non_exhaustive]
pub enum Level {
    /// What every machine of the target has.
    Portable = 1,
    /// x86-64 with AVX2, FMA, BMI1, BMI2, LZCNT and POPCNT.
    Avx2 = 2,
}

static LEVEL: AtomicU8 = AtomicU8::new(0);

/// The level in use: the best that this machine has, unless [`set_level`] chose a lower one.
#[inline]
pub fn level() -> Level {
    match LEVEL.load(Ordering::Relaxed) {
        1 => Level::Portable,
        2 => Level::Avx2,
        _ => detect(),
    }
}

/// Whether the level is known to be [`Level::Avx2`]; false before the first call of [`level`].
#[inline]
pub(super) fn is_avx2() -> bool {
    LEVEL.load(Ordering::Relaxed) == Level::Avx2 as u8
}

/// Uses this level from now on, in the whole process, or the best that the machine has if that is lower.
///
/// The results are the same bits at every level; this is for tests and measurements. Returns the level in use.
pub fn set_level(level: Level) -> Level {
    let level = level.min(best());
    LEVEL.store(level as u8, Ordering::Relaxed);
    level
}

#[cold]
fn detect() -> Level {
    set_level(Level::Avx2)
}

fn best() -> Level {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    if std::arch::is_x86_feature_detected!("avx2")
        && std::arch::is_x86_feature_detected!("fma")
        && std::arch::is_x86_feature_detected!("bmi1")
        && std::arch::is_x86_feature_detected!("bmi2")
        && std::arch::is_x86_feature_detected!("lzcnt")
        && std::arch::is_x86_feature_detected!("popcnt")
    {
        return Level::Avx2;
    }
    Level::Portable
}
