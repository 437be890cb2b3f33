//! The page of an evaluation of drivers.

use std::path::Path;

use kufe::jobs::Failure;
use kufe::report::{Kind, page as html, picture_url};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::report::read_json::read_json;
use crate::report::results::picture;
use crate::runs::tables::TABLE_PICTURES;

/// An evaluation holds a few hundred bytes a run; what is longer than this is something else [bytes].
const LONGEST: u64 = 1 << 24;
/// A page shows every run; more would be no page to look at.
const MOST_RUNS: usize = 1000;

/// Data of the page: what `kufe evaluate` wrote, and the pictures.
#[derive(Serialize)]
struct EvaluationPage {
    #[serde(flatten)]
    evaluation: Map<String, Value>,
    tables: Vec<TablePicture>,
}

/// A picture of a table of friction with the runs upon it.
#[derive(Serialize)]
struct TablePicture {
    runner: &'static str,
    picture: String,
}

/// The page of a folder that `kufe evaluate` has written.
pub fn page(folder: &Path) -> Result<String, Failure> {
    let path = folder.join("evaluation.json");
    let evaluation: Map<String, Value> = read_json(&path, LONGEST)?;
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let list = |key: &str| {
        let list = evaluation.get(key).and_then(Value::as_array);
        list.ok_or_else(|| told(format!("{key}: expected a list")))
    };
    list("groups")?;
    let runs = list("runs")?.len();
    if runs > MOST_RUNS {
        return Err(told(format!(
            "{runs} runs: a page shows at most {MOST_RUNS}"
        )));
    }
    let tables = tables(folder)?;
    let data = EvaluationPage { evaluation, tables };
    Ok(html(Kind::Evaluation, "What drivers lose", &data))
}

/// The pictures of the model's tables of friction with the runs upon them, of those that there are.
fn tables(folder: &Path) -> Result<Vec<TablePicture>, Failure> {
    let runners = ["front runner", "rear runner"];
    let mut tables = Vec::new();
    for (name, runner) in TABLE_PICTURES.iter().zip(runners) {
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
    Ok(tables)
}
