//! What the README shows is what happens.
#![cfg(unix)]

mod support;

use std::process::Command;
use support::{Workshop, repository};

/// The fenced blocks of the README with this word behind the fence.
fn blocks(word: &str) -> Vec<String> {
    let readme = std::fs::read_to_string(repository().join("README.md")).unwrap();
    let mut found = Vec::new();
    let mut pieces = readme.split("```");
    while let (Some(_), Some(block)) = (pieces.next(), pieces.next()) {
        if let Some(text) = block.strip_prefix(word).and_then(|rest| rest.strip_prefix('\n')) {
            found.push(text.to_string());
        }
    }
    found
}

/// A folder with the family, small enough for a test.
fn family() -> Workshop {
    let workshop = Workshop::new();
    std::fs::create_dir(workshop.path("scenes")).unwrap();
    let scene = std::fs::read_to_string(repository().join("scenes/family.toml")).unwrap();
    let small = scene.replace("width = 1000", "width = 24").replace("height = 1000", "height = 24");
    assert_ne!(small, scene);
    workshop.write("scenes/family.toml", small);
    std::fs::copy(repository().join("scenes/wood.png"), workshop.path("scenes/wood.png")).unwrap();
    workshop.write("rays.jsonl", "{\"origin\": [0, 1, 9], \"direction\": [0, 0, -1]}\n");
    workshop
}

#[test]
fn every_line_of_the_command_works() {
    let workshop = family();
    let shell = |line: &str| {
        let folder = std::path::Path::new(env!("CARGO_BIN_EXE_rt")).parent().unwrap();
        let path = format!("{}:{}", folder.display(), std::env::var("PATH").unwrap());
        let mut bash = Command::new("bash");
        bash.current_dir(workshop.folder()).env("PATH", path).args(["-c", line]);
        let outcome = support::run(&mut bash, b"");
        assert_eq!(outcome.code(), 0, "{line}: {outcome:?}");
        outcome.text()
    };
    shell("for k in 1 2 4 5 6 7 8; do rt render scenes/family.toml -q -o part-$k.png --tile $k/8; done");
    let mut count = 0;
    let block = blocks("console").into_iter().find(|b| b.contains("$ rt check")).unwrap();
    let mut lines = block.lines().peekable();
    while let Some(line) = lines.next() {
        let command = line.strip_prefix("$ ").unwrap();
        let printed = shell(command);
        // What the block shows below a command is what it prints.
        let mut shown = String::new();
        while let Some(output) = lines.next_if(|line| !line.starts_with("$ ")) {
            shown += output;
            shown.push('\n');
        }
        assert!(shown.is_empty() || shown == printed, "{command}: {printed}");
        count += 1;
    }
    assert!(count >= 7);
    assert!(workshop.read("part-3.png").starts_with(b"\x89PNG"));
}

#[test]
fn the_scene_is_one() {
    let workshop = Workshop::new();
    let scene = blocks("toml").into_iter().find(|b| b.starts_with("version")).unwrap();
    workshop.write("readme.toml", scene);
    let outcome = workshop.rt(&["check", "readme.toml"]);
    assert_eq!(
        (outcome.code(), outcome.stderr.as_str()),
        (0, "readme.toml: no errors, 2 objects, 1 light\n")
    );
    assert_eq!(
        workshop
            .rt(&["render", "readme.toml", "-o", "a.png", "-q", "--width", "40", "--height", "30"])
            .code(),
        0
    );
}

#[test]
fn every_scene_of_the_repository_is_good() {
    let mut count = 0;
    for entry in std::fs::read_dir(repository().join("scenes")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml" || e == "nff") {
            let outcome = support::run(support::rt().arg("check").arg(&path), b"");
            assert_eq!(outcome.code(), 0, "{outcome:?}");
            count += 1;
        }
    }
    assert!(count > 0);
}
