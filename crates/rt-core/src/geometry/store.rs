//! The shapes by kind, each kind in the order of the leaves: what a ray touches, without the width of [`Shape`].

use super::query::Query;
use crate::kernel::{Lanes, prefetch, prefetch_lines};
use crate::shape::{Cone, Cuboid, Cylinder, Disk, Plane, Sphere, Torus, Triangle};
use crate::{Departure, Hit, Interval, Primitive, Ray, Shape, Surface};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::ops::ControlFlow;

/// Consecutive shapes of one kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub kind: u32,
    pub first: usize,
    pub count: usize,
}

/// The shapes of one kind and the objects they belong to.
#[derive(Clone, Debug)]
struct Column<P> {
    shapes: Vec<P>,
    objects: Vec<u32>,
}

impl<P> Default for Column<P> {
    fn default() -> Self {
        Column { shapes: Vec::new(), objects: Vec::new() }
    }
}

impl<P: Primitive> Column<P> {
    fn push(&mut self, shape: P, object: u32) {
        self.shapes.push(shape);
        self.objects.push(object);
    }

    fn reserve(&mut self, count: usize) {
        self.shapes = crate::kernel::vec_on_large_pages(count);
        self.objects = crate::kernel::vec_on_large_pages(count);
    }

    fn bytes(&self) -> usize {
        self.shapes.capacity() * size_of::<P>() + self.objects.capacity() * size_of::<u32>()
    }

    #[inline(always)]
    fn prefetch<L: Lanes>(&self, lanes: L, first: usize) {
        if let (Some(shape), Some(object)) = (self.shapes.get(first), self.objects.get(first)) {
            lanes.prefetch(shape);
            lanes.prefetch(object);
        }
    }

    #[inline(always)]
    fn visit<Q: Query>(&self, run: Run, ray: &Ray, query: &mut Q) -> ControlFlow<()> {
        let range = run.first..run.first + run.count;
        if let (Some(shapes), Some(objects)) = (self.shapes.get(range.clone()), self.objects.get(range)) {
            for (shape, &object) in shapes.iter().zip(objects) {
                query.visit(ray, object, shape)?;
            }
        }
        ControlFlow::Continue(())
    }
}

macro_rules! store {
    ($($index:literal $field:ident $kind:ident $type:ty;)*) => {
        /// All shapes, by kind.
        #[derive(Clone, Debug, Default)]
        pub(super) struct Store {
            $($field: Column<$type>,)*
            /// By object: kind and index. Empty where shapes are few, or not in the store.
            places: Vec<u32>,
        }

        impl Store {
            /// The kind of spheres.
            pub const BALL: u32 = 0;

            /// The kind of tori.
            pub const RING: u32 = 5;

            /// The bits of an index within a kind.
            const INDEX_BITS: u32 = 28;

            /// A place of a kind that does not exist.
            const NOWHERE: u32 = u32::MAX;

            /// The number of kinds.
            pub const KINDS: usize = [$($index),*].len();

            /// The number of the shape's kind.
            pub fn kind_of(shape: &Shape) -> u32 {
                match shape {
                    $(Shape::$kind(_) => $index,)*
                }
            }

            /// Makes room for this many shapes of each kind, before any is added.
            pub fn reserve(&mut self, counts: [usize; Self::KINDS]) {
                $(self.$field.reserve(counts[$index]);)*
            }

            /// Makes room for the places of this many objects, before any is added.
            pub fn remember_places(&mut self, count: usize) {
                self.places = crate::kernel::vec_on_large_pages(count);
                self.places.resize(count, Self::NOWHERE);
            }

            /// Adds a shape at the end of its kind.
            pub fn push(&mut self, shape: &Shape, object: u32) {
                let (kind, index) = (Self::kind_of(shape), self.count(Self::kind_of(shape)));
                if index < 1 << Self::INDEX_BITS && let Some(place) = self.places.get_mut(object as usize) {
                    *place = kind << Self::INDEX_BITS | index as u32;
                }
                match shape {
                    $(Shape::$kind(shape) => self.$field.push(shape.clone(), object),)*
                }
            }

            /// The number of shapes of this kind so far.
            pub fn count(&self, kind: u32) -> usize {
                match kind {
                    $($index => self.$field.objects.len(),)*
                    _ => 0,
                }
            }

            /// The bytes of memory in use.
            pub fn bytes(&self) -> usize {
                self.places.capacity() * size_of::<u32>() $(+ self.$field.bytes())*
            }

            /// Kind and index of an object; one of no kind where they are not known.
            #[inline(always)]
            fn place(&self, object: u32) -> (u32, usize) {
                let place = self.places.get(object as usize).copied().unwrap_or(Self::NOWHERE);
                (place >> Self::INDEX_BITS, (place & ((1 << Self::INDEX_BITS) - 1)) as usize)
            }

            /// Whether an object may be of a kind of which one object's records are made four at a time, as far as is known without a
            /// look at it: among many objects that look takes longer than a record.
            #[inline(always)]
            pub fn may_go_by_four(&self, object: u32) -> bool {
                match self.place(object).0 {
                    $(kind if kind == $index => matches!(stringify!($kind), "Plane" | "Cylinder" | "Cone"),)*
                    _ => true,
                }
            }

            /// [`Primitive::surface`] of an object, which is one of `shapes`: the copy here was just seen by the search.
            #[inline]
            pub fn surface(&self, shapes: &[Shape], object: u32, ray: &Ray, hit: Hit) -> Surface {
                match self.place(object) {
                    $(($index, index) if index < self.$field.shapes.len() => {
                        self.$field.shapes[index].surface(ray, hit)
                    })*
                    _ => shapes[object as usize].surface(ray, hit),
                }
            }

            /// [`Primitive::hit_leaving`] of the object that is left, if it is one of `shapes`.
            #[inline]
            pub fn hit_leaving(
                &self,
                shapes: &[Shape],
                ray: &Ray,
                within: Interval,
                from: &Departure,
            ) -> Option<Hit> {
                match self.place(from.object) {
                    $(($index, index) if index < self.$field.shapes.len() => {
                        self.$field.shapes[index].hit_leaving(ray, within, from)
                    })*
                    _ => shapes.get(from.object as usize)?.hit_leaving(ray, within, from),
                }
            }

            /// Asks for the memory of an object, one of `shapes`.
            #[inline]
            pub fn prefetch_object(&self, shapes: &[Shape], object: u32) {
                match self.place(object) {
                    $(($index, index) if index < self.$field.shapes.len() => {
                        // A record takes all of it.
                        prefetch_lines(&self.$field.shapes[index], 6);
                    })*
                    _ => {
                        if let Some(shape) = shapes.get(object as usize) {
                            prefetch(shape);
                        }
                    }
                }
            }

            /// Asks for the memory of the run's first shape.
            #[inline(always)]
            pub fn prefetch<L: Lanes>(&self, lanes: L, run: Run) {
                match run.kind {
                    $($index => self.$field.prefetch(lanes, run.first),)*
                    _ => (),
                }
            }

            /// Shows the shapes of the run to the query, until it has seen enough.
            #[inline(always)]
            pub fn visit<Q: Query>(&self, run: Run, ray: &Ray, query: &mut Q) -> ControlFlow<()> {
                if run.kind == Self::RING && query.defer(run) {
                    return ControlFlow::Continue(());
                }
                match run.kind {
                    $($index => self.$field.visit(run, ray, query),)*
                    _ => ControlFlow::Continue(()),
                }
            }
        }
    };
}

store! {
    0 spheres Sphere Sphere;
    1 planes Plane Plane;
    2 cuboids Cuboid Cuboid;
    3 cylinders Cylinder Cylinder;
    4 cones Cone Cone;
    5 tori Torus Torus;
    6 disks Disk Disk;
    7 triangles Triangle Triangle;
    8 customs Custom Arc<dyn Primitive>;
}

impl Store {
    /// The torus of this index, and its object.
    #[inline(always)]
    pub fn torus(&self, index: usize) -> Option<(&Torus, u32)> {
        Some((self.tori.shapes.get(index)?, *self.tori.objects.get(index)?))
    }

    /// The torus that an object is, which is one of `shapes`; none where it is something else.
    #[inline(always)]
    pub fn ring<'a>(&'a self, shapes: &'a [Shape], object: u32) -> Option<&'a Torus> {
        match self.by_four(shapes, object) {
            Some(ByFour::Torus(torus)) => Some(torus),
            _ => None,
        }
    }

    /// What an object is, which is one of `shapes`, if records of its kind are made four at a time, each with an object of its
    /// own.
    #[inline(always)]
    pub fn by_four<'a>(&'a self, shapes: &'a [Shape], object: u32) -> Option<ByFour<'a>> {
        match self.place(object) {
            (Self::RING, index) => self.tori.shapes.get(index).map(ByFour::Torus),
            (Self::BALL, index) => self.spheres.shapes.get(index).map(ByFour::Sphere),
            (kind, _) if (kind as usize) < Self::KINDS => None,
            _ => match shapes.get(object as usize) {
                Some(Shape::Torus(torus)) => Some(ByFour::Torus(torus)),
                Some(Shape::Sphere(sphere)) => Some(ByFour::Sphere(sphere)),
                _ => None,
            },
        }
    }
}

/// See [`Store::by_four`].
pub(super) enum ByFour<'a> {
    Sphere(&'a Sphere),
    Torus(&'a Torus),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bytes_are_those_of_the_shapes_and_their_indices() {
        let mut store = Store::default();
        assert_eq!(store.bytes(), 0);
        let (mut counts, least) = ([0; Store::KINDS], 1000 * (size_of::<Sphere>() + 4));
        counts[Store::BALL as usize] = 1000;
        store.reserve(counts);
        let sphere = Shape::from(Sphere::new([0.0; 3], 1.0).unwrap());
        (0..1000).for_each(|object| store.push(&sphere, object));
        assert_eq!(store.count(Store::BALL), 1000);
        // Memory comes in pages, and may be more than was asked for.
        assert!((least..2 * least).contains(&store.bytes()), "{} {least}", store.bytes());
    }
}
