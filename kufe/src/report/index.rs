//! The page of an index of runs.

use std::path::Path;

use kufe_sled::{Entry, distinct};
use serde::Serialize;

use crate::jobs::gather::UNNAMED;
use crate::report::results::results_page;
use crate::results::{Data, Datum};

/// A row of the page; values that the index does not state are absent.
#[derive(Serialize)]
struct IndexRow<'a> {
    run: &'a str,
    track: Option<&'a str>,
    driver: Option<&'a str>,
    driver_class: Option<&'a str>,
    session: Option<&'a str>,
    ice_c: f64,
    air_c: f64,
    air_pa: f64,
    humidity_pct: f64,
    mass_kg: f64,
    file: String,
    missing: Option<&'static str>,
}

impl<'a> IndexRow<'a> {
    fn new(entry: &'a Entry, folder: &Path) -> Self {
        let stated = |name: &'a String| (name != UNNAMED).then_some(name.as_str());
        let at = &entry.conditions;
        let file = entry.file.strip_prefix(folder).unwrap_or(&entry.file);
        IndexRow {
            run: &entry.run,
            track: stated(&entry.track),
            driver: stated(&entry.driver),
            driver_class: stated(&entry.driver_class),
            session: stated(&entry.session),
            ice_c: at.ice_c,
            air_c: at.air_c,
            air_pa: at.air_pa,
            humidity_pct: at.humidity_pct,
            mass_kg: at.mass_kg,
            file: file.display().to_string(),
            missing: (!entry.file.is_file()).then_some("there is no such file"),
        }
    }
}

/// The page of the index `name` in `folder`: sessions, tracks and drivers with their numbers of
/// runs, and each run.
///
/// # Errors
/// Those of a number that cannot be written as JSON.
pub fn index_page(name: &str, folder: &Path, entries: &[Entry]) -> serde_json::Result<String> {
    let rows = entries.iter().map(|entry| IndexRow::new(entry, folder));
    let counts = |key, field| counts(entries, key, field);
    let documents = [
        ("sessions", counts("session", |entry| &entry.session)),
        ("tracks", counts("track", |entry| &entry.track)),
        ("drivers", counts("driver", |entry| &entry.driver)),
        ("every run", Datum::of(&rows.collect::<Vec<_>>())?),
    ];
    let documents = documents.map(|(name, figures)| (name.to_owned(), figures));
    let count = entries.len();
    let plural = if count == 1 { "" } else { "s" };
    let title = format!("{name}: {count} run{plural}");
    Ok(results_page([&title, ""], &[], &[], &documents))
}

/// Distinct values of a field in the order of their first run, each with its number of runs.
fn counts(entries: &[Entry], key: &str, field: fn(&Entry) -> &String) -> Datum {
    let row = |name: &String| {
        let count = entries.iter().filter(|entry| field(entry) == name).count();
        Datum::Group(Data::from([
            (key.to_owned(), Datum::Text(name.clone())),
            ("runs".to_owned(), Datum::Whole(count as i64)),
        ]))
    };
    let names = distinct(entries.iter().map(field));
    Datum::List(names.into_iter().map(row).collect())
}
