//! Scenes as text.

pub mod shape;
mod suggest;
