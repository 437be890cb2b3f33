//! Any bytes are experiments or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_sled::friction::read_experiments("experiments.csv", bytes);
});
