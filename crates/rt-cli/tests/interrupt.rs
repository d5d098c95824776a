//! Ctrl-C, SIGTERM and kill -9 at any moment.
#![cfg(unix)]

mod support;

use rt_shade::Picture;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use support::{Workshop, rt, wait};

fn send(signal: &str, child: &Child) {
    // The child may be gone already.
    let _ = Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status();
}

/// Starts a rendering that takes some seconds, or much longer.
fn start(workshop: &Workshop, options: &[&str]) -> Child {
    let mut command = rt();
    command.current_dir(workshop.folder()).args(["render", "scene.toml", "--threads", "2"]).args(options);
    command.stdin(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

const LONG: &[&str] = &["-o", "out.png", "--width", "3000", "--height", "3000", "--aa", "grid:4", "-q"];

/// Counts of pixels that were drawn (the scene's background is bright: nothing in it is black) and that were not.
fn drawn_and_not(picture: &Picture) -> (usize, usize) {
    let not = picture.pixels().iter().filter(|pixel| **pixel == [0.0; 3]).count();
    (picture.pixels().len() - not, not)
}

#[test]
fn the_first_signal_writes_what_there_is() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        let workshop = Workshop::new();
        let mut child = start(&workshop, LONG);
        std::thread::sleep(Duration::from_millis(700));
        let sent = Instant::now();
        send(signal, &child);
        assert_eq!(wait(&mut child).code(), Some(code));
        // Tiles in flight are finished and the picture is encoded, which takes a moment at this size.
        assert!(sent.elapsed() < Duration::from_secs(20), "{:?}", sent.elapsed());
        let picture = Picture::decode(&workshop.read("out.png")).unwrap();
        let (drawn, not) = drawn_and_not(&picture);
        assert!(drawn > 100 && not > 100, "{drawn} drawn, {not} not");
        assert_eq!(workshop.names(), ["out.png", "scene.toml"]);
    }
}

#[test]
fn an_interrupted_part_is_not_taken_for_a_whole_one() {
    let workshop = Workshop::new();
    let mut child = start(&workshop, &[LONG, &["--tile", "1/2"]].concat());
    std::thread::sleep(Duration::from_millis(700));
    send("-INT", &child);
    assert_eq!(wait(&mut child).code(), Some(130));
    let outcome = workshop.rt(&["stitch", "out.png", "-o", "whole.png"]);
    assert_eq!(outcome.code(), 3);
    assert!(outcome.stderr.contains("was interrupted: render it again"), "{outcome:?}");
}

#[test]
fn the_second_signal_quits_at_once() {
    let workshop = Workshop::new();
    workshop.write("out.png", "old");
    // One tile in flight takes seconds: four million rays from the eye.
    let mut child =
        start(&workshop, &["-o", "out.png", "-q", "--width", "3000", "--height", "3000", "--aa", "grid:64"]);
    std::thread::sleep(Duration::from_millis(500));
    send("-INT", &child);
    std::thread::sleep(Duration::from_millis(100));
    let sent = Instant::now();
    send("-INT", &child);
    assert_eq!(wait(&mut child).code(), Some(130));
    assert!(sent.elapsed() < Duration::from_millis(1500), "{:?}", sent.elapsed());
    assert_eq!(workshop.names(), ["out.png", "scene.toml"]);
}

/// The process is killed at fifty moments spread over its life: the file is the old or the new one, whole.
#[test]
fn killed_at_any_moment() {
    let workshop = Workshop::new();
    let options = &["-o", "out.pfm", "--width", "120", "--height", "120", "--aa", "none", "-q"];
    let begun = Instant::now();
    assert!(wait(&mut start(&workshop, options)).success());
    let whole_life = begun.elapsed();
    let new = workshop.read("out.pfm");
    let (mut olds, mut news) = (0, 0);
    for moment in 0..50u32 {
        workshop.write("out.pfm", "old");
        let mut child = start(&workshop, options);
        std::thread::sleep(whole_life * moment / 45);
        child.kill().unwrap();
        child.wait().unwrap();
        match workshop.read("out.pfm") {
            found if found == b"old" => olds += 1,
            found if found == new => news += 1,
            torn => panic!("torn: {} bytes", torn.len()),
        }
    }
    println!("killed at 50 moments: {olds} times the old file, {news} times the new one, never a torn one");
    assert!(olds > 0);
}
