//! Bad input of every kind: nothing crashes, nothing hangs, every refusal says where and why, and the old picture
//! stays. `cargo test -p rt-cli --test bad_input -- --nocapture` prints how many inputs were tried and what came of
//! them.

mod support;

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Mutex;
use support::{EVERYTHING, Outcome, Workshop};

const OLD: &[u8] = b"the old picture";

/// Renders into a file that is there already; checks that it is replaced exactly when the exit code is 0.
fn render(workshop: &Workshop, scene: &str, options: &[&str]) -> Outcome {
    workshop.write("out.png", OLD);
    let before = workshop.names();
    let outcome = workshop.rt(&[&["render", scene, "-o", "out.png", "--quiet"], options].concat());
    let untouched = workshop.read("out.png") == OLD;
    assert_eq!(untouched, outcome.code() != 0, "{scene} {options:?}: {outcome:?}");
    assert_eq!(workshop.names(), before, "{scene} {options:?}");
    assert!(!outcome.stderr.contains("panicked"), "{outcome:?}");
    outcome
}

/// Line and column of the first message, when it has the form `FILE:LINE:COLUMN: error: ...`.
fn place(outcome: &Outcome, file: &str) -> Option<(usize, usize)> {
    let rest = outcome.stderr.strip_prefix(file)?.strip_prefix(':')?;
    let (line, rest) = rest.split_once(':')?;
    let (column, rest) = rest.split_once(':')?;
    rest.starts_with(" error: ").then_some(())?;
    Some((line.parse().ok()?, column.parse().ok()?))
}

/// The numbers of a scene's text, those in strings and names left out.
fn numbers(text: &str) -> Vec<Range<usize>> {
    let bytes = text.as_bytes();
    let mut found = Vec::new();
    let (mut at, mut quoted) = (0, false);
    while at < bytes.len() {
        let before = if at == 0 { b' ' } else { bytes[at - 1] };
        if bytes[at] == b'"' {
            quoted = !quoted;
        } else if !quoted
            && !before.is_ascii_alphanumeric()
            && (bytes[at].is_ascii_digit() || bytes[at] == b'-')
        {
            let length = bytes[at..].iter().take_while(|b| b.is_ascii_digit() || b"-.".contains(b)).count();
            found.push(at..at + length);
            at += length;
            continue;
        }
        at += 1;
    }
    found
}

/// Counts of outcomes, shared by the workers.
#[derive(Default)]
struct Tally(Mutex<BTreeMap<&'static str, usize>>);

impl Tally {
    fn count(&self, what: &'static str) {
        *self.0.lock().unwrap().entry(what).or_default() += 1;
    }
    fn of(&self, what: &str) -> usize {
        self.0.lock().unwrap().get(what).copied().unwrap_or(0)
    }
}

/// Shares the work between two workers, each with a folder of its own.
fn each<T: Sync>(inputs: &[T], work: impl Fn(&Workshop, &T) + Sync) {
    let next = std::sync::atomic::AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                let workshop = Workshop::new();
                while let Some(input) = inputs.get(next.fetch_add(1, std::sync::atomic::Ordering::Relaxed)) {
                    work(&workshop, input);
                }
            });
        }
    });
}

#[test]
fn the_scene_itself_is_good() {
    let workshop = Workshop::new();
    let outcome = render(&workshop, "scene.toml", &[]);
    assert_eq!((outcome.code(), outcome.stderr.as_str()), (0, ""));
}

/// Every number of the scene, one at a time, is replaced by what is no number that any field could take.
#[test]
fn every_number_refuses_what_is_no_finite_number() {
    let bad = ["nan", "-nan", "inf", "-inf", "1e400", "-1e400", "\"1\"", "true", "[]", "{}"];
    let numbers = numbers(EVERYTHING);
    assert!(numbers.len() > 130, "{}", numbers.len());
    let inputs: Vec<_> = numbers.iter().flat_map(|n| bad.iter().map(move |b| (n.clone(), *b))).collect();
    let tally = Tally::default();
    each(&inputs, |workshop, (number, value)| {
        let mut text = EVERYTHING.to_string();
        text.replace_range(number.clone(), value);
        workshop.write("bad.toml", &text);
        let outcome = render(workshop, "bad.toml", &[]);
        let line = 1 + EVERYTHING[..number.start].matches('\n').count();
        let found = place(&outcome, "bad.toml");
        assert_eq!(outcome.code(), 3, "{value} in line {line}: {outcome:?}");
        assert_eq!(found.map(|p| p.0), Some(line), "{value}: {outcome:?}");
        tally.count("refused with line and column");
    });
    println!(
        "not finite or not a number: {} inputs, {} refused with line and column",
        inputs.len(),
        tally.of("refused with line and column")
    );
}

/// Every number becomes extreme: the scene is drawn or refused with its place, and takes no longer for it.
#[test]
fn every_number_survives_extremes() {
    let extreme =
        ["0", "-0.0", "-1", "1e308", "-1e308", "5e-324", "1e-320", "1e-200", "1e200", "2147483648", "0.1"];
    let inputs: Vec<_> =
        numbers(EVERYTHING).into_iter().flat_map(|n| extreme.iter().map(move |e| (n.clone(), *e))).collect();
    let tally = Tally::default();
    each(&inputs, |workshop, (number, value)| {
        let mut text = EVERYTHING.to_string();
        text.replace_range(number.clone(), value);
        workshop.write("bad.toml", &text);
        let outcome = render(workshop, "bad.toml", &["--width", "8", "--height", "6"]);
        let line = 1 + EVERYTHING[..number.start].matches('\n').count();
        match outcome.code() {
            0 => tally.count("drawn"),
            3 => {
                assert!(place(&outcome, "bad.toml").is_some(), "{value} in line {line}: {outcome:?}");
                tally.count("refused with line and column");
            }
            _ => panic!("{value} in line {line}: {outcome:?}"),
        }
    });
    println!(
        "extreme numbers: {} inputs, {} drawn, {} refused with line and column",
        inputs.len(),
        tally.of("drawn"),
        tally.of("refused with line and column")
    );
}

/// A change to the scene's text, and what the message must say.
type Change = (&'static str, &'static str, &'static str);

const CHANGES: &[Change] = &[
    // Keys and words: the nearest one is named.
    ("radius = 1 }", "raduis = 1 }", "`radius`"),
    ("[camera]", "[camara]", "`camera`"),
    ("shape.sphere", "shape.spere", "`sphere`"),
    ("material = \"glass\"", "material = \"glas\"", "`glass`"),
    ("texture = \"floor\"", "texture = \"flor\"", "`floor`"),
    ("look_at", "lookat", "`look_at`"),
    ("shininess = 40", "shinyness = 40", "`shininess`"),
    ("fov = 40", "fov = 40\nfov = 41", "twice"),
    ("checker = {", "chequer = {", "`checker`"),
    ("point = { position", "pont = { position", "`point`"),
    ("antialias = \"grid:2\"", "antialias = \"gird:2\"", "grid"),
    ("antialias = \"grid:2\"", "antialias = \"grid:0\"", "grid"),
    ("antialias = \"grid:2\"", "antialias = \"grid:99999\"", "grid"),
    ("antialias = \"grid:2\"", "antialias = 2", "antialias"),
    ("version = 1", "version = 2", "version"),
    // Shapes.
    ("radius = 1 }", "radius = 0 }", "radius"),
    ("radius = 1 }", "radius = -1 }", "radius"),
    ("radius = 1 }", "}", "radius"),
    ("normal = [0, 1, 0]", "normal = [0, 0, 0]", "normal"),
    ("normal = [0, 1, 0]", "normal = [0, 1]", "normal"),
    ("normal = [0, 1, 0]", "normal = [0, 1, 0, 0]", "normal"),
    ("axis = [0, 1, 0.5]", "axis = [0, 0, 0]", "axis"),
    ("minor = 0.25", "minor = 0", "minor"),
    ("minor = 0.25", "minor = -0.25", "minor"),
    ("major = 1.5", "major = -1.5", "major"),
    ("top = [3, 2, 0.5]", "top = [3, 0.5, 0]", "base"),
    ("radius = 0.5 }", "radius = 0 }", "radius"),
    (
        "base_radius = 0.5, top = [2, 2, 3], top_radius = 0.1",
        "base_radius = 0, top = [2, 2, 3], top_radius = 0",
        "radius",
    ),
    ("base_radius = 0.5, top = [2, 2, 3]", "base_radius = -0.5, top = [2, 2, 3]", "radius"),
    ("min = [-4, 0.5, -1]", "min = [4, 0.5, -1]", "min"),
    ("radius = 0.75", "radius = -0.75", "radius"),
    ("c = [1, 5, 0.5]", "c = [3, 4, 0]", "triangle"),
    ("shape.disk", "shape.sphere = { center = [0, 0, 0], radius = 1 }\nshape.disk", "another [[object]]"),
    ("shape.triangle = { a = [1, 4, 0], b = [2, 4, 0], c = [1, 5, 0.5] }", "", "shape"),
    // Transforms.
    ("scale = 1.25", "scale = 0", "scale"),
    ("scale = 1.25", "scale = -1", "scale"),
    ("scale = 1.25", "scale = [1, 2, 1]", "scale"),
    ("axis = [0, 1, 0], degrees", "axis = [0, 0, 0], degrees", "axis"),
    ("rotate = {", "rotat = {", "`rotate`"),
    // Camera, lights, materials, textures.
    ("eye = [0, 3, 12]", "eye = [0, 1.5, 0]", "look_at"),
    ("up = [0, 1, 0]", "up = [0, 0, 0]", "up"),
    ("up = [0, 1, 0]", "up = [0, 1.5, 12]", "up"),
    ("fov = 40", "fov = 0", "fov"),
    ("fov = 40", "fov = 180", "fov"),
    ("fov = 40", "fov = -40", "fov"),
    ("eye = [0, 3, 12]", "", "eye"),
    ("inner = 12", "inner = 19", "inner"),
    ("outer = 18", "outer = 181", "outer"),
    ("outer = 18", "outer = -18", "outer"),
    ("target = [0, 1, 0]", "target = [-5, 9, 7]", "target"),
    ("color = [1, 0.9, 0.8]", "color = [1, -0.9, 0.8]", "color"),
    ("color = [1, 0.9, 0.8]", "color = \"red\"", "color"),
    ("attenuation = [1, 0.01, 0.002]", "attenuation = [0, 0, 0]", "attenuation"),
    ("attenuation = [1, 0.01, 0.002]", "attenuation = [1, -0.01, 0]", "attenuation"),
    ("ior = 1.5", "ior = 0", "ior"),
    ("ior = 1.5", "ior = -1.5", "ior"),
    ("diffuse = 0.2", "diffuse = -0.2", "diffuse"),
    ("reflect = 0.1", "reflect = -0.1", "reflect"),
    ("reflect = 0.1", "reflect = 1.5", "reflect"),
    ("shininess = 40", "shininess = -1", "shininess"),
    ("size = 1.5", "size = 0", "size"),
    ("size = 1.5", "size = -1", "size"),
    ("colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]]", "colors = [[0.1, 0.1, 0.1]]", "colors"),
    ("texture = \"floor\"", "texture = \"floor\"\ncolor = [1, 1, 1]", "color"),
    // Size of the picture and depth.
    ("width = 24", "width = 0", "width"),
    ("width = 24", "width = -5", "width"),
    ("width = 24", "width = 2147483648", "width"),
    ("width = 24", "width = 99999999999999999999", "width"),
    ("width = 24", "width = 24.5", "width"),
    ("height = 18", "height = 0", "height"),
    ("height = 18", "height = 2147483648", "height"),
    ("max_depth = 4", "max_depth = 0", "max_depth"),
    ("max_depth = 4", "max_depth = 1000000", "max_depth"),
    // Pictures as textures.
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \"missing.png\" }",
        "missing.png",
    ),
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \"garbage.png\" }",
        "garbage.png",
    ),
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \"truncated.png\" }",
        "truncated.png",
    ),
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \"empty.png\" }",
        "empty.png",
    ),
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \"bomb.png\" }",
        "bomb.png",
    ),
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \"nan.pfm\" }",
        "nan.pfm",
    ),
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \".\" }",
        ".",
    ),
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \"\" }",
        "path",
    ),
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \"../wood.png\" }",
        "folder",
    ),
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \"/etc/passwd\" }",
        "folder",
    ),
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \"link.png\" }",
        "folder",
    ),
    (
        "checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }",
        "image = { path = \"pipe.png\" }",
        "pipe.png",
    ),
    ("checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }", "image = { path = 5 }", "path"),
    // Syntax.
    ("version = 1", "version = ", ""),
    ("version = 1", "= 1", ""),
    ("version = 1", "version = 1 2", ""),
    ("[image]", "[image", ""),
    ("[[light]]", "[light]", ""),
    ("eye = [0, 3, 12]", "eye = [0, 3, 12", ""),
    ("name = \"ball\"", "name = \"ball", ""),
    ("name = \"ball\"", "name = \"b\\qll\"", ""),
    ("name = \"ball\"", "name = 'ball\u{0}'", ""),
];

#[test]
fn every_change_is_refused_in_words() {
    let tally = Tally::default();
    let vague = Mutex::new(Vec::new());
    each(CHANGES, |workshop, (from, to, word)| {
        assert!(EVERYTHING.contains(from), "{from}");
        textures(workshop);
        let text = EVERYTHING.replacen(from, to, 1);
        workshop.write("bad.toml", &text);
        let outcome = render(workshop, "bad.toml", &[]);
        let message = outcome.stderr.split('\n').next().unwrap_or_default();
        if outcome.code() != 3 || place(&outcome, "bad.toml").is_none() || !message.contains(word) {
            vague.lock().unwrap().push(format!("{from} -> {to}: exit code {}: {message}", outcome.code()));
        }
        tally.count("refused");
    });
    let vague = vague.into_inner().unwrap();
    assert!(vague.is_empty(), "{vague:#?}");
    println!(
        "mistakes of every kind: {} inputs, {} refused with line and column",
        CHANGES.len(),
        tally.of("refused")
    );
}

/// Broken pictures beside the scene.
fn textures(workshop: &Workshop) {
    if workshop.path("garbage.png").exists() {
        return;
    }
    let mut picture = rt_shade::Picture::new(8, 8);
    let png = picture.to_png().unwrap();
    workshop.write("garbage.png", "no picture at all");
    workshop.write("truncated.png", &png[..png.len() / 2]);
    workshop.write("empty.png", "");
    workshop.write("bomb.png", bomb(&png));
    picture.pixels_mut()[3][1] = f32::NAN;
    workshop.write("nan.pfm", picture.to_pfm());
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("/etc/passwd", workshop.path("link.png")).unwrap();
        let made = std::process::Command::new("mkfifo").arg(workshop.path("pipe.png")).status();
        if !made.is_ok_and(|status| status.success()) {
            workshop.write("pipe.png", "no pipes here");
        }
    }
}

/// A small file that claims to hold 30000 x 30000 pixels.
fn bomb(png: &[u8]) -> Vec<u8> {
    let mut bomb = png.to_vec();
    bomb[16..20].copy_from_slice(&30000u32.to_be_bytes());
    bomb[20..24].copy_from_slice(&30000u32.to_be_bytes());
    let crc = bomb[12..29].iter().fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg()))
    });
    bomb[29..33].copy_from_slice(&(!crc).to_be_bytes());
    bomb
}

#[test]
fn a_picture_that_claims_too_much_is_refused_at_once() {
    let workshop = Workshop::new();
    textures(&workshop);
    let text = EVERYTHING.replacen(
        CHANGES.iter().find(|c| c.1.contains("bomb")).unwrap().0,
        "image = { path = \"bomb.png\" }",
        1,
    );
    workshop.write("bad.toml", text);
    let fastest = (0..5).map(|_| render(&workshop, "bad.toml", &[]).took).min().unwrap();
    println!("a PNG of 30000 x 30000 pixels is refused in {} ms", fastest.as_millis());
    assert!(fastest.as_millis() < 100);
}

/// Whole files.
#[test]
fn files_that_are_no_scenes() {
    let deep_list = format!("a = {}1{}", "[".repeat(100_000), "]".repeat(100_000));
    let deep_table = format!("a = {}1{}", "{b = ".repeat(100_000), "}".repeat(100_000));
    let deep_key = format!("a{} = 1", ".b".repeat(100_000));
    let long_line = format!("a = \"{}", "x".repeat(1 << 20));
    let files: Vec<(&str, Vec<u8>)> = vec![
        ("empty.toml", vec![]),
        ("space.toml", b" \n\t\n".to_vec()),
        ("binary.toml", (0..=255).collect()),
        ("zeros.toml", vec![0; 4096]),
        ("latin1.toml", b"[camera]\n# caf\xe9\n".to_vec()),
        ("utf16.toml", "[camera]".encode_utf16().flat_map(u16::to_le_bytes).collect()),
        ("deep_list.toml", deep_list.into_bytes()),
        ("deep_table.toml", deep_table.into_bytes()),
        ("deep_key.toml", deep_key.into_bytes()),
        ("long_line.toml", long_line.into_bytes()),
        ("json.toml", b"{\"camera\": {}}".to_vec()),
        ("png.toml", rt_shade::Picture::new(3, 3).to_png().unwrap()),
        ("empty.nff", vec![]),
        ("words.nff", b"v\nfrom here\n".to_vec()),
        ("letters.nff", b"q 1 2 3\n".to_vec()),
        ("nan.nff", b"v\nfrom nan 0 0\nat 0 0 1\nup 0 1 0\nangle 40\nhither 0\nresolution 8 8\n".to_vec()),
        ("cut.nff", b"v\nfrom 0 0 0\nat 0 0 1\nup 0 1 0\nangle 40\nhither 0\nresolution 8 8\ns 0 0".to_vec()),
        ("count.nff", b"v\nfrom 0 0 0\nat 0 0 1\nup 0 1 0\nangle 40\nhither 0\nresolution 8 8\nf 1 1 1 1 0 0 0 1\np 999999999 0 0 0\n".to_vec()),
        ("binary.nff", (0..=255).collect()),
    ];
    let workshop = Workshop::new();
    for (name, bytes) in &files {
        workshop.write(name, bytes);
        let outcome = render(&workshop, name, &[]);
        assert_eq!(outcome.code(), 3, "{name}: {outcome:?}");
        assert!(place(&outcome, name).is_some(), "{name}: {outcome:?}");
        assert!(outcome.stderr.len() < 10_000, "{name}: {} bytes of errors", outcome.stderr.len());
    }
    println!("files that are no scenes: {} inputs, {0} refused with line and column", files.len());
}

#[test]
fn files_that_cannot_be_read() {
    let workshop = Workshop::new();
    for scene in ["missing.toml", ".", "missing/scene.toml", "scene.toml/scene.toml"] {
        let outcome = render(&workshop, scene, &[]);
        assert_eq!(outcome.code(), 1, "{scene}: {outcome:?}");
        assert!(outcome.stderr.starts_with("error: cannot read "), "{outcome:?}");
        assert_eq!(workshop.rt(&["check", scene]).code(), 1);
    }
}

#[test]
fn a_picture_too_large_for_the_memory() {
    let workshop = Workshop::new();
    let outcome = render(&workshop, "scene.toml", &["--width", "65536", "--height", "65536"]);
    assert_eq!(outcome.code(), 1);
    assert!(outcome.stderr.starts_with("error: 65536 x 65536 pixels take 96.0 GiB"), "{outcome:?}");
    let outcome =
        render(&workshop, "scene.toml", &["--width", "65536", "--height", "65536", "--region", "9,9,2,2"]);
    assert_eq!(outcome.code(), 0);
}

#[test]
fn all_errors_come_in_one_run() {
    let workshop = Workshop::new();
    let text = EVERYTHING.replace("radius = 1 }", "radius = -1 }").replace("fov = 40", "fov = 0");
    let text = text.replace("ior = 1.5", "iro = 1.5").replace("width = 24", "width = 0");
    workshop.write("bad.toml", text);
    let outcome = workshop.rt(&["check", "bad.toml"]);
    assert_eq!(outcome.code(), 3);
    assert_eq!(outcome.stderr.matches(": error: ").count(), 4, "{}", outcome.stderr);
    assert_eq!(outcome.stderr.matches(" | ").count(), 8, "{}", outcome.stderr);
}

#[test]
fn bad_options_are_refused_before_anything_is_read() {
    let options: &[&[&str]] = &[
        &["--width", "0"],
        &["--width", "-5"],
        &["--width", "2147483648"],
        &["--width", "99999999999999999999"],
        &["--width", "nan"],
        &["--height", "0"],
        &["--height", "2147483648"],
        &["--threads", "-1"],
        &["--threads", "1000000"],
        &["--max-depth", "0"],
        &["--max-depth", "1000000"],
        &["--aa", "grid:0"],
        &["--aa", "grid"],
        &["--aa", "grid:99999"],
        &["--aa", "best"],
        &["--aa", "adaptive:2:3"],
        &["--aa", "adaptive:0.1:99"],
        &["--aa", "adaptive:nan:3"],
        &["--corners", "--aa", "grid:2"],
        &["--region", "0,0,0,5"],
        &["--region", "20,0,10,5"],
        &["--region", "1,2,3"],
        &["--region", "-1,0,5,5"],
        &["--region", "4294967295,0,4294967295,1"],
        &["--tile", "0/4"],
        &["--tile", "5/4"],
        &["--tile", "1/1000"],
        &["--tile", "4"],
        &["--tile", "1/0"],
        &["--progress", "loud"],
        &["--frobnicate"],
        &["--stats", "out.png"],
    ];
    let workshop = Workshop::new();
    for option in options {
        let outcome = render(&workshop, "scene.toml", option);
        assert_eq!(outcome.code(), 2, "{option:?}: {outcome:?}");
        assert!(outcome.stderr.starts_with("error: "), "{option:?}: {outcome:?}");
    }
    for arguments in [
        &["render", "scene.toml"][..],
        &["render", "scene.toml", "-o", "a.jpg"],
        &["render", "scene.toml", "-o", "scene.toml"],
        &["frobnicate"],
        &[],
        &["roots", "--solver", "magic"],
        &["stitch", "-o", "a.png"],
    ] {
        assert_eq!(workshop.rt(arguments).code(), 2, "{arguments:?}");
    }
    assert_eq!(workshop.read("scene.toml"), EVERYTHING.as_bytes());
    println!("options that make no sense: {} inputs, all refused", options.len() + 7);
}

/// An option that other programs have is answered by the name of ours.
#[test]
fn options_of_other_programs() {
    let workshop = Workshop::new();
    for (option, ours) in [
        (&["--size", "4x4"][..], "'--width' and '--height'"),
        (&["--resolution=4x4"], "'--width' and '--height'"),
        (&["--samples", "4"], "'--aa grid:N'"),
        (&["--out", "a.png"], "'--output'"),
        (&["-j", "2"], "'--threads'"),
        // A slip of the fingers is answered as ever.
        (&["--widht", "4"], "'--width'"),
        (&["--frobnicate"], "'--frobnicate'"),
    ] {
        let outcome = render(&workshop, "scene.toml", option);
        assert_eq!(outcome.code(), 2, "{option:?}: {outcome:?}");
        let tip = outcome.stderr.lines().find(|line| line.contains("tip: "));
        assert!(tip.is_some_and(|tip| tip.contains(ours)), "{option:?}: {outcome:?}");
    }
}

/// Every prefix of the scene either is one or is refused with its place. In this process: a command for each would
/// take minutes.
#[test]
fn truncated_anywhere() {
    use rt_shade::text::{NoPictures, load};
    let mut texts = vec![("scene.toml".to_string(), EVERYTHING.as_bytes().to_vec())];
    let folders = [support::repository().join("scenes")]
        .into_iter()
        .chain(support::shared().map(|s| s.join("scenes/nff")));
    for folder in folders.filter(|f| f.is_dir()) {
        let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        paths.sort();
        for path in paths {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let bytes = if path.is_file() { std::fs::read(&path).unwrap() } else { continue };
            // Parsing every prefix takes time quadratic in the length.
            if (name.ends_with(".toml") || name.ends_with(".nff")) && bytes.len() < 12_000 {
                texts.push((name, bytes));
            }
        }
    }
    let (mut tried, mut whole) = (0, 0);
    for (name, bytes) in texts.iter().take(12) {
        for end in 0..bytes.len() {
            tried += 1;
            match load(name, &bytes[..end], &NoPictures) {
                Ok(_) => whole += 1,
                Err(errors) => assert!(errors.iter().all(|e| e.line > 0 && e.column > 0), "{name} at {end}"),
            }
        }
    }
    println!(
        "truncated: {tried} prefixes of {} scenes, {whole} are scenes, the others refused with line and column",
        texts.len().min(12)
    );
}

#[test]
fn bad_lines_end_cast_and_roots_after_the_answers_before() {
    let good_ray = r#"{"id": 1, "shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "origin": [0, 0, -5], "direction": [0, 0, 1]}"#;
    let bad_rays = [
        "{",
        "nonsense",
        "[]",
        "1",
        "null",
        "{}",
        "\u{0}",
        "{\"id\": 1}",
        r#"{"id": 1, "origin": [0, 0, 0], "direction": [0, 0, 1]}"#,
        r#"{"shape": {"sphere": {"center": [0, 0, 0], "radius": 0}}, "origin": [0, 0, 0], "direction": [0, 0, 1]}"#,
        r#"{"shape": {"sphere": {"center": [0, 0, 0]}}, "origin": [0, 0, 0], "direction": [0, 0, 1]}"#,
        r#"{"shape": {"sphere": {"center": [0, 0, 0], "radius": 1, "color": 2}}, "origin": [0, 0, 0], "direction": [0, 0, 1]}"#,
        r#"{"shape": {"blob": {"center": [0, 0, 0], "radius": 1}}, "origin": [0, 0, 0], "direction": [0, 0, 1]}"#,
        r#"{"shape": {}, "origin": [0, 0, 0], "direction": [0, 0, 1]}"#,
        r#"{"shape": 5, "origin": [0, 0, 0], "direction": [0, 0, 1]}"#,
        r#"{"shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "origin": [0, 0], "direction": [0, 0, 1]}"#,
        r#"{"shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "origin": [0, 0, NaN], "direction": [0, 0, 1]}"#,
        r#"{"shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "origin": [0, 0, 1e400], "direction": [0, 0, 1]}"#,
        r#"{"shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "origin": [0, 0, 0], "direction": "up"}"#,
        r#"{"shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "origin": [0, 0, 0], "direction": [0, 0, 1], "t_max": null}"#,
    ];
    let bad_roots = [
        "{",
        "5",
        "{}",
        r#"{"c": 5}"#,
        r#"{"c": [1, 2, 3, 4, 5, 6]}"#,
        r#"{"c": [1, 2, 3, 4, "5"]}"#,
        r#"{"c": [1, 2, 3, 4, 1e999]}"#,
        r#"{"c": [1, 2, 3, 4, inf]}"#,
        r#"{"c": [1, 2, 3, 4, 5]} x"#,
    ];
    let workshop = Workshop::new();
    for (command, good, bad) in
        [("cast", good_ray, &bad_rays[..]), ("roots", r#"{"c": [1, -2, 1, 0, 0]}"#, &bad_roots)]
    {
        for line in bad {
            let outcome =
                workshop.rt_with(&[command], format!("{good}\n{good}\n{line}\n{good}\n").as_bytes());
            assert_eq!(outcome.code(), 3, "{line}: {outcome:?}");
            assert_eq!(outcome.text().lines().count(), 2, "{line}: {outcome:?}");
            assert_eq!(place(&outcome, "<stdin>").map(|p| p.0), Some(3), "{line}: {outcome:?}");
        }
    }
    println!(
        "bad lines: {} inputs, all refused with their number after the answers before",
        bad_rays.len() + bad_roots.len()
    );
}
