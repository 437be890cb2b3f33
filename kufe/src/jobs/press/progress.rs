//! Progress messages of a contact's solution, and remaining times in words.

use std::sync::Arc;

use kufe_contact::{Iterate, NextMesh, Options, SlidingIterate, SlidingWatcher};
use kufe_sled::friction::film::FilmConditions;

use crate::case::Case;
use crate::jobs::slide::{conditions, film_on};
use crate::plot::{percent, quantity};

/// Options that report the progress of a case's solution, one line per call: the current mesh and
/// the error of the meshes before it; for a sliding runner, mu after each correction of a mesh.
pub fn with_progress(
    options: Options,
    case: &Case,
    report: impl Fn(String) + Send + Sync + 'static,
) -> Options {
    let requested = case.accuracy.p_max;
    let film = case.sliding.as_ref().map(conditions);
    let report = Arc::new(report);
    let (by_mesh, by_groove) = (report.clone(), report.clone());
    Options {
        next_mesh: Some(Arc::new(move |mesh: &NextMesh| {
            let (number, dofs) = (mesh.level + 1, mesh.dofs);
            let error = errors(mesh.error_before, requested);
            by_mesh(format!("mesh {number}: {dofs} unknowns; {error}"));
        })),
        progress: Some(Arc::new(move |state: &Iterate| {
            report(format!(
                "mesh {}: {} unknowns, {} nodes touch, p_max {}, residual {:.0e}; {}",
                state.level + 1,
                state.dofs,
                state.contact_nodes,
                quantity(state.p_max, "Pa"),
                state.residual,
                errors(state.error_before, requested)
            ));
        })),
        sliding_progress: film.map(|film| -> SlidingWatcher {
            Arc::new(move |state| by_groove(sliding_line(state, &film, requested)))
        }),
        ..options
    }
}

/// The error of the meshes so far, if it is known, and the requested error.
fn errors(so_far: Option<f64>, requested: f64) -> String {
    let so_far = so_far.map_or("not known yet".to_owned(), percent);
    format!("error {so_far}, requested {}", percent(requested))
}

/// One correction of a sliding contact: its mesh, and the friction with the film on it.
fn sliding_line(state: &SlidingIterate, film: &FilmConditions, requested: f64) -> String {
    let ploughing = state.ploughing / state.fz;
    let friction = film_on(&state.sections, state.fz, film).map_or_else(
        |_| format!("ploughing {:.3}e-3 of the load", 1e3 * ploughing),
        |film| {
            let mu = ploughing + film.totals.friction;
            format!(
                "mu {:.3}e-3, ploughing {:.3}e-3 of it",
                1e3 * mu,
                1e3 * ploughing
            )
        },
    );
    format!(
        "groove in ice of {}, mesh {}: {} unknowns, correction {}, forces change by {:.0e}, {friction}; {}",
        quantity(state.hardness, "Pa"),
        state.level + 1,
        state.dofs,
        state.corrections,
        state.residual,
        errors(state.error_before, requested)
    )
}

/// Shortest remaining time that is reported [s].
const MIN_REPORTED: f64 = 3.0;

/// A range of remaining time [s] in words, as "2 to 4 s remaining"; `None` if it is NaN or short.
pub fn time_left([least, most]: [f64; 2]) -> Option<String> {
    if most.is_nan() || most < MIN_REPORTED {
        return None;
    }
    let (scale, unit) = match most {
        ..120.0 => (1.0, "s"),
        ..7200.0 => (60.0, "min"),
        _ => (3600.0, "h"),
    };
    let [least, most] = [least, most].map(|time| (time / scale).round());
    Some(if least >= most {
        format!("about {most} {unit} remaining")
    } else if least == 0.0 {
        format!("up to {most} {unit} remaining")
    } else {
        format!("{least} to {most} {unit} remaining")
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Mutex;

    use super::*;
    use crate::Contact;
    use crate::jobs::case_file::LoadedCase;
    use crate::jobs::watch::Watch;

    /// A luge steel, whose third mesh states an error of 0.202 %.
    const LUGE: &str = "[runner]\n\
        shape = { kind = \"luge\", length_m = 0.3, rocker_radius_m = 25.0, edge_radius_m = 2e-3, tilt_rad = 0.02, width_m = 0.020, height_m = 0.008 }\n\
        [ice]\nyoungs_modulus_pa = 9e9\npoissons_ratio = 0.33\nthickness_m = 0.05\n\
        [load]\nfz_n = 500.0\n[accuracy]\np_max = 0.002\n";

    #[test]
    fn a_fourth_mesh_is_reported_before_it_is_solved_with_the_error_of_three_meshes() {
        let reported = Arc::new(Mutex::new(Vec::new()));
        let lines = reported.clone();
        let report = move |line: String| lines.lock().expect("lines").push(line);
        let loaded = LoadedCase::parse("luge", Path::new(""), LUGE).expect("a case");
        let options = with_progress(Options::default(), &loaded.case, report);
        let contact = Contact::from(loaded).options(options);
        contact.best(&Watch::default()).expect("an answer");
        let reported = reported.lock().expect("lines");
        for line in reported.iter() {
            let known = !line.contains("error not known yet, requested 0.200 %");
            assert_eq!(known, line.starts_with("mesh 4: "), "{line}");
        }
        let fourth = reported
            .iter()
            .position(|line| line.starts_with("mesh 4: "));
        let fourth = &reported[fourth.expect("a fourth mesh")..];
        assert!(fourth[0].contains("unknowns; error 0.2") && fourth.len() > 1);
        assert!(fourth[1].contains(" nodes touch, p_max "), "{fourth:?}");
    }

    #[test]
    fn remaining_time_is_a_range_and_appears_only_after_a_while() {
        assert_eq!(time_left([0.4, 2.9]), None);
        assert_eq!(
            time_left([0.2, 4.2]).as_deref(),
            Some("up to 4 s remaining")
        );
        assert_eq!(
            time_left([4.2, 9.8]).as_deref(),
            Some("4 to 10 s remaining")
        );
        assert_eq!(
            time_left([89.0, 91.0]).as_deref(),
            Some("89 to 91 s remaining")
        );
        assert_eq!(
            time_left([100.0, 290.0]).as_deref(),
            Some("2 to 5 min remaining")
        );
        assert_eq!(
            time_left([170.0, 190.0]).as_deref(),
            Some("about 3 min remaining")
        );
    }
}
