//! Bars of the gap, and bins with their errors.

use std::fmt::Write as _;

use kufe_plot::{number4, unit_of, usual};

use super::data::Data;
use super::diagram::COLOURS;
use crate::page::escape;

/// Bins that a picture shows.
const SHOWN: usize = 12;

/// Most of a picture's width that names of bins take.
const NAMES: f64 = 420.0;

/// Horizontal bars, each channel in its own scale: before, after, and what the sensors' noise alone would give.
pub fn gap(title: &str, channels: &[Data]) -> String {
    let height = 34 + channels.len() * 74;
    let mut svg = format!(
        "<svg viewBox=\"0 0 640 {height}\" width=\"640\" role=\"img\" aria-label=\"{0}\" font-family=\"system-ui,sans-serif\" font-size=\"13\" fill=\"currentColor\"><text x=\"0\" y=\"16\" font-weight=\"bold\">{0}</text>\n",
        escape(title)
    );
    for (k, c) in channels.iter().enumerate() {
        let y = 30 + k * 74;
        let most = c
            .number("before")
            .max(c.number("after"))
            .max(c.number("noise"))
            .max(1e-300);
        let (_, unit) = usual(1.0, c.text("unit"));
        let unit = if unit.is_empty() {
            String::new()
        } else {
            format!(" [{unit}]")
        };
        let _ = write!(
            svg,
            "<text x=\"0\" y=\"{}\">{}{}</text>",
            y + 34,
            escape(c.text("channel")),
            escape(&unit)
        );
        for (row, (label, value, colour)) in [
            ("before", c.number("before"), COLOURS[0]),
            ("after", c.number("after"), COLOURS[1]),
            ("sensor noise", c.number("noise"), "#8c8c8c"),
        ]
        .into_iter()
        .enumerate()
        {
            let top = y + row * 20;
            let width = 330.0 * value / most;
            let _ = writeln!(
                svg,
                "<text x=\"205\" y=\"{}\" text-anchor=\"end\">{label}</text><rect x=\"212\" y=\"{}\" width=\"{width:.1}\" height=\"14\" fill=\"{colour}\"/><text x=\"{:.1}\" y=\"{}\">{}</text>",
                top + 13,
                top + 2,
                218.0 + width,
                top + 13,
                number4(usual(value, c.text("unit")).0)
            );
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// Mean residuals with two standard errors, strongest bins first.
pub fn bins(bins: &[Data]) -> String {
    let shown = &bins[..bins.len().min(SHOWN)];
    let height = 30 + 22 * shown.len();
    let named = |bin: &Data| format!("{}: {}", bin.text("channel"), range(*bin));
    let longest = shown.iter().map(|bin| named(bin).chars().count()).max();
    // The names' end, and the middle and half of what is left beside them.
    let names = (7.0 * longest.unwrap_or(0) as f64).min(NAMES);
    let half = 0.5 * (630.0 - names);
    let middle = names + 5.0 + half;
    let mut svg = format!(
        "<svg viewBox=\"0 0 640 {height}\" width=\"640\" role=\"img\" aria-label=\"mean residual by bin\" font-family=\"system-ui,sans-serif\" font-size=\"12\" fill=\"currentColor\"><text x=\"0\" y=\"14\">mean residual with two standard errors, relative to the largest of its channel</text>\n"
    );
    for (k, b) in shown.iter().enumerate() {
        let largest = shown
            .iter()
            .filter(|o| o.text("channel") == b.text("channel"))
            .fold(1e-300_f64, |m, o| {
                m.max(o.number("mean").abs() + 2.0 * o.number("error"))
            });
        let y = 36 + 22 * k;
        let x = |v: f64| middle + half * v / largest;
        let _ = writeln!(
            svg,
            "<text x=\"{names}\" y=\"{}\" text-anchor=\"end\">{}</text><line x1=\"{middle}\" x2=\"{middle}\" y1=\"{}\" y2=\"{}\" stroke=\"currentColor\" opacity=\"0.4\"/>\
<line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y}\" y2=\"{y}\" stroke=\"{}\" stroke-width=\"2\"/><circle cx=\"{:.1}\" cy=\"{y}\" r=\"4\" fill=\"{}\"/>",
            y + 4,
            escape(&named(b)),
            y - 10,
            y + 12,
            x(b.number("mean") - 2.0 * b.number("error")),
            x(b.number("mean") + 2.0 * b.number("error")),
            COLOURS[1],
            x(b.number("mean")),
            COLOURS[0]
        );
    }
    svg.push_str("</svg>\n");
    svg
}

/// A channel's mean residual run by run, sessions side by side on alternate ground.
pub fn runs(of: Data) -> String {
    const LEFT: f64 = 64.0;
    const WIDE: f64 = 570.0;
    const MIDDLE: f64 = 86.0;
    const HALF: f64 = 52.0;
    let runs = of.list("runs");
    let largest = runs.iter().fold(1e-300_f64, |m, r| {
        m.max(r.number("before").abs()).max(r.number("after").abs())
    });
    let step = WIDE / of.list("runs").len().max(1) as f64;
    let y = |value: f64| MIDDLE - HALF * value / largest;
    let (top, unit) = usual(largest, of.text("unit"));
    let unit = if unit.is_empty() {
        String::new()
    } else {
        format!(" [{unit}]")
    };
    let title = format!("mean residual {}{unit}", of.text("channel"));
    let mut svg = format!(
        "<svg viewBox=\"0 0 640 172\" width=\"640\" role=\"img\" aria-label=\"{0} by run\" font-family=\"system-ui,sans-serif\" font-size=\"12\" fill=\"currentColor\"><text x=\"0\" y=\"14\">{0}</text>\
<circle cx=\"470\" cy=\"10\" r=\"4\" fill=\"none\" stroke=\"{1}\" stroke-width=\"1.6\"/><text x=\"480\" y=\"14\">before</text><circle cx=\"550\" cy=\"10\" r=\"4\" fill=\"{2}\"/><text x=\"560\" y=\"14\">after</text>\n",
        escape(&title),
        COLOURS[0],
        COLOURS[1]
    );
    for (value, told) in [(largest, top), (0.0, 0.0), (-largest, -top)] {
        let _ = writeln!(
            svg,
            "<text x=\"{:.0}\" y=\"{:.1}\" text-anchor=\"end\">{}</text><line x1=\"{LEFT}\" x2=\"{}\" y1=\"{4:.1}\" y2=\"{4:.1}\" stroke=\"currentColor\" opacity=\"0.3\"/>",
            LEFT - 6.0,
            y(value) + 4.0,
            number4(told),
            LEFT + WIDE,
            y(value)
        );
    }
    let sessions: Vec<&[Data]> = runs
        .chunk_by(|a, b| a.text("session") == b.text("session"))
        .collect();
    // Names that would run into each other are left out, every second or third.
    let longest = sessions
        .iter()
        .map(|s| s[0].text("session").chars().count())
        .max();
    let room = WIDE / sessions.len().max(1) as f64;
    let every = (7.0 * (longest.unwrap_or(0) + 1) as f64 / room)
        .ceil()
        .max(1.0) as usize;
    let mut first = 0;
    for (k, session) in sessions.iter().enumerate() {
        let from = LEFT + step * first as f64;
        let width = step * session.len() as f64;
        if k % 2 == 1 {
            let _ = write!(
                svg,
                "<rect x=\"{from:.1}\" y=\"26\" width=\"{width:.1}\" height=\"120\" opacity=\"0.07\"/>"
            );
        }
        if k % every == 0 {
            let _ = write!(
                svg,
                "<text x=\"{:.1}\" y=\"162\" text-anchor=\"middle\">{}</text>",
                from + 0.5 * width,
                escape(session[0].text("session"))
            );
        }
        for (i, run) in session.iter().enumerate() {
            let x = from + step * (i as f64 + 0.5);
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{:.1}\" r=\"4\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"/><circle cx=\"{x:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{}\"><title>{}</title></circle>",
                y(run.number("before")),
                COLOURS[0],
                y(run.number("after")),
                COLOURS[1],
                escape(run.text("run"))
            );
        }
        first += session.len();
    }
    let _ = writeln!(svg, "<text x=\"0\" y=\"162\">session</text></svg>");
    svg
}

/// `column from to unit`.
pub fn range(bin: Data) -> String {
    let unit = unit_of(bin.text("column"));
    let (from, shown) = usual(bin.number("from"), unit);
    let (to, _) = usual(bin.number("to"), unit);
    format!(
        "{} {} to {} {shown}",
        bin.text("column"),
        number4(from),
        number4(to)
    )
    .trim_end()
    .to_owned()
}
