//! Scenes in the Neutral File Format, as the Standard Procedural Databases write them (Haines, *A Proposal for
//! Standard Graphics Environments*, IEEE Computer Graphics and Applications 7(11), 1987).
//!
//! White-space separated tokens, `#` starts a comment; line ends mean nothing.
//!
//! | entity | meaning here |
//! |---|---|
//! | `v from X Y Z at X Y Z up X Y Z angle A hither D resolution W H` | the camera; `hither` is ignored |
//! | `b R G B` | background, black if absent |
//! | `l X Y Z [R G B]` | point light without attenuation, white if no colour is given |
//! | `f R G B Kd Ks Shine T ior` | fill of all that follows: diffuse `Kd`, highlight and mirror `Ks`, transmission `T` |
//! | `s X Y Z r` | sphere |
//! | `c X Y Z r X Y Z r` | open cone, or open cylinder where the radii are equal |
//! | `p n (X Y Z)*n` | planar polygon, concave or not, counter-clockwise as seen from outside |
//! | `pp n (X Y Z NX NY NZ)*n` | the same with vertex normals, interpolated |
//!
//! The format leaves to the renderer: how bright the `n` lights are (each `sqrt(n) / (2 n)` of its colour, and so is
//! the ambient light); one or two sides (everything is drawn from both, so a negative radius, which asks for the inside
//! only, counts as its absolute value); the depth of rays (5, the eye ray counted). Mirror and transmitted rays are
//! weighted by `Ks` and `T` alone, without Fresnel. Equal fills are one material, and so one medium: a solid made of
//! loose polygons is told from its surroundings by their orientation.

mod fill;
mod polygon;
mod reader;
mod token;

pub use reader::load_nff;
