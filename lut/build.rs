//! Compiles the FMU's library with the system's C compiler, so that an installed `kufe` carries it.
//!
//! Without a usable compiler the crate still builds; only writing an FMU is refused then, with the
//! reason.

use std::path::Path;
use std::process::Command;

fn main() {
    for file in ["c", "build.rs"] {
        println!("cargo::rerun-if-changed={file}");
    }
    println!("cargo::rerun-if-env-changed=CC");
    let variable = |name: &str| std::env::var(name).unwrap_or_default();
    let library = Path::new(&variable("OUT_DIR")).join("kufe_lut_fmu.bin");
    let (platform, suffix) = match (
        variable("CARGO_CFG_TARGET_ARCH").as_str(),
        variable("CARGO_CFG_TARGET_OS").as_str(),
    ) {
        ("x86_64", "linux") => ("x86_64-linux", "so"),
        ("aarch64", "linux") => ("aarch64-linux", "so"),
        ("x86_64", "macos") => ("x86_64-darwin", "dylib"),
        ("aarch64", "macos") => ("aarch64-darwin", "dylib"),
        _ => ("", ""),
    };
    let reason = if platform.is_empty() {
        "FMUs are made on Linux and macOS, x86-64 and ARM64".to_string()
    } else if machine(&variable("HOST")) != machine(&variable("TARGET")) {
        "it was cross-compiled".to_string()
    } else {
        compile(&library).err().unwrap_or_default()
    };
    if !reason.is_empty() {
        println!("cargo::warning=kufe-lut: no FMU export: {reason}");
        // Empty on purpose: the library detects its absence by its length.
        if let Err(error) = std::fs::write(&library, b"") {
            println!("cargo::error=kufe-lut: {}: {error}", library.display());
        }
    }
    println!("cargo::rustc-env=KUFE_FMU_PLATFORM={platform}");
    println!("cargo::rustc-env=KUFE_FMU_SUFFIX={suffix}");
    println!(
        "cargo::rustc-env=KUFE_FMU_REASON={}",
        reason.replace('\n', " ")
    );
}

/// Architecture and system of a target triple; the C library it is linked with does not matter to
/// an FMU.
fn machine(triple: &str) -> (Option<&str>, Option<&str>) {
    let mut parts = triple.split('-');
    (parts.next(), parts.nth(1))
}

fn compile(library: &Path) -> Result<(), String> {
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let output = Command::new(&compiler)
        .args(["-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden"])
        .args(["-ffp-contract=off", "-Ic", "c/fmu.c", "-o"])
        .arg(library)
        .arg("-lm")
        .output()
        .map_err(|error| format!("{compiler}: {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    Err(format!(
        "{compiler} failed: {}",
        String::from_utf8_lossy(&output.stderr).trim()
    ))
}
