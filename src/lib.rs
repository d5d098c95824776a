#![doc = "Exact, fast ray tracing of analytic shapes: the two libraries under one name."]
#![forbid(unsafe_code)]

pub use rt_core as core;
pub use rt_shade as shade;
