//! The pages of single kinds of results.

use std::path::Path;

use kufe::jobs::field::read_exr::read_map;
use kufe::jobs::{Failure, runs::failure, table::read_table};
use kufe::report::{
    ContactPage, Kind, Picture, SeriesPage, TablePage, index_page, page, picture_url, results_page,
};
use kufe::results::{ContactResult, Datum, DocumentKind, Evaluation, SeriesRow};
use kufe_contact::parted;
use kufe_files::{read_regular, text_of_regular};
use kufe_mesh::{HullOptions, load_hull};
use kufe_sled::read_index;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::runs::TABLE_PICTURES;

/// The file that lists runs.
pub const INDEX: &str = "runs.csv";
/// Documents without a page of their own, in the order of their importance.
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

/// Longest document of a struct of its own: [`MOST_CONTACTS`] take 4 to 8 MB
/// [bytes].
const LONGEST: u64 = 1 << 24;
/// Longest document that is read as a tree, which takes sixty times as much memory [bytes].
pub const LONGEST_TREE: u64 = 1 << 23;
/// Longest page [bytes].
const LONGEST_PAGE: u64 = 1 << 28;
/// Points along and across of all maps together.
const POINTS: [usize; 2] = [420, 260];
/// More triangles than `hull.glb` has.
const MOST_TRIANGLES: usize = 20_000;
/// Most contacts and most runs of a page.
const MOST_CONTACTS: usize = 5000;
const MOST_RUNS: usize = 1000;
/// Longest picture of a page [bytes], and most of them.
const LONGEST_PICTURE: u64 = 1 << 23;
const MOST_PICTURES: usize = 12;

/// The document in a JSON file of at most `longest` bytes.
///
/// # Errors
/// [`Failure::BadInput`] with the file and the key.
pub fn read_json<T: DeserializeOwned>(path: &Path, longest: u64) -> Result<T, Failure> {
    let text = text_of_regular(path, longest).map_err(|error| unreadable(path, &error))?;
    serde_json::from_str(&text).map_err(|error| wrong(path, &error))
}

fn wrong(path: &Path, reason: &dyn std::fmt::Display) -> Failure {
    Failure::BadInput(format!("{}: {reason}", path.display()))
}

fn unreadable(path: &Path, error: &std::io::Error) -> Failure {
    wrong(path, &format!("cannot be read: {error}"))
}

/// The folder's own name, also where the path ends in `.`.
fn folder_name(folder: &Path) -> String {
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.into());
    let last = whole.file_name().unwrap_or(whole.as_os_str());
    last.to_string_lossy().into_owned()
}

/// The page that a command has written itself.
pub fn written(path: &Path) -> Result<String, Failure> {
    text_of_regular(path, LONGEST_PAGE).map_err(|error| unreadable(path, &error))
}

/// The page of a solved contact.
pub fn contact(folder: &Path) -> Result<String, Failure> {
    let result: ContactResult = read_json(&folder.join("result.json"), LONGEST)?;
    let maps = parted(read_map(&folder.join("pressure.exr"))?);
    let glb = folder.join("hull.glb");
    let hull = if glb.is_file() {
        let (hull, _) = load_hull(&glb, &HullOptions::default()).map_err(Failure::bad_input)?;
        Some(hull).filter(|hull| hull.triangles.len() <= MOST_TRIANGLES)
    } else {
        None
    };
    let data = ContactPage::new(result, &maps, hull.as_ref(), POINTS, folder_name(folder));
    Ok(page(Kind::Press, &data.title, &data))
}

/// The page of a series of contacts.
pub fn series(folder: &Path) -> Result<String, Failure> {
    let path = folder.join("table.json");
    let rows: Vec<SeriesRow> = read_json(&path, LONGEST)?;
    if rows.is_empty() || rows.len() > MOST_CONTACTS {
        let count = rows.len();
        return Err(wrong(
            &path,
            &format!("{count} steps: expected 1 to {MOST_CONTACTS}"),
        ));
    }
    let name = folder_name(folder);
    let title = format!("{name}, series");
    Ok(page(Kind::Series, &title, &SeriesPage::new(name, rows)))
}

/// The page of a `.lut` file.
pub fn table(path: &Path) -> Result<String, Failure> {
    let table = read_table(path)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let data = TablePage::new(&table, &name).map_err(|error| wrong(path, &error))?;
    Ok(page(Kind::Table, &format!("{name}, lookup table"), &data))
}

/// Data of the page of an evaluation.
#[derive(Serialize)]
struct EvaluationPage {
    #[serde(flatten)]
    evaluation: Evaluation,
    tables: Vec<TablePicture>,
}

/// A picture of a table of friction with the samples of the runs.
#[derive(Serialize)]
struct TablePicture {
    runner: &'static str,
    picture: String,
}

/// The page of an evaluation of drivers.
pub fn evaluation(folder: &Path) -> Result<String, Failure> {
    let path = folder.join("evaluation.json");
    let evaluation: Evaluation = read_json(&path, LONGEST)?;
    let count = evaluation.runs.len();
    if count > MOST_RUNS {
        let reason = format!("{count} runs: a page shows at most {MOST_RUNS}");
        return Err(wrong(&path, &reason));
    }
    let mut tables = Vec::new();
    for (name, runner) in TABLE_PICTURES.iter().zip(["front runner", "rear runner"]) {
        let path = folder.join(name);
        let png = if path.is_file() {
            picture(&path)?
        } else {
            None
        };
        tables.extend(png.map(|png| TablePicture {
            runner,
            picture: picture_url(&png),
        }));
    }
    let data = EvaluationPage { evaluation, tables };
    Ok(page(Kind::Evaluation, "What drivers lose", &data))
}

/// The page of an index of runs.
pub fn index(folder: &Path) -> Result<String, Failure> {
    let entries = read_index(&folder.join(INDEX)).map_err(failure)?;
    index_page(&folder_name(folder), folder, &entries).map_err(Failure::bad_input)
}

/// The picture in a file; nothing where its first bytes are not those of a PNG.
fn picture(path: &Path) -> Result<Option<Vec<u8>>, Failure> {
    let bytes = read_regular(path, LONGEST_PICTURE).map_err(|error| unreadable(path, &error))?;
    Ok(Some(bytes).filter(|bytes| bytes.starts_with(b"\x89PNG\r\n\x1a\n")))
}

/// The page of a folder with [`DOCUMENTS`].
pub fn documents(folder: &Path) -> Result<String, Failure> {
    let mut documents = Vec::new();
    for name in DOCUMENTS {
        let path = folder.join(name);
        if path.is_file() {
            let document: Datum = read_json(&path, LONGEST_TREE)?;
            let kind = DocumentKind::of(&document).map_or(name, |kind| kind.name);
            documents.push((kind.to_owned(), document.effective()));
        }
    }
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|error| unreadable(folder, &error))? {
        let path = entry.map_err(|error| unreadable(folder, &error))?.path();
        if path.extension().is_some_and(|ending| ending == "png") {
            paths.push(path);
        }
    }
    paths.sort();
    let mut pictures = Vec::new();
    for path in paths.into_iter().take(MOST_PICTURES) {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        pictures.extend(picture(&path)?.map(|png| Picture { name, png }));
    }
    Ok(results_page(&folder_name(folder), &pictures, &documents))
}
