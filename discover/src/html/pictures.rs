//! Bars of the gap, and bins with their errors.

use std::fmt::Write as _;

use super::number::{escape, number4, unit_of, usual};
use crate::plot::COLOURS;
use crate::report::{Bin, ChannelGap};

/// Bins that a picture shows.
const SHOWN: usize = 12;

/// Horizontal bars, each channel in its own scale: before, after, and what the sensors' noise alone would give.
pub fn gap(title: &str, channels: &[ChannelGap]) -> String {
    let height = 34 + channels.len() * 74;
    let mut svg = format!(
        "<svg viewBox=\"0 0 640 {height}\" width=\"640\" role=\"img\" aria-label=\"{0}\" font-family=\"system-ui,sans-serif\" font-size=\"13\" fill=\"currentColor\"><text x=\"0\" y=\"16\" font-weight=\"bold\">{0}</text>\n",
        escape(title)
    );
    for (k, c) in channels.iter().enumerate() {
        let y = 30 + k * 74;
        let most = c.before.max(c.after).max(c.noise).max(1e-300);
        let (_, unit) = usual(1.0, &c.unit);
        let unit = if unit.is_empty() {
            String::new()
        } else {
            format!(" [{unit}]")
        };
        let _ = write!(
            svg,
            "<text x=\"0\" y=\"{}\">{}{}</text>",
            y + 34,
            escape(&c.channel),
            escape(&unit)
        );
        for (row, (label, value, colour)) in [
            ("before", c.before, COLOURS[0]),
            ("after", c.after, COLOURS[1]),
            ("sensor noise", c.noise, "#8c8c8c"),
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
                number4(usual(value, &c.unit).0)
            );
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// Mean residuals with two standard errors, strongest bins first.
pub fn bins(bins: &[Bin]) -> String {
    let shown = &bins[..bins.len().min(SHOWN)];
    let height = 30 + 22 * shown.len();
    let mut svg = format!(
        "<svg viewBox=\"0 0 640 {height}\" width=\"640\" role=\"img\" aria-label=\"mean residual by bin\" font-family=\"system-ui,sans-serif\" font-size=\"12\" fill=\"currentColor\"><text x=\"0\" y=\"14\">mean residual with two standard errors, relative to the largest of its channel</text>\n"
    );
    for (k, b) in shown.iter().enumerate() {
        let largest = shown
            .iter()
            .filter(|o| o.channel == b.channel)
            .fold(1e-300_f64, |m, o| m.max(o.mean.abs() + 2.0 * o.error));
        let y = 36 + 22 * k;
        let x = |v: f64| 475.0 + 160.0 * v / largest;
        let _ = writeln!(
            svg,
            "<text x=\"305\" y=\"{}\" text-anchor=\"end\">{}: {}</text><line x1=\"475\" x2=\"475\" y1=\"{}\" y2=\"{}\" stroke=\"currentColor\" opacity=\"0.4\"/>\
<line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y}\" y2=\"{y}\" stroke=\"{}\" stroke-width=\"2\"/><circle cx=\"{:.1}\" cy=\"{y}\" r=\"4\" fill=\"{}\"/>",
            y + 4,
            escape(&b.channel),
            escape(&range(b)),
            y - 10,
            y + 12,
            x(b.mean - 2.0 * b.error),
            x(b.mean + 2.0 * b.error),
            COLOURS[1],
            x(b.mean),
            COLOURS[0]
        );
    }
    svg.push_str("</svg>\n");
    svg
}

/// `column from to unit`.
pub fn range(bin: &Bin) -> String {
    let unit = unit_of(&bin.column);
    let (from, shown) = usual(bin.from, unit);
    let (to, _) = usual(bin.to, unit);
    format!(
        "{} {} to {} {shown}",
        bin.column,
        number4(from),
        number4(to)
    )
    .trim_end()
    .to_owned()
}
