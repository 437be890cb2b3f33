//! Bars of the gap, and bins with their errors.

use std::fmt::Write as _;

use crate::plot::{number4, unit_of, usual};

use super::data::Data;
use super::diagram::COLOURS;
use super::parts::{WIDTHS, for_both};
use crate::report::page::escape;
use crate::report::sign::sign;

/// Bins that a picture shows.
const SHOWN: usize = 12;

/// Colour of a bar that is neither of the two ends of a comparison.
const NEUTRAL: &str = "#8c8c8c";

/// Most of a picture's width that names of bins take.
const NAMES: f64 = 420.0;

/// A picture's opening tag.
fn open(width: f64, height: usize, label: &str, letters: usize) -> String {
    format!(
        "<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" role=\"img\" aria-label=\"{label}\" font-family=\"system-ui,sans-serif\" font-size=\"{letters}\" fill=\"currentColor\">"
    )
}

fn is_narrow(width: f64) -> bool {
    width < WIDTHS[0]
}

/// ` [unit]`, nothing where there is none.
fn in_brackets(unit: &str) -> String {
    match unit {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    }
}

/// Horizontal bars, each channel in its own scale: before, after, and what the sensors' noise alone would give.
pub fn gap(title: &str, channels: &[Data]) -> String {
    for_both(WIDTHS, |width| gap_drawn(title, channels, width))
}

fn gap_drawn(title: &str, channels: &[Data], width: f64) -> String {
    const BARS: [(&str, &str, &str); 3] = [
        ("before", "before", COLOURS[0]),
        ("after", "after", COLOURS[1]),
        ("noise", "sensor noise", NEUTRAL),
    ];
    drawn(title, ("channel", channels), BARS, width)
}

/// Horizontal bars of three models: as given, base refitted, with the effect. A model that cannot be simulated has no bar.
pub fn models(title: &str, baselines: &[Data]) -> String {
    const BARS: [(&str, &str, &str); 3] = [
        ("as_given", "as given", COLOURS[0]),
        ("refitted", "base refitted", NEUTRAL),
        ("with_effect", "with the effect", COLOURS[1]),
    ];
    for_both(WIDTHS, |width| {
        drawn(title, ("quantity", baselines), BARS, width)
    })
}

/// Three bars for each row, whose name is the field `of`; each bar is a field, its label and its colour.
fn drawn(
    title: &str,
    (of, channels): (&str, &[Data]),
    bars: [(&str, &str, &str); 3],
    width: f64,
) -> String {
    // Names stand left of their bars, on a phone above them.
    let (left, above, step) = match is_narrow(width) {
        true => (92.0, 20, 94),
        false => (212.0, 0, 74),
    };
    let most_wide = width - left - 98.0;
    let title = escape(title);
    let mut svg = open(width, 34 + channels.len() * step, &title, 13);
    let _ = writeln!(
        svg,
        "<text x=\"0\" y=\"16\" font-weight=\"bold\">{title}</text>"
    );
    for (k, c) in channels.iter().enumerate() {
        let y = 30 + k * step;
        let most = bars.map(|(field, ..)| c.number(field));
        let most = most.into_iter().fold(1e-300, f64::max);
        let (_, unit) = usual(1.0, c.text("unit"));
        let _ = write!(
            svg,
            "<text x=\"0\" y=\"{}\">{}{}</text>",
            if above > 0 { y + 14 } else { y + 34 },
            escape(c.text(of)),
            escape(&in_brackets(unit))
        );
        let known = bars.into_iter().filter(|(field, ..)| c.has(field));
        for (row, (field, label, colour)) in known.enumerate() {
            let value = c.number(field);
            let top = y + above + row * 20;
            let wide = most_wide * value / most;
            let _ = writeln!(
                svg,
                "<text x=\"{:.0}\" y=\"{}\" text-anchor=\"end\">{label}</text><rect x=\"{left}\" y=\"{}\" width=\"{wide:.1}\" height=\"14\" fill=\"{colour}\"/><text x=\"{:.1}\" y=\"{}\">{}</text>",
                left - 7.0,
                top + 13,
                top + 2,
                left + 6.0 + wide,
                top + 13,
                number4(usual(value, c.text("unit")).0)
            );
        }
    }
    svg.push_str("</svg>");
    svg
}

/// Mean residuals with two standard errors, strongest bins first.
pub fn bins(bins: &[Data]) -> String {
    let shown = &bins[..bins.len().min(SHOWN)];
    for_both(WIDTHS, |width| bins_drawn(shown, width))
}

fn bins_drawn(shown: &[Data], width: f64) -> String {
    let narrow = is_narrow(width);
    let named = |bin: &Data| format!("{}: {}", bin.text("channel"), range(*bin));
    let longest = shown.iter().map(|bin| named(bin).chars().count()).max();
    // The names' end, and the middle and half of what is left beside them; on a phone names stand above.
    let (names, step, first) = match narrow {
        true => (0.0, 40, 66),
        false => ((7.0 * longest.unwrap_or(0) as f64).min(NAMES), 22, 36),
    };
    let half = 0.5 * (width - 10.0 - names);
    let middle = names + 5.0 + half;
    let mut svg = open(
        width,
        first - 6 + step * shown.len(),
        "mean residual by bin",
        12,
    );
    let title = [
        "mean residual with two standard errors,",
        "relative to the largest of its channel",
    ];
    let _ = match narrow {
        true => writeln!(
            svg,
            "<text x=\"0\" y=\"14\">{}</text><text x=\"0\" y=\"30\">{}</text>",
            title[0], title[1]
        ),
        false => writeln!(svg, "<text x=\"0\" y=\"14\">{}</text>", title.join(" ")),
    };
    for (k, b) in shown.iter().enumerate() {
        let largest = shown
            .iter()
            .filter(|o| o.text("channel") == b.text("channel"))
            .fold(1e-300_f64, |m, o| {
                m.max(o.number("mean").abs() + 2.0 * o.number("error"))
            });
        let y = first + step * k;
        let x = |v: f64| middle + half * v / largest;
        let (at, anchor, below) = match narrow {
            true => (0.0, "start", y - 12),
            false => (names, "end", y + 4),
        };
        let _ = writeln!(
            svg,
            "<text x=\"{at}\" y=\"{below}\" text-anchor=\"{anchor}\">{}</text><line x1=\"{middle}\" x2=\"{middle}\" y1=\"{}\" y2=\"{}\" stroke=\"currentColor\" opacity=\"0.4\"/>\
<line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y}\" y2=\"{y}\" stroke=\"{}\" stroke-width=\"2\"/><circle cx=\"{:.1}\" cy=\"{y}\" r=\"4\" fill=\"{}\"/>",
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
    svg.push_str("</svg>");
    svg
}

/// A channel's mean residual run by run, sessions side by side on alternate ground.
pub fn runs(of: Data) -> String {
    for_both(WIDTHS, |width| runs_drawn(of, width))
}

fn runs_drawn(of: Data, width: f64) -> String {
    const LEFT: f64 = 64.0;
    const HALF: f64 = 52.0;
    // The legend stands beside the title, on a phone below it.
    let lower = if is_narrow(width) { 18.0 } else { 0.0 };
    let (middle, wide) = (86.0 + lower, width - LEFT - 6.0);
    let runs = of.list("runs");
    let largest = runs.iter().fold(1e-300_f64, |m, r| {
        m.max(r.number("before").abs()).max(r.number("after").abs())
    });
    let step = wide / of.list("runs").len().max(1) as f64;
    let y = |value: f64| middle - HALF * value / largest;
    let (top, unit) = usual(largest, of.text("unit"));
    let title = escape(&format!(
        "mean residual {}{}",
        of.text("channel"),
        in_brackets(unit)
    ));
    let mut svg = open(width, 172 + lower as usize, &format!("{title} by run"), 12);
    let legend = match is_narrow(width) {
        true => LEFT + 4.0,
        false => width - 170.0,
    };
    let _ = writeln!(
        svg,
        "<text x=\"0\" y=\"14\">{title}</text>\
<circle cx=\"{legend}\" cy=\"{4}\" r=\"4\" fill=\"none\" stroke=\"{0}\" stroke-width=\"1.6\"/><text x=\"{2}\" y=\"{5}\">before</text><circle cx=\"{3}\" cy=\"{4}\" r=\"4\" fill=\"{1}\"/><text x=\"{6}\" y=\"{5}\">after</text>",
        COLOURS[0],
        COLOURS[1],
        legend + 10.0,
        legend + 80.0,
        10.0 + lower,
        14.0 + lower,
        legend + 90.0
    );
    for (value, told) in [(largest, top), (0.0, 0.0), (-largest, -top)] {
        let _ = writeln!(
            svg,
            "<text x=\"{:.0}\" y=\"{:.1}\" text-anchor=\"end\">{}</text><line x1=\"{LEFT}\" x2=\"{}\" y1=\"{4:.1}\" y2=\"{4:.1}\" stroke=\"currentColor\" opacity=\"0.3\"/>",
            LEFT - 6.0,
            y(value) + 4.0,
            number4(told),
            LEFT + wide,
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
    let room = wide / sessions.len().max(1) as f64;
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
                "<rect x=\"{from:.1}\" y=\"{}\" width=\"{width:.1}\" height=\"120\" opacity=\"0.07\"/>",
                26.0 + lower
            );
        }
        if k % every == 0 {
            let _ = write!(
                svg,
                "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                from + 0.5 * width,
                162.0 + lower,
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
    let _ = write!(
        svg,
        "<text x=\"0\" y=\"{}\">session</text></svg>",
        162.0 + lower
    );
    svg
}

/// `column from to unit`; a place is one on a track, as `s_m on east`.
pub fn range(bin: Data) -> String {
    let column = bin.text("column").split_once(' ');
    let unit = sign(&unit_of(
        column.map_or(bin.text("column"), |(name, _)| name),
    ));
    let (from, shown) = usual(bin.number("from"), &unit);
    let (to, _) = usual(bin.number("to"), &unit);
    format!(
        "{} {} to {} {shown}",
        bin.text("column"),
        number4(from),
        number4(to)
    )
    .trim_end()
    .to_owned()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn bins_have_the_units_of_their_columns_on_a_track_too() {
        for (column, told) in [
            ("s_m on east", "s_m on east 10.00 to 20.00 m"),
            ("ax_mps2", "ax_mps2 10.00 to 20.00 m/s²"),
            ("humidity", "humidity 10.00 to 20.00"),
        ] {
            let bin = json!({ "column": column, "from": 10.0, "to": 20.0 });
            assert_eq!(range(Data(&bin)), told);
        }
    }
}
