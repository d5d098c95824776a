//! The same bits for any number of threads, any tile and any region; and strangers who do not keep their word.

use rt_core::glam::DVec3;
use rt_core::shape::{Plane, Sphere, Torus};
use rt_core::{Aabb, Hit, Interval, Primitive, Ray, Shape, Surface};
use rt_shade::{
    Antialias, Attenuation, Camera, Checker, Color, Error, Light, Material, Object, Paint, Pattern, Picture,
    Progress, Region, Scene, SceneBuilder, Settings, Texture, render,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

fn start() -> SceneBuilder {
    let camera = Camera::new([0.0, 1.0, 5.0], [0.0, 0.5, 0.0], [0.0, 1.0, 0.0], 45.0).unwrap();
    let lamp = Light::point([3.0, 5.0, 4.0], [0.9; 3], Attenuation::NONE).unwrap();
    Scene::builder().camera(camera).background([0.4, 0.5, 0.7]).ambient([0.1; 3]).light(lamp)
}

fn scene() -> Scene {
    let mut scene = start();
    let squares = Checker::new([Color::gray(0.9), Color::gray(0.1)], 0.5).unwrap();
    let texture = scene.add_texture(Texture::Checker(squares));
    let floor = scene.add_material(Material { paint: Paint::Texture(texture), ..Material::default() });
    let plane = Plane::new([0.0; 3], [0.0, 1.0, 0.0]).unwrap();
    scene.add_object(Object { name: "floor".into(), material: floor, no_shadow: false }, plane);
    let glass = Material { diffuse: 0.1, transmit: Color::gray(0.9), ior: Some(1.5), ..Material::default() };
    scene
        .object("ball", Sphere::new([0.2, 0.8, 0.0], 0.8).unwrap(), glass)
        .object(
            "ring",
            Torus::new([0.0, 0.4, 0.0], [0.1, 1.0, 0.2], 1.3, 0.2).unwrap(),
            Material { reflect: 0.3, ..Material::default() },
        )
        .build()
        .unwrap()
}

fn settings(antialias: Antialias) -> Settings {
    Settings { width: 90, height: 70, antialias, threads: 1, max_depth: 5, ..Settings::default() }
}

#[test]
fn threads_tiles_and_regions_change_no_bit() {
    let scene = scene();
    let adaptive = Antialias::Adaptive { threshold: 0.1, depth: 3 };
    let deep = Antialias::Adaptive { threshold: 0.1, depth: 5 };
    for antialias in [Antialias::None, Antialias::Grid(3), adaptive, deep] {
        let whole = render(&scene, &settings(antialias), &()).unwrap();
        assert!(whole.complete);
        for (threads, tile) in [(2, 32), (7, 5), (1, 1), (3, 1000)] {
            let other = render(&scene, &Settings { threads, tile, ..settings(antialias) }, &()).unwrap();
            assert_eq!(other, whole, "{antialias} {threads} threads, tile {tile}");
        }
        for (x, y, width, height) in [(0, 0, 1, 1), (13, 21, 40, 30), (89, 69, 1, 1), (50, 0, 3, 70)] {
            let region = Some(Region { x, y, width, height });
            let part = render(&scene, &Settings { region, tile: 7, ..settings(antialias) }, &()).unwrap();
            for (row, pixels) in part.picture.pixels().chunks_exact(width as usize).enumerate() {
                let first = (y as usize + row) * 90 + x as usize;
                assert_eq!(pixels, &whole.picture.pixels()[first..first + width as usize], "{antialias}");
            }
        }
    }
}

#[test]
fn corners_are_one_ray_each() {
    let scene = scene();
    let rendering = render(&scene, &Settings { corners: true, ..settings(Antialias::None) }, &()).unwrap();
    assert_eq!((rendering.picture.width(), rendering.picture.height()), (91, 71));
    assert_eq!(rendering.stats.eye_rays, 91 * 71);
    let both = Settings { corners: true, ..settings(Antialias::Grid(2)) };
    assert!(matches!(render(&scene, &both, &()), Err(Error::Antialias { .. })));
}

#[test]
fn a_cancelled_rendering_returns_what_is_finished() {
    struct After(AtomicU64);
    impl Progress for After {
        fn cancelled(&self) -> bool {
            self.0.fetch_add(1, Ordering::Relaxed) >= 3
        }
    }
    let settings = settings(Antialias::None);
    let scene = scene();
    let part = render(&scene, &settings, &After(AtomicU64::new(0))).unwrap();
    assert!(!part.complete && part.stats.eye_rays > 0 && part.stats.eye_rays < 90 * 70);
    let none = render(&scene, &settings, &AtomicBool::new(true)).unwrap();
    assert_eq!(none.picture, Picture::new(90, 70));
}

/// What a stranger's shape or texture may do wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    PanicInHit,
    PanicInSurface,
    NotANumber,
    Liar,
    NoUnitNormal,
    PanicInBounds,
    BadBounds,
}

#[derive(Debug)]
struct Stranger(Fault);

impl Primitive for Stranger {
    fn hit(&self, _: &Ray, within: Interval) -> Option<Hit> {
        assert!(self.0 != Fault::PanicInHit, "I panic");
        match self.0 {
            Fault::Liar => Interval::LINE.admit(-1.0, 0, 0),
            _ => within.admit(2.0, 0, 0),
        }
    }
    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        assert!(self.0 != Fault::PanicInSurface, "I panic");
        let (point, normal) = match self.0 {
            Fault::NotANumber => (DVec3::NAN, DVec3::Y),
            Fault::NoUnitNormal => (DVec3::ZERO, DVec3::splat(0.1)),
            _ => (ray.at(hit.t()), DVec3::Y),
        };
        Surface::new(hit.t(), point, DVec3::ZERO, normal, 0.0)
    }
    fn bounds(&self) -> Option<Aabb> {
        assert!(self.0 != Fault::PanicInBounds, "I panic");
        match self.0 {
            Fault::BadBounds => Some(Aabb { min: DVec3::NAN, max: DVec3::ONE }),
            _ => None,
        }
    }
}

#[test]
fn a_strangers_shape_that_fails_is_named() {
    use Fault::*;
    for fault in [PanicInHit, PanicInSurface, NotANumber, Liar, NoUnitNormal, PanicInBounds, BadBounds] {
        let shape: Arc<dyn Primitive> = Arc::new(Stranger(fault));
        let scene = start()
            .object("ball", Sphere::new([0.0; 3], 0.1).unwrap(), Material::default())
            .object("strange", Shape::Custom(shape), Material::default())
            .build();
        let error = match scene {
            Err(error) => error,
            Ok(scene) => render(&scene, &settings(Antialias::None), &()).unwrap_err(),
        };
        let Error::Object { object, reason } = &error else { panic!("{fault:?}: {error}") };
        assert_eq!(object, "strange");
        let panics = matches!(fault, PanicInHit | PanicInSurface | PanicInBounds);
        assert_eq!(reason.contains("I panic"), panics, "{reason}");
    }
}

#[derive(Debug)]
struct BadPattern(bool);

impl Pattern for BadPattern {
    fn color(&self, _: &Surface) -> Color {
        assert!(!self.0, "I panic");
        Color::new(f64::NAN, 0.0, 0.0)
    }
}

#[test]
fn a_strangers_texture_that_fails_is_named() {
    for panics in [true, false] {
        let mut scene = start();
        let texture = scene.add_texture(Texture::Custom(Arc::new(BadPattern(panics))));
        let material = Material { paint: Paint::Texture(texture), ..Material::default() };
        let scene = scene.object("bad paint", Sphere::new([0.0; 3], 1.0).unwrap(), material).build().unwrap();
        let error = render(&scene, &settings(Antialias::None), &()).unwrap_err();
        assert!(matches!(error, Error::Object { object, .. } if object == "bad paint"));
    }
}

#[test]
fn bad_settings_are_refused() {
    let scene = scene();
    let base = settings(Antialias::None);
    for bad in [
        Settings { width: 0, ..base },
        Settings { height: 1 << 31, ..base },
        Settings { max_depth: 0, ..base },
        Settings { tile: 0, ..base },
        Settings { threads: usize::MAX, ..base },
        Settings { cutoff: f64::NAN, ..base },
        Settings { antialias: Antialias::Grid(0), ..base },
        Settings { antialias: Antialias::Adaptive { threshold: f64::NAN, depth: 3 }, ..base },
        Settings { region: Some(Region { x: 80, y: 0, width: 11, height: 1 }), ..base },
        Settings { region: Some(Region { x: 0, y: u32::MAX, width: 1, height: u32::MAX }), ..base },
        Settings { region: Some(Region { x: 0, y: 0, width: 0, height: 1 }), ..base },
    ] {
        assert!(render(&scene, &bad, &()).is_err(), "{bad:?}");
    }
}

#[test]
fn anti_aliasing_is_read_as_it_is_written() {
    for text in ["none", "grid:4", "adaptive:0.1:3"] {
        assert_eq!(text.parse::<Antialias>().unwrap().to_string(), text);
    }
    assert_eq!("adaptive".parse::<Antialias>().unwrap(), Antialias::ADAPTIVE);
    for text in [
        "",
        "grid",
        "grid:0",
        "grid:65",
        "grid:-1",
        "adaptive:2:3",
        "adaptive:nan:3",
        "adaptive:0.1",
        "none:1",
    ] {
        assert!(text.parse::<Antialias>().is_err(), "{text}");
    }
}

#[test]
fn pictures_return_from_their_files() {
    let picture = render(&scene(), &settings(Antialias::None), &()).unwrap().picture;
    assert_eq!(Picture::from_pfm(&picture.to_pfm()).unwrap(), picture);
    assert!(picture.to_pfm().starts_with(b"PF\n90 70\n-1.0\n"));
    let png = picture.to_png().unwrap();
    let read = Picture::decode(&png).unwrap();
    assert_eq!(read.to_png().unwrap(), png);
    for length in [0, 1, 2, 5, 9, 14, 20, png.len() / 2] {
        assert!(Picture::decode(&png[..length]).is_err());
        assert!(Picture::decode(&picture.to_pfm()[..length]).is_err());
    }
    for header in ["PF\n0 1\n-1.0\n", "PF\n4000000000 4000000000\n-1.0\n", "PF\n1 1\nx\n", "Pf\n1 1\n-1.0\n"]
    {
        assert!(Picture::decode(header.as_bytes()).is_err(), "{header}");
    }
}
