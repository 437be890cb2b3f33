//! Any text is a mapping or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_telemetry::Mapping::parse(&String::from_utf8_lossy(bytes), "mapping.toml");
});
