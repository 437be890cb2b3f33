//! Any bytes are a table or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_lut::Table::read(&mut &bytes[..]);
});
