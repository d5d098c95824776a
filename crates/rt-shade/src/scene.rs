//! A checked scene, ready to be rendered.

use crate::guard::Guarded;
use crate::light::check_color;
use crate::medium::Medium;
use crate::texture::Mapping;
use crate::{Camera, Color, Error, Light, Material, Paint, Texture};
use rt_core::glam::DVec3;
use rt_core::{DirectionCube, Found, Geometry, GeometryBuilder, Interval, Ray, Screen, Shape};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What is known of an object beside its shape.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Object {
    /// Its name, for messages. May be empty and need not be unique.
    pub name: String,
    /// The index of its material in the scene.
    pub material: u32,
    /// Whether light passes it as if it were not there.
    pub no_shadow: bool,
}

/// A checked scene: nothing in it can make rendering fail, except a shape or a texture of your own.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) camera: Camera,
    pub(crate) background: Color,
    pub(crate) ambient: Color,
    pub(crate) lights: Vec<Light>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) materials: Vec<Material>,
    pub(crate) objects: Vec<Object>,
    /// By object: its material, apart from its name, so that few cache lines hold those of many.
    pub(crate) material_of: Vec<u32>,
    pub(crate) geometry: Geometry,
    /// By object: what it does to the light of a lamp.
    pub(crate) screens: Vec<Screen>,
    /// Whether every object stops all light.
    pub(crate) all_opaque: bool,
    /// What the eye sees where, and each lamp: for few objects.
    pub(crate) seen_by_eye: Option<DirectionCube>,
    pub(crate) seen_by_lamp: Vec<Option<DirectionCube>>,
    /// By object: how its texture coordinates lead to a picture.
    pub(crate) mappings: Vec<Mapping>,
    /// The media that the eye is in.
    pub(crate) around_eye: Vec<Medium>,
    /// How long the acceleration structure took.
    pub(crate) build_time: Duration,
}

impl Scene {
    /// An empty builder.
    pub fn builder() -> SceneBuilder {
        SceneBuilder::default()
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The lamps.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// The materials, by index.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The textures, by index.
    pub fn textures(&self) -> &[Texture] {
        &self.textures
    }

    /// The objects, by index: the same indices as the shapes of [`Scene::geometry`].
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The shapes, ready for rays.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// How long [`SceneBuilder::build`] took to make the acceleration structure.
    pub fn build_time(&self) -> Duration {
        self.build_time
    }

    /// What rays see that hit nothing.
    pub fn background(&self) -> Color {
        self.background
    }

    /// The light that comes from everywhere.
    pub fn ambient(&self) -> Color {
        self.ambient
    }

    /// The material of what was hit.
    #[inline(always)]
    pub(crate) fn material_hit(&self, found: &Found) -> &Material {
        &self.materials[self.material_of[found.object as usize] as usize]
    }
}

/// Collects the parts of a [`Scene`].
///
/// The methods named `add_` return the index of what they added; the others return the builder.
#[derive(Clone, Debug, Default)]
pub struct SceneBuilder {
    camera: Option<Camera>,
    background: Color,
    ambient: Color,
    lights: Vec<Light>,
    textures: Vec<Texture>,
    materials: Vec<Material>,
    objects: Vec<Object>,
    geometry: GeometryBuilder,
    /// The first shape of a stranger that cannot be used.
    fault: Option<Error>,
}

impl SceneBuilder {
    /// The camera: the one thing that a scene must have.
    pub fn camera(mut self, camera: Camera) -> Self {
        self.camera = Some(camera);
        self
    }

    /// What rays see that hit nothing. Default: black.
    pub fn background(mut self, color: impl Into<Color>) -> Self {
        self.background = color.into();
        self
    }

    /// The light that comes from everywhere. Default: black.
    pub fn ambient(mut self, color: impl Into<Color>) -> Self {
        self.ambient = color.into();
        self
    }

    /// One more lamp.
    pub fn light(mut self, light: Light) -> Self {
        self.lights.push(light);
        self
    }

    /// One more object, with a material of its own.
    pub fn object(mut self, name: impl Into<String>, shape: impl Into<Shape>, material: Material) -> Self {
        let material = self.add_material(material);
        self.add_object(Object { name: name.into(), material, no_shadow: false }, shape);
        self
    }

    /// One more lamp; its index.
    pub fn add_light(&mut self, light: Light) -> u32 {
        self.lights.push(light);
        (self.lights.len() - 1) as u32
    }

    /// One more texture; its index, for [`Paint::Texture`].
    pub fn add_texture(&mut self, texture: Texture) -> u32 {
        self.textures.push(texture);
        (self.textures.len() - 1) as u32
    }

    /// One more material; its index, for [`Object::material`]. Objects of one material are one medium: glass made of
    /// many polygons takes one material.
    pub fn add_material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        (self.materials.len() - 1) as u32
    }

    /// One more object; its index.
    pub fn add_object(&mut self, object: Object, shape: impl Into<Shape>) -> u32 {
        let index = self.objects.len() as u32;
        let shape = match shape.into() {
            Shape::Custom(shape) => match Guarded::new(index, &object.name, shape) {
                Ok(guarded) => Shape::Custom(Arc::new(guarded)),
                Err(error) => {
                    self.fault.get_or_insert(error);
                    return index;
                }
            },
            shape => shape,
        };
        self.objects.push(object);
        self.geometry.push(shape)
    }

    /// Checks everything and prepares the shapes for rays.
    ///
    /// # Errors
    /// [`Error::NoCamera`], [`Error::NoMaterial`], [`Error::NoTexture`], [`Error::Material`], [`Error::Color`],
    /// [`Error::TooManyObjects`]; [`Error::Object`] for a shape of your own whose bounds panic or are no box.
    pub fn build(self) -> Result<Scene, Error> {
        if let Some(fault) = self.fault {
            return Err(fault);
        }
        let camera = self.camera.ok_or(Error::NoCamera)?;
        check_color("background", self.background)?;
        check_color("ambient", self.ambient)?;
        let most = u32::MAX as usize - 1;
        if self.objects.len() > most {
            return Err(Error::TooManyObjects { count: self.objects.len(), most });
        }
        for (index, material) in self.materials.iter().enumerate() {
            let index = index as u32;
            material.check().map_err(|e| Error::Material { material: index, source: Box::new(e) })?;
            if let Paint::Texture(texture) = material.paint
                && texture as usize >= self.textures.len()
            {
                let count = self.textures.len();
                return Err(Error::NoTexture { material: index, texture, count });
            }
        }
        for object in &self.objects {
            if object.material as usize >= self.materials.len() {
                let (object, material) = (object.name.clone(), object.material);
                return Err(Error::NoMaterial { object, material, count: self.materials.len() });
            }
        }
        // What lamps' rays meet.
        let screens = self.objects.iter().map(|object| {
            let transmit = self.materials[object.material as usize].transmit;
            match object.no_shadow {
                false if transmit.is_black() => Screen::Opaque,
                false if transmit != Color::WHITE => Screen::Sheer,
                _ => Screen::Absent,
            }
        });
        let screens: Vec<Screen> = screens.collect();
        let all_opaque = screens.iter().all(|&screen| screen == Screen::Opaque);
        let start = Instant::now();
        let geometry = self.geometry.build();
        let seen_by_eye = geometry.cube_about(camera.eye());
        let seen_by_lamp = self.lights.iter().map(|light| geometry.cube_about(light.position())).collect();
        let build_time = start.elapsed();
        let mappings = geometry.shapes().iter().map(|shape| match shape {
            Shape::Plane(_) | Shape::Disk(_) => Mapping::Tiles,
            Shape::Torus(_) => Mapping::Ring,
            _ => Mapping::Sheet,
        });
        let mappings = mappings.collect();
        let around_eye = around(camera.eye(), &camera, &geometry, &self.objects, &self.materials);
        Ok(Scene {
            camera,
            background: self.background,
            ambient: self.ambient,
            lights: self.lights,
            textures: self.textures,
            materials: self.materials,
            material_of: self.objects.iter().map(|object| object.material).collect(),
            objects: self.objects,
            geometry,
            screens,
            seen_by_eye,
            seen_by_lamp,
            all_opaque,
            mappings,
            around_eye,
            build_time,
        })
    }
}

/// The media that the eye is in, the innermost last: those that a ray from there leaves once more often than it enters.
///
/// Only solids and half spaces count. (Glass made of loose faces has no inside that one ray could tell; leaving it
/// without having entered is right all the same.)
fn around(
    eye: DVec3,
    camera: &Camera,
    geometry: &Geometry,
    objects: &[Object],
    materials: &[Material],
) -> Vec<Medium> {
    let medium = |object: u32| {
        let key = objects[object as usize].material;
        let material = &materials[key as usize];
        let solid = match &geometry.shapes()[object as usize] {
            Shape::Sphere(_) | Shape::Plane(_) | Shape::Cuboid(_) | Shape::Torus(_) => true,
            Shape::Cylinder(cylinder) => cylinder.is_closed(),
            Shape::Cone(cone) => cone.is_closed(),
            _ => false,
        };
        let ior = material.ior.filter(|_| solid && !material.transmit.is_black())?;
        Some(Medium { key, ior })
    };
    if objects.iter().enumerate().all(|(index, _)| medium(index as u32).is_none()) {
        return Vec::new();
    }
    // Any direction will do that is along no likely axis.
    let direction = camera.forward() + camera.right() * 0.137 + camera.up() * 0.0911;
    let ray = Ray::new(eye, direction);
    let mut crossings = Vec::new();
    geometry.crossings(&ray, Interval::FORWARD, None, &mut |found| {
        if let Some(medium) = medium(found.object) {
            let leaving = geometry.surface(&ray, found).normal.dot(direction) > 0.0;
            crossings.push((found.hit.t(), found.object, medium, leaving));
        }
        ControlFlow::Continue(())
    });
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut around: Vec<Medium> = Vec::new();
    let mut entered: Vec<u32> = Vec::new();
    for (_, _, medium, leaving) in crossings {
        if !leaving {
            entered.push(medium.key);
        } else if let Some(at) = entered.iter().position(|&key| key == medium.key) {
            entered.swap_remove(at);
        } else {
            around.push(medium);
        }
    }
    around.reverse();
    around
}
