//! Pictures of the page, each in two widths: for wide pages and for phones.

use kufe_sled::distinct;

use crate::plot::{
    AFTER, Axis, BEFORE, Cells, Colour, ColourBar, Figure, INK, Layer, Panel, Point, Scale, Symbol,
    Ticks, diverging, extent, number4, quantity, unit_of,
};
use crate::report::discovery::parts::range;
use crate::report::html::for_both;
use crate::results::finding::{
    Baseline, Bin, ByRun, ChannelGap, Maps, Peak, Plot, Scatter, Strip, StripRun,
};

// Widths [pixels] of a map, of one of two pictures side by side, of a single picture, and of a
// picture over the whole width.
const MAP: f64 = 290.0;
const HALF: f64 = 480.0;
const ALONE: f64 = 640.0;
const WHOLE: f64 = 940.0;

/// Colour of values that are neither before nor after.
const NEUTRAL: Colour = Colour::new(140, 140, 140);
/// Colour of places of effects.
const PLACES: Colour = Colour::new(224, 168, 0).alpha(0.3);
/// Largest number of bins of a picture.
const MAX_BINS: usize = 12;
/// Largest number of sessions in a legend.
const MAX_SESSIONS: usize = 10;

/// A figure of panels one below the other, without a title; `label` is the alternative text.
fn column(width: f64, label: &str, height: f64, panels: Vec<Panel>) -> Figure {
    let mut figure = Figure::new(width, "").column(height, panels);
    figure.letters = 13.0;
    figure.label = label.to_owned();
    figure
}

/// The picture of a plot; a diagram that is one of a pair has half the width of the page.
pub fn picture(plot: &Plot, is_one_of_a_pair: bool) -> String {
    let figure = match plot {
        Plot::Scatter(plot) => column(HALF, &plot.label, 230.0, vec![diagram(plot)]),
        Plot::Strip(plot) => {
            let channel = Scale::of(&plot.unit, 1.0).label(&plot.channel);
            let along = format!("along track {}, by session", plot.track);
            let panels = [false, true].map(|after| strip(plot, after));
            let mut figure = column(WHOLE, "", 120.0, panels.to_vec());
            figure.title = format!("measured less simulated, {channel}, {along}");
            figure
        }
        Plot::Peaks(rows) => column(WHOLE, "peak pressure by row", 0.0, vec![peaks(rows)]),
        Plot::Maps(plot) => return format!("<div class=\"panels\">\n{}</div>\n", maps(plot)),
    };
    if is_one_of_a_pair {
        figure.svg()
    } else {
        for_both(WHOLE, figure)
    }
}

/// Points in up to two series over a column, with their standard deviations, and a curve or the
/// level 0.
fn diagram(plot: &Scatter) -> Panel {
    let pairs =
        |x: &[f64], y: &[f64]| -> Vec<Point> { x.iter().copied().zip(y.iter().copied()).collect() };
    let mut layers = vec![match &plot.curve {
        Some(curve) => Layer::line(2.0, pairs(&curve.x, &curve.y), AFTER).named(&*curve.name),
        None => Layer::level(0.0),
    }];
    for (one, colour) in plot.series.iter().zip([BEFORE, AFTER]) {
        let points = pairs(&plot.x, &one.y);
        let bars = points.iter().zip(&one.sd);
        let bars = bars.map(|((x, y), sd)| [(*x, y - sd), (*x, y + sd)]);
        layers.push(Layer::segments(1.0, bars, colour.alpha(0.7)));
        layers.push(Layer::dots(3.5, points, colour).named(&*one.name));
    }
    let x = Scale::of(&unit_of(&plot.x_name), 1.0).label(&plot.x_name);
    Panel::new(Axis::new(x), Axis::new(&*plot.y_name), layers)
}

/// Every run along a track in its session's colour, the mean of all, and the places of effects.
fn strip(plot: &Strip, after: bool) -> Panel {
    let values = |run: &StripRun| {
        let values = if after { &run.after } else { &run.before };
        values.clone()
    };
    let runs = plot.runs.iter();
    let both = runs.flat_map(|run| run.before.iter().chain(&run.after));
    let [_, largest] = extent(both.map(|value| value.abs()).chain([1e-300]));
    let lengths = plot.runs.iter().map(|run| run.before.len());
    let count = lengths.max().unwrap_or(0);
    let end = plot.from_m + plot.step_m * count as f64;
    let line = |values: Vec<f64>, width: f64, colour: Colour| {
        let at = |k: usize| plot.from_m + plot.step_m * (k as f64 + 0.5);
        let points = values.into_iter().enumerate();
        Layer::line(width, points.map(|(k, value)| (at(k), value)), colour)
    };
    let mut layers = Vec::new();
    for place in &plot.places {
        // At least wide enough to be seen.
        let to = place.to.max(place.from + 0.002 * (end - plot.from_m));
        let [low, high] = [place.from, place.to].map(number4);
        let hint = format!("{}, {low} to {high} m", place.effect);
        layers.push(Layer::stretch([place.from, to], PLACES).hinted(hint));
        if !after {
            layers.push(Layer::above(0.5 * (place.from + place.to), &*place.effect));
        }
    }
    let sessions = distinct(plot.runs.iter().map(|run| &run.session));
    let named = |layer: Layer, name: &str| if after { layer } else { layer.named(name) };
    for run in &plot.runs {
        let session = sessions.iter().position(|session| **session == run.session);
        let session = session.unwrap_or(0);
        let colour = Colour::hue(session, sessions.len()).alpha(0.6);
        let layer = line(values(run), 0.9, colour).hinted(&*run.run);
        let is_named = session < MAX_SESSIONS;
        layers.push(named(layer, if is_named { &run.session } else { "" }));
    }
    if sessions.len() > MAX_SESSIONS {
        let more = format!("and {} sessions", sessions.len() - MAX_SESSIONS);
        layers.push(named(line(Vec::new(), 1.0, INK.alpha(0.0)), &more));
    }
    let runs: Vec<Vec<f64>> = plot.runs.iter().map(values).collect();
    let mean = |k: usize| {
        let at = runs.iter().filter_map(|values| values.get(k).copied());
        let at: Vec<f64> = at.filter(|value| value.is_finite()).collect();
        at.iter().sum::<f64>() / at.len() as f64
    };
    let means = line((0..count).map(mean).collect(), 1.8, INK);
    layers.push(named(means, "mean of all runs"));
    if after && !plot.discrepancy.is_empty() {
        layers.push(line(plot.discrepancy.clone(), 2.4, AFTER).named("model discrepancy"));
    }
    let (x, title) = if after {
        ("distance along the track [m]", "after")
    } else {
        ("", "before")
    };
    let y = Axis::new("").within([-1.05 * largest, 1.05 * largest]);
    Panel::new(Axis::new(x).within([plot.from_m, end]), y, layers).titled(title)
}

/// Peak pressures, measured (a stroke with two standard deviations) and simulated before (a ring)
/// and after (a disc).
fn peaks(rows: &[Peak]) -> Panel {
    let mega = |pa: f64| 1e-6 * pa;
    let mut layers = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        let y = k as f64 + 0.5;
        let ends = [-2.0, 2.0].map(|side| (mega(row.measured + side * row.sd), y));
        layers.push(Layer::segments(1.5, [ends], INK));
        let points = [
            ("measured", Some(row.measured), Symbol::Stroke, 7.0, INK),
            ("before", Some(row.before), Symbol::Ring, 4.0, BEFORE),
            ("after", row.after, Symbol::Disc, 4.0, AFTER),
        ];
        layers.extend(
            points
                .into_iter()
                .filter_map(|(name, pa, symbol, radius, colour)| {
                    let pressure = mega(pa?);
                    let layer = Layer::symbols(symbol, radius, [(pressure, y)], colour);
                    let hint = format!("{name} {}", quantity(1e6 * pressure, "Pa"));
                    Some(layer.named(name).hinted(hint))
                }),
        );
    }
    let names = rows.iter().map(|row| {
        let seen = if row.not_seen { ", not seen" } else { "" };
        format!("{}{seen}", row.name)
    });
    let x = Axis::new("peak pressure [MPa]");
    Panel::new(x, Axis::names("", names).reversed(), layers)
}

/// Maps of the measured pressure, and of measured less simulated pressure before and, if effects
/// were added, after.
fn maps(plot: &Maps) -> String {
    let measured = &plot.measured;
    let less = |simulated: &[f64]| -> Vec<f64> {
        let pairs = measured.pressure.iter().zip(simulated);
        pairs
            .map(|(pa, simulated)| 1e-6 * (pa - simulated))
            .collect()
    };
    let largest = |values: &[f64]| values.iter().fold(1e-6_f64, |m, v| m.max(v.abs()));
    let span = |from: f64, step: f64, count: usize| {
        [-0.5, count as f64 - 0.5].map(|k| 1e3 * (from + k * step))
    };
    let window = [
        span(measured.x0, measured.dx, measured.nx),
        span(measured.y0, measured.dy, measured.ny),
    ];
    let map = |title: &str, values: Vec<f64>, bar: ColourBar| {
        let cells = Cells::new([measured.nx, measured.ny], |column, row| {
            Some(bar.colour(values[row * measured.nx + column]))
        });
        let [x, y] = ["x [mm]", "y [mm]"].map(Axis::new);
        let (x, y) = (x.within(window[0]), y.within(window[1]));
        let panel = Panel::new(x, y, vec![Layer::map(window, cells)]).titled(title);
        let mut figure = column(MAP, title, 150.0, vec![panel]).bar(bar);
        figure.letters = 12.0;
        figure.svg()
    };
    let pressure = less(&vec![0.0; measured.pressure.len()]);
    let bar = ColourBar::viridis("p [MPa]", [0.0, largest(&pressure)]);
    let mut out = map("measured", pressure, bar);
    let before = less(&plot.before);
    let off = largest(&before);
    let bar = || ColourBar::new("p [MPa]", [-off, off], |share| diverging(2.0 * share - 1.0));
    out += &map("measured less simulated, before", before, bar());
    if !plot.after.is_empty() {
        out += &map("measured less simulated, after", less(&plot.after), bar());
    }
    out
}

/// One panel of bars per quantity, each with its own scale, and each bar with its value.
fn bars<'a>(
    title: &str,
    quantities: impl Iterator<Item = (&'a str, &'a str, Vec<(&'a str, f64, Colour)>)>,
) -> String {
    let panels = quantities.map(|(name, unit, values)| {
        let largest = values
            .iter()
            .fold(1e-300, |most, bar| f64::max(most, bar.1));
        let scale = Scale::of(unit, largest);
        let bars = values.iter().enumerate();
        let layers = bars.flat_map(|(k, (_, value, colour))| {
            let (y, end) = (k as f64, value / largest);
            [
                Layer::rectangle([0.0, end], [y + 0.15, y + 0.85], *colour),
                Layer::text((end, y + 0.5), scale.number(*value), [0.4, 0.0], INK),
            ]
        });
        let names = Axis::names("", values.iter().map(|(name, ..)| *name));
        let x = Axis::blank([0.0, 1.25]);
        Panel::new(x, names.reversed(), layers.collect()).titled(scale.label(name))
    });
    let mut figure = column(ALONE, "", 0.0, panels.collect());
    figure.title = title.to_owned();
    for_both(ALONE, figure)
}

/// The misfit of each channel before and after, and the misfit that sensor noise alone would cause.
pub fn gaps(title: &str, channels: &[ChannelGap]) -> String {
    let values = channels.iter().map(|c| {
        let values = vec![
            ("before", c.before, BEFORE),
            ("after", c.after, AFTER),
            ("sensor noise", c.noise, NEUTRAL),
        ];
        (&*c.channel, &*c.unit, values)
    });
    bars(title, values)
}

/// The misfit of each quantity by three models; a model that cannot be simulated has no bar.
pub fn models(title: &str, baselines: &[Baseline]) -> String {
    let values = baselines.iter().map(|b| {
        let refitted = b.refitted.map(|gap| ("refitted", gap, NEUTRAL));
        let with_effect = b.with_effect.map(|gap| ("with the effect", gap, AFTER));
        let given = [("as given", b.as_given, BEFORE)].into_iter();
        let values = given.chain(refitted).chain(with_effect);
        (&*b.quantity, &*b.unit, values.collect())
    });
    bars(title, values)
}

/// Mean residuals with two standard errors, relative to the largest of their channel, most
/// significant bins first.
pub fn bins(bins: &[Bin]) -> String {
    let bins = &bins[..bins.len().min(MAX_BINS)];
    let mut layers = vec![Layer::upright(0.0, INK.alpha(0.4))];
    for (k, bin) in bins.iter().enumerate() {
        let same = bins.iter().filter(|other| other.channel == bin.channel);
        let reach = same.map(|b| b.mean.abs() + 2.0 * b.error);
        let largest = reach.fold(1e-300, f64::max);
        let at = |side: f64| ((bin.mean + side * bin.error) / largest, k as f64 + 0.5);
        layers.push(Layer::segments(2.0, [[at(-2.0), at(2.0)]], AFTER));
        layers.push(Layer::dots(4.0, [at(0.0)], BEFORE));
    }
    let name = |bin: &Bin| format!("{}: {}", bin.channel, range(bin));
    let names = Axis::names("", bins.iter().map(name)).reversed();
    let title = "mean residual with two standard errors, relative to the largest of its channel";
    let panel = Panel::new(Axis::blank([-1.05, 1.05]), names, layers).titled(title);
    let figure = column(ALONE, "mean residual by bin", 0.0, vec![panel]);
    for_both(ALONE, figure)
}

/// A channel's mean residual by run, with every second session shaded.
pub fn runs(of: &ByRun) -> String {
    let means = of.runs.iter().flat_map(|run| [run.before, run.after]);
    let scale = Scale::of_all(&of.unit, means);
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
        let point = |value: f64| [(k as f64 + 0.5, scale.times * value)];
        let before = Layer::symbols(Symbol::Ring, 4.0, point(run.before), BEFORE);
        let after = Layer::dots(3.0, point(run.after), AFTER);
        layers.push(before.named("before").hinted(&*run.run));
        layers.push(after.named("after").hinted(&*run.run));
    }
    let title = format!("mean residual {}", scale.label(&of.channel));
    let x = Axis::with("session", Ticks::Names(names)).within([0.0, from.max(1) as f64]);
    let label = format!("{title} by run");
    let panel = Panel::new(x, Axis::new(""), layers).titled(title);
    for_both(ALONE, column(ALONE, &label, 120.0, vec![panel]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::effects::Map;
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
            discrepancy: Vec::new(),
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
        let quarter = path[2] - path[0];
        assert!((2.0 * quarter - 0.5 * 880.0).abs() < 10.0, "{path:?}");
    }

    #[test]
    fn a_legend_names_some_of_many_sessions_and_counts_the_others() {
        let runs = (0..30).map(|k| run(&format!("session {k}"), vec![1.0], vec![0.5]));
        let html = along(Vec::new(), runs.collect());
        assert_eq!(html.matches(">session ").count(), 2 * MAX_SESSIONS);
        assert_eq!(html.matches(">and 20 sessions<").count(), 2);
    }

    #[test]
    fn maps_have_their_own_scales_and_no_after_where_nothing_was_added() {
        let plot = |after: Vec<f64>| {
            let measured = Map {
                nx: 2,
                ny: 2,
                x0: 0.0,
                y0: 0.0,
                dx: 1e-3,
                dy: 1e-5,
                pressure: vec![1e6, 2e6, 3e6, 4e6],
            };
            Plot::Maps(Maps {
                measured,
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
