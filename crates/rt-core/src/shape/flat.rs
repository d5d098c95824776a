//! What the flat shapes share: the parameter of a plane in plain `f64` with a bound on its error, and normals, axes and
//! bounds.

use crate::double::Double;
use crate::expansion::Expansion;
use crate::kernel::{Product, Task, run};
use crate::math::{exp2i, exponent};
use crate::scaled::{largest, times_power};
use crate::{Aabb, Error, Hit, Interval, Ray};
use glam::DVec3;

/// The unit roundoff of `f64`, 2^-53.
pub(super) const U: f64 = exp2i(-53);

/// An error bound below this may be swamped by underflow: products that underflow err by 2^-1075 each, and no bound here
/// covers more than a hundred of them.
pub(super) const LEAST_CERTAIN: f64 = exp2i(-1022) * exp2i(-38);

/// The parameter at which a ray meets a plane, in plain `f64`, and how far to trust it.
pub(super) struct Rough {
    /// The parameter.
    pub(super) t: f64,
    /// The origin seen from the anchor is `-w`.
    pub(super) w: DVec3,
    /// A bound on the error of `t`.
    pub(super) slack: f64,
    /// A bound on the error of each coordinate of `t d - w`, and on the sum of the errors of all three.
    pub(super) error: f64,
    /// Whether the bounds hold: not for rays closer to the plane than about 2^-18, nor where numbers may have
    /// under- or overflowed.
    pub(super) sound: bool,
}

impl Rough {
    /// For the plane through `anchor` across `n`, whose components are below 2, each within u.
    ///
    /// With W and V the sums of the sizes of the coordinates of w and d, the numerator `n . w` errs by at most 10 u W
    /// (normal, difference, product, two additions, times 2), the denominator by 8 u V, the quotient and the product
    /// by 2 u of themselves. With `G = V / |n . d|`, at least 1/2, and |t| <= 2 W / |n . d| that makes
    /// `|dt| <= (10 + 16 G + 4) u W / |n . d|`, which is at most 44 u G W / |n . d|, and 45 pays for the second order
    /// too. The point adds three roundings of `w` and `t d`: 3 u W (1 + 2 G), at most 12 u W G and thus 24 u W G^2.
    #[inline(always)]
    pub(super) fn new(anchor: DVec3, n: DVec3, ray: &Ray) -> Rough {
        let (w, d) = (anchor - ray.origin, ray.direction);
        let inverse = 1.0 / (n.x * d.x + n.y * d.y + n.z * d.z);
        let t = (n.x * w.x + n.y * w.y + n.z * w.z) * inverse;
        let reach = w.x.abs() + w.y.abs() + w.z.abs();
        let speed = d.x.abs() + d.y.abs() + d.z.abs();
        let steep = speed * inverse;
        let relative = (45.0 * U) * reach * steep;
        let slack = relative * inverse;
        // These and the next range bound all other numbers: products that underflow err by 2^-1075, nothing against
        // 2^-53 of these. NaN and infinities fail too.
        let sound = (steep.abs() < exp2i(18)) & ordinary(reach) & ordinary(speed);
        Rough { t, w, slack, error: 2.0 * relative * steep, sound }
    }

    /// Whether the interval ends exactly at the parameter: then it was made from that hit, and does not contain it.
    pub(super) fn ends(&self, within: Interval) -> bool {
        self.sound && (self.t == within.min || self.t == within.max)
    }

    /// Whether the true parameter is certainly in the interval, and whether it certainly is not.
    #[inline(always)]
    pub(super) fn sides(&self, within: Interval) -> (bool, bool) {
        let Rough { t, slack, sound, .. } = *self;
        let inside = sound & (t - within.min > slack) & (within.max - t > slack);
        let beside = sound & ((within.min - t > slack) | (t - within.max > slack));
        (inside, beside)
    }

    /// The hit of a ray that certainly meets the shape.
    #[inline(always)]
    pub(super) fn hit(self, within: Interval) -> Verdict {
        let (inside, beside) = self.sides(within);
        if inside {
            Ok(Some(Hit::inside(self.t, 0, 0)))
        } else if beside {
            Ok(None)
        } else {
            Err(Doubt { ended: self.ends(within) })
        }
    }
}

/// The hit or none, where plain `f64` can tell.
pub(super) type Verdict = Result<Option<Hit>, Doubt>;

/// Plain `f64` cannot tell.
pub(super) struct Doubt {
    /// The place is certain, and the interval ends at the parameter that `f64` gives: it was made from that hit, and
    /// does not contain it.
    pub(super) ended: bool,
}

/// A ray seen from an anchor, in units of powers of two.
pub(super) struct Relative {
    /// The origin minus the anchor, rounded once, and the direction; the largest of its components, or the size that
    /// was asked for, is in `[1, 2)`.
    pub(super) ray: Ray,
    /// A length here times this is one there.
    pub(super) unit: f64,
    /// A parameter there is `2^power` times the one here.
    power: i32,
}

impl Relative {
    /// For a shape of this size, or of none.
    pub(super) fn new(anchor: DVec3, ray: &Ray, size: f64) -> Relative {
        let w = ray.origin - anchor;
        let reach = largest(w);
        let length = power_of(DVec3::splat(if reach > size { reach } else { size }));
        let (direction, speed) = prescaled(ray.direction);
        let unit = exp2i(-length);
        Relative { ray: Ray::new(w * unit, direction), unit, power: length - speed }
    }

    /// An interval of the given ray.
    pub(super) fn interval(&self, within: Interval) -> Interval {
        Interval::new(times_power(within.min, -self.power), times_power(within.max, -self.power))
    }

    /// A hit of the given ray.
    pub(super) fn hit(&self, hit: Hit, within: Interval) -> Option<Hit> {
        within.admit(times_power(hit.t(), self.power), hit.part(), hit.root())
    }
}

/// Whether a number that is not negative lies between 2^-480 and 2^480, by its bits: not for NaN.
#[inline(always)]
fn ordinary(x: f64) -> bool {
    const LEAST: u64 = exp2i(-480).to_bits();
    x.to_bits().wrapping_sub(LEAST) < exp2i(480).to_bits() - LEAST
}

/// The vector itself when it is finite and has a length.
pub(super) fn checked_direction(what: &'static str, value: DVec3) -> Result<DVec3, Error> {
    if !value.is_finite() {
        return Err(Error::NotFinite { what, value });
    }
    if value == DVec3::ZERO { Err(Error::ZeroLength { what, value }) } else { Ok(value) }
}

/// The vector times `2^-power`, with the largest component in `[1, 2)`, and that power; zero stays as it is.
#[inline(always)]
pub(super) fn prescaled(v: DVec3) -> (DVec3, i32) {
    let power = power_of(v);
    (v * exp2i(-power), power)
}

/// The power of two that [`prescaled`] divides by.
#[inline(always)]
pub(super) fn power_of(v: DVec3) -> i32 {
    let largest = largest(v);
    if largest == 0.0 { 0 } else { exponent(largest).clamp(-1022, 1022) }
}

/// The unit vector along a prescaled one, each component correctly rounded but for a few in 2^40.
pub(super) fn unit(v: [Double; 3]) -> DVec3 {
    struct Unit([Double; 3]);
    impl Task for Unit {
        type Output = DVec3;
        #[inline(always)]
        fn run<P: Product>(self) -> DVec3 {
            let [x, y, z] = self.0;
            let length = (x.square::<P>() + y.square::<P>() + z.square::<P>()).sqrt::<P>();
            DVec3::new(x.div::<P>(length).to_f64(), y.div::<P>(length).to_f64(), z.div::<P>(length).to_f64())
        }
    }
    run(Unit(v))
}

/// A vector of exact `f64`.
#[inline(always)]
pub(super) fn doubles(v: DVec3) -> [Double; 3] {
    [Double::from(v.x), Double::from(v.y), Double::from(v.z)]
}

/// The index of the component of largest size; the first of equals.
#[inline(always)]
pub(super) fn dominant(v: DVec3) -> usize {
    let a = v.abs();
    if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    }
}

/// Two unit vectors in the plane across a prescaled normal: the two world axes in which the normal is not largest, in
/// the order x, y, z; the first projected onto the plane, the second the perpendicular on the side of its world axis.
pub(super) fn plane_axes(normal: DVec3) -> (DVec3, DVec3) {
    let k = dominant(normal);
    let (i, j) = [(1, 2), (0, 2), (0, 1)][k];
    let n = normal.to_array();
    // The vector (0 along j, n_k along i, -n_i along k) would be perpendicular too, but it is not the projection.
    // Projection of the axis i, times |n|^2: e_i |n|^2 - n_i n.
    let square = normal.length_squared();
    let mut first = [0.0; 3];
    first[i] = square - n[i] * n[i];
    first[j] = -n[i] * n[j];
    first[k] = -n[i] * n[k];
    let first = unit(doubles(DVec3::from_array(first)));
    // The side: the component along j of n x first has the sign of the volume (n, first, e_j).
    let across = normal.cross(first);
    let across = if across.to_array()[j] < 0.0 { -across } else { across };
    (first, unit(doubles(across)))
}

/// The exact cross product.
#[inline(always)]
pub(super) fn cross<P: Product>(a: &[Double; 3], b: &[Double; 3]) -> [Expansion; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(j, k)| {
        let mut sum = Expansion::ZERO;
        sum.add_double_product::<P>(a[j], b[k]);
        sum.add_double_product::<P>(-a[k], b[j]);
        sum
    })
}

/// A vector of `f64` as exact expansions.
pub(super) fn expansions(v: DVec3) -> [Expansion; 3] {
    v.to_array().map(|x| {
        let mut e = Expansion::ZERO;
        e.add(x);
        e
    })
}

/// The world axis that a vector lies along exactly.
pub(super) fn world_axis(v: DVec3) -> Option<u8> {
    let k = dominant(v);
    let v = v.to_array();
    (0..3).all(|i| i == k || v[i] == 0.0).then_some(k as u8)
}

/// The vector with each coordinate moved into its range. Unlike glam's `clamp` it compiles to plain minima and maxima.
#[inline(always)]
pub(super) fn clamped(v: DVec3, least: DVec3, most: DVec3) -> DVec3 {
    let clamp = |x: f64, least: f64, most: f64| {
        let x = if x < least { least } else { x };
        if x > most { most } else { x }
    };
    DVec3::new(clamp(v.x, least.x, most.x), clamp(v.y, least.y, most.y), clamp(v.z, least.z, most.z))
}

/// The box from `anchor + least` to `anchor + greatest`, each end rounded away from the box.
pub(super) fn outward(anchor: DVec3, least: DVec3, greatest: DVec3) -> Aabb {
    // One rounding of the sum and one of the point that is tested against the box.
    let down = |x: f64| x.next_down().next_down();
    let up = |x: f64| x.next_up().next_up();
    let (a, b) = (anchor + least, anchor + greatest);
    Aabb { min: DVec3::new(down(a.x), down(a.y), down(a.z)), max: DVec3::new(up(b.x), up(b.y), up(b.z)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn sides_of_an_interval() {
        let at = |t: f64, slack: f64, sound: bool| Rough { t, w: DVec3::ZERO, slack, error: 0.0, sound };
        let rough = at(1.0, 0.25, true);
        for (min, max, expected) in [
            (0.0, 2.0, (true, false)),
            (-5.0, 0.5, (false, true)),
            (1.5, 9.0, (false, true)),
            (0.875, 2.0, (false, false)),
            (0.0, 1.125, (false, false)),
            (1.125, 2.0, (false, false)),
            (0.0, 0.875, (false, false)),
            // An end just as far away as the parameter may err.
            (0.75, 9.0, (false, false)),
            (0.0, 1.25, (false, false)),
            (1.25, 9.0, (false, false)),
            (0.0, 0.75, (false, false)),
        ] {
            assert_eq!(rough.sides(Interval::new(min, max)), expected, "{min} {max}");
            assert_eq!(at(1.0, 0.25, false).sides(Interval::new(min, max)), (false, false));
        }
    }

    /// The bounds hold, and are not larger than the roundings can be by more than two hundred times.
    #[test]
    fn a_parameter_is_known_within_its_slack() {
        let mut random = Random::new(1);
        for _ in 0..4000 {
            let (anchor, n) = (random.in_cube(), random.direction());
            let ray = Ray::new(random.in_cube() * 4.0, random.direction());
            let rough = Rough::new(anchor, n, &ray);
            let dot = |a: [Double; 3], b: [Double; 3]| {
                a.into_iter().zip(b).fold(Double::ZERO, |sum, (a, b)| sum + a.mul::<crate::kernel::Dekker>(b))
            };
            let w = [0, 1, 2].map(|k| Double::difference(anchor[k], ray.origin[k]));
            let slope = dot(doubles(n), doubles(ray.direction));
            let t = dot(doubles(n), w).div::<crate::kernel::Dekker>(slope);
            assert!((t - rough.t).high.abs() <= rough.slack, "{anchor} {n} {ray:?}");
            // u |w| over the cosine, once more for the slope.
            let least = U * (anchor - ray.origin).length() / (slope.high * slope.high);
            assert!(rough.slack <= 200.0 * least, "{anchor} {n} {ray:?} {}", rough.slack / least);
            for (k, &w) in w.iter().enumerate() {
                let exact = t.mul::<crate::kernel::Dekker>(Double::from(ray.direction[k])) - w;
                let local = ray.direction[k] * rough.t - rough.w[k];
                assert!((exact - local).high.abs() <= rough.error, "{anchor} {n} {ray:?}");
            }
        }
    }

    /// The axes of a plane are unit vectors in it and across each other: the first is the projection of its world axis, the
    /// second on the side of its own.
    #[test]
    fn axes_in_the_plane() {
        let mut random = Random::new(5);
        for _ in 0..1000 {
            let n = random.direction();
            let (first, second) = plane_axes(n);
            let k = dominant(n);
            let (i, j) = [(1, 2), (0, 2), (0, 1)][k];
            let projected = (DVec3::AXES[i] - n * n[i]).normalize();
            assert!((first - projected).length() < 1e-15, "{n} {first}");
            assert!(second.dot(n).abs() < 1e-15 && second.dot(first).abs() < 1e-15, "{n} {second}");
            assert!((second.length() - 1.0).abs() < 1e-15 && second[j] > 0.0, "{n} {second}");
        }
    }
}
