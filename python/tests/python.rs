//! The Python package as its users have it: the library that cargo has just built, together with
//! the package's Python files, with pytest over python/tests and the examples.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The newest of the places where cargo leaves the library.
fn library() -> PathBuf {
    let test = std::env::current_exe().expect("this program's path");
    let deps = test.parent().expect("target/PROFILE/deps");
    let places = [deps.join("lib_kufe.so"), deps.join("../lib_kufe.so")];
    let made = |path: &PathBuf| path.metadata().and_then(|meta| meta.modified()).ok();
    let newest = places.into_iter().max_by_key(made).expect("two places");
    assert!(newest.exists(), "{}: not built", newest.display());
    newest
}

fn copy_all(from: &Path, to: &Path, ending: &str) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|found| found == ending) {
            std::fs::copy(&path, to.join(path.file_name().expect("a name"))).expect("a copy");
        }
    }
}

#[test]
#[cfg(target_os = "linux")]
fn the_python_package_passes_its_tests() {
    let Some(python) = kufe_outside::python("numpy, pytest, matplotlib") else {
        return;
    };
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().expect("a folder");
    let package = folder.path().join("kufe");
    copy_all(&here.join("kufe"), &package, "py");
    std::fs::copy(library(), package.join("_kufe.abi3.so")).expect("the library");
    copy_all(&here.join("tests"), &folder.path().join("tests"), "py");
    copy_all(
        &here.join("examples"),
        &folder.path().join("examples"),
        "py",
    );
    let output = Command::new(&python)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "tests"])
        .current_dir(folder.path())
        .env("PYTHONPATH", folder.path())
        .env("MPLBACKEND", "Agg")
        .env("KUFE_STUBS", here.join("kufe/_kufe.pyi"))
        .env("KUFE_PAGE", here.join("../docs/python.md"))
        .output()
        .expect("pytest");
    assert!(
        output.status.success(),
        "{}\n{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}
