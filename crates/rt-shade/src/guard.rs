//! Shapes and textures of a stranger, kept from doing harm: a panic or a NaN ends the rendering with the object's name.
//!
//! Only [`Shape::Custom`](rt_core::Shape) and [`Texture::Custom`](crate::Texture) are guarded; the shapes and textures
//! of these crates do not panic and pay nothing.

use crate::{Color, Error, Pattern};
use rt_core::glam::DVec3;
use rt_core::{Aabb, Departure, Hit, Interval, Primitive, Ray, Surface};
use std::any::Any;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// What a stranger's code did wrong.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fault {
    pub object: u32,
    pub reason: String,
}

thread_local! {
    /// The first fault since [`take`] was called on this thread. A tile is rendered by one thread from beginning to end.
    static FAULT: RefCell<Option<Fault>> = const { RefCell::new(None) };
}

/// The first fault on this thread since the last call.
pub(crate) fn take() -> Option<Fault> {
    FAULT.with(|fault| fault.borrow_mut().take())
}

#[cold]
fn report(object: u32, reason: String) {
    FAULT.with(|fault| {
        fault.borrow_mut().get_or_insert(Fault { object, reason });
    });
}

fn message(what: &str, panic: &(dyn Any + Send)) -> String {
    let said = panic.downcast_ref::<&str>().copied().or(panic.downcast_ref::<String>().map(String::as_str));
    match said {
        Some(said) => format!("its {what} panicked: {said}"),
        None => format!("its {what} panicked"),
    }
}

/// The colour of a stranger's texture; black and a fault if it panics or returns what is no colour.
pub(crate) fn color(object: u32, pattern: &dyn Pattern, at: &Surface) -> Color {
    // Unwind safe: whatever state a panic leaves behind is the stranger's own, and the picture is given up.
    match catch_unwind(AssertUnwindSafe(|| pattern.color(at))) {
        Ok(color) if color.is_finite() && color.r >= 0.0 && color.g >= 0.0 && color.b >= 0.0 => color,
        Ok(color) => {
            report(
                object,
                format!("its texture returned the colour [{}, {}, {}]", color.r, color.g, color.b),
            );
            Color::BLACK
        }
        Err(panic) => {
            report(object, message("texture", &*panic));
            Color::BLACK
        }
    }
}

/// A stranger's shape, each call guarded.
#[derive(Debug)]
pub(crate) struct Guarded {
    object: u32,
    shape: Arc<dyn Primitive>,
    bounds: Option<Aabb>,
}

impl Guarded {
    /// Guards the shape of this object.
    ///
    /// # Errors
    /// [`Error::Object`] when its bounds panic or are no box.
    pub fn new(object: u32, name: &str, shape: Arc<dyn Primitive>) -> Result<Self, Error> {
        let error = |reason| Error::Object { object: name.to_owned(), reason };
        let bounds = catch_unwind(AssertUnwindSafe(|| shape.bounds()));
        let bounds = bounds.map_err(|panic| error(message("bounds", &*panic)))?;
        if let Some(Aabb { min, max }) = bounds
            && !(min.is_finite() && max.is_finite() && min.cmple(max).all())
        {
            return Err(error(format!("its bounds are no box: from {min} to {max}")));
        }
        Ok(Guarded { object, shape, bounds })
    }

    fn call<T>(&self, what: &str, otherwise: T, call: impl FnOnce(&dyn Primitive) -> T) -> T {
        match catch_unwind(AssertUnwindSafe(|| call(&*self.shape))) {
            Ok(value) => value,
            Err(panic) => {
                report(self.object, message(what, &*panic));
                otherwise
            }
        }
    }

    /// The hit, if it lies inside the interval as promised.
    fn admit(&self, within: Interval, hit: Hit) -> Option<Hit> {
        let admitted = within.admit(hit.t(), hit.part(), hit.root());
        if admitted.is_none() {
            let (t, min, max) = (hit.t(), within.min, within.max);
            report(self.object, format!("its hit at t = {t} lies outside the interval from {min} to {max}"));
        }
        admitted
    }
}

impl Primitive for Guarded {
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let hit = self.call("hit", None, |shape| shape.hit(ray, within))?;
        self.admit(within, hit)
    }

    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        self.call("crossings", (), |shape| {
            shape.crossings(ray, within, &mut |hit| {
                if let Some(hit) = self.admit(within, hit) {
                    each(hit);
                }
            });
        });
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let up = Surface::new(hit.t(), DVec3::ZERO, DVec3::ZERO, DVec3::Y, 0.0);
        let surface = self.call("surface", up, |shape| shape.surface(ray, hit));
        match unfit(&surface) {
            None => surface,
            Some(what) => {
                report(self.object, format!("its surface has a bad {what}: {surface:?}"));
                up
            }
        }
    }

    fn bounds(&self) -> Option<Aabb> {
        self.bounds
    }

    fn hit_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Hit> {
        let hit = self.call("hit_leaving", None, |shape| shape.hit_leaving(ray, within, from))?;
        self.admit(within, hit)
    }

    fn crossings_leaving(&self, ray: &Ray, within: Interval, from: &Departure, each: &mut dyn FnMut(Hit)) {
        self.call("crossings_leaving", (), |shape| {
            shape.crossings_leaving(ray, within, from, &mut |hit| {
                if let Some(hit) = self.admit(within, hit) {
                    each(hit);
                }
            });
        });
    }
}

/// What is wrong with a surface record: NaN, infinity, or a normal that is not of unit length even in `f32`.
fn unfit(s: &Surface) -> Option<&'static str> {
    let is_unit = |n: DVec3| (n.length_squared() - 1.0).abs() < f64::from(f32::EPSILON);
    match s {
        s if !s.t.is_finite() => Some("t"),
        s if !(s.point.is_finite() && s.local.is_finite() && s.object_point.is_finite()) => Some("point"),
        s if !is_unit(s.normal) || !is_unit(s.shading_normal) => Some("normal"),
        s if !s.uv().is_finite() => Some("uv"),
        s if !(s.error >= 0.0 && s.error.is_finite()) => Some("error radius"),
        _ => None,
    }
}
