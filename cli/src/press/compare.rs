//! `kufe compare`: two solved contacts.

use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe::jobs::field::{ComparedMaps, read_map};
use kufe::plot::{measured, quantity, shown_unit};
use kufe::report::{Picture, read_json, results_page};
use kufe::results::{
    ComparedQuantity, Comparison, ContactResult, Datum, PeakPressure, ResultQuantity,
    compared_quantities,
};
use kufe_contact::PressureMap;

use crate::output::OutputDir;
use crate::terminal::{Global, warn};
use crate::text::aligned;

/// Largest size of a result [bytes].
const MAX_BYTES: u64 = 1 << 25;

/// Arguments of `kufe compare`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Folder of the first contact, as kufe press writes it
    pub first: PathBuf,
    /// Folder of the second
    pub second: PathBuf,
    /// Folder for comparison.json, comparison.png and comparison.html
    #[arg(long, short, value_name = "FOLDER", default_value = "compared")]
    pub out: PathBuf,
}

/// Compares two contacts and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file and place.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let folders = [&args.first, &args.second];
    let files = folders.map(|folder| ["result.json", "pressure.exr"].map(|name| folder.join(name)));
    let output = OutputDir::begin("compare", files.as_flattened(), &args.out, global.force)?;
    let [[first, first_map], [second, second_map]] = &files;
    let first: ContactResult = read_json(first, MAX_BYTES)?;
    let second: ContactResult = read_json(second, MAX_BYTES)?;
    let maps = [read_map(first_map)?, read_map(second_map)?];
    if let Some([x, y]) = distance_apart(maps.each_ref()) {
        warn(&format!(
            "the maps do not overlap: their middles are {} apart along and {} across, and their difference says nothing; \
             give both hulls one origin",
            quantity(x, "m"),
            quantity(y, "m")
        ));
    }
    let compared = ComparedMaps::new(maps.each_ref());
    let names = folders.map(|folder| name_of(folder));
    let document = Comparison {
        first: names[0].clone(),
        second: names[1].clone(),
        quantities: compared_quantities(&first, &second)?,
        map: compared.difference(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    let figure = compared.picture(names.each_ref().map(String::as_str));
    let picture = Picture {
        name: format!("{} and {}", names[0], names[1]),
        png: figure.png(),
    };
    let data = Datum::of(&document)?;
    let documents = [("second less first".to_owned(), data)];
    let title = title(&document);
    output.bytes(
        "comparison.html",
        results_page([&title, ""], &[picture], &[], &documents),
    )?;
    output.picture("comparison.png", &figure)?;
    output.finish("comparison.json", &document, global, || text(&document))
}

/// Distance of the middles of two maps along and across [m]; `None` if the maps overlap.
fn distance_apart(maps: [&PressureMap; 2]) -> Option<[f64; 2]> {
    let along = maps.map(|map| [map.x0, map.dx * (map.nx - 1) as f64]);
    let across = maps.map(|map| [map.y0, map.dy * (map.ny - 1) as f64]);
    let distance = |[[a, a_length], [b, b_length]]: [[f64; 2]; 2]| {
        let middles = b - a + 0.5 * (b_length - a_length);
        (middles, middles.abs() > 0.5 * (a_length + b_length))
    };
    let ((x, apart_x), (y, apart_y)) = (distance(along), distance(across));
    (apart_x || apart_y).then_some([x, y])
}

/// Names of both contacts, and the difference of their peaks.
fn title(document: &Comparison) -> String {
    let names = format!("{} and {}", document.first, document.second);
    let peak = PeakPressure::DESCRIPTION;
    let row = document.quantities.iter().find(|row| row.key == peak.key);
    let Some((row, error)) = row.and_then(|row| Some((row, row.difference_error?))) else {
        return names;
    };
    let [first, second] = [row.first, row.second].map(|peak| quantity(peak, "Pa"));
    let difference = measured(row.difference.abs(), error, "Pa");
    format!("{names}: peaks of {first} and {second}, {difference} apart")
}

/// The path of a folder without a slash at its end.
fn name_of(folder: &Path) -> String {
    let name = folder.display().to_string();
    match name.trim_end_matches('/') {
        "" => name.clone(),
        short => short.to_owned(),
    }
}

fn text(document: &Comparison) -> String {
    let (first, second) = (&document.first, &document.second);
    let rows = document.quantities.iter().map(row);
    let head = ["", first, second, "difference", ""].map(str::to_owned);
    let table = aligned(&[head].into_iter().chain(rows).collect::<Vec<_>>(), "");
    let map = &document.map;
    let [x, y] = [map.largest_x_m, map.largest_y_m].map(|place| quantity(place, "m"));
    let (most, moved) = (quantity(map.largest_pa, "Pa"), quantity(map.moved_n, "N"));
    format!(
        "{table}the maps differ by up to {most}, at x = {x}, y = {y}; redistributed force {moved}\n"
    )
}

/// A quantity with its errors; a star where the difference exceeds them.
fn row(quantity: &ComparedQuantity) -> [String; 5] {
    let unit = shown_unit(&quantity.key);
    let shown = |value: f64, error: Option<f64>| measured(value, error.unwrap_or(0.0), &unit);
    let exceeds = quantity.exceeds_errors == Some(true);
    [
        kufe::results::name_of(&quantity.key),
        shown(quantity.first, quantity.first_error),
        shown(quantity.second, quantity.second_error),
        shown(quantity.difference, quantity.difference_error),
        if exceeds { "*" } else { "" }.to_owned(),
    ]
}
