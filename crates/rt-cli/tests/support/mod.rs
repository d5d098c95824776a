//! What the tests of the command share.
#![allow(dead_code)]

use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// No command of these tests may take longer; a hang is a failure.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// A scene with every kind of table and number in it, drawn in a moment.
pub const EVERYTHING: &str = r#"version = 1

[image]
width = 24
height = 18
background = [0.5, 0.25, 0.75]

[camera]
eye = [0, 3, 12]
look_at = [0, 1.5, 0]
up = [0, 1, 0]
fov = 40

[render]
max_depth = 4
ambient = [0.25, 0.25, 0.25]
antialias = "grid:2"

[[light]]
point = { position = [5, 9, 7], color = [1, 0.9, 0.8], attenuation = [1, 0.01, 0.002] }

[[light]]
spot = { position = [-5, 9, 7], target = [0, 1, 0], inner = 12, outer = 18, color = [1, 1, 1], attenuation = [1, 0.01, 0.001] }

[material.glass]
color = [0.9, 0.8, 0.7]
diffuse = 0.2
specular = 0.5
shininess = 40
reflect = 0.1
transmit = [0.9, 0.8, 0.7]
ior = 1.5

[material.tiles]
texture = "floor"

[texture.floor]
checker = { colors = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]], size = 1.5 }

[[object]]
name = "floor"
material = "tiles"
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }

[[object]]
name = "ball"
material = "glass"
scale = 1.25
rotate = { axis = [0, 1, 0], degrees = 35 }
translate = [0.5, 0.25, 0]
shape.sphere = { center = [0, 1, 0], radius = 1 }

[[object]]
material = "tiles"
shape.cuboid = { min = [-4, 0.5, -1], max = [-3, 1.5, 1] }

[[object]]
material = "tiles"
shape.cylinder = { base = [3, 0.5, 0], top = [3, 2, 0.5], radius = 0.5 }

[[object]]
material = "tiles"
shape.open_cylinder = { base = [-2, 0.5, 2], top = [-2, 2, 2], radius = 0.3 }

[[object]]
material = "tiles"
shape.cone = { base = [2, 0.5, 3], base_radius = 0.5, top = [2, 2, 3], top_radius = 0.1 }

[[object]]
material = "tiles"
shape.open_cone = { base = [4, 0.5, 3], base_radius = 0.5, top = [4, 2, 3], top_radius = 0.1 }

[[object]]
material = "tiles"
no_shadow = true
shape.torus = { center = [0, 3, 0], axis = [0, 1, 0.5], major = 1.5, minor = 0.25 }

[[object]]
material = "tiles"
shape.disk = { center = [-3, 3, 0], normal = [0, 1, 1], radius = 0.75 }

[[object]]
material = "tiles"
shape.triangle = { a = [1, 4, 0], b = [2, 4, 0], c = [1, 5, 0.5] }
"#;

/// The command, built for tests.
pub fn rt() -> Command {
    Command::new(env!("CARGO_BIN_EXE_rt"))
}

/// What a command did.
#[derive(Debug)]
pub struct Outcome {
    pub status: ExitStatus,
    pub stdout: Vec<u8>,
    pub stderr: String,
    pub took: Duration,
}

impl Outcome {
    /// The exit code; a death by signal counts as a crash.
    pub fn code(&self) -> i32 {
        self.status.code().unwrap_or_else(|| panic!("died: {self:?}"))
    }

    /// The standard output as text.
    pub fn text(&self) -> String {
        String::from_utf8(self.stdout.clone()).unwrap()
    }
}

/// Waits for a child, and kills and reports it when it hangs.
pub fn wait(child: &mut Child) -> ExitStatus {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("hangs");
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Runs a command with this standard input to its end.
pub fn run(command: &mut Command, stdin: &[u8]) -> Outcome {
    let start = Instant::now();
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let (mut out, mut err) = (child.stdout.take().unwrap(), child.stderr.take().unwrap());
    std::thread::scope(|scope| {
        // A child that stops reading closes the pipe: not an error here.
        scope.spawn(move || input.write_all(stdin).is_ok());
        let stdout = scope.spawn(move || {
            let mut bytes = Vec::new();
            out.read_to_end(&mut bytes).map(|_| bytes)
        });
        let stderr = scope.spawn(move || {
            let mut bytes = Vec::new();
            err.read_to_end(&mut bytes).map(|_| bytes)
        });
        let status = wait(&mut child);
        Outcome {
            status,
            stdout: stdout.join().unwrap().unwrap(),
            stderr: String::from_utf8_lossy(&stderr.join().unwrap().unwrap()).into_owned(),
            took: start.elapsed(),
        }
    })
}

/// A folder of its own for a test, with `scene.toml` in it.
pub struct Workshop {
    folder: tempfile::TempDir,
}

impl Workshop {
    pub fn new() -> Workshop {
        let workshop = Workshop { folder: tempfile::tempdir().unwrap() };
        workshop.write("scene.toml", EVERYTHING);
        workshop
    }

    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    /// The names of all files, sorted.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(self.folder())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// Runs `rt` in the folder.
    pub fn rt(&self, arguments: &[&str]) -> Outcome {
        self.rt_with(arguments, b"")
    }

    /// Runs `rt` in the folder with this standard input.
    pub fn rt_with(&self, arguments: &[&str], stdin: &[u8]) -> Outcome {
        run(rt().current_dir(self.folder()).args(arguments), stdin)
    }
}

/// The data that is handed about beside the repository, where it is there.
pub fn shared() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no shared data");
    None
}

/// The root of the repository.
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
