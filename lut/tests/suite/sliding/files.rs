//! Files of tables that slide.

use crate::tables::sliding;
use kufe_lut::Table;

#[test]
fn a_file_read_back_is_the_same_table_to_the_bit() {
    for rocker in [false, true] {
        let table = sliding(rocker);
        let mut bytes = Vec::new();
        table.write(&mut bytes).unwrap();
        let back = Table::read(&mut bytes.as_slice()).unwrap();
        assert!(back == table);
        let mut again = Vec::new();
        back.write(&mut again).unwrap();
        assert!(again == bytes);
    }
}

#[test]
fn broken_files_are_named_by_place() {
    let mut bytes = Vec::new();
    sliding(false).write(&mut bytes).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    for (from, to, told) in [
        ("\"name\":\"v_mps\"", "\"name\":\"ice_c\"", "axes[3]"),
        (
            "\"name\":\"ice_c\"",
            "\"name\":\"fog\"",
            "axes[3]: found fog, expected ice_c",
        ),
        ("[2.0,6.0,14.0", "[-2.0,6.0,14.0", "v_mps, value 0 = -2"),
        (
            "\"mu\": {\"unit\":\"1\"",
            "\"mu\": {\"unit\":\"Pa\"",
            "quantities.mu",
        ),
        ("\"format_version\": 3", "\"format_version\": 1", "axes"),
        ("\"ice_c\":-4.0", "\"ice_c\":-40.0", "checks[0].ice_c"),
    ] {
        assert!(text.contains(from), "{from}");
        let broken = text.replace(from, to);
        let Err(error) = Table::read(&mut broken.as_bytes()) else {
            panic!("{from} may be {to}");
        };
        let error = error.to_string();
        assert!(error.contains(told), "{told}: {error}");
    }
}
