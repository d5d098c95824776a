//! Exact arithmetic where double-double cannot decide: floating-point expansions.
//!
//! An expansion is a sum of `f64` that do not overlap, in ascending order. Sums with a `f64` and products with a `f64`
//! are exact (Shewchuk 1997, doi:10.1007/PL00009321, algorithms Grow-Expansion and Scale-Expansion with zero
//! elimination); the sign is that of the last part.

use super::scaled::{Local, Polynomial};
use crate::double::{Double, fast_two_sum, two_sum};
use crate::kernel::Product;

/// The longest expansion that occurs: a polynomial of degree four with double-double coefficients at a `f64`, where each
/// step doubles the number of parts and adds two: 2, 6, 14, 30, 62.
const PARTS: usize = 64;

/// An exact sum.
#[derive(Clone, Copy)]
pub(super) struct Expansion {
    part: [f64; PARTS],
    len: usize,
}

impl Expansion {
    fn zero() -> Self {
        Expansion { part: [0.0; PARTS], len: 0 }
    }

    fn push(&mut self, part: f64) {
        if part != 0.0
            && let Some(slot) = self.part.get_mut(self.len)
        {
            *slot = part;
            self.len += 1;
        }
    }

    /// Adds a number.
    fn add(&mut self, b: f64) {
        let mut q = b;
        let len = core::mem::take(&mut self.len);
        for i in 0..len {
            // What is kept never overtakes what is read.
            let (s, e) = two_sum(q, self.part[i]);
            self.push(e);
            q = s;
        }
        self.push(q);
    }

    fn add_double(&mut self, b: Double) {
        self.add(b.low);
        self.add(b.high);
    }

    /// The product with a number.
    fn scaled<P: Product>(&self, b: f64) -> Self {
        let mut product = Expansion::zero();
        let mut q = 0.0;
        for (i, &part) in self.part[..self.len].iter().enumerate() {
            let (p, e) = P::two_product(part, b);
            if i == 0 {
                product.push(e);
                q = p;
            } else {
                let (s, f) = two_sum(q, e);
                product.push(f);
                let (t, g) = fast_two_sum(p, s);
                product.push(g);
                q = t;
            }
        }
        product.push(q);
        product
    }

    /// Adds another expansion.
    fn add_all(&mut self, b: &Expansion) {
        for &part in &b.part[..b.len] {
            self.add(part);
        }
    }

    /// A number of the same sign.
    fn sign(&self) -> f64 {
        if self.len == 0 { 0.0 } else { self.part[self.len - 1] }
    }

    fn is_zero(&self) -> bool {
        self.len == 0
    }

    /// The value to twice the precision.
    fn to_double(self) -> Double {
        let mut high = 0.0;
        let mut low = 0.0;
        for &part in &self.part[..self.len] {
            let (s, e) = two_sum(part, high);
            low = e;
            high = s;
        }
        // The parts were added from below: one more pass from above recovers what the last rounding left.
        let mut rest = self;
        rest.add(-high);
        for &part in &rest.part[..rest.len] {
            low = if part == rest.part[0] { part } else { low + part };
        }
        if rest.len == 0 {
            low = 0.0;
        }
        let (high, low) = fast_two_sum(high, low);
        Double { high, low }
    }
}

/// The polynomial in the variable `x - s`, each coefficient rounded once to double-double.
pub(super) fn shifted<P: Product>(p: &Polynomial, s: f64) -> Polynomial {
    let Local { c, y, exponent, .. } = p.local(Double::from(s));
    let y = y.high;
    // Binomial coefficients of the k-th Taylor coefficient: C(i, k).
    const BINOMIAL: [[f64; 5]; 5] = [
        [1.0, 1.0, 1.0, 1.0, 1.0],
        [0.0, 1.0, 2.0, 3.0, 4.0],
        [0.0, 0.0, 1.0, 3.0, 6.0],
        [0.0, 0.0, 0.0, 1.0, 4.0],
        [0.0, 0.0, 0.0, 0.0, 1.0],
    ];
    let mut shifted = [Double::ZERO; 5];
    for (k, (shifted, binomial)) in shifted.iter_mut().zip(&BINOMIAL).enumerate() {
        let mut sum = Expansion::zero();
        for i in (k..5).rev() {
            sum = sum.scaled::<P>(y);
            // 3, and 6 = 3 * 2, times a number of 53 bits is the sum of two numbers.
            let (high, low) = (c[i].high, c[i].low);
            match binomial[i] {
                3.0 => [2.0 * low, low, 2.0 * high, high].iter().for_each(|&b| sum.add(b)),
                6.0 => [4.0 * low, 2.0 * low, 4.0 * high, 2.0 * high].iter().for_each(|&b| sum.add(b)),
                b => sum.add_double(c[i].scale_exact(b)),
            }
        }
        *shifted = sum.to_double();
    }
    Polynomial::stretched(&shifted, exponent, p.degree())
}

/// The multiplicity of the multiple root that `p`, a polynomial with `f64` coefficients, has at `x`, or `None` if it has
/// no multiple root there. `x` is that root to 2^-60, relative, if there is one.
///
/// If the polynomial has only one multiple root, that root is rational, and by Gauss's lemma the square of its denominator
/// divides the leading coefficient and that of its numerator the trailing one: it is `2^j a / b` with odd
/// `a, b < 2^26.5`. The only alternative is the square of a quadratic.
pub(super) fn multiple_root<P: Product>(p: &Polynomial, x: Double) -> Option<u32> {
    let local = p.local(x);
    if local.dropped || local.c.iter().any(|c| c.low != 0.0) {
        return None;
    }
    let c = local.c.map(|c| c.high);
    if let Some((numerator, denominator)) = fraction::<P>(local.y) {
        let multiplicity = multiplicity_at::<P>(&c, numerator, denominator, p.degree());
        if multiplicity > 1 {
            return Some(multiplicity);
        }
    }
    if p.degree() == 4 && is_real_square::<P>(&c) && near_root(&c, local.y.high) { Some(2) } else { None }
}

/// The fraction with a denominator up to 2^27 that is nearest to `y`, `1 <= |y| < 2`, if it is nearer than any two such
/// fractions can be to one number: by continued fractions.
fn fraction<P: Product>(y: Double) -> Option<(f64, f64)> {
    const LIMIT: f64 = 134_217_728.0;
    let (mut rest, sign) = if y.high < 0.0 { (-y, -1.0) } else { (y, 1.0) };
    // A number of few digits, at once: by the same bound as below.
    const SHORT: f64 = 67_108_864.0;
    let n = floor(rest.high * SHORT + 0.5);
    if ((rest.high * SHORT - n) + rest.low * SHORT).abs() <= SHORT * (1.0 / 72_057_594_037_927_936.0) {
        return Some((sign * n, SHORT));
    }
    let (mut n0, mut d0, mut n1, mut d1) = (0.0, 1.0, 1.0, 0.0);
    // The denominators grow at least as the Fibonacci numbers: 40 steps reach 2^27.
    for _ in 0..42 {
        let whole = floor(rest.high);
        let whole = if rest.high == whole && rest.low < 0.0 { whole - 1.0 } else { whole };
        let (n2, d2) = (whole * n1 + n0, whole * d1 + d0);
        if !(d2 <= LIMIT) {
            return None;
        }
        (n0, d0, n1, d1) = (n1, d1, n2, d2);
        // |y - n / d| < 2^-56: two fractions below the limit differ by 2^-54 or more.
        let difference = Double::from(n1) - (if y.high < 0.0 { -y } else { y }).scale::<P>(d1);
        if difference.high.abs() <= d1 * (1.0 / 72_057_594_037_927_936.0) {
            return Some((sign * n1, d1));
        }
        let remainder = rest - whole;
        if remainder.high <= 0.0 {
            return None;
        }
        rest = Double::ONE.div::<P>(remainder);
    }
    None
}

/// The largest whole number up to `x`, `0 <= x < 2^53`.
fn floor(x: f64) -> f64 {
    libm::floor(x)
}

/// How often `n / d` is a root of the polynomial, exactly. `n` and `d` are whole numbers up to 2^28.
fn multiplicity_at<P: Product>(c: &[f64; 5], n: f64, d: f64, degree: usize) -> u32 {
    // By division while all its steps are exact, as they are for numbers of few digits; then by expansions.
    let mut c = *c;
    for found in 0..degree {
        let degree = degree - found;
        if clearly_not_zero(&c, n, d, degree) {
            return found as u32;
        }
        match divided::<P>(&c, n, d, degree) {
            Some(quotient) => c = quotient,
            None => return found as u32 + order_of_zero::<P>(&c, n, d, degree),
        }
    }
    degree as u32
}

/// Whether `n / d` is no root already in plain arithmetic.
fn clearly_not_zero(c: &[f64; 5], n: f64, d: f64, degree: usize) -> bool {
    let (mut value, mut size, mut power) = (c[degree], c[degree].abs(), 1.0);
    for k in (0..degree).rev() {
        power *= d;
        value = value * n + c[k] * power;
        size = size * n.abs() + (c[k] * power).abs();
    }
    // Four steps of three roundings and the powers' own, of the magnitudes each: below 16 u.
    value.abs() > 16.0 * f64::EPSILON * size
}

/// The quotient of the polynomial and `d x - n`, if there is no remainder and no step is rounded.
fn divided<P: Product>(c: &[f64; 5], n: f64, d: f64, degree: usize) -> Option<[f64; 5]> {
    let mut quotient = [0.0; 5];
    let (mut sum, mut rounding) = (c[degree], 0.0);
    for k in (0..degree).rev() {
        // c[k + 1] + n quotient[k + 1] = d quotient[k]
        let q = sum / d;
        let (p, e) = P::two_product(q, n);
        if rounding != 0.0 || P::remainder(sum, q, d) != 0.0 || e != 0.0 {
            return None;
        }
        quotient[k] = q;
        (sum, rounding) = two_sum(c[k], p);
    }
    if sum == 0.0 { Some(quotient) } else { None }
}

/// How often `n / d` is a root, by the signs of the derivatives there.
fn order_of_zero<P: Product>(c: &[f64; 5], n: f64, d: f64, degree: usize) -> u32 {
    for order in 0..degree {
        // The order-th derivative over order!, times d^(degree - order), term by term.
        let mut sum = Expansion::zero();
        for (i, &c) in c.iter().enumerate().take(degree + 1).skip(order) {
            let mut term = Expansion::zero();
            term.add(c);
            for _ in 0..i - order {
                term = term.scaled::<P>(n);
            }
            for _ in 0..degree - i {
                term = term.scaled::<P>(d);
            }
            sum.add_all(&term.scaled::<P>(binomial(i, order)));
        }
        if !sum.is_zero() {
            return order as u32;
        }
    }
    degree as u32
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64)
}

/// Whether the quartic is a constant times the square of a quadratic:
/// `c4 (x^2 + u x + v)^2` has `c1^2 c4 = c3^2 c0` and `4 c4 c2 c3 = c3^3 + 8 c4^2 c1`, or `c3 = c1 = 0` and
/// `c2^2 = 4 c4 c0`. Its roots are real when `u^2 >= 4 v`: `(c3^3 - 16 c4^2 c1) c3 >= 0`, or `c2 c4 <= 0`.
fn is_real_square<P: Product>(c: &[f64; 5]) -> bool {
    let product = |factors: &[f64]| {
        let mut e = Expansion::zero();
        e.add(1.0);
        factors.iter().fold(e, |e, &f| e.scaled::<P>(f))
    };
    let [c0, c1, c2, c3, c4] = *c;
    if c3 == 0.0 {
        let mut e = product(&[c2, c2]);
        e.add_all(&product(&[-4.0, c4, c0]));
        return c1 == 0.0 && (c2 > 0.0) != (c4 > 0.0) && e.is_zero();
    }
    let mut e = product(&[c1, c1, c4]);
    e.add_all(&product(&[-c3, c3, c0]));
    if !e.is_zero() {
        return false;
    }
    let mut e = product(&[4.0, c4, c2, c3]);
    e.add_all(&product(&[-c3, c3, c3]));
    e.add_all(&product(&[-8.0, c4, c4, c1]));
    if !e.is_zero() {
        return false;
    }
    let mut e = product(&[c3, c3, c3]);
    e.add_all(&product(&[-16.0, c4, c4, c1]));
    e.sign() * c3 >= 0.0
}

/// Whether the square of a quadratic vanishes at `y` rather than at its other roots: in plain arithmetic, half of whose digits
/// are left at a double root.
fn near_root(c: &[f64; 5], y: f64) -> bool {
    let value = (((c[4] * y + c[3]) * y + c[2]) * y + c[1]) * y + c[0];
    let y = y.abs();
    let size = (((c[4].abs() * y + c[3].abs()) * y + c[2].abs()) * y + c[1].abs()) * y + c[0].abs();
    // Six roundings of the sum of the magnitudes.
    value.abs() <= 8.0 * f64::EPSILON * size
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Task;
    use crate::kernel::counted::counted;
    use crate::math::exp2i;
    use crate::testing::Random;

    struct Fraction(Double);

    impl Task for Fraction {
        type Output = Option<(f64, f64)>;
        fn run<P: Product>(self) -> Self::Output {
            fraction::<P>(self.0)
        }
    }

    /// A number of few digits is a fraction at once, another by continued fractions; what is none is told.
    #[test]
    fn fractions() {
        let mut random = Random::new(1);
        for case in 0..4000 {
            let sign = random.sign();
            let b = 1.0 + f64::from(random.below(90_000_000));
            let a = b + floor(random.uniform(0.0, 1.0) * b);
            let short = 1.0 + f64::from(random.below(1 << 26)) * (1.0 / 67_108_864.0);
            // Known to 2^-60 only.
            let off = exp2i(-61) * random.uniform(-1.0, 1.0);
            let (y, few) = match case % 3 {
                0 => (Double::from(sign * short) + off, true),
                1 => (
                    Double::from(a).div::<crate::kernel::Dekker>(Double::from(b)).scale_exact(sign) + off,
                    false,
                ),
                _ => (Double::from(sign * random.uniform(1.0, 2.0)) + sign * exp2i(-55), false),
            };
            let (found, products) = counted(Fraction(y));
            assert!(!few || products == 0, "{y:?} {products}");
            match found {
                Some((n, d)) => {
                    // |n - d y| < d 2^-56, exactly.
                    let miss = Double::from(n) - y.scale::<crate::kernel::Dekker>(d);
                    assert!(miss.high.abs() <= d * exp2i(-56), "{y:?} {n} {d}");
                    assert!(n.abs() <= 2.0 * d && d <= exp2i(27) && d >= 1.0, "{y:?} {n} {d}");
                    if case % 3 == 0 {
                        assert_eq!(n / d, sign * short);
                    } else if case % 3 == 1 {
                        assert_eq!(n * b, sign * a * d, "{y:?} {n} {d}");
                    }
                }
                None => assert!(case % 3 == 2, "{y:?} {a} {b}"),
            }
        }
    }

    struct Order([f64; 5], f64, f64, usize);

    impl Task for Order {
        type Output = (u32, u32);
        fn run<P: Product>(self) -> Self::Output {
            let Order(c, n, d, degree) = self;
            (multiplicity_at::<P>(&c, n, d, degree), order_of_zero::<P>(&c, n, d, degree))
        }
    }

    /// How often a fraction is a root, by division and by derivatives: of polynomials whose coefficients have few digits and
    /// whose products have many.
    #[test]
    fn orders_of_zeros() {
        let mut random = Random::new(2);
        let mut count = [0; 5];
        for case in 0..4000 {
            let most = if case % 2 == 0 { 12 } else { 1000 };
            let number = |random: &mut Random| f64::from(random.below(most)) + 1.0;
            let (n, d) = (number(&mut random) * random.sign(), number(&mut random));
            // Times other factors, of which some have the same root, to a degree of at most four.
            let times = random.below(5) as usize;
            let mut c = [number(&mut random), 0.0, 0.0, 0.0, 0.0];
            let (mut expected, mut exact) = (0, true);
            for i in 0..4 {
                let same = i < times;
                let (p, q) = if same { (n, d) } else { (number(&mut random), number(&mut random)) };
                exact &= c.iter().all(|c| c.abs() * p.abs().max(q) < exp2i(53));
                c = core::array::from_fn(|k| if k == 0 { -p * c[0] } else { q * c[k - 1] - p * c[k] });
                expected += u32::from(p * d == n * q);
            }
            if !exact {
                continue;
            }
            let (found, by_derivatives) = counted(Order(c, n, d, 4)).0;
            assert_eq!((found, by_derivatives), (expected, expected), "{c:?} {n} {d}");
            count[expected as usize] += 1;
        }
        assert!(count.iter().all(|&count| count > 200), "{count:?}");
    }

    struct Square([f64; 5]);

    impl Task for Square {
        type Output = bool;
        fn run<P: Product>(self) -> bool {
            is_real_square::<P>(&self.0)
        }
    }

    /// Squares of quadratics with real roots are told from those of others, and from all neighbours.
    #[test]
    fn squares_of_quadratics() {
        let mut random = Random::new(3);
        let mut count = [0; 3];
        for case in 0..4000 {
            let number = |random: &mut Random| f64::from(random.below(4000)) - 2000.0;
            let lead = [1.0, 3.0, -1.0, -5.0][case % 4];
            let (u, v) = (if case % 3 == 0 { 0.0 } else { number(&mut random) }, number(&mut random) * 64.0);
            let mut c = [v * v, 2.0 * u * v, u * u + 2.0 * v, 2.0 * u, 1.0].map(|c| c * lead);
            assert_eq!(counted(Square(c)).0, u * u >= 4.0 * v && (u, v) != (0.0, 0.0), "{u} {v}");
            count[usize::from(u * u >= 4.0 * v)] += 1;
            let k = random.below(4) as usize;
            c[k] = if c[k] == 0.0 {
                1e-300
            } else if random.once_in(2) {
                c[k].next_up()
            } else {
                -c[k]
            };
            // Changing the sign of u makes it another square.
            if c[k] != 0.0 && !(k % 2 == 1 && u == 0.0) {
                let again = counted(Square(c)).0;
                count[2] += u32::from(!again);
                assert!(!again || c[1] * c[1] * c[4] == c[3] * c[3] * c[0], "{c:?}");
            }
        }
        assert!(count[0] > 700 && count[1] > 700 && count[2] > 3000, "{count:?}");
    }

    struct Shifted<'a>(&'a Polynomial, f64);

    impl Task for Shifted<'_> {
        type Output = Polynomial;
        fn run<P: Product>(self) -> Polynomial {
            shifted::<P>(self.0, self.1)
        }
    }

    /// The polynomial in another variable has the coefficients of the binomial theorem, exactly as far as two numbers go.
    #[test]
    fn developed_about_a_place() {
        let mut random = Random::new(4);
        for case in 0..2000 {
            let number = |random: &mut Random| f64::from(random.below(2000)) - 1000.0;
            let c: [f64; 5] = core::array::from_fn(|_| number(&mut random));
            if c[4] == 0.0 || c[0] == 0.0 {
                continue;
            }
            // Whole numbers, so that the development is exact in whole numbers, too.
            let s = number(&mut random) + 0.5 * f64::from(case % 2);
            if s == 0.0 {
                continue;
            }
            let p = Polynomial::new(&c.map(Double::from));
            let about = counted(Shifted(&p, s)).0;
            // Coefficients by the binomial theorem: below 2^53 in absolute value times 16.
            let mut expected = [0_i128; 5];
            let twice = (2.0 * s) as i128;
            for (i, &c) in c.iter().enumerate() {
                for (k, expected) in expected.iter_mut().enumerate().take(i + 1) {
                    let choose =
                        [[1, 0, 0, 0, 0], [1, 1, 0, 0, 0], [1, 2, 1, 0, 0], [1, 3, 3, 1, 0], [1, 4, 6, 4, 1]]
                            [i][k];
                    // Sixteen times the coefficient: c C(i, k) s^(i - k), with s half a whole number.
                    *expected +=
                        c as i128 * choose * twice.pow((i - k) as u32) * 2_i128.pow(4 - (i - k) as u32);
                }
            }
            let local = about.local(Double::ONE);
            // Up to the common power of two, that of the leading coefficient.
            let unit = c[4] / local.c[4].high;
            for (k, expected) in expected.into_iter().enumerate() {
                let found = (local.c[k].high * unit * 16.0) as i128 + (local.c[k].low * unit * 16.0) as i128;
                assert_eq!(found, expected, "{c:?} {s} {k}");
            }
        }
    }

    /// A sum of parts of any size, to twice the precision of its largest.
    #[test]
    fn rounded_to_two_numbers() {
        let mut random = Random::new(5);
        for _ in 0..4000 {
            let mut sum = Expansion::zero();
            let mut truth = crate::expansion::Expansion::ZERO;
            for _ in 0..8 {
                let part = random.sign() * random.uniform(1.0, 2.0) * exp2i(random.below(200) as i32 - 100);
                sum.add(part);
                truth.add(part);
            }
            let found = sum.to_double();
            assert_eq!(sum.sign().signum(), found.high.signum());
            truth.add(-found.high);
            let low = truth.rounded().to_f64();
            assert!((low - found.low).abs() <= exp2i(-52) * low.abs(), "{found:?} {low:e}");
            assert!(found.low.abs() <= exp2i(-53) * found.high.abs());
        }
    }
}
