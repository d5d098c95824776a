//! A crate outside the workspace depends on `rt-core` alone, by path, and hits a torus.

use std::path::Path;
use std::process::Command;

#[test]
fn a_crate_of_its_own_hits_a_torus() {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    // Below `target`, so that `cargo clean` takes it; its own workspace, so that ours is not joined.
    let folder = repository.join("target/outside-crate");
    std::fs::create_dir_all(folder.join("src")).unwrap();
    let manifest = format!(
        "[package]\nname = \"outside\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[workspace]\n\n\
         [dependencies]\nrt-core = {{ path = {:?} }}\n",
        repository.join("crates/rt-core")
    );
    std::fs::write(folder.join("Cargo.toml"), manifest).unwrap();
    // The same versions as ours, so that nothing need be fetched.
    std::fs::copy(repository.join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    let program = r#"
use rt_core::{Interval, Primitive, Ray, shape::Torus};

fn main() -> Result<(), rt_core::Error> {
    let ring = Torus::new([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 2.0, 0.5)?;
    let ray = Ray::new([-10.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let hit = ring.hit(&ray, Interval::FORWARD).expect("the ray goes through the ring");
    assert_eq!(ring.surface(&ray, hit).t, 7.5);
    Ok(())
}
"#;
    std::fs::write(folder.join("src/main.rs"), program).unwrap();
    let output = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--offline"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
