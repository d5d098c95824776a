//! Acne, leaks and ghosts: pictures in which every wrong pixel can be told without a reference.
//!
//! - acne: a convex shape lit from outside shadows nothing that faces the lamp, and what the eye sees is seen by a lamp at
//!   the eye: with and without shadows the pictures are the same bits;
//! - leak: a closed shape lit from outside is exactly black inside;
//! - lit: with eye and lamp inside a convex shape every pixel is lit;
//! - ghost: a closed shape with index 1 that transmits everything is invisible.
//!
//! `cargo run --release --example acne -- 256` prints the wrong pixels of every case.

use rt::rt_core::glam::DVec3;
use rt::rt_core::shape::{Cone, Cuboid, Cylinder, Disk, Plane, Sphere, Torus, Triangle};
use rt::rt_core::{Interval, Ray, Shape};
use rt::rt_shade::{
    Attenuation, Camera, Checker, Color, Light, Material, Object, Paint, Picture, Scene, SceneBuilder,
    Settings, Texture, render,
};

/// Draws a scene: ours, or one broken on purpose.
pub type Renderer = dyn Fn(&Scene, &Settings) -> Picture;

/// A shape of size 1 about the origin, and what is known of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A sphere.
    Sphere,
    /// A cube.
    Cuboid,
    /// A closed cylinder.
    Cylinder,
    /// A closed cone.
    Cone,
    /// A ring.
    Torus,
    /// A plane.
    Plane,
    /// A disk.
    Disk,
    /// A triangle.
    Triangle,
}

/// Every shape.
pub const KINDS: [Kind; 8] = [
    Kind::Sphere,
    Kind::Cuboid,
    Kind::Cylinder,
    Kind::Cone,
    Kind::Torus,
    Kind::Plane,
    Kind::Disk,
    Kind::Triangle,
];
/// What all lengths are multiplied by.
pub const SCALES: [f64; 7] = [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6];
/// How many sizes of the shape everything is moved by.
pub const OFFSETS: [f64; 4] = [0.0, 1e2, 1e4, 1e6];

impl Kind {
    fn is_convex(self) -> bool {
        self != Kind::Torus
    }

    fn is_closed(self) -> bool {
        !matches!(self, Kind::Plane | Kind::Disk | Kind::Triangle)
    }

    fn shape(self, place: Place) -> Shape {
        let p = |x, y, z| place.at([x, y, z]);
        let s = place.scale;
        match self {
            Kind::Sphere => Sphere::new(p(0.0, 0.0, 0.0), s).unwrap().into(),
            Kind::Cuboid => Cuboid::new(p(-1.0, -0.8, -0.7), p(1.0, 0.8, 0.7)).unwrap().into(),
            Kind::Cylinder => Cylinder::new(p(-0.2, -0.9, 0.1), p(0.3, 0.9, -0.1), 0.8 * s).unwrap().into(),
            Kind::Cone => Cone::new(p(0.1, -0.9, 0.1), 0.9 * s, p(-0.1, 1.0, 0.0), 0.0).unwrap().into(),
            Kind::Torus => Torus::new(p(0.0, 0.0, 0.0), [0.2, 1.0, 0.4], s, 0.4 * s).unwrap().into(),
            Kind::Plane => Plane::new(p(0.0, 0.0, 0.0), [0.1, 1.0, 0.2]).unwrap().into(),
            Kind::Disk => Disk::new(p(0.0, 0.0, 0.0), [0.1, 1.0, 0.2], s).unwrap().into(),
            Kind::Triangle => {
                Triangle::new(p(-1.0, -0.2, 0.7), p(1.0, 0.0, 0.6), p(0.1, 0.3, -1.0)).unwrap().into()
            }
        }
    }

    /// A point well inside.
    fn inside(self) -> [f64; 3] {
        match self {
            // In the tube: the axis is (0.2, 1, 0.4), this is perpendicular to it and of length 1.
            Kind::Torus => [0.9805806756909202, -0.19611613513818404, 0.0],
            Kind::Cone => [0.05, -0.4, 0.05],
            _ => [0.07, -0.05, 0.03],
        }
    }
}

/// Where a case takes place: every length times `scale`, moved by `offset` sizes.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// What all lengths are multiplied by.
    pub scale: f64,
    /// How many sizes of the shape everything is moved by.
    pub offset: f64,
}

impl Place {
    fn at(self, [x, y, z]: [f64; 3]) -> DVec3 {
        let moved = self.offset * self.scale;
        DVec3::new(x, y, z) * self.scale + DVec3::new(0.57, 0.61, -0.55) * moved
    }

    fn seen(self, eye: [f64; 3], look_at: [f64; 3], fov: f64) -> SceneBuilder {
        let up = [0.05, 1.0, 0.1];
        Scene::builder().camera(Camera::new(self.at(eye), self.at(look_at), up, fov).unwrap())
    }

    fn lamp(self, at: [f64; 3]) -> Light {
        Light::point(self.at(at), [1.0; 3], Attenuation::NONE).unwrap()
    }
}

const EYE: [f64; 3] = [1.7, 2.1, 2.9];
const MIDDLE: [f64; 3] = [0.0; 3];
const WHITE: Material = Material {
    paint: Paint::Color(Color::WHITE),
    diffuse: 1.0,
    specular: 0.0,
    shininess: 0.0,
    reflect: 0.0,
    transmit: Color::BLACK,
    ior: None,
    optics: rt::rt_shade::Optics::Fresnel,
};

/// The checks by name: each gives the wrong pixels of one case, `None` where it does not apply.
pub const CHECKS: [(&str, Check); 6] = [
    ("convex from outside", convex_outside),
    ("convex from inside", convex_inside),
    ("lamp at the eye", headlamp),
    ("heap, lamp at the eye", heap),
    ("leak", leak),
    ("ghost", ghost),
];
/// Counts wrong pixels; `None`: the check does not apply to this shape.
pub type Check = fn(&Renderer, Kind, Place, u32) -> Option<usize>;

fn settings(pixels: u32, shadows: bool) -> Settings {
    Settings { width: pixels, height: pixels, shadows, max_depth: 8, ..Settings::default() }
}

fn differing(a: &Picture, b: &Picture) -> usize {
    a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

fn dark(a: &Picture) -> usize {
    a.pixels().iter().filter(|p| p[0] == 0.0).count()
}

/// Pixels that differ with and without shadows; all of them if nothing is lit at all.
fn acne(render: &Renderer, scene: SceneBuilder, pixels: u32) -> usize {
    let scene = scene.build().unwrap();
    let (with, without) = (render(&scene, &settings(pixels, true)), render(&scene, &settings(pixels, false)));
    let nothing = dark(&without) == without.pixels().len();
    if nothing { without.pixels().len() } else { differing(&with, &without) }
}

fn convex_outside(render: &Renderer, kind: Kind, place: Place, pixels: u32) -> Option<usize> {
    kind.is_convex().then(|| {
        let scene = place
            .seen(EYE, MIDDLE, 40.0)
            .light(place.lamp([-2.0, 3.0, 1.5]))
            .light(place.lamp([3.0, 4.0, 5.0]));
        acne(render, scene.object("shape", kind.shape(place), WHITE), pixels)
    })
}

fn convex_inside(render: &Renderer, kind: Kind, place: Place, pixels: u32) -> Option<usize> {
    (kind.is_convex() && kind.is_closed()).then(|| {
        let lamp = kind.inside().map(|x| 0.5 * x - 0.02);
        let scene = place.seen(kind.inside(), [0.3, 0.1, -0.9], 120.0).light(place.lamp(lamp));
        let scene = scene.object("shape", kind.shape(place), WHITE).build().unwrap();
        dark(&render(&scene, &settings(pixels, true)))
    })
}

fn headlamp(render: &Renderer, kind: Kind, place: Place, pixels: u32) -> Option<usize> {
    let scene = place.seen(EYE, MIDDLE, 40.0).light(place.lamp(EYE));
    Some(acne(render, scene.object("shape", kind.shape(place), WHITE), pixels))
}

/// Two of a kind that overlap, on a floor.
fn heap(render: &Renderer, kind: Kind, place: Place, pixels: u32) -> Option<usize> {
    let mut other = place;
    other.scale *= 0.75;
    other.offset *= place.scale / other.scale;
    let floor = Plane::new(place.at([0.0, -0.8, 0.0]), [0.0, 1.0, 0.0]).unwrap();
    let scene = place
        .seen(EYE, MIDDLE, 40.0)
        .light(place.lamp(EYE))
        .object("one", kind.shape(place), WHITE)
        .object("other", kind.shape(other), WHITE)
        .object("floor", floor, WHITE);
    Some(acne(render, scene, pixels))
}

fn leak(render: &Renderer, kind: Kind, place: Place, pixels: u32) -> Option<usize> {
    kind.is_closed().then(|| {
        let lamps = [[-2.0, 3.0, 1.5], [3.0, 4.0, 5.0], [0.5, -4.0, -3.0]];
        let scene = place.seen(kind.inside(), [0.3, 0.1, -0.9], 120.0);
        let scene = lamps.into_iter().fold(scene, |scene, lamp| scene.light(place.lamp(lamp)));
        let scene = scene.object("shape", kind.shape(place), WHITE).build().unwrap();
        let picture = render(&scene, &settings(pixels, true));
        // Without shadows something must be seen, or the check is void.
        let void = dark(&render(&scene, &settings(pixels, false))) == picture.pixels().len();
        if void { picture.pixels().len() } else { picture.pixels().len() - dark(&picture) }
    })
}

fn ghost(render: &Renderer, kind: Kind, place: Place, pixels: u32) -> Option<usize> {
    kind.is_closed().then(|| {
        let scene = |ghost: bool| {
            let mut scene = place.seen(EYE, MIDDLE, 40.0).ambient([1.0; 3]);
            let squares = Checker::new([Color::WHITE, Color::gray(0.25)], 0.37 * place.scale).unwrap();
            let texture = scene.add_texture(Texture::Checker(squares));
            let material = scene.add_material(Material { paint: Paint::Texture(texture), ..WHITE });
            let wall = Plane::new(place.at([-1.0, -2.0, -3.0]), [0.3, 0.5, 1.0]).unwrap();
            scene.add_object(Object { material, ..Object::default() }, wall);
            if ghost {
                let clear = Material { diffuse: 0.0, transmit: Color::WHITE, ior: Some(1.0), ..WHITE };
                scene = scene.object("ghost", kind.shape(place), clear);
            }
            scene.build().unwrap()
        };
        let (with, without) =
            (render(&scene(true), &settings(pixels, false)), render(&scene(false), &settings(pixels, false)));
        if dark(&without) == without.pixels().len() {
            return without.pixels().len();
        }
        let far = |(a, b): &(&[f32; 3], &[f32; 3])| (a[0] - b[0]).abs() > 1.0 / 65535.0;
        with.pixels().iter().zip(without.pixels()).filter(far).count()
    })
}

/// Ours.
pub fn ours(scene: &Scene, settings: &Settings) -> Picture {
    render(scene, settings, &()).unwrap().picture
}

/// Broken on purpose: everything is black.
#[allow(dead_code)]
pub fn black(_: &Scene, settings: &Settings) -> Picture {
    Picture::new(settings.width, settings.height)
}

/// Broken on purpose: new rays start an absolute distance along their direction.
#[allow(dead_code)]
pub fn with_epsilon(scene: &Scene, settings: &Settings, epsilon: f64) -> Picture {
    let mut picture = Picture::new(settings.width, settings.height);
    for (index, pixel) in picture.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (index as u32 % settings.width, index as u32 / settings.width);
        let ray = scene.camera().ray(f64::from(x) + 0.5, f64::from(y) + 0.5, settings.width, settings.height);
        *pixel = simple(scene, settings, &ray, epsilon, 8).to_f32();
    }
    picture
}

fn simple(scene: &Scene, settings: &Settings, ray: &Ray, epsilon: f64, depth: u32) -> Color {
    let Some(found) = scene.geometry().nearest(ray, Interval::FORWARD) else { return scene.background() };
    let surface = scene.geometry().surface(ray, found);
    let direction = ray.direction.normalize();
    let point = ray.at(found.hit.t());
    let material = scene.materials()[scene.objects()[found.object as usize].material as usize];
    if !material.transmit.is_black() {
        let on = Ray::new(point + direction * epsilon, direction);
        return if depth == 0 { Color::BLACK } else { simple(scene, settings, &on, epsilon, depth - 1) };
    }
    let paint = match material.paint {
        Paint::Color(color) => color,
        Paint::Texture(texture) => match &scene.textures()[texture as usize] {
            Texture::Checker(checker) => checker.color(surface.object_point),
            _ => Color::WHITE,
        },
    };
    let normal = if surface.normal.dot(direction) > 0.0 { -surface.normal } else { surface.normal };
    let mut sum = scene.ambient() * paint;
    for light in scene.lights() {
        let to_light = (light.position() - point).normalize();
        let cosine = normal.dot(to_light);
        let start = point + to_light * epsilon;
        let shadow = Ray::new(start, light.position() - start);
        if cosine > 0.0 && !(settings.shadows && scene.geometry().occluded(&shadow, Interval::new(0.0, 1.0)))
        {
            sum += light.color() * paint * cosine;
        }
    }
    sum
}

/// Runs every check on every shape, scale and offset: cases and wrong pixels of each check, and the cases that failed.
pub fn run(
    render: &Renderer,
    pixels: u32,
    scales: &[f64],
    offsets: &[f64],
) -> Vec<(&'static str, usize, usize, Vec<String>)> {
    CHECKS
        .iter()
        .map(|(name, check)| {
            let (mut cases, mut wrong, mut failed) = (0, 0, Vec::new());
            for kind in KINDS {
                for &scale in scales {
                    for &offset in offsets {
                        if let Some(count) = check(render, kind, Place { scale, offset }, pixels) {
                            cases += 1;
                            wrong += count;
                            if count > 0 {
                                failed.push(format!("{kind:?} scale {scale:e} offset {offset:e}: {count}"));
                            }
                        }
                    }
                }
            }
            (*name, cases, wrong, failed)
        })
        .collect()
}

#[allow(dead_code)]
fn main() {
    let pixels = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(64);
    println!("{:24} {:>6} {:>8} {:>14}", "check", "cases", "failing", "wrong pixels");
    for (name, cases, wrong, failed) in run(&ours, pixels, &SCALES, &OFFSETS) {
        println!("{name:24} {cases:6} {:8} {wrong:14}", failed.len());
        for case in failed {
            println!("    {case}");
        }
    }
}
