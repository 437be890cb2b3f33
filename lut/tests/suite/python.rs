//! Scripts in Python.

use std::path::Path;
use std::process::Command;

/// What `script` prints, run in `folder`.
pub fn run_python(python: &Path, folder: &Path, script: &str) -> String {
    let output = Command::new(python)
        .arg("-c")
        .arg(script)
        .current_dir(folder)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    String::from_utf8(output.stdout).unwrap()
}
