//! The torus' own axes, to double-double accuracy.

use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::{Product, Task};
use crate::math::exponent;
use crate::scaled::{largest, times_power};
use glam::DVec3;

/// The right-handed orthonormal frame whose third axis is `axis` and whose first is `hint` made perpendicular to it.
///
/// Without a hint the coordinate axis that is most nearly perpendicular is taken, the first of equals.
pub(super) struct Frame {
    /// The third axis, of any length but zero.
    pub axis: DVec3,
    /// Roughly the first axis.
    pub hint: Option<DVec3>,
}

impl Task for Frame {
    type Output = [DoubleVector; 3];

    #[inline(always)]
    fn run<P: Product>(self) -> [DoubleVector; 3] {
        // Twice, since the exponent of a subnormal number cannot be read.
        let axis = prescaled(prescaled(self.axis));
        let axis = normalized::<P>(DoubleVector::from(axis));
        let hint = DoubleVector::from(self.hint.unwrap_or_else(|| most_perpendicular(axis.high())));
        let first = normalized::<P>(hint - axis.mul::<P>(hint.dot::<P>(axis)));
        [first, cross::<P>(axis, first), axis]
    }
}

fn prescaled(v: DVec3) -> DVec3 {
    let power = -exponent(largest(v));
    DVec3::new(times_power(v.x, power), times_power(v.y, power), times_power(v.z, power))
}

fn most_perpendicular(axis: DVec3) -> DVec3 {
    let size = axis.abs();
    if size.x <= size.y && size.x <= size.z {
        DVec3::X
    } else if size.y <= size.z {
        DVec3::Y
    } else {
        DVec3::Z
    }
}

#[inline(always)]
fn normalized<P: Product>(v: DoubleVector) -> DoubleVector {
    v.mul::<P>(Double::ONE.div::<P>(v.length_squared::<P>().sqrt::<P>()))
}

#[inline(always)]
fn cross<P: Product>(a: DoubleVector, b: DoubleVector) -> DoubleVector {
    DoubleVector {
        x: a.y.mul::<P>(b.z) - a.z.mul::<P>(b.y),
        y: a.z.mul::<P>(b.x) - a.x.mul::<P>(b.z),
        z: a.x.mul::<P>(b.y) - a.y.mul::<P>(b.x),
    }
}
