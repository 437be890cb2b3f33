//! Odd files of hulls and recordings, made by a script that shares nothing with the readers.

use std::path::Path;
use std::process::Command;

#[test]
fn every_odd_file_of_the_corpus_has_its_right_reading() {
    let Some(python) = kufe_outside::python("asammdf, h5py, numpy, pyarrow, scipy") else {
        return;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/corpus.py");
    let output = Command::new(python)
        .arg(script)
        .arg(env!("CARGO_BIN_EXE_kufe"))
        .output()
        .expect("the interpreter that KUFE_PYTHON names");
    let found = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{found}{errors}");
}
