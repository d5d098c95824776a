//! What can be wrong with a shape.

use glam::DVec3;

/// Why a shape could not be made. Every variant carries the offending value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A length that must be positive and finite is not.
    #[error("{what} must be greater than 0 and finite, got {value}")]
    NotPositive {
        /// What the length is.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// A length that must be zero or more and finite is not.
    #[error("{what} must be at least 0 and finite, got {value}")]
    Negative {
        /// What the length is.
        what: &'static str,
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
    /// A direction of length zero.
    #[error("{what} must not have length 0, got [{}, {}, {}]", value.x, value.y, value.z)]
    ZeroLength {
        /// What the direction is.
        what: &'static str,
        /// The value given.
        value: DVec3,
    },
    /// Both ends of an axis are the same point.
    #[error("{what} must differ, both are [{}, {}, {}]", value.x, value.y, value.z)]
    Coincident {
        /// Which two points.
        what: &'static str,
        /// Where both are.
        value: DVec3,
    },
    /// The corners of a box in the wrong order.
    #[error("min must not exceed max in any coordinate, got min [{}, {}, {}] and max [{}, {}, {}]", min.x, min.y, min.z, max.x, max.y, max.z)]
    Unordered {
        /// The corner given as the least.
        min: DVec3,
        /// The corner given as the greatest.
        max: DVec3,
    },
    /// Three vertices on a line.
    #[error("the triangle has no area: its vertices lie on a line")]
    Degenerate {
        /// The vertices.
        vertices: [DVec3; 3],
    },
    /// A size or coordinate too large or too small for exact arithmetic in `f64`.
    #[error("{what} is out of the supported range of 1e-150 to 1e150, got {value}")]
    OutOfRange {
        /// What is out of range.
        what: &'static str,
        /// The value given.
        value: f64,
    },
}
