//! Whitted's shading.
