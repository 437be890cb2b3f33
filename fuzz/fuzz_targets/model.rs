//! Any text is a model or an error; a model's effects are switched on or refused.
#![no_main]

use kufe_sled::{Model, Vehicle};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(mut model) = Model::from_toml(text, "model.toml") {
        // Tables are other files.
        model.friction.longitudinal.front_table = None;
        model.friction.longitudinal.rear_table = None;
        let _ = Vehicle::with_effects(&model);
    }
});
