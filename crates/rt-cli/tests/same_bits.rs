//! The picture has the same bits for any number of threads, in regions or in parts.

mod support;

use support::Workshop;

fn render(workshop: &Workshop, out: &str, options: &[&str]) -> Vec<u8> {
    let outcome = workshop.rt(&[
        &["render", "scene.toml", "-q", "-o", out, "--width", "61", "--height", "47"],
        options,
    ]
    .concat());
    assert_eq!((outcome.code(), outcome.stderr.as_str()), (0, ""), "{options:?}");
    workshop.read(out)
}

#[test]
fn any_number_of_threads() {
    let workshop = Workshop::new();
    for (aa, out) in [("grid:2", "a.png"), ("grid:2", "a.pfm"), ("adaptive", "a.pfm"), ("none", "a.png")] {
        let one = render(&workshop, out, &["--aa", aa, "--threads", "1"]);
        for threads in ["0", "2", "7", "64"] {
            assert!(
                render(&workshop, out, &["--aa", aa, "--threads", threads]) == one,
                "{aa} {out} {threads}"
            );
        }
    }
}

#[test]
fn parts_make_the_whole() {
    let workshop = Workshop::new();
    for (kind, options) in [
        ("png", &["--aa", "grid:2"][..]),
        ("pfm", &["--aa", "adaptive"]),
        ("pfm", &["--corners"]),
        ("png", &["--aa", "none", "--region", "7,5,40,30"]),
        ("pfm", &["--no-shadows", "--max-depth", "2"]),
    ] {
        let whole = render(&workshop, &format!("whole.{kind}"), options);
        for parts in [1, 2, 7, 30] {
            let mut names = Vec::new();
            // Last part first: the order does not matter.
            for k in (1..=parts).rev() {
                let (name, tile) = (format!("part-{k}.{kind}"), format!("{k}/{parts}"));
                render(&workshop, &name, &[options, &["--tile", &tile]].concat());
                names.push(name);
            }
            let out = format!("stitched.{kind}");
            let mut arguments = vec!["stitch", "-o", &out];
            arguments.extend(names.iter().map(String::as_str));
            let outcome = workshop.rt(&arguments);
            assert_eq!((outcome.code(), outcome.stderr.as_str()), (0, ""));
            assert!(workshop.read(&out) == whole, "{kind} {options:?} {parts}");
        }
    }
}

#[test]
fn a_region_is_cut_from_the_whole() {
    let workshop = Workshop::new();
    for aa in ["grid:2", "adaptive"] {
        let decode = |bytes: Vec<u8>| rt_shade::Picture::decode(&bytes).unwrap();
        let whole = decode(render(&workshop, "whole.pfm", &["--aa", aa]));
        let part = decode(render(&workshop, "part.pfm", &["--aa", aa, "--region", "10,20,30,15"]));
        assert_eq!((part.width(), part.height()), (30, 15));
        for y in 0..15 {
            let from = (20 + y) * 61 + 10;
            assert!(part.pixels()[y * 30..][..30] == whole.pixels()[from..][..30], "{aa}: row {y}");
        }
    }
}

#[test]
fn parts_that_do_not_fit_are_named() {
    let workshop = Workshop::new();
    for k in ["1", "2", "3"] {
        render(&workshop, &format!("part-{k}.png"), &["--tile", &format!("{k}/3")]);
    }
    render(&workshop, "whole.png", &[]);
    render(&workshop, "other.png", &["--tile", "2/3", "--max-depth", "2"]);
    render(&workshop, "pfm.pfm", &["--tile", "2/3"]);
    let mut damaged = workshop.read("part-2.png");
    damaged.truncate(damaged.len() - 40);
    workshop.write("damaged.png", damaged);
    for (parts, code, words) in [
        (&["part-1.png", "part-3.png"][..], 3, "parts are missing: 2/3"),
        (&["part-1.png"], 3, "parts are missing: 2/3, 3/3"),
        (&["part-1.png", "part-2.png", "part-2.png", "part-3.png"], 3, "part 2/3 is there twice"),
        (
            &["part-1.png", "other.png", "part-3.png"],
            3,
            "other.png: error: part of another picture than part-1.png",
        ),
        (&["part-1.png", "whole.png", "part-3.png"], 3, "whole.png: error: not a part of a picture"),
        (&["part-1.png", "damaged.png", "part-3.png"], 3, "damaged.png: error: "),
        (&["part-1.png", "pfm.pfm", "part-3.png"], 2, "PNG to PNG"),
        (&["part-1.png", "missing.png", "part-3.png"], 1, "cannot read missing.png"),
    ] {
        workshop.write("out.png", "old");
        let outcome = workshop.rt(&[&["stitch", "-o", "out.png"], parts].concat());
        assert_eq!(outcome.code(), code, "{parts:?}: {outcome:?}");
        assert!(outcome.stderr.contains(words), "{parts:?}: {outcome:?}");
        assert_eq!(workshop.read("out.png"), b"old");
    }
}

#[test]
fn gnu_parallel_spreads_the_parts() {
    let there = std::process::Command::new("parallel").arg("--version").output();
    if !there.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains("GNU parallel")) {
        println!("skipped: GNU parallel is not installed");
        return;
    }
    let workshop = Workshop::new();
    let whole = render(&workshop, "whole.png", &[]);
    // The recipe of docs/farm.md, with this build of the command.
    let rt = env!("CARGO_BIN_EXE_rt");
    let script = format!(
        "parallel --will-cite --halt now,fail=1 '{rt}' render scene.toml --width 61 --height 47 -q -o part-{{}}.png --tile {{}}/8 ::: $(seq 8) && '{rt}' stitch part-*.png -o stitched.png"
    );
    let mut command = std::process::Command::new("bash");
    let outcome = support::run(
        command.current_dir(workshop.folder()).env("HOME", workshop.folder()).args(["-c", &script]),
        b"",
    );
    assert_eq!(outcome.code(), 0, "{outcome:?}");
    assert!(workshop.read("stitched.png") == whole);
}
