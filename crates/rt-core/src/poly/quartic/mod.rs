//! Degree four: three methods with one signature.

mod certified;
pub(super) mod discs;
pub(super) mod factors;
mod ferrari;
mod graphics_gems;
pub(super) mod split;
#[cfg(test)]
mod tests;

use super::{Roots, cubic};
use crate::Interval;

pub(super) use certified::all_roots;
pub use certified::{double, quartic};
pub use ferrari::ferrari;
pub use graphics_gems::graphics_gems;

/// What the closed forms do when there is no term of degree four.
fn lower_degree([c0, c1, c2, c3, c4]: [f64; 5], within: Interval) -> Roots<4> {
    if !c4.is_finite() {
        return Roots::default();
    }
    cubic([c0, c1, c2, c3], within).within(within)
}

/// The finite roots inside the interval, equal ones (which are neighbours) put together.
fn gathered(found: &Roots<4>, within: Interval) -> Roots<4> {
    let mut roots = Roots::default();
    let mut i = 0;
    while let Some(root) = found.get(i) {
        let equal = found.iter().skip(i).take_while(|r| r.x == root.x).count().max(1);
        if within.contains(root.x) && root.x.is_finite() {
            roots.push(root.x, equal as u32);
        }
        i += equal;
    }
    roots
}
