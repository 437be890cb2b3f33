//! The page: what to act on first, then each effect, then tables folded.

use std::fmt::Write as _;

use crate::plot::quantity;
use serde_json::Value;

use super::bars;
use super::data::Data;
use super::diagram::{diagram, wide_diagram};
use super::maps::comparison;
use super::parts::{fold, list};
use super::peaks::peaks;
use super::sections::{bins, detectable, next_runs, parameters, runs, step};
use super::strip::strip;
use super::summary::summary;
use crate::report::page::{escape, plain_page};
use crate::report::sign::signed;

/// The page of a search for missing effects: one HTML file without scripts.
///
/// `report` is what `kufe discover` writes to `report.json`, with its `pictures` beside: each has a `title` and a `plot`,
/// whose `kind` is `strip` (`runs` along a track, `places`), `scatter` (`x`, `y`, `series`, a `curve` or `zero`), `maps` (a
/// measured and simulated maps on one grid) or `peaks` (`rows` with their largest pressures).
pub fn discovery_page(report: &Value) -> String {
    let report = signed(report);
    let report = Data(&report);
    let mut out = String::new();
    summary(&mut out, report);
    let (strips, others): (Vec<Data>, Vec<Data>) = report
        .list("pictures")
        .into_iter()
        .partition(|picture| picture.part("plot").text("kind") == "strip");
    along_tracks(&mut out, strips);
    figures(&mut out, &others);
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

/// What is left along the track where most effects are; along others, folded.
fn along_tracks(out: &mut String, strips: Vec<Data>) {
    let mut plots: Vec<Data> = strips.iter().map(|strip| strip.part("plot")).collect();
    plots.sort_by_key(|plot| std::cmp::Reverse(plot.list("places").len()));
    let mut plots = plots.into_iter();
    if let Some(first) = plots.next() {
        out.push_str(&strip(first));
    }
    for plot in plots {
        let title = format!("The same along track {}", plot.text("track"));
        fold(out, &title, |out| out.push_str(&strip(plot)));
    }
}

/// Diagrams side by side, maps one below the other.
fn figures(out: &mut String, pictures: &[Data]) {
    if pictures.is_empty() {
        return;
    }
    out.push_str("<div class=\"figures\">\n");
    let is_whole = |picture: &&Data| ["maps", "peaks"].contains(&picture.part("plot").text("kind"));
    // Diagrams stand in pairs; the one that has none beside it is as wide as the page.
    let single = match pictures.iter().filter(|picture| !is_whole(picture)).count() % 2 {
        1 => pictures.iter().position(|picture| !is_whole(&picture)),
        _ => None,
    };
    for (k, picture) in pictures.iter().enumerate() {
        let plot = picture.part("plot");
        let (class, svg) = match plot.text("kind") {
            _ if single == Some(k) => (" class=\"whole\"", wide_diagram(plot)),
            "maps" => (" class=\"whole\"", comparison(plot)),
            "peaks" => (" class=\"whole\"", peaks(plot)),
            _ => ("", diagram(plot)),
        };
        let title = escape(picture.text("title"));
        let _ = writeln!(out, "<div{class}><h2>{title}</h2>\n{svg}");
        if !picture.text("caption").is_empty() {
            let caption = escape(picture.text("caption"));
            let _ = writeln!(out, "<p><small>{caption}</small></p>");
        }
        out.push_str("</div>\n");
    }
    out.push_str("</div>\n");
}

/// Tables of numbers, folded.
fn details(out: &mut String, report: Data) {
    out.push_str("<h2>In numbers</h2>\n");
    let baselines = report.list("baselines");
    if !baselines.is_empty() {
        let title = "Three models on data that the search had not seen";
        out.push_str(&bars::models(title, &baselines));
    }
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
    out.push_str(&bars::gap(title, &report.list("training")));
    let held_out = report.part("held_out");
    let channels = held_out.list("channels");
    if !channels.is_empty() {
        out.push_str(&bars::gap(
            "On data that the search had not seen",
            &channels,
        ));
        let _ = writeln!(
            out,
            "<p><small>Not seen: {}. Root mean squares; the noise cannot be closed by any effect.</small></p>",
            escape(&held_out.texts("runs").join(", "))
        );
    }
}
