//! External programs that tests compare with.
//!
//! A test whose program is missing passes and reports on standard error what it did not check, even
//! if the test runner captures output. With `KUFE_DEMAND=1`, as in `.ci/run`, it fails.

use std::{
    io::Write,
    path::PathBuf,
    process::{Command, Stdio},
};

/// Reports that a program or package to compare with is missing.
///
/// # Panics
/// With `KUFE_DEMAND=1`.
pub fn missing(what: &str) {
    assert!(
        std::env::var_os("KUFE_DEMAND").is_none_or(|value| value != "1"),
        "KUFE_DEMAND=1, and {what}"
    );
    not_here(what);
}

/// Reports that this machine does not meet a requirement of a test (a mount, a second address,
/// confidential data). `KUFE_DEMAND` has no effect, because no installation would change it.
pub fn not_here(why: &str) {
    // Not captured by the test runner.
    let _ = writeln!(std::io::stderr().lock(), "not checked: {why}");
}

/// The program of this name if it is on the `PATH`.
///
/// # Panics
/// As [`missing`].
pub fn program(name: &str) -> Option<Command> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path).find(|folder| folder.join(name).is_file());
    if found.is_none() {
        missing(&format!("there is no {name} on the PATH"));
    }
    found.map(|_| Command::new(name))
}

/// The interpreter that `KUFE_PYTHON` names if it has these modules (separated by commas).
///
/// # Panics
/// As [`missing`].
pub fn python(modules: &str) -> Option<PathBuf> {
    let Some(interpreter) = std::env::var_os("KUFE_PYTHON") else {
        missing("KUFE_PYTHON names no interpreter");
        return None;
    };
    let found = Command::new(&interpreter)
        .args(["-c", &format!("import {modules}")])
        .stderr(Stdio::null())
        .status();
    if !found.is_ok_and(|status| status.success()) {
        missing(&format!(
            "{} has not all of {modules}",
            interpreter.display()
        ));
        return None;
    }
    Some(interpreter.into())
}
