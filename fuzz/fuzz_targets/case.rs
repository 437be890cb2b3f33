//! Any text is a case or an error of one line; a case survives writing and reading.
#![no_main]

use kufe::case::Case;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| match Case::parse(text) {
    Ok(case) => {
        let written = case.to_toml().expect("a case that was text is text again");
        assert_eq!(
            Case::parse(&written).expect("a written case is a case"),
            case
        );
    }
    Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error}"),
});
