//! The torus' own axes, to double-double accuracy.

use super::approach::{Vector, dot_double};
use crate::double::Double;
use crate::kernel::{Product, Task};
use crate::math::exponent;
use glam::DVec3;

#[inline(always)]
fn along<P: Product>(v: &Vector, factor: Double) -> Vector {
    [v[0].mul::<P>(factor), v[1].mul::<P>(factor), v[2].mul::<P>(factor)]
}

fn normalized<P: Product>(v: &Vector) -> Vector {
    let length = dot_double::<P>(v, v).sqrt::<P>();
    [v[0].div::<P>(length), v[1].div::<P>(length), v[2].div::<P>(length)]
}

fn cross<P: Product>(a: &Vector, b: &Vector) -> Vector {
    let minor = |i: usize, j: usize| a[i].mul::<P>(b[j]) - a[j].mul::<P>(b[i]);
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

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
    type Output = [Vector; 3];

    fn run<P: Product>(self) -> [Vector; 3] {
        let power = exponent(self.axis.abs().max_element());
        let component = |x: f64| Double::from(super::approach::scaled(x, -power));
        let axis = normalized::<P>(&[component(self.axis.x), component(self.axis.y), component(self.axis.z)]);
        let size = DVec3::new(axis[0].high, axis[1].high, axis[2].high).abs();
        let hint = self.hint.unwrap_or(if size.x <= size.y && size.x <= size.z {
            DVec3::X
        } else if size.y <= size.z {
            DVec3::Y
        } else {
            DVec3::Z
        });
        let hint = hint.to_array().map(Double::from);
        let shadow = along::<P>(&axis, dot_double::<P>(&hint, &axis));
        let first = normalized::<P>(&[hint[0] - shadow[0], hint[1] - shadow[1], hint[2] - shadow[2]]);
        [first, cross::<P>(&axis, &first), axis]
    }
}
