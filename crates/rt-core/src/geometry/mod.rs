//! Many shapes: the nearest hit, or whether anything is in the way.
//!
//! A [`Geometry`] finds exactly what a loop over all its shapes would find, to the last bit, whatever the
//! instruction set: boxes rounded outward only leave out shapes that the ray cannot hit, and each hit is computed by
//! the shape itself.
//!
//! # Order of hits
//! The hit with the least parameter is the nearest. Where the parameters of two objects are so close that their
//! roundings could have exchanged them, the order is that of their refined parameters ([`Surface::t`]); at equal ones,
//! leaving a solid comes before entering one (`direction . normal > 0` first), then the order of adding.

// `!(a < b)` is meant where it is written: it holds for NaN too.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod batch;
mod builder;
mod course;
mod cube;
mod frame;
mod leaving;
mod order;
mod outline;
mod packet;
mod query;
mod record;
mod returning;
mod rings;
mod store;
mod stream;
mod tile;
mod traverse;
mod tree;

use crate::kernel::{Lanes, Vectorized, vec_on_large_pages, vectorize};
use crate::{Aabb, Departure, Hit, Interval, Primitive, Ray, Shape, Surface};
use alloc::vec::Vec;
use builder::Item;
use core::ops::ControlFlow;
use course::Legal;
pub use cube::{DirectionCube, Way};
use frame::Frame;
pub use query::Screen;
use query::{Any, Contest, Crossings, Nearest, Path, Query};
use store::{Run, Store};
use traverse::traverse;
use tree::{Child, Tree};

/// Trees larger than this are not likely to stay in a core's own cache.
const CACHE: usize = 1 << 20;

/// A hit and the object it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The index of the object, in the order of [`GeometryBuilder::add`].
    pub object: u32,
    /// The hit.
    pub hit: Hit,
}

/// A set of shapes, ready for rays.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    shapes: Vec<Shape>,
    frame: Frame,
    tree: Tree,
    store: Store,
    /// The shapes outside the tree.
    apart: Vec<Run>,
    plain: bool,
}

/// Collects shapes for a [`Geometry`].
#[derive(Clone, Debug, Default)]
pub struct GeometryBuilder {
    shapes: Vec<Shape>,
    plain: bool,
}

impl GeometryBuilder {
    /// Adds a shape: its index is the count of those added before.
    #[allow(clippy::should_implement_trait)]
    pub fn add(mut self, shape: impl Into<Shape>) -> Self {
        self.push(shape);
        self
    }

    /// Adds a shape and returns its index.
    pub fn push(&mut self, shape: impl Into<Shape>) -> u32 {
        self.shapes.push(shape.into());
        (self.shapes.len() - 1) as u32
    }

    /// Whether to build an acceleration structure (the default), or to test every shape with every ray. The answers
    /// are the same bits: the plain loop is for tests and comparisons.
    pub fn accelerated(mut self, accelerated: bool) -> Self {
        self.plain = !accelerated;
        self
    }

    /// Prepares the set for rays.
    pub fn build(self) -> Geometry {
        let GeometryBuilder { shapes, plain } = self;
        let mut bounds = vec_on_large_pages(shapes.len());
        bounds.extend(shapes.iter().map(regular_bounds));
        let frame = Frame::around(shapes.len(), bounds.iter().copied());
        let mut geometry = Geometry { shapes, frame, plain, ..Geometry::default() };
        if !plain {
            geometry.accelerate(bounds);
        }
        geometry
    }
}

impl Geometry {
    /// An empty builder.
    pub fn builder() -> GeometryBuilder {
        GeometryBuilder::default()
    }

    /// The shapes, by index.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// The bytes of memory in use beside [`shapes`](Geometry::shapes).
    pub fn memory(&self) -> usize {
        self.tree.bytes() + self.store.bytes()
    }

    /// With the boxes of the shapes that can be put into the tree.
    fn accelerate(&mut self, bounds: Vec<Option<Aabb>>) {
        let mut items = vec_on_large_pages(self.shapes.len());
        let mut apart: [Vec<u32>; Store::KINDS] = Default::default();
        let mut counts = [0; Store::KINDS];
        for (object, (shape, bounds)) in self.shapes.iter().zip(&bounds).enumerate() {
            let (object, kind) = (object as u32, Store::kind_of(shape));
            counts[kind as usize] += 1;
            match bounds {
                Some(bounds) if items.len() < Child::CAPACITY => {
                    let (min, max) = self.frame.outward(bounds);
                    items.push(Item { min, object, max, kind });
                }
                _ => apart[kind as usize].push(object),
            }
        }
        drop(bounds);
        self.tree = builder::build(&mut items);
        self.store.reserve(counts);
        if size_of_val(&self.shapes[..]) > CACHE {
            self.store.remember_places(self.shapes.len());
        }
        for item in items {
            self.store.push(&self.shapes[item.object as usize], item.object);
        }
        // Those apart come last of their kind.
        for (kind, objects) in apart.iter().enumerate().filter(|(_, objects)| !objects.is_empty()) {
            let first = self.store.count(kind as u32);
            self.apart.push(Run { kind: kind as u32, first, count: objects.len() });
            for &object in objects {
                self.store.push(&self.shapes[object as usize], object);
            }
        }
    }

    /// The nearest hit inside the interval: see the [order of hits](self#order-of-hits).
    #[inline]
    pub fn nearest(&self, ray: &Ray, within: Interval) -> Option<Found> {
        self.find_nearest(ray, within, None)
    }

    /// The nearest hit of a ray that leaves a surface: see [`Departure`].
    #[inline]
    pub fn nearest_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Found> {
        self.find_nearest(ray, within, Some(from))
    }

    /// Whether anything lies inside the interval.
    pub fn occluded(&self, ray: &Ray, within: Interval) -> bool {
        vectorize(FindAny { geometry: self, ray, within, from: None })
    }

    /// Whether anything lies inside the interval, for a ray that leaves a surface: see [`Departure`].
    pub fn occluded_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> bool {
        vectorize(FindAny { geometry: self, ray, within, from: Some(from) })
    }

    /// Whether anything opaque lies inside the interval, and what lies there that is not: in one search.
    ///
    /// `screens` says of each object, by index, what it does to the ray; those beyond its end are opaque. While
    /// nothing opaque is found, the crossings of [`Screen::Sheer`] objects are reported to `each`, in no particular
    /// order; they mean nothing when the answer is `true`. With `from`, the ray leaves that surface.
    pub fn blocked(
        &self,
        ray: &Ray,
        within: Interval,
        from: Option<&Departure>,
        screens: &[Screen],
        each: &mut dyn FnMut(Found),
    ) -> bool {
        let skip = from.map(|from| from.object);
        let path = Path { within, skip, screens, each, blocked: false };
        vectorize(FindPath { geometry: self, ray, from, path })
    }

    /// All crossings inside the interval of all objects, in no particular order, but ascending for each object;
    /// stops when `each` breaks. With `from`, the ray leaves that surface.
    pub fn crossings(
        &self,
        ray: &Ray,
        within: Interval,
        from: Option<&Departure>,
        each: &mut dyn FnMut(Found) -> ControlFlow<()>,
    ) {
        vectorize(FindCrossings { geometry: self, ray, query: Crossings { within, from, each } })
    }

    /// The full record of a hit found with this ray.
    pub fn surface(&self, ray: &Ray, found: Found) -> Surface {
        self.store.surface(&self.shapes, found.object, ray, found.hit)
    }

    /// Asks for the memory of an object whose [`surface`](Geometry::surface) will soon be asked for: among many objects
    /// that takes longer than the record. Has no effect but on time.
    #[inline]
    pub fn prefetch(&self, found: Found) {
        self.store.prefetch_object(&self.shapes, found.object);
    }

    /// The shape that the ray leaves, if it is one of these.
    #[inline(always)]
    fn departed<'a>(&self, from: Option<&'a Departure>) -> Option<(&'a Departure, &Shape)> {
        from.and_then(|from| self.shapes.get(from.object as usize).map(|shape| (from, shape)))
    }

    /// A hit comes back in two registers, its object by itself: an answer of three words comes back in memory, where callers
    /// read it in other pieces than it was written in, and wait.
    #[inline(always)]
    fn find_nearest(&self, ray: &Ray, within: Interval, from: Option<&Departure>) -> Option<Found> {
        let mut object = 0;
        let hit = find_nearest(self, ray, within, from, &mut object)?;
        Some(Found { object, hit })
    }

    /// Shows the query every shape that the ray can hit, until it breaks.
    #[inline(always)]
    fn ask<L: Lanes, Q: Query>(
        &self,
        lanes: L,
        ray: &Ray,
        within: Interval,
        legal: Legal,
        query: &mut Q,
    ) -> ControlFlow<()> {
        if self.plain {
            for (object, shape) in self.shapes.iter().enumerate() {
                query.visit(ray, object as u32, shape)?;
            }
            return ControlFlow::Continue(());
        }
        // These first: numbers made ready before would not stay in registers.
        self.ask_apart(ray, query)?;
        match self.frame.course(lanes, ray, within, legal) {
            Some(course) => traverse(lanes, &self.tree, &self.store, ray, &course, query),
            None => ControlFlow::Continue(()),
        }
    }

    /// Whether a ray hits any object but one.
    #[inline(always)]
    fn any<L: Lanes>(&self, lanes: L, ray: &Ray, within: Interval, legal: Legal, skip: Option<u32>) -> bool {
        let mut any = Any::new(within, skip);
        let _ = self.ask(lanes, ray, within, legal, &mut any);
        any.found
    }

    /// Shows the query the shapes outside the tree.
    #[inline(always)]
    fn ask_apart<Q: Query>(&self, ray: &Ray, query: &mut Q) -> ControlFlow<()> {
        for run in &self.apart {
            self.store.visit(*run, ray, query)?;
        }
        ControlFlow::Continue(())
    }

    /// The first of the hits within an interval in which several objects are hit, too close to be sure.
    #[cold]
    fn decide(&self, ray: &Ray, within: Interval, limit: f64, from: Option<&Departure>) -> Option<Found> {
        vectorize(Decide { geometry: self, ray, within, limit, from })
    }
}

/// The box of a shape that can be put into the tree.
fn regular_bounds(shape: &Shape) -> Option<Aabb> {
    shape.bounds().filter(frame::is_regular)
}

/// Whether the ray can hit anything in the interval.
#[inline(always)]
fn is_legal(ray: &Ray, within: Interval) -> bool {
    ray.is_valid() && within.min < within.max
}

/// Not in place: it is long. All arguments come in registers.
#[inline(never)]
fn find_nearest(
    geometry: &Geometry,
    ray: &Ray,
    within: Interval,
    from: Option<&Departure>,
    object: &mut u32,
) -> Option<Hit> {
    vectorize(Apart { geometry, ray, within, from, object })
}

/// The nearest hit, and its object by itself.
struct Apart<'a> {
    geometry: &'a Geometry,
    ray: &'a Ray,
    within: Interval,
    from: Option<&'a Departure>,
    object: &'a mut u32,
}

impl Vectorized for Apart<'_> {
    type Output = Option<Hit>;
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Option<Hit> {
        let Apart { geometry, ray, within, from, object } = self;
        let found = FindNearest { geometry, ray, within, from }.run(lanes)?;
        *object = found.object;
        Some(found.hit)
    }
}

struct FindNearest<'a> {
    geometry: &'a Geometry,
    ray: &'a Ray,
    within: Interval,
    from: Option<&'a Departure>,
}

impl Vectorized for FindNearest<'_> {
    type Output = Option<Found>;
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Option<Found> {
        let FindNearest { geometry, ray, within, from } = self;
        let legal = geometry.frame.legal(lanes, ray, within)?;
        let mut nearest = Nearest::new(within, from.map(|from| from.object));
        if let Some((from, shape)) = geometry.departed(from)
            && let Some(hit) = shape.hit_leaving(ray, within, from)
        {
            nearest.offer(from.object, hit);
        }
        let _ = geometry.ask(lanes, ray, within, legal, &mut nearest);
        match nearest.contested(|| geometry.frame.window(ray)) {
            None => nearest.best(),
            Some(limit) => geometry.decide(ray, within, limit, from),
        }
    }
}

struct Decide<'a> {
    geometry: &'a Geometry,
    ray: &'a Ray,
    within: Interval,
    limit: f64,
    from: Option<&'a Departure>,
}

impl Vectorized for Decide<'_> {
    type Output = Option<Found>;
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Option<Found> {
        let Decide { geometry, ray, within, limit, from } = self;
        let before = within.until(limit);
        let legal = geometry.frame.legal(lanes, ray, before)?;
        let mut contest = Contest::new(within, limit, from.map(|from| from.object));
        if let Some((from, shape)) = geometry.departed(from)
            && let Some(hit) = shape.hit_leaving(ray, within, from)
            && hit.t() < limit
        {
            contest.offer(ray, from.object, shape, hit);
        }
        let _ = geometry.ask(lanes, ray, before, legal, &mut contest);
        contest.winner()
    }
}

struct FindAny<'a> {
    geometry: &'a Geometry,
    ray: &'a Ray,
    within: Interval,
    from: Option<&'a Departure>,
}

impl Vectorized for FindAny<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> bool {
        let FindAny { geometry, ray, within, from } = self;
        let Some(legal) = geometry.frame.legal(lanes, ray, within) else { return false };
        if let Some((from, shape)) = geometry.departed(from)
            && shape.hit_leaving(ray, within, from).is_some()
        {
            return true;
        }
        geometry.any(lanes, ray, within, legal, from.map(|from| from.object))
    }
}

struct FindPath<'a> {
    geometry: &'a Geometry,
    ray: &'a Ray,
    from: Option<&'a Departure>,
    path: Path<'a>,
}

impl Vectorized for FindPath<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> bool {
        let FindPath { geometry, ray, from, mut path } = self;
        let within = path.within;
        let Some(legal) = geometry.frame.legal(lanes, ray, within) else { return false };
        if let Some(from) = from
            && path.leave(geometry, ray, from.object, || *from).is_break()
        {
            return true;
        }
        let _ = geometry.ask(lanes, ray, within, legal, &mut path);
        path.blocked
    }
}

struct FindCrossings<'a> {
    geometry: &'a Geometry,
    ray: &'a Ray,
    query: Crossings<'a>,
}

impl Vectorized for FindCrossings<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let FindCrossings { geometry, ray, mut query } = self;
        let within = query.within;
        let Some(legal) = geometry.frame.legal(lanes, ray, within) else { return };
        if let Some((from, shape)) = geometry.departed(query.from) {
            let crossings = |each: &mut dyn FnMut(Hit)| shape.crossings_leaving(ray, within, from, each);
            if query::report(from.object, query.each, crossings).is_break() {
                return;
            }
        }
        let _ = geometry.ask(lanes, ray, within, legal, &mut query);
    }
}
