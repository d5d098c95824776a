//! The command `rt`.
#![forbid(unsafe_code)]

fn main() {}
