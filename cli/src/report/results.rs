//! The page of a folder whose figures have no page of their own.

use std::path::Path;

use kufe::jobs::Failure;
use kufe::report::{Picture, results_page};
use kufe_files::read_regular;

use crate::output::documents::{known_as, without_idle_steel};
use crate::report::folder_name::folder_name;
use crate::report::read_json::read_json;

/// Figures of a command, the ones of most to say first.
pub const DOCUMENTS: [&str; 9] = [
    "friction.json",
    "fit.json",
    "validation.json",
    "simulation.json",
    "icehouse.json",
    "align.json",
    "import.json",
    "truth.json",
    "quality.json",
];

/// Figures hold some hundreds of bytes a run; what is longer than this is something else [bytes].
const LONGEST: u64 = 1 << 24;
/// Longest picture that a page carries [bytes], and most of them.
const LONGEST_PICTURE: u64 = 1 << 23;
const MOST_PICTURES: usize = 12;

fn unreadable(path: &Path, error: std::io::Error) -> Failure {
    Failure::BadInput(format!("{}: cannot be read: {error}", path.display()))
}

/// The picture in a file; nothing where its first bytes are not those of a PNG.
pub fn picture(path: &Path) -> Result<Option<Vec<u8>>, Failure> {
    let bytes = read_regular(path, LONGEST_PICTURE).map_err(|error| unreadable(path, error))?;
    Ok(Some(bytes).filter(|bytes| bytes.starts_with(b"\x89PNG\r\n\x1a\n")))
}

/// The page of a folder that holds one of [`DOCUMENTS`].
pub fn page(folder: &Path) -> Result<String, Failure> {
    let mut documents = Vec::new();
    for name in DOCUMENTS {
        let path = folder.join(name);
        if path.is_file() {
            let mut document = read_json(&path, LONGEST)?;
            let kind = known_as(&document).map_or(name, |known| known.kind);
            without_idle_steel(&mut document);
            documents.push((kind.to_owned(), document));
        }
    }
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|error| unreadable(folder, error))? {
        let path = entry.map_err(|error| unreadable(folder, error))?.path();
        if path.extension().is_some_and(|ending| ending == "png") {
            paths.push(path);
        }
    }
    paths.sort();
    let mut pictures = Vec::new();
    for path in paths.into_iter().take(MOST_PICTURES) {
        let Some(png) = picture(&path)? else {
            continue;
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        pictures.push(Picture {
            name: name.into_owned(),
            png,
        });
    }
    Ok(results_page(&folder_name(folder), &pictures, &documents))
}
