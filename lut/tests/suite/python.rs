//! Scripts in the interpreter that KUFE_PYTHON names.

use std::path::Path;
use std::process::Command;

/// The interpreter with the scientific packages, where there is one with `module`.
pub fn python(module: &str) -> Option<String> {
    let Ok(python) = std::env::var("KUFE_PYTHON") else {
        println!("skipped: KUFE_PYTHON is not set");
        return None;
    };
    let found = Command::new(&python)
        .args(["-c", &format!("import {module}")])
        .status();
    if !found.is_ok_and(|status| status.success()) {
        println!("skipped: {python} has no {module}");
        return None;
    }
    Some(python)
}

/// What `script` prints, run in `folder`.
pub fn run_python(python: &str, folder: &Path, script: &str) -> String {
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
