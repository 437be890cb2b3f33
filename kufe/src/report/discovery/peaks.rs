//! Peak pressures of measurements, measured and simulated, a line each.

use std::fmt::Write as _;

use crate::plot::{axis_ticks, number4, tick_text};

use super::data::Data;
use super::diagram::COLOURS;
use super::parts::for_both;
use crate::report::page::escape;

/// Widths on a page and on a phone, where names stand above their lines.
const WIDTHS: [f64; 2] = [940.0, 400.0];
/// Where the first line stands.
const TOP: f64 = 44.0;

/// The peaks of `rows`, each with `name`, `measured`, `sd` and `before` [Pa], `after` where something was added, `not_seen`.
pub fn peaks(plot: Data) -> String {
    let rows = plot.list("rows");
    for_both(WIDTHS, |width| drawn(&rows, width))
}

fn drawn(rows: &[Data], width: f64) -> String {
    let narrow = width < WIDTHS[0];
    let longest = rows.iter().map(|row| named(*row).chars().count()).max();
    let (left, step) = match narrow {
        true => (8.0, 38.0),
        false => (7.2 * longest.unwrap_or(0) as f64 + 12.0, 22.0),
    };
    let right = width - 14.0;
    let ends = rows.iter().flat_map(|row| {
        let [measured, sd, before, after] =
            ["measured", "sd", "before", "after"].map(|key| 1e-6 * row.number(key));
        [measured - 2.0 * sd, measured + 2.0 * sd, before, after]
    });
    let (low, high) = ends
        .filter(|end| end.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), end| {
            (l.min(end), h.max(end))
        });
    let margin = (0.04 * (high - low)).max(1e-3 * high.abs());
    let (low, high) = (low - margin, high + margin);
    let x = |pressure: f64| left + (right - left) * (pressure - low) / (high - low);
    let bottom = TOP + step * rows.len() as f64;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {width} {0}\" width=\"{width}\" role=\"img\" aria-label=\"peak pressure by row\" font-family=\"system-ui,sans-serif\" font-size=\"12\" fill=\"currentColor\">\n",
        bottom + 46.0
    );
    key(&mut svg, left, rows.iter().any(|row| row.has("after")));
    let frame_top = TOP - 12.0;
    let _ = writeln!(
        svg,
        "<rect x=\"{left:.1}\" y=\"{frame_top}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"currentColor\" opacity=\"0.4\"/>",
        right - left,
        bottom - frame_top
    );
    for tick in axis_ticks(low, high, if narrow { 6 } else { 10 }) {
        let at = x(tick);
        let _ = writeln!(
            svg,
            "<line x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{frame_top}\" y2=\"{:.1}\" stroke=\"currentColor\" opacity=\"0.15\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            bottom + 5.0,
            bottom + 19.0,
            tick_text(tick, high - low)
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">peak pressure [MPa]</text>",
        0.5 * (left + right),
        bottom + 38.0
    );
    for (k, row) in rows.iter().enumerate() {
        let y = TOP + step * k as f64 + if narrow { 18.0 } else { 0.0 };
        let (at, anchor, below) = match narrow {
            true => (left + 4.0, "start", y - 10.0),
            false => (left - 8.0, "end", y + 4.0),
        };
        let _ = writeln!(
            svg,
            "<text x=\"{at:.1}\" y=\"{below}\" text-anchor=\"{anchor}\">{}</text>",
            escape(&named(*row))
        );
        line(&mut svg, *row, &x, y);
    }
    svg.push_str("</svg>");
    svg
}

/// The row's name, and whether the search had not seen it.
fn named(row: Data) -> String {
    match row.is("not_seen") {
        true => format!("{}, not seen", row.text("name")),
        false => row.text("name").to_owned(),
    }
}

fn key(svg: &mut String, left: f64, has_after: bool) {
    let mut x = left + 6.0;
    for (k, (name, wide)) in [("measured", 84.0), ("before", 66.0), ("after", 60.0)]
        .into_iter()
        .take(if has_after { 3 } else { 2 })
        .enumerate()
    {
        mark(svg, k, x, 12.0);
        let _ = write!(svg, "<text x=\"{:.1}\" y=\"16\">{name}</text>", x + 9.0);
        x += wide;
    }
}

/// Measured: a line across; simulated before: a ring, after: a disc.
fn mark(svg: &mut String, kind: usize, x: f64, y: f64) {
    let _ = match kind {
        0 => write!(
            svg,
            "<line x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{:.1}\" y2=\"{:.1}\" stroke=\"currentColor\" stroke-width=\"2\"/>",
            y - 7.0,
            y + 7.0
        ),
        1 => write!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>",
            COLOURS[0]
        ),
        _ => write!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{}\"/>",
            COLOURS[1]
        ),
    };
}

fn line(svg: &mut String, row: Data, x: &dyn Fn(f64) -> f64, y: f64) {
    let [measured, sd, before, after] =
        ["measured", "sd", "before", "after"].map(|key| 1e-6 * row.number(key));
    let mut message = format!("measured {}, before {}", number4(measured), number4(before));
    if after.is_finite() {
        let _ = write!(message, ", after {}", number4(after));
    }
    let _ = write!(
        svg,
        "<g><title>{} [MPa]</title><line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"currentColor\" stroke-width=\"1.5\"/>",
        message,
        x(measured - 2.0 * sd),
        x(measured + 2.0 * sd)
    );
    mark(svg, 0, x(measured), y);
    mark(svg, 1, x(before), y);
    if after.is_finite() {
        mark(svg, 2, x(after), y);
    }
    svg.push_str("</g>\n");
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn peaks_stand_where_their_pressures_say_on_both_widths() {
        let plot = json!({ "rows": [
            { "name": "row 2", "measured": 10e6, "sd": 0.0, "before": 20e6, "after": 10e6 },
            { "name": "row <3>", "not_seen": true, "measured": 30e6, "sd": 0.0, "before": 20e6, "after": 30e6 },
        ] });
        let svg = peaks(Data(&plot));
        // The same pressures lie one below the other, the larger ones further right.
        let phone = &svg[svg.find("class=\"phone\"").expect("a phone's picture")..];
        let x = |k: usize| -> f64 {
            let rings = phone.split("fill=\"none\" stroke=\"#d0703c\"");
            let ring = rings
                .take(k + 1)
                .last()
                .and_then(|r| r.rsplit("cx=\"").next());
            let at = ring.and_then(|r| r.split('"').next());
            at.and_then(|at| at.parse().ok()).expect("a place")
        };
        assert_eq!(x(1), x(2));
        assert_eq!(svg.matches("row &lt;3&gt;, not seen").count(), 2);
        assert!(svg.contains("peak pressure [MPa]") && !svg.contains("NaN"));
    }

    #[test]
    fn without_an_effect_nothing_stands_after() {
        let plot =
            json!({ "rows": [{ "name": "row 2", "measured": 1e7, "sd": 1e5, "before": 1.1e7 }] });
        let svg = peaks(Data(&plot));
        assert!(!svg.contains(">after<") && !svg.contains(COLOURS[1]));
    }
}
