//! Any bytes are a mesh or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_mesh::read_vtu(bytes);
});
