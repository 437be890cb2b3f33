//! The page of a folder that a command has written, or of a lookup table.

use std::path::{Path, PathBuf};

use kufe_contact::parted;
use kufe_files::{leads_out, read_regular, text_of_regular};
use kufe_mesh::{HullOptions, load_hull};
use kufe_sled::{Section, read_index};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::jobs::field::read_map;
use crate::jobs::gather::relative;
use crate::jobs::{Failure, failure::Located, table::read_table};
use crate::report::contact::{ContactPage, SeriesPage};
use crate::report::index::index_page;
use crate::report::page::{Kind, page};
use crate::report::results::sections::capital;
use crate::report::results::{Picture, picture_url, results_page};
use crate::report::table::TablePage;
use crate::report::viewer::{Stretch, VIEWER, ViewedPart, address, linked_to};
use crate::results::label::name_of;
use crate::results::{
    ContactResult, Datum, DocumentKind, Evaluation, LateralFitDocument, SeriesRow, Validation,
};

/// Default file name of the page of a folder.
pub const PAGE: &str = "report.html";
/// Files of the pictures of the model's tables, front and rear; absent for a model without tables.
pub const TABLE_PICTURES: [&str; 2] = ["table_front.png", "table_rear.png"];
/// The file that lists runs.
const INDEX: &str = "runs.csv";
/// The document of simulated runs and of a replay.
const SIMULATION: &str = "simulation.json";
/// Documents without a page of their own, in the order of their importance.
const DOCUMENTS: [&str; 9] = [
    "friction.json",
    "fit.json",
    "validation.json",
    SIMULATION,
    "icehouse.json",
    "align.json",
    "import.json",
    "truth.json",
    "quality.json",
];

/// Largest size of a document that is read into a struct: [`MAX_CONTACTS`] take 4 to 8 MB [bytes].
const MAX_BYTES: u64 = 1 << 24;
/// Largest size of a document that is read as a tree, which takes sixty times as much memory
/// [bytes].
pub const MAX_TREE_BYTES: u64 = 1 << 23;
/// Largest size of a page [bytes].
const MAX_PAGE_BYTES: u64 = 1 << 28;
/// Number of points along and across of all maps together.
const POINTS: [usize; 2] = [420, 260];
/// Largest number of triangles of a hull; `hull.glb` has fewer.
const MAX_TRIANGLES: usize = 20_000;
/// Largest number of contacts of a page, and of steps of a series.
pub const MAX_CONTACTS: usize = 5000;
/// Largest number of runs of a page.
const MAX_RUNS: usize = 1000;
/// Largest size of a picture of a page [bytes].
const MAX_PICTURE_BYTES: u64 = 1 << 23;
/// Largest number of pictures of a page.
const MAX_PICTURES: usize = 12;

/// The document in a JSON file of at most `max_bytes`.
///
/// # Errors
/// [`Failure::BadInput`] with the file and the key.
pub fn read_json<T: DeserializeOwned>(path: &Path, max_bytes: u64) -> Result<T, Failure> {
    let text = text_of_regular(path, max_bytes).in_file(path)?;
    serde_json::from_str(&text).in_file(path)
}

/// The name of a folder, even if its path ends in `.`.
fn folder_name(folder: &Path) -> String {
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.into());
    let last = whole.file_name().unwrap_or(whole.as_os_str());
    last.to_string_lossy().into_owned()
}

/// The page of a result.
pub struct ResultPage {
    /// Kind of the result.
    pub kind: &'static str,
    /// File of the page.
    pub file: PathBuf,
    /// The page as HTML.
    pub html: String,
}

/// The page of a folder that a command has written, or of a lookup table (`.lut`). Its file is
/// `out`, or by default `report.html` in the folder, or the table's name with the ending `.html`.
///
/// A page of runs links into `view.html` of the folder, if this file exists.
///
/// # Errors
/// [`Failure::BadInput`] for a folder without results, or an invalid file.
pub fn result_page(result: &Path, out: Option<&Path>) -> Result<ResultPage, Failure> {
    let wrong = |reason: &str| Failure::in_file(result, reason);
    let file = |default: PathBuf| out.map_or(default, Path::to_path_buf);
    if !result.exists() {
        return Err(wrong("cannot be read: there is no such file or folder"));
    }
    if !result.is_dir() {
        if !ends_in(result, "lut") {
            let reason = "expected a folder that a command of kufe has written, or a .lut file";
            return Err(wrong(reason));
        }
        return Ok(ResultPage {
            kind: "table",
            file: file(result.with_extension("html")),
            html: table(result)?,
        });
    }
    let files = files_of(result);
    if let Some(link) = files.iter().find(|path| leads_out(result, path)) {
        let reason = "a link that leads out of the folder; expected a file in it";
        return Err(Failure::in_file(link, reason));
    }
    let has = |name: &str| result.join(name).is_file();
    let file = file(result.join(PAGE));
    let viewer = has(VIEWER).then(|| {
        let folder = file.parent().filter(|folder| *folder != Path::new(""));
        let folder = folder.unwrap_or(Path::new("."));
        address(&relative(&result.join(VIEWER), folder))
    });
    let viewer = viewer.as_deref();
    let (kind, html) = if has("result.json") {
        ("press", contact(result)?)
    } else if has("comparison.json") {
        ("comparison", written(result, "comparison.html", viewer)?)
    } else if has("table.json") {
        ("series", series(result)?)
    } else if has("evaluation.json") {
        ("evaluation", evaluation(result, viewer)?)
    } else if has("report.json") {
        ("discovery", written(result, PAGE, viewer)?)
    } else if has("check.json") {
        ("check", written(result, "check.html", viewer)?)
    } else if DOCUMENTS.into_iter().any(has) {
        ("results", documents(result, &files, viewer)?)
    } else if has(INDEX) {
        ("runs", index(result)?)
    } else {
        return Err(wrong(&without_page(result, &files)));
    };
    Ok(ResultPage { kind, file, html })
}

/// The files of a folder, sorted.
fn files_of(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let paths = entries.map(|entry| entry.path());
    let mut files: Vec<PathBuf> = paths.filter(|path| path.is_file()).collect();
    files.sort();
    files
}

fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|found| found == ending)
}

/// The error of a folder without figures: its contents, and the command that shows them.
fn without_page(folder: &Path, files: &[PathBuf]) -> String {
    let shown = folder.display();
    let table = files.iter().find(|path| ends_in(path, "lut"));
    let glides = folder.join("glides.csv");
    if folder.join("plan.json").is_file() {
        format!(
            "the plan of a table: solve its shards, then kufe lut merge {shown} -o table.lut makes the table, which kufe report shows"
        )
    } else if glides.is_file() {
        let glides = glides.display();
        format!("glides without figures: kufe icehouse {glides} makes them")
    } else if let Some(table) = table {
        let table = table.display();
        format!("lookup tables, which have a page each: kufe report {table}")
    } else {
        "no results: expected what a command of kufe has written, as result.json or table.json (kufe press), \
         evaluation.json (kufe evaluate) or report.json (kufe discover)"
            .to_owned()
    }
}

/// The page `name` that a command has written, with its links changed to the address of the viewer.
fn written(folder: &Path, name: &str, viewer: Option<&str>) -> Result<String, Failure> {
    let path = folder.join(name);
    let page = text_of_regular(&path, MAX_PAGE_BYTES).in_file(&path)?;
    Ok(match viewer {
        Some(viewer) => linked_to(&page, viewer),
        None => page,
    })
}

/// The page of a solved contact.
fn contact(folder: &Path) -> Result<String, Failure> {
    let result: ContactResult = read_json(&folder.join("result.json"), MAX_BYTES)?;
    let maps = parted(read_map(&folder.join("pressure.exr"))?);
    let glb = folder.join("hull.glb");
    let hull = if glb.is_file() {
        Some(load_hull(&glb, &HullOptions::default())?.0)
    } else {
        None
    };
    let hull = hull.filter(|hull| hull.triangles.len() <= MAX_TRIANGLES);
    let data = ContactPage::new(result, &maps, hull.as_ref(), POINTS, folder_name(folder))?;
    Ok(page(Kind::Press, &data.title, &data))
}

/// The page of a series of contacts.
fn series(folder: &Path) -> Result<String, Failure> {
    let path = folder.join("table.json");
    let rows: Vec<SeriesRow> = read_json(&path, MAX_BYTES)?;
    if !(1..=MAX_CONTACTS).contains(&rows.len()) {
        let reason = format!("{} steps: expected 1 to {MAX_CONTACTS}", rows.len());
        return Err(Failure::in_file(&path, reason));
    }
    let name = folder_name(folder);
    let title = format!("{name}, series");
    Ok(page(Kind::Series, &title, &SeriesPage::new(name, rows)))
}

/// The page of a `.lut` file.
fn table(path: &Path) -> Result<String, Failure> {
    let table = read_table(path)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let data = TablePage::new(&table, &name).in_file(path)?;
    Ok(page(Kind::Table, &format!("{name}, lookup table"), &data))
}

/// Data of the page of an evaluation.
#[derive(Serialize)]
struct EvaluationPage<'a> {
    #[serde(flatten)]
    evaluation: Evaluation,
    tables: Vec<TablePicture>,
    /// Address of the page of the runs.
    viewer: Option<&'a str>,
}

/// A picture of a table of friction with the samples of the runs.
#[derive(Serialize)]
struct TablePicture {
    runner: &'static str,
    picture: String,
}

/// The page of an evaluation of drivers.
fn evaluation(folder: &Path, viewer: Option<&str>) -> Result<String, Failure> {
    let path = folder.join("evaluation.json");
    let evaluation: Evaluation = read_json(&path, MAX_BYTES)?;
    let count = evaluation.runs.len();
    if count > MAX_RUNS {
        let reason = format!("{count} runs: a page shows at most {MAX_RUNS}");
        return Err(Failure::in_file(&path, reason));
    }
    let mut tables = Vec::new();
    for (name, runner) in TABLE_PICTURES.iter().zip(["front runner", "rear runner"]) {
        let png = picture(&folder.join(name))?;
        tables.extend(png.map(|png| TablePicture {
            runner,
            picture: picture_url(&png),
        }));
    }
    let data = EvaluationPage {
        evaluation,
        tables,
        viewer,
    };
    Ok(page(Kind::Evaluation, "What drivers lose", &data))
}

/// The page of an index of runs.
fn index(folder: &Path) -> Result<String, Failure> {
    let entries = read_index(&folder.join(INDEX))?;
    Ok(index_page(&folder_name(folder), folder, &entries)?)
}

/// The picture in a file; `None` if the file does not exist or is not a PNG.
fn picture(path: &Path) -> Result<Option<Vec<u8>>, Failure> {
    if !path.is_file() {
        return Ok(None);
    }
    let bytes = read_regular(path, MAX_PICTURE_BYTES).in_file(path)?;
    Ok(Some(bytes).filter(|bytes| bytes.starts_with(b"\x89PNG\r\n\x1a\n")))
}

/// The page of a folder with [`DOCUMENTS`].
fn documents(folder: &Path, files: &[PathBuf], viewer: Option<&str>) -> Result<String, Failure> {
    let mut documents = Vec::new();
    for name in DOCUMENTS {
        let path = folder.join(name);
        if path.is_file() {
            let document: Datum = read_json(&path, MAX_TREE_BYTES)?;
            if !matches!(&document, Datum::Group(data) if !data.is_empty()) {
                return Err(Failure::in_file(&path, "expected an object with results"));
            }
            let kind = DocumentKind::of(&document).map_or(name, |kind| kind.name);
            documents.push((kind.to_owned(), document.effective()));
        }
    }
    let mut pictures = Vec::new();
    let pngs = files.iter().filter(|path| ends_in(path, "png"));
    for path in pngs.take(MAX_PICTURES) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.into_owned();
        pictures.extend(picture(path)?.map(|png| Picture { name, png }));
    }
    let simulation = folder.join(SIMULATION);
    let links = match viewer.filter(|_| simulation.is_file()) {
        Some(viewer) => replay_links(&simulation, viewer)?,
        None => Vec::new(),
    };
    let name = folder_name(folder);
    let kind = documents.first().map(|(kind, _)| capital(kind) + ": ");
    let title = kind.unwrap_or_default() + &name;
    let headline = headline(folder)?.unwrap_or_default();
    let heads = [&*title, &headline];
    Ok(results_page(heads, &pictures, &links, &documents))
}

/// The result of a fit or a validation in one sentence; `None` for other folders and fits.
fn headline(folder: &Path) -> Result<Option<String>, Failure> {
    if let Ok(fit) = read_json::<LateralFitDocument>(&folder.join("fit.json"), MAX_TREE_BYTES) {
        return Ok(Some(fit.headline()));
    }
    let file = folder.join("validation.json");
    if !file.is_file() {
        return Ok(None);
    }
    let validation = read_json::<Validation>(&file, MAX_TREE_BYTES)?;
    Ok(Some(validation.headline()))
}

/// The replay in a `simulation.json`.
#[derive(Deserialize)]
struct ReplayRecord {
    replay: Option<ReplayedRun>,
}

#[derive(Deserialize)]
struct ReplayedRun {
    run: String,
    sections: Vec<Section>,
}

/// Links to a replayed run and to the sections where it differs from the model; empty for other
/// simulations.
fn replay_links(path: &Path, viewer: &str) -> Result<Vec<String>, Failure> {
    let record: ReplayRecord = read_json(path, MAX_TREE_BYTES)?;
    let Some(ReplayedRun { run, sections }) = record.replay else {
        return Ok(Vec::new());
    };
    let runs = [&*run];
    let part = ViewedPart::of_runs(&runs);
    let whole = part.link(viewer, "the whole run");
    let sections = sections.iter().map(|section| {
        let (column, from, to) = (&section.column, section.from_m, section.to_m);
        let part = ViewedPart {
            channel: Some(column),
            stretch: Some(Stretch::around(from, to)),
            ..part
        };
        let name = name_of(column);
        part.link(viewer, &format!("{name}, {from:.0} to {to:.0} m"))
    });
    Ok(std::iter::once(whole).chain(sections).collect())
}
