//! Checks that the outputs of a command are not among its inputs.

use std::collections::HashSet;
use std::fmt::Display;
use std::io::{Error, ErrorKind};
use std::path::{Component, Path, PathBuf};

use crate::place::replaceable;

/// Checks that every output may be written: it is not an input, no other output is the same file,
/// and a regular file or nothing is at its path.
///
/// # Errors
/// [`ErrorKind::InvalidInput`] with the first output that fails, and the reason.
pub fn outputs_apart(
    inputs: &[impl AsRef<Path>],
    outputs: &[impl AsRef<Path>],
) -> std::io::Result<()> {
    let inputs = inputs.iter().map(|input| resolved(input.as_ref()));
    let inputs: HashSet<PathBuf> = inputs.collect();
    let mut taken: HashSet<PathBuf> = HashSet::new();
    for output in outputs.iter().map(AsRef::as_ref) {
        let clash = |reason: &dyn Display| {
            let text = format!("{}: cannot be written: {reason}", output.display());
            Error::new(ErrorKind::InvalidInput, text)
        };
        replaceable(output).map_err(|reason| clash(&reason))?;
        let place = resolved(output);
        if inputs.contains(&place) {
            return Err(clash(&"this command reads it; expected another place"));
        }
        if !taken.insert(place) {
            let reason = "this command writes another of its outputs there; expected another place";
            return Err(clash(&reason));
        }
    }
    Ok(())
}

/// Whether two paths lead to one file, also through links and `..`; they need not exist.
pub fn same_file(a: &Path, b: &Path) -> bool {
    resolved(a) == resolved(b)
}

/// Whether a link between `folder` and `file`, or `file` itself, leads out of `folder`.
///
/// For a path that does not begin with `folder`, its own folder is used instead.
pub fn leads_out(folder: &Path, file: &Path) -> bool {
    let own = file.parent().unwrap_or(Path::new(""));
    let below = file.starts_with(folder) && file.is_absolute() == folder.is_absolute();
    let folder = if below { folder } else { own };
    // An empty path is the current folder.
    let inside = resolved(&folder.join("."));
    let way = file.ancestors().take_while(|part| *part != folder);
    way.filter(|part| part.is_symlink())
        .any(|link| !resolved(link).starts_with(&inside))
}

/// The path from the root without `.`, `..` and links, as far as the file system has it.
///
/// Each existing part is resolved before `..` removes it: `link/..` is the parent of the folder
/// that the link leads to. Parts that do not exist are not resolved: `new/../FILE` is `FILE`.
pub fn resolved(path: &Path) -> PathBuf {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let mut clean = PathBuf::new();
    for part in whole.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                clean.pop();
            }
            part => {
                clean.push(part);
                if let Ok(found) = clean.canonicalize() {
                    clean = found;
                }
            }
        }
    }
    clean
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_output_is_no_input_under_any_of_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("inner")).unwrap();
        std::fs::write(at("case.toml"), "").unwrap();
        let inputs = [at("case.toml")];
        let printed = |output: &Path| outputs_apart(&inputs, &[output]).map_err(|e| e.to_string());
        assert_eq!(printed(&at("other.toml")), Ok(()));
        assert_eq!(printed(&at("none/other.toml")), Ok(()));
        for name in ["case.toml", "./case.toml", "inner/../case.toml"] {
            assert!(
                printed(&at(name)).unwrap_err().contains("reads it"),
                "{name}"
            );
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("case.toml"), at("link")).unwrap();
            assert!(printed(&at("link")).unwrap_err().contains("reads it"));
        }
        assert!(printed(&at("inner")).unwrap_err().contains("a folder"));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_leads_out_of_its_folder_itself_or_by_a_folder_on_the_way() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        std::fs::create_dir_all(at("in/deep")).unwrap();
        std::fs::create_dir(at("out")).unwrap();
        for name in ["in/a", "in/deep/b", "out/c"] {
            std::fs::write(at(name), "").unwrap();
        }
        symlink("deep/b", at("in/inner")).unwrap();
        symlink("../a", at("in/deep/up")).unwrap();
        symlink("../out", at("in/folder")).unwrap();
        symlink("../out/c", at("in/file")).unwrap();
        symlink("file", at("in/twice")).unwrap();
        symlink("in", at("linked")).unwrap();
        let leads = |folder: &str, file: &str| leads_out(&at(folder), &at(file));
        for file in ["a", "deep/b", "inner", "deep/up", "../out/c"] {
            assert!(!leads("in", &format!("in/{file}")), "{file}");
            assert!(!leads("linked", &format!("linked/{file}")), "{file}");
        }
        for file in ["folder/c", "file", "twice"] {
            assert!(leads("in", &format!("in/{file}")), "{file}");
            assert!(leads("linked", &format!("linked/{file}")), "{file}");
        }
        assert!(leads("in", "linked/file") && !leads("in", "linked/a"));
    }

    #[test]
    fn two_outputs_are_two_files_also_before_there_is_a_folder() {
        let none: [&Path; 0] = [];
        let clash = outputs_apart(&none, &["none/a/t.csv", "none/b/../a/t.csv"]);
        let text = clash.expect_err("one place").to_string();
        assert!(text.contains("another of its outputs"), "{text}");
        assert!(outputs_apart(&none, &["none/a/t.csv", "none/b/t.csv"]).is_ok());
    }
}
