//! What is wrong with a scene is said at its place, with a word on how to mend it: a table of mistakes.
//!
//! Each row takes a whole scene and puts a mistake into it. The sign `@` marks where the message must point; it is
//! taken out before the scene is read.

use rt_shade::text::{Diagnostics, NoPictures, PictureLoader, load, load_nff, load_toml};

const TOML: &str = r#"version = 1

[image]
width = 32
height = 24
background = [0.1, 0.2, 0.3]

[camera]
eye = [0, 1, 9]
look_at = [0, 1, 0]
up = [0, 1, 0]
fov = 45

[render]
max_depth = 5
ambient = [0.1, 0.1, 0.1]
antialias = "grid:2"

[[light]]
point = { position = [4, 5, 6], color = [1, 0.9, 0.8], attenuation = [1, 0, 0.01] }

[[light]]
spot = { position = [-4, 5, 6], target = [0, 0, 0], inner = 10, outer = 20 }

[texture.floor]
checker = { colors = [[0, 0, 0], [1, 1, 1]], size = 2 }

[texture.wood]
image = { path = "wood.pfm", size = 3 }

[texture.plain]
solid = { color = [0.5, 0.4, 0.3] }

[material.glass]
color = [0.9, 0.9, 1]
diffuse = 0.1
specular = 0.6
shininess = 80
reflect = 0.2
transmit = [0.7, 0.8, 0.9]
ior = 1.5

[material.tiles]
texture = "floor"

[[object]]
name = "ball"
material = "glass"
shape.sphere = { center = [1, 2, 3], radius = 4 }
scale = 2
rotate = { axis = [0, 1, 1], degrees = 30 }
translate = [5, 6, 7]
no_shadow = true

[[object]]
material = "tiles"
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }

[[object]]
material = "tiles"
shape.cuboid = { min = [-1, -2, -3], max = [1, 2, 3] }

[[object]]
material = "tiles"
shape.cylinder = { base = [0, 0, 0], top = [0, 1, 0], radius = 0.5 }

[[object]]
material = "tiles"
shape.open_cone = { base = [0, 0, 2], base_radius = 1.5, top = [0, 3, 2], top_radius = 0.25 }

[[object]]
material = "tiles"
shape.torus = { center = [2, 2, 2], axis = [1, 1, 0], major = 1.75, minor = 0.75 }

[[object]]
material = "tiles"
shape.disk = { center = [3, 3, 3], normal = [0, 0, 1], radius = 0.125 }

[[object]]
material = "tiles"
shape.triangle = { a = [0, 0, 0], b = [1, 0, 0], c = [0, 1, 0], na = [0, 0, 1], nb = [0, 0, 1], nc = [0, 1, 1] }
"#;

/// A picture of one grey texel.
fn pictures(path: &str) -> Result<Vec<u8>, String> {
    match path {
        "wood.pfm" => Ok([&b"PF\n1 1\n-1.0\n"[..], &[0, 0, 0, 63].repeat(3)].concat()),
        "cut.pfm" => Ok(b"PF\n1 1\n-1.0\n\0\0".to_vec()),
        "noise.png" => Ok((0u8..200).map(|x| x.wrapping_mul(77)).collect()),
        "empty.png" => Ok(Vec::new()),
        _ => Err("no such file".to_string()),
    }
}

/// What stands in the scene, what to put there instead, and a part of the message.
type Mistake = (&'static str, &'static str, &'static str);

#[rustfmt::skip]
const TOML_MISTAKES: &[Mistake] = &[
    // The document.
    ("version = 1", "version = @2", "`version` must be a whole number from 1 to 1, got 2"),
    ("version = 1", "version = @\"1\"", "`version` must be a whole number, not a string"),
    ("version = 1", "@verson = 1", "unknown key `verson` in the scene: did you mean `version`?"),
    ("version = 1", "@frobnicate = 1", "unknown key `frobnicate` in the scene: known are `camera`, "),
    ("[image]", "[@images]", "did you mean `image`?"),
    ("[render]", "[@Render]", "did you mean `render`?"),
    ("[[light]]\nspot", "[@light]\nspot", "this key is given twice"),
    ("version = 1", "version = 1\na @b", "a key needs a value"),
    // Syntax.
    ("width = 32", "width = @", "this is no value"),
    ("width = 32", "width @32", "a key needs a value: write KEY = VALUE"),
    ("width = 32", "width = 32\n@width = 33", "this key is given twice"),
    ("diffuse = 0.1", "diffuse = @.1", "a number needs a digit before the point, such as 0.5"),
    ("diffuse = 0.1", "diffuse = 1.@", "a number needs a digit after the point, such as 5.0"),
    ("diffuse = 0.1", "diffuse = @01", "superfluous 0"),
    ("diffuse = 0.1", "diffuse = @abc", "this is no value"),
    ("diffuse = 0.1", "diffuse = @0.1 0.2", "this is no value"),
    ("eye = [0, 1, 9]", "eye = @(0, 1, 9)", "this is no value"),
    ("eye = [0, 1, 9]", "eye = 0@, 1, 9", "unexpected text after a value: a list stands in [ ]"),
    ("eye = [0, 1, 9]", "eye = [@0 1, 9]", "this is no value"),
    ("\"grid:2\"", "\"grid:2@", "expected `\"`"),
    ("[camera]", "[camera@", "unclosed table, expected `]`"),
    ("[camera]", "[camera]\n@= 3", "keys cannot be empty"),
    // Image.
    ("width = 32", "width = @0", "`width` must be a whole number from 1 to 65536, got 0"),
    ("width = 32", "width = @-5", "got -5"),
    ("width = 32", "width = @2147483648", "got 2147483648"),
    ("width = 32", "width = @99999999999999999999", "got 99999999999999999999"),
    ("width = 32", "width = @32.5", "must be a whole number from 1 to 65536, got 32.5"),
    ("width = 32", "width = @nan", "got nan"),
    ("width = 32", "width = @\"32\"", "`width` must be a whole number, not a string"),
    ("height = 24", "height = @0", "`height` must be"),
    ("height = 24", "height = @65537", "from 1 to 65536, got 65537"),
    ("height = 24", "@heigth = 24", "unknown key `heigth` in image: did you mean `height`?"),
    ("[0.1, 0.2, 0.3]", "@[0.1, 0.2]", "`background` must be a list of three numbers, such as [0, 1, 0], not a list of 2 values"),
    ("[0.1, 0.2, 0.3]", "@[]", "not an empty list"),
    ("[0.1, 0.2, 0.3]", "@[0.1, 0.2, 0.3, 1]", "not a list of 4 values"),
    ("[0.1, 0.2, 0.3]", "[0.1, @-0.2, 0.3]", "`background` must have channels from 0 to 1e30, got -0.2"),
    ("[0.1, 0.2, 0.3]", "[0.1, @1e300, 0.3]", "channels from 0 to 1e30, got 1e300"),
    ("[0.1, 0.2, 0.3]", "[0.1, @nan, 0.3]", "`background` must be finite, got nan"),
    ("[0.1, 0.2, 0.3]", "[0.1, 0.2, @inf]", "`background` must be finite, got inf"),
    ("[0.1, 0.2, 0.3]", "[@1e400, 0.2, 0.3]", "`background` is out of range: 1e400"),
    ("[0.1, 0.2, 0.3]", "[0.1, @\"0.2\", 0.3]", "`background` must hold numbers only, not a string"),
    ("[0.1, 0.2, 0.3]", "@\"blue\"", "`background` must be a list of three numbers"),
    // Camera.
    ("eye = [0, 1, 9]", "eye = [@nan, 1, 9]", "`eye` must be finite"),
    ("eye = [0, 1, 9]", "eye = [0, @-inf, 9]", "`eye` must be finite, got -inf"),
    ("eye = [0, 1, 9]", "eye = [0, 1, @-1e400]", "`eye` is out of range"),
    ("eye = [0, 1, 9]", "eye = @[0, 1]", "`eye` must be a list of three numbers"),
    ("eye = [0, 1, 9]", "eye = @1", "not a number"),
    ("eye = [0, 1, 9]", "@eyes = [0, 1, 9]", "unknown key `eyes` in camera: did you mean `eye`?"),
    ("[camera]\neye = [0, 1, 9]", "@[camera]", "camera lacks `eye`"),
    ("look_at = [0, 1, 0]", "look_at = @[0, 1, 9]", "camera eye and look_at must differ"),
    ("look_at = [0, 1, 0]", "look_at = [0, @1e999, 0]", "`look_at` is out of range"),
    ("look_at = [0, 1, 0]", "look_at = [0, @true, 0]", "not true or false"),
    ("look_at = [0, 1, 0]", "@lookat = [0, 1, 0]", "did you mean `look_at`?"),
    ("up = [0, 1, 0]", "up = @[0, 0, 0]", "camera up must not be parallel to the view, got [0, 0, 0]"),
    ("up = [0, 1, 0]", "up = @[0, 0, -2]", "choose another up, such as [0, 1, 0] or [0, 0, 1]"),
    ("up = [0, 1, 0]", "up = [0, @nan, 0]", "`up` must be finite"),
    ("fov = 45", "fov = @0", "camera fov must be greater than 0 and less than 180, got 0"),
    ("fov = 45", "fov = @-10", "got -10"),
    ("fov = 45", "fov = @180", "got 180"),
    ("fov = 45", "fov = @inf", "`fov` must be finite"),
    ("fov = 45", "fov = @\"wide\"", "`fov` must be a number, not a string"),
    ("fov = 45", "fov = @[45]", "not a list of 1 value"),
    ("fov = 45", "fov = @1979-05-27", "not a date or time"),
    ("fov = 45", "@fow = 45", "did you mean `fov`?"),
    // Render.
    ("max_depth = 5", "max_depth = @0", "`max_depth` must be a whole number from 1 to 1000, got 0"),
    ("max_depth = 5", "max_depth = @1000000", "got 1000000"),
    ("max_depth = 5", "max_depth = @1.5", "got 1.5"),
    ("max_depth = 5", "@depth = 5", "unknown key `depth` in render"),
    ("ambient = [0.1, 0.1, 0.1]", "ambient = [0.1, 0.1, @-1]", "`ambient` must have channels from 0 to 1e30, got -1"),
    ("ambient = [0.1, 0.1, 0.1]", "ambient = @0.1", "`ambient` must be a list of three numbers"),
    ("\"grid:2\"", "@\"grid\"", "antialias must be none, grid:N"),
    ("\"grid:2\"", "@\"grid:0\"", "grid:0"),
    ("\"grid:2\"", "@\"grid:100000\"", "grid:100000"),
    ("\"grid:2\"", "@\"adaptive:2\"", "adaptive:2"),
    ("\"grid:2\"", "@\"adaptive:nan:3\"", "adaptive:nan:3"),
    ("\"grid:2\"", "@\"adaptive:0.1:99\"", "adaptive:0.1:99"),
    ("\"grid:2\"", "@2", "`antialias` must be a string in quotes, not a number"),
    // Lights.
    ("point = { position = [4, 5, 6]", "point = { position = [4, 5, @nan]", "`position` must be finite"),
    ("point = { position = [4, 5, 6]", "point = { @pos = [4, 5, 6]", "unknown key `pos` in point light"),
    ("point = { position = [4, 5, 6]", "point = { position = @[4, 5]", "`position` must be a list of three numbers"),
    ("point = { position = [4, 5, 6], ", "point = @{ ", "point light lacks `position`"),
    ("point = { position", "@pont = { position", "unknown key `pont` in light: did you mean `point`?"),
    ("color = [1, 0.9, 0.8]", "color = [1, @-0.9, 0.8]", "`color` must have channels from 0 to 1e30, got -0.9"),
    ("color = [1, 0.9, 0.8]", "@colour = [1, 0.9, 0.8]", "unknown key `colour` in point light: did you mean `color`?"),
    ("attenuation = [1, 0, 0.01]", "attenuation = @[0, 0, 0]", "attenuation must be greater than 0 in one of its numbers"),
    ("attenuation = [1, 0, 0.01]", "attenuation = @[1, 0, -0.01]", "attenuation must be at least 0 and finite, got -0.01"),
    ("attenuation = [1, 0, 0.01]", "attenuation = [1, @1e309, 0]", "`attenuation` is out of range"),
    ("target = [0, 0, 0]", "target = @[-4, 5, 6]", "light position and target must differ"),
    ("target = [0, 0, 0], ", "", "@spotlight lacks `target`"),
    ("inner = 10, outer = 20", "inner = @30, outer = 20", "light inner must be at least 0 and at most outer, got 30"),
    ("inner = 10, outer = 20", "inner = @-1, outer = 20", "got -1"),
    ("inner = 10, outer = 20", "inner = 0, outer = @0", "light outer must be greater than 0 and at most 180, got 0"),
    ("inner = 10, outer = 20", "inner = 10, outer = @181", "got 181"),
    ("inner = 10, outer = 20", "inner = 10, outer = @nan", "`outer` must be finite"),
    ("inner = 10, outer = 20 }", "inner = 10, outer = 20 }\n@point = { position = [0, 0, 0] }", "a light is either `point` or `spot`"),
    ("[texture.floor]", "@[[light]]\n[texture.floor]", "light lacks `point` or `spot`"),
    ("[texture.floor]", "[[light]]\npoint = @3\n[texture.floor]", "point light must be a table, not a number"),
    // Textures.
    ("colors = [[0, 0, 0], [1, 1, 1]]", "colors = @[[0, 0, 0]]", "`colors` must be a list of two colours"),
    ("colors = [[0, 0, 0], [1, 1, 1]]", "colors = @[0, 0, 0]", "`colors` must be a list of two colours"),
    ("colors = [[0, 0, 0], [1, 1, 1]]", "colors = [[0, 0, 0], @1]", "`colors` must be a list of three numbers"),
    ("colors = [[0, 0, 0], [1, 1, 1]]", "colors = [[0, 0, 0], [1, @-1, 1]]", "`colors` must have channels from 0 to 1e30, got -1"),
    ("colors = [[0, 0, 0], [1, 1, 1]], ", "", "@checker texture lacks `colors`"),
    ("size = 2", "size = @0", "texture size must be greater than 0 and finite, got 0"),
    ("size = 2", "size = @-2", "got -2"),
    ("size = 2", "size = @nan", "`size` must be finite"),
    ("size = 2", "@sise = 2", "did you mean `size`?"),
    ("size = 3", "size = @0", "texture size must be greater than 0 and finite, got 0"),
    ("checker = {", "@chequer = {", "unknown key `chequer` in texture `floor`: did you mean `checker`?"),
    ("[texture.plain]\nsolid = { color = [0.5, 0.4, 0.3] }", "@[texture.plain]", "texture `plain` lacks `solid`, `checker` or `image`"),
    ("[texture.plain]", "[texture.plain]\nimage = { path = \"wood.pfm\" }", "texture `plain` is already `image`@"),
    ("solid = { color = [0.5, 0.4, 0.3] }", "solid = @[0.5, 0.4, 0.3]", "solid texture must be a table"),
    ("solid = { color = [0.5, 0.4, 0.3] }", "solid = { color = [0.5, @\"x\", 0.3] }", "`color` must hold numbers only, not a string"),
    ("path = \"wood.pfm\"", "path = @\"gone.png\"", "cannot read `gone.png`: no such file"),
    ("path = \"wood.pfm\"", "path = @\"noise.png\"", "`noise.png`: the picture cannot be read"),
    ("path = \"wood.pfm\"", "path = @\"cut.pfm\"", "`cut.pfm`: the picture cannot be read"),
    ("path = \"wood.pfm\"", "path = @\"empty.png\"", "`empty.png`: the picture cannot be read"),
    ("path = \"wood.pfm\"", "path = @\"../wood.pfm\"", "leaves the scene's folder"),
    ("path = \"wood.pfm\"", "path = @\"/etc/passwd\"", "is absolute"),
    ("path = \"wood.pfm\"", "path = @'a\\b.png'", "write / between folders"),
    ("path = \"wood.pfm\"", "path = @\"\"", "is empty"),
    ("path = \"wood.pfm\"", "path = @7", "`path` must be a string in quotes, not a number"),
    ("path = \"wood.pfm\", ", "", "@image texture lacks `path`"),
    // Materials.
    ("diffuse = 0.1", "diffuse = @-0.1", "diffuse must be from 0 to 1e30, got -0.1"),
    ("diffuse = 0.1", "diffuse = @inf", "`diffuse` must be finite"),
    ("diffuse = 0.1", "@difuse = 0.1", "unknown key `difuse` in material `glass`: did you mean `diffuse`?"),
    ("specular = 0.6", "specular = @-1", "specular must be from 0"),
    ("specular = 0.6", "specular = @[0.6]", "`specular` must be a number, not a list of 1 value"),
    ("shininess = 80", "shininess = @-80", "shininess must be from 0 to"),
    ("shininess = 80", "shininess = @1e310", "`shininess` is out of range"),
    ("reflect = 0.2", "reflect = @1.2", "reflect must be from 0 to 1, got 1.2"),
    ("reflect = 0.2", "reflect = @-0.2", "reflect must be from 0 to 1, got -0.2"),
    ("reflect = 0.2", "reflect = @true", "`reflect` must be a number, not true or false"),
    ("transmit = [0.7, 0.8, 0.9]", "transmit = @0.7", "`transmit` must be a list of three numbers"),
    ("transmit = [0.7, 0.8, 0.9]", "transmit = [@-0.7, 0.8, 0.9]", "`transmit` must have channels from 0 to 1e30"),
    ("transmit = [0.7, 0.8, 0.9]", "transmit = @[0.7, 1.8, 0.9]", "transmit must be from 0 to 1, got 1.8"),
    ("ior = 1.5", "ior = @0", "ior must be from 0.001 to 1000, got 0"),
    ("ior = 1.5", "ior = @-1.5", "ior must be from 0.001 to 1000, got -1.5"),
    ("ior = 1.5", "ior = @nan", "`ior` must be finite, got nan"),
    ("ior = 1.5", "@oir = 1.5", "did you mean `ior`?"),
    ("color = [0.9, 0.9, 1]", "color = [0.9, @-0.9, 1]", "`color` must have channels from 0 to 1e30"),
    ("color = [0.9, 0.9, 1]", "color = @{ r = 1 }", "`color` must be a list of three numbers, such as [0, 1, 0], not a table"),
    ("texture = \"floor\"", "texture = @\"flor\"", "there is no texture `flor`: did you mean `floor`?"),
    ("texture = \"floor\"", "texture = @\"marble\"", "there is no texture `marble`: known are `floor`, `wood`, `plain`"),
    ("texture = \"floor\"", "texture = @1", "`texture` must be a string in quotes"),
    ("texture = \"floor\"", "color = [1, 1, 1]\n@texture = \"floor\"", "material `tiles` has both `color` and `texture`"),
    ("[material.glass]", "[material]\nice = @1\n[material.glass]", "material `ice` must be a table, not a number"),
    // Objects.
    ("material = \"glass\"", "material = @\"glas\"", "there is no material `glas`: did you mean `glass`?"),
    ("material = \"glass\"", "material = @\"iron\"", "there is no material `iron`: known are `glass`, `tiles`"),
    ("material = \"glass\"", "material = @{ color = [1, 0, 0] }", "`material` must be a string in quotes, not a table"),
    ("material = \"glass\"\n", "", "@object lacks `material`"),
    ("material = \"glass\"", "@materiel = \"glass\"", "did you mean `material`?"),
    ("name = \"ball\"", "name = @1", "`name` must be a string in quotes"),
    ("no_shadow = true", "no_shadow = @1", "`no_shadow` must be true or false, not a number"),
    ("no_shadow = true", "no_shadow = @\"true\"", "not a string"),
    ("no_shadow = true", "@noshadow = true", "did you mean `no_shadow`?"),
    ("scale = 2", "scale = @0", "scale must be greater than 0 and finite, got 0"),
    ("scale = 2", "scale = @-1", "scale must be greater than 0 and finite, got -1"),
    ("scale = 2", "scale = @[1, 2, 1]", "`scale` must be a number, not a list of 3 values"),
    ("scale = 2", "scale = @inf", "`scale` must be finite"),
    ("scale = 2", "scale = @1e300", "the shape is not legal"),
    ("scale = 2", "scale = @1e-300", "the shape is not legal"),
    ("translate = [5, 6, 7]", "translate = @[1e300, 6, 7]", "the shape is not legal"),
    ("shape.sphere = {", "shape.@type = \"sphere\"\nshape.sphere = {", "unknown shape `type`"),
    ("eye = [0, 1, 9]", "eye = [0, 1, 9", "a comma is missing here, or the `]` of the list before@"),
    ("axis = [0, 1, 1], degrees", "axis = @[0, 0, 0], degrees", "rotation axis must not have length 0"),
    ("axis = [0, 1, 1], degrees", "axis = [0, @nan, 1], degrees", "`axis` must be finite"),
    ("degrees = 30", "degrees = @nan", "`degrees` must be finite"),
    ("degrees = 30", "@angle = 30", "unknown key `angle` in rotate"),
    ("rotate = { axis = [0, 1, 1], degrees = 30 }", "rotate = @30", "rotate must be a table, not a number"),
    ("translate = [5, 6, 7]", "translate = @5", "`translate` must be a list of three numbers"),
    ("translate = [5, 6, 7]", "translate = [5, @1e400, 7]", "`translate` is out of range"),
    // Shapes.
    ("shape.sphere = {", "shape.@spehre = {", "unknown shape `spehre`: did you mean `sphere`?"),
    ("shape.sphere = {", "shape.@teapot = {", "unknown shape `teapot`: known are `sphere`, `plane`"),
    ("shape.sphere = { center = [1, 2, 3], radius = 4 }", "shape = @\"sphere\"", "`shape` must be a table"),
    ("shape.sphere = { center = [1, 2, 3], radius = 4 }", "shape = @{}", "`shape` is empty"),
    ("shape.sphere = { center = [1, 2, 3], radius = 4 }", "shape.sphere = @4", "`sphere` must be a table"),
    ("shape.sphere = { center = [1, 2, 3], radius = 4 }\n", "", "@object lacks `shape`"),
    ("radius = 4 }", "radius = 4 }\nshape.@disk = { center = [0, 0, 0], normal = [0, 0, 1], radius = 1 }", "write another [[object]] for the disk"),
    ("shape.sphere = { center = [1, 2, 3], radius = 4 }", "shape.sphere = @{ center = [1, 2, 3] }", "sphere lacks `radius`"),
    ("shape.sphere = { center = [1, 2, 3], radius = 4 }", "shape.sphere = @{}", "sphere lacks `center`, `radius`"),
    ("radius = 4", "radius = @0", "radius must be greater than 0 and finite, got 0"),
    ("radius = 4", "radius = @-4", "radius must be greater than 0 and finite, got -4"),
    ("radius = 4", "radius = @-0.0", "radius must be greater than 0"),
    ("radius = 4", "radius = @nan", "`radius` must be finite, got nan"),
    ("radius = 4", "radius = @+inf", "`radius` must be finite, got +inf"),
    ("radius = 4", "radius = @1e400", "`radius` is out of range: 1e400"),
    ("radius = 4", "radius = @1e308", "1e308"),
    ("radius = 4", "radius = @1e-310", "radius"),
    ("radius = 4", "radius = @\"4\"", "`radius` must be a number, not a string"),
    ("radius = 4", "radius = @[4, 4, 4]", "`radius` must be a number, not a list of three numbers"),
    ("radius = 4", "@raduis = 4", "unknown key `raduis` in sphere: did you mean `radius`?"),
    ("radius = 4", "radius = 4, @color = [1, 0, 0]", "unknown key `color` in sphere: known are `center`, `radius`"),
    ("center = [1, 2, 3]", "center = [1, @nan, 3]", "`center` must be finite"),
    ("center = [1, 2, 3]", "center = @[1, 2]", "`center` must be a list of three numbers [x, y, z], not a list of 2 values"),
    ("center = [1, 2, 3]", "center = [1, @[2], 3]", "`center` must hold numbers only, not a list of 1 value"),
    ("center = [1, 2, 3]", "@centre = [1, 2, 3]", "did you mean `center`?"),
    ("normal = [0, 1, 0]", "normal = @[0, 0, 0]", "must not have length 0"),
    ("normal = [0, 1, 0]", "normal = [0, 1, @inf]", "`normal` must be finite"),
    ("normal = [0, 1, 0]", "@normals = [0, 1, 0]", "did you mean `normal`?"),
    ("max = [1, 2, 3]", "max = @[1, -3, 3]", "min must not exceed max"),
    ("max = [1, 2, 3]", "max = [@1e500, 2, 3]", "`max` is out of range"),
    ("max = [1, 2, 3]", "size = [1, 2, 3]", "@cuboid lacks `max`"),
    ("top = [0, 1, 0], radius", "top = @[0, 0, 0], radius", "must differ"),
    ("radius = 0.5", "radius = @-0.5", "radius must be greater than 0 and finite, got -0.5"),
    ("base_radius = 1.5", "base_radius = @-1.5", "got -1.5"),
    ("top_radius = 0.25", "top_radius = @-0.25", "got -0.25"),
    ("top_radius = 0.25", "@topradius = 0.25", "did you mean `top_radius`?"),
    ("top = [0, 3, 2]", "top = @[0, 0, 2]", "must differ"),
    ("axis = [1, 1, 0], major", "axis = @[0, 0, 0], major", "must not have length 0"),
    ("major = 1.75", "major = @0", "must be greater than 0 and finite, got 0"),
    ("major = 1.75", "major = @-1.75", "got -1.75"),
    ("major = 1.75", "@mayor = 1.75", "did you mean `major`?"),
    ("minor = 0.75", "minor = @0", "must be greater than 0 and finite, got 0"),
    ("minor = 0.75", "minor = @-0.75", "got -0.75"),
    ("normal = [0, 0, 1], radius", "normal = @[0, 0, 0], radius", "must not have length 0"),
    ("radius = 0.125", "radius = @-0.125", "got -0.125"),
    ("c = [0, 1, 0]", "c = [2, 0, 0]", "@triangle has no area"),
    ("c = [0, 1, 0]", "c = [0, @nan, 0]", "`c` must be finite"),
    ("nc = [0, 1, 1]", "nc = @[0, 0, 0]", "must not have length 0"),
    (", nc = [0, 1, 1]", "", "@triangle lacks `nc`"),
];

const NFF: &str = "\
# a comment
b 0.1 0.2 0.3
v
from 0 0 9
at 0 0 0
up 0 1 0
angle 45
hither 1
resolution 32 24
l 2 4 4
l 1 2 3 0.5 0.5 0.5
f 1 0.5 0.25 0.8 0.2 30 0 0
s 1 2 3 0.5
c 0 0 0 1 0 2 0 0.75
c 5 0 0 2 5 2 0 2
p 4
0 0 0
4 0 0
4 4 0
0 4 0
f 1 1 1 0 0.1 100 0.9 1.5
pp 3
0 0 1 0 0 1
1 0 1 0 0 1
0 1 1 0 1 1
";

#[rustfmt::skip]
const NFF_MISTAKES: &[Mistake] = &[
    ("b 0.1", "b @-0.1", "background must have channels from 0 to 1e30"),
    ("b 0.1 0.2 0.3", "b 0.1 0.2", "background must be a number, got `@v`"),
    ("# a comment", "@hello", "unknown entity `hello`: known are `v`, `b`"),
    ("# a comment", "@7", "the number 7 belongs to nothing"),
    ("b 0.1 0.2 0.3", "b 0.1 0.2 0.3 @0.4", "the number 0.4 belongs to nothing"),
    ("from 0 0 9", "from 0 0 @nan", "`from` must be finite, got nan"),
    ("from 0 0 9", "from 0 0 @x9", "`from` must be a number, got `x9`"),
    ("from 0 0 9\n", "", "the view lacks `from`"),
    ("at 0 0 0", "@at 0 0 9", "must differ"),
    ("at 0 0 0", "at 0 0 @inf", "`at` must be finite"),
    ("up 0 1 0", "@up 0 0 1", "must not be parallel to the view"),
    ("up 0 1 0", "@up 0 0 0", "must not be parallel to the view"),
    ("angle 45", "@angle 0", "fov must be greater than 0"),
    ("angle 45", "@angle 180", "fov must be greater than 0 and less than 180"),
    ("angle 45", "angle @1e999", "`angle` is out of range: 1e999"),
    ("angle 45", "angle @wide", "`angle` must be a number, got `wide`"),
    ("resolution 32 24", "resolution @0 24", "the width of the resolution must be a whole number from 1 to 65536, got 0"),
    ("resolution 32 24", "resolution 32 @1.5", "the height of the resolution must be a whole number"),
    ("resolution 32 24", "resolution 32 @99999999999", "got 99999999999"),
    ("resolution 32 24", "resolution 32", "the height of the resolution must be a whole number from 1 to 65536, got @l"),
    ("l 2 4 4", "l 2 4 @nan", "the position of a light must be finite"),
    ("l 2 4 4", "l 2 4 4 1 1 @-1", "light color must have channels from 0 to 1e30"),
    ("l 2 4 4\n", "l 2 4\n", "the position of a light must be a number, got `@l`"),
    ("l 2 4 4", "@v from 0 0 9 at 0 0 0 up 0 1 0 angle 45 resolution 1 1", "a second view"),
    ("f 1 0.5 0.25 0.8 0.2 30 0 0\ns", "@s", "`s` has no fill: put an `f` entity before it"),
    ("f 1 0.5 0.25 0.8 0.2 30 0 0\n", "f 1 0.5 0.25 0.8 0.2 30 0\n", "ior must be a number, got `@s`"),
    ("f 1 0.5 0.25 0.8 0.2 30 0 0", "f 1 0.5 0.25 @-0.8 0.2 30 0 0", "diffuse must be from 0 to 1e30, got -0.8"),
    ("f 1 0.5 0.25 0.8 0.2 30 0 0", "f 1 @-0.5 0.25 0.8 0.2 30 0 0", "color must have channels from 0 to 1e30"),
    ("f 1 0.5 0.25 0.8 0.2 30 0 0", "f 1 0.5 0.25 0.8 0.2 @inf 0 0", "Shine must be finite, got inf"),
    ("100 0.9 1.5", "100 0.9 @-1.5", "ior must be from 0.001 to 1000, got -1.5"),
    ("100 0.9 1.5", "100 @-0.9 1.5", "transmit must be from 0 to 1, got -0.9"),
    ("100 0.9 1.5", "@-100 0.9 1.5", "shininess must be from 0 to 1e9, got -100"),
    ("s 1 2 3 0.5", "@s 1 2 3 0", "radius must be greater than 0 and finite, got 0"),
    ("s 1 2 3 0.5", "s 1 2 3 @nan", "the radius of a sphere must be finite"),
    ("s 1 2 3 0.5", "s 1 2 3", "the radius of a sphere must be a number, got `@c`"),
    ("s 1 2 3 0.5", "s 1 2 3 0.5 @0.5", "the number 0.5 belongs to nothing"),
    ("s 1 2 3 0.5", "s 1 @2,5 3 0.5", "the center of a sphere must be a number, got `2,5`"),
    ("s 1 2 3 0.5", "@sphere 1 2 3 0.5", "unknown entity `sphere`"),
    ("c 0 0 0 1 0 2 0 0.75", "@c 0 0 0 1 0 0 0 0.75", "must differ"),
    ("c 0 0 0 1 0 2 0 0.75", "@c 0 0 0 1 0 2 0 -0.75", "must have the same sign"),
    ("c 0 0 0 1 0 2 0 0.75", "@c 0 0 0 0 0 2 0 0", "must be greater than 0"),
    ("c 0 0 0 1 0 2 0 0.75", "c 0 0 0 1 0 2 0 @-", "the apex radius of a cone must be a number, got `-`"),
    ("p 4", "p @2", "the number of vertices must be a whole number from 3 to 10000, got 2"),
    ("p 4", "p @-1", "got -1"),
    ("p 4", "p @1000000000", "got 1000000000"),
    ("p 4", "p @99999999999999999999999", "got 99999999999999999999999"),
    ("p 4", "p @4.5", "got 4.5"),
    ("p 4", "p 5", "vertex 5 of 5 must be a number, got `@f`"),
    ("p 4", "p 3", "the number @0 belongs to nothing"),
    ("4 4 0", "4 @nan 0", "vertex 3 of 4 must be finite"),
    ("4 4 0", "4 @1e400 0", "vertex 3 of 4 is out of range"),
    ("pp 3", "pp @2", "the number of vertices must be a whole number"),
    ("1 0 1 0 0 1", "1 0 1 0 0 @nan", "the normal of vertex 2 of 3 must be finite"),
];

/// The text without the sign, and the line and column where it stood.
fn marked(text: &str) -> Option<(String, usize, usize)> {
    let at = text.find('@')?;
    let line = text[..at].matches('\n').count() + 1;
    let column = text[..at].chars().rev().take_while(|c| *c != '\n').count() + 1;
    Some((text.replacen('@', "", 1), line, column))
}

fn check(whole: &str, mistakes: &[Mistake], read: impl Fn(&str) -> Option<Diagnostics>) -> usize {
    assert!(read(whole).is_none(), "{}", read(whole).unwrap());
    let mut failures = Vec::new();
    for (there, instead, message) in mistakes {
        assert_eq!(whole.matches(there).count().min(1), 1, "{there}");
        let text = whole.replacen(there, instead, 1);
        let (text, place) = match marked(&text) {
            Some((text, line, column)) => (text, Some((line, column))),
            // Where the place cannot be marked it is the message that tells; see below.
            None => (text, None),
        };
        let Some(found) = read(&text) else {
            failures.push(format!("{instead}: not refused"));
            continue;
        };
        let fragment = message.replacen('@', "", 1);
        let fits = |d: &&rt_shade::text::Diagnostic| {
            d.message.contains(&fragment) && place.is_none_or(|place| place == (d.line, d.column))
        };
        if !found.iter().any(|d| fits(&d)) {
            failures.push(format!("{instead}: expected {place:?} {fragment}, got\n{found}"));
        }
        // One mistake, one message: what follows from it is not reported again.
        if found.len() > 1 && !message.contains('@') && !found.iter().any(|d| d.message.contains(" lacks ")) {
            failures.push(format!("{instead}: more than one message\n{found}"));
        }
        assert!(found.iter().all(|d| d.line >= 1 && d.column >= 1 && d.file == "scene"));
    }
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), mistakes.len(), failures.join("\n\n"));
    mistakes.len()
}

#[test]
fn toml_mistakes() {
    let tried = check(TOML, TOML_MISTAKES, |text| load_toml("scene", text, &pictures).err());
    println!("{tried} mistakes in TOML, each told with its place");
    assert!(tried >= 150);
}

#[test]
fn nff_mistakes() {
    let tried = check(NFF, NFF_MISTAKES, |text| load_nff("scene", text).err());
    println!("{tried} mistakes in NFF, each told with its place");
    assert!(tried >= 50);
}

#[test]
fn all_errors_of_a_file_at_once() {
    let text = TOML
        .replace("fov = 45", "fov = 0")
        .replace("ior = 1.5", "ior = -1\nfrobnicate = 2")
        .replace("material = \"glass\"", "material = \"glas\"")
        .replace("center = [1, 2, 3]", "center = [nan, 2, 1e400]")
        .replace("minor = 0.75", "minor = -1");
    let found = load_toml("scene", &text, &pictures).unwrap_err();
    let places: Vec<(usize, usize)> = found.iter().map(|d| (d.line, d.column)).collect();
    assert_eq!(places, [(12, 7), (41, 7), (42, 1), (49, 12), (50, 28), (50, 36), (74, 77)], "{found}");
}

/// The message as it is printed.
#[test]
fn printed_form() {
    let text = TOML.replace("radius = 4", "radius = -4");
    let found = load_toml("scene.toml", &text, &pictures).unwrap_err().to_string();
    let lines: Vec<&str> = found.lines().collect();
    assert_eq!(lines[0], "scene.toml:49:47: error: sphere radius must be greater than 0 and finite, got -4");
    assert_eq!(lines[1], " 49 | shape.sphere = { center = [1, 2, 3], radius = -4 }");
    assert_eq!(lines[2], "    |                                               ^^");
    assert_eq!(lines.len(), 3);
}

#[test]
fn files_that_are_no_scene() {
    let place = |name: &str, bytes: &[u8]| {
        let found = load(name, bytes, &NoPictures).unwrap_err();
        (found[0].line, found[0].column, found[0].message.clone())
    };
    for name in ["a.toml", "a.nff"] {
        assert!(place(name, b"").2.contains("the file is empty"));
        assert!(place(name, b" \r\n\t\n").2.contains("the file is empty"));
        assert!(place(name, b"\xef\xbb\xbf").2.contains("the file is empty"));
        let (line, column, message) = place(name, b"# \xc3\xa4\n#  \xff\n");
        assert_eq!((line, column), (2, 4));
        assert!(message.contains("0xff is not UTF-8"), "{message}");
        let (line, column, message) = place(name, b"# ab\n# \0\n");
        assert_eq!((line, column), (2, 3));
        assert!(message.contains("control character 0x00"), "{message}");
        assert!(place(name, b"\x7fELF\x02\x01").2.contains("0x7f"));
    }
    assert!(place("a.toml", b"# nothing").2.contains("the scene lacks `camera`"));
    assert!(place("a.nff", b"# nothing").2.contains("without a view"));
}

#[test]
fn byte_order_marks_and_line_ends_mean_nothing() {
    let marked = |text: &str| [&b"\xef\xbb\xbf"[..], text.replace('\n', "\r\n").as_bytes()].concat();
    assert!(load("a.toml", &marked(TOML), &pictures as &dyn PictureLoader).is_ok());
    assert!(load("A.NFF", &marked(NFF), &NoPictures).is_ok());
    let wrong = marked(&TOML.replace("radius = 4", "radius = -4"));
    let found = load("a.toml", &wrong, &pictures).unwrap_err();
    assert_eq!((found[0].line, found[0].column), (49, 47));
    assert!(!found.to_string().contains('\r'));
}

/// A file that ends anywhere is an error with a place in it, or a smaller scene; it is never a panic.
#[test]
fn truncated_anywhere() {
    let lines = TOML.lines().count();
    let mut refused = 0;
    for end in 0..TOML.len() {
        let Err(found) = load("a.toml", &TOML.as_bytes()[..end], &pictures) else { continue };
        refused += 1;
        assert!(found.iter().all(|d| (1..=lines).contains(&d.line)), "{end}: {found}");
    }
    assert!(refused > TOML.len() / 2);
    let mut refused = 0;
    for end in 0..NFF.len() {
        refused += usize::from(load("a.nff", &NFF.as_bytes()[..end], &NoPictures).is_err());
    }
    assert!(refused > NFF.len() / 2);
}

/// Any byte replaced by any of a few: an answer every time.
#[test]
fn changed_anywhere() {
    for (name, whole) in [("a.toml", TOML), ("a.nff", NFF)] {
        for at in 0..whole.len() {
            for byte in *b"x9-.[]{}\"#\n \xff" {
                let mut bytes = whole.as_bytes().to_vec();
                bytes[at] = byte;
                let _ = load(name, &bytes, &pictures);
            }
        }
    }
}

#[test]
fn nested_too_deeply() {
    let deep = 100_000;
    for text in [
        format!("a = {}", "[".repeat(deep)),
        format!("a = {}", "{b = ".repeat(deep)),
        format!("[{}b]\nx = 1", "a.".repeat(deep)),
        format!("\n{}b = 1", "a.".repeat(deep)),
        format!("[camera]\neye = {}{}", "[".repeat(70), "]".repeat(70)),
    ] {
        let found = load_toml("scene", &text, &NoPictures).unwrap_err();
        assert!(found[0].line <= 2, "{found}");
    }
}

/// Ten thousand wrong objects: the first errors are told, the rest counted, in no time to speak of.
#[test]
fn very_many_errors() {
    let mut text = TOML.to_string();
    for index in 0..10_000 {
        text.push_str(&format!(
            "[material.m{index}]\n[[object]]\nmaterial = \"n{index}\"\nshape.ball = {{}}\n"
        ));
    }
    let found = load_toml("scene", &text, &pictures).unwrap_err();
    assert_eq!((found.len(), found.count()), (20, 20_000));
    assert_eq!(found[0].line, TOML.lines().count() + 3);
}
