//! Builds a scene in Rust and writes a PNG: `cargo run --release --example build_scene -- out.png`.

use rt::rt_core::shape::{Plane, Sphere, Torus};
use rt::rt_shade::{
    Antialias, Attenuation, Camera, Checker, Color, Light, Material, Paint, Scene, Settings, Texture, render,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = Scene::builder()
        .camera(Camera::new([0.0, 2.5, 7.0], [0.0, 0.8, 0.0], [0.0, 1.0, 0.0], 40.0)?)
        .background([0.5, 0.6, 0.8])
        .ambient([0.1, 0.1, 0.1])
        .light(Light::point([4.0, 6.0, 5.0], [0.9, 0.9, 0.8], Attenuation::NONE)?)
        .light(Light::spot([-5.0, 6.0, 4.0], [0.0; 3], 12.0, 18.0, [0.5; 3], Attenuation::NONE)?);
    let squares = Checker::new([Color::gray(0.8), Color::gray(0.2)], 1.0)?;
    let floor = scene.add_texture(Texture::Checker(squares));
    let glass = Material {
        diffuse: 0.0,
        specular: 0.6,
        shininess: 200.0,
        transmit: Color::gray(0.95),
        ior: Some(1.5),
        ..Material::default()
    };
    let brass = Material {
        paint: Paint::Color(Color::new(0.8, 0.6, 0.2)),
        specular: 0.5,
        reflect: 0.2,
        ..Material::default()
    };
    let scene = scene
        .object(
            "floor",
            Plane::new([0.0; 3], [0.0, 1.0, 0.0])?,
            Material { paint: Paint::Texture(floor), ..Material::default() },
        )
        .object("ball", Sphere::new([0.0, 1.0, 0.0], 0.9)?, glass)
        .object("ring", Torus::new([0.0, 0.3, 0.0], [0.0, 1.0, 0.0], 1.4, 0.25)?, brass)
        .build()?;

    let settings = Settings { width: 640, height: 480, antialias: Antialias::Grid(2), ..Settings::default() };
    let rendering = render(&scene, &settings, &())?;
    let path = std::env::args().nth(1).unwrap_or_else(|| "build_scene.png".to_owned());
    std::fs::write(&path, rendering.picture.to_png()?)?;
    println!("{path}: {} rays", rendering.stats.rays());
    Ok(())
}
