//! Compiles the library of the FMUs with the system's C compiler, and for Windows with MinGW-w64 if
//! it is installed. An installed `kufe` contains both.
//!
//! Without a usable compiler the crate still builds. Writing an FMU is then an error that states
//! the reason.

use std::path::Path;
use std::process::Command;

/// A platform of the compiled library: its names in FMI 2.0 and 3.0, and the file extension of its
/// libraries.
type Platform = (&'static str, &'static str, &'static str);

const WINDOWS: Platform = ("win64", "x86_64-windows", "dll");

/// Name of the cross-compiler for Windows on Debian, Fedora, Arch and Homebrew.
const MINGW: &str = "x86_64-w64-mingw32-gcc";

fn main() {
    for file in ["c", "build.rs"] {
        println!("cargo::rerun-if-changed={file}");
    }
    println!("cargo::rerun-if-env-changed=CC");
    let variable = |name: &str| std::env::var(name).unwrap_or_default();
    let folder = variable("OUT_DIR");
    let folder = Path::new(&folder);
    let [architecture, system] =
        ["ARCH", "OS"].map(|of| variable(&format!("CARGO_CFG_TARGET_{of}")));
    let native: Option<Platform> = match (architecture.as_str(), system.as_str()) {
        ("x86_64", "linux") => Some(("linux64", "x86_64-linux", "so")),
        ("aarch64", "linux") => Some(("aarch64-linux", "aarch64-linux", "so")),
        ("x86_64", "macos") => Some(("darwin64", "x86_64-darwin", "dylib")),
        ("aarch64", "macos") => Some(("aarch64-darwin", "aarch64-darwin", "dylib")),
        _ => None,
    };
    let mut libraries = String::from("[");
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let compiled = match native {
        None => Err("FMUs are made on Linux and macOS, x86-64 and ARM64".into()),
        Some(_) if machine(&variable("HOST")) != machine(&variable("TARGET")) => {
            Err("it was cross-compiled".into())
        }
        Some(platform) => compile(&compiler, &["-fPIC"], platform, folder),
    };
    let reason = compiled.as_ref().err().cloned().unwrap_or_default();
    if !reason.is_empty() {
        println!("cargo::warning=kufe-lut: no FMU for this machine: {reason}");
    }
    let on_windows = compile(MINGW, &["-static-libgcc", "-s"], WINDOWS, folder);
    for entry in [compiled, on_windows].into_iter().flatten() {
        libraries += &entry;
    }
    libraries.push(']');
    let list = folder.join("libraries.rs");
    if let Err(error) = std::fs::write(&list, libraries) {
        println!("cargo::error=kufe-lut: {}: {error}", list.display());
    }
    println!(
        "cargo::rustc-env=KUFE_FMU_REASON={}",
        reason.replace('\n', " ")
    );
}

/// Architecture and system of a target triple; the C library is irrelevant for an FMU.
fn machine(triple: &str) -> (Option<&str>, Option<&str>) {
    let mut parts = triple.split('-');
    (parts.next(), parts.nth(1))
}

/// Compiles the library of a platform; returns its entry in the list of libraries.
fn compile(
    compiler: &str,
    flags: &[&str],
    (fmi2, fmi3, ending): Platform,
    folder: &Path,
) -> Result<String, String> {
    let library = folder.join(format!("{fmi3}.bin"));
    let output = Command::new(compiler)
        .args(["-std=c99", "-O2", "-shared", "-fvisibility=hidden"])
        .args(["-ffp-contract=off", "-Ic", "c/fmi2.c", "c/fmi3.c", "-o"])
        .arg(&library)
        .args(flags)
        .arg("-lm")
        .output()
        .map_err(|error| format!("{compiler}: {error}"))?;
    if !output.status.success() {
        let messages = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{compiler} failed: {}", messages.trim()));
    }
    Ok(format!(
        "Library {{ platform: [{fmi2:?}, {fmi3:?}], ending: {ending:?}, \
         bytes: include_bytes!(concat!(env!(\"OUT_DIR\"), \"/{fmi3}.bin\")) }},"
    ))
}
