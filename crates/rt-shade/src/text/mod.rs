//! Scenes as text.

mod diagnostic;
mod reader;
pub mod shape;
mod suggest;

pub use diagnostic::{Diagnostic, Diagnostics, MOST_ERRORS};
