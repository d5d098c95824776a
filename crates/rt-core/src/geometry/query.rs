//! What is asked of the shapes that a ray may meet. No answer depends on the order in which they are seen.

use super::frame::Window;
use super::rings::Together;
use super::store::Run;
use super::{Found, Geometry};
use crate::{Departure, Hit, Interval, Primitive, Ray, Shape};
use core::cmp::Ordering;
use core::ops::ControlFlow;

/// A question about a ray, answered by showing it shapes.
pub(super) trait Query {
    /// Whether near shapes are best seen first: a hit then spares those behind it.
    const NEAREST_FIRST: bool = true;
    /// Hits beyond this parameter by more than the [`Window`] do not matter any more.
    fn end(&self) -> f64;
    /// Shows it tori of the store; false if it wants to see them one by one.
    #[inline(always)]
    fn defer(&mut self, _tori: Run) -> bool {
        false
    }
    /// Shows it a shape; breaks when nothing more needs to be seen.
    fn visit<P: Primitive>(&mut self, ray: &Ray, object: u32, shape: &P) -> ControlFlow<()>;
}

/// Which hit is nearest, and whether another object's is too close to be sure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// What every shape is asked about, also when nearer hits are known: the last bits of a parameter may depend on an
    /// interval that ends beside it, and must not depend on the order of visits.
    within: Interval,
    /// The parameter of the best hit, or the end of the interval.
    end: f64,
    skip: Option<u32>,
    best: Option<Found>,
    /// The least parameter of all other objects seen.
    runner_up: f64,
}

impl Nearest {
    #[inline(always)]
    pub fn new(within: Interval, skip: Option<u32>) -> Self {
        Nearest { within, end: within.max, skip, best: None, runner_up: f64::INFINITY }
    }

    /// What every shape is asked about.
    #[inline(always)]
    pub fn within(&self) -> Interval {
        self.within
    }

    /// Takes a hit into account.
    #[inline(always)]
    pub fn offer(&mut self, object: u32, hit: Hit) {
        let t = hit.t();
        match self.best {
            Some(best) if t >= best.hit.t() => self.runner_up = self.runner_up.min(t),
            before => {
                if let Some(before) = before {
                    self.runner_up = self.runner_up.min(before.hit.t());
                }
                self.best = Some(Found { object, hit });
                self.end = t;
            }
        }
    }

    /// Hits from this parameter on do not matter any more, with the window of ties that the ray has.
    #[inline(always)]
    pub fn limit(&self, window: Window) -> f64 {
        window.limit(self.end).min(self.within.max)
    }

    /// What was found, unless that is [contested](Nearest::contested).
    #[inline(always)]
    pub fn best(&self) -> Option<Found> {
        self.best
    }

    /// Where the hits end of which several objects have one, too close for their order to be sure. The window is asked for where
    /// several objects have a hit: most rays meet no other.
    #[inline(always)]
    pub fn contested(&self, window: impl FnOnce() -> Window) -> Option<f64> {
        if self.runner_up == f64::INFINITY || self.best.is_none() {
            return None;
        }
        let limit = self.limit(window());
        (self.runner_up < limit).then_some(limit)
    }
}

impl Query for Nearest {
    #[inline(always)]
    fn end(&self) -> f64 {
        self.end
    }
    #[inline(always)]
    fn visit<P: Primitive>(&mut self, ray: &Ray, object: u32, shape: &P) -> ControlFlow<()> {
        if self.skip != Some(object)
            && let Some(hit) = shape.hit(ray, self.within)
        {
            self.offer(object, hit);
        }
        ControlFlow::Continue(())
    }
}

impl Together for Nearest {
    const PLACES: bool = true;
    #[inline(always)]
    fn asks(&self, object: u32) -> Option<Interval> {
        (self.skip != Some(object)).then_some(self.within)
    }
    #[inline(always)]
    fn meet(&mut self, object: u32, hit: Hit) -> ControlFlow<()> {
        self.offer(object, hit);
        ControlFlow::Continue(())
    }
}

/// Which of the hits before a limit comes first: by refined parameter, then those that leave a solid before
/// those that enter one, then by index.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contest {
    /// What every shape is asked about: the winner's hit is then the one that [`Nearest`] saw, to the last bit.
    within: Interval,
    limit: f64,
    skip: Option<u32>,
    best: Option<(Found, f64, bool)>,
}

impl Contest {
    pub fn new(within: Interval, limit: f64, skip: Option<u32>) -> Self {
        Contest { within, limit, skip, best: None }
    }

    pub fn offer<P: Primitive>(&mut self, ray: &Ray, object: u32, shape: &P, hit: Hit) {
        let surface = shape.surface(ray, hit);
        let t = if surface.t.is_nan() { hit.t() } else { surface.t };
        let entering = !(ray.direction.dot(surface.normal) > 0.0);
        let before = |(best, best_t, best_entering): &(Found, f64, bool)| {
            let order = t.partial_cmp(best_t).unwrap_or(Ordering::Equal);
            order.then(entering.cmp(best_entering)).then(object.cmp(&best.object)) == Ordering::Less
        };
        if self.best.as_ref().is_none_or(before) {
            self.best = Some((Found { object, hit }, t, entering));
        }
    }

    pub fn winner(&self) -> Option<Found> {
        self.best.map(|(found, ..)| found)
    }
}

impl Query for Contest {
    #[inline(always)]
    fn end(&self) -> f64 {
        self.limit
    }
    #[inline(always)]
    fn visit<P: Primitive>(&mut self, ray: &Ray, object: u32, shape: &P) -> ControlFlow<()> {
        if self.skip != Some(object)
            && let Some(hit) = shape.hit(ray, self.within)
            && hit.t() < self.limit
        {
            self.offer(ray, object, shape, hit);
        }
        ControlFlow::Continue(())
    }
}

/// Whether anything is hit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Any {
    within: Interval,
    skip: Option<u32>,
    pub found: bool,
}

impl Any {
    #[inline(always)]
    pub fn new(within: Interval, skip: Option<u32>) -> Self {
        Any { within, skip, found: false }
    }
}

impl Query for Any {
    const NEAREST_FIRST: bool = false;
    #[inline(always)]
    fn end(&self) -> f64 {
        self.within.max
    }
    #[inline(always)]
    fn visit<P: Primitive>(&mut self, ray: &Ray, object: u32, shape: &P) -> ControlFlow<()> {
        if self.skip != Some(object) && shape.hit(ray, self.within).is_some() {
            self.found = true;
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

impl Together for Any {
    const PLACES: bool = false;
    #[inline(always)]
    fn asks(&self, object: u32) -> Option<Interval> {
        (self.skip != Some(object) && !self.found).then_some(self.within)
    }
    #[inline(always)]
    fn meet(&mut self, _: u32, _: Hit) -> ControlFlow<()> {
        self.found = true;
        ControlFlow::Break(())
    }
}

/// What an object does to a ray that asks for a [path](super::Geometry::blocked).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Screen {
    /// It blocks the ray.
    Opaque,
    /// The ray goes on; each crossing is reported.
    Sheer,
    /// It is not there.
    Absent,
}

/// Whether anything opaque is hit, and what is crossed otherwise.
pub(super) struct Path<'a> {
    pub within: Interval,
    pub skip: Option<u32>,
    pub screens: &'a [Screen],
    pub each: &'a mut dyn FnMut(Found),
    pub blocked: bool,
}

impl Path<'_> {
    #[inline(always)]
    pub fn screen(&self, object: u32) -> Screen {
        self.screens.get(object as usize).copied().unwrap_or(Screen::Opaque)
    }

    /// Shows it the shape that the ray leaves.
    #[inline(always)]
    pub fn leave(
        &mut self,
        geometry: &Geometry,
        ray: &Ray,
        object: u32,
        from: impl FnOnce() -> Departure,
    ) -> ControlFlow<()> {
        let within = self.within;
        let Some(shape) = geometry.shapes.get(object as usize) else { return ControlFlow::Continue(()) };
        // No ray comes back to a plane: most need not say where they leave.
        if let Shape::Plane(_) = shape {
            return ControlFlow::Continue(());
        }
        let from = &from();
        match self.screen(object) {
            Screen::Opaque if shape.hit_leaving(ray, within, from).is_some() => {
                self.blocked = true;
                return ControlFlow::Break(());
            }
            Screen::Sheer => {
                shape.crossings_leaving(ray, within, from, &mut |hit| (self.each)(Found { object, hit }));
            }
            Screen::Opaque | Screen::Absent => {}
        }
        ControlFlow::Continue(())
    }
}

impl Query for Path<'_> {
    #[inline(always)]
    fn end(&self) -> f64 {
        self.within.max
    }
    #[inline(always)]
    fn visit<P: Primitive>(&mut self, ray: &Ray, object: u32, shape: &P) -> ControlFlow<()> {
        if self.skip == Some(object) {
            return ControlFlow::Continue(());
        }
        match self.screen(object) {
            Screen::Opaque if shape.hit(ray, self.within).is_some() => {
                self.blocked = true;
                return ControlFlow::Break(());
            }
            Screen::Sheer => shape.crossings(ray, self.within, &mut |hit| (self.each)(Found { object, hit })),
            Screen::Opaque | Screen::Absent => {}
        }
        ControlFlow::Continue(())
    }
}

/// All crossings, reported one by one.
pub(super) struct Crossings<'a> {
    pub within: Interval,
    pub from: Option<&'a Departure>,
    pub each: &'a mut dyn FnMut(Found) -> ControlFlow<()>,
}

impl Query for Crossings<'_> {
    #[inline(always)]
    fn end(&self) -> f64 {
        self.within.max
    }
    #[inline(always)]
    fn visit<P: Primitive>(&mut self, ray: &Ray, object: u32, shape: &P) -> ControlFlow<()> {
        if self.from.is_some_and(|from| from.object == object) {
            return ControlFlow::Continue(());
        }
        report(object, self.each, |each| shape.crossings(ray, self.within, each))
    }
}

/// Passes the crossings of one object on until `each` breaks.
pub(super) fn report(
    object: u32,
    each: &mut dyn FnMut(Found) -> ControlFlow<()>,
    crossings: impl FnOnce(&mut dyn FnMut(Hit)),
) -> ControlFlow<()> {
    let mut flow = ControlFlow::Continue(());
    crossings(&mut |hit| {
        if flow.is_continue() {
            flow = each(Found { object, hit });
        }
    });
    flow
}
