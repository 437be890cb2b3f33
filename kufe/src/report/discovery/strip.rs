//! What is left along a track, run by run, before and after.

use std::fmt::Write as _;

use crate::plot::{axis_ticks, number4, tick_text};

use super::data::Data;
use crate::report::page::escape;

/// Widths of a page and of a phone, whose letters stay as large.
const WIDTHS: [f64; 2] = [940.0, 470.0];
const LEFT: f64 = 64.0;
/// Top edges of the two panels, and their height.
const TOPS: [f64; 2] = [44.0, 184.0];
const HIGH: f64 = 118.0;
/// Ticks upwards that leave three numbers on a scale about 0.
const TICKS: usize = 5;

/// Two panels over the distance along the track: every run in its session's colour and the mean of all, before and after; places of
/// effects are shaded. Both panels have the same scale. Drawn twice: the page shows the one that fits.
pub fn strip(plot: Data) -> String {
    let [page, phone] = WIDTHS.map(|width| drawn(plot, width));
    format!("<div class=\"page\">{page}</div><div class=\"phone\">{phone}</div>")
}

fn drawn(plot: Data, width: f64) -> String {
    let runs = plot.list("runs");
    let (from, step) = (plot.number("from_m"), plot.number("step_m"));
    let panels = ["before", "after"]
        .map(|key| -> Vec<Vec<f64>> { runs.iter().map(|run| run.numbers(key)).collect() });
    let count = panels[0].iter().map(Vec::len).max().unwrap_or(0);
    let to = from + step * count as f64;
    let most = panels
        .iter()
        .flatten()
        .flatten()
        .filter(|v| v.is_finite())
        .fold(1e-300_f64, |m, v| m.max(v.abs()));
    let scale = Scale {
        from,
        to,
        most: 1.05 * most,
        right: width - 12.0,
    };
    let mut sessions: Vec<&str> = runs.iter().map(|run| run.text("session")).collect();
    let mut seen = std::collections::HashSet::new();
    sessions.retain(|session| seen.insert(*session));
    let mut svg = format!(
        "<svg viewBox=\"0 0 {width} {3}\" width=\"{width}\" role=\"img\" aria-label=\"what is left along track {0}\" font-family=\"system-ui,sans-serif\" font-size=\"13\" fill=\"currentColor\">\n\
<text x=\"8\" y=\"14\">measured less simulated, {1} [{2}], along track {0}, by session</text>\n",
        escape(plot.text("track")),
        escape(plot.text("channel")),
        escape(plot.text("unit")),
        scale.legend() + 6.0
    );
    for (top, (name, panel)) in TOPS
        .into_iter()
        .zip(["before", "after"].iter().zip(&panels))
    {
        scale.frame(&mut svg, top, name);
        for place in plot.list("places") {
            scale.place(&mut svg, top, place);
        }
        for (run, values) in runs.iter().zip(panel) {
            let session = sessions.iter().position(|s| *s == run.text("session"));
            let _ = writeln!(
                svg,
                "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"0.9\" opacity=\"0.6\"><title>{}</title></path>",
                scale.path(values, step, top),
                colour(session.unwrap_or(0), sessions.len()),
                escape(run.text("run"))
            );
        }
        let _ = writeln!(
            svg,
            "<path d=\"{}\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.8\"/>",
            scale.path(&means(panel, count), step, top)
        );
    }
    scale.distance(&mut svg);
    scale.sessions(&mut svg, &sessions);
    svg.push_str("</svg>\n");
    svg
}

/// Ranges of both panels.
struct Scale {
    from: f64,
    to: f64,
    most: f64,
    /// Right edge of the panels.
    right: f64,
}

impl Scale {
    fn x(&self, s: f64) -> f64 {
        LEFT + (self.right - LEFT) * (s - self.from) / (self.to - self.from)
    }

    fn y(&self, value: f64, top: f64) -> f64 {
        top + 0.5 * HIGH * (1.0 - value / self.most)
    }

    fn frame(&self, svg: &mut String, top: f64, name: &str) {
        let _ = writeln!(
            svg,
            "<rect x=\"{LEFT}\" y=\"{top}\" width=\"{:.1}\" height=\"{HIGH}\" fill=\"none\" stroke=\"currentColor\" opacity=\"0.4\"/>\
<text x=\"{:.1}\" y=\"{:.1}\" font-weight=\"bold\">{name}</text>",
            self.right - LEFT,
            LEFT + 6.0,
            top + 16.0
        );
        let right = self.right;
        for tick in axis_ticks(-self.most, self.most, TICKS) {
            let y = self.y(tick, top);
            let _ = writeln!(
                svg,
                "<line x1=\"{LEFT}\" x2=\"{right}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"currentColor\" opacity=\"0.15\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                LEFT - 6.0,
                y + 4.0,
                tick_text(tick, 2.0 * self.most)
            );
        }
    }

    /// A shaded place with its effect's name above; at least two pixels wide.
    fn place(&self, svg: &mut String, top: f64, place: Data) {
        let (from, to) = (self.x(place.number("from")), self.x(place.number("to")));
        let wide = (to - from).max(2.0);
        let _ = writeln!(
            svg,
            "<rect x=\"{from:.1}\" y=\"{top}\" width=\"{wide:.1}\" height=\"{HIGH}\" fill=\"#e0a800\" opacity=\"0.3\"><title>{0}, {1} to {2} m</title></rect>",
            escape(place.text("effect")),
            number4(place.number("from")),
            number4(place.number("to"))
        );
        if top == TOPS[0] {
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"12\">{}</text>",
                (from + 0.5 * wide).clamp(LEFT + 40.0, self.right - 40.0),
                top - 5.0,
                escape(place.text("effect"))
            );
        }
    }

    /// A line through the stretches' means, broken where there is none.
    fn path(&self, values: &[f64], step: f64, top: f64) -> String {
        let mut path = String::new();
        let mut drawing = false;
        for (k, value) in values.iter().enumerate() {
            if value.is_finite() {
                let x = self.x(self.from + step * (k as f64 + 0.5));
                let word = if drawing { 'L' } else { 'M' };
                let _ = write!(path, "{word}{x:.0} {:.0}", self.y(*value, top));
            }
            drawing = value.is_finite();
        }
        path
    }

    fn distance(&self, svg: &mut String) {
        let bottom = TOPS[1] + HIGH;
        for tick in axis_ticks(self.from, self.to, if self.is_narrow() { 8 } else { 10 }) {
            let x = self.x(tick);
            let _ = writeln!(
                svg,
                "<line x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{bottom}\" y2=\"{}\" stroke=\"currentColor\"/><text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                bottom + 5.0,
                bottom + 19.0,
                tick_text(tick, self.to - self.from)
            );
        }
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">distance along the track [m]</text>",
            self.right,
            bottom + 38.0
        );
    }

    /// Where the legend stands: beside the name of the axis, or where there is no room below it.
    fn legend(&self) -> f64 {
        let beside = TOPS[1] + HIGH + 38.0;
        match self.is_narrow() {
            true => beside + 22.0,
            false => beside,
        }
    }

    fn is_narrow(&self) -> bool {
        self.right < 0.75 * WIDTHS[0]
    }

    /// The mean's and the sessions' colours, as many as there is room for.
    fn sessions(&self, svg: &mut String, sessions: &[&str]) {
        let y = self.legend();
        let entry = |svg: &mut String, x: f64, colour: &str, name: &str| {
            let _ = writeln!(
                svg,
                "<line x1=\"{x}\" x2=\"{}\" y1=\"{2}\" y2=\"{2}\" stroke=\"{colour}\" stroke-width=\"2\"/><text x=\"{1}\" y=\"{y}\">{3}</text>",
                x + 14.0,
                x + 18.0,
                y - 4.0,
                escape(name)
            );
        };
        let left = if self.is_narrow() { 8.0 } else { LEFT };
        entry(svg, left, "currentColor", "mean of all runs");
        let name_of_axis = if self.is_narrow() { 0.0 } else { 190.0 };
        let end = self.right - name_of_axis - 120.0;
        let mut x = left + 140.0;
        for (k, session) in sessions.iter().enumerate() {
            let wide = 34.0 + 7.5 * session.chars().count() as f64;
            let last = k + 1 == sessions.len();
            if x + wide > end + if last { 120.0 } else { 0.0 } {
                let more = sessions.len() - k;
                let _ = writeln!(svg, "<text x=\"{x}\" y=\"{y}\">and {more} sessions</text>");
                break;
            }
            entry(svg, x, &colour(k, sessions.len()), session);
            x += wide;
        }
    }
}

/// Means over runs, stretch by stretch.
fn means(runs: &[Vec<f64>], count: usize) -> Vec<f64> {
    let mean = |k: usize| {
        let values = runs.iter().filter_map(|run| run.get(k));
        let (sum, n) = values
            .filter(|v| v.is_finite())
            .fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
        sum / n
    };
    (0..count).map(mean).collect()
}

/// The `k`-th of `count` hues around the circle, in the middle of light and dark.
fn colour(k: usize, count: usize) -> String {
    let hue = 200.0 + 360.0 * k as f64 / count.max(1) as f64;
    format!("hsl({:.0} 60% 50%)", hue % 360.0)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// A scale about 0 has three numbers wherever it ends, and names do not run out of a phone's picture.
    #[test]
    fn scales_have_three_numbers_and_legends_room() {
        for largest in [1.0, 2.3, 3.9, 4.1, 7.7, 9.9] {
            assert!(axis_ticks(-largest, largest, TICKS).len() >= 3, "{largest}");
        }
        let runs: Vec<_> = (0..30)
            .map(|k| json!({ "run": "r", "session": format!("session {k}"), "before": [1.0], "after": [0.5] }))
            .collect();
        let plot = json!({ "from_m": 0.0, "step_m": 10.0, "runs": runs, "places": [] });
        for width in WIDTHS {
            let svg = drawn(Data(&plot), width);
            let told = svg.matches(">session ").count();
            assert!(told > 0 && svg.contains(&format!(">and {} sessions<", 30 - told)));
            let places = svg.split("<text x=\"").skip(1);
            let x = places.filter_map(|text| text.split('"').next()?.parse::<f64>().ok());
            assert!(x.fold(0.0, f64::max) <= width - 12.0);
        }
    }

    /// Four stretches of 10 m, one without a value: the line is broken there, and its ends lie where their values say.
    #[test]
    fn a_run_is_drawn_where_it_has_values_and_places_where_they_are() {
        let plot = json!({
            "channel": "side", "unit": "N", "track": "e<st", "from_m": 100.0, "step_m": 10.0,
            "places": [{ "effect": "wall-contact", "from": 110.0, "to": 120.0 }],
            "runs": [
                { "run": "A-1", "session": "d1", "before": [0.0, null, 100.0, 0.0], "after": [0.0, null, 0.0, 0.0] },
            ],
        });
        let svg = strip(Data(&plot));
        let wide = WIDTHS[0] - 12.0 - LEFT;
        let first = format!("M{:.0} {:.0}M", LEFT + 0.125 * wide, TOPS[0] + 0.5 * HIGH);
        assert!(svg.contains(&first), "{svg}");
        let peak = format!(
            "M{:.0} {:.0}L",
            LEFT + 0.625 * wide,
            TOPS[0] + 0.5 * HIGH * (1.0 - 1.0 / 1.05)
        );
        assert!(svg.contains(&peak), "{svg}");
        let place = format!("<rect x=\"{:.1}\"", LEFT + 0.25 * wide);
        assert_eq!(svg.matches(&place).count(), 2);
        assert!(svg.contains("e&lt;st") && !svg.contains("NaN"));
        assert!(svg.contains("by session</text>"), "what d1 is the name of");
    }
}
