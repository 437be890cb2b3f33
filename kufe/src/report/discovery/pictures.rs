//! Pictures of the page. Each is drawn for a page and for a phone.

use crate::plot::{
    AFTER, Axis, BEFORE, Colour, ColourBar, Figure, INK, Layer, Mark, Panel, Point, Symbol, Ticks,
    diverging, number4, unit_of, usual,
};
use crate::report::discovery::parts::{channel_label, range, shown};
use crate::report::sign::sign;
use crate::results::finding::{
    Baseline, Bin, ByRun, ChannelGap, Maps, Peak, Plot, Scatter, Strip, StripRun,
};

/// Widths of a map, of a picture next to another, of one as wide as the page, and of one on a
/// phone.
const MAP: f64 = 290.0;
const HALF: f64 = 480.0;
const WHOLE: f64 = 940.0;
const PHONE: f64 = 400.0;

/// Colour of what is neither before nor after.
const NEUTRAL: Colour = Colour::new(140, 140, 140);
/// Colour of places of effects.
const PLACES: Colour = Colour::new(224, 168, 0).alpha(0.3);
/// Bins that a picture shows, and sessions that a legend names.
const MOST_BINS: usize = 12;
const MOST_SESSIONS: usize = 10;

fn figure(width: f64, label: &str) -> Figure {
    Figure {
        letters: 13.0,
        label: label.to_owned(),
        ..Figure::new(width, "")
    }
}

/// A picture for a page and for a phone: the page shows the one that fits.
fn for_both(page: f64, drawn: impl Fn(f64) -> Figure) -> String {
    let [page, phone] = [page, PHONE].map(|width| drawn(width).svg());
    format!("<div class=\"page\">{page}</div><div class=\"phone\">{phone}</div>\n")
}

/// The picture of a plot; a diagram has half the width of the page where it is one of a pair.
pub fn picture(plot: &Plot, is_one_of_a_pair: bool) -> String {
    match plot {
        Plot::Scatter(plot) => {
            let drawn = |width| figure(width, &plot.label).row(230.0, [diagram(plot)]);
            match is_one_of_a_pair {
                true => drawn(HALF).svg(),
                false => for_both(WHOLE, drawn),
            }
        }
        Plot::Strip(plot) => for_both(WHOLE, |width| {
            let title = format!(
                "measured less simulated, {} [{}], along track {}, by session",
                plot.channel,
                sign(&plot.unit),
                plot.track
            );
            let figure = Figure {
                title,
                ..figure(width, "")
            };
            let figure = figure.row(120.0, [strip(plot, false)]);
            figure.row(120.0, [strip(plot, true)])
        }),
        Plot::Peaks(rows) => for_both(WHOLE, |width| {
            figure(width, "peak pressure by row").row(0.0, [peaks(rows)])
        }),
        Plot::Maps(plot) => format!("<div class=\"panels\">\n{}</div>\n", maps(plot)),
    }
}

/// Points in up to two series over a column, with their standard deviations, and a curve or the
/// level 0.
fn diagram(plot: &Scatter) -> Panel {
    let mut layers = vec![match &plot.curve {
        Some(curve) => {
            let points = curve.x.iter().copied().zip(curve.y.iter().copied());
            Layer::line(2.0, points, AFTER).named(&*curve.name)
        }
        None => Layer::level(0.0),
    }];
    for (one, colour) in plot.series.iter().zip([BEFORE, AFTER]) {
        let points = || plot.x.iter().copied().zip(one.y.iter().copied());
        let bars = points()
            .zip(&one.sd)
            .map(|((x, y), sd)| [(x, y - sd), (x, y + sd)]);
        layers.push(Layer::segments(1.0, bars, colour.alpha(0.7)));
        layers.push(Layer::dots(3.5, points(), colour).named(&*one.name));
    }
    Panel {
        x: Axis::new(match &*sign(&unit_of(&plot.x_name)) {
            "" => plot.x_name.clone(),
            unit => format!("{} [{unit}]", plot.x_name),
        }),
        y: Axis::new(&*plot.y_name),
        layers,
        ..Panel::default()
    }
}

/// Every run along a track in its session's colour, the mean of all, and the places of effects.
fn strip(plot: &Strip, after: bool) -> Panel {
    let (from, step) = (plot.from_m, plot.step_m);
    let (runs, places) = (&plot.runs, &plot.places);
    let values = |run: &StripRun| {
        if after {
            run.after.clone()
        } else {
            run.before.clone()
        }
    };
    let count = runs.iter().map(|run| run.before.len()).max().unwrap_or(0);
    let both = runs
        .iter()
        .flat_map(|run| run.before.iter().chain(&run.after));
    let largest = both
        .filter(|v| v.is_finite())
        .fold(1e-300_f64, |m, v| m.max(v.abs()));
    let line = |values: &[f64]| -> Vec<Point> {
        let places = (0..values.len()).map(|k| from + step * (k as f64 + 0.5));
        places.zip(values.iter().copied()).collect()
    };
    let mut sessions: Vec<&str> = Vec::new();
    for run in runs {
        if !sessions.contains(&&*run.session) {
            sessions.push(&run.session);
        }
    }
    let mut layers: Vec<Layer> = places
        .iter()
        .map(|place| {
            // At least wide enough to be seen.
            let least = 0.002 * step * count as f64;
            let ends = [place.from, place.to.max(place.from + least)];
            let [low, high] = [place.from, place.to].map(number4);
            Layer::stretch(ends, PLACES).hinted(format!("{}, {low} to {high} m", place.effect))
        })
        .collect();
    let names = places
        .iter()
        .map(|place| (0.5 * (place.from + place.to), place.effect.clone()));
    if !after {
        layers.push(Layer::new(Mark::Above(names.collect()), INK));
    }
    let mean = |k: usize| {
        let at = runs.iter().filter_map(|run| values(run).get(k).copied());
        let (sum, n) = at
            .filter(|v| v.is_finite())
            .fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
        sum / n
    };
    let means: Vec<f64> = (0..count).map(mean).collect();
    let named = |layer: Layer, name: &str| layer.named(if after { "" } else { name });
    for run in runs {
        let session = sessions
            .iter()
            .position(|session| *session == run.session)
            .unwrap_or(0);
        let colour = Colour::hue(session, sessions.len()).alpha(0.6);
        let layer = Layer::line(0.9, line(&values(run)), colour).hinted(&*run.run);
        layers.push(match session < MOST_SESSIONS {
            true => named(layer, &run.session),
            false => layer,
        });
    }
    if sessions.len() > MOST_SESSIONS {
        let more = format!("and {} sessions", sessions.len() - MOST_SESSIONS);
        layers.push(named(Layer::line(1.0, [], INK.alpha(0.0)), &more));
    }
    layers.push(named(
        Layer::line(1.8, line(&means), INK),
        "mean of all runs",
    ));
    Panel {
        title: if after { "after" } else { "before" }.to_owned(),
        x: match after {
            true => Axis::new("distance along the track [m]"),
            false => Axis::default(),
        }
        .within([from, from + step * count as f64]),
        y: Axis::default().within([-1.05 * largest, 1.05 * largest]),
        layers,
        ..Panel::default()
    }
}

/// Peak pressures, measured (a stroke with two standard deviations) and simulated before (a ring)
/// and after (a disc).
fn peaks(rows: &[Peak]) -> Panel {
    let mega = |pa: f64| 1e-6 * pa;
    let names = rows.iter().map(|row| match row.not_seen {
        true => format!("{}, not seen", row.name),
        false => row.name.clone(),
    });
    let mut layers = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        let y = k as f64 + 0.5;
        let [low, high] = [-2.0, 2.0].map(|side| (mega(row.measured + side * row.sd), y));
        let mut hint = format!(
            "measured {}, before {}",
            number4(mega(row.measured)),
            number4(mega(row.before))
        );
        if let Some(after) = row.after {
            hint += &format!(", after {}", number4(mega(after)));
        }
        let point = |symbol, radius, pressure, colour| {
            Layer::symbols(symbol, radius, [(mega(pressure), y)], colour)
                .hinted(format!("{hint} [MPa]"))
        };
        layers.push(Layer::segments(1.5, [[low, high]], INK));
        layers.push(point(Symbol::Stroke, 7.0, row.measured, INK).named("measured"));
        layers.push(point(Symbol::Ring, 4.0, row.before, BEFORE).named("before"));
        let after = row
            .after
            .map(|after| point(Symbol::Disc, 4.0, after, AFTER));
        layers.extend(after.map(|layer| layer.named("after")));
    }
    Panel {
        x: Axis::new("peak pressure [MPa]"),
        y: Axis::names(names).reversed(),
        layers,
        ..Panel::default()
    }
}

/// Measured pressure, and measured less simulated before and, where that is another one, after.
fn maps(plot: &Maps) -> String {
    let mega = |values: Vec<f64>| -> Vec<f64> { values.into_iter().map(|pa| 1e-6 * pa).collect() };
    let less = |simulated: &[f64]| {
        mega(
            plot.measured
                .iter()
                .zip(simulated)
                .map(|(m, s)| m - s)
                .collect(),
        )
    };
    let largest = |values: &[f64]| values.iter().fold(1e-6_f64, |m, v| m.max(v.abs()));
    let span = |from: f64, step: f64, count: usize| {
        [
            1e3 * (from - 0.5 * step),
            1e3 * (from + (count as f64 - 0.5) * step),
        ]
    };
    let window = [
        span(plot.x0, plot.dx, plot.nx),
        span(plot.y0, plot.dy, plot.ny),
    ];
    let map = |title: &str, values: Vec<f64>, bar: ColourBar| {
        // Maps have their rows from below.
        let rows = values.chunks(plot.nx.max(1)).rev();
        let cells = rows
            .flatten()
            .map(|value| Some(bar.colour(*value)))
            .collect();
        let size = [plot.nx, plot.ny];
        let cells = Mark::Map {
            window,
            size,
            cells,
        };
        let panel = Panel {
            title: title.to_owned(),
            x: Axis::new("x [mm]").within(window[0]),
            y: Axis::new("y [mm]").within(window[1]),
            layers: vec![Layer::new(cells, INK)],
            ..Panel::default()
        };
        let figure = Figure {
            letters: 12.0,
            ..figure(MAP, title)
        };
        figure.row(150.0, [panel]).bar(bar).svg()
    };
    let pressure = mega(plot.measured.clone());
    let bar = ColourBar::viridis("p [MPa]", [0.0, largest(&pressure)]);
    let mut out = map("measured", pressure, bar);
    let first = less(&plot.before);
    let off = largest(&first);
    let bar = || ColourBar::new("p [MPa]", [-off, off], |share| diverging(2.0 * share - 1.0));
    out += &map("measured less simulated, before", first, bar());
    if !plot.after.is_empty() {
        out += &map("measured less simulated, after", less(&plot.after), bar());
    }
    out
}

/// Bars of one quantity in its own scale, each with its value.
fn bars(title: String, unit: &str, values: &[(&str, f64, Colour)]) -> Panel {
    let largest = values
        .iter()
        .fold(1e-300_f64, |m, (_, value, _)| m.max(*value));
    let mut layers = Vec::new();
    for (k, (_, value, colour)) in values.iter().enumerate() {
        let y = k as f64;
        layers.push(Layer::rectangle(
            [0.0, value / largest],
            [y + 0.15, y + 0.85],
            *colour,
        ));
        let text = shown(*value, unit);
        layers.push(Layer::text(
            (value / largest, y + 0.5),
            text,
            [0.4, 0.0],
            INK,
        ));
    }
    Panel {
        title,
        x: Axis::blank([0.0, 1.25]),
        y: Axis::names(values.iter().map(|(name, ..)| *name)).reversed(),
        layers,
        ..Panel::default()
    }
}

fn bar_chart(title: &str, panels: &dyn Fn() -> Vec<Panel>) -> String {
    for_both(640.0, |width| {
        let figure = Figure {
            title: title.to_owned(),
            ..figure(width, "")
        };
        panels()
            .into_iter()
            .fold(figure, |figure, panel| figure.row(0.0, [panel]))
    })
}

/// The gap of each channel before and after, and what the sensors' noise alone would give.
pub fn gaps(title: &str, channels: &[ChannelGap]) -> String {
    bar_chart(title, &|| {
        let one = |c: &ChannelGap| {
            let values = [
                ("before", c.before, BEFORE),
                ("after", c.after, AFTER),
                ("sensor noise", c.noise, NEUTRAL),
            ];
            bars(channel_label(&c.channel, &c.unit), &c.unit, &values)
        };
        channels.iter().map(one).collect()
    })
}

/// The gap of each quantity by three models; a model that cannot be simulated has no bar.
pub fn models(title: &str, baselines: &[Baseline]) -> String {
    bar_chart(title, &|| {
        let one = |b: &Baseline| {
            let values = [
                Some(("as given", b.as_given, BEFORE)),
                b.refitted.map(|gap| ("base refitted", gap, NEUTRAL)),
                b.with_effect.map(|gap| ("with the effect", gap, AFTER)),
            ];
            let values: Vec<_> = values.into_iter().flatten().collect();
            bars(channel_label(&b.quantity, &b.unit), &b.unit, &values)
        };
        baselines.iter().map(one).collect()
    })
}

/// Mean residuals with two standard errors, relative to the largest of their channel, most
/// significant bins first.
pub fn bins(bins: &[Bin]) -> String {
    let bins = &bins[..bins.len().min(MOST_BINS)];
    let mut errors = Vec::new();
    let mut means = Vec::new();
    for (k, bin) in bins.iter().enumerate() {
        let same = bins.iter().filter(|other| other.channel == bin.channel);
        let largest = same.fold(1e-300_f64, |m, b| m.max(b.mean.abs() + 2.0 * b.error));
        let at = |side: f64| ((bin.mean + side * bin.error) / largest, k as f64 + 0.5);
        errors.push([at(-2.0), at(2.0)]);
        means.push(at(0.0));
    }
    let zero = [(0.0, f64::NEG_INFINITY), (0.0, f64::INFINITY)];
    for_both(640.0, |width| {
        let panel = Panel {
            title: "mean residual with two standard errors, relative to the largest of its channel"
                .to_owned(),
            x: Axis::blank([-1.05, 1.05]),
            y: Axis::names(
                bins.iter()
                    .map(|bin| format!("{}: {}", bin.channel, range(bin))),
            )
            .reversed(),
            layers: vec![
                Layer::line(1.0, zero, INK.alpha(0.4)),
                Layer::segments(2.0, errors.iter().copied(), AFTER),
                Layer::dots(4.0, means.iter().copied(), BEFORE),
            ],
            ..Panel::default()
        };
        figure(width, "mean residual by bin").row(0.0, [panel])
    })
}

/// A channel's mean residual run by run, every second session shaded.
pub fn runs(of: &ByRun) -> String {
    let mut layers = vec![Layer::level(0.0)];
    let mut names = Vec::new();
    let mut from = 0;
    let sessions = of.runs.chunk_by(|a, b| a.session == b.session);
    for (k, session) in sessions.enumerate() {
        let ends = [from, from + session.len()].map(|run| run as f64);
        if k % 2 == 1 {
            layers.push(Layer::stretch(ends, INK.alpha(0.07)));
        }
        names.push((0.5 * (ends[0] + ends[1]), session[0].session.clone()));
        from += session.len();
    }
    for (k, run) in of.runs.iter().enumerate() {
        let point = |value: f64| [(k as f64 + 0.5, usual(value, &of.unit).0)];
        let before = Layer::symbols(Symbol::Ring, 4.0, point(run.before), BEFORE);
        layers.push(before.named("before").hinted(&*run.run));
        layers.push(
            Layer::dots(3.0, point(run.after), AFTER)
                .named("after")
                .hinted(&*run.run),
        );
    }
    let title = format!("mean residual {}", channel_label(&of.channel, &of.unit));
    for_both(640.0, |width| {
        let panel = Panel {
            title: title.clone(),
            x: Axis {
                label: "session".to_owned(),
                range: Some([0.0, of.runs.len().max(1) as f64]),
                ticks: Ticks::Names(names.clone()),
            },
            layers: layers.clone(),
            ..Panel::default()
        };
        figure(width, &format!("{title} by run")).row(120.0, [panel])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::finding::Place;

    /// The coordinates `attribute` of elements that contain `mark`, in the part of a page for
    /// phones.
    fn on_a_phone(html: &str, mark: &str, attribute: &str) -> Vec<f64> {
        let phone = &html[html.find("class=\"phone\"").expect("a phone's picture")..];
        let elements = phone.split('<').filter(|element| element.contains(mark));
        let value = |element: &str| {
            let (_, rest) = element.split_once(&format!(" {attribute}=\""))?;
            rest.split('"').next()?.parse().ok()
        };
        elements.filter_map(value).collect()
    }

    fn peak(name: &str, measured: f64, after: Option<f64>) -> Peak {
        Peak {
            name: name.to_owned(),
            not_seen: name.contains('<'),
            measured,
            sd: 0.0,
            before: 20e6,
            after,
        }
    }

    #[test]
    fn peaks_are_where_their_pressures_say() {
        let rows = vec![
            peak("row 2", 10e6, Some(10e6)),
            peak("row <3>", 30e6, Some(30e6)),
        ];
        let html = picture(&Plot::Peaks(rows), false);
        // The legend's ring, and one of each row.
        let rings = on_a_phone(&html, "stroke=\"#d0703c\"", "cx");
        let discs = on_a_phone(&html, "fill=\"#3f8fd0\"", "cx");
        assert_eq!((rings.len(), discs.len()), (3, 3));
        assert_eq!(rings[1], rings[2]);
        assert!((rings[1] - 0.5 * (discs[1] + discs[2])).abs() < 0.2 && discs[1] < discs[2]);
        assert_eq!(html.matches("row &lt;3&gt;, not seen").count(), 2);
        assert!(html.contains("peak pressure [MPa]") && !html.contains("NaN"));
        let plain = picture(&Plot::Peaks(vec![peak("row 2", 1e7, None)]), false);
        assert!(!plain.contains(">after<") && !plain.contains("#3f8fd0"));
    }

    fn run(session: &str, before: Vec<f64>, after: Vec<f64>) -> StripRun {
        StripRun {
            run: "A-1".to_owned(),
            session: session.to_owned(),
            before,
            after,
        }
    }

    fn along(places: Vec<Place>, runs: Vec<StripRun>) -> String {
        let plot = Strip {
            channel: "side".to_owned(),
            unit: "m/s2".to_owned(),
            track: "e<st".to_owned(),
            from_m: 100.0,
            step_m: 10.0,
            places,
            runs,
        };
        picture(&Plot::Strip(plot), false)
    }

    /// Four stretches of 10 m, one without a value: the line is broken there, and places are shaded
    /// in both panels.
    #[test]
    fn a_run_is_drawn_where_it_has_values_and_places_where_they_are() {
        let place = Place {
            effect: "wall-contact".to_owned(),
            from: 110.0,
            to: 120.0,
        };
        let before = vec![0.0, f64::NAN, 100.0, 0.0];
        let after = vec![0.0, f64::NAN, 0.0, 0.0];
        let html = along(vec![place], vec![run("d1", before, after)]);
        assert_eq!(html.matches("fill=\"#e0a800\"").count(), 4);
        assert_eq!(html.matches("wall-contact, 110.0 to 120.0 m").count(), 4);
        assert!(html.contains("e&lt;st") && html.contains("[m/s²]") && !html.contains("NaN"));
        let path = html
            .split("<title>A-1</title><path d=\"")
            .nth(1)
            .expect("the run");
        let path: Vec<f64> = path
            .split('"')
            .next()
            .unwrap()
            .split(['M', 'L', ' '])
            .filter_map(|number| number.parse().ok())
            .collect();
        // From the third stretch to the fourth, a quarter of the width; the peak of 100 is at 1 /
        // 1.05 of the half height.
        assert_eq!(path.len(), 4);
        assert!(((path[3] - path[1]) * 1.05 - 60.0).abs() < 0.5, "{path:?}");
        assert!(path[0] > 600.0 && path[2] > path[0]);
    }

    #[test]
    fn a_legend_names_some_of_many_sessions_and_counts_the_others() {
        let runs = (0..30).map(|k| run(&format!("session {k}"), vec![1.0], vec![0.5]));
        let html = along(Vec::new(), runs.collect());
        assert_eq!(html.matches(">session ").count(), 2 * MOST_SESSIONS);
        assert_eq!(html.matches(">and 20 sessions<").count(), 2);
    }

    #[test]
    fn maps_have_their_own_scales_and_no_after_where_nothing_was_added() {
        let plot = |after: Vec<f64>| {
            Plot::Maps(Maps {
                nx: 2,
                ny: 2,
                x0: 0.0,
                y0: 0.0,
                dx: 1e-3,
                dy: 1e-5,
                measured: vec![1e6, 2e6, 3e6, 4e6],
                before: vec![1e6, 2e6, 3e6, 3e6],
                after,
            })
        };
        let html = picture(&plot(vec![1e6, 2e6, 3e6, 4e6]), false);
        assert_eq!(html.matches("<svg").count(), 3);
        // Every map has its own colour bar with numbers.
        assert_eq!(html.matches(">p [MPa]<").count(), 3);
        assert_eq!(picture(&plot(Vec::new()), false).matches("<svg").count(), 2);
    }
}
