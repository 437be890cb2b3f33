//! Any bytes are results that commands read back, fit.json among them, or errors.
#![no_main]

use kufe::results::{ContactResult, LateralFitDocument, SeriesRow};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = serde_json::from_slice::<LateralFitDocument>(bytes);
    let _ = serde_json::from_slice::<ContactResult>(bytes);
    let _ = serde_json::from_slice::<Vec<SeriesRow>>(bytes);
});
