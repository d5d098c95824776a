//! Scenes of all kinds of objects, materials and lights, drawn at 8 x 8 pixels: no panic, no NaN, the same picture on
//! one thread and on two.
#![no_main]

use libfuzzer_sys::arbitrary::{self, Arbitrary};
use libfuzzer_sys::fuzz_target;
use rt_fuzz::{Number, Vector};
use rt_shade::text::{NoPictures, load};
use rt_shade::{Antialias, Settings, render};
use std::fmt::Write;

#[derive(Arbitrary, Debug)]
struct Object {
    kind: u8,
    points: [Vector; 3],
    lengths: [Number; 2],
    material: u8,
    scale: Option<Number>,
    rotate: Option<(Vector, Number)>,
    no_shadow: bool,
}

#[derive(Arbitrary, Debug)]
struct Scene {
    eye: Vector,
    look_at: Vector,
    lights: Vec<(Vector, Vector, bool, [u8; 3])>,
    materials: [[u8; 6]; 3],
    objects: Vec<Object>,
    adaptive: bool,
}

fn vector(v: Vector) -> String {
    let [x, y, z] = v.value().to_array();
    format!("[{x:?}, {y:?}, {z:?}]")
}

impl Scene {
    fn text(&self) -> String {
        let mut s = format!("[camera]\neye = {}\nlook_at = {}\n", vector(self.eye), vector(self.look_at));
        for (position, target, spot, [a, b, c]) in self.lights.iter().take(4) {
            let (position, target) = (vector(*position), vector(*target));
            let attenuation = format!("[1, {}, {}]", f64::from(*a) / 64.0, f64::from(*b) / 64.0);
            let _ = if *spot {
                writeln!(
                    s,
                    "[[light]]\nspot = {{ position = {position}, target = {target}, inner = {}, outer = {}, attenuation = {attenuation} }}",
                    c / 3,
                    c / 2
                )
            } else {
                writeln!(s, "[[light]]\npoint = {{ position = {position}, attenuation = {attenuation} }}")
            };
        }
        for (name, m) in self.materials.iter().enumerate() {
            let [d, k, n, r, t, ior] = m.map(|x| f64::from(x) / 255.0);
            let _ = writeln!(
                s,
                "[material.m{name}]\ndiffuse = {d}\nspecular = {k}\nshininess = {}\nreflect = {r}",
                255.0 * n
            );
            if t > 0.5 {
                let _ = writeln!(s, "transmit = [{t}, {t}, {t}]\nior = {}", 0.5 + 2.0 * ior);
            }
        }
        for o in self.objects.iter().take(8) {
            let [a, b, c] = o.points.map(vector);
            let [l, m] = o.lengths.map(|n| format!("{:?}", n.value()));
            let shape = match o.kind % 10 {
                0 => format!("sphere = {{ center = {a}, radius = {l} }}"),
                1 => format!("plane = {{ point = {a}, normal = {b} }}"),
                2 => format!("cuboid = {{ min = {a}, max = {b} }}"),
                3 => format!("cylinder = {{ base = {a}, top = {b}, radius = {l} }}"),
                4 => format!("open_cylinder = {{ base = {a}, top = {b}, radius = {l} }}"),
                5 => format!("cone = {{ base = {a}, base_radius = {l}, top = {b}, top_radius = {m} }}"),
                6 => format!("open_cone = {{ base = {a}, base_radius = {l}, top = {b}, top_radius = {m} }}"),
                7 => format!("torus = {{ center = {a}, axis = {b}, major = {l}, minor = {m} }}"),
                8 => format!("disk = {{ center = {a}, normal = {b}, radius = {l} }}"),
                _ => format!("triangle = {{ a = {a}, b = {b}, c = {c} }}"),
            };
            let _ = writeln!(
                s,
                "[[object]]\nmaterial = \"m{}\"\nno_shadow = {}\nshape.{shape}",
                o.material % 3,
                o.no_shadow
            );
            if let Some(scale) = o.scale {
                let _ = writeln!(s, "scale = {:?}", scale.value());
            }
            if let Some((axis, degrees)) = o.rotate {
                let _ =
                    writeln!(s, "rotate = {{ axis = {}, degrees = {:?} }}", vector(axis), degrees.value());
            }
        }
        s
    }
}

fuzz_target!(|scene: Scene| {
    let Ok(loaded) = load("scene.toml", scene.text().as_bytes(), &NoPictures) else { return };
    let antialias = if scene.adaptive { Antialias::ADAPTIVE } else { Antialias::Grid(2) };
    let settings =
        Settings { width: 8, height: 8, max_depth: 5, antialias, threads: 1, tile: 3, ..Settings::default() };
    let one = render(&loaded.scene, &settings, &()).expect("a checked scene is drawn");
    assert!(one.picture.pixels().iter().flatten().all(|c| !c.is_nan()));
    let two = render(&loaded.scene, &Settings { threads: 2, tile: 5, ..settings }, &())
        .expect("a checked scene is drawn");
    assert_eq!(one.picture, two.picture);
});
