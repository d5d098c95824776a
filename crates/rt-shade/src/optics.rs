//! Mirror and refraction.
