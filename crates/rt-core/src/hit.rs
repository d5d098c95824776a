//! Where a ray may hit, and the small record of a hit.

use core::fmt;
use core::num::NonZeroU64;

/// The open interval of the parameter in which a hit counts: `min < t < max`.
///
/// An interval is an argument of each query, never a part of the ray. It may be empty (`min >= max`) or hold NaN:
/// then nothing is admitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end, not included.
    pub min: f64,
    /// The upper end, not included.
    pub max: f64,
}

impl Interval {
    /// Everything in front of the origin: `0 < t`.
    pub const FORWARD: Interval = Interval { min: 0.0, max: f64::INFINITY };
    /// The whole line.
    pub const LINE: Interval = Interval { min: f64::NEG_INFINITY, max: f64::INFINITY };

    /// The open interval from `min` to `max`.
    #[inline]
    pub const fn new(min: f64, max: f64) -> Self {
        Interval { min, max }
    }

    /// Whether `min < t < max`; false for NaN.
    #[inline]
    pub fn contains(&self, t: f64) -> bool {
        self.min < t && t < self.max
    }

    /// The same interval ended at `max`.
    #[inline]
    pub const fn until(&self, max: f64) -> Self {
        Interval { min: self.min, max }
    }

    /// The same interval begun at `min`.
    #[inline]
    pub const fn after(&self, min: f64) -> Self {
        Interval { min, max: self.max }
    }

    /// The way to make a [`Hit`]: `None` unless `t` lies inside, so that neither NaN nor a parameter out of
    /// range can escape. Parts and roots may be any numbers but the greatest of both together.
    #[inline]
    pub fn admit(&self, t: f64, part: u32, root: u32) -> Option<Hit> {
        if self.contains(t) { Some(Hit::inside(t, part, root)) } else { None }
    }
}

/// A crossing of a ray and a shape: 16 bytes, also as an `Option`, which functions return in two registers.
#[derive(Clone, Copy, PartialEq)]
pub struct Hit {
    t: f64,
    /// `2^32 part + root + 1`.
    place: NonZeroU64,
}

impl Hit {
    /// A hit whose parameter is known to lie inside the interval.
    #[inline(always)]
    pub(crate) fn inside(t: f64, part: u32, root: u32) -> Hit {
        Hit { t, place: NonZeroU64::MIN.saturating_add(u64::from(part) << 32 | u64::from(root)) }
    }

    /// A part and a root, as tables keep them.
    pub(crate) const fn place(part: u32, root: u32) -> Option<NonZeroU64> {
        NonZeroU64::new(((part as u64) << 32 | root as u64) + 1)
    }

    /// A hit whose parameter is known to lie inside the interval, of a part and a root from a table.
    #[inline(always)]
    pub(crate) fn at(t: f64, place: NonZeroU64) -> Hit {
        Hit { t, place }
    }

    /// The only crossing with a shape of one part, if that is met: without a branch.
    #[inline(always)]
    pub(crate) fn only(t: f64, meets: bool) -> Option<Hit> {
        NonZeroU64::new(u64::from(meets)).map(|place| Hit { t, place })
    }

    /// The parameter along the ray, in lengths of its direction, within a few units in the last place.
    #[inline]
    pub fn t(&self) -> f64 {
        self.t
    }

    /// Which part of the shape was hit; each shape says what its parts are.
    #[inline]
    pub fn part(&self) -> u32 {
        ((self.place.get() - 1) >> 32) as u32
    }

    /// The index of this crossing among those of its part with the whole line, counted from `t = -infinity`:
    /// two roots may round to one `t`, the index still tells them apart.
    #[inline]
    pub fn root(&self) -> u32 {
        (self.place.get() - 1) as u32
    }
}

impl fmt::Debug for Hit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Hit")
            .field("t", &self.t)
            .field("part", &self.part())
            .field("root", &self.root())
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hit_says_what_it_was_made_from() {
        for (part, root) in [(0, 0), (0, u32::MAX), (7, 3), (u32::MAX, u32::MAX - 1)] {
            let hit = Interval::LINE.admit(0.5, part, root).unwrap();
            assert_eq!((hit.t(), hit.part(), hit.root()), (0.5, part, root));
        }
        assert_eq!(size_of::<Option<Hit>>(), 16);
        let printed = alloc::format!("{:?}", Interval::LINE.admit(0.5, 1, 2));
        assert_eq!(printed, "Some(Hit { t: 0.5, part: 1, root: 2 })");
    }

    #[test]
    fn nothing_outside_the_open_interval_is_admitted() {
        let within = Interval::new(0.0, 1.0);
        for t in [0.0, 1.0, -0.5, 1.5, f64::NAN, f64::INFINITY] {
            assert_eq!(within.admit(t, 0, 0), None);
        }
        assert_eq!(Interval::new(f64::NAN, 1.0).admit(0.5, 0, 0), None);
    }
}
