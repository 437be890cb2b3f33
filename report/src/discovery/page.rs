//! The page: what to act on first, then each effect, then tables folded.

use std::fmt::Write as _;

use kufe_plot::quantity;
use serde_json::Value;

use super::bars;
use super::data::Data;
use super::diagram::diagram;
use super::maps::comparison;
use super::parts::{fold, list, wide};
use super::sections::{bins, detectable, next_runs, parameters, runs, step};
use super::strip::strip;
use super::summary::summary;
use crate::page::{escape, plain_page};

/// The page of a search for missing effects: one HTML file without scripts.
///
/// `report` is what `kufe discover` writes to `report.json`, with its `pictures` beside: each has a `title` and a `plot`,
/// whose `kind` is `strip` (`runs` along a track, `places`), `scatter` (`x`, `y`, `series`, a `curve` or `zero`) or `maps` (a
/// measured and simulated maps on one grid).
pub fn discovery_page(report: &Value) -> String {
    let report = Data(report);
    let mut out = String::new();
    summary(&mut out, report);
    let (strips, others): (Vec<Data>, Vec<Data>) = report
        .list("pictures")
        .into_iter()
        .partition(|picture| picture.part("plot").text("kind") == "strip");
    for picture in strips {
        wide(&mut out, &strip(picture.part("plot")));
    }
    for picture in others {
        let plot = picture.part("plot");
        let svg = match plot.text("kind") {
            "maps" => comparison(plot),
            _ => diagram(plot),
        };
        let _ = writeln!(out, "<h2>{}</h2>", escape(picture.text("title")));
        wide(&mut out, &svg);
        if !picture.text("caption").is_empty() {
            let _ = writeln!(
                out,
                "<p><small>{}</small></p>",
                escape(picture.text("caption"))
            );
        }
    }
    for (number, one) in report.list("steps").iter().enumerate() {
        step(&mut out, number + 1, *one, report);
    }
    details(&mut out, report);
    let _ = writeln!(
        out,
        "<p><small>kufe {}, seed {}, data: {}</small></p>",
        escape(report.text("version")),
        report.count("seed"),
        escape(report.text("data"))
    );
    plain_page("What the model lacks", &out)
}

/// Tables of numbers, folded.
fn details(out: &mut String, report: Data) {
    out.push_str("<h2>In numbers</h2>\n");
    fold(out, "The gap before and after, channel by channel", |out| {
        gaps(out, report);
    });
    fold(out, "Where it disagrees", |out| {
        bins(out, &report.list("bins"));
    });
    if !report.list("steps").is_empty() {
        fold(out, "What is left after", |out| {
            bins(out, &report.list("bins_after"));
        });
    }
    let plans = report.list("next_runs");
    if !plans.is_empty() {
        fold(out, "Which runs to drive next", |out| {
            next_runs(out, &plans)
        });
    }
    let by_run = report.list("by_run");
    if by_run.iter().any(|channel| channel.list("runs").len() >= 2) {
        fold(out, "By run and by session", |out| runs(out, &by_run));
    }
    if !report.list("base").is_empty() {
        fold(out, "Base parameters, refitted", |out| {
            parameters(out, &report.list("base"));
        });
    }
    let tolerated = report.list("within_tolerance").into_iter().map(|part| {
        let size = quantity(part.number("size"), part.text("unit"));
        format!("{}: {size}", part.text("what"))
    });
    list(out, "Within the tolerance of the installation", tolerated);
    if !report.list("minimum_detectable").is_empty() {
        fold(out, "What could be told apart with these data", |out| {
            detectable(out, &report.list("minimum_detectable"));
        });
    }
    let untestable = report.list("untestable").into_iter().map(|pair| {
        let text = |k: usize| pair.0[k].as_str().unwrap_or_default();
        format!("{}: {}", text(0), text(1))
    });
    list(out, "Not testable with these data", untestable);
    let remarks = report.texts("remarks").into_iter();
    list(out, "Remarks", remarks.map(str::to_owned));
}

fn gaps(out: &mut String, report: Data) {
    let title = "On the data it was learned from";
    wide(out, &bars::gap(title, &report.list("training")));
    let held_out = report.part("held_out");
    let channels = held_out.list("channels");
    if !channels.is_empty() {
        wide(
            out,
            &bars::gap("On data that the search had not seen", &channels),
        );
        let _ = writeln!(
            out,
            "<p><small>Not seen: {}. Root mean squares; the noise cannot be closed by any effect.</small></p>",
            escape(&held_out.texts("runs").join(", "))
        );
    }
}
