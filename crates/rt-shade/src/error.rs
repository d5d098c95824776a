//! What can be wrong with a scene, its pictures and its rendering.

use rt_core::glam::DVec3;

/// Why a scene, a part of one or a picture could not be made. Every variant carries the offending value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number out of its range (or NaN).
    #[error("{what} must be {range}, got {value}")]
    Number {
        /// What the number is.
        what: &'static str,
        /// What it may be.
        range: &'static str,
        /// The value given.
        value: f64,
    },
    /// A point or vector with a NaN or infinite component.
    #[error("{what} must be finite, got [{}, {}, {}]", value.x, value.y, value.z)]
    NotFinite {
        /// What the point or vector is.
        what: &'static str,
        /// The value given.
        value: DVec3,
    },
    /// A colour with a channel that is negative, NaN or above 1e30.
    #[error("{what} must have channels from 0 to 1e30, got [{}, {}, {}]", value[0], value[1], value[2])]
    Color {
        /// What the colour is.
        what: &'static str,
        /// The value given.
        value: [f64; 3],
    },
    /// Two points that must differ are the same.
    #[error("{what} must differ, both are [{}, {}, {}]", value.x, value.y, value.z)]
    Coincident {
        /// Which two points.
        what: &'static str,
        /// Where both are.
        value: DVec3,
    },
    /// The camera's `up` is zero or parallel to the view.
    #[error("camera up must not be parallel to the view, got [{}, {}, {}]", up.x, up.y, up.z)]
    Up {
        /// The vector given.
        up: DVec3,
    },
    /// A width or height out of range.
    #[error("{what} must be from 1 to {most}, got {value}")]
    Size {
        /// What the size is.
        what: &'static str,
        /// The value given.
        value: u64,
        /// The largest legal value.
        most: u64,
    },
    /// A region that does not lie inside the picture.
    #[error(
        "the region {x},{y},{width},{height} must lie inside the picture of {picture_width} x {picture_height} pixels and not be empty"
    )]
    Region {
        /// Its left column.
        x: u32,
        /// Its top row.
        y: u32,
        /// Its columns.
        width: u32,
        /// Its rows.
        height: u32,
        /// Columns of the picture.
        picture_width: u32,
        /// Rows of the picture.
        picture_height: u32,
    },
    /// Words that name no way of anti-aliasing.
    #[error(
        "antialias must be none, grid:N (N from 1 to 64) or adaptive[:THRESHOLD:DEPTH] (0 to 1, 1 to 6), got {text:?}"
    )]
    Antialias {
        /// The words given.
        text: String,
    },
    /// An object names a material that the scene does not have.
    #[error("object {object:?}: there is no material {material}, the scene has {count}")]
    NoMaterial {
        /// The object's name.
        object: String,
        /// The index given.
        material: u32,
        /// How many the scene has.
        count: usize,
    },
    /// A material names a texture that the scene does not have.
    #[error("material {material}: there is no texture {texture}, the scene has {count}")]
    NoTexture {
        /// The index of the material.
        material: u32,
        /// The index given.
        texture: u32,
        /// How many the scene has.
        count: usize,
    },
    /// Something is wrong with one material.
    #[error("material {material}: {source}")]
    Material {
        /// The index of the material.
        material: u32,
        /// What is wrong.
        source: Box<Error>,
    },
    /// A scene without a camera.
    #[error("the scene has no camera")]
    NoCamera,
    /// More objects than can be numbered.
    #[error("a scene holds at most {most} objects, got {count}")]
    TooManyObjects {
        /// How many were given.
        count: usize,
        /// The most there can be.
        most: usize,
    },
    /// Picture data that cannot be decoded.
    #[error("the picture cannot be read: {reason}")]
    Decode {
        /// What is wrong with it.
        reason: String,
    },
    /// A picture that could not be encoded.
    #[error("the picture cannot be written: {reason}")]
    Encode {
        /// What went wrong.
        reason: String,
    },
    /// A shape or texture of your own panicked or returned NaN.
    #[error("object {object:?}: {reason}")]
    Object {
        /// The object's name.
        object: String,
        /// What it did.
        reason: String,
    },
    /// There is no memory for a picture.
    #[error("there is no memory for a picture of {bytes} bytes")]
    Memory {
        /// The bytes it takes.
        bytes: u128,
    },
    /// The threads could not be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// Why not.
        reason: String,
    },
}
