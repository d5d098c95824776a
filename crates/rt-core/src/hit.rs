//! Where a ray may hit, and the small record of a hit.

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

    /// The only way to make a [`Hit`]: `None` unless `t` lies inside, so that neither NaN nor a parameter out of
    /// range can escape.
    #[inline]
    pub fn admit(&self, t: f64, part: u32, root: u32) -> Option<Hit> {
        if self.contains(t) { Some(Hit { t, part, root }) } else { None }
    }
}

/// A crossing of a ray and a shape: 16 bytes, the cheap half of an intersection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    t: f64,
    part: u32,
    root: u32,
}

impl Hit {
    /// The parameter along the ray, in lengths of its direction, within a few units in the last place.
    #[inline]
    pub fn t(&self) -> f64 {
        self.t
    }

    /// Which part of the shape was hit; each shape says what its parts are.
    #[inline]
    pub fn part(&self) -> u32 {
        self.part
    }

    /// The index of this crossing among those of its part with the whole line, counted from `t = -infinity`:
    /// two roots may round to one `t`, the index still tells them apart.
    #[inline]
    pub fn root(&self) -> u32 {
        self.root
    }
}
