//! Any bytes are a pressure map or an error, without the memory that a header asks for.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_discover::read_map_bytes(bytes, "map.exr");
});
