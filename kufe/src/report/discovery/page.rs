//! Structure of the page: summary, pictures, each effect, and folded tables.

use crate::plot::escape;
use crate::plot::quantity;
use crate::report::discovery::parts::{folded, list};
use crate::report::discovery::pictures::{gaps, models, picture};
use crate::report::discovery::sections::{bins, detectable, next_runs, parameters, runs, step};
use crate::report::discovery::summary::{summary, tested};
use crate::report::html::{fold, plain_page, small};
use crate::report::viewer::{Stretch, ViewedPart, viewer_links};
use crate::results::finding::{Picture, Plot, Report, SessionOffset, Strip};

/// The page of a search for missing effects: one HTML file without scripts. `viewer` is the address
/// of the page of the runs, if it exists.
pub fn discovery_page(report: &Report, viewer: Option<&str>) -> String {
    let steps = tested(report).iter().enumerate();
    let parts = [
        summary(report),
        along_tracks(report, viewer),
        figures(&report.pictures),
        steps.map(|(k, one)| step(k + 1, one, report)).collect(),
        details(report, viewer),
        small(&format!(
            "kufe {}, seed {}, data: {}",
            report.version, report.seed, report.data
        )),
    ];
    plain_page("What the model does not explain", &parts.concat())
}

/// Residuals along the tracks: that with most effects open, the others folded.
fn along_tracks(report: &Report, viewer: Option<&str>) -> String {
    let pictures = report.pictures.iter();
    let strips = pictures.filter_map(|picture| match &picture.plot {
        Plot::Strip(strip) => Some((strip, &picture.plot)),
        _ => None,
    });
    let mut strips: Vec<(&Strip, &Plot)> = strips.collect();
    strips.sort_by_key(|(strip, _)| std::cmp::Reverse(strip.places.len()));
    let drawn = strips.into_iter().enumerate().map(|(k, (strip, plot))| {
        let links = viewer.map_or_else(Vec::new, |viewer| strip_links(strip, report, viewer));
        let drawn = picture(plot, false) + &viewer_links(&links);
        match k {
            0 => drawn,
            _ => fold(
                &format!("Channel {} on track {}", strip.channel, strip.track),
                &drawn,
            ),
        }
    });
    drawn.collect()
}

/// Links to a track, to the places of effects on it, and to the runs that hit a wall at each place.
fn strip_links(strip: &Strip, report: &Report, viewer: &str) -> Vec<String> {
    /// Largest number of runs that are shown together.
    const MAX_RUNS: usize = 4;
    let part = ViewedPart {
        track: Some(&strip.track),
        ..ViewedPart::default()
    };
    let mut links = vec![part.link(viewer, &format!("track {}", strip.track))];
    let mut link = |effect: &str, [from, to]: [f64; 2], runs: &[&str]| {
        let stretch = Some(Stretch::around(from, to));
        let part = ViewedPart {
            runs,
            stretch,
            ..part
        };
        links.push(part.link(viewer, &format!("{effect}, {from:.0} to {to:.0} m")));
    };
    for place in &strip.places {
        link(&place.effect, [place.from, place.to], &[]);
    }
    for step in &report.steps {
        let places = step.contacts.iter();
        for place in places.filter(|place| place.track == strip.track) {
            let runs = place.contacts.iter().map(|contact| contact.run.as_str());
            let runs: Vec<&str> = runs.take(MAX_RUNS).collect();
            link(&step.effect, [place.from_m, place.to_m], &runs);
        }
    }
    links
}

/// Diagrams side by side, maps one below the other.
fn figures(pictures: &[Picture]) -> String {
    let is_diagram = |picture: &&Picture| matches!(picture.plot, Plot::Scatter(_));
    // Diagrams are in pairs; with an odd number of them the first is as wide as the page.
    let mut is_single = pictures.iter().filter(is_diagram).count() % 2 == 1;
    let figure = |one: &Picture| {
        let is_one_of_a_pair = is_diagram(&one) && !std::mem::take(&mut is_single);
        let class = if is_one_of_a_pair {
            ""
        } else {
            " class=\"whole\""
        };
        let (title, svg) = (escape(&one.title), picture(&one.plot, is_one_of_a_pair));
        let caption = match &*one.caption {
            "" => String::new(),
            caption => small(caption),
        };
        format!("<div{class}><h2>{title}</h2>\n{svg}\n{caption}</div>\n")
    };
    let pictures = pictures.iter();
    let figures = pictures.filter(|one| !matches!(one.plot, Plot::Strip(_)));
    let figures: String = figures.map(figure).collect();
    match &*figures {
        "" => figures,
        figures => format!("<div class=\"figures\">\n{figures}</div>\n"),
    }
}

/// Folded tables of numbers; empty tables are omitted.
fn details(report: &Report, viewer: Option<&str>) -> String {
    let held_out = &report.held_out;
    let seen = "rms residual on the data of the fit";
    let mut before_and_after = gaps(seen, &report.training);
    if !held_out.channels.is_empty() {
        before_and_after += &gaps("rms residual on held-out data", &held_out.channels);
        before_and_after += &small(&format!(
            "Held out: {}. No effect explains the sensors’ noise.",
            held_out.runs.join(", ")
        ));
    }
    let mut out = String::from("<h2>In numbers</h2>\n");
    if !report.baselines.is_empty() {
        let title = "rms residual of three models on held-out data";
        out += &models(title, &report.baselines);
    }
    let shown_if = |is_shown: bool, inner: String| if is_shown { inner } else { String::new() };
    let remains = shown_if(!tested(report).is_empty(), bins(&report.bins_after));
    let by_run = report.by_run.iter().any(|channel| channel.runs.len() >= 2);
    let by_run = shown_if(by_run, runs(&report.by_run, viewer));
    let title = "Residual by channel, before and after";
    out += &fold(title, &before_and_after);
    out += &fold("Significant bins before", &bins(&report.bins));
    out += &folded("Significant bins after", remains);
    out += &folded("Which runs to drive next", next_runs(&report.next_runs));
    out += &folded("Mean residual by run and session", by_run);
    out += &folded(
        "Parameters of the given model, refitted",
        parameters(&report.base),
    );
    let tolerated = report.within_tolerance.iter();
    let tolerated =
        tolerated.map(|part| format!("{}: {}", part.what, quantity(part.size, &part.unit)));
    let offsets = SessionOffset::by_sensor(&report.session_offsets);
    let offsets = offsets.iter().map(|one| SessionOffset::in_words(one));
    let title = "Installation errors that were corrected for";
    out += &list(title, tolerated.chain(offsets));
    let distinguished = detectable(&report.minimum_detectable);
    out += &folded("Smallest effects that these data could show", distinguished);
    let untestable = report.untestable.iter();
    let untestable = untestable.map(|(effect, reason)| format!("{effect}: {reason}"));
    out += &list("Not testable with these data", untestable);
    out + &list("Remarks", report.remarks.iter().cloned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::finding::{
        ContactPlace, Place, RunContact, Scatter, Series, Step, StripRun,
    };

    #[test]
    fn places_of_effects_link_to_the_runs_that_met_them() {
        let strip = Strip {
            track: "east & west".to_owned(),
            places: vec![Place {
                effect: "relaxation-length".to_owned(),
                from: 100.0,
                to: 150.0,
            }],
            channel: "ay".to_owned(),
            unit: "N".to_owned(),
            from_m: 0.0,
            step_m: 100.0,
            discrepancy: Vec::new(),
            runs: vec![StripRun {
                run: "A1<".to_owned(),
                session: "1".to_owned(),
                before: vec![1.0; 8],
                after: vec![0.5; 8],
            }],
        };
        let contact = RunContact {
            run: "A1<".to_owned(),
            driver: "A1".to_owned(),
            from_m: 481.0,
            to_m: 484.0,
            force_n: 900.0,
            error_n: 90.0,
        };
        let place = ContactPlace {
            track: strip.track.clone(),
            from_m: 482.0,
            to_m: 486.0,
            force_n: 900.0,
            spread_n: 0.0,
            runs: 1,
            hit: 1,
            drivers: Vec::new(),
            contacts: vec![contact],
        };
        let report = Report {
            steps: vec![Step {
                effect: "wall-contact".to_owned(),
                contacts: vec![place],
                ..Step::default()
            }],
            pictures: vec![Picture {
                title: String::new(),
                caption: String::new(),
                plot: Plot::Strip(strip),
            }],
            ..Report::default()
        };
        let page = discovery_page(&report, Some("view.html"));
        for link in [
            "<a href=\"view.html#track=east%20%26%20west\">track east &amp; west</a>",
            "<a href=\"view.html#track=east%20%26%20west&amp;over=distance&amp;from=50.00&amp;to=200.00\">relaxation-length, 100 to 150 m</a>",
            "<a href=\"view.html#run=A1%3C&amp;track=east%20%26%20west&amp;over=distance&amp;from=472.00&amp;to=496.00\">wall-contact, 482 to 486 m</a>",
        ] {
            assert!(page.contains(link), "{link} in {page}");
        }
        assert!(!discovery_page(&report, None).contains("view.html"));
    }

    #[test]
    fn names_of_foreign_files_are_text() {
        let image = "<img src=x onerror=alert(1)>".to_owned();
        let series = Series {
            name: image.clone(),
            y: vec![1.0, 2.0],
            sd: Vec::new(),
        };
        let scatter = Scatter {
            label: format!("'\"{image}"),
            x_name: image.clone(),
            y_name: image.clone(),
            x: vec![0.0, 1.0],
            series: vec![series],
            curve: None,
        };
        let report = Report {
            sentence: image.clone(),
            remarks: vec![image.clone()],
            pictures: vec![Picture {
                title: image.clone(),
                caption: image,
                plot: Plot::Scatter(scatter),
            }],
            ..Report::default()
        };
        let page = discovery_page(&report, None);
        assert!(
            page.matches("onerror").count() > 6 && !page.contains("<img"),
            "{page}"
        );
        assert!(page.contains("default-src 'none'; style-src"));
    }
}
