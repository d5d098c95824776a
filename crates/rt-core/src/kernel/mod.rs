//! Instruction sets, picked at run time: the only module with `unsafe` code.
//!
//! Whatever is detected, the results are the same bits: fused multiply-add is used for error-free products only
//! (where it computes exactly what Dekker's splitting computes), and `f32` lanes only cull. The `f64` lanes of [`Pair`] and
//! [`Four`] round as numbers by themselves do on every machine.
#![allow(unsafe_code)]

mod avx2;
mod boxes;
#[cfg(test)]
pub(crate) mod counted;
mod lanes;
mod level;
mod memory;
mod packet;
mod pair;
mod real;
mod stack;
mod task;
#[cfg(test)]
mod tests;
mod triple;

pub use boxes::{Boxes, Row, SlabRay, at_least, at_most, outward_step};
pub use lanes::{Lanes, PortableLanes, Vectorized};
pub use level::{Level, level, set_level};
pub(crate) use memory::{prefetch, prefetch_lines, vec_on_large_pages};
pub use packet::{Beam, BeamShape, EightRays};
pub use pair::{Pair, Pairs};
pub use real::{Four, Real, Twice, Vector};
pub use stack::{Room, Stack};
pub use task::{Dekker, Fused, Product, Solver, Task, run, run_portable, solve};
#[cfg(test)]
pub(crate) use triple::PairedSlabs;
#[cfg(all(test, target_arch = "x86_64", feature = "std"))]
pub(crate) use triple::wide::WideSlabs;
pub(crate) use triple::{Clipped, Planes, SlabLanes, clip};

/// Runs the computation with the widest lanes of the [`level`] in use.
#[inline(always)]
pub fn vectorize<V: Vectorized>(task: V) -> V::Output {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    if level() >= Level::Avx2 {
        // SAFETY: the level is Avx2 only after run-time detection of all that `avx2::run` names.
        return unsafe { avx2::run(task) };
    }
    portable(task)
}

/// Not in place: its room on the stack would be that of the other way, too.
#[inline(never)]
fn portable<V: Vectorized>(task: V) -> V::Output {
    task.run(PortableLanes)
}
