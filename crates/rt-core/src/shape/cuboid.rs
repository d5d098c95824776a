//! A box: `min <= p <= max` in each coordinate of its own axes.
//!
//! `hit` clips the ray by three pairs of planes (Kay and Kajiya 1986, Ray Tracing Complex Scenes, doi:10.1145/15922.15916).
//! Along the world's axes each parameter `(min - o) / d` has a relative error of three roundings, so the order of
//! two of them is certain unless they agree to 4 u; then they are compared exactly, as fractions. A turned box takes
//! the ray into its own axes first and carries the absolute errors of that.

use super::flat::{self, LEAST_CERTAIN, U};
use super::meeting::{self, ExactPlane, Meeting, Piece};
use crate::double::Double;
use crate::expansion::Expansion;
use crate::kernel::{Clipped, Planes, Product, SlabLanes, Task, clip, run};
use crate::math::{exp2i, exponent, greater, lesser};
use crate::scaled::{checked_point, times_power};
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Side, Similarity, Surface};
use core::cmp::Ordering;
use core::num::NonZeroU64;
use glam::{DMat3, DVec2, DVec3};

/// A solid box, along the world's axes or turned. It may be flat.
///
/// # Parts
/// 0 and 1 are the faces where the first coordinate is least and greatest, 2 and 3 those of the second, 4 and 5
/// those of the third. The normal points out of the box. Root 0 enters the box, root 1 leaves it. A line that touches
/// an edge or a corner without entering does not hit; one that runs within a face enters and leaves by the others.
///
/// # Texture coordinates
/// The anchor of local coordinates is the corner that was `min`; `object_point` counts along the box's own axes.
/// `uv` run from 0 to 1 across each face, v upward along the second axis (on the faces 2 and 3 along the third:
/// away from the face 5, and towards it), u to the right as seen from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// Its planes; of a turned one infinite ones, so that nothing is certain of it by these.
    planes: Planes,
    turn: Option<Turn>,
}

/// A turned box fills `0 <= axes . (p - corner) <= size`: `min` is zero and `max` the size.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Turn {
    /// Where the corner `min` is.
    corner: DVec3,
    /// The box's own axes in the world.
    axes: [DVec3; 3],
    size: DVec3,
}

const WORLD: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];

impl Cuboid {
    /// The box between two corners.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::OutOfRange`] for coordinates beyond 1e150, [`Error::Unordered`] unless
    /// `min <= max` in each coordinate.
    pub fn new(min: impl Into<DVec3>, max: impl Into<DVec3>) -> Result<Self, Error> {
        let min = checked_point("cuboid corner", min.into())?;
        let max = checked_point("cuboid corner", max.into())?;
        if !min.cmple(max).all() {
            return Err(Error::Unordered { min, max });
        }
        Ok(Cuboid { planes: Cuboid::planes(min, max), turn: None })
    }

    #[inline(always)]
    fn min(&self) -> DVec3 {
        let [_, x, y, z] = self.planes.0[0];
        if self.turn.is_some() { DVec3::ZERO } else { DVec3::new(x, y, z) }
    }

    #[inline(always)]
    fn max(&self) -> DVec3 {
        let [_, x, y, z] = self.planes.0[1];
        self.turn.as_ref().map_or(DVec3::new(x, y, z), |turn| turn.size)
    }

    /// As it keeps its planes.
    fn planes(min: DVec3, max: DVec3) -> Planes {
        Planes([[min.x, min.x, min.y, min.z], [max.x, max.x, max.y, max.z]])
    }

    /// The corner that was given as the least, in the world: the anchor of local coordinates.
    pub fn corner(&self) -> DVec3 {
        self.turn.map_or(self.min(), |turn| turn.corner)
    }

    /// The lengths of the edges along the box's own axes.
    pub fn size(&self) -> DVec3 {
        self.max() - self.min()
    }

    /// The box's own axes in the world, as unit vectors.
    pub fn axes(&self) -> [DVec3; 3] {
        self.turn.map_or(WORLD, |turn| turn.axes)
    }

    /// Scaled, turned and moved. A turn makes it an oriented box.
    ///
    /// # Errors
    /// As [`Cuboid::new`].
    pub fn transformed(&self, by: &Similarity) -> Result<Self, Error> {
        if self.turn.is_none() && by.rotation() == DMat3::IDENTITY {
            return Cuboid::new(by.point(self.min()), by.point(self.max()));
        }
        let corner = checked_point("cuboid corner", by.point(self.corner()))?;
        let size = checked_point("cuboid size", self.size() * by.scale())?;
        let axes = self.axes().map(|axis| flat::unit(flat::doubles(by.direction(axis))));
        let planes = Cuboid::planes(DVec3::NEG_INFINITY, DVec3::INFINITY);
        Ok(Cuboid { planes, turn: Some(Turn { corner, axes, size }) })
    }

    /// Both crossings with the line, in double-double: which faces and where, for the rays in doubt.
    #[cold]
    #[inline(never)]
    fn span_exactly(&self, ray: &Ray) -> Option<[Crossing; 2]> {
        if !ray.is_valid() { None } else { run(Span { cuboid: self, ray }) }
    }

    /// The first crossing with a box along the world's axes, where a few comparisons can tell: what [`Slabs::first`] finds, to
    /// the bit, and nothing beside or behind.
    ///
    /// Each parameter errs by 7 u of itself at most: u from the difference, u from the product, 4 u from the inverse, which
    /// loses two digits where the direction is beyond 2^1022. Positive numbers are ordered like their bits, and 7 u are 7 of
    /// their steps at most. So two whose bits are [`STEPS`] apart are in order, with negative ones below all. What underflows
    /// is below [`TINY`].
    ///
    /// Along an axis in which the ray does not move it lies between the planes, where the parameters are infinities that
    /// decide nothing, or beside them, where both are one infinity. The inverse of a subnormal number may be infinite too, and
    /// within a plane a parameter is NaN: then no crossing is certain, and no miss but by two numbers.
    #[inline(always)]
    fn plainly<S: SlabLanes>(&self, ray: &Ray, within: Interval) -> Result<Option<Hit>, ()> {
        let slabs = S::new(&self.planes, ray);
        let (entry, leave) = slabs.ends();
        let [first, until, begin] =
            [entry, lesser(leave, within.max), within.min].map(|t| t.to_bits() as i64);
        // As unsigned numbers, bits with that of the sign are the greatest. Less than this are negative numbers, and positive ones.
        let is_finite = |negative: i64| (negative as u64) < SIGN | INFINITY;
        if first > TINY {
            if first - STEPS > begin {
                // NaN may wrap: it is in doubt.
                if first.wrapping_add(STEPS) < until {
                    if within.min.is_nan() | within.max.is_nan() || slabs.are_doubtful() {
                        return Err(());
                    }
                    let place = PLACES[0][slabs.entered(STEPS) & 15][slabs.back() & 7].ok_or(())?;
                    return Ok(Some(Hit::at(entry, place)));
                } else if first - STEPS > until
                    && ((first < INFINITY as i64 && is_finite(until)) || !slabs.are_doubtful())
                {
                    return Ok(None);
                }
            }
            return Err(());
        }
        if begin >= 0 {
            if until < 0 {
                return if is_finite(until) || !slabs.are_doubtful() { Ok(None) } else { Err(()) };
            }
            // Neither of NaN nor of an end that is NaN.
            let is_behind = first as u64 > SIGN | TINY as u64;
            let end = within.max.to_bits() as i64;
            if is_behind && until > TINY && until - STEPS > begin && end - until > STEPS {
                if slabs.are_doubtful() {
                    return Err(());
                }
                let place = PLACES[1][slabs.left(STEPS) & 15][slabs.back() & 7].ok_or(())?;
                return Ok(Some(Hit::at(leave, place)));
            }
        }
        Err(())
    }

    /// The first crossing of a turned box, or one that is not easily told.
    #[inline(never)]
    fn hit_closely(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        match self.slabs(ray).first(within) {
            Ok(hit) => hit,
            Err(()) => self.hit_exactly(ray, within),
        }
    }

    /// The first crossing, when `f64` leaves a doubt. An interval that ends exactly at a parameter that `f64` gives
    /// was made from that hit, and does not contain it.
    #[cold]
    #[inline(never)]
    fn hit_exactly(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let [near, _] = self.span_exactly(ray)?;
        let slabs = self.slabs(ray);
        let (entry, _) = slabs.ends();
        let ended = slabs.sound && (entry == within.min || entry == within.max);
        let first = if ended { None } else { within.admit(near.t, near.face, 0) };
        first.or_else(|| self.exit(ray, within))
    }

    /// Where a line that enters the box leaves it, if that is inside the interval.
    fn exit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let slabs = self.slabs(ray);
        let (entry, leave) = slabs.ends();
        if slabs.decides(entry, leave)
            && let Ok(hit) = slabs.admit(leave, false, within)
        {
            return hit;
        }
        let [_, far] = self.span_exactly(ray)?;
        let ended = slabs.sound && (leave == within.min || leave == within.max);
        if ended { None } else { within.admit(far.t, far.face, 1) }
    }

    #[inline(always)]
    fn slabs(&self, ray: &Ray) -> Slabs {
        match &self.turn {
            None => self.span(ray),
            Some(turn) => self.span_turned(turn, ray),
        }
    }

    /// The crossings with a box along the world's axes.
    #[inline(always)]
    fn span(&self, ray: &Ray) -> Slabs {
        let inverse = 1.0 / ray.direction;
        let a = (self.min() - ray.origin) * inverse;
        let b = (self.max() - ray.origin) * inverse;
        // Differences, quotients and products round three times; the fourth u pays for second order terms. Along an
        // axis in which the ray does not move it lies between the planes or beside them: both parameters are infinite.
        // Quotients of denormal directions, and a ray within a plane (0 times infinity), are left to exact arithmetic.
        let size = ray.direction.abs();
        let least = lesser(size.x, lesser(size.y, size.z));
        let sound = size.x + size.y + size.z < exp2i(1000)
            && ((least > exp2i(-1000) && (a.x + a.y + a.z).is_finite()) || {
                let moves =
                    |d: f64, a: f64, b: f64| (d > exp2i(-1000) || d == 0.0) && !a.is_nan() && !b.is_nan();
                moves(size.x, a.x, b.x) && moves(size.y, a.y, b.y) && moves(size.z, a.z, b.z)
            });
        Slabs { a, b, slack: LEAST_CERTAIN, sound, backward: inverse }
    }

    /// The crossings with a turned box.
    #[inline(always)]
    fn span_turned(&self, turn: &Turn, ray: &Ray) -> Slabs {
        let (w, d) = (ray.origin - turn.corner, ray.direction);
        let along = |v: DVec3| DVec3::new(turn.axes[0].dot(v), turn.axes[1].dot(v), turn.axes[2].dot(v));
        let (start, inverse) = (along(w), 1.0 / along(d));
        let a = (self.min() - start) * inverse;
        let b = (self.max() - start) * inverse;
        // With axes of length 1, the start errs by 4 u |w| (1-norm), the direction by 3 u |d|; then as above.
        let (w, v) = (w.abs(), d.abs());
        let lengths = (5.0 * U) * (w.x + w.y + w.z);
        let turned = (4.0 * U) * (v.x + v.y + v.z) * a.abs().max(b.abs());
        let error = (turned + lengths) * inverse.abs();
        let reach = v.x + v.y + v.z;
        let sound = reach > exp2i(-900) && reach < exp2i(1000);
        let slack = greater(error.x, greater(error.y, error.z)) + LEAST_CERTAIN;
        Slabs { a, b, slack, sound, backward: inverse }
    }
}

/// The parameters of the planes of the faces; each errs by `slack + 4 u |t|` at most.
struct Slabs {
    a: DVec3,
    b: DVec3,
    slack: f64,
    sound: bool,
    /// Of the sign of the direction.
    backward: DVec3,
}

impl Slabs {
    /// Where the line enters and leaves.
    #[inline(always)]
    fn ends(&self) -> (f64, f64) {
        let (a, b) = (self.a, self.b);
        let entry = greater(lesser(a.x, b.x), greater(lesser(a.y, b.y), lesser(a.z, b.z)));
        let leave = lesser(greater(a.x, b.x), lesser(greater(a.y, b.y), greater(a.z, b.z)));
        (entry, leave)
    }

    /// Two parameters that err by 4 u of themselves can only be out of order when each is within 9 u of the other.
    #[inline(always)]
    fn doubt(&self, t: f64) -> f64 {
        (9.0 * U) * t.abs() + 2.0 * self.slack
    }

    /// Whether the order of the two, and thus whether the line enters, is certain: the smaller parameter, which is finite when the other is
    /// infinite, tells how far apart the two have to be.
    #[inline(always)]
    fn decides(&self, entry: f64, leave: f64) -> bool {
        self.sound & ((entry - leave).abs() > self.doubt(lesser(entry.abs(), leave.abs())))
    }

    /// The face of the greatest `near`, or least `far`, parameter `t`; `None` when it could be two.
    #[inline(always)]
    fn face(&self, t: f64, enters: bool) -> Option<u32> {
        let (a, b, doubt) = (self.a, self.b, self.doubt(t));
        let is_at = |a: f64, b: f64| {
            let plane = if enters { lesser(a, b) } else { greater(a, b) };
            ((plane - t).abs() <= doubt) as u32
        };
        let at = is_at(a.x, b.x) | is_at(a.y, b.y) << 1 | is_at(a.z, b.z) << 2;
        let backward = (self.backward.x < 0.0) as u32
            | ((self.backward.y < 0.0) as u32) << 1
            | ((self.backward.z < 0.0) as u32) << 2;
        // One bit alone: 1, 2 and 4 stand for the axes 0, 1 and 2.
        let upper = (at & backward != 0) == enters;
        (at & at.wrapping_sub(1) == 0).then_some((at & !1) + upper as u32)
    }

    /// The crossing at `t` when it is certain on which sides of the ends of the interval it lies, and which face it
    /// is; `Err` in doubt.
    #[inline(always)]
    fn admit(&self, t: f64, enters: bool, within: Interval) -> Result<Option<Hit>, ()> {
        let doubt = self.doubt(t);
        if !(((t - within.min).abs() > doubt) & ((t - within.max).abs() > doubt)) {
            return Err(());
        }
        if !within.contains(t) {
            return Ok(None);
        }
        let face = self.face(t, enters).ok_or(())?;
        Ok(within.admit(t, face, !enters as u32))
    }

    /// The first crossing; `Err` in doubt.
    #[inline(always)]
    fn first(&self, within: Interval) -> Result<Option<Hit>, ()> {
        let (entry, leave) = self.ends();
        if !self.decides(entry, leave) {
            return Err(());
        }
        if entry > leave {
            return Ok(None);
        }
        if entry > within.min {
            self.admit(entry, true, within)
        } else if within.min - entry > self.doubt(entry) {
            self.admit(leave, false, within)
        } else {
            Err(())
        }
    }
}

/// Face and root of a crossing, by whether it leaves, the only pair of planes it may be of, and the axes along which the
/// direction goes back; nothing for several pairs.
static PLACES: [[[Option<NonZeroU64>; 8]; 16]; 2] = {
    let mut places = [[[None; 8]; 16]; 2];
    let pairs = [3, 4, 8];
    let mut case = 0;
    while case < 2 * 3 * 8 {
        let (leaves, axis, backs) = (case % 2, case / 2 % 3, case / 6);
        let upper = (backs >> axis & 1) ^ leaves;
        places[leaves][pairs[axis]][backs] = Hit::place((2 * axis + upper) as u32, leaves as u32);
        case += 1;
    }
    places
};

/// More than two parameters err together, in steps between neighbouring numbers, and two roundings.
const STEPS: i64 = 16;

/// More than all that underflow can take: the bits of 2^-900.
const TINY: i64 = (1023 - 900) << 52;

/// The bits of a sign, and of infinity.
const SIGN: u64 = 1 << 63;
const INFINITY: u64 = 0x7ff << 52;

/// One crossing of the line: the face, and the parameter correctly rounded.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    t: f64,
    face: u32,
}

/// A parameter as a fraction: `2^power * numerator / denominator`, the denominator positive. Both are 0 or of a size in
/// `[1, 2)`, so that no product of theirs leaves the range of numbers.
#[derive(Clone, Copy, Debug)]
struct Fraction {
    numerator: Double,
    denominator: Double,
    power: i32,
    face: u32,
}

impl Fraction {
    /// `2^power * numerator / denominator`.
    #[inline(always)]
    fn new(numerator: Double, denominator: Double, power: i32, face: u32) -> Self {
        let (numerator, over) = normalized(numerator);
        let (denominator, under) = normalized(denominator);
        Fraction { numerator, denominator, power: power + over - under, face }
    }

    /// The order of two fractions, exactly.
    #[inline(always)]
    fn order<P: Product>(&self, other: &Fraction) -> Ordering {
        let (a, b) = (self.numerator.high, other.numerator.high);
        let sign = |x: f64| (x > 0.0) as i32 - (x < 0.0) as i32;
        if a == 0.0 || sign(a) != sign(b) {
            return sign(a).cmp(&sign(b));
        }
        // Quotients of numbers in [1, 2) differ by less than a factor of 4.
        let lead = self.power - other.power;
        if lead.abs() > 2 {
            return if a > 0.0 { lead.cmp(&0) } else { 0.cmp(&lead) };
        }
        let mut difference = Expansion::ZERO;
        difference.add_double_product::<P>(self.numerator.scale_exact(exp2i(lead)), other.denominator);
        difference.add_double_product::<P>(-other.numerator, self.denominator);
        difference.sign().cmp(&0)
    }
}

/// The number divided by a power of two that leaves a size in `[1, 2)`, and which; zero as it is.
#[inline(always)]
fn normalized(x: Double) -> (Double, i32) {
    // Twice, since a subnormal number shows no exponent; 2^52 makes it a normal one.
    let by = |x: Double, k: i32| Double { high: times_power(x.high, k), low: times_power(x.low, k) };
    let lift = if exponent(x.high) < -1022 { 52 } else { 0 };
    let lifted = by(x, lift);
    if lifted.high == 0.0 {
        return (x, 0);
    }
    let power = exponent(lifted.high);
    (by(lifted, -power), power - lift)
}

/// Where the line enters and leaves the box.
struct Span<'a> {
    cuboid: &'a Cuboid,
    ray: &'a Ray,
}

impl Task for Span<'_> {
    type Output = Option<[Crossing; 2]>;
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        let (min, max, turn) = (self.cuboid.min(), self.cuboid.max(), &self.cuboid.turn);
        let Ray { origin: o, direction: d } = *self.ray;
        // The axes of a turned box mix the components, in units of the largest ones.
        let (direction, direction_power) = flat::prescaled(d);
        let power = flat::power_of((self.cuboid.corner() - o).abs().max(max - min));
        let scale = exp2i(-power);
        let (mut near, mut far): (Option<Fraction>, Option<Fraction>) = (None, None);
        for i in 0..3 {
            let (low, high, along, power) = match turn {
                None => {
                    let ends = (Double::difference(min[i], o[i]), Double::difference(max[i], o[i]));
                    (ends.0, ends.1, Double::from(d[i]), 0)
                }
                Some(turn) => {
                    let (low, high, along) = turned_slab::<P>(turn, i, max[i], o, direction, scale);
                    (low, high, along, power - direction_power)
                }
            };
            let sign = along.high;
            if sign == 0.0 {
                if low.high > 0.0 || high.high < 0.0 {
                    return None;
                }
                continue;
            }
            let (first, second, denominator) =
                if sign > 0.0 { (low, high, along) } else { (-high, -low, -along) };
            let back = (sign < 0.0) as u32;
            let entry = Fraction::new(first, denominator, power, 2 * i as u32 + back);
            let exit = Fraction::new(second, denominator, power, 2 * i as u32 + 1 - back);
            if near.is_none_or(|near| entry.order::<P>(&near).is_gt()) {
                near = Some(entry);
            }
            if far.is_none_or(|far| exit.order::<P>(&far).is_lt()) {
                far = Some(exit);
            }
        }
        let (near, far) = (near?, far?);
        // Equal parameters on two pairs of faces: an edge is touched. On one pair: the box is flat, and crossed.
        let flat_pair = near.face / 2 == far.face / 2;
        match near.order::<P>(&far) {
            Ordering::Less => {}
            Ordering::Equal if flat_pair => {}
            _ => return None,
        }
        let crossing = |f: Fraction| Crossing {
            t: times_power(f.numerator.div::<P>(f.denominator).to_f64(), f.power),
            face: f.face,
        };
        Some([crossing(near), crossing(far)])
    }
}

/// A slab of a turned box: what is left to its two planes, and the speed across, each within 2^-104 of itself.
#[inline(always)]
fn turned_slab<P: Product>(
    turn: &Turn,
    i: usize,
    size: f64,
    o: DVec3,
    d: DVec3,
    scale: f64,
) -> (Double, Double, Double) {
    let (mut low, mut along) = (Expansion::ZERO, Expansion::ZERO);
    for k in 0..3 {
        let axis = turn.axes[i][k];
        low.add_double_product::<P>(
            Double::from(axis),
            Double::difference(turn.corner[k], o[k]).scale_exact(scale),
        );
        along.add_product::<P>(axis, d[k]);
    }
    let mut high = low;
    high.add(size * scale);
    (low.rounded(), high.rounded(), along.rounded())
}

/// A face of a box, by the index of its part.
struct Face<'a> {
    cuboid: &'a Cuboid,
    part: u32,
    /// The axis across it, and whether it is the upper one.
    k: usize,
    upper: bool,
}

impl Face<'_> {
    #[inline(always)]
    fn new(cuboid: &Cuboid, part: u32) -> Face<'_> {
        let part = part.min(5);
        Face { cuboid, part, k: (part / 2) as usize, upper: part % 2 == 1 }
    }

    #[inline(always)]
    fn axis(&self) -> DVec3 {
        self.cuboid.turn.as_ref().map_or(&WORLD, |turn| &turn.axes)[self.k]
    }

    #[inline(always)]
    fn normal(&self) -> DVec3 {
        if self.upper { self.axis() } else { -self.axis() }
    }
}

impl Piece for Face<'_> {
    /// Along the world's axes the plane of a face goes through a coordinate given; turned, it lies `size` away.
    #[inline(always)]
    fn plane(&self) -> ExactPlane {
        let (min, max, turn) = (self.cuboid.min(), self.cuboid.max(), &self.cuboid.turn);
        let k = self.k;
        match turn {
            None => ExactPlane {
                anchor: if self.upper { min.with_axis(k, coordinate(max, k)) } else { min },
                normal: flat::doubles(WORLD[k]),
                axis: Some(k as u8),
                offset: 0.0,
            },
            Some(turn) => ExactPlane {
                anchor: turn.corner,
                normal: flat::doubles(turn.axes[k]),
                axis: None,
                offset: if self.upper { coordinate(max, k) } else { 0.0 },
            },
        }
    }

    fn exact_normal(&self) -> [Expansion; 3] {
        flat::expansions(self.axis())
    }

    #[inline(always)]
    fn record<P: Product>(&self, at: &Meeting) -> Surface {
        let (min, max, turn) = (self.cuboid.min(), self.cuboid.max(), &self.cuboid.turn);
        let size = max - min;
        let across = if self.upper { coordinate(size, self.k) } else { 0.0 };
        // The hit is on the face; what double-double leaves beside it is noise.
        let on_face = |p: DVec3| flat::clamped(p.with_axis(self.k, across), DVec3::ZERO, size);
        let (point, local, object_point) = match turn {
            None => {
                let local = on_face(at.local());
                (flat::clamped(at.point(self.plane().anchor), min, max), local, local)
            }
            Some(turn) => {
                let along =
                    |axis: DVec3| meeting::dot::<P, f64>(&at.local, &flat::doubles(axis), 0.0).0.to_f64();
                let [x, y, z] = turn.axes;
                let own = DVec3::new(along(x), along(y), along(z)) * exp2i(at.power);
                (at.point(turn.corner), at.local(), on_face(own))
            }
        };
        Surface::new(at.t, point, local, self.normal(), at.error_radius(point))
            .with_object_point(object_point)
            .with_uv(face_uv(self.part, object_point, size))
    }

    fn parallel(&self, _: &Ray, hit: Hit) -> Surface {
        let (min, max) = (self.cuboid.min(), self.cuboid.max());
        Surface::new(hit.t(), self.cuboid.corner(), DVec3::ZERO, self.normal(), (max - min).length())
    }
}

impl Clipped for Cuboid {
    #[inline(always)]
    fn clipped<S: SlabLanes>(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        match self.plainly::<S>(ray, within) {
            Ok(hit) => hit,
            Err(()) => self.hit_closely(ray, within),
        }
    }
}

impl Primitive for Cuboid {
    #[inline]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        clip(self, ray, within)
    }

    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        // The first is what `hit` says, to the bit, whatever the doubt about the second.
        let Some(first) = self.hit(ray, within) else { return };
        each(first);
        if first.root() == 0
            && let Some(exit) = self.exit(ray, within)
        {
            each(exit);
        }
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        meeting::surface(&Face::new(self, hit.part()), ray, hit)
    }

    fn bounds(&self) -> Option<Aabb> {
        let Some(turn) = &self.turn else {
            return Some(flat::outward(DVec3::ZERO, self.min(), self.max()));
        };
        let (mut least, mut most) = (DVec3::ZERO, DVec3::ZERO);
        for (axis, size) in turn.axes.iter().zip(self.max().to_array()) {
            let edge = *axis * size;
            least += edge.min(DVec3::ZERO);
            most += edge.max(DVec3::ZERO);
        }
        // The planes meet where the dual axes say: those of rounded unit axes differ by a few u from the axes
        // themselves. Products and sums round by 3 u of the size.
        let slack = DVec3::splat(16.0 * U * self.max().element_sum());
        Some(flat::outward(turn.corner, least - slack, most + slack))
    }

    /// A box is convex: a ray that leaves it outward never returns; one that goes inside leaves through one of
    /// the other faces, for certain.
    fn hit_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Hit> {
        if from.side == Side::Outside || !ray.is_valid() {
            return None;
        }
        let axes = self.axes();
        let size = self.size();
        let mut exit: Option<(f64, u32)> = None;
        for k in 0..3 {
            let (start, speed) = (axes[k].dot(from.local), axes[k].dot(ray.direction));
            let face = 2 * k as u32 + (speed > 0.0) as u32;
            if speed == 0.0 || face == from.part {
                continue;
            }
            let way = if speed > 0.0 { size[k] - start } else { -start };
            let t = way / speed;
            if exit.is_none_or(|(least, _)| t < least) {
                exit = Some((t, face));
            }
        }
        let (t, face) = exit.unwrap_or((0.0, from.part));
        // The start may lie beyond the exit by rounding: the exit is then where the ray starts.
        let least = if within.min < 0.0 { 0.0 } else { f64::from_bits(1) };
        let t = if t > 0.0 { t } else { least };
        within.admit(t, face, 1)
    }

    fn crossings_leaving(&self, ray: &Ray, within: Interval, from: &Departure, each: &mut dyn FnMut(Hit)) {
        if let Some(hit) = self.hit_leaving(ray, within, from) {
            each(hit);
        }
    }
}

/// Texture coordinates on a face.
fn face_uv(face: u32, p: DVec3, size: DVec3) -> DVec2 {
    let part = |i: usize| if size[i] > 0.0 { p[i] / size[i] } else { 0.0 };
    let (x, y, z) = (part(0), part(1), part(2));
    match face {
        0 => DVec2::new(z, y),
        1 => DVec2::new(1.0 - z, y),
        2 => DVec2::new(x, z),
        3 => DVec2::new(x, 1.0 - z),
        4 => DVec2::new(1.0 - x, y),
        _ => DVec2::new(x, y),
    }
}

/// A vector with one coordinate replaced.
trait WithAxis {
    fn with_axis(self, k: usize, value: f64) -> Self;
}

impl WithAxis for DVec3 {
    #[inline(always)]
    fn with_axis(self, k: usize, value: f64) -> Self {
        let pick = |i: usize, keep: f64| if i == k { value } else { keep };
        DVec3::new(pick(0, self.x), pick(1, self.y), pick(2, self.z))
    }
}

/// One coordinate.
#[inline(always)]
fn coordinate(v: DVec3, k: usize) -> f64 {
    match k {
        0 => v.x,
        1 => v.y,
        _ => v.z,
    }
}
#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::PairedSlabs;

    #[test]
    fn crossings_begin_with_the_hit_where_the_exit_is_in_doubt() {
        // The line leaves so near an edge that the face takes exact arithmetic; entering does not.
        let cuboid = Cuboid::new(
            [-3.0, -1.8107252369725184e18, -2.499999999999995],
            [-1.0000000000001295, 1.5, 1e-140],
        );
        let cuboid = cuboid.unwrap();
        let ray =
            Ray::new([-2.5, -3.5, 3.0000000000000013], [-3.125, -3.124999999999985, 1.1621328335824573e256]);
        let mut all = alloc::vec::Vec::new();
        cuboid.crossings(&ray, Interval::LINE, &mut |hit| all.push(hit));
        assert_eq!(all.len(), 2);
        assert_eq!(cuboid.hit(&ray, Interval::LINE), Some(all[0]));
        // Nor is a hit reported again by an interval that starts with it.
        assert_eq!(cuboid.hit(&ray, Interval::LINE.after(all[0].t())), Some(all[1]));
    }

    fn unit() -> Cuboid {
        Cuboid::new([0.0; 3], [1.0; 3]).unwrap()
    }

    fn faces(cuboid: &Cuboid, ray: &Ray) -> Vec<(f64, u32)> {
        let mut found = Vec::new();
        cuboid.crossings(ray, Interval::LINE, &mut |hit| found.push((hit.t(), hit.part())));
        found
    }

    #[test]
    fn faces_are_numbered_by_axis_and_side() {
        for k in 0..3 {
            let axis = DVec3::AXES[k];
            let ray = Ray::new(DVec3::splat(0.5) - axis * 2.0, axis);
            assert_eq!(faces(&unit(), &ray), [(1.5, 2 * k as u32), (2.5, 2 * k as u32 + 1)]);
            let hit = unit().hit(&ray, Interval::FORWARD).unwrap();
            assert_eq!(unit().surface(&ray, hit).normal, -axis);
            let back = unit().hit(&ray, Interval::new(2.0, 9.0)).unwrap();
            assert_eq!((back.part(), back.root()), (2 * k as u32 + 1, 1));
        }
    }

    #[test]
    fn a_touched_edge_is_no_hit_but_a_face_is_not_lost() {
        // Past the edge x = 0, y = 1, at 45 degrees.
        let touching = Ray::new([-1.0, 0.0, 0.5], [1.0, 1.0, 0.0]);
        assert_eq!(faces(&unit(), &touching), []);
        assert_eq!(faces(&unit(), &Ray::new([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0])).len(), 2);
        // Along the face x = 0: zero times infinity.
        for zero in [0.0, -0.0] {
            let along = Ray::new([0.0, 0.5, -1.0], [zero, zero, 1.0]);
            assert_eq!(faces(&unit(), &along), [(1.0, 4), (2.0, 5)]);
            assert_eq!(unit().hit(&along, Interval::FORWARD).map(|h| h.t()), Some(1.0));
        }
        assert_eq!(faces(&unit(), &Ray::new([-f64::MIN_POSITIVE, 0.5, -1.0], [0.0, 0.0, 1.0])), []);
    }

    #[test]
    fn a_flat_box_is_hit_from_both_sides() {
        let tile = Cuboid::new([0.0, 2.0, 0.0], [1.0, 2.0, 1.0]).unwrap();
        let down = Ray::new([0.5, 3.0, 0.5], [0.0, -1.0, 0.0]);
        assert_eq!(tile.hit(&down, Interval::FORWARD).map(|h| (h.t(), h.part())), Some((1.0, 3)));
        assert_eq!(faces(&tile, &down), [(1.0, 3), (1.0, 2)]);
    }

    #[test]
    fn a_turned_box_keeps_its_own_axes() {
        let turn =
            Similarity::IDENTITY.rotated(DVec3::Z, 90.0).unwrap().translated([10.0, 0.0, 0.0]).unwrap();
        let cuboid = Cuboid::new([0.0; 3], [1.0, 2.0, 3.0]).unwrap().transformed(&turn).unwrap();
        assert_eq!(cuboid.axes(), [DVec3::Y, -DVec3::X, DVec3::Z]);
        // In the world it fills x from 8 to 10, y from 0 to 1: its own x axis is the world's y.
        let ray = Ray::new([9.5, -4.0, 1.0], [0.0, 2.0, 0.0]);
        let hit = cuboid.hit(&ray, Interval::FORWARD).unwrap();
        let surface = cuboid.surface(&ray, hit);
        assert_eq!((surface.t, hit.part(), surface.normal), (2.0, 0, -DVec3::Y));
        assert_eq!(surface.object_point, DVec3::new(0.0, 0.5, 1.0));
    }

    #[test]
    fn leaving_inside_always_ends() {
        let ray = Ray::new([0.5, 0.5, -1.0], [0.0, 0.0, 1.0]);
        let hit = unit().hit(&ray, Interval::FORWARD).unwrap();
        let from = unit().surface(&ray, hit).departure(0, hit, Side::Inside);
        let (start, within) = from.through(ray.direction);
        let exit = unit().hit_leaving(&start, within, &from).unwrap();
        assert_eq!((exit.t(), exit.part()), (1.0, 5));
        let outward = unit().surface(&ray, hit).departure(0, hit, Side::Outside);
        assert_eq!(unit().hit_leaving(&start, within, &outward), None);
    }

    #[test]
    fn exactly_and_plainly_the_same_faces() {
        let mut random = crate::testing::Random::new(7);
        let turned = Similarity::IDENTITY.rotated(DVec3::ONE, 40.0).unwrap();
        let mut crossed = 0;
        for case in 0..2000 {
            let (a, b) = (random.in_cube(), random.in_cube());
            let cuboid = Cuboid::new(a.min(b), a.max(b)).unwrap();
            let cuboid = if case % 2 == 0 { cuboid } else { cuboid.transformed(&turned).unwrap() };
            let origin = random.in_cube() * 2.0;
            let aim = (a + b) * 0.5 + random.in_cube() * 0.3;
            let ray = Ray::new(origin, (aim - origin) * random.magnitude(-300.0, 300.0));
            let exact = cuboid.span_exactly(&ray);
            let exact: Vec<_> = exact.iter().flatten().map(|crossing| crossing.face).collect();
            let plain: Vec<_> = faces(&cuboid, &ray).iter().map(|&(_, face)| face).collect();
            assert_eq!(exact, plain, "{cuboid:?} {ray:?}");
            crossed += plain.len();
        }
        assert!(crossed > 1000, "{crossed}");
    }

    #[test]
    fn passed_by_at_any_speed() {
        // Beside the box in y, moving along z by 2^1022 a unit of the parameter.
        let cuboid =
            Cuboid::new([-30.75, 73.9921875, 58.0234375], [30.24999487400055, 84.19921875, 127.8515625])
                .unwrap();
        let ray = Ray::new(
            [-23.000000000002927, 105.609375, -4.6072862477343016e36],
            [-5.0000001192092896, 74.92578125, 9.205637315716674e307],
        );
        assert_eq!(faces(&cuboid, &ray), []);
    }

    /// Numbers that are none, also those with the greatest bits, which arithmetic with bits may overflow at.
    #[test]
    fn nothing_is_hit_by_what_is_no_number() {
        let cuboid = Cuboid::new([-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]).unwrap();
        let bits =
            [u64::MAX, u64::MAX >> 1, (u64::MAX >> 1) - 6, 0x7ff0_0000_0000_0001, 0x7ff8 << 48, 0xfff8 << 48];
        // From outside, from inside, and beside it.
        for origin in [[0.25, 0.5, 9.0], [0.25, 0.5, 1.0], [5.0, 0.5, 1.0]] {
            for place in 0..8 {
                for none in bits.map(f64::from_bits) {
                    let [mut o, mut d, mut ends] = [origin, [0.125, 0.0, -1.0], [0.0, f64::INFINITY, 0.0]];
                    match place {
                        0..3 => o[place] = none,
                        3..6 => d[place - 3] = none,
                        _ => ends[place - 6] = none,
                    }
                    let (ray, within) = (Ray::new(o, d), Interval::new(ends[0], ends[1]));
                    assert_eq!(cuboid.hit(&ray, within), None, "{ray:?} {within:?} {:x}", none.to_bits());
                    assert_eq!(cuboid.clipped::<PairedSlabs>(&ray, within), None, "{ray:?} {within:?}");
                    cuboid.crossings(&ray, within, &mut |hit| panic!("{ray:?} {within:?} {hit:?}"));
                }
            }
        }
    }

    #[test]
    fn constructor_errors() {
        assert!(matches!(Cuboid::new([1.0, 0.0, 0.0], [0.0, 1.0, 1.0]), Err(Error::Unordered { .. })));
        assert!(matches!(Cuboid::new([f64::NAN; 3], [1.0; 3]), Err(Error::NotFinite { .. })));
    }

    /// By the few comparisons, the same in all lanes: crossings for certain, misses where either kind tells.
    fn plainly(cuboid: &Cuboid, ray: &Ray, within: Interval) -> Result<Option<Hit>, ()> {
        let found = cuboid.plainly::<PairedSlabs>(ray, within);
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        if crate::kernel::level() >= crate::kernel::Level::Avx2 {
            let wide = cuboid.plainly::<crate::kernel::WideSlabs>(ray, within);
            assert_eq!(found.ok().flatten(), wide.ok().flatten(), "{cuboid:?} {ray:?} {within:?}");
            return found.or(wide);
        }
        found
    }

    /// What must not become slow unseen, and must be the same: the few comparisons answer nearly all plain rays, as the
    /// slabs do; also rays along axes and within planes, and intervals that end at the very crossings.
    #[test]
    fn plainly_as_by_slabs() {
        let mut random = crate::testing::Random::new(1);
        let mut count = [[0_u32; 2]; 3];
        for case in 0..12_000 {
            let (min, max) = (random.in_cube() - 1.5, random.in_cube() + 1.5);
            let cuboid = Cuboid::new(min, max).unwrap();
            let inside = min + (random.in_cube() * 0.49 + 0.5) * (max - min);
            let mut direction = random.direction();
            let mut origin = inside + random.direction() * random.uniform(0.0, 6.0);
            if !random.once_in(3) {
                // Aimed.
                direction = inside - origin;
            }
            let kind = case % 3;
            if kind > 0 {
                direction[case / 3 % 3] = 0.0 * random.sign();
                if kind == 2 {
                    direction = DVec3::AXES[case / 3 % 3] * random.sign() + 0.0 * random.sign();
                }
                origin = if random.once_in(8) { min } else { origin };
            }
            let ray = Ray::new(origin, direction);
            let (entry, leave) = cuboid.span(&ray).ends();
            let mut end = || match random.below(4) {
                0 => entry,
                1 => leave,
                2 => 0.0,
                _ => random.uniform(-9.0, 9.0),
            };
            let all = [Interval::LINE, Interval::FORWARD, Interval::new(end(), end())];
            for (number, within) in all.into_iter().enumerate() {
                let found = plainly(&cuboid, &ray, within);
                if let (Ok(found), Ok(other)) = (found, cuboid.span(&ray).first(within)) {
                    assert_eq!(found, other, "{cuboid:?} {ray:?} {within:?}");
                } else if let Ok(found) = found {
                    assert_eq!(found, cuboid.hit_exactly(&ray, within), "{cuboid:?} {ray:?} {within:?}");
                }
                // Behind the origin the slabs are to tell.
                let told = found.is_ok() || number == 0 && cuboid.span(&ray).first(within).is_ok();
                if number < 2 {
                    count[kind][usize::from(told)] += 1;
                }
            }
        }
        let most = [0.03, 0.14, 0.65];
        let few = |([left, told], most): ([u32; 2], f64)| f64::from(left) < most * f64::from(left + told);
        assert!(count.into_iter().zip(most).all(few), "{count:?}");
    }

    /// What must not become slow unseen, and must be true: the slabs of turned boxes tell nearly all plain crossings; and of
    /// directions at the end of the range of `f64` neither way tells anything that exact arithmetic does not.
    #[test]
    fn slabs_of_turned_boxes_and_of_extreme_directions() {
        let mut random = crate::testing::Random::new(2);
        let key = |hit: Hit| (hit.part(), hit.root());
        let t = |hit: Option<Hit>| hit.map_or(0.0, |hit| hit.t());
        let mut count = [0_u32; 2];
        for _ in 0..3000 {
            let cuboid = Cuboid::new(random.in_cube() - 1.5, random.in_cube() + 1.5).unwrap();
            let axis = random.direction();
            let by = Similarity::IDENTITY.rotated(axis, random.uniform(-180.0, 180.0)).unwrap();
            let turned = cuboid.transformed(&by).unwrap();
            let origin = random.direction() * random.uniform(3.0, 9.0);
            let ray = Ray::new(origin, random.in_cube() * 1.5 - origin);
            let first = turned.slabs(&ray).first(Interval::FORWARD);
            count[usize::from(first.is_ok())] += 1;
            if let Ok(first) = first {
                let exact = turned.hit_exactly(&ray, Interval::FORWARD);
                assert_eq!(first.map(key), exact.map(key), "{turned:?} {ray:?}");
                assert!((t(first) - t(exact)).abs() < 1e-12, "{turned:?} {ray:?}");
            }

            let mut direction = random.direction();
            for k in 0..3 {
                direction[k] *= [1.0, 1e-300, 1e300, 1.7e308][random.below(4) as usize];
            }
            let ray = Ray::new(origin, direction);
            if let Ok(found) = plainly(&cuboid, &ray, Interval::FORWARD) {
                let exact = cuboid.hit_exactly(&ray, Interval::FORWARD);
                assert_eq!(found.map(key), exact.map(key), "{cuboid:?} {ray:?}");
                assert!((t(found) - t(exact)).abs() <= 10.0 * U * t(exact), "{cuboid:?} {ray:?}");
            }
        }
        assert!(count[0] < 30 && count[1] > 2900, "{count:?}");
    }

    /// Every face has the whole unit square, seen from outside with `y` up (or `z` where there is no `y`).
    #[test]
    fn coordinates_of_the_faces() {
        let (corner, size) = (DVec3::new(1.0, -2.0, 3.0), DVec3::new(2.0, 4.0, 8.0));
        let cuboid = Cuboid::new(corner, corner + size).unwrap();
        let share = DVec3::new(0.25, 0.125, 0.375);
        let expected =
            [(0.375, 0.125), (0.625, 0.125), (0.25, 0.375), (0.25, 0.625), (0.75, 0.125), (0.25, 0.125)];
        for (face, (u, v)) in expected.into_iter().enumerate() {
            let out = DVec3::AXES[face / 2] * if face % 2 == 0 { -1.0 } else { 1.0 };
            let ray = Ray::new(corner + share * size + out * 20.0, -out);
            let hit = cuboid.hit(&ray, Interval::FORWARD).unwrap();
            let surface = cuboid.surface(&ray, hit);
            assert_eq!((hit.part(), surface.uv(), surface.normal), (face as u32, DVec2::new(u, v), out));
        }
    }
}
