//! Arithmetic that is written once, for one number and for four at a time.
//!
//! What computes with lanes is a function with `#[inline(always)]`, never a closure of more than an operation or two: a closure
//! that is not inlined is not compiled for the instruction set, and each operation in it is a call.

use super::{Lanes, Product};
use core::ops::{Add, Div, Mul, Neg, Sub};
use glam::DVec3;

/// A number, or one in each of four lanes. Each lane rounds as a number by itself does, so the bits are the same.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// What [`less`](Real::less) says where it is so in every lane.
    const EVERY: u32;
    /// The same number in all lanes, of as many as `self` has.
    fn all(self, x: f64) -> Self;
    /// The square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// The absolute value.
    fn abs(self) -> Self;
    /// The lanes in which `self < other`, one bit each, lane 0 the lowest.
    fn less(self, other: Self) -> u32;
    /// The lanes in which `self <= other`.
    fn at_most(self, other: Self) -> u32;
    /// The number whose bits, as a whole number, are a third of those of this one, and `more`.
    fn third_of_bits(self, more: u64) -> Self;
    /// One in the lanes of a mask, zero in the others.
    fn ones(self, mask: u32) -> Self;
    /// `if a < b { then } else { otherwise }`.
    fn if_less(a: Self, b: Self, then: Self, otherwise: Self) -> Self;
    /// `if a <= b { then } else { otherwise }`.
    fn if_at_most(a: Self, b: Self, then: Self, otherwise: Self) -> Self;
    /// [`Product::two_product`]; lanes bring a product of their own.
    fn two_product<P: Product>(a: Self, b: Self) -> (Self, Self);
    /// [`Product::remainder`], alike.
    fn remainder<P: Product>(c: Self, a: Self, b: Self) -> Self;
}

impl Real for f64 {
    const EVERY: u32 = 1;
    #[inline(always)]
    fn all(self, x: f64) -> f64 {
        x
    }
    #[inline(always)]
    fn sqrt(self) -> f64 {
        crate::math::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    #[inline(always)]
    fn less(self, other: f64) -> u32 {
        u32::from(self < other)
    }
    #[inline(always)]
    fn at_most(self, other: f64) -> u32 {
        u32::from(self <= other)
    }
    #[inline(always)]
    fn third_of_bits(self, more: u64) -> f64 {
        f64::from_bits(self.to_bits() / 3 + more)
    }
    #[inline(always)]
    fn ones(self, mask: u32) -> f64 {
        f64::from(mask & 1)
    }
    #[inline(always)]
    fn if_less(a: f64, b: f64, then: f64, otherwise: f64) -> f64 {
        if a < b { then } else { otherwise }
    }
    #[inline(always)]
    fn if_at_most(a: f64, b: f64, then: f64, otherwise: f64) -> f64 {
        if a <= b { then } else { otherwise }
    }
    #[inline(always)]
    fn two_product<P: Product>(a: f64, b: f64) -> (f64, f64) {
        P::two_product(a, b)
    }
    #[inline(always)]
    fn remainder<P: Product>(c: f64, a: f64, b: f64) -> f64 {
        P::remainder(c, a, b)
    }
}

/// Four numbers.
#[derive(Clone, Copy, Debug)]
pub struct Four<L: Lanes>(L, L::D);

impl<L: Lanes> Four<L> {
    /// The lanes of an array.
    #[inline(always)]
    pub fn new(lanes: L, numbers: [f64; 4]) -> Self {
        Four(lanes, lanes.load4(numbers))
    }

    /// The lanes as an array.
    #[inline(always)]
    pub fn to_array(self) -> [f64; 4] {
        self.0.store4(self.1)
    }

    /// The lanes of the mask first, in their order; any of the others behind them.
    #[inline(always)]
    pub fn packed(self, mask: u32) -> Self {
        Four(self.0, self.0.pack4(self.1, mask))
    }

    /// The lanes without their fractions; any numbers for those that are NaN or not in `0..2^31`.
    #[inline(always)]
    pub fn whole(self) -> [u32; 4] {
        self.0.whole4(self.1)
    }

    /// The power of two with the exponent of each lane, which is positive: 0 for subnormal numbers, infinite for NaN.
    #[inline(always)]
    pub fn binade(self) -> Self {
        Four(self.0, self.0.binade4(self.1))
    }
}

macro_rules! operator {
    ($name:ident $method:ident $lanes:ident) => {
        impl<L: Lanes> $name for Four<L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Four(self.0, self.0.$lanes(self.1, other.1))
            }
        }
    };
}
operator!(Add add add4);
operator!(Sub sub sub4);
operator!(Mul mul mul4);
operator!(Div div div4);

impl<L: Lanes> Neg for Four<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Four(self.0, self.0.neg4(self.1))
    }
}

impl<L: Lanes> Real for Four<L> {
    const EVERY: u32 = 15;
    #[inline(always)]
    fn all(self, x: f64) -> Self {
        Four(self.0, self.0.splat4(x))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Four(self.0, self.0.sqrt4(self.1))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Four(self.0, self.0.abs4(self.1))
    }
    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        self.0.lt4(self.1, other.1)
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> u32 {
        self.0.le4(self.1, other.1)
    }
    #[inline(always)]
    fn third_of_bits(self, more: u64) -> Self {
        let [a, b, c, d] = self.to_array();
        let numbers =
            [a.third_of_bits(more), b.third_of_bits(more), c.third_of_bits(more), d.third_of_bits(more)];
        Four::new(self.0, numbers)
    }
    #[inline(always)]
    fn ones(self, mask: u32) -> Self {
        Four::new(self.0, ONES[mask as usize & 15])
    }
    #[inline(always)]
    fn if_less(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        Four(a.0, a.0.if_less4(a.1, b.1, then.1, otherwise.1))
    }
    #[inline(always)]
    fn if_at_most(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        Four(a.0, a.0.if_at_most4(a.1, b.1, then.1, otherwise.1))
    }
    #[inline(always)]
    fn two_product<P: Product>(a: Self, b: Self) -> (Self, Self) {
        let (p, e) = a.0.two_product4(a.1, b.1);
        (Four(a.0, p), Four(a.0, e))
    }
    #[inline(always)]
    fn remainder<P: Product>(c: Self, a: Self, b: Self) -> Self {
        let (p, e) = Self::two_product::<P>(a, b);
        (c - p) - e
    }
}

/// One in the lanes of a mask.
const ONES: [[f64; 4]; 16] = {
    let mut all = [[0.0; 4]; 16];
    let mut mask = 0;
    while mask < 16 {
        let mut lane = 0;
        while lane < 4 {
            all[mask][lane] = (mask >> lane & 1) as f64;
            lane += 1;
        }
        mask += 1;
    }
    all
};

/// Twice as many numbers: where each operation waits for the one before, two of them at a time take little longer than one.
#[derive(Clone, Copy, Debug)]
pub struct Twice<R>(pub R, pub R);

macro_rules! twice {
    ($name:ident $method:ident) => {
        impl<R: Real> $name for Twice<R> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Twice(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    };
}
twice!(Add add);
twice!(Sub sub);
twice!(Mul mul);
twice!(Div div);

impl<R: Real> Neg for Twice<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Twice(-self.0, -self.1)
    }
}

impl<R: Real> Twice<R> {
    const WIDTH: u32 = R::EVERY.count_ones();
}

impl<R: Real> Real for Twice<R> {
    const EVERY: u32 = R::EVERY | R::EVERY << Self::WIDTH;
    #[inline(always)]
    fn all(self, x: f64) -> Self {
        Twice(self.0.all(x), self.1.all(x))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Twice(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Twice(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        self.0.less(other.0) | self.1.less(other.1) << Self::WIDTH
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> u32 {
        self.0.at_most(other.0) | self.1.at_most(other.1) << Self::WIDTH
    }
    #[inline(always)]
    fn third_of_bits(self, more: u64) -> Self {
        Twice(self.0.third_of_bits(more), self.1.third_of_bits(more))
    }
    #[inline(always)]
    fn ones(self, mask: u32) -> Self {
        Twice(self.0.ones(mask), self.1.ones(mask >> Self::WIDTH))
    }
    #[inline(always)]
    fn if_less(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        Twice(R::if_less(a.0, b.0, then.0, otherwise.0), R::if_less(a.1, b.1, then.1, otherwise.1))
    }
    #[inline(always)]
    fn if_at_most(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        Twice(R::if_at_most(a.0, b.0, then.0, otherwise.0), R::if_at_most(a.1, b.1, then.1, otherwise.1))
    }
    #[inline(always)]
    fn two_product<P: Product>(a: Self, b: Self) -> (Self, Self) {
        let ((p, e), (q, f)) = (R::two_product::<P>(a.0, b.0), R::two_product::<P>(a.1, b.1));
        (Twice(p, q), Twice(e, f))
    }
    #[inline(always)]
    fn remainder<P: Product>(c: Self, a: Self, b: Self) -> Self {
        Twice(R::remainder::<P>(c.0, a.0, b.0), R::remainder::<P>(c.1, a.1, b.1))
    }
}

/// Three coordinates. The operations are those of [`DVec3`], in its order.
#[derive(Clone, Copy, Debug)]
pub struct Vector<R> {
    /// The first coordinate.
    pub x: R,
    /// The second.
    pub y: R,
    /// The third.
    pub z: R,
}

impl From<DVec3> for Vector<f64> {
    #[inline(always)]
    fn from(v: DVec3) -> Self {
        Vector { x: v.x, y: v.y, z: v.z }
    }
}

impl From<Vector<f64>> for DVec3 {
    #[inline(always)]
    fn from(v: Vector<f64>) -> Self {
        DVec3::new(v.x, v.y, v.z)
    }
}

impl<L: Lanes> Vector<Four<L>> {
    /// One vector in each lane. From where they are: copies would be written in other pieces than they are read in.
    #[inline(always)]
    pub fn new(lanes: L, [a, b, c, d]: [&DVec3; 4]) -> Self {
        Vector {
            x: Four::new(lanes, [a.x, b.x, c.x, d.x]),
            y: Four::new(lanes, [a.y, b.y, c.y, d.y]),
            z: Four::new(lanes, [a.z, b.z, c.z, d.z]),
        }
    }

    /// The vectors of the lanes.
    #[inline(always)]
    pub fn to_array(self) -> [DVec3; 4] {
        let (x, y, z) = (self.x.to_array(), self.y.to_array(), self.z.to_array());
        [0, 1, 2, 3].map(|i| DVec3::new(x[i], y[i], z[i]))
    }
}

impl<R> Vector<Twice<R>> {
    /// The vectors of both.
    #[inline(always)]
    pub fn both(a: Vector<R>, b: Vector<R>) -> Self {
        Vector { x: Twice(a.x, b.x), y: Twice(a.y, b.y), z: Twice(a.z, b.z) }
    }
}

impl<R: Real> Vector<R> {
    /// The same vector in all lanes, of as many as `like` has.
    #[inline(always)]
    pub fn all(like: R, v: DVec3) -> Self {
        Vector { x: like.all(v.x), y: like.all(v.y), z: like.all(v.z) }
    }

    /// The scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The largest absolute value of the components.
    #[inline(always)]
    pub fn largest(self) -> R {
        let (x, y, z) = (self.x.abs(), self.y.abs(), self.z.abs());
        let most = R::if_at_most(y, x, x, y);
        R::if_at_most(z, most, most, z)
    }

    /// The length.
    #[inline(always)]
    pub fn length(self) -> R {
        self.dot(self).sqrt()
    }
}

impl<R: Real> Add for Vector<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Vector { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}

impl<R: Real> Sub for Vector<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Vector { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}

impl<R: Real> Neg for Vector<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Vector { x: -self.x, y: -self.y, z: -self.z }
    }
}

impl<R: Real> Mul<R> for Vector<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: R) -> Self {
        Vector { x: self.x * s, y: self.y * s, z: self.z * s }
    }
}

impl<R: Real> Div<R> for Vector<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, s: R) -> Self {
        Vector { x: self.x / s, y: self.y / s, z: self.z / s }
    }
}
