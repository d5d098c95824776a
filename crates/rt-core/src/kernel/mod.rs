//! Instruction sets, picked at run time: the only module with `unsafe` code.
//!
//! Whatever is detected, the results are the same bits: fused multiply-add is used for error-free products only
//! (where it computes exactly what Dekker's splitting computes), and vector code only culls.
#![allow(unsafe_code)]

mod level;
mod task;

pub use level::{Level, level, set_level};
pub use task::{Dekker, Fused, Product, Task, run, run_portable};
