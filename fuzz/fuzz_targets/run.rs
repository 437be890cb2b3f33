//! Any bytes are the columns of a run or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_sled::read_csv(bytes, &kufe_sled::COLUMNS, "run.csv");
});
