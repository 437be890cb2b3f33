//! Any bytes are a track or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_sled::Track::from_csv(bytes, "east", "track.csv");
});
