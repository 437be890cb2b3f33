//! Any bytes are columns of a Parquet file or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = kufe_sled::read_parquet(bytes::Bytes::copy_from_slice(bytes), None, "run.parquet");
});
