//! The media that a ray is in.
