//! A line against the side and the planes of the caps, in double-double: see the module above for the equations.

use super::{BASE, Frustum, SIDE, TOP};
use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::{self, Product, Task};
use crate::math::exp2i;
use crate::scaled::{ScaledRay, largest};
use glam::DVec3;

/// A crossing, in the scale of the ray, after its shift.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    pub at: Double,
    pub part: u32,
    pub root: u32,
}

/// A ray against the side and the planes of the caps: `start + (t - shift) * direction`.
pub(super) struct Line {
    pub shift: Double,
    pub start: DoubleVector,
    /// The height at the start and its growth.
    pub z: Double,
    pub z_growth: Double,
    pub height: Double,
    /// The end that is the apex, if one is: nothing enters or leaves through it, but next to it through the side.
    tip: Option<u32>,
    /// The growth of the radius along the ray: its sign says on which nappe the ray ends.
    e1: Double,
    /// The leading coefficient: negative where the ray runs steeper than the side.
    pub a: Double,
    /// The quadratic at the start: negative inside.
    c: Double,
    /// The discriminant: positive where the line crosses the double cone.
    pub depth: Double,
    /// Entrance and exit of the side.
    pub side: [Double; 2],
}

pub(super) struct FindLine<'a> {
    pub frustum: &'a Frustum,
    pub ray: &'a ScaledRay,
}

const INFINITE: Double = Double::from(f64::INFINITY);

impl Task for FindLine<'_> {
    type Output = Line;
    #[inline(always)]
    fn run<P: Product>(self) -> Line {
        let f = self.frustum;
        let d = self.ray.direction;
        let far = self.ray.relative;
        let step = f.approach(far.high(), d);
        let mut shift = Double::from(step);
        let mut start = far + DoubleVector::product::<P>(d, step);
        // The first step errs by a few u of the distance: from beyond 2^30 a second one brings the rest down.
        if largest(far.high()) > exp2i(30) {
            let step = f.approach(start.high(), d);
            shift = shift + step;
            start = start + DoubleVector::product::<P>(d, step);
        }

        let z = f.axis.dot::<P>(start);
        let z_growth = f.axis.dot_f64::<P>(d);
        let mut across = DoubleVector::from(d) - f.axis.mul::<P>(z_growth);
        // The axis is known to 2^-103: what is less than 2^-90 of the direction may be its error alone, and moves the
        // ray by 2^-90 of the height between the caps.
        if largest(across.high()) < exp2i(-90) {
            across = DoubleVector::default();
        }
        let away = start - f.axis.mul::<P>(z);
        let e0 = f.slope.mul::<P>(z) + f.base_radius * exp2i(-f.unit);
        let e1 = f.slope.mul::<P>(z_growth);
        let a = across.length_squared::<P>() - e1.square::<P>();
        let b = away.dot::<P>(across) - e0.mul::<P>(e1);
        let c = away.length_squared::<P>() - e0.square::<P>();
        let depth = b.square::<P>() - a.mul::<P>(c);
        let root = depth.sqrt::<P>();
        // The larger root in size has no cancellation; the product of both is c / a.
        let side = if depth.high <= 0.0 {
            // A double root, or none: then the closest approach, for hits that are known to exist.
            [quotient::<P>(-b, a); 2]
        } else if b.high > 0.0 {
            let q = -b - root;
            [quotient::<P>(q, a), c.div::<P>(q)]
        } else {
            let q = root - b;
            [c.div::<P>(q), quotient::<P>(q, a)]
        };
        let tip = match [f.base_radius, f.top_radius] {
            [0.0, _] => Some(BASE),
            [_, 0.0] => Some(TOP),
            _ => None,
        };
        Line { shift, start, z, z_growth, height: f.height, tip, e1, a, c, depth, side }
    }
}

/// `q / a`, infinite for zero `a`.
#[inline(always)]
pub(super) fn quotient<P: Product>(q: Double, a: Double) -> Double {
    let rough = q.high / a.high;
    if rough.is_finite() { q.div::<P>(a) } else { Double::from(rough) }
}

impl Frustum {
    /// Roughly where a line passes closest to the axis between the caps. Any finite answer is allowed: it only
    /// decides how well conditioned the rest is.
    #[inline(always)]
    fn approach(&self, w: DVec3, d: DVec3) -> f64 {
        let a = self.axis.high();
        let (z, z_growth) = (a.dot(w), a.dot(d));
        let across = d - a * z_growth;
        let away = w - a * z;
        let mut t = -(away.dot(across) / across.dot(across));
        let (base, top) = (-(z / z_growth), (self.height.high - z) / z_growth);
        let (first, last) = if base < top { (base, top) } else { (top, base) };
        // Without motion along the axis the planes are nowhere: infinite, or NaN where the line lies in one of them. NaN, also
        // for no motion across, fails every comparison.
        if !(t > first) && first.is_finite() {
            t = first;
        }
        if t > last && last.is_finite() {
            t = last;
        }
        if t.is_finite() { t } else { 0.0 }
    }
}

impl Line {
    fn cap(&self, part: u32) -> Double {
        let rise = if part == TOP { self.height - self.z } else { -self.z };
        kernel::run(Quotient(rise, self.z_growth))
    }

    /// The entrance and exit between the planes of the caps; `None` where the line runs beside them.
    fn slab(&self) -> Option<[Crossing; 2]> {
        if self.z_growth.high == 0.0 {
            let between = self.z.high > 0.0 && self.z < self.height;
            let end = |at| Crossing { at, part: BASE, root: 0 };
            return if between { Some([end(-INFINITE), end(INFINITE)]) } else { None };
        }
        let base = Crossing { at: self.cap(BASE), part: BASE, root: 0 };
        let top = Crossing { at: self.cap(TOP), part: TOP, root: 0 };
        Some(if self.z_growth.high > 0.0 { [base, top] } else { [top, base] })
    }

    /// Entrance and exit of the nappe that has the frustum; `None` where the line misses the side.
    ///
    /// Where `a` is negative the line runs steeper than the side: on the wanted nappe it only enters when it runs
    /// towards larger radii, and only leaves when it runs towards smaller ones. Then it always crosses (the
    /// discriminant is at least zero: through the apex it is zero); else only where the discriminant is positive.
    fn nappe(&self) -> Option<[Crossing; 2]> {
        let end = |at, root| Crossing { at, part: SIDE, root };
        if self.a.high == 0.0 && self.e1.high == 0.0 && self.c.high < 0.0 {
            // Along the axis of a cylinder, inside.
            return Some([end(-INFINITE, 0), end(INFINITE, 1)]);
        }
        if !(self.depth.high > 0.0 || self.a.high < 0.0) {
            return None;
        }
        let steep = self.a.high < 0.0;
        let enter = if steep && self.e1.high < 0.0 { -INFINITE } else { self.side[0] };
        let leave = if steep && self.e1.high > 0.0 { INFINITE } else { self.side[1] };
        Some([Crossing { at: enter, part: SIDE, root: 0 }, Crossing { at: leave, part: SIDE, root: 1 }])
    }

    /// The crossings of the whole line, ascending.
    pub fn span(&self, closed: bool) -> [Option<Crossing>; 2] {
        let (Some([first, last]), Some([enter, leave])) = (self.slab(), self.nappe()) else {
            return [None; 2];
        };
        let from = if enter.at > first.at { enter } else { first };
        let to = if leave.at < last.at { leave } else { last };
        if !(from.at < to.at) {
            return [None; 2];
        }
        // Next to the apex rounding orders the side and the plane across it.
        let from = if self.tip == Some(from.part) { enter } else { from };
        let to = if self.tip == Some(to.part) { leave } else { to };
        [from, to].map(|c| if closed || c.part == SIDE { Some(c) } else { None })
    }

    /// The exit of a line that is known to run inside from `part` on.
    pub fn exit(&self, closed: bool, part: u32) -> Option<Crossing> {
        let side = Crossing { at: self.side[1], part: SIDE, root: 1 };
        let leave = match self.nappe() {
            Some([_, leave]) => leave,
            // By rounding the line passes just outside: it leaves where it is.
            None => Crossing { at: -INFINITE, ..side },
        };
        let last = match self.slab() {
            Some([_, last]) => last,
            // Likewise, along a cap.
            None => Crossing { at: -INFINITE, part: if part == SIDE { BASE } else { part }, root: 0 },
        };
        let exit = if leave.at < last.at || self.tip == Some(last.part) { leave } else { last };
        if closed || exit.part == SIDE { Some(exit) } else { None }
    }
}

struct Quotient(Double, Double);

impl Task for Quotient {
    type Output = Double;
    #[inline(always)]
    fn run<P: Product>(self) -> Double {
        quotient::<P>(self.0, self.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line whose numbers are these; along the axis it runs with speed 1 from this height.
    fn line(z: f64, z_growth: f64, [e1, a, c, depth]: [f64; 4], side: [f64; 2]) -> Line {
        let [z, z_growth, e1, a, c, depth] = [z, z_growth, e1, a, c, depth].map(Double::from);
        let side = side.map(Double::from);
        let (shift, start, height) = (Double::ZERO, DoubleVector::default(), Double::ONE);
        Line { shift, start, z, z_growth, height, tip: None, e1, a, c, depth, side }
    }

    /// What a line has in common with slab and side, and where one leaves that is known to be inside.
    #[test]
    fn spans_and_exits() {
        let (never, always) = (f64::NEG_INFINITY, f64::INFINITY);
        let across = [0.0, 1.0, -1.0, 1.0];
        // Height and growth, numbers of the side, its crossings; first and last crossing and their parts; the exit from the
        // side of a closed one, and that from a cap.
        type Expected = (Option<[(f64, u32); 2]>, (f64, u32), (f64, u32));
        type Case = (f64, f64, [f64; 4], [f64; 2], Expected);
        let cases: [Case; 13] = [
            // Up and down between the caps, or through them.
            (0.5, 0.1, across, [-1.0, 1.0], (Some([(-1.0, SIDE), (1.0, SIDE)]), (1.0, SIDE), (1.0, SIDE))),
            (0.5, 1.0, across, [-1.0, 1.0], (Some([(-0.5, BASE), (0.5, TOP)]), (0.5, TOP), (0.5, TOP))),
            (0.5, -1.0, across, [-1.0, 1.0], (Some([(-0.5, TOP), (0.5, BASE)]), (0.5, BASE), (0.5, BASE))),
            (0.5, -1.0, across, [-0.25, 1.0], (Some([(-0.25, SIDE), (0.5, BASE)]), (0.5, BASE), (0.5, BASE))),
            // Past the rim, and past the side by rounding.
            (2.5, 1.0, across, [-1.0, 1.0], (None, (-1.5, TOP), (-1.5, TOP))),
            (0.5, 1.0, [0.0, 1.0, 1.0, -1.0], [5.0, 5.0], (None, (never, SIDE), (never, SIDE))),
            (0.5, 1.0, [0.0, 1.0, 0.0, 0.0], [0.0, 0.0], (None, (never, SIDE), (never, SIDE))),
            // Through the very rim.
            (0.5, 1.0, across, [0.5, 1.0], (None, (0.5, TOP), (0.5, TOP))),
            // Along the slab, in it and in or beside a cap.
            (0.5, 0.0, across, [-1.0, 1.0], (Some([(-1.0, SIDE), (1.0, SIDE)]), (1.0, SIDE), (1.0, SIDE))),
            (1.0, 0.0, across, [-1.0, 1.0], (None, (never, BASE), (never, TOP))),
            // Along the axis of a cylinder.
            (
                0.5,
                1.0,
                [0.0, 0.0, -1.0, 0.0],
                [always, always],
                (Some([(-0.5, BASE), (0.5, TOP)]), (0.5, TOP), (0.5, TOP)),
            ),
            // Steeper than the side: towards larger radii it never leaves, towards smaller ones it was always inside.
            (
                0.5,
                1.0,
                [0.5, -1.0, -1.0, 1.0],
                [-0.25, 0.25],
                (Some([(-0.25, SIDE), (0.5, TOP)]), (0.5, TOP), (0.5, TOP)),
            ),
            (
                0.5,
                1.0,
                [-0.5, -1.0, -1.0, 0.0],
                [-0.25, 0.25],
                (Some([(-0.5, BASE), (0.25, SIDE)]), (0.25, SIDE), (0.25, SIDE)),
            ),
        ];
        for (place, (z, z_growth, numbers, side, (both, from_side, from_cap))) in
            cases.into_iter().enumerate()
        {
            let line = line(z, z_growth, numbers, side);
            let of = |c: Crossing| (c.at.high, c.part);
            for closed in [true, false] {
                let kept = |c: (f64, u32)| if closed || c.1 == SIDE { Some(c) } else { None };
                let expected = both.map_or([None; 2], |both| both.map(kept));
                assert_eq!(line.span(closed).map(|c| c.map(of)), expected, "{place}");
                assert_eq!(line.exit(closed, SIDE).map(of), kept(from_side), "{place}");
                assert_eq!(line.exit(closed, TOP).map(of), kept(from_cap), "{place}");
            }
            let roots = line.span(true).map(|c| c.map_or(9, |c| c.root + 3 * c.part));
            assert!(both.is_none() || roots[0] % 3 == 0, "{place}");
            assert!(both.is_none() || (roots[1] == 1) == (roots[1] < 3), "{place}");
        }
    }
}
