//! What a shaded point is worth, against answers known beforehand.

use rt_core::glam::DVec3;
use rt_core::shape::{Cone, Cuboid, Cylinder, Disk, Plane, Sphere, Torus};
use rt_core::{Interval, Primitive, Ray, Shape};
use rt_shade::{
    Attenuation, Camera, Color, ImageTexture, Light, Material, Object, Optics, Paint, Picture, Rendering,
    Scene, SceneBuilder, Settings, Texture, render,
};

/// A camera at the origin that looks down the negative z axis.
fn one_ray() -> SceneBuilder {
    Scene::builder().camera(Camera::new([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], 1.0).unwrap())
}

/// A picture of one pixel.
fn see(scene: SceneBuilder, max_depth: u32) -> Rendering {
    let settings = Settings { width: 1, height: 1, max_depth, ..Settings::default() };
    render(&scene.build().unwrap(), &settings, &()).unwrap()
}

fn color(rendering: &Rendering) -> [f32; 3] {
    rendering.picture.pixels()[0]
}

fn wall(z: f64) -> Shape {
    Plane::new([0.0, 0.0, z], [0.0, 0.0, 1.0]).unwrap().into()
}

fn ball(z: f64, radius: f64) -> Shape {
    Sphere::new([0.0, 0.0, z], radius).unwrap().into()
}

fn glass(ior: f64) -> Material {
    Material { diffuse: 0.0, transmit: Color::WHITE, ior: Some(ior), ..Material::default() }
}

fn glow(color: [f64; 3]) -> Material {
    Material { paint: Paint::Color(color.into()), ..Material::default() }
}

/// Transmittance at perpendicular incidence.
fn transmittance(a: f64, b: f64) -> f64 {
    1.0 - ((a - b) / (a + b)) * ((a - b) / (a + b))
}

#[test]
fn diffuse_highlight_and_attenuation_by_hand() {
    // The lamp is 3 above the wall's point and 4 to the side: cosine 3/5, distance 5.
    let fading = Attenuation::new(0.5, 0.1, 0.02).unwrap();
    let light = Light::point([4.0, 0.0, -7.0], [2.0, 1.0, 0.5], fading).unwrap();
    let paint = Paint::Color(Color::new(0.5, 0.25, 1.0));
    let material = Material { paint, diffuse: 0.8, specular: 0.5, shininess: 2.0, ..Material::default() };
    let seen = see(one_ray().light(light).ambient([0.1; 3]).object("wall", wall(-10.0), material), 1);
    let expect = |light: f64, paint: f64| {
        0.1 * 0.8 * paint + light / (0.5 + 0.5 + 0.5) * (0.8 * paint * 0.6 + 0.5 * 0.6 * 0.6)
    };
    let expected = [expect(2.0, 0.5), expect(1.0, 0.25), expect(0.5, 1.0)];
    for (got, expected) in color(&seen).into_iter().zip(expected) {
        assert!((f64::from(got) - expected).abs() < 1e-6, "{got} {expected}");
    }
    assert_eq!((seen.stats.eye_hits, seen.stats.shadow_rays, seen.stats.shadow_hits), (1, 1, 0));
}

#[test]
fn no_double_shadow_outside_a_cone() {
    // The spotlight's cone does not reach the point: an occluder between them changes no bit, and no ray is cast.
    let lit = |inner: f64, outer: f64, occluder: bool| {
        let at = [4.0, 0.0, -7.0];
        let spot = Light::spot(at, [4.0, 0.0, -10.0], inner, outer, [1.0; 3], Attenuation::NONE).unwrap();
        let other = Light::point([0.0, 4.0, -7.0], [1.0; 3], Attenuation::NONE).unwrap();
        let mut scene = one_ray().light(other).light(spot).object("wall", wall(-10.0), glow([0.7; 3]));
        if occluder {
            scene =
                scene.object("occluder", Sphere::new([2.0, 0.0, -8.5], 0.5).unwrap(), Material::default());
        }
        see(scene, 1)
    };
    // The point is at 53 degrees from the axis.
    let (free, hidden) = (lit(20.0, 30.0, false), lit(20.0, 30.0, true));
    assert_eq!(color(&free), color(&hidden));
    assert_eq!((free.stats.shadow_rays, hidden.stats.shadow_rays), (1, 1));
    // Inside the cone the occluder takes that lamp's light away, and nothing more.
    let (free, hidden) = (lit(60.0, 70.0, false), lit(60.0, 70.0, true));
    assert_eq!((free.stats.shadow_rays, hidden.stats.shadow_rays, hidden.stats.shadow_hits), (2, 2, 1));
    assert_eq!(color(&hidden), color(&lit(20.0, 30.0, false)));
    assert!(color(&free)[0] > color(&hidden)[0]);
}

#[test]
fn shadows_that_overlap_are_as_dark_as_one() {
    let lamp = |x: f64| Light::point([x, 4.0, -7.0], [1.0; 3], Attenuation::NONE).unwrap();
    let lid = Disk::new([0.0, 2.0, -8.5], [0.0, 1.0, 0.5], 1.9).unwrap();
    let scene = one_ray().ambient([0.25; 3]).light(lamp(-1.0)).light(lamp(1.0));
    let seen = see(
        scene.object("wall", wall(-10.0), Material::default()).object("lid", lid, Material::default()),
        1,
    );
    assert_eq!(seen.stats.shadow_hits, 2);
    assert_eq!(color(&seen), [0.25; 3]);
}

#[test]
fn coloured_shadows_multiply_and_no_shadow_lets_light_pass() {
    let lamp = Light::point([0.0, 6.0, -4.0], [1.0; 3], Attenuation::NONE).unwrap();
    let pane = |y: f64| Disk::new([0.0, y, -10.0 + y], [0.0, 1.0, 1.0], 0.5).unwrap();
    let tinted = |transmit| Material { diffuse: 0.0, transmit, ..Material::default() };
    let base = || one_ray().light(lamp).object("wall", wall(-10.0), Material::default());
    let bright = color(&see(base(), 1));
    let red = tinted(Color::new(1.0, 0.5, 0.25));
    let seen =
        see(base().object("red", pane(3.0), red).object("gray", pane(4.0), tinted(Color::gray(0.5))), 1);
    for (channel, left) in [0.5, 0.25, 0.125].into_iter().enumerate() {
        assert!((color(&seen)[channel] - bright[channel] * left).abs() < 1e-6);
    }
    assert_eq!((seen.stats.shadow_rays, seen.stats.shadow_hits), (1, 0));
    let mut scene = base();
    let material = scene.add_material(Material::default());
    scene.add_object(Object { name: "ghost".into(), material, no_shadow: true }, pane(3.0));
    assert_eq!(color(&see(scene, 1)), bright);
}

#[test]
fn white_glass_in_white_surroundings_is_white() {
    for ior in [1.0, 1.1, 1.5, 2.4] {
        let off_axis = Sphere::new([0.3, 0.2, -4.0], 1.0).unwrap();
        let seen = see(one_ray().background([1.0; 3]).object("ball", off_axis, glass(ior)), 60);
        assert!((f64::from(color(&seen)[0]) - 1.0).abs() < 1e-6, "{ior}");
    }
    // Straight through: F = 0.04 is reflected at once, and each wall from inside lets 1 - F out. At a depth (eye
    // ray 1) what has not left after depth - 2 walls is lost: (1 - F) F^(depth - 2).
    for depth in 2..8 {
        let seen = see(one_ray().background([1.0; 3]).object("ball", ball(-4.0, 1.0), glass(1.5)), depth);
        let lost = (2..depth).fold(0.96, |lost, _| lost * 0.04);
        assert!((f64::from(color(&seen)[0]) - (1.0 - lost)).abs() < 1e-7, "depth {depth}");
    }
}

#[test]
fn deeper_than_the_depth_is_black() {
    let mirror = Material { diffuse: 0.0, reflect: 1.0, ..Material::default() };
    let seen = |depth| see(one_ray().background([1.0; 3]).object("wall", wall(-10.0), mirror), depth);
    assert_eq!((color(&seen(1)), seen(1).stats.reflected_rays), ([0.0; 3], 0));
    assert_eq!((color(&seen(2)), seen(2).stats.reflected_rays), ([1.0; 3], 1));
}

#[test]
fn nested_glass_is_the_analytic_product() {
    // Air, glass, water, glass, air, then a wall that glows. At this depth there is only the straight path.
    let scene = |order: [usize; 2]| {
        let mut scene = one_ray().ambient([1.0; 3]).object("wall", wall(-10.0), glow([1.0; 3]));
        for i in order {
            let (radius, ior) = [(2.0, 1.5), (1.0, 1.33)][i];
            scene = scene.object("ball", ball(-5.0, radius), glass(ior));
        }
        see(scene, 5)
    };
    let walls = [(1.0, 1.5), (1.5, 1.33), (1.33, 1.5), (1.5, 1.0)];
    let straight: f64 = walls.into_iter().map(|(a, b)| transmittance(a, b)).product();
    assert!((f64::from(color(&scene([0, 1]))[0]) - straight).abs() < 1e-6);
    assert_eq!(color(&scene([0, 1])), color(&scene([1, 0])));
}

#[test]
fn overlapping_glass_of_one_material_has_no_inner_walls() {
    let mut scene = one_ray().ambient([1.0; 3]).object("wall", wall(-10.0), glow([1.0; 3]));
    let material = scene.add_material(glass(1.5));
    for z in [-4.0, -5.0] {
        scene.add_object(Object { material, ..Object::default() }, ball(z, 1.0));
    }
    assert!((f64::from(color(&see(scene, 5))[0]) - 0.96 * 0.96).abs() < 1e-6);
}

#[test]
fn an_eye_inside_glass_knows_it() {
    // Out of a ball of glass through a bubble of water.
    let scene = one_ray()
        .ambient([1.0; 3])
        .object("wall", wall(-10.0), glow([1.0; 3]))
        .object("around", ball(0.0, 6.0), glass(1.5))
        .object("bubble", ball(-3.0, 1.0), glass(1.33));
    let straight = transmittance(1.5, 1.33) * transmittance(1.33, 1.5) * transmittance(1.5, 1.0);
    assert!((f64::from(color(&see(scene, 4))[0]) - straight).abs() < 1e-6);
}

#[test]
fn total_reflection_sends_everything_to_the_mirror() {
    // From inside a block of glass at 45 degrees onto its side: beyond the critical angle of 41.8.
    let camera = Camera::new([0.0; 3], [1.0, 0.0, -1.0], [0.0, 1.0, 0.0], 1.0).unwrap();
    let block = Cuboid::new([-1.0, -1.0, -9.0], [1.0, 1.0, 1.0]).unwrap();
    let scene = Scene::builder().camera(camera).background([1.0; 3]).object("block", block, glass(1.5));
    let seen = see(scene, 3);
    assert_eq!((seen.stats.refracted_rays, seen.stats.reflected_rays), (0, 2));
    assert_eq!(color(&seen), [0.0; 3]);
}

#[test]
fn nff_flavour_is_plain_mirror_and_transmission() {
    let plain = Material {
        diffuse: 0.0,
        specular: 0.25,
        shininess: 100_000.0,
        reflect: 0.25,
        transmit: Color::gray(0.5),
        ior: Some(1.5),
        optics: Optics::Plain,
        ..Material::default()
    };
    let seen = see(one_ray().background([1.0; 3]).object("pane", wall(-10.0), plain), 2);
    assert_eq!(color(&seen), [0.75; 3]);
    assert_eq!((seen.stats.reflected_rays, seen.stats.refracted_rays), (1, 1));
}

fn heap(order: [usize; 7], lights: [usize; 3]) -> Picture {
    let paint = Paint::Color(Color::new(0.9, 0.1, 0.2));
    let red = Material { paint, reflect: 0.3, specular: 0.4, ..Material::default() };
    let pane = |r, g, b| {
        let transmit = Color::new(r, g, b);
        Material { transmit, diffuse: 0.1, ior: Some(1.3), ..Material::default() }
    };
    let cylinder = Cylinder::new([-1.5, -1.0, -5.0], [-1.4, 0.8, -5.2], 0.4).unwrap();
    let cone = Cone::new([-0.6, -1.0, -4.0], 0.5, [-0.5, 0.2, -4.1], 0.1).unwrap();
    let objects: [(Shape, Material); 7] = [
        (Plane::new([0.0, -1.0, 0.0], [0.0, 1.0, 0.0]).unwrap().into(), Material::default()),
        (Sphere::new([0.0, 0.0, -6.0], 1.0).unwrap().into(), red),
        (Sphere::new([1.5, 0.3, -5.0], 0.7).unwrap().into(), pane(0.9, 0.8, 0.7)),
        (Sphere::new([0.4, 0.9, -4.6], 0.4).unwrap().into(), pane(0.7, 0.9, 0.6)),
        (cylinder.into(), pane(0.8, 0.85, 0.95)),
        (Torus::new([0.2, 0.3, -5.5], [0.2, 1.0, 0.3], 1.3, 0.2).unwrap().into(), red),
        (cone.into(), pane(0.6, 0.7, 0.8)),
    ];
    let fading = Attenuation::new(1.0, 0.0, 0.01).unwrap();
    let target = [0.0, 0.0, -5.0];
    let lamps = [
        Light::point([3.0, 5.0, -2.0], [0.5, 0.4, 0.3], fading).unwrap(),
        Light::spot([-4.0, 4.0, 0.0], target, 15.0, 30.0, [0.6; 3], Attenuation::NONE).unwrap(),
        Light::point([0.5, 6.0, -6.0], [0.2, 0.3, 0.4], Attenuation::NONE).unwrap(),
    ];
    let camera = Camera::new([0.0, 0.5, 0.0], [0.0, 0.0, -5.0], [0.0, 1.0, 0.0], 50.0).unwrap();
    let mut scene = Scene::builder().camera(camera).background([0.3, 0.4, 0.5]).ambient([0.1; 3]);
    for i in lights {
        scene = scene.light(lamps[i]);
    }
    for i in order {
        let (shape, material) = objects[i].clone();
        scene = scene.object(i.to_string(), shape, material);
    }
    let settings = Settings { width: 64, height: 48, max_depth: 5, ..Settings::default() };
    render(&scene.build().unwrap(), &settings, &()).unwrap().picture
}

#[test]
fn the_order_of_objects_changes_no_bit_and_that_of_lamps_next_to_none() {
    let picture = heap([0, 1, 2, 3, 4, 5, 6], [0, 1, 2]);
    assert_eq!(picture, heap([6, 5, 4, 3, 2, 1, 0], [0, 1, 2]));
    assert_eq!(picture, heap([3, 0, 5, 1, 6, 2, 4], [0, 1, 2]));
    let other = heap([0, 1, 2, 3, 4, 5, 6], [2, 0, 1]);
    for (a, b) in picture.pixels().iter().flatten().zip(other.pixels().iter().flatten()) {
        // Sums of three in f64, seen in f32: the same, or neighbours.
        assert!((a - b).abs() <= f32::EPSILON * a.abs(), "{a} {b}");
    }
}

#[test]
fn textures_have_no_seam() {
    // A texture of 1 + cos(k phi): on both sides of phi = 0 it must be the same to a few ulps.
    let (width, k) = (256u32, 3.0);
    let texels = (0..width).map(|x| {
        let phi = (f64::from(x) + 0.5) / f64::from(width) * core::f64::consts::TAU;
        [(1.0 + libm::cos(k * phi)) as f32; 3]
    });
    let image = ImageTexture::new(width, 1, texels.collect(), 1.0).unwrap();
    let shapes: [Shape; 4] = [
        Sphere::new([0.0; 3], 1.0).unwrap().into(),
        Cylinder::open([0.0, -1.0, 0.0], [0.0, 1.0, 0.0], 1.0).unwrap().into(),
        Cone::open([0.0, -1.0, 0.0], 1.2, [0.0, 1.0, 0.0], 0.4).unwrap().into(),
        Torus::new([0.0; 3], [0.0, 1.0, 0.0], 1.0, 0.4).unwrap().into(),
    ];
    for shape in shapes {
        let uv = |angle: f64, y: f64| {
            let out = DVec3::new(libm::cos(angle), 0.0, libm::sin(angle));
            let ray = Ray::new(out * 3.0 + DVec3::Y * y, -out);
            let hit = shape.hit(&ray, Interval::FORWARD).unwrap();
            shape.surface(&ray, hit).uv()
        };
        let jumps = |a: f64| (uv(a - 1e-9, 0.1).x - uv(a + 1e-9, 0.1).x).abs() > 0.5;
        // u jumps by nearly a turn across the seam: found by bisection round the axis.
        let start =
            (0..64).map(|i| f64::from(i) * 0.1).find(|&a| (uv(a, 0.1).x - uv(a + 0.1, 0.1).x).abs() > 0.5);
        let (mut low, mut high) = start.map(|a| (a, a + 0.1)).unwrap();
        while !jumps(low) && high - low > 1e-10 {
            let middle = 0.5 * (low + high);
            if (uv(low, 0.1).x - uv(middle, 0.1).x).abs() > 0.5 { high = middle } else { low = middle }
        }
        let seam = low;
        for i in 0..1000 {
            let y = -0.3 + 0.6 * f64::from(i) / 1000.0;
            let (a, b) = (uv(seam - 1e-9, y), uv(seam + 1e-9, y));
            let (a, b) = (image.color_at(a), image.color_at(b));
            // The slope of the texture at its crest is 0 within a texel's width; what is left is rounding: a few ulps of
            // u times the width, times the difference of two texels.
            let allowed = 1e-8 * k + 16.0 * f64::EPSILON * f64::from(width);
            assert!((a.r - b.r).abs() <= allowed, "{shape:?}: {} {}", a.r, b.r);
        }
    }
}

#[test]
fn a_textured_floor_repeats_by_its_size() {
    let image = ImageTexture::new(2, 1, vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 4.0).unwrap();
    for (x, expected) in [(-1.0, [1.0, 0.0, 0.0]), (-3.0, [0.0, 1.0, 0.0]), (3.0, [1.0, 0.0, 0.0])] {
        let mut scene = one_ray().ambient([1.0; 3]);
        let texture = scene.add_texture(Texture::Image(image.clone()));
        let material = scene.add_material(Material { paint: Paint::Texture(texture), ..Material::default() });
        // The texel centres are at a quarter and three quarters of the size.
        let floor = Plane::new([x, 0.0, -10.0], [0.0, 0.0, 1.0]).unwrap();
        scene.add_object(Object { material, ..Object::default() }, floor);
        assert_eq!(color(&see(scene, 1)), expected, "{x}");
    }
}

#[test]
fn a_cutoff_leaves_out_rays_by_their_share_and_is_off_by_default() {
    // Two mirrors face each other; each generation is worth 0.3 of the one before. Ambient light on each: 0.25.
    let mirror = Material { reflect: 0.3, diffuse: 1.0, ..glow([1.0; 3]) };
    let scene = || {
        one_ray().ambient([0.25; 3]).object("front", wall(-10.0), mirror).object("back", wall(10.0), mirror)
    };
    let cut = |cutoff: f64| {
        let settings = Settings { width: 1, height: 1, max_depth: 9, cutoff, ..Settings::default() };
        render(&scene().build().unwrap(), &settings, &()).unwrap()
    };
    let sum = |generations: u64| (0..generations).fold(0.0, |rest, _| 0.25 + 0.3 * rest);
    assert_eq!(see(scene(), 9).picture, cut(0.0).picture);
    // Shares 0.3, 0.09, 0.027, 0.0081: all within the depth, three, two, none.
    for (cutoff, reflected) in [(0.0, 8), (0.02, 3), (0.0899, 2), (0.31, 0)] {
        let seen = cut(cutoff);
        assert_eq!(seen.stats.reflected_rays, reflected, "{cutoff}");
        let expected = sum(reflected + 1);
        assert!(color(&seen).iter().all(|c| (f64::from(*c) - expected).abs() < 1e-6), "{cutoff}");
    }
}
