//! Products that are counted: how much work a piece of arithmetic is, the same on every machine.

use super::{Dekker, Product, Task};
use core::cell::Cell;

extern crate std;

std::thread_local! {
    static PRODUCTS: Cell<u64> = const { Cell::new(0) };
    static STEPS: Cell<u64> = const { Cell::new(0) };
}

/// Counts a step of a search in plain `f64`.
pub fn step() {
    STEPS.set(STEPS.get() + 1);
}

/// The steps counted so far.
pub fn steps() -> u64 {
    STEPS.get()
}

/// [`Dekker`], counted.
#[derive(Clone, Copy, Debug)]
pub struct Counted;

impl Product for Counted {
    fn two_product(a: f64, b: f64) -> (f64, f64) {
        PRODUCTS.set(PRODUCTS.get() + 1);
        Dekker::two_product(a, b)
    }
}

/// What a task computes, and how many exact products that takes.
pub fn counted<T: Task>(task: T) -> (T::Output, u64) {
    let before = PRODUCTS.get();
    let output = task.run::<Counted>();
    (output, PRODUCTS.get() - before)
}
