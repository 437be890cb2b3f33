//! File names from the names of runs, tracks, drivers and specimens.

use crate::record::files::RunFormat;

/// Longest part of a name in a file name [bytes].
const MAX_BYTES: usize = 100;

/// A name as part of a file name.
///
/// Letters, digits, `-`, `_` and `.` are unchanged; other characters become `_`. A hash of the name
/// is appended if the name changes by this, is empty or longer than 100 bytes, begins with `.` or `-`,
/// or is the name of a device on Windows. Different names therefore give different files, all in
/// their folder.
pub fn file_stem(name: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
    let mut stem = String::new();
    for c in name.chars() {
        if stem.len() + c.len_utf8() > MAX_BYTES {
            break;
        }
        stem.push(if is_plain(c) { c } else { '_' });
    }
    let first = name.split('.').next().unwrap_or_default().to_lowercase();
    let number = first.trim_start_matches("com").trim_start_matches("lpt");
    let is_port = number.len() + 3 == first.len() && number.parse::<u8>().is_ok();
    let is_device = is_port || ["con", "prn", "aux", "nul"].contains(&&*first);
    if stem == name && !name.starts_with(['.', '-']) && !name.is_empty() && !is_device {
        return stem;
    }
    // FNV-1a of 32 bits.
    let hash = name.bytes().fold(0x811c_9dc5_u32, |hash, byte| {
        (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
    });
    // Windows takes `con.csv` for a device too.
    let stem = if is_device {
        stem.replace('.', "_")
    } else {
        stem
    };
    let stem = stem.trim_start_matches(['.', '-']);
    let stem = if stem.is_empty() { "_" } else { stem };
    format!("{stem}-{hash:08x}")
}

/// The file of a run.
pub fn run_file(run: &str, format: RunFormat) -> String {
    format!("{}.{}", file_stem(run), format.extension())
}

/// The file of a track, in the folder of the runs on it.
pub fn track_file(track: &str) -> String {
    format!("track_{}.csv", file_stem(track))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_their_folder_and_different_names_give_different_files() {
        for plain in ["A1-01", "igls", "Königssee", "run_001", "a.b"] {
            assert_eq!(file_stem(plain), plain);
        }
        let long = "x".repeat(300);
        let names = [
            "../../precious",
            "/etc/passwd",
            "..",
            ".",
            "",
            ".hidden",
            "a/b",
            "a\\b",
            "a:b",
            "a b",
            "a_b",
            "a\nb",
            "a\u{1b}b",
            "con",
            "NUL.old",
            "Com1",
            "-rf",
            &long,
            &format!("{long}y"),
        ];
        let stems: Vec<String> = names.iter().map(|name| file_stem(name)).collect();
        for (stem, name) in stems.iter().zip(names) {
            assert!(
                !stem.starts_with(['.', '-']) && !stem.is_empty(),
                "{name:?}"
            );
            let device = stem.split('.').next().unwrap().to_lowercase();
            assert!(!["con", "nul", "com1"].contains(&&*device), "{name:?}");
            assert!(!stem.contains(['/', '\\', ':', '\n', '\u{1b}']), "{name:?}");
            assert!(stem.len() < 120, "{name:?}");
            assert_eq!(
                stems.iter().filter(|other| *other == stem).count(),
                1,
                "{name:?}"
            );
        }
    }
}
