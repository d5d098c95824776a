//! Families of rays about a shape, and the textbook formulas in plain `f64`.

use crate::rt_core::glam::DVec3;
use crate::rt_core::{Interval, Ray};

/// Rays of a family.
pub const RAYS: usize = 1024;

/// SplitMix64 (Steele, Lea and Flood 2014, doi:10.1145/2660193.2660195).
pub struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// Uniform in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 * 2.0_f64.powi(-52) - 1.0
    }
    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(self.signed(), self.signed(), self.signed());
            let length = v.length();
            if length > 0.1 && length <= 1.0 {
                return v / length;
            }
        }
    }
    /// Uniform in the unit ball.
    fn ball(&mut self) -> DVec3 {
        self.direction() * self.signed().abs().cbrt()
    }
}

/// From `distance` radii away at a point in the ball of `spread` radii about the centre.
pub fn aimed(center: DVec3, radius: f64, distance: f64, spread: f64) -> Vec<Ray> {
    let mut random = Random(1);
    (0..RAYS)
        .map(|_| {
            let origin = center + random.direction() * (radius * distance);
            let target = center + random.ball() * (radius * spread);
            let length = 0.5 + random.signed().abs();
            Ray::new(origin, (target - origin) * (length / (target - origin).length()))
        })
        .collect()
}

/// Past the bounding sphere.
pub fn missing(center: DVec3, radius: f64) -> Vec<Ray> {
    let mut random = Random(2);
    (0..RAYS)
        .map(|_| {
            let way = random.direction();
            let aside = random.direction().cross(way).normalize();
            let target = center + aside * (radius * (1.1 + random.signed().abs()));
            Ray::new(target - way * (radius * 5.0), way)
        })
        .collect()
}

/// From inside the ball of `spread` radii, in all directions.
pub fn inside(center: DVec3, radius: f64, spread: f64) -> Vec<Ray> {
    let mut random = Random(3);
    (0..RAYS).map(|_| Ray::new(center + random.ball() * (radius * spread), random.direction())).collect()
}

/// Within `depth` radii of a tangent of the side, on either side of it; `touch` gives a point and the normal there.
pub fn grazing(radius: f64, depth: f64, touch: impl Fn(&mut Random) -> (DVec3, DVec3)) -> Vec<Ray> {
    let mut random = Random(4);
    (0..RAYS)
        .map(|_| {
            let (point, normal) = touch(&mut random);
            let way = normal.cross(random.direction()).normalize();
            Ray::new(point + normal * (radius * depth * random.signed()) - way * (radius * 3.0), way)
        })
        .collect()
}

/// b^2 - a c about the ray's own origin.
pub fn textbook_sphere(center: DVec3, radius: f64, ray: &Ray, within: Interval) -> Option<f64> {
    let w = ray.origin - center;
    let a = ray.direction.dot(ray.direction);
    let b = w.dot(ray.direction);
    let c = w.dot(w) - radius * radius;
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let near = (-b - root) / a;
    if within.contains(near) {
        return Some(near);
    }
    let far = (root - b) / a;
    if within.contains(far) { Some(far) } else { None }
}

/// The quotient of two distances from the plane.
pub fn textbook_plane(point: DVec3, normal: DVec3, ray: &Ray, within: Interval) -> Option<f64> {
    let t = normal.dot(point - ray.origin) / normal.dot(ray.direction);
    if within.contains(t) { Some(t) } else { None }
}

/// The place in the plane, and its distance from the centre.
pub fn textbook_disk(center: DVec3, normal: DVec3, radius: f64, ray: &Ray, within: Interval) -> Option<f64> {
    let w = ray.origin - center;
    let t = -normal.dot(w) / normal.dot(ray.direction);
    let p = w + ray.direction * t;
    if within.contains(t) && p.dot(p) <= radius * radius { Some(t) } else { None }
}

/// Three pairs of planes (Kay and Kajiya 1986; Williams et al. 2005): the parameter, not the face.
pub fn textbook_cuboid(min: DVec3, max: DVec3, ray: &Ray, within: Interval) -> Option<f64> {
    let inverse = 1.0 / ray.direction;
    let (a, b) = ((min - ray.origin) * inverse, (max - ray.origin) * inverse);
    let least = |a: f64, b: f64| if a < b { a } else { b };
    let most = |a: f64, b: f64| if a > b { a } else { b };
    let near = most(least(a.x, b.x), most(least(a.y, b.y), least(a.z, b.z)));
    let far = least(most(a.x, b.x), least(most(a.y, b.y), most(a.z, b.z)));
    if near > far {
        None
    } else if within.contains(near) {
        Some(near)
    } else if within.contains(far) {
        Some(far)
    } else {
        None
    }
}

/// Moller and Trumbore 1997: Cramer's rule, leaving as soon as a weight is out of range.
pub fn textbook_triangle([a, b, c]: [DVec3; 3], ray: &Ray, within: Interval) -> Option<f64> {
    let (first, second) = (b - a, c - a);
    let p = ray.direction.cross(second);
    let determinant = first.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let inverse = 1.0 / determinant;
    let w = ray.origin - a;
    let u = w.dot(p) * inverse;
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let q = w.cross(first);
    let v = ray.direction.dot(q) * inverse;
    if v < 0.0 || u + v > 1.0 {
        return None;
    }
    let t = second.dot(q) * inverse;
    if within.contains(t) { Some(t) } else { None }
}

/// A frustum's numbers as a textbook keeps them.
pub struct TextbookFrustum {
    base: DVec3,
    axis: DVec3,
    height: f64,
    radius: f64,
    slope: f64,
    top_radius: f64,
}

impl TextbookFrustum {
    /// Closed; equal radii make a cylinder.
    pub fn new(base: DVec3, radius: f64, top: DVec3, top_radius: f64) -> Self {
        let height = (top - base).length();
        let slope = (top_radius - radius) / height;
        TextbookFrustum { base, axis: (top - base) / height, height, radius, slope, top_radius }
    }

    /// All four surfaces' crossings, the least one kept.
    pub fn hit<const SLOPED: bool>(&self, ray: &Ray, within: Interval) -> Option<f64> {
        let w = ray.origin - self.base;
        let d = ray.direction;
        let (z, dz) = (w.dot(self.axis), d.dot(self.axis));
        let (mut a, mut b) = (d.dot(d) - dz * dz, w.dot(d) - z * dz);
        let mut c = w.dot(w) - z * z;
        if SLOPED {
            let (r, k) = (self.radius + self.slope * z, self.slope * dz);
            a -= k * k;
            b -= r * k;
            c -= r * r;
        } else {
            c -= self.radius * self.radius;
        }
        let mut best = None;
        let mut end = within.max;
        let mut offer = |t: f64, inside: bool| {
            if inside && t > within.min && t < end {
                end = t;
                best = Some(t);
            }
        };
        let discriminant = b * b - a * c;
        if discriminant < 0.0 && !SLOPED {
            return None;
        }
        if discriminant >= 0.0 {
            let root = discriminant.sqrt();
            let inverse = 1.0 / a;
            for t in [(-b - root) * inverse, (root - b) * inverse] {
                let height = z + t * dz;
                offer(t, height > 0.0 && height < self.height);
            }
        }
        let inverse = 1.0 / dz;
        for (height, radius) in [(0.0, self.radius), (self.height, self.top_radius)] {
            let t = (height - z) * inverse;
            let p = w + d * t - self.axis * height;
            offer(t, p.dot(p) < radius * radius);
        }
        best
    }
}

/// A place on the side of a frustum and the normal there.
pub fn on_side(f: &TextbookFrustum, random: &mut Random) -> (DVec3, DVec3) {
    let z = f.height * (0.5 + 0.4 * random.signed());
    let away = f.axis.cross(random.direction()).normalize();
    (f.base + f.axis * z + away * (f.radius + f.slope * z), (away - f.axis * f.slope).normalize())
}
