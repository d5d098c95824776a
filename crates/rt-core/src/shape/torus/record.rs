//! The full record of a hit: parameter, point, normal and angles from the refined crossing.

use super::Torus;
use super::approach::{Approach, Vector, dot_double, scaled};
use super::isolate::{Crossings, Quartic};
use crate::double::Double;
use crate::kernel::{Product, Task};
use crate::{Hit, Ray, Surface};
use core::f64::consts::TAU;
use glam::{DVec2, DVec3};

/// See [`Primitive::surface`](crate::Primitive::surface).
pub(super) struct Record<'a> {
    pub torus: &'a Torus,
    pub ray: &'a Ray,
    pub hit: Hit,
}

impl Task for Record<'_> {
    type Output = Surface;

    #[inline(always)]
    fn run<P: Product>(self) -> Surface {
        let Some(line) = Approach::new::<P>(self.torus, self.ray) else {
            return self.torus.no_surface(self.ray, self.hit);
        };
        let crossings = Quartic::new::<P>(self.torus, &line).crossings::<P>();
        let x = match chosen::<P>(&crossings, &line, self.hit) {
            Some(x) => x,
            // A ray that left this torus along a tangent may pass it by less than the radius by which its origin
            // was moved: the point at the parameter is the best there is.
            None => {
                let s = Double::from(scaled(self.hit.t(), -line.exponent)) - line.parameter;
                s.mul::<P>(line.length)
            }
        };
        self.torus.record::<P>(line.t::<P>(x), &line.at::<P>(x))
    }
}

/// The crossing that the hit names: the one of that index, unless another in the same sense (both inward or both
/// outward) is nearer to the hit's parameter. Only rays that leave this torus make a difference: they were counted
/// along the line from the departure's point, not along the line of the moved ray.
#[inline(always)]
fn chosen<P: Product>(crossings: &Crossings, line: &Approach, hit: Hit) -> Option<Double> {
    let mut best: Option<(f64, Double)> = None;
    for (index, x) in crossings.as_slice().iter().enumerate() {
        if index as u32 % 2 != hit.root() % 2 {
            continue;
        }
        let miss = (line.t::<P>(*x) - hit.t()).abs();
        if best.is_none_or(|(least, _)| miss < least || (miss == least && index as u32 == hit.root())) {
            best = Some((miss, *x));
        }
    }
    best.map(|(_, x)| x)
}

impl Torus {
    /// The record of the point `local` (relative to the centre, at the torus' scale) at the parameter `t`.
    #[inline(always)]
    fn record<P: Product>(&self, t: f64, local: &Vector) -> Surface {
        let own = [
            dot_double::<P>(local, &self.frame[0]),
            dot_double::<P>(local, &self.frame[1]),
            dot_double::<P>(local, &self.frame[2]),
        ];
        let rho = (own[0].square::<P>() + own[1].square::<P>()).sqrt::<P>();
        let (major, minor) = (Double::from(self.major_scaled), Double::from(self.minor_scaled));
        // The signed squared distance from the surface seen from the near and from the far side of the generating
        // circle: on the inner sheet of a spindle torus the second vanishes.
        let height = own[2].square::<P>() - minor.square::<P>();
        let near = (rho - major).square::<P>() + height;
        let far = (rho + major).square::<P>() + height;
        let inner = far.high.abs() < near.high.abs();
        let circle = if inner { -major } else { major };
        // The normal lies in the plane of the point and the axis: `out` along the radius, `up` along the axis.
        let out = rho - circle;
        let (radial, up) = (out.div::<P>(minor), own[2].div::<P>(minor));
        let normal = if rho.high > 0.0 {
            let factor = radial.div::<P>(rho);
            let component = |i: usize| {
                let axial = own[2].mul::<P>(self.frame[2][i]);
                ((local[i] - axial).mul::<P>(factor) + up.mul::<P>(self.frame[2][i])).to_f64()
            };
            DVec3::new(component(0), component(1), component(2))
        } else {
            // On the axis, where sheets meet in a cone point: the axis itself.
            let sign = if own[2].high < 0.0 { -1.0 } else { 1.0 };
            rounded(&self.frame[2]) * sign
        };
        let back = |v: &Vector| {
            v.map(|c| Double { high: scaled(c.high, self.scale), low: scaled(c.low, self.scale) })
        };
        let world = back(local);
        let point = DVec3::new(
            (world[0] + self.center.x).to_f64(),
            (world[1] + self.center.y).to_f64(),
            (world[2] + self.center.z).to_f64(),
        );
        let turn = if inner { 0.5 } else { 0.0 };
        let (across, height) =
            if inner { (-out.to_f64(), own[2].to_f64()) } else { (out.to_f64(), own[2].to_f64()) };
        let uv = DVec2::new(
            turns(libm::atan2(own[1].to_f64(), own[0].to_f64()) / TAU + turn),
            turns(libm::atan2(height, across) / TAU),
        );
        Surface::new(t, point, rounded(&world), normal, self.error_radius(point))
            .with_uv(uv)
            .with_object_point(rounded(&back(&own)))
    }

    /// How far `point` can be from the true crossing: each coordinate is the rounded sum of the centre's and a
    /// double-double local one, whose own error, some 2^-98 of the size, vanishes beside half a unit of the size
    /// (it is allowed 2^-53 of it). The sum of three half units bounds the length of the difference.
    fn error_radius(&self, point: DVec3) -> f64 {
        const HALF_UNIT: f64 = 0.5 * f64::EPSILON;
        let p = point.abs();
        HALF_UNIT * (p.x + p.y + p.z + (self.major + self.minor))
    }

    /// What a ray gets that cannot have hit: its own point, so that nothing downstream panics.
    #[cold]
    fn no_surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let point = ray.at(hit.t());
        Surface::new(hit.t(), point, point - self.center, rounded(&self.frame[2]), self.error_radius(point))
    }
}

/// An angle in turns, brought into `[0, 1)`.
fn turns(x: f64) -> f64 {
    let x = if x < 0.0 { x + 1.0 } else { x };
    if x >= 1.0 { 0.0 } else { x }
}

#[inline(always)]
fn rounded(v: &Vector) -> DVec3 {
    DVec3::new(v[0].to_f64(), v[1].to_f64(), v[2].to_f64())
}
