//! Runs the command in an empty folder.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// A runner, flat ice and a load: a case that solves in an instant.
pub const CASE: &str = r#"[runner]
shape = { kind = "bob", length_m = 1.0, rocker_radius_m = 30.0, section_radius_m = 0.005, width_m = 0.010, height_m = 0.030 }
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = 0.05
[track]
radius_m = inf
[load]
fz_n = 1000.0
[accuracy]
p_max = 0.02
"#;

/// An empty folder to run the command in.
pub struct Bench {
    /// The folder, removed with this value.
    pub folder: TempDir,
}

impl Bench {
    /// A new empty folder.
    pub fn new() -> Bench {
        Bench {
            folder: tempfile::tempdir().expect("a temporary folder"),
        }
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).expect("a writable folder");
    }

    /// Runs `kufe` with these words in the folder.
    pub fn kufe(&self, words: &[&str]) -> Output {
        kufe(self.folder.path(), words)
    }

    /// Runs `kufe` and expects it to succeed; returns what it printed.
    pub fn succeeds(&self, words: &[&str]) -> String {
        let output = self.kufe(words);
        assert!(
            output.status.success(),
            "kufe {words:?}: {}",
            errors(&output)
        );
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Names in the folder, sorted.
    pub fn names(&self) -> Vec<String> {
        names(self.folder.path())
    }
}

/// Runs `kufe` with these words in a folder.
pub fn kufe(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_kufe"))
        .current_dir(folder)
        .args(words)
        .output()
        .expect("the command runs")
}

/// Runs `kufe` in a folder and expects it to succeed; returns what it printed.
pub fn succeeds(folder: &Path, words: &[&str]) -> String {
    let output = kufe(folder, words);
    let reported = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{words:?}: {reported}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Runs `kufe` in a folder and expects it to exit with `code` and to name these parts.
pub fn refused(folder: &Path, words: &[&str], code: i32, parts: &[&str]) {
    let output = kufe(folder, words);
    let reported = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{words:?}: {reported}");
    for part in parts {
        assert!(
            reported.contains(part),
            "{words:?}: no {part:?} in {reported}"
        );
    }
}

/// A JSON file.
pub fn json(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).expect("a result");
    serde_json::from_str(&text).expect("JSON")
}

/// Runs lines in Octave in a folder, if Octave is installed, and expects every `assert` of them to pass.
pub fn octave(folder: &Path, lines: &str) {
    if let Some(mut octave) = kufe_outside::program("octave-cli") {
        let ran = octave
            .args(["--quiet", "--eval", lines])
            .current_dir(folder);
        let output = ran.output().expect("Octave runs");
        assert!(output.status.success(), "{}", errors(&output));
    }
}

/// Standard error of a run.
pub fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Names in a folder, hidden ones too, without the record of an output folder; sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("a readable folder")
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.retain(|name| name != ".kufe.json");
    names.sort();
    names
}
