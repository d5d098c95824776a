//! Whatever prevents writing: exit code 1, a word why, the old picture whole, nothing left behind.
#![cfg(unix)]

mod support;

use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};
use support::{Outcome, Workshop, rt};

const OLD: &[u8] = b"the old picture";

fn failed(outcome: &Outcome, word: &str) {
    assert_eq!(outcome.code(), 1, "{outcome:?}");
    assert!(outcome.stderr.starts_with("error: cannot write "), "{outcome:?}");
    assert!(outcome.stderr.contains(word), "{word}: {outcome:?}");
}

/// A picture with so many rays takes minutes: the answer must come before the rendering.
const LARGE: &[&str] = &["--width", "4000", "--height", "4000", "--aa", "grid:16", "--quiet"];

fn render_large(workshop: &Workshop, out: &str) -> Outcome {
    let outcome = workshop.rt(&[&["render", "scene.toml", "-o", out], LARGE].concat());
    assert!(outcome.took.as_secs() < 10, "rendered first: {outcome:?}");
    outcome
}

#[test]
fn a_missing_folder() {
    let workshop = Workshop::new();
    failed(&render_large(&workshop, "missing/out.png"), "No such file or directory");
}

#[test]
fn a_file_as_folder() {
    let workshop = Workshop::new();
    failed(&render_large(&workshop, "scene.toml/out.png"), "Not a directory");
}

#[test]
fn a_folder_as_file() {
    let workshop = Workshop::new();
    std::fs::create_dir(workshop.path("out.png")).unwrap();
    failed(&render_large(&workshop, "out.png"), "directory");
}

#[test]
fn a_read_only_file() {
    let workshop = Workshop::new();
    workshop.write("out.png", OLD);
    std::fs::set_permissions(workshop.path("out.png"), std::fs::Permissions::from_mode(0o444)).unwrap();
    failed(&render_large(&workshop, "out.png"), "denied");
    assert_eq!(workshop.read("out.png"), OLD);
}

#[test]
fn a_read_only_folder() {
    let workshop = Workshop::new();
    let folder = workshop.path("closed");
    std::fs::create_dir(&folder).unwrap();
    std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o555)).unwrap();
    // Whoever runs the tests may be allowed everything.
    if std::fs::write(folder.join("probe"), "").is_ok() {
        println!("skipped: folders cannot be closed to this user");
        return;
    }
    failed(&render_large(&workshop, "closed/out.png"), "denied");
}

#[test]
fn a_file_system_without_write_access() {
    let workshop = Workshop::new();
    failed(&render_large(&workshop, "/proc/out.png"), "");
    failed(&render_large(&workshop, "/sys/out.png"), "");
}

#[test]
fn a_name_too_long() {
    let workshop = Workshop::new();
    failed(&render_large(&workshop, &format!("{}.png", "x".repeat(300))), "too long");
}

#[test]
fn links_in_a_circle() {
    let workshop = Workshop::new();
    std::os::unix::fs::symlink("b.png", workshop.path("a.png")).unwrap();
    std::os::unix::fs::symlink("a.png", workshop.path("b.png")).unwrap();
    failed(&render_large(&workshop, "a.png"), "symbolic links");
}

#[test]
fn a_full_device() {
    let workshop = Workshop::new();
    failed(&workshop.rt(&["render", "scene.toml", "-o", "/dev/full", "-q"]), "No space left on device");
}

#[test]
fn standard_output_on_a_full_device() {
    let workshop = Workshop::new();
    let full = || Stdio::from(std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap());
    let ray = r#"{"shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "origin": [0, 0, -5], "direction": [0, 0, 1]}"#;
    workshop.write("rays.jsonl", format!("{ray}\n").repeat(1000));
    for arguments in [&["render", "scene.toml", "-o", "-", "-q"][..], &["cast"], &["completions", "bash"]] {
        let stdin = std::fs::File::open(workshop.path("rays.jsonl")).unwrap();
        let mut command = rt();
        command
            .current_dir(workshop.folder())
            .args(arguments)
            .stdin(stdin)
            .stdout(full())
            .stderr(Stdio::piped());
        let output = command.spawn().unwrap().wait_with_output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
        assert!(message.contains("No space left on device"), "{arguments:?}: {message}");
    }
}

#[test]
fn a_full_file_system() {
    let workshop = Workshop::new();
    let mount = workshop.path("small");
    std::fs::create_dir(&mount).unwrap();
    let mounted = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=64k", "none"])
        .arg(&mount)
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success());
    if !mounted {
        println!("skipped: no leave to mount a small file system");
        return;
    }
    workshop.write("small/out.pfm", OLD);
    let outcome = workshop.rt(&[
        "render",
        "scene.toml",
        "-o",
        "small/out.pfm",
        "--width",
        "200",
        "--height",
        "200",
        "-q",
    ]);
    let kept = std::fs::read(mount.join("out.pfm"));
    let names = std::fs::read_dir(&mount).map(|entries| entries.count());
    let unmounted = Command::new("umount").arg(&mount).status().is_ok_and(|status| status.success());
    failed(&outcome, "No space left on device");
    assert_eq!(kept.unwrap(), OLD);
    assert_eq!(names.unwrap(), 1, "the temporary file is left behind");
    assert!(unmounted);
}

/// The same fault without leave to mount: a limit on the size of files.
#[test]
fn a_limit_on_file_sizes() {
    let workshop = Workshop::new();
    workshop.write("out.pfm", OLD);
    let script = format!(
        "trap '' XFSZ; ulimit -f 64; exec '{}' render scene.toml -o out.pfm --width 200 --height 200 -q",
        env!("CARGO_BIN_EXE_rt")
    );
    let outcome =
        support::run(Command::new("bash").current_dir(workshop.folder()).args(["-c", &script]), b"");
    failed(&outcome, "File too large");
    assert_eq!(workshop.read("out.pfm"), OLD);
    assert_eq!(workshop.names(), ["out.pfm", "scene.toml"]);
}

#[test]
fn a_reader_that_leaves() {
    let workshop = Workshop::new();
    let ray = r#"{"shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "origin": [0, 0, -5], "direction": [0, 0, 1]}"#;
    workshop.write("rays.jsonl", format!("{ray}\n").repeat(20_000));
    for tail in [
        "cast < rays.jsonl",
        "render scene.toml -o - -q --width 400 --height 400",
        "completions bash",
        "--help",
    ] {
        let script = format!("'{}' {tail} | true; exit ${{PIPESTATUS[0]}}", env!("CARGO_BIN_EXE_rt"));
        let outcome =
            support::run(Command::new("bash").current_dir(workshop.folder()).args(["-c", &script]), b"");
        assert!(outcome.stderr.is_empty(), "{tail}: {outcome:?}");
        assert!(outcome.code() <= 1, "{tail}: {outcome:?}");
    }
}

#[test]
fn no_standard_streams_at_all() {
    let workshop = Workshop::new();
    let script = format!("'{}' render scene.toml -o out.png <&- >&- 2>&-", env!("CARGO_BIN_EXE_rt"));
    let outcome =
        support::run(Command::new("bash").current_dir(workshop.folder()).args(["-c", &script]), b"");
    assert_eq!(outcome.code(), 0);
    assert!(rt_shade::Picture::decode(&workshop.read("out.png")).is_ok());
}

#[test]
fn two_runs_into_one_file() {
    let workshop = Workshop::new();
    let render = |width: &str| {
        let mut command = rt();
        command.current_dir(workshop.folder());
        command.args(["render", "scene.toml", "-o", "out.png", "-q", "--width", width]);
        command.spawn().unwrap()
    };
    for _ in 0..5 {
        let mut runs = [render("40"), render("80"), render("120")];
        for run in &mut runs {
            assert!(support::wait(run).success());
        }
        let picture = rt_shade::Picture::decode(&workshop.read("out.png")).unwrap();
        assert!([40, 80, 120].contains(&picture.width()));
        assert_eq!(workshop.names(), ["out.png", "scene.toml"]);
    }
}

#[test]
fn stats_that_cannot_be_written_stop_the_rendering() {
    let workshop = Workshop::new();
    workshop.write("out.png", OLD);
    let outcome =
        workshop
            .rt(&[&["render", "scene.toml", "-o", "out.png", "--stats", "missing/s.json"], LARGE].concat());
    failed(&outcome, "missing/s.json");
    assert!(outcome.took.as_secs() < 10);
    assert_eq!(workshop.read("out.png"), OLD);
}

#[test]
fn a_redirected_stream_keeps_what_else_is_written_to_it() {
    let workshop = Workshop::new();
    let script = format!(
        "{{ echo before; '{}' render scene.toml -o a.png -q --stats /dev/stdout; echo after; }} > log",
        env!("CARGO_BIN_EXE_rt")
    );
    let outcome =
        support::run(Command::new("bash").current_dir(workshop.folder()).args(["-c", &script]), b"");
    assert_eq!(outcome.code(), 0, "{outcome:?}");
    let log = String::from_utf8(workshop.read("log")).unwrap();
    assert!(log.starts_with("before\n{") && log.ends_with("}\nafter\n"), "{log}");
}
