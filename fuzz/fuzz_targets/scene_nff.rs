//! Any bytes as a scene in NFF: a scene, or errors each with its place.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_shade::text::{NoPictures, load};

fuzz_target!(|bytes: &[u8]| {
    if let Err(errors) = load("scene.nff", bytes, &NoPictures) {
        assert!(
            !errors.is_empty() && errors.iter().all(|e| e.line > 0 && e.column > 0 && !e.message.is_empty())
        );
    }
});
