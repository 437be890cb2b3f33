//! Sections of the page: each effect with its rivals, and tables.

use std::collections::BTreeSet;

use crate::plot::{escape, measured, number4, quantity};
use crate::report::discovery::parts::{alike, folded, headed_table, p_is, p_value, range, table};
use crate::report::discovery::pictures;
use crate::report::html::small;
use crate::report::viewer::{ViewedPart, viewer_links};
use crate::results::finding::{
    Bin, ByRun, ContactForces, ContactPlace, Detectable, Fitted, NextRuns, OfKind, Report, Rival,
    Step,
};

/// Largest number of bins of a table.
const MAX_BINS: usize = 15;

/// One effect: reduction of the misfit, parameters, and rivals.
pub fn step(number: usize, step: &Step, report: &Report) -> String {
    let shared = match report.steps.len() {
        1 => "",
        _ => " by all steps together",
    };
    let judged = match report.held_out.runs[..] {
        [] => "",
        _ => " on held-out data",
    };
    let closed = &step.explainable_gap_closed;
    let [value, low, high] = [closed.value, closed.low, closed.high].map(|share| 100.0 * share);
    let of = if step.contact_forces.is_some() {
        "the mean square along and yaw residual in contacts, beyond noise,"
    } else if report.remaining.is_empty() {
        "what effects of the catalogue could explain"
    } else {
        "what effects of the catalogue could explain, with each place weighted by its scatter,"
    };
    let text = format!(
        "Channel {}; p {}. {} Of {of}{judged}, {value:.0} % ({low:.0} to {high:.0} %) is explained{shared}.",
        step.channel,
        p_is(step.p_value),
        fitted_gap(step, report),
    );
    let (effect, text) = (escape(&step.effect), escape(&text));
    let mut out = format!("<h2>{number}. {effect}</h2>\n<p>{text}</p>\n");
    if let Some(law) = &step.law {
        out += &format!("<p>Law: <code>{}</code></p>\n", escape(law));
    }
    out += &evidence(&step.evidence);
    out += &folded("Its size, with the interval", parameters(&step.parameters));
    out += &folded("Contacts by place", contacts(&step.contacts));
    let title = format!("Why {} and not its rivals", step.effect);
    out + &folded(&title, rivals(&step.rivals))
}

/// A table of the places at which runs hit a wall.
fn contacts(places: &[ContactPlace]) -> String {
    let row = |place: &ContactPlace| {
        let force = |force: fn(&ContactForces) -> f64| {
            let forces = ContactForces::of(std::slice::from_ref(place));
            forces.map_or(String::new(), |one| format!("{:.0}", force(&one)))
        };
        let hit = place.drivers.iter().filter(|driver| driver.hit > 0);
        let drivers = hit.map(|one| format!("{} {} of {}", one.driver, one.hit, one.runs));
        [
            place.track.clone(),
            format!("{:.0} to {:.0}", place.from_m, place.to_m),
            if place.force_n > 0.0 { "left" } else { "right" }.to_owned(),
            format!("{} of {}", place.hit, place.runs),
            force(|one| one.median_n),
            force(|one| one.min_n),
            force(|one| one.max_n),
            drivers.collect::<Vec<_>>().join(", "),
        ]
    };
    let head = "<p>The peak force of each contact follows from the side balance of its own run. The lever follows from how the sled then turns.</p>\n";
    let columns = "track|#s [m]|pushed to the|#runs|#median force [N]|#smallest|#largest|drivers";
    let rows = places.iter().map(|place| (false, row(place)));
    headed_table(head, columns, rows)
}

/// Reduction of the misfit on the fitted data. For a single effect it is that of the bars, from the
/// given to the next model; for several effects it is that of each effect after the base was
/// refitted.
fn fitted_gap(step: &Step, report: &Report) -> String {
    let bars = report.training.iter().find(|c| c.channel == step.channel);
    let text = if let (1, Some(bars)) = (report.steps.len(), bars) {
        let [before, after] = [bars.before, bars.after].map(|gap| quantity(gap, &bars.unit));
        format!(
            "the rms residual is {before} with the model as given and {after} with the next one."
        )
    } else {
        let [before, after] =
            [step.gap_before, step.gap_after].map(|gap| quantity(gap, &step.unit));
        let base = match report.base[..] {
            [] => "",
            _ => ", with the given model refitted,",
        };
        if step.gap_after >= step.gap_before {
            format!(
                "the refitted model had absorbed it: the rms residual was {before} and is {after}."
            )
        } else {
            format!("it lowers the rms residual{base} from {before} to {after}.")
        }
    };
    format!("On the data it was fitted to {text}")
}

fn rivals(rivals: &[Rival]) -> String {
    let row = |r: &Rival| {
        let cells = [
            r.effect.clone(),
            r.parameter.clone(),
            quantity(r.size, &r.unit),
            number4(r.t),
            number4(r.gain),
            format!("{:.2}", r.correlation),
            number4(r.t_of_named_beyond),
            r.decides.clone(),
        ];
        (r.in_class, cells)
    };
    let columns = "rival|parameter|#size alone|#t|#explains|#correlation|#t of the named effect|what would decide";
    let head = "<p>Shaded: these data do not distinguish it from the named effect. <i>Explains</i>: decrease of the sum of squares by the rival alone, in units of the noise variance. \
        <i>t of the named effect</i>: fitted together with the rival; below about 2 the two are alike.</p>\n";
    headed_table(head, columns, rivals.iter().map(row))
}

/// The value, the interval and the unit of a parameter.
fn sized(p: &Fitted) -> [String; 3] {
    let ([value, low, high], scale) = alike([p.value, p.low, p.high], &p.unit);
    [value, format!("{low} to {high}"), scale.unit]
}

/// A table of parameters with their intervals.
pub fn parameters(fitted: &[Fitted]) -> String {
    let row = |p: &Fitted| {
        let [value, interval, unit] = sized(p);
        [p.name.clone(), value, interval, unit]
    };
    let columns = "parameter|#value|#95 % interval|unit";
    table(columns, fitted.iter().map(row))
}

/// The parameters of an effect from each kind of data of a campaign.
fn evidence(kinds: &[OfKind]) -> String {
    let message = match (kinds.len(), kinds.iter().all(|kind| kind.agrees)) {
        (0, _) => return String::new(),
        (1, _) => "One kind of data of the campaign depends on this effect.",
        (_, true) => {
            "The kinds of data agree: the size above is that of all together, each weighed by its error."
        }
        (_, false) => {
            "The kinds of data disagree: each has its own size, and the next model has that of the first."
        }
    };
    let rows = kinds.iter().flat_map(|kind| {
        let [before, after] =
            [kind.gap_before, kind.gap_after].map(|gap| quantity(gap, &kind.unit));
        let gaps = format!("{before} → {after}");
        kind.parameters.iter().map(move |p| {
            let (data, name, [value, interval, unit]) = (&kind.data, &p.name, sized(p));
            [
                data.clone(),
                name.clone(),
                value,
                interval,
                unit,
                gaps.clone(),
            ]
        })
    });
    let columns = "data|parameter|#these data alone|#95 % interval|unit|#rms residual on held-out data before, and after";
    format!("<p>{message}</p>\n{}", table(columns, rows))
}

/// Runs that would distinguish the members of a class, simulated.
pub fn next_runs(plans: &[NextRuns]) -> String {
    let row = |plan: &NextRuns| {
        let cells = [
            plan.runs.to_string(),
            plan.track.clone(),
            plan.change.clone(),
            plan.between.join(" and "),
            number4(plan.expected_evidence),
        ];
        (plan.splits, cells)
    };
    let head = "<p>Each plan was simulated with each of the alternative effects at its fitted size. <i>Expected</i>: the log-likelihood ratio of the two effects that the \
        runs would distinguish least; shaded where they would be distinguished with a probability of 90 %.</p>\n";
    let columns = "runs|track|what differs|between|#expected";
    headed_table(head, columns, plans.iter().map(row))
}

/// Bins in which the residual is significant.
pub fn bins(bins: &[Bin]) -> String {
    if bins.is_empty() {
        return "<p>No bin of any variable is significant (p &gt; 0.05 over all bins).</p>\n"
            .to_owned();
    }
    let row = |b: &Bin| {
        let (mean, p) = (measured(b.mean, b.error, &b.unit), p_value(b.p_value));
        [b.channel.clone(), range(b), mean, p]
    };
    let columns = "channel|bin|#mean residual, ± standard error|#p over all bins";
    let mut out = pictures::bins(bins) + &table(columns, bins.iter().take(MAX_BINS).map(row));
    if bins.len() > MAX_BINS {
        let count = bins.len();
        out += &small(&format!(
            "The most significant {MAX_BINS} of {count}; all are in report.json."
        ));
    }
    out
}

/// Mean residuals run by run, and links to the runs.
pub fn runs(by_run: &[ByRun], viewer: Option<&str>) -> String {
    let names = by_run.iter().flat_map(|channel| &channel.runs);
    let names: BTreeSet<&str> = names.map(|run| run.run.as_str()).collect();
    let link = |run: &&str| Some(ViewedPart::of_runs(&[*run]).link(viewer?, run));
    let links: Vec<String> = names.iter().filter_map(link).collect();
    let mut out = viewer_links(&links);
    for channel in by_run {
        let chance = |p: f64| if p >= 1.0 { "1".to_owned() } else { p_value(p) };
        out += &pictures::runs(channel);
        let before = chance(channel.sessions_differ_before);
        let after = chance(channel.sessions_differ_after);
        out += &small(&format!(
            "p-value of the differences between sessions: {before} before, {after} after.",
        ));
    }
    out
}

/// A table of the smallest detectable effects, and of the effects that resemble them most.
pub fn detectable(effects: &[Detectable]) -> String {
    let row = |d: &Detectable| {
        let cells = [
            d.effect.clone(),
            d.parameter.clone(),
            quantity(d.size, &d.unit),
            format!("{:.3}", d.left_after_refit),
            d.most_like.clone(),
            format!("{:.2}", d.correlation),
        ];
        (false, cells)
    };
    let head = "<p>The smallest size that would be found with a probability of 90 %, the share of the effect that a refit of the given model \
        does not absorb, and the effect most correlated with it.</p>\n";
    let columns = "effect|parameter|#smallest size|#share not absorbed|most alike|#correlation";
    headed_table(head, columns, effects.iter().map(row))
}
