//! Defines a shape of one's own, an ellipsoid, and renders it: `cargo run --release --example own_primitive -- out.png`.

use rt::rt_core::glam::DVec3;
use rt::rt_core::shape::Plane;
use rt::rt_core::{Aabb, Hit, Interval, Primitive, Ray, Shape, Surface};
use rt::rt_shade::{Antialias, Attenuation, Camera, Color, Light, Material, Paint, Scene, Settings, render};
use std::sync::Arc;

/// The points with `|(p - center) / radii| = 1`.
#[derive(Debug)]
struct Ellipsoid {
    center: DVec3,
    radii: DVec3,
}

impl Ellipsoid {
    /// Both crossings with the whole line: the ellipsoid is the unit sphere after division by the radii.
    fn roots(&self, ray: &Ray) -> Option<[f64; 2]> {
        let (o, d) = ((ray.origin - self.center) / self.radii, ray.direction / self.radii);
        // About the closest approach, so that no digits are lost far away.
        let middle = -o.dot(d) / d.length_squared();
        let rest = 1.0 - (o + d * middle).length_squared();
        let half = (rest / d.length_squared()).sqrt();
        (rest > 0.0).then_some([middle - half, middle + half])
    }
}

impl Primitive for Ellipsoid {
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let [near, far] = self.roots(ray)?;
        within.admit(near, 0, 0).or_else(|| within.admit(far, 0, 1))
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        // Back onto the surface: what remains of the ray's error lies along it.
        let on_unit_sphere = ((ray.at(hit.t()) - self.center) / self.radii).normalize();
        let local = on_unit_sphere * self.radii;
        let normal = (on_unit_sphere / self.radii).normalize();
        // A dozen roundings of numbers no larger than these.
        let size = self.center.abs().max_element() + self.radii.max_element();
        Surface::new(hit.t(), self.center + local, local, normal, 12.0 * f64::EPSILON * size)
    }

    fn bounds(&self) -> Option<Aabb> {
        // A little wider than the true box, so that it holds every rounded point.
        let reach = self.radii * (1.0 + 1e-12) + self.center.abs() * 1e-12;
        Some(Aabb::new(self.center - reach, self.center + reach))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let egg: Arc<dyn Primitive> =
        Arc::new(Ellipsoid { center: DVec3::new(0.0, 1.0, 0.0), radii: DVec3::new(0.7, 1.0, 0.7) });
    let shell =
        Material { paint: Paint::Color(Color::new(0.9, 0.8, 0.6)), specular: 0.3, ..Material::default() };
    let scene = Scene::builder()
        .camera(Camera::new([0.0, 2.0, 5.0], [0.0, 0.9, 0.0], [0.0, 1.0, 0.0], 40.0)?)
        .background([0.5, 0.6, 0.8])
        .ambient([0.1; 3])
        .light(Light::point([3.0, 5.0, 4.0], [0.9; 3], Attenuation::NONE)?)
        .object("floor", Plane::new([0.0; 3], [0.0, 1.0, 0.0])?, Material::default())
        .object("egg", Shape::Custom(egg), shell)
        .build()?;
    let settings = Settings { width: 400, height: 300, antialias: Antialias::Grid(2), ..Settings::default() };
    let rendering = render(&scene, &settings, &())?;
    let path = std::env::args().nth(1).unwrap_or_else(|| "own_primitive.png".to_owned());
    std::fs::write(&path, rendering.picture.to_png()?)?;
    println!("{path}: {} rays", rendering.stats.rays());
    Ok(())
}
