//! Real roots of polynomials of degree two to four.
//!
//! Every solver takes the coefficients in ascending powers, `c[0] + c[1] x + c[2] x^2 + ..`, and the open interval in
//! which a root counts, and gives back [`Roots`]: all real roots inside, ascending, each once with its multiplicity.
//! Leading zeros lower the degree. The coefficients are taken as exact numbers.
//!
//! | coefficients | answer |
//! |---|---|
//! | all zero | no roots listed, [`Roots::all`] is true |
//! | a constant that is not zero | no roots |
//! | a NaN or an infinity among them | no roots |
//! | a root too large for `f64` | that root is left out |
//!
//! [`quadratic`], [`cubic`] and [`quartic()`] have the exact number of roots and each root within one unit in the last
//! place; how near, and how it is known, is said at each. The other methods for the quartic, [`quartic::ferrari`] and
//! [`quartic::graphics_gems`], are kept for comparison.

mod bracket;
mod cubic;
mod exact;
mod quadratic;
pub mod quartic;
mod scaled;

use crate::Interval;
use crate::double::Double;
use core::ops::Deref;

pub use cubic::cubic;
pub use quadratic::quadratic;
#[doc(inline)]
pub use quartic::quartic;

/// A real root and how often it counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Root<T = f64> {
    /// Where the polynomial is zero.
    pub x: T,
    /// 1 for a simple root, 2 for a double root and so on.
    pub multiplicity: u32,
}

/// At most `N` distinct real roots in ascending order; behaves as a slice of [`Root`].
///
/// The zero polynomial vanishes everywhere: its list is empty and [`Roots::all`] says so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roots<const N: usize, T = f64> {
    list: [Root<T>; N],
    /// How many of the list count, or [`ALL`]. One word, as the others: a copy made as soon as the parts are written
    /// would wait for parts smaller than those it reads.
    len: usize,
}

/// The length that says that every number is a root.
const ALL: usize = usize::MAX;

impl<const N: usize, T: Copy + Default> Default for Roots<N, T> {
    #[inline]
    fn default() -> Self {
        Roots { list: [Root::default(); N], len: 0 }
    }
}

impl<const N: usize, T: Copy + Default> Roots<N, T> {
    /// Whether every number is a root: the polynomial is zero.
    #[inline]
    pub fn all(&self) -> bool {
        self.len == ALL
    }

    /// The answer for the zero polynomial.
    #[inline]
    pub(crate) fn everything() -> Self {
        Roots { len: ALL, ..Roots::default() }
    }

    /// Appends a root; the caller keeps the order. What does not fit is dropped: a polynomial of degree `N` cannot
    /// have more.
    #[inline]
    pub(crate) fn push(&mut self, x: T, multiplicity: u32) {
        if let Some(slot) = self.list.get_mut(self.len) {
            *slot = Root { x, multiplicity };
            self.len += 1;
        }
    }
}

impl<const N: usize> Roots<N> {
    /// Puts a root in its place among those before it.
    #[inline]
    pub(crate) fn insert(&mut self, x: f64, multiplicity: u32) {
        self.push(x, multiplicity);
        let mut i = self.len.saturating_sub(1);
        while i > 0 && self.list[i].x < self.list[i - 1].x {
            self.list.swap(i, i - 1);
            i -= 1;
        }
    }

    /// The roots of the polynomial in `-x`.
    #[inline(always)]
    pub(crate) fn mirrored(&self) -> Self {
        let mut roots = if self.all() { Roots::everything() } else { Roots::default() };
        // Zero has one sign.
        self.iter().rev().for_each(|root| roots.push(0.0 - root.x, root.multiplicity));
        roots
    }

    /// Every root times a power of two.
    #[inline]
    pub(crate) fn scaled(mut self, power: f64) -> Self {
        self.list.iter_mut().for_each(|root| root.x *= power);
        self
    }

    /// Only the roots inside the interval.
    #[inline(always)]
    pub(crate) fn inside(self, within: Interval) -> Self {
        // The roots ascend: with the first and the last all are inside.
        match (self.first(), self.last()) {
            (Some(first), Some(last)) if !(within.contains(first.x) && within.contains(last.x)) => {
                self.within(within)
            }
            _ => self,
        }
    }

    /// The roots inside the interval, in a list of another capacity.
    #[inline]
    pub(crate) fn within<const M: usize>(&self, within: Interval) -> Roots<M> {
        let mut kept = if self.all() { Roots::everything() } else { Roots::default() };
        for root in self.iter().filter(|root| within.contains(root.x)) {
            kept.push(root.x, root.multiplicity);
        }
        kept
    }
}

/// What the quick ways find: simple roots, ascending, three at most. Only numbers, so that [`Roots`] are written once, where they are
/// returned: a copy of what was just written piece by piece costs as much as a division.
#[derive(Clone, Copy)]
enum Simple<const N: usize> {
    None,
    One(f64),
    All([f64; N]),
}

impl<const N: usize> Simple<N> {
    /// As a list, only those inside the interval.
    #[inline(always)]
    fn inside<const M: usize>(self, within: &Interval) -> Roots<M> {
        // The arguments in registers; NaN lies in no interval.
        #[cold]
        #[inline(never)]
        fn selected<const M: usize>(x: f64, y: f64, z: f64, within: Interval) -> Roots<M> {
            let mut roots = Roots::default();
            [x, y, z].iter().filter(|&&x| within.contains(x)).for_each(|&x| roots.push(x, 1));
            roots
        }
        #[inline(always)]
        fn list<const K: usize, const M: usize>(x: [f64; K], within: &Interval) -> Roots<M> {
            // They ascend: if the first and the last are not beyond its end, all are inside.
            if !(x.first().is_some_and(|&x| within.min < x) && x.last().is_some_and(|&x| x < within.max)) {
                let at = |i: usize| x.get(i).copied().unwrap_or(f64::NAN);
                return selected(at(0), at(1), at(2), *within);
            }
            let root = |i: usize| x.get(i).map_or(Root::default(), |&x| Root { x, multiplicity: 1 });
            Roots { list: core::array::from_fn(root), len: K }
        }
        match self {
            Simple::None => Roots::default(),
            Simple::One(x) => list([x], within),
            Simple::All(x) => list(x, within),
        }
    }
}

impl<const N: usize> Roots<N, Double> {
    /// The roots rounded to `f64`; those too large for it are left out.
    #[inline]
    pub(crate) fn rounded(&self) -> Roots<N> {
        let mut kept = if self.all() { Roots::everything() } else { Roots::default() };
        for root in self.iter() {
            let x = root.x.to_f64();
            if x.is_finite() {
                kept.push(x, root.multiplicity);
            }
        }
        kept
    }
}

impl<const N: usize, T> Deref for Roots<N, T> {
    type Target = [Root<T>];
    #[inline]
    fn deref(&self) -> &[Root<T>] {
        self.list.get(..self.len).unwrap_or(&[])
    }
}

/// How to solve a quartic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// [`quartic()`]: exact counts, correctly rounded or nearly so.
    #[default]
    Certified,
    /// [`quartic::ferrari()`]: the textbook formula.
    Ferrari,
    /// [`quartic::graphics_gems()`]: the solver of *Graphics Gems*, absolute tolerances and all.
    GraphicsGems,
}

/// The real roots inside `within` of `c[0] + c[1] x + .. + c[4] x^4` by the given method.
#[inline]
pub fn roots(c: [f64; 5], within: Interval, method: Method) -> Roots<4> {
    match method {
        Method::Certified => quartic(c, within),
        Method::Ferrari => quartic::ferrari(c, within),
        Method::GraphicsGems => quartic::graphics_gems(c, within),
    }
}
