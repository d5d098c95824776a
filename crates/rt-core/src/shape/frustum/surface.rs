//! The full record of a hit, refined in double-double.

use super::line::{FindLine, quotient};
use super::{BASE, Frustum, TOP};
use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::{self, Product, Task};
use crate::math::{exp2i, sqrt};
use crate::scaled::{ScaledRay, error_radius, uncertainty};
use crate::surface::Coordinates;
use crate::{Hit, Ray, Surface};
use glam::{DVec2, DVec3};

impl Frustum {
    /// See [`Primitive::surface`](crate::Primitive::surface).
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let Some(scaled) = ScaledRay::new(ray, self.base, self.unit) else {
            return Surface::new(hit.t(), self.base, DVec3::ZERO, self.axis.high(), 0.0);
        };
        let found = kernel::run(FindSurface { frustum: self, ray: &scaled, hit });
        let scale = exp2i(self.unit);
        let local = found.local.scale_exact(scale);
        let point = local.plus_f64(self.base);
        let at = found.local.high();
        let (x, y) = (at.dot(self.first), at.dot(self.second));
        let v = match hit.part() {
            BASE => 0.0,
            TOP => 1.0,
            _ => (found.z / self.height.high).clamp(0.0, 1.0),
        };
        Surface::new(
            scaled.unscale(found.t).high,
            point,
            local.high(),
            found.normal,
            error_radius(point, scale * uncertainty(found.half)),
        )
        .with_coordinates(Coordinates::Side(DVec2::new(x, y), v))
        .with_object_point(DVec3::new(x, y, found.z) * scale)
    }
}

struct FindSurface<'a> {
    frustum: &'a Frustum,
    ray: &'a ScaledRay,
    hit: Hit,
}

struct Refined {
    t: Double,
    local: DoubleVector,
    normal: DVec3,
    z: f64,
    half: f64,
}

impl Task for FindSurface<'_> {
    type Output = Refined;
    #[inline(always)]
    fn run<P: Product>(self) -> Refined {
        let FindSurface { frustum: f, ray, hit } = self;
        let line = FindLine { frustum: f, ray }.run::<P>();
        let at = match hit.part() {
            BASE => quotient::<P>(-line.z, line.z_growth),
            TOP => quotient::<P>(line.height - line.z, line.z_growth),
            _ => line.side[(hit.root() & 1) as usize],
        };
        // A hit of another ray, or one that rounding invented: the closest approach is the nearest to it.
        let at = if at.high.is_finite() { at } else { Double::ZERO };
        let mut local = line.start + DoubleVector::from(ray.direction).mul::<P>(at);
        let t = line.shift + at;
        if hit.part() == BASE || hit.part() == TOP {
            let axis = f.axis.high();
            let (normal, z) = if hit.part() == BASE { (-axis, 0.0) } else { (axis, f.height.high) };
            return Refined { t, local, normal, z, half: line.z_growth.high.abs() };
        }
        let z = f.axis.dot::<P>(local);
        let along = f.axis.mul::<P>(z);
        let away = local - along;
        let distance = away.length_squared::<P>().sqrt::<P>();
        let outward = if distance.high > 0.0 {
            away.mul::<P>(Double::ONE.div::<P>(distance))
        } else {
            // On the axis, at the apex: there is no direction away from it.
            DoubleVector::default()
        };
        if line.depth.high <= 0.0 && line.a.high >= 0.0 {
            // The rounded ray misses: take the place on the surface beside it.
            let radius = f.slope.mul::<P>(z) + f.base_radius * exp2i(-f.unit);
            local = along + outward.mul::<P>(radius);
        }
        let mut normal = (outward.mul::<P>(f.radial) + f.axis.mul::<P>(f.axial)).high();
        if distance.high <= 0.0 {
            normal = if f.axial.high < 0.0 { -f.axis.high() } else { f.axis.high() };
        }
        let half = if line.depth.high > 0.0 { sqrt(line.depth.high) } else { 0.0 };
        Refined { t, local, normal, z: z.high, half }
    }
}
