//! Rays through one point, in small scenes: which objects lie in which direction from there.
//!
//! All rays from a camera begin at one point, all shadow rays of a lamp end at one. A [`DirectionCube`] about it holds,
//! for each of the small squares of its faces, the set of the objects whose boxes are seen through it: a ray then
//! needs no search at all. Source of the idea: Haines, Greenberg 1986, "The light buffer: a shadow-testing
//! accelerator" (doi:10.1109/MCG.1986.276832).
//!
//! # Why no hit is lost
//! Let `S` be 2^10 times the largest coordinate of the point and of all boxes. A ray whose origin is within `S` and that
//! passes the point but for roundings does so within 2^-50 S; what its hits err is less. An object at least
//! 2^-26 S away from the point is then seen at most 2^-24 of its distance from where the ray's direction says; in
//! coordinates on a face, which are at most 1, that is less than 2^-22. Every object is entered with a margin of 2^-16;
//! one that is nearer is entered everywhere. Rays from further away are not answered here.
//!
//! An object is entered where both its box and its [`Outline`] are seen. The corners of an outline err by less than 2^-50 of
//! `2^-10 S` and of the object's size; with a depth of at least 2^-20 S on the face that is far less than the margin, and
//! where a corner is less deep, the box alone counts.

use super::frame::{Window, Windows};
use super::outline::{Face, Outline};
use super::query::{Nearest, Path, Query, Screen};
use super::rings::AskFour;
use super::{Found, Geometry, frame, is_legal};
use crate::kernel::{Four, Lanes, Real, Vector, Vectorized, vectorize};
use crate::math::{exp2i, sqrt};
use crate::scaled::{largest, moderate};
use crate::shape::Torus;
use crate::{Departure, Hit, Interval, Primitive, Ray, Shape};
use alloc::vec::Vec;
use glam::DVec3;

/// Squares along the edge of a face: 0.7 degrees each.
const EDGE: usize = 128;

/// The most objects: one bit each.
const MOST_OBJECTS: usize = 64;

/// See the module.
const MARGIN: f64 = exp2i(-16);

/// The objects of a [`Geometry`] by their direction from a point: made by [`Geometry::cube_about`].
#[derive(Clone, Debug)]
pub struct DirectionCube {
    point: DVec3,
    /// Rays that begin beyond this are left to the tree.
    reach: f64,
    /// The objects, nearest first: a set of them is one bit each in this order.
    objects: Vec<u32>,
    /// In the same order, a lower bound of the distance.
    distances: Vec<f64>,
    /// By object: its bit.
    bits: Vec<u64>,
    /// The objects that are tori.
    rings: u64,
    /// Those that no ray meets that leaves them on the outside, and those that no ray meets that leaves them.
    convex: u64,
    flat: u64,
    /// The ties of rays that begin at the point.
    windows: Windows,
    /// Face after face, row after row.
    squares: Vec<u64>,
}

impl DirectionCube {
    /// The objects in this direction, one bit each.
    #[inline(always)]
    fn seen(&self, direction: DVec3) -> u64 {
        let size = direction.abs();
        let (axis, a, b, depth) = if size.x >= size.y && size.x >= size.z {
            (0, direction.y, direction.z, direction.x)
        } else if size.y >= size.z {
            (1, direction.z, direction.x, direction.y)
        } else {
            (2, direction.x, direction.y, direction.z)
        };
        let scale = (0.5 * EDGE as f64) / depth.abs();
        if !(scale < f64::INFINITY) {
            // A subnormal direction.
            return u64::MAX;
        }
        // From 0 to EDGE, as a cast does with anything.
        let place = |x: f64| ((x * scale + 0.5 * EDGE as f64) as usize).min(EDGE - 1);
        let face = 2 * axis + usize::from(depth < 0.0);
        self.squares.get((face * EDGE + place(b)) * EDGE + place(a)).copied().unwrap_or(u64::MAX)
    }

    /// The objects in each of four directions.
    #[inline(always)]
    fn seen_four<L: Lanes>(&self, d: Vector<Four<L>>) -> [u64; 4] {
        let (zero, half) = (d.x.all(0.0), d.x.all(0.5 * EDGE as f64));
        let (x, y, z) = (d.x.abs(), d.y.abs(), d.z.abs());
        // Of y and z; then of these and x.
        let first = Four::if_at_most(z, y, zero.all(2.0), zero.all(4.0));
        let size = Four::if_at_most(z, y, y, z);
        let depth = Four::if_at_most(z, y, d.y, d.z);
        let a = Four::if_at_most(z, y, d.z, d.x);
        let b = Four::if_at_most(z, y, d.x, d.y);
        let first = Four::if_at_most(size, x, zero, first);
        let depth = Four::if_at_most(size, x, d.x, depth);
        let a = Four::if_at_most(size, x, d.y, a);
        let b = Four::if_at_most(size, x, d.z, b);
        let face = Four::if_less(depth, zero, first + zero.all(1.0), first);
        let scale = half / depth.abs();
        let plain = scale.less(zero.all(f64::INFINITY));
        let last = zero.all((EDGE - 1) as f64);
        let (a, b) = (a * scale + half, b * scale + half);
        let (a, b) = (Four::if_less(a, last, a, last), Four::if_less(b, last, b, last));
        let (face, a, b) = (face.whole(), a.whole(), b.whole());
        let mut seen = [u64::MAX; 4];
        for i in 0..4 {
            let edge = EDGE as u32;
            if plain >> i & 1 == 1
                && let Some(&objects) = self.squares.get(((face[i] * edge + b[i]) * edge + a[i]) as usize)
            {
                seen[i] = objects;
            }
        }
        seen
    }

    /// Whether the ray is one of those that this is for, but for its passing the point.
    #[inline(always)]
    fn holds(&self, ray: &Ray) -> bool {
        largest(ray.origin) <= self.reach
    }

    /// Enters an object whose box, relative to the point, is this; corners of its outline count from a depth of `least`.
    fn enter(&mut self, bit: u64, min: DVec3, max: DVec3, outline: &Outline, least: f64) {
        for face in 0..6 {
            let axis = face / 2;
            let (near, far) = if face % 2 == 0 { (min[axis], max[axis]) } else { (-max[axis], -min[axis]) };
            if !(far > 0.0) {
                continue;
            }
            // The squares from the least to the greatest quotient of a coordinate and the depth.
            let span = |axis: usize| {
                let (least, most) = (min[axis], max[axis]);
                let least = match least < 0.0 {
                    true if near > 0.0 => least / near,
                    true => f64::NEG_INFINITY,
                    false => least / far,
                };
                let most = match most > 0.0 {
                    true if near > 0.0 => most / near,
                    true => f64::INFINITY,
                    false => most / far,
                };
                squares(least, most)
            };
            let (columns, rows) = (span((axis + 1) % 3), span((axis + 2) % 3));
            let silhouette = outline.on_face(Face(face), least);
            for row in rows {
                let place = |i: usize| i as f64 * (2.0 / EDGE as f64) - 1.0;
                let Some((least, most)) = silhouette.span(place(row) - MARGIN, place(row + 1) + MARGIN)
                else {
                    continue;
                };
                let seen = squares(least, most);
                let start = (face * EDGE + row) * EDGE;
                for column in columns.start.max(seen.start)..columns.end.min(seen.end) {
                    if silhouette.meets(row, column, EDGE, MARGIN) {
                        self.squares[start + column] |= bit;
                    }
                }
            }
        }
    }
}

/// The squares from one coordinate on a face to another, with the margin.
fn squares(least: f64, most: f64) -> core::ops::Range<usize> {
    let (least, most) = (least - MARGIN, most + MARGIN);
    if least > 1.0 || most < -1.0 {
        return 0..0;
    }
    let place = |x: f64| (((x + 1.0) * (0.5 * EDGE as f64)) as usize).min(EDGE - 1);
    place(least)..place(most) + 1
}

/// The distance of a box from zero.
fn distance(min: DVec3, max: DVec3) -> f64 {
    let outside = min.max(-max).max(DVec3::ZERO);
    sqrt(outside.dot(outside))
}

impl Geometry {
    /// For rays from or to this point; `None` for more than 64 objects, for which the tree does better, and for a point
    /// that is not finite.
    pub fn cube_about(&self, point: DVec3) -> Option<DirectionCube> {
        if self.plain || self.shapes.len() > MOST_OBJECTS || !(largest(point) < exp2i(400)) {
            return None;
        }
        let boxes: Vec<_> =
            self.shapes.iter().map(|shape| shape.bounds().filter(frame::is_regular)).collect();
        let extent = boxes.iter().flatten().fold(largest(point), |most, b| {
            let size = largest(b.min.abs().max(b.max.abs()));
            if size > most { size } else { most }
        });
        // Squares must not overflow, nor underflow where they decide.
        if !(extent < exp2i(400) && extent > exp2i(-400)) {
            return None;
        }
        let reach = extent * exp2i(10);
        // Nearer than this, an object is seen everywhere.
        let close = reach * exp2i(-26);
        let mut order: Vec<(f64, u32)> = Vec::new();
        for (object, (shape, bounds)) in self.shapes.iter().zip(&boxes).enumerate() {
            let distance = match (bounds, shape) {
                (Some(b), _) => distance(b.min - point, b.max - point),
                (None, Shape::Plane(plane)) => {
                    // Its height errs by less than 2^-50 of the numbers it is made of.
                    let anchor = plane.point() - point;
                    let height = plane.normal().dot(anchor);
                    if largest(anchor) <= reach { height.abs() } else { 0.0 }
                }
                _ => 0.0,
            };
            let distance = if distance > close { distance * (1.0 - MARGIN) } else { 0.0 };
            order.push((distance, object as u32));
        }
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut cube = DirectionCube {
            point,
            reach,
            objects: order.iter().map(|&(_, object)| object).collect(),
            distances: order.iter().map(|&(distance, _)| distance).collect(),
            bits: alloc::vec![0; order.len()],
            rings: 0,
            convex: 0,
            flat: 0,
            windows: self.frame.windows(point),
            squares: alloc::vec![0; 6 * EDGE * EDGE],
        };
        let everywhere = DVec3::INFINITY;
        for (place, (distance, object)) in order.into_iter().enumerate() {
            let bit = 1_u64 << place;
            cube.bits[object as usize] = bit;
            match self.shapes[object as usize] {
                Shape::Torus(_) => cube.rings |= bit,
                Shape::Sphere(_) | Shape::Cuboid(_) | Shape::Cylinder(_) | Shape::Cone(_) => {
                    cube.convex |= bit;
                }
                Shape::Plane(_) | Shape::Disk(_) | Shape::Triangle(_) => cube.flat |= bit,
                _ => {}
            }
            if !(distance > 0.0) {
                cube.squares.iter_mut().for_each(|square| *square |= bit);
                continue;
            }
            let outline = Outline::of(&self.shapes[object as usize], point);
            let (min, max) = boxes[object as usize]
                .map_or((-everywhere, everywhere), |bounds| (bounds.min - point, bounds.max - point));
            cube.enter(bit, min, max, &outline, reach * exp2i(-20));
        }
        Some(cube)
    }

    /// [`nearest`](Geometry::nearest) for a ray that begins at the point of the cube, which must be one of this
    /// geometry.
    #[inline]
    pub fn nearest_from(&self, cube: &DirectionCube, ray: &Ray, within: Interval) -> Option<Found> {
        self.seen_from(cube, ray, within)
    }

    /// The same for many rays, each with its interval and its place for the answer: as many as the shortest of the three
    /// slices holds.
    pub fn nearest_from_many(
        &self,
        cube: &DirectionCube,
        rays: &[Ray],
        within: &[Interval],
        found: &mut [Option<Found>],
    ) {
        vectorize(SeenMany { geometry: self, cube, rays, within, found });
    }

    #[inline(always)]
    fn seen_from(&self, cube: &DirectionCube, ray: &Ray, within: Interval) -> Option<Found> {
        // A ray that counts backwards too has another direction there.
        if ray.origin != cube.point || !(within.min >= 0.0) {
            return self.nearest(ray, within);
        }
        if !is_legal(ray, within) {
            return None;
        }
        let square = ray.direction.dot(ray.direction);
        let length = if moderate(square) { sqrt(square) } else { f64::INFINITY };
        let mut found = None;
        let nearest = (Nearest::new(within, None), cube.windows.of(ray.direction));
        self.nearest_seen(cube, ray, nearest, length, cube.seen(ray.direction), &mut found);
        found
    }

    /// The nearest of the objects that a ray may meet. The margin of the distances covers the rounding of the direction's
    /// length, which is infinite where squares leave their range.
    ///
    /// An answer goes from registers to its place. Returned or chosen first, it would be written in three parts and read back
    /// as two, which waits for all three.
    #[inline(always)]
    fn nearest_seen(
        &self,
        cube: &DirectionCube,
        ray: &Ray,
        (mut nearest, window): (Nearest, Window),
        length: f64,
        mut rest: u64,
        found: &mut Option<Found>,
    ) {
        while rest != 0 {
            let place = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let (Some(&object), Some(&distance)) = (cube.objects.get(place), cube.distances.get(place))
            else {
                break;
            };
            // The others are further still.
            if distance > nearest.limit(window) * length {
                break;
            }
            if let Some(shape) = self.shapes.get(object as usize) {
                let _ = nearest.visit(ray, object, shape);
            }
        }
        *found = nearest.best();
        if let Some(limit) = nearest.contested(|| window) {
            *found = self.decide(ray, nearest.within(), limit, None);
        }
    }

    /// The torus of a bit, and its object.
    #[inline(always)]
    fn ring(&self, cube: &DirectionCube, place: usize) -> Option<(&Torus, u32)> {
        let &object = cube.objects.get(place)?;
        match self.shapes.get(object as usize) {
            Some(Shape::Torus(torus)) => Some((torus, object)),
            _ => None,
        }
    }

    /// Shows four queries the tori of `seen`, which need not be shown any more; the rays of `members` are meant.
    #[inline(always)]
    fn show_rings(
        &self,
        cube: &DirectionCube,
        rays: [&Ray; 4],
        nearest: &mut [Nearest; 4],
        seen: &mut [u64; 4],
        members: u32,
    ) {
        let mut rest = (seen[0] | seen[1] | seen[2] | seen[3]) & cube.rings;
        let within = [nearest[0].within(), nearest[1].within(), nearest[2].within(), nearest[3].within()];
        while rest != 0 {
            let place = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let Some((torus, object)) = self.ring(cube, place) else { continue };
            let members = members & take_out(seen, place);
            if members == 0 {
                continue;
            }
            let told = vectorize(AskFour::<true> { torus, rays, within, members });
            for i in 0..4 {
                if told.meet >> i & 1 == 1 {
                    nearest[i].offer(object, Hit::inside(told.t[i], 0, 0));
                } else if told.doubt >> i & 1 == 1 {
                    let _ = nearest[i].visit(rays[i], object, torus);
                }
            }
        }
    }

    /// [`blocked`](Geometry::blocked) for the ray from a departure's start to the point of the cube, which must be one
    /// of this geometry; the parameter runs from 0 to 1.
    #[inline]
    pub fn blocked_towards(
        &self,
        cube: &DirectionCube,
        from: &Departure,
        screens: &[Screen],
        each: &mut dyn FnMut(Found),
    ) -> bool {
        let start = from.ray(DVec3::ZERO).0.origin;
        let ray = Ray::new(start, cube.point - start);
        let way = Way {
            held: cube.holds(&ray),
            valid: ray.is_valid(),
            length: sqrt(ray.direction.dot(ray.direction)),
            seen: cube.seen(-ray.direction),
            ray,
        };
        self.blocked_on(cube, &way, from.object, || *from, screens, each)
    }

    /// The ways of [`blocked_towards`](Geometry::blocked_towards) from four places, for [`blocked_on`](Geometry::blocked_on).
    #[inline(always)]
    pub fn four_towards<L: Lanes>(cube: &DirectionCube, start: Vector<Four<L>>) -> [Way; 4] {
        let zero = start.x.all(0.0);
        let direction = Vector::all(zero, cube.point) - start;
        // Zero times a number is zero, unless the number is infinite or NaN, which then the direction is too.
        let nothing = direction.x * zero + direction.y * zero + direction.z * zero;
        let valid = zero.less(direction.largest()) & nothing.less(zero.all(1.0));
        let beyond = zero.all(cube.reach).less(start.largest());
        let length = direction.length().to_array();
        let seen = cube.seen_four(-direction);
        let (start, direction) = (start.to_array(), direction.to_array());
        core::array::from_fn(|i| Way {
            ray: Ray { origin: start[i], direction: direction[i] },
            held: beyond >> i & 1 == 0,
            valid: valid >> i & 1 == 1,
            length: length[i],
            seen: seen[i],
        })
    }

    /// Which of the four ways, of those of `members`, certainly meet an opaque torus, one bit each: then they are blocked. They
    /// leave these objects. About the others [`blocked_on`](Geometry::blocked_on) need not ask the tori again that are certain.
    #[inline(always)]
    pub fn blocked_by_tori(
        &self,
        cube: &DirectionCube,
        ways: &mut [Way; 4],
        members: u32,
        left: [u32; 4],
        screens: &[Screen],
    ) -> u32 {
        let mut seen = [0; 4];
        for i in 0..4 {
            let way = &ways[i];
            if members >> i & 1 == 1 && way.held && way.valid {
                seen[i] = way.seen & !cube.bits.get(left[i] as usize).copied().unwrap_or(0);
            }
        }
        let mut rest = (seen[0] | seen[1] | seen[2] | seen[3]) & cube.rings;
        let mut blocked = 0;
        while rest != 0 {
            let place = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let Some((torus, object)) = self.ring(cube, place) else { continue };
            if screens.get(object as usize).is_some_and(|screen| *screen != Screen::Opaque) {
                continue;
            }
            let members = take_out(&mut seen, place) & !blocked;
            if members == 0 {
                continue;
            }
            let rays = [&ways[0].ray, &ways[1].ray, &ways[2].ray, &ways[3].ray];
            let within = [Interval::new(0.0, 1.0); 4];
            let told = vectorize(AskFour::<false> { torus, rays, within, members });
            blocked |= told.meet;
            for (i, way) in ways.iter_mut().enumerate() {
                if (members & !told.doubt) >> i & 1 == 1 {
                    way.seen &= !(1 << place);
                }
            }
        }
        blocked
    }

    /// Which of the four ways, which leave these objects, certainly meet nothing, one bit each, of those that are not blocked
    /// [by tori](Geometry::blocked_by_tori). Those of `outside` leave on the outside.
    #[inline(always)]
    pub fn are_free(cube: &DirectionCube, ways: &[Way; 4], left: [u32; 4], outside: u32) -> u32 {
        let mut free = 0;
        for i in 0..4 {
            let (way, left) = (&ways[i], cube.bits.get(left[i] as usize).copied().unwrap_or(0));
            let leaves = left & (cube.flat | if outside >> i & 1 == 1 { cube.convex } else { 0 }) != 0;
            free |= u32::from(way.held & way.valid & leaves & (way.seen & !left == 0)) << i;
        }
        free
    }

    /// The rest of [`blocked_towards`](Geometry::blocked_towards) for a ray that leaves `object`.
    #[inline(always)]
    pub fn blocked_on(
        &self,
        cube: &DirectionCube,
        way: &Way,
        object: u32,
        from: impl Fn() -> Departure,
        screens: &[Screen],
        each: &mut dyn FnMut(Found),
    ) -> bool {
        let Way { ref ray, held, valid, length, seen } = *way;
        let within = Interval::new(0.0, 1.0);
        if !held {
            return self.blocked(ray, within, Some(&from()), screens, each);
        }
        if !valid {
            return false;
        }
        let mut path = Path { within, skip: None, screens, each, blocked: false };
        if path.leave(self, ray, object, from).is_break() {
            return true;
        }
        let left = cube.bits.get(object as usize).copied().unwrap_or(0);
        let mut rest = seen & !left;
        // Objects beyond the start are not in the way. The margin covers the roundings of the distance, as it is relative.
        while rest != 0 {
            let place = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let (Some(&object), Some(&distance)) = (cube.objects.get(place), cube.distances.get(place))
            else {
                break;
            };
            if distance > length {
                break;
            }
            if let Some(shape) = self.shapes.get(object as usize)
                && path.visit(ray, object, shape).is_break()
            {
                break;
            }
        }
        path.blocked
    }
}

/// Takes an object out of four sets; those that it was in, one bit each.
#[inline(always)]
fn take_out(sets: &mut [u64; 4], place: usize) -> u32 {
    let mut members = 0;
    for (i, set) in sets.iter_mut().enumerate() {
        members |= ((*set >> place & 1) as u32) << i;
        *set &= !(1 << place);
    }
    members
}

/// The ray from a place to the point of a [`DirectionCube`], and what the cube says of it.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    ray: Ray,
    /// Whether it begins within the reach of the cube.
    held: bool,
    valid: bool,
    length: f64,
    /// The objects in the direction of the place, one bit each.
    seen: u64,
}

/// Rays that begin at the point of a cube, four at a time.
struct SeenMany<'a> {
    geometry: &'a Geometry,
    cube: &'a DirectionCube,
    rays: &'a [Ray],
    within: &'a [Interval],
    found: &'a mut [Option<Found>],
}

impl Vectorized for SeenMany<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let SeenMany { geometry, cube, rays, within, found } = self;
        let fours = rays.chunks(4).zip(within.chunks(4)).zip(found.chunks_mut(4));
        for ((rays, within), found) in fours {
            let here = |ray: &Ray| ray.origin == cube.point;
            let ([a, b, c, d], true) = (rays, rays.iter().all(here)) else {
                for ((ray, within), found) in rays.iter().zip(within).zip(found) {
                    *found = geometry.seen_from(cube, ray, *within);
                }
                continue;
            };
            let direction = Vector::new(lanes, [&a.direction, &b.direction, &c.direction, &d.direction]);
            let zero = direction.x.all(0.0);
            let largest = direction.largest();
            // Zero times a number is zero, unless the number is infinite or NaN. The point is finite.
            let nothing = direction.x * zero + direction.y * zero + direction.z * zero;
            let valid = zero.less(largest) & nothing.less(zero.all(1.0));
            let windows = cube.windows.of_four(largest);
            let square = direction.dot(direction);
            let length = square.sqrt().to_array();
            let (square, mut seen) = (square.to_array(), cube.seen_four(direction));
            if (seen[0] | seen[1] | seen[2] | seen[3]) & cube.rings != 0 && within.len() == 4 {
                let mut nearest = [0, 1, 2, 3].map(|i| Nearest::new(within[i], None));
                let mut members = valid;
                for (i, within) in within.iter().enumerate() {
                    members &= !(u32::from(!(within.min >= 0.0 && within.min < within.max)) << i);
                }
                geometry.show_rings(cube, [a, b, c, d], &mut nearest, &mut seen, members);
                for (i, (ray, found)) in rays.iter().zip(found).enumerate() {
                    if members >> i & 1 == 1 {
                        let length = if moderate(square[i]) { length[i] } else { f64::INFINITY };
                        geometry.nearest_seen(cube, ray, (nearest[i], windows[i]), length, seen[i], found);
                    } else {
                        *found = geometry.nearest(ray, within[i]);
                    }
                }
                continue;
            }
            for (i, ((ray, within), found)) in rays.iter().zip(within).zip(found).enumerate() {
                if valid >> i & 1 == 1 && within.min >= 0.0 && within.min < within.max {
                    let length = if moderate(square[i]) { length[i] } else { f64::INFINITY };
                    let nearest = (Nearest::new(*within, None), windows[i]);
                    geometry.nearest_seen(cube, ray, nearest, length, seen[i], found);
                } else {
                    *found = geometry.nearest(ray, *within);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Side;
    use crate::kernel::PortableLanes;
    use crate::shape::{Plane, Sphere, Torus};
    use crate::testing::Random;

    /// An object is entered in all squares that it is seen in, and in few more.
    #[test]
    fn squares_are_those_of_the_objects() {
        let point = DVec3::new(0.25, -0.5, 0.125);
        let mut count = [0; 2];
        for (turn, radius) in [(0, 0.4), (7, 0.1), (11, 0.9), (23, 0.02), (31, 0.7)] {
            let x = f64::from(turn);
            let way = DVec3::new(libm::sin(x), libm::cos(1.7 * x), libm::sin(2.3 * x + 1.0)).normalize();
            let shapes: [Shape; 2] = [
                Sphere::new(point + way * 2.0, radius).unwrap().into(),
                Torus::new(point - way * 3.0, way, radius, 0.25 * radius).unwrap().into(),
            ];
            let geometry = Geometry::builder().add(shapes[0].clone()).add(shapes[1].clone()).build();
            let cube = geometry.cube_about(point).unwrap();
            let bit = |object: usize| cube.bits[object];
            // The sphere fills a cap of this cosine of its half angle; a square is at most this wide.
            let (sine, wide) = (radius / 2.0, 2.9 / EDGE as f64);
            for face in 0..6 {
                for row in 0..EDGE {
                    for column in 0..EDGE {
                        let at = |i: usize| (2 * i + 1) as f64 / EDGE as f64 - 1.0;
                        let mut direction = DVec3::ZERO;
                        direction[face / 2] = if face % 2 == 0 { 1.0 } else { -1.0 };
                        direction[(face / 2 + 1) % 3] = at(column);
                        direction[(face / 2 + 2) % 3] = at(row);
                        let seen = cube.seen(direction);
                        assert_eq!(seen, cube.squares[(face * EDGE + row) * EDGE + column]);
                        let angle = libm::acos(direction.normalize().dot(way));
                        let half = libm::asin(sine);
                        assert!(angle > half || seen & bit(0) != 0, "{way} {radius} {direction}");
                        assert!(angle < half + wide || seen & bit(0) == 0, "{way} {radius} {direction}");
                        let ray = crate::Ray::new(point, direction);
                        let hit = shapes[1].hit(&ray, Interval::FORWARD).is_some();
                        assert!(!hit || seen & bit(1) != 0, "{way} {radius} {direction}");
                        // The hole of the ring counts as filled: it is 2 3/4 radii wide, with the polygons' corners.
                        let half = libm::atan(1.3 * radius / (3.0 - 0.27 * radius));
                        let away = core::f64::consts::PI - angle;
                        assert!(
                            away < half + 2.0 * wide || seen & bit(1) == 0,
                            "{way} {radius} {direction} {away}"
                        );
                        count[0] += u32::from(seen & bit(0) != 0);
                        count[1] += u32::from(seen & bit(1) != 0);
                    }
                }
            }
        }
        assert!(count.iter().all(|&count| count > 5000), "{count:?}");
    }

    /// Rays that begin within 2^10 times the largest coordinate are answered, whatever the scale.
    #[test]
    fn how_far_a_cube_reaches() {
        for scale in [1e-9, 1.0, 1e6] {
            let sphere = Sphere::new(DVec3::splat(2.0 * scale), scale).unwrap();
            let geometry = Geometry::builder().add(sphere).build();
            let cube = geometry.cube_about(DVec3::new(scale, 0.0, 0.0)).unwrap();
            let from = |x: f64| crate::Ray::new([x * scale, 0.0, 0.0], [1.0, 0.0, 0.0]);
            assert!(cube.holds(&from(3.0 * 1023.0)) && !cube.holds(&from(3.0 * 1025.0)));
        }
    }

    /// A few shapes, of which a plane, about the middle.
    fn scene() -> Geometry {
        let mut builder = Geometry::builder().add(Plane::new([0.0, -1.0, 0.0], [0.0, 1.0, 0.0]).unwrap());
        for i in 0..20 {
            let x = f64::from(i);
            let way = DVec3::new(libm::sin(x), libm::cos(1.7 * x), libm::sin(2.3 * x + 1.0)).normalize();
            builder = match i % 2 {
                0 => builder.add(Sphere::new(way * 3.0, 0.2 + 0.02 * x).unwrap()),
                _ => builder.add(Torus::new(way * 4.0, way, 0.9, 0.2).unwrap()),
            };
        }
        builder.build()
    }

    /// Ordinary numbers, and now and then one of the others.
    fn odd(random: &mut Random, ordinary: f64) -> f64 {
        const ODD: [f64; 10] =
            [0.0, -0.0, 1e-320, -1e-160, 1e160, exp2i(1000), f64::MAX, f64::INFINITY, f64::NAN, 1.0];
        match random.uniform(0.0, 12.0) as usize {
            0 => ODD[random.uniform(0.0, 10.0) as usize % 10],
            _ => ordinary,
        }
    }

    /// Rays by four find what they find one by one, in all lanes and whatever their bits.
    #[test]
    fn many_are_each() {
        let mut random = Random::new(1);
        let geometry = scene();
        let point = DVec3::new(0.25, -0.5, 0.125);
        let cube = geometry.cube_about(point).unwrap();
        let mut hits = 0;
        for _ in 0..2000 {
            let mut ray = || {
                let d = random.direction() * random.magnitude(-3.0, 3.0);
                let d = DVec3::new(odd(&mut random, d.x), odd(&mut random, d.y), odd(&mut random, d.z));
                Ray::new(DVec3::new(odd(&mut random, point.x), point.y, point.z), d)
            };
            let rays: [Ray; 7] = core::array::from_fn(|_| ray());
            let within =
                [0; 7].map(|_| Interval::new(odd(&mut random, 0.0), odd(&mut random, f64::INFINITY)));
            let (mut found, mut portable) = ([None; 7], [None; 7]);
            geometry.nearest_from_many(&cube, &rays, &within, &mut found);
            let (rays_, within_) = (&rays, &within);
            SeenMany { geometry: &geometry, cube: &cube, rays: rays_, within: within_, found: &mut portable }
                .run(PortableLanes);
            for (i, (ray, within)) in rays.iter().zip(within).enumerate() {
                let expected = geometry.nearest(ray, within);
                hits += u32::from(expected.is_some());
                for found in [found[i], portable[i], geometry.nearest_from(&cube, ray, within)] {
                    assert_eq!(found, expected, "{ray:?} {within:?}");
                }
            }
        }
        assert!(hits > 3000, "{hits}");
    }

    struct Blocked<'a>(&'a Geometry, &'a DirectionCube, [Departure; 4]);

    impl Vectorized for Blocked<'_> {
        type Output = [bool; 4];
        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> [bool; 4] {
            let Blocked(geometry, cube, from) = self;
            let start = from.map(|from| from.ray(DVec3::ZERO).0.origin);
            let start = Vector::new(lanes, start.each_ref());
            let mut ways = Geometry::four_towards(cube, start);
            let left = from.map(|from| from.object);
            let outside = (0..4).map(|i| u32::from(from[i].side == Side::Outside) << i).sum();
            let before = ways;
            let blocked = geometry.blocked_by_tori(cube, &mut ways, 15, left, &[]);
            let free = Geometry::are_free(cube, &ways, left, outside) & !blocked;
            core::array::from_fn(|i| {
                let ask = |way| geometry.blocked_on(cube, way, left[i], || from[i], &[], &mut |_| {});
                let answer = ask(&before[i]);
                assert_eq!(answer, blocked >> i & 1 == 1 || ask(&ways[i]));
                assert!(!answer || free >> i & 1 == 0);
                answer
            })
        }
    }

    /// Shadow rays by four are blocked where they are one by one.
    #[test]
    fn four_are_each_towards_a_point() {
        let mut random = Random::new(2);
        let geometry = scene();
        let point = DVec3::new(0.25, 0.5, 0.125);
        let cube = geometry.cube_about(point).unwrap();
        let mut blocked = 0;
        for _ in 0..2000 {
            let from = [0; 4].map(|_| {
                loop {
                    let ray = Ray::new(random.in_cube() * 9.0, random.direction());
                    let Some(found) = geometry.nearest(&ray, Interval::FORWARD) else { continue };
                    let surface = geometry.surface(&ray, found);
                    let side = Side::of_arrival(ray.direction, surface.normal);
                    let mut from = surface.departure(found.object, found.hit, side);
                    from.point.y = odd(&mut random, from.point.y);
                    break from;
                }
            });
            let found = vectorize(Blocked(&geometry, &cube, from));
            assert_eq!(found, Blocked(&geometry, &cube, from).run(PortableLanes));
            for (from, found) in from.iter().zip(found) {
                assert_eq!(found, geometry.blocked_towards(&cube, from, &[], &mut |_| {}), "{from:?}");
                let start = from.ray(DVec3::ZERO).0.origin;
                let (ray, within) = (Ray::new(start, point - start), Interval::new(0.0, 1.0));
                assert_eq!(found, geometry.occluded_leaving(&ray, within, from), "{from:?}");
                blocked += u32::from(found);
            }
        }
        assert!((500..7500).contains(&blocked), "{blocked}");
    }
}
