//! Vectors of double-double numbers.

use crate::double::{Double, two_difference, two_sum};
use crate::kernel::{Four, Lanes, Product, Real, Twice, Vector};
use core::ops::{Add, Sub};
use glam::DVec3;

/// Three double-double coordinates: about 106 bits each; or three such in each lane of [`Four`](crate::kernel::Four).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DoubleVector<R = f64> {
    pub x: Double<R>,
    pub y: Double<R>,
    pub z: Double<R>,
}

/// The square as a product and what is left of it, but for the square of the low part.
#[inline(always)]
fn squared<P: Product, R: Real>(a: Double<R>) -> (R, R) {
    let (p, e) = R::two_product::<P>(a.high, a.high);
    (p, e + e.all(2.0) * (a.high * a.low))
}

/// [`DoubleVector::advanced`] along one axis.
#[inline(always)]
fn advanced<P: Product, R: Real>(x: Double<R>, d: R, t: Double<R>) -> Double<R> {
    let (p, e) = R::two_product::<P>(d, t.high);
    let (s, f) = two_sum(x.high, p);
    Double::sum(s, f + (x.low + (e + d * t.low)))
}

/// A term of [`DoubleVector::inner`].
#[inline(always)]
fn term<P: Product, R: Real>(a: Double<R>, b: Double<R>) -> (R, R) {
    let (p, e) = R::two_product::<P>(a.high, b.high);
    (p, e + (a.high * b.low + a.low * b.high))
}

/// [`DoubleVector::less`] along one axis.
#[inline(always)]
fn less<P: Product, R: Real>(a: Double<R>, b: Double<R>, s: Double<R>) -> Double<R> {
    let (p, e) = R::two_product::<P>(b.high, s.high);
    let (d, f) = two_difference(a.high, p);
    Double::sum(d, (f - e) + (a.low - (b.high * s.low + b.low * s.high)))
}

/// [`DoubleVector::blend`] along one axis.
#[inline(always)]
fn blend<P: Product, R: Real>(a: Double<R>, s: Double<R>, b: Double<R>, t: Double<R>) -> R {
    let (p, e) = R::two_product::<P>(a.high, s.high);
    let (q, f) = R::two_product::<P>(b.high, t.high);
    let (sum, g) = two_sum(p, q);
    sum + (((e + f) + g) + ((a.high * s.low + a.low * s.high) + (b.high * t.low + b.low * t.high)))
}

impl<R: Real> DoubleVector<R> {
    /// The same vector in all lanes, of as many as `like` has.
    #[inline(always)]
    pub fn all(like: R, v: &DoubleVector) -> Self {
        DoubleVector { x: Double::all(like, v.x), y: Double::all(like, v.y), z: Double::all(like, v.z) }
    }

    /// The exact difference of two points.
    #[inline(always)]
    pub fn difference(a: impl Into<Vector<R>>, b: impl Into<Vector<R>>) -> Self {
        let (a, b) = (a.into(), b.into());
        DoubleVector {
            x: Double::difference(a.x, b.x),
            y: Double::difference(a.y, b.y),
            z: Double::difference(a.z, b.z),
        }
    }

    /// `self + t * d`, within a few 2^-106 of the largest of the terms.
    #[inline(always)]
    pub fn advanced<P: Product>(&self, d: impl Into<Vector<R>>, t: Double<R>) -> Self {
        let d = d.into();
        DoubleVector {
            x: advanced::<P, R>(self.x, d.x, t),
            y: advanced::<P, R>(self.y, d.y, t),
            z: advanced::<P, R>(self.z, d.z, t),
        }
    }

    /// `self + t * d` for a step far smaller than `self`.
    #[inline(always)]
    pub fn nudged(self, d: impl Into<Vector<R>>, t: R) -> Self {
        let d = d.into();
        DoubleVector {
            x: Double::sum(self.x.high, self.x.low + d.x * t),
            y: Double::sum(self.y.high, self.y.low + d.y * t),
            z: Double::sum(self.z.high, self.z.low + d.z * t),
        }
    }

    /// The scalar product, and less work than [`dot`](Self::dot): the high parts without error, their errors and the low
    /// parts added up in `f64` (Ogita, Rump, Oishi 2005, doi:10.1137/030601818). Errs by less than 2^-99 of the sizes of
    /// the terms together: eight additions of parts that are below 8 u of those, and the products of low parts.
    #[inline(always)]
    pub fn inner<P: Product>(&self, b: &Self) -> Double<R> {
        let (x, x_low) = term::<P, R>(self.x, b.x);
        let (y, y_low) = term::<P, R>(self.y, b.y);
        let (z, z_low) = term::<P, R>(self.z, b.z);
        let (s, e) = two_sum(x, y);
        let (s, f) = two_sum(s, z);
        Double::sum(s, ((x_low + y_low) + z_low) + (e + f))
    }

    /// `self - b s`: each coordinate within 2^-103 of the larger of the two terms, besides the errors of what is given.
    #[inline(always)]
    pub fn less<P: Product>(&self, b: &Self, s: Double<R>) -> Self {
        DoubleVector {
            x: less::<P, R>(self.x, b.x, s),
            y: less::<P, R>(self.y, b.y, s),
            z: less::<P, R>(self.z, b.z, s),
        }
    }

    /// `self s + b t`, each coordinate rounded once, all but.
    #[inline(always)]
    pub fn blend<P: Product>(&self, s: Double<R>, b: &Self, t: Double<R>) -> Vector<R> {
        Vector {
            x: blend::<P, R>(self.x, s, b.x, t),
            y: blend::<P, R>(self.y, s, b.y, t),
            z: blend::<P, R>(self.z, s, b.z, t),
        }
    }

    /// `|self|^2 - r^2`: within 2^-100 of `|self|^2 + r^2`.
    #[inline(always)]
    pub fn excess_over<P: Product>(&self, r: Double<R>) -> R {
        let (x, x_low) = squared::<P, R>(self.x);
        let (y, y_low) = squared::<P, R>(self.y);
        let (z, z_low) = squared::<P, R>(self.z);
        let (r, r_low) = squared::<P, R>(r);
        let (s, s_low) = two_sum(x, y);
        let (u, u_low) = two_difference(z, r);
        let (v, v_low) = two_sum(s, u);
        v + (v_low + ((s_low + u_low) + ((x_low + y_low) + (z_low - r_low))))
    }

    /// `|self|^2 - r^2` for a place near the sphere: within 2^-102 of `r^2`, or a unit in the last place.
    #[inline(always)]
    pub fn excess<P: Product>(self, r: R) -> R {
        let (xx, x_low) = R::two_product::<P>(self.x.high, self.x.high);
        let (yy, y_low) = R::two_product::<P>(self.y.high, self.y.high);
        let (zz, z_low) = R::two_product::<P>(self.z.high, self.z.high);
        let (rr, r_low) = R::two_product::<P>(r, r);
        let (s, s_low) = two_sum(xx, yy);
        let (u, u_low) = two_difference(zz, rr);
        let (v, v_low) = two_sum(s, u);
        let cross = self.x.high * self.x.low + self.y.high * self.y.low + self.z.high * self.z.low;
        v + (v_low + ((s_low + u_low) + ((x_low + y_low) + (z_low - r_low)) + cross.all(2.0) * cross))
    }

    /// The product with a power of two: exact.
    #[inline(always)]
    pub fn scale_exact(self, power: R) -> Self {
        DoubleVector {
            x: self.x.scale_exact(power),
            y: self.y.scale_exact(power),
            z: self.z.scale_exact(power),
        }
    }

    /// The length: right to 2^-101 of itself.
    #[inline(always)]
    pub fn length<P: Product>(&self) -> Double<R> {
        let ((x, x_low), (y, y_low), (z, z_low)) =
            (squared::<P, R>(self.x), squared::<P, R>(self.y), squared::<P, R>(self.z));
        let (s, s_low) = two_sum(x, y);
        let (s, z_s) = two_sum(s, z);
        let low = (s_low + z_s) + ((x_low + y_low) + z_low);
        let root = s.sqrt();
        Double::sum(root, (R::remainder::<P>(s, root, root) + low) * (s.all(0.5) / root))
    }

    /// The leading parts.
    #[inline(always)]
    pub fn leading(self) -> Vector<R> {
        Vector { x: self.x.high, y: self.y.high, z: self.z.high }
    }

    /// `self + v`, rounded once: within half a unit in the last place and a little.
    #[inline(always)]
    pub fn plus(self, v: impl Into<Vector<R>>) -> Vector<R> {
        let v = v.into();
        Vector { x: (self.x + v.x).high, y: (self.y + v.y).high, z: (self.z + v.z).high }
    }
}

impl<L: Lanes> DoubleVector<Four<L>> {
    /// One vector in each lane.
    #[inline(always)]
    pub fn new(lanes: L, [a, b, c, d]: [&DoubleVector; 4]) -> Self {
        DoubleVector {
            x: Double {
                high: Four::new(lanes, [a.x.high, b.x.high, c.x.high, d.x.high]),
                low: Four::new(lanes, [a.x.low, b.x.low, c.x.low, d.x.low]),
            },
            y: Double {
                high: Four::new(lanes, [a.y.high, b.y.high, c.y.high, d.y.high]),
                low: Four::new(lanes, [a.y.low, b.y.low, c.y.low, d.y.low]),
            },
            z: Double {
                high: Four::new(lanes, [a.z.high, b.z.high, c.z.high, d.z.high]),
                low: Four::new(lanes, [a.z.low, b.z.low, c.z.low, d.z.low]),
            },
        }
    }
}

impl<R> DoubleVector<Twice<R>> {
    /// The vectors of both.
    #[inline(always)]
    pub fn both(a: DoubleVector<R>, b: DoubleVector<R>) -> Self {
        DoubleVector { x: Double::both(a.x, b.x), y: Double::both(a.y, b.y), z: Double::both(a.z, b.z) }
    }
}

impl DoubleVector {
    /// The exact value of a vector.
    #[inline(always)]
    pub fn from(v: DVec3) -> Self {
        DoubleVector { x: Double::from(v.x), y: Double::from(v.y), z: Double::from(v.z) }
    }

    /// `v * s`, exactly.
    #[inline(always)]
    pub fn product<P: Product>(v: DVec3, s: f64) -> Self {
        DoubleVector {
            x: Double::product::<P>(v.x, s),
            y: Double::product::<P>(v.y, s),
            z: Double::product::<P>(v.z, s),
        }
    }

    /// The product with a number.
    #[inline(always)]
    pub fn mul<P: Product>(self, s: Double) -> Self {
        DoubleVector { x: self.x.mul::<P>(s), y: self.y.mul::<P>(s), z: self.z.mul::<P>(s) }
    }

    /// The scalar product.
    #[inline(always)]
    pub fn dot<P: Product>(self, b: DoubleVector) -> Double {
        self.x.mul::<P>(b.x) + self.y.mul::<P>(b.y) + self.z.mul::<P>(b.z)
    }

    /// The scalar product with a vector of `f64`.
    #[inline(always)]
    pub fn dot_f64<P: Product>(self, b: DVec3) -> Double {
        self.x.scale::<P>(b.x) + self.y.scale::<P>(b.y) + self.z.scale::<P>(b.z)
    }

    /// The square of the length.
    #[inline(always)]
    pub fn length_squared<P: Product>(self) -> Double {
        self.x.square::<P>() + self.y.square::<P>() + self.z.square::<P>()
    }

    /// The leading parts: the nearest `f64` of each coordinate.
    #[inline(always)]
    pub fn high(self) -> DVec3 {
        DVec3::new(self.x.high, self.y.high, self.z.high)
    }

    /// `self + v`, rounded once: within half a unit in the last place and a little.
    #[inline(always)]
    pub fn plus_f64(self, v: DVec3) -> DVec3 {
        self.plus(v).into()
    }
}

impl<R: Real> Add for DoubleVector<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        DoubleVector { x: self.x + b.x, y: self.y + b.y, z: self.z + b.z }
    }
}

impl<R: Real> Sub for DoubleVector<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        DoubleVector { x: self.x - b.x, y: self.y - b.y, z: self.z - b.z }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expansion::Expansion;
    use crate::kernel::{Dekker, Task, run};
    use crate::math::exp2i;
    use crate::testing::Random;

    /// Numbers of all 106 bits, of both signs and sizes from 1/1000 to 1000.
    fn double(random: &mut Random) -> Double {
        let high = random.sign() * random.magnitude(-3.0, 3.0);
        Double::sum(high, high * exp2i(-54) * random.uniform(-1.0, 1.0))
    }

    fn vector(random: &mut Random) -> DoubleVector {
        DoubleVector { x: double(random), y: double(random), z: double(random) }
    }

    fn coordinates(v: &DoubleVector) -> [Double; 3] {
        [v.x, v.y, v.z]
    }

    /// How far a number is from the exact sum of products, and the sum of the sizes of these.
    fn error(found: Double, products: &[(Double, Double)]) -> (f64, f64) {
        let mut exact = Expansion::ZERO;
        let mut size = 0.0;
        for &(a, b) in products {
            exact.add_double_product::<Dekker>(a, b);
            size += (a.high * b.high).abs();
        }
        exact.add(-found.high);
        exact.add(-found.low);
        (exact.rounded().high.abs(), size)
    }

    struct Bounds(Random);

    impl Task for &mut Bounds {
        type Output = ();
        fn run<P: Product>(self) {
            let random = &mut self.0;
            for case in 0..4000 {
                let (mut a, b) = (vector(random), vector(random));
                let (mut s, t) = (double(random), double(random));
                if case % 2 == 1 {
                    // The terms all but cancel.
                    s = a.x.div::<P>(b.x);
                    a.z = -(a.x.mul::<P>(b.x) + a.y.mul::<P>(b.y)).div::<P>(b.z);
                    a.z.low += a.z.high * random.uniform(-1.0, 1.0) * exp2i(-53 - (case / 2) % 50);
                    a.z = Double::sum(a.z.high, a.z.low);
                }
                let terms = [(a.x, b.x), (a.y, b.y), (a.z, b.z)];
                let (off, size) = error(a.inner::<P>(&b), &terms);
                assert!(off <= exp2i(-99) * size, "inner {a:?} {b:?}");
                let (off, size) = error(a.dot::<P>(b), &terms);
                assert!(off <= exp2i(-101) * size, "dot {a:?} {b:?}");

                let less = coordinates(&a.less::<P>(&b, s));
                let blend = DVec3::from(a.blend::<P>(s, &b, t)).to_array();
                let (d, step) = (b.high(), exp2i(-30) * t.high);
                let advanced = coordinates(&a.advanced::<P>(d, s));
                let nudged = coordinates(&a.nudged(d, step));
                let moved = a.plus_f64(d).to_array();
                for (k, (a, b)) in coordinates(&a).into_iter().zip(coordinates(&b)).enumerate() {
                    let (off, size) = error(less[k], &[(a, Double::ONE), (-b, s)]);
                    assert!(off <= exp2i(-103) * size, "{a:?} less {b:?} {s:?}");
                    let (off, size) = error(Double::from(blend[k]), &[(a, s), (b, t)]);
                    assert!(off <= exp2i(-53) * blend[k].abs() + exp2i(-101) * size, "blend {a:?} {b:?}");
                    let (d, one) = (Double::from(d.to_array()[k]), Double::ONE);
                    let (off, size) = error(advanced[k], &[(a, one), (d, s)]);
                    assert!(off <= exp2i(-103) * size, "{a:?} advanced {d:?} {s:?}");
                    let (off, size) = error(nudged[k], &[(a, one), (d, Double::from(step))]);
                    assert!(
                        off <= exp2i(-105) * size + exp2i(-52) * (d.high * step).abs(),
                        "{a:?} nudged {d:?} {step}"
                    );
                    let (off, size) = error(Double::from(moved[k]), &[(a, one), (d, one)]);
                    assert!(off <= exp2i(-53) * moved[k].abs() + exp2i(-104) * size, "{a:?} plus {d:?}");
                }

                let length = a.length::<P>();
                let squares = [(a.x, a.x), (a.y, a.y), (a.z, a.z)];
                let [x, y, z] = squares;
                let (off, _) = error(Double::ZERO, &[x, y, z, (-length, length)]);
                assert!(off <= exp2i(-100) * length.high * length.high, "length of {a:?}");
                let (off, size) = error(a.length_squared::<P>(), &squares);
                assert!(off <= exp2i(-102) * size, "square of {a:?}");
                // Near the surface of a ball, nearer with each case, and anywhere.
                let r = if case % 3 == 0 { t } else { length };
                let r = Double::sum(r.high, r.low + r.high * random.uniform(-1.0, 1.0) * exp2i(-(case % 64)));
                let excess = a.excess_over::<P>(r);
                let (off, size) = error(Double::from(excess), &[x, y, z, (-r, r)]);
                assert!(off <= exp2i(-53) * excess.abs() + exp2i(-100) * size, "excess of {a:?} over {r:?}");
                let excess = a.excess::<P>(r.high);
                let (off, size) =
                    error(Double::from(excess), &[x, y, z, (Double::from(-r.high), Double::from(r.high))]);
                assert!(
                    off <= exp2i(-52) * excess.abs() + exp2i(-101) * size,
                    "excess of {a:?} over {}",
                    r.high
                );
            }
        }
    }

    /// What the operations promise, against exact sums.
    #[test]
    fn as_right_as_promised() {
        run(&mut Bounds(Random::new(1)));
        (&mut Bounds(Random::new(2))).run::<Dekker>();
    }
}
