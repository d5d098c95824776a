//! Anti-aliasing.
