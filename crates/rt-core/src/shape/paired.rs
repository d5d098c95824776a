//! A ray in three pairs of numbers: they lie in memory as two-wide registers read them, and two of a ray's inner
//! products cost what one does.

use crate::Ray;
use crate::kernel::Pair;
use glam::DVec3;

/// A line `w + t d` in pairs.
#[derive(Clone, Copy)]
pub(super) struct Paired {
    /// `w.x` and `w.y`.
    pub first: Pair,
    /// `w.z` and `d.x`.
    pub second: Pair,
    /// `d.y` and `d.z`.
    pub rest: Pair,
}

impl Paired {
    /// A ray, its origin seen from an anchor: x and y; z and zero.
    #[inline(always)]
    pub fn new(ray: &Ray, anchor: [Pair; 2]) -> Paired {
        let (o, d) = (ray.origin, ray.direction);
        Paired {
            first: Pair::new(o.x, o.y) - anchor[0],
            second: Pair::new(o.z, d.x) - anchor[1],
            rest: Pair::new(d.y, d.z),
        }
    }

    /// The line of these vectors.
    #[inline(always)]
    pub fn of(w: DVec3, d: DVec3) -> Paired {
        Paired { first: Pair::new(w.x, w.y), second: Pair::new(w.z, d.x), rest: Pair::new(d.y, d.z) }
    }

    /// The squares of the lengths of `w` and of `d`, each the sum of three products.
    #[inline(always)]
    pub fn squares(&self) -> Pair {
        let (a, b, c) = (self.first * self.first, self.second * self.second, self.rest * self.rest);
        (a.lows(c) + a.highs(c)) + b
    }

    /// `w . d`.
    #[inline(always)]
    pub fn along(&self) -> f64 {
        let across = self.first * Pair::new(self.second.high(), self.rest.low());
        across.low() + self.second.low() * self.rest.high() + across.high()
    }

    /// `w x d`: x and y; z.
    #[inline(always)]
    pub fn moment(&self) -> (Pair, f64) {
        let Paired { first, second, rest } = *self;
        let x_y = Pair::new(first.high(), second.low()) * rest.highs(second) - second.lows(first) * rest;
        let z = first.low() * rest.low() - first.high() * second.high();
        (x_y, z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// Products by pairs are those of the vectors: to the bit where the order of the sums is the same, and to a few roundings.
    #[test]
    fn products_of_pairs() {
        let mut random = Random::new(1);
        for _ in 0..2000 {
            let origin = random.in_cube() * random.magnitude(-2.0, 2.0);
            let (anchor, d) = (random.in_cube(), random.in_cube() * random.magnitude(-2.0, 2.0));
            let ray = Ray::new(origin, d);
            let paired = Paired::new(&ray, [Pair::new(anchor.x, anchor.y), Pair::new(anchor.z, 0.0)]);
            let w = origin - anchor;
            let of = Paired::of(w, d);
            let numbers = |p: &Paired| [p.first, p.second, p.rest].map(|pair| (pair.low(), pair.high()));
            assert_eq!(numbers(&paired), [(w.x, w.y), (w.z, d.x), (d.y, d.z)]);
            assert_eq!(numbers(&of), numbers(&paired));
            let (x_y, z) = paired.moment();
            assert_eq!(DVec3::new(x_y.low(), x_y.high(), z), w.cross(d));
            let squares = paired.squares();
            assert_eq!(squares.low(), w.dot(w));
            assert!((squares.high() / d.dot(d) - 1.0).abs() < 1e-15);
            assert!((paired.along() - w.dot(d)).abs() < 1e-15 * w.length() * d.length());
        }
    }
}
