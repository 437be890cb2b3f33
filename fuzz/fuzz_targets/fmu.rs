//! Any bytes are an FMU's description or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_lut::read_fmu(std::io::Cursor::new(bytes));
});
