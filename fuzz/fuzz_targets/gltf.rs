//! Any bytes are a hull or an error; files that they refer to do not exist.
#![no_main]

use kufe_mesh::{HullOptions, check_hull, read_gltf};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let nothing = |_: &str| Err(std::io::ErrorKind::NotFound.into());
    if let Ok(hull) = read_gltf(bytes, &HullOptions::default(), nothing) {
        let _ = check_hull(&hull);
    }
});
