//! The page of a series of contacts.

use std::path::Path;

use kufe::jobs::Failure;
use kufe::report::{Kind, SeriesPage, page as html};
use kufe::results::SeriesRow;

use crate::report::folder_name::folder_name;
use crate::report::read_json::read_json;

/// Largest `table.json` [bytes].
const LONGEST: u64 = 1 << 25;
/// Most contacts of a page.
const MOST: usize = 5000;

/// The page of a folder into which `kufe press` has written a series.
pub fn page(folder: &Path) -> Result<String, Failure> {
    let path = folder.join("table.json");
    let rows: Vec<SeriesRow> = read_json(&path, LONGEST)?;
    if rows.is_empty() || rows.len() > MOST {
        return Err(Failure::BadInput(format!(
            "{}: {} steps: expected 1 to {MOST}",
            path.display(),
            rows.len()
        )));
    }
    let name = folder_name(folder);
    let title = format!("{name}, series");
    Ok(html(Kind::Series, &title, &SeriesPage::new(name, rows)))
}
