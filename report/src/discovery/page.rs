//! The page: what to act on first, then each effect, then tables folded.

use std::fmt::Write as _;

use kufe_plot::quantity;
use serde_json::Value;

use super::bars;
use super::data::Data;
use super::diagram::diagram;
use super::maps::comparison;
use super::parts::{fold, list, wide};
use super::sections::{bins, detectable, parameters, runs, step};
use super::strip::strip;
use super::summary::summary;
use crate::page::escape;

const STYLE: &str = "\
:root{color-scheme:light dark;--text:#1a1a1a;--back:#fff;--faint:#595959;--line:#d4d4d4;--box:#eef3f8;--edge:#2a6496;--in:#fff0cf}\
@media(prefers-color-scheme:dark){:root{--text:#e6e6e6;--back:#16181b;--faint:#a8a8a8;--line:#3c4046;--box:#1f2a35;--edge:#6aa5dc;--in:#463a18}}\
body{font:16px/1.45 system-ui,sans-serif;max-width:60em;margin:1em auto;padding:0 1em;color:var(--text);background:var(--back)}\
h1{font-size:1.4em;margin:.4em 0}h2{font-size:1.15em;margin-top:2em;border-bottom:1px solid var(--line)}h3{font-size:1em;margin:1em 0 .3em}\
.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.9em}\
td,th{padding:.25em .7em;border-bottom:1px solid var(--line);text-align:left;vertical-align:top}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}td.n{white-space:nowrap}\
.verdict{padding:.6em 1em;margin:.5em 0;background:var(--box);border-left:5px solid var(--edge);overflow-wrap:anywhere}ol.verdict{padding-left:2.2em}ol.verdict li{margin:.25em 0}\
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(12em,1fr));gap:.6em;margin:.7em 0}.tiles div{border:1px solid var(--line);border-radius:6px;padding:.45em .8em}\
.tiles b{display:block;font-size:1.25em;font-variant-numeric:tabular-nums}.tiles span{font-size:.85em;color:var(--faint)}\
details{border-bottom:1px solid var(--line);padding:.5em 0}summary{cursor:pointer;font-weight:600}\
.in td{background:var(--in)}td:last-child:not(.n){min-width:11em}p,li{overflow-wrap:anywhere}small{color:var(--faint)}svg{max-width:100%;min-width:33em;height:auto}svg.strip{min-width:44em}";

/// The page of a search for missing effects: one HTML file without scripts.
///
/// `report` is what `kufe discover` writes to `report.json`, with its `pictures` beside: each has a `title` and a `plot`,
/// whose `kind` is `strip` (`runs` along a track, `places`), `scatter` (`x`, `y`, `series`, a `curve` or `zero`) or `maps` (a
/// measured and simulated maps on one grid).
pub fn discovery_page(report: &Value) -> String {
    let report = Data(report);
    let mut out = String::new();
    let _ = writeln!(
        out,
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
<title>What the model lacks</title><style>{STYLE}</style></head><body>"
    );
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
    let _ = write!(
        out,
        "<p><small>kufe {}, seed {}, data: {}</small></p>\n</body></html>\n",
        escape(report.text("version")),
        report.count("seed"),
        escape(report.text("data"))
    );
    out
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
