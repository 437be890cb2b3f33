//! Any bytes are the channels of a MATLAB v7.3 file or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_telemetry::read_matlab73(std::io::Cursor::new(bytes.to_vec()), None, "a.mat");
});
