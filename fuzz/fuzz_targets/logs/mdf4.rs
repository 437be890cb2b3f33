//! Any bytes are the channels of an MDF 4 log or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_telemetry::read_mdf4(std::io::Cursor::new(bytes.to_vec()), None, "a.mf4");
});
