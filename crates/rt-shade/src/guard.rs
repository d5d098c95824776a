//! Shapes and textures of a stranger, kept from doing harm: a panic or a NaN ends the rendering with the object's name.

use crate::Color;
use std::cell::RefCell;

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
pub(crate) fn report(object: u32, reason: String) {
    FAULT.with(|fault| {
        fault.borrow_mut().get_or_insert(Fault { object, reason });
    });
}

/// The colour, or black and a fault if it is not finite.
#[inline]
pub(crate) fn checked_color(object: u32, color: Color) -> Color {
    if color.is_finite() {
        return color;
    }
    report(object, format!("its texture returned [{}, {}, {}]", color.r, color.g, color.b));
    Color::BLACK
}
