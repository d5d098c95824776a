//! No acne, no leak, no ghost; and each check fails on a renderer that is broken on purpose.

#[path = "../examples/acne.rs"]
mod acne;

use acne::{OFFSETS, SCALES, black, ours, run, with_epsilon};

#[test]
fn no_pixel_is_wrong() {
    for (name, cases, wrong, failed) in run(&ours, 24, &SCALES, &OFFSETS) {
        assert!(cases > 0);
        assert_eq!(wrong, 0, "{name}: {failed:#?}");
    }
}

#[test]
fn black_pictures_fail_every_check() {
    for (name, _, wrong, _) in run(&black, 8, &[1.0], &[0.0]) {
        assert!(wrong > 0, "{name}");
    }
}

#[test]
fn an_epsilon_too_small_has_acne_and_ghosts() {
    let wrong = run(&|scene, settings| with_epsilon(scene, settings, 1e-16), 24, &[1.0], &[0.0, 1e4]);
    for (name, _, wrong, _) in wrong {
        // Too small an epsilon never lets light in.
        assert_eq!(wrong > 0, name != "leak", "{name}");
    }
}

#[test]
fn an_epsilon_too_large_leaks() {
    for (name, _, wrong, _) in run(&|scene, settings| with_epsilon(scene, settings, 0.2), 24, &[1.0], &[0.0])
    {
        assert!(name != "leak" || wrong > 0);
    }
}
