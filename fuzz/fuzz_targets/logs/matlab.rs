//! Any bytes are vectors of a MATLAB v5 file or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_sled::read_matlab(bytes, "run.mat");
});
