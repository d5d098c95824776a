//! A line against a frustum in `f64`, with bounds of all errors: certain, or in doubt.
//!
//! With `d'` and `w'` the parts of direction and origin across the axis, the closest approach to the axis is at
//! `t0 = -w'.d' / |d'|^2`, at a distance `|m|`, `m = w' + t0 d'`, where the frustum's radius is `e0`, growing by `e1`.
//! Since `m . d' = 0`, the crossings are at
//!
//! ```text
//! t0 + (e0 e1 -+ sqrt(D)) / A,   D = |d'|^2 (e0^2 - |m|^2) + e1^2 |m|^2,   A = |d'|^2 - e1^2.
//! ```
//!
//! Errors. Let u = 2^-53, K = |d| / |d'|, S at least |w| and the size of the frustum. Axis, scalar products and
//! differences err by less than 10 u |w| in `w'` and 8 u |d| in `d'`, so at `t0`, at most |w| / |d'|, `m` errs by
//! less than (14 + 8 K) u S across the ray's plane; `z` at `t0` by less than (7 + 8 K) u S. All this is below
//! `16 u S K^2 + 14 u S < E = 32 u S K^2`. `e0` errs by less than `F = (1 + |k|) (E + 32 u |e0| K^2)`, with `k` the
//! slope. With `q = |e0| + 2 max(R)` an upper bound of `|e0| + |m|` (lines that pass farther away are gone), `D` errs
//! by less than `4 (|d'|^2 + e1^2) (q + F) F`, including all roundings.
//!
//! Where `D` is more than `CLEAR` = 2^14 times that, `F < q / 2^16`, and the parameters err by less than 2^-15 from
//! the root and twice 2^-16 from the rest, of half the chord `sqrt(D) / |A|`: its 2^-13 is a margin. Where `D` is 2^20
//! times that, so is 2^-19.

use super::{BASE, SIDE, TOP};
use crate::math::{exp2i, sqrt};
use crate::scaled::{CLEAR, Candidate, Rough, margin, moderate};
use glam::DVec3;

/// The numbers of a frustum, rounded to `f64`, all in one unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Numbers {
    pub axis: DVec3,
    pub height: f64,
    pub base_radius: f64,
    pub slope: f64,
    /// The larger radius.
    pub reach: f64,
    /// At least height and radii; NaN where their squares would leave the range of the exponents.
    pub size: f64,
}

impl Numbers {
    /// The same frustum in another unit of length, in which its squares are in range; `height` is its height there.
    pub fn scaled(&self, power: f64, height: f64) -> Numbers {
        let reach = self.reach * power;
        Numbers { height, base_radius: self.base_radius * power, reach, size: height + reach, ..*self }
    }

    /// The span of a line inside. `SLOPED` is false when both radii are the same: then the slope is not looked at.
    ///
    /// `w` is the origin minus the base; `d` the direction.
    #[inline(always)]
    pub fn span<const SLOPED: bool>(&self, w: DVec3, d: DVec3) -> Rough {
        let axis = self.axis;
        let (z_far, z_growth) = (axis.dot(w), axis.dot(d));
        let across = d - axis * z_growth;
        let away = w - axis * z_far;
        let square = across.dot(across);
        let inverse = 1.0 / square;
        let t0 = -(away.dot(across) * inverse);
        let m = away + across * t0;
        let mm = m.dot(m);

        let far = w.x.abs() + w.y.abs() + w.z.abs() + self.size;
        let spread = (1.0 + z_growth * z_growth * inverse) * exp2i(-48);
        let error = far * spread;
        let edge = self.reach + 2.0 * error;
        if !moderate(square) {
            return Rough::Doubt;
        }
        if mm > edge * edge {
            return Rough::Miss;
        }

        let z0 = z_far + t0 * z_growth;
        let (enter, leave, half, starts, ends, relative);
        if SLOPED {
            let slope = self.slope;
            let e0 = self.base_radius + slope * z0;
            let e1 = slope * z_growth;
            let size = square + e1 * e1;
            let error = (1.0 + slope.abs()) * (error + e0.abs() * spread);
            let depth = square * (e0 * e0 - mm) + e1 * e1 * mm;
            let doubt = 4.0 * size * (e0.abs() + 2.0 * self.reach + error) * error;
            if depth < -doubt {
                return Rough::Miss;
            }
            relative = margin(depth, doubt);
            let lead = square - e1 * e1;
            // The sign of the leading coefficient errs with K u (1 + |k|) at most, far less than 2^-10; nearer to
            // zero one root runs away and its error grows.
            if !(depth > CLEAR * doubt && lead.abs() > exp2i(-10) * size) {
                return Rough::Doubt;
            }
            let root = sqrt(depth);
            let middle = e0 * e1;
            let c = mm - e0 * e0;
            // The root that is larger in size first, the other from their product c / lead.
            let q = if middle > 0.0 { middle + root } else { middle - root };
            let r = 1.0 / (lead * q);
            let (large, small) = (q * q * r, c * lead * r);
            (enter, leave) = if middle > 0.0 { (small, large) } else { (large, small) };
            half = root / lead.abs();
            // On a line steeper than the side, one of the crossings is on the other nappe.
            starts = lead > 0.0 || e1 > 0.0;
            ends = lead > 0.0 || e1 < 0.0;
        } else {
            let depth = self.base_radius * self.base_radius - mm;
            let doubt = 4.0 * (3.0 * self.base_radius + error) * error;
            if depth < -doubt {
                return Rough::Miss;
            }
            if !(depth > CLEAR * doubt) {
                return Rough::Doubt;
            }
            relative = margin(depth, doubt);
            half = sqrt(depth * inverse);
            (enter, leave) = (-half, half);
            (starts, ends) = (true, true);
        }

        let margin = half * relative;
        let z_margin = z_growth.abs() * margin + 4.0 * error;
        let zone = |s: f64| {
            let z = z0 + s * z_growth;
            let above = z - self.height;
            if z > z_margin {
                if above < -z_margin {
                    Zone::Between
                } else if above > z_margin {
                    Zone::Above
                } else {
                    Zone::Doubt
                }
            } else if z < -z_margin {
                Zone::Below
            } else {
                Zone::Doubt
            }
        };
        let rising = z_growth > 0.0;
        let first = if starts {
            zone(enter)
        } else if rising {
            Zone::Below
        } else {
            Zone::Above
        };
        let last = if ends {
            zone(leave)
        } else if rising {
            Zone::Above
        } else {
            Zone::Below
        };
        if first == Zone::Doubt || last == Zone::Doubt {
            return Rough::Doubt;
        }
        if first == last && first != Zone::Between {
            return Rough::Miss;
        }
        // Both caps, each parameter in doubt by its margin below: the nearer one as reported must not lie behind the
        // farther one as it is, lest an interval that ends there still holds that. Their planes are
        // `height / |z_growth|` apart.
        if first != Zone::Between && last != Zone::Between && !(self.height > 8.0 * error) {
            return Rough::Doubt;
        }
        let crossing = |zone: Zone, s: f64, root: u32| {
            if zone == Zone::Between {
                return Candidate { t: t0 + s, margin, part: SIDE, root };
            }
            let (height, part) = if zone == Zone::Below { (0.0, BASE) } else { (self.height, TOP) };
            let steepness = 1.0 / z_growth;
            let t = (height - z_far) * steepness;
            // The heights err by less than `error` each, the quotient by 3 u and what `z_growth` does, 4 u |d|.
            Candidate { t, margin: 4.0 * error * steepness.abs(), part, root: 0 }
        };
        Rough::Span([crossing(first, enter, 0), crossing(last, leave, 1)])
    }
}

/// Where a crossing of the side is.
#[derive(Clone, Copy, PartialEq)]
enum Zone {
    Below,
    Between,
    Above,
    Doubt,
}
