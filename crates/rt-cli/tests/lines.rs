//! What the commands print, word for word.

mod support;

use snapbox::cmd::Command;
use snapbox::str;
use support::Workshop;

fn rt() -> Command {
    Command::new(env!("CARGO_BIN_EXE_rt"))
}

#[test]
fn cast_a_sphere() {
    let line = r#"{"id": 1, "shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "origin": [0, 0, -5], "direction": [0, 0, 1], "t_min": 0, "t_max": 1e308}"#;
    rt().arg("cast").stdin(line).assert().success().stderr_eq("").stdout_eq(str![[r#"
{"id":1,"hits":[{"t":4.0,"normal":[0.0,0.0,-1.0],"point":[0.0,0.0,-1.0]},{"t":6.0,"normal":[0.0,0.0,1.0],"point":[0.0,0.0,1.0]}]}

"#]]);
    rt().args(["cast", "--first"]).stdin(line).assert().success().stdout_eq(str![[r#"
{"id":1,"hits":[{"t":4.0,"normal":[0.0,0.0,-1.0],"point":[0.0,0.0,-1.0]}]}

"#]]);
}

#[test]
fn cast_strictly_between_the_limits() {
    let ray = |limits: &str| {
        format!(
            r#"{{"id": "a", "shape": {{"sphere": {{"center": [0, 0, 0], "radius": 1}}}}, "origin": [0, 0, -5], "direction": [0, 0, 1]{limits}}}"#
        )
    };
    let lines = [
        ray(r#", "t_min": 4, "t_max": 6"#),
        ray(r#", "t_min": 6, "t_max": 4"#),
        ray(r#", "t_max": 4.0000000000000009"#),
        ray(r#", "t_min": -0.0, "t_max": 1.7976931348623157e308"#),
    ];
    rt().arg("cast").stdin(lines.join("\n")).assert().success().stdout_eq(str![[r#"
{"id":"a","hits":[]}
{"id":"a","hits":[]}
{"id":"a","hits":[{"t":4.0,"normal":[0.0,0.0,-1.0],"point":[0.0,0.0,-1.0]}]}
{"id":"a","hits":[{"t":4.0,"normal":[0.0,0.0,-1.0],"point":[0.0,0.0,-1.0]},{"t":6.0,"normal":[0.0,0.0,1.0],"point":[0.0,0.0,1.0]}]}

"#]]);
}

#[test]
fn cast_says_what_is_wrong() {
    let good = r#"{"shape": {"torus": {"center": [0, 0, 0], "axis": [0, 0, 1], "major": 2, "minor": 0.5}}, "origin": [9, 9, 9], "direction": [0, 0, 1]}"#;
    let bad = good.replace("minor\": 0.5", "minor\": -0.5");
    rt().arg("cast")
        .stdin(format!("{good}\n{bad}\n{good}\n"))
        .assert()
        .code(3)
        .stdout_eq(str![[r#"
{"id":null,"hits":[]}

"#]])
        .stderr_eq(str![[r#"
<stdin>:2:83: error: [..]minor[..]-0.5[..]

"#]]);
    let bad = good.replace("torus", "tours");
    rt().arg("cast").stdin(bad).assert().code(3).stderr_eq(str![[r#"
<stdin>:1:11: error: unknown shape `tours`: did you mean `torus`?

"#]]);
}

#[test]
fn cast_at_a_scene_names_the_objects() {
    let workshop = Workshop::new();
    let down = r#"{"id": 1, "origin": [0.5, 9, 0], "direction": [0, -1, 0]}"#;
    let scene = workshop.path("scene.toml");
    let outcome = workshop.rt_with(&["cast", "--first", "--scene", scene.to_str().unwrap()], down.as_bytes());
    assert_eq!(
        outcome.text(),
        "{\"id\":1,\"hits\":[{\"t\":6.25,\"normal\":[0.0,1.0,0.0],\"point\":[0.5,2.75,0.0],\"object\":\"ball\"}]}\n"
    );
    let outcome = workshop.rt_with(&["cast", "--scene", "scene.toml"], down.as_bytes());
    let objects: Vec<_> =
        outcome.text().split("\"object\":").skip(1).map(|rest| rest[..7].to_string()).collect();
    assert_eq!(objects, ["\"ball\"}", "\"ball\"}", "\"floor\""]);
    let with_shape = r#"{"shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "origin": [0, 9, 0], "direction": [0, -1, 0]}"#;
    assert_eq!(workshop.rt_with(&["cast", "--scene", "scene.toml"], with_shape.as_bytes()).code(), 3);
}

#[test]
fn roots_with_multiplicity() {
    let lines = r#"{"c": [24, -50, 35, -10, 1]}
{"c": [1, -2, 1, 0, 0]}
{"c": [1, 0, 1, 0, 0]}
{"c": [0, 0, 0, 0, 0]}
"#;
    rt().arg("roots").stdin(lines).assert().success().stderr_eq("").stdout_eq(str![[r#"
{"roots":[[1.0,1],[2.0,1],[3.0,1],[4.0,1]]}
{"roots":[[1.0,2]]}
{"roots":[]}
{"roots":[],"all":true}

"#]]);
}

#[test]
fn check_says_where_and_how_to_mend() {
    let workshop = Workshop::new();
    let text = support::EVERYTHING.replace("radius = 1 }", "raduis = 1 }").replace("fov = 40", "fov = 200");
    workshop.write("bad.toml", text);
    rt().current_dir(workshop.folder()).args(["check", "bad.toml"]).assert().code(3).stdout_eq("").stderr_eq(
        str![[r#"
bad.toml:12:7: error: [..]fov[..]
 12 | fov = 200
    |       ^^^
bad.toml:51:38: error: unknown key `raduis` in sphere: did you mean `radius`?
 51 | shape.sphere = { center = [0, 1, 0], raduis = 1 }
    |                                      ^^^^^^

"#]],
    );
    rt().current_dir(workshop.folder()).args(["check", "scene.toml"]).assert().success().stderr_eq(str![[
        r#"
scene.toml: no errors, 10 objects, 2 lights

"#
    ]]);
}

#[test]
fn progress_in_lines_and_in_json() {
    let workshop = Workshop::new();
    let render = |mode: &str| {
        workshop.rt(&["render", "scene.toml", "-o", "a.png", "--width", "200", "--progress", mode])
    };
    let plain = render("plain").stderr;
    assert!(
        plain.lines().any(|line| line.starts_with("100% done, ") && line.ends_with(" s left")),
        "{plain}"
    );
    assert!(plain.lines().last().unwrap().starts_with("a.png: 200 x 18 pixels, "), "{plain}");
    let json = render("json").stderr;
    let lines: Vec<serde_json::Value> =
        json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let last = lines.last().unwrap();
    assert_eq!((&last["percent"], &last["done"]), (&100.into(), &last["total"]));
    assert_eq!(render("none").stderr, "");
    assert_eq!(workshop.rt(&["render", "scene.toml", "-o", "a.png", "-q"]).stderr, "");
}

#[test]
fn statistics_hold_every_count() {
    let workshop = Workshop::new();
    let outcome = workshop.rt(&[
        "render",
        "scene.toml",
        "-o",
        "a.png",
        "-q",
        "--aa",
        "none",
        "--stats",
        "-",
        "--threads",
        "2",
    ]);
    let stats: serde_json::Value = serde_json::from_str(&outcome.text()).unwrap();
    assert_eq!(stats["eye_rays"], 24 * 18);
    assert_eq!(
        (&stats["primitives"], &stats["lights"], &stats["threads"]),
        (&10.into(), &2.into(), &2.into())
    );
    for count in
        ["eye_hits", "shadow_rays", "shadow_hits", "reflected_rays", "refracted_rays", "secondary_hits"]
    {
        assert!(stats[count].as_u64().is_some_and(|n| n > 0), "{count}: {stats}");
    }
    for time in ["load_s", "build_s", "trace_s", "write_s"] {
        assert!(stats[time].as_f64().is_some_and(|s| s >= 0.0), "{time}: {stats}");
    }
}

#[test]
fn a_scene_from_standard_input_and_a_picture_to_standard_output() {
    let workshop = Workshop::new();
    assert_eq!(workshop.rt(&["render", "scene.toml", "-o", "a.png", "-q"]).code(), 0);
    let outcome = workshop.rt_with(&["render", "-", "-o", "-", "-q"], support::EVERYTHING.as_bytes());
    assert!(outcome.stdout == workshop.read("a.png"));
}

#[test]
fn completions_for_every_shell() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = rt().args(["completions", shell]).output().unwrap();
        assert!(
            script.status.success() && String::from_utf8_lossy(&script.stdout).contains("render"),
            "{shell}"
        );
    }
}

#[test]
fn help_has_examples() {
    for command in [
        &["--help"][..],
        &["render", "--help"],
        &["check", "--help"],
        &["cast", "--help"],
        &["roots", "--help"],
        &["stitch", "--help"],
    ] {
        let help = rt().args(command).env("NO_COLOR", "1").output().unwrap();
        let text = String::from_utf8(help.stdout).unwrap();
        assert!(
            help.status.success() && text.contains("Examples:") && !text.contains('\u{1b}'),
            "{command:?}"
        );
    }
}

#[test]
fn a_misspelt_command_is_recognised() {
    rt().arg("rendr").assert().code(2).stderr_eq(str![[r#"
error: unrecognized subcommand 'rendr'

  tip: a similar subcommand exists: 'render'
...
"#]]);
}
