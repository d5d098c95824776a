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
//! one that is nearer, or unbounded, is entered everywhere. Rays from further away are not answered here.

use super::query::{Nearest, Path, Query, Ruling, Screen};
use super::{Found, Geometry, frame, is_legal};
use crate::math::exp2i;
use crate::scaled::largest;
use crate::{Departure, Interval, Primitive, Ray};
use alloc::vec::Vec;
use core::ops::ControlFlow;
use glam::DVec3;

/// Squares along the edge of a face: 1.4 degrees each.
const EDGE: usize = 64;

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
    /// By object: a lower bound of the square of its distance.
    distances: Vec<f64>,
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

    /// Whether the ray is one of those that this is for, but for its passing the point.
    #[inline(always)]
    fn holds(&self, ray: &Ray) -> bool {
        largest(ray.origin) <= self.reach
    }

    /// Enters an object whose box, relative to the point, is this.
    fn enter(&mut self, bit: u64, min: DVec3, max: DVec3) {
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
                } - MARGIN;
                let most = match most > 0.0 {
                    true if near > 0.0 => most / near,
                    true => f64::INFINITY,
                    false => most / far,
                } + MARGIN;
                if least > 1.0 || most < -1.0 {
                    return 0..0;
                }
                let place = |x: f64| (((x + 1.0) * (0.5 * EDGE as f64)) as usize).min(EDGE - 1);
                place(least)..place(most) + 1
            };
            let (columns, rows) = (span((axis + 1) % 3), span((axis + 2) % 3));
            for row in rows {
                let start = (face * EDGE + row) * EDGE;
                for square in &mut self.squares[start + columns.start..start + columns.end] {
                    *square |= bit;
                }
            }
        }
    }
}

/// The distance of a box from zero, squared.
fn distance_squared(min: DVec3, max: DVec3) -> f64 {
    let outside = min.max(-max).max(DVec3::ZERO);
    outside.dot(outside)
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
        let squares = alloc::vec![0; 6 * EDGE * EDGE];
        let mut cube = DirectionCube { point, reach, distances: Vec::new(), squares };
        for (object, bounds) in boxes.iter().enumerate() {
            let bit = 1_u64 << object;
            let (min, max) = bounds.map_or((DVec3::ZERO, DVec3::ZERO), |b| (b.min - point, b.max - point));
            let distance = distance_squared(min, max);
            if distance > (reach * exp2i(-26)) * (reach * exp2i(-26)) {
                cube.enter(bit, min, max);
                cube.distances.push(distance * (1.0 - MARGIN));
            } else {
                cube.squares.iter_mut().for_each(|square| *square |= bit);
                cube.distances.push(0.0);
            }
        }
        Some(cube)
    }

    /// [`nearest`](Geometry::nearest) for a ray that begins at the point of the cube, which must be one of this
    /// geometry.
    #[inline]
    pub fn nearest_from(&self, cube: &DirectionCube, ray: &Ray, within: Interval) -> Option<Found> {
        // A ray that counts backwards too has another direction there.
        if ray.origin != cube.point || !(within.min >= 0.0) {
            return self.nearest(ray, within);
        }
        if !is_legal(ray, within) {
            return None;
        }
        let mut nearest = Nearest::new(within, self.frame.window(ray), None);
        let _ = self.ask_these(cube.seen(ray.direction), ray, &mut nearest);
        match nearest.ruling() {
            Ruling::Clear(found) => found,
            Ruling::Contested(limit) => self.decide(ray, within, limit, None),
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
        let within = Interval::new(0.0, 1.0);
        if !cube.holds(&ray) {
            return self.blocked(&ray, within, Some(from), screens, each);
        }
        if !is_legal(&ray, within) {
            return false;
        }
        let mut path = Path { within, skip: Some(from.object), screens, each, blocked: false };
        if path.leave(self, &ray, from).is_break() {
            return true;
        }
        let mut seen = cube.seen(-ray.direction);
        // Objects beyond the start are not in the way. The margin covers the roundings of the distance, as it is relative.
        let length = ray.direction.dot(ray.direction);
        let mut rest = seen;
        while rest != 0 {
            let object = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            if cube.distances.get(object).is_some_and(|&distance| distance > length) {
                seen &= !(1 << object);
            }
        }
        let _ = self.ask_these(seen, &ray, &mut path);
        path.blocked
    }

    /// Shows the query these shapes, one bit each, until it breaks.
    #[inline(always)]
    fn ask_these<Q: Query>(&self, mut objects: u64, ray: &Ray, query: &mut Q) -> ControlFlow<()> {
        while objects != 0 {
            let object = objects.trailing_zeros();
            objects &= objects - 1;
            if let Some(shape) = self.shapes.get(object as usize) {
                query.visit(ray, object, shape)?;
            }
        }
        ControlFlow::Continue(())
    }
}
