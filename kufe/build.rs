//! Lists the effects: every file in a room of the catalogue is a module with an `EFFECT`, and nothing else lists it.
//!
//! Written for each room: `ROOM.rs` with the modules, and `catalogue.rs` with all effects in the order of rooms and files.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

fn main() {
    let package = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR").expect("set by cargo"));
    let out = PathBuf::from(std::env::var("OUT_DIR").expect("set by cargo"));
    let catalogue = ["src/effects/catalogue", "src/case/effects/catalogue"]
        .map(|folder| package.join(folder))
        .into_iter()
        .find(|folder| folder.is_dir())
        .expect("a package with effects has a catalogue");
    println!("cargo::rerun-if-changed={}", catalogue.display());
    let mut all =
        String::from("/// All effects, room by room.\npub static CATALOGUE: &[&Effect] = &[\n");
    for room in sorted(&catalogue).iter().filter(|path| path.is_dir()) {
        let mut modules = String::new();
        for file in sorted(room).iter().filter(|path| stem(path) != "mod") {
            let _ = writeln!(modules, "#[path = {:?}]\npub mod {};", file, stem(file));
            let _ = writeln!(all, "    &{}::{}::EFFECT,", stem(room), stem(file));
        }
        write(&out.join(format!("{}.rs", stem(room))), &modules);
    }
    all.push_str("];\n");
    write(&out.join("catalogue.rs"), &all);
}

fn sorted(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder that can be read");
    let mut paths: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.is_dir() || path.extension().is_some_and(|e| e == "rs"))
        .collect();
    paths.sort();
    paths
}

fn stem(path: &Path) -> &str {
    path.file_stem()
        .and_then(|stem| stem.to_str())
        .expect("names of modules are plain letters")
}

fn write(path: &Path, text: &str) {
    std::fs::write(path, text).expect("cargo's own folder can be written");
}
