//! A ray and a plane, exactly: what the plane, the disk and the triangle share.
//!
//! The plane through `anchor` across `normal` is met at `t = N / D` with `N = normal . (anchor - origin)` and
//! `D = normal . direction`. The normal need not have unit length, so a given one enters as the exact numbers it is.
//! Differences are kept as exact sums of two `f64`; `N` and `D` are sums in double-double, and exact sums where those
//! cancel. Lengths and directions are scaled by powers of two first, so neither 1e-150 nor 1e150 loses a digit.

use crate::double::Double;
use crate::expansion::Expansion;
use crate::kernel::{Product, Task, run};
use crate::math::{exp2i, exponent};
use crate::scaled::{largest, times_power};
use crate::{Aabb, Error, Interval, Ray};
use glam::{DVec2, DVec3};

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
    /// `|dt| <= (10 + 16 G + 4) u W / |n . d|`, and 20 (1 + G) pays for the second order too. The point adds three
    /// roundings of `w` and `t d`: 3 u W (1 + 2 G), less than 10 u W G + 6 u W G^2.
    #[inline(always)]
    pub(super) fn new(anchor: DVec3, n: DVec3, ray: &Ray) -> Rough {
        let (w, d) = (anchor - ray.origin, ray.direction);
        let inverse = 1.0 / (n.x * d.x + n.y * d.y + n.z * d.z);
        let t = (n.x * w.x + n.y * w.y + n.z * w.z) * inverse;
        let reach = w.x.abs() + w.y.abs() + w.z.abs();
        let speed = d.x.abs() + d.y.abs() + d.z.abs();
        let steep = speed * inverse.abs();
        let relative = (20.0 * U) * (1.0 + steep) * reach;
        let slack = relative * inverse.abs();
        // Products that underflow err by 2^-1075, nothing against 2^-53 of these. NaN and infinities fail too.
        let sound = (steep < exp2i(18))
            & (reach > exp2i(-900))
            & (slack < exp2i(900))
            & (slack > exp2i(-1000))
            & (inverse.abs() < exp2i(900));
        Rough { t, w, slack, error: 2.0 * relative * steep, sound }
    }

    /// Whether the interval ends exactly at the parameter: then it was made from that hit, and does not contain it.
    pub(super) fn ends(&self, within: Interval) -> bool {
        self.sound && (self.t == within.min || self.t == within.max)
    }

    /// Whether it is certain on which sides of the ends of the interval the true parameter lies.
    #[inline(always)]
    pub(super) fn decides(&self, within: Interval) -> bool {
        self.sound & ((self.t - within.min).abs() > self.slack) & ((self.t - within.max).abs() > self.slack)
    }
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
pub(super) fn doubles(v: DVec3) -> [Double; 3] {
    [Double::from(v.x), Double::from(v.y), Double::from(v.z)]
}

/// The index of the component of largest size; the first of equals.
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

/// A plane as the refinement needs it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExactPlane {
    /// A point of the plane.
    pub(super) anchor: DVec3,
    /// The normal, of a length near 1, within 2^-104 of each component.
    pub(super) normal: [Double; 3],
    /// `normal . (p - anchor)` for the points of the plane: zero unless the anchor lies beside it.
    pub(super) offset: f64,
}

/// Where a ray meets a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// The parameter, correctly rounded.
    pub(super) t: f64,
    /// The point minus the anchor, in units of `2^power`.
    pub(super) local: [Double; 3],
    /// The unit of `local`.
    pub(super) power: i32,
    /// A bound on the error of each coordinate of `local`, in the same unit.
    pub(super) error: f64,
}

impl Meeting {
    /// The point minus the anchor, each coordinate rounded once.
    pub(super) fn local(&self) -> DVec3 {
        let scale = exp2i(self.power);
        DVec3::from_array(self.local.map(|x| x.to_f64() * scale))
    }

    /// The world point, each coordinate rounded once.
    pub(super) fn point(&self, anchor: DVec3) -> DVec3 {
        let scale = exp2i(self.power);
        let [x, y, z] = self.local.map(|x| x.scale_exact(scale));
        DVec3::new((x + anchor.x).to_f64(), (y + anchor.y).to_f64(), (z + anchor.z).to_f64())
    }

    /// The lengths of `local` along two vectors.
    pub(super) fn along(&self, first: DVec3, second: DVec3) -> DVec2 {
        struct Along([Double; 3], DVec3, DVec3);
        impl Task for Along {
            type Output = DVec2;
            #[inline(always)]
            fn run<P: Product>(self) -> DVec2 {
                let Along([x, y, z], a, b) = self;
                let dot = |v: DVec3| (x.scale::<P>(v.x) + y.scale::<P>(v.y) + z.scale::<P>(v.z)).to_f64();
                DVec2::new(dot(a), dot(b))
            }
        }
        run(Along(self.local, first, second)) * exp2i(self.power)
    }

    /// The error radius of a world point made by [`point`](Meeting::point).
    ///
    /// Each coordinate of the point is within half a unit in the last place, `u |p_i|`, and moving the start of a
    /// ray by the radius rounds once more by as much; `1 + 16 u` pays for the roundings of this sum. The error of
    /// `local` itself comes on top, once for each coordinate.
    pub(super) fn error_radius(&self, point: DVec3) -> f64 {
        let a = point.abs();
        (2.0 * U * (1.0 + 16.0 * U)) * (a.x + a.y + a.z)
            + 3.0 * self.error * exp2i(self.power)
            + f64::from_bits(8)
    }
}

/// The meeting of a valid ray with a plane; `None` when they are parallel. `exact_normal` gives the prescaled normal
/// without any rounding, for the rays that need it.
pub(super) fn meet(
    plane: &ExactPlane,
    ray: &Ray,
    exact_normal: impl Fn() -> [Expansion; 3],
) -> Option<Meeting> {
    run(Meet { plane, ray, exact_normal })
}

struct Meet<'a, F> {
    plane: &'a ExactPlane,
    ray: &'a Ray,
    exact_normal: F,
}

impl<F: Fn() -> [Expansion; 3]> Task for Meet<'_, F> {
    type Output = Option<Meeting>;
    #[inline(always)]
    fn run<P: Product>(self) -> Option<Meeting> {
        let (direction, direction_power) = prescaled(self.ray.direction);
        let (w, power) = exact_difference(self.plane.anchor, self.ray.origin);
        let n = &self.plane.normal;
        let d = direction.to_array();
        let offset = self.plane.offset * exp2i(-power);
        let terms = [n[0].mul::<P>(w[0]), n[1].mul::<P>(w[1]), n[2].mul::<P>(w[2]), Double::from(offset)];
        let parts = [n[0].scale::<P>(d[0]), n[1].scale::<P>(d[1]), n[2].scale::<P>(d[2])];
        let mut numerator = terms[0] + terms[1] + terms[2] + terms[3];
        let mut denominator = parts[0] + parts[1] + parts[2];
        // Each sum errs by less than 2^-101 of the sum of its terms' sizes: products 6 u^2, additions 3 u^2 each, the
        // rounded normal u^2 (u^2 = 2^-106). The quotient is then right to 2^-70 unless a sum cancels to below
        // 2^-30 of its terms: there the terms are added exactly.
        const CANCELLED: f64 = exp2i(-30);
        let size = |terms: &[Double]| terms.iter().fold(0.0, |sum, term| sum + term.high.abs());
        if !(numerator.high.abs() > CANCELLED * size(&terms)
            && denominator.high.abs() > CANCELLED * size(&parts))
        {
            (numerator, denominator) = exact_sums::<P>(&(self.exact_normal)(), &w, offset, d);
        }
        if denominator.high == 0.0 {
            return None;
        }
        let t = numerator.div::<P>(denominator);
        let mut local = [t.scale::<P>(d[0]) - w[0], t.scale::<P>(d[1]) - w[1], t.scale::<P>(d[2]) - w[2]];
        // The components of w are at most 2 in this unit, those of the direction too. The quotient errs by 2^-70 at
        // worst, the product and the difference by 2^-103 of their operands.
        let mut error = exp2i(-99) * (2.0 + 2.0 * t.high.abs());
        let largest = local.iter().fold(0.0_f64, |m, x| if x.high.abs() > m { x.high.abs() } else { m });
        // A place near the anchor met from afar: without the difference of large numbers.
        if self.plane.offset == 0.0 && largest < exp2i(-40) * t.high.abs() {
            local = near_anchor::<P>(n, &w, d, denominator);
            error = exp2i(-99) * largest;
        }
        Some(Meeting { t: times_power(t.to_f64(), power - direction_power), local, power, error })
    }
}

/// `t d - w = n x (d x w) / (n . d)`, with an exact inner product: for places much nearer to the anchor than the
/// origin is. Errs by 2^-100 of itself over the cosine between normal and direction.
#[cold]
#[inline(never)]
fn near_anchor<P: Product>(
    n: &[Double; 3],
    w: &[Double; 3],
    d: [f64; 3],
    denominator: Double,
) -> [Double; 3] {
    let m = cross::<P>(&d.map(Double::from), w).map(|m| m.rounded());
    [(1, 2), (2, 0), (0, 1)].map(|(j, k)| (n[j].mul::<P>(m[k]) - n[k].mul::<P>(m[j])).div::<P>(denominator))
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

/// `a - b` as exact sums of two `f64`, in units of the returned power of two, in which the largest is in `[1, 2)`.
#[inline(always)]
pub(super) fn exact_difference(a: DVec3, b: DVec3) -> ([Double; 3], i32) {
    let w = [Double::difference(a.x, b.x), Double::difference(a.y, b.y), Double::difference(a.z, b.z)];
    let power = power_of(DVec3::new(w[0].high, w[1].high, w[2].high));
    let scale = exp2i(-power);
    (w.map(|x| x.scale_exact(scale)), power)
}

#[cold]
#[inline(never)]
fn exact_sums<P: Product>(
    normal: &[Expansion; 3],
    w: &[Double; 3],
    offset: f64,
    d: [f64; 3],
) -> (Double, Double) {
    let (mut numerator, mut denominator) = (Expansion::ZERO, Expansion::ZERO);
    numerator.add(offset);
    for i in 0..3 {
        numerator.add_expansion_product::<P>(&normal[i], w[i]);
        denominator.add_expansion_product::<P>(&normal[i], Double::from(d[i]));
    }
    (numerator.rounded(), denominator.rounded())
}

/// A vector of `f64` as exact expansions.
pub(super) fn expansions(v: DVec3) -> [Expansion; 3] {
    v.to_array().map(|x| {
        let mut e = Expansion::ZERO;
        e.add(x);
        e
    })
}

/// Makes the coordinate across a plane exactly zero when its normal lies along a world axis.
pub(super) fn settle(at: &mut Meeting, normal: DVec3) {
    let k = dominant(normal);
    let n = normal.to_array();
    if (0..3).all(|i| i == k || n[i] == 0.0) {
        at.local[k] = Double::ZERO;
    }
}

/// The box from `anchor + least` to `anchor + greatest`, each end rounded away from the box.
pub(super) fn outward(anchor: DVec3, least: DVec3, greatest: DVec3) -> Aabb {
    // One rounding of the sum and one of the point that is tested against the box.
    let down = |x: f64| x.next_down().next_down();
    let up = |x: f64| x.next_up().next_up();
    let (a, b) = (anchor + least, anchor + greatest);
    Aabb { min: DVec3::new(down(a.x), down(a.y), down(a.z)), max: DVec3::new(up(b.x), up(b.y), up(b.z)) }
}
