//! Any bytes are a recording that a mapping can be guessed from, or an error.
#![no_main]

use kufe_telemetry::{TextOptions, guess_mapping, read_text};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(log) = read_text(bytes, TextOptions::default(), None, "a.csv") {
        let _ = guess_mapping(&[("a.csv".into(), log)]);
    }
});
