//! Any bytes are a recording that a mapping can be guessed from, and a mapping, or errors.
#![no_main]

use kufe_telemetry::{Mapping, TextOptions, guess_mapping, read_text};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(log) = read_text(bytes, TextOptions::default(), None, 1_000_000, "a.csv") {
        let _ = guess_mapping(&[("a.csv".into(), log)]);
    }
    let _ = Mapping::parse(&String::from_utf8_lossy(bytes), "mapping.toml");
});
