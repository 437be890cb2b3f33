//! Any bytes are a hull or an error.
#![no_main]

use kufe_mesh::{HullOptions, check_hull, read_3mf};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(hull) = read_3mf(bytes, &HullOptions::default()) {
        let _ = check_hull(&hull);
    }
});
