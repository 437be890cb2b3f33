//! Any bytes are a height map or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_mesh::HeightMap::from_csv(bytes);
});
