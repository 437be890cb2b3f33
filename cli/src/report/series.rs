//! The page of a series of contacts.

use std::path::Path;

use kufe::jobs::Failure;
use kufe::report::{Kind, page as html};
use serde_json::{Value, json};

use crate::report::folder_name::folder_name;
use crate::report::read_json::read_json;

/// A row holds some hundreds of bytes; what is longer than this is something else [bytes].
const LONGEST: u64 = 1 << 25;
/// A page shows every step; more would be no page to look at.
const MOST: usize = 5000;

/// The page of a folder into which `kufe press` has written a series.
pub fn page(folder: &Path) -> Result<String, Failure> {
    let path = folder.join("table.json");
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let rows = read_json(&path, LONGEST)?;
    let list = rows
        .as_array()
        .filter(|list| list.iter().all(Value::is_object))
        .ok_or_else(|| told("expected a list of steps".into()))?;
    if list.is_empty() || list.len() > MOST {
        return Err(told(format!("{} steps: expected 1 to {MOST}", list.len())));
    }
    for (k, row) in list.iter().enumerate() {
        let number = |key: &str| row[key].is_number() || row[key].is_null();
        let found = ["p_max_pa", "seconds"].into_iter().find(|key| !number(key));
        if let Some(key) = found {
            return Err(told(format!(
                "row {}: {key} = {}: expected a number",
                k + 1,
                row[key]
            )));
        }
    }
    // What was varied stands between the folder and the first figure.
    let first = list[0].as_object().into_iter().flatten();
    let keys: Vec<&String> = first
        .map(|(key, _)| key)
        .skip_while(|key| *key != "folder")
        .skip(1)
        .take_while(|key| *key != "p_max_pa")
        .collect();
    let name = folder_name(folder);
    let data = json!({ "name": name, "keys": keys, "rows": list });
    Ok(html(Kind::Series, &format!("{name}, series"), &data))
}
