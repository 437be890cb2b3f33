//! Programs in C.

use std::fs::{File, write};
use std::path::Path;

/// What the C99 program in the file `source` of `folder` prints, given `input`; compiled without a
/// warning, and with these `flags`. None where there is no compiler.
pub fn run_c(folder: &Path, source: &str, flags: &[&str], input: &str) -> Option<String> {
    let mut compiler = kufe_outside::program("cc")?;
    let compiled = compiler
        .args([
            "-std=c99",
            "-pedantic",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-O1",
        ])
        .args(flags)
        .args([source, "-o", "program", "-lm"])
        .current_dir(folder)
        .output()
        .unwrap();
    let messages = String::from_utf8_lossy(&compiled.stderr);
    assert!(compiled.status.success(), "{messages}");
    write(folder.join("input"), input).unwrap();
    let ran = std::process::Command::new(folder.join("program"))
        .stdin(File::open(folder.join("input")).unwrap())
        .output()
        .unwrap();
    assert!(ran.status.success(), "{:?}", ran.status);
    Some(String::from_utf8(ran.stdout).unwrap())
}
