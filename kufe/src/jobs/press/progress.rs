//! Progress of a contact, and the time that remains.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use kufe_contact::{Iterate, NextMesh, Options, SlidingIterate, SlidingWatcher};
use kufe_sled::friction::film::FilmConditions;

use crate::case::Case;
use crate::jobs::slide::{conditions, film_on};

/// Options that report how far the contact of a case is, a line at a time: the mesh in hand, the
/// error of those before it, and about how long the rest takes where that is known and matters; of
/// a runner that slides the friction after each correction of a mesh.
pub fn with_progress(
    options: Options,
    case: &Case,
    tell: impl Fn(String) + Send + Sync + 'static,
) -> Options {
    let requested = case.accuracy.p_max;
    let film = case.sliding.as_ref().map(conditions);
    let (since, meshes) = (Instant::now(), Arc::new(Mutex::new(Vec::new())));
    let (known, tell) = (meshes.clone(), Arc::new(tell));
    let (said, slid) = (tell.clone(), tell.clone());
    let ending = move |meshes: &[MeshStart], error: Option<f64>| {
        let so_far = error.map_or("not known yet".to_owned(), percent);
        let rest = remaining(meshes, since.elapsed().as_secs_f64(), requested);
        let rest = rest.and_then(time_left);
        let rest = rest.map_or(String::new(), |time| format!("; {time}"));
        format!("error {so_far}, requested {}{rest}", percent(requested))
    };
    Options {
        next_mesh: Some(Arc::new(move |mesh: &NextMesh| {
            let mut meshes = meshes.lock().unwrap_or_else(PoisonError::into_inner);
            meshes.push(MeshStart {
                at: since.elapsed().as_secs_f64(),
                dofs: mesh.dofs as f64,
                error_before: mesh.error_before,
            });
            let (number, dofs) = (mesh.level + 1, mesh.dofs);
            let end = ending(&meshes, mesh.error_before);
            said(format!("mesh {number}: {dofs} unknowns; {end}"));
        })),
        progress: Some(Arc::new(move |state: &Iterate| {
            let meshes = known.lock().unwrap_or_else(PoisonError::into_inner);
            tell(format!(
                "mesh {}: {} unknowns, {} nodes touch, p_max {:.1} MPa, residual {:.0e}; {}",
                state.level + 1,
                state.dofs,
                state.contact_nodes,
                state.p_max / 1e6,
                state.residual,
                ending(&meshes, state.error_before)
            ));
        })),
        sliding_progress: film.map(|film| -> SlidingWatcher {
            Arc::new(move |state| slid(sliding_line(state, &film, requested)))
        }),
        ..options
    }
}

/// One correction of a sliding contact: its mesh, the friction with the film of this moment.
fn sliding_line(state: &SlidingIterate, film: &FilmConditions, requested: f64) -> String {
    let ploughing = state.ploughing / state.fz;
    let friction = film_on(&state.sections, state.fz, film).map_or_else(
        |_| format!("ploughing {:.3}e-3 of the load", 1e3 * ploughing),
        |along| {
            let mu = ploughing + along.film.totals.friction;
            format!(
                "mu {:.3}e-3, ploughing {:.3}e-3 of it",
                1e3 * mu,
                1e3 * ploughing
            )
        },
    );
    let error = state
        .error_before
        .map_or("not known yet".to_owned(), percent);
    format!(
        "groove in ice of {:.2} MPa, mesh {}: {} unknowns, correction {}, forces change by {:.0e}, {friction}; error {error}, requested {}",
        state.hardness / 1e6,
        state.level + 1,
        state.dofs,
        state.corrections,
        state.residual,
        percent(requested)
    )
}

/// A force as people read it, in kN from one on [N].
pub fn newtons(force: f64) -> String {
    // 1 kN less a rounding error is 1 kN too.
    if force >= 999.95 {
        format!("{:.3} kN", force / 1e3)
    } else {
        format!("{force:.1} N")
    }
}

/// A share in per cent, small ones with more digits.
pub fn percent(share: f64) -> String {
    let percent = 1e2 * share;
    let digits = match percent {
        ..0.01 => 5,
        ..1.0 => 3,
        _ => 2,
    };
    format!("{percent:.digits$} %")
}

/// When a mesh was begun.
#[derive(Clone, Copy, Debug)]
struct MeshStart {
    /// When [s].
    pub at: f64,
    /// Its unknowns.
    pub dofs: f64,
    /// Relative error that those before it leave, where it is known.
    pub error_before: Option<f64>,
}

/// Powers of the cells' size with which errors fall, where they fall fast and slowly.
const ORDERS: [f64; 2] = [2.5, 1.5];

/// Powers of the unknowns with which a mesh's time grows, at least and at most.
const GROWTHS: [f64; 2] = [0.9, 1.3];

/// So many meshes ahead are not foreseen.
const FORESEEN: usize = 4;

/// How much longer the most may be than the least that is still worth saying.
const OPEN: f64 = 8.0;

/// Least and most time [s] from `now` on until meshes as these have the relative error `requested`:
/// as if each were finer than the one before it by what the last is. `None` before their error is
/// known, and where too much is open.
fn remaining(meshes: &[MeshStart], now: f64, requested: f64) -> Option<[f64; 2]> {
    let [.., before, last] = meshes else {
        return None;
    };
    let error = last.error_before?;
    let (took, grows) = (last.at - before.at, last.dofs / before.dofs);
    let spent = now - last.at;
    let range = [0, 1].map(|case| {
        let mesh = grows.powf(GROWTHS[case]);
        let falls = grows.powf(-ORDERS[case] / 3.0);
        let (mut time, mut total, mut error) = (took, 0.0, error);
        for _ in 0..FORESEEN {
            time *= mesh;
            error *= falls;
            total += time;
            if error <= requested {
                return Some(total);
            }
        }
        None
    });
    match range {
        [Some(least), Some(most)] if most <= OPEN * least => {
            Some([least, most].map(|total| (total - spent).max(0.0)))
        }
        _ => None,
    }
}

/// Waiting that is worth a word [s].
const WORTH: f64 = 3.0;

/// "2 to 4 s remaining" where it is long enough to matter.
pub fn time_left([least, most]: [f64; 2]) -> Option<String> {
    if most.is_nan() || most < WORTH {
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
    fn a_fourth_mesh_is_told_before_it_is_solved_with_the_error_of_three_which_is_more_than_asked()
    {
        let reported = Arc::new(Mutex::new(Vec::new()));
        let lines = reported.clone();
        let tell = move |line: String| lines.lock().expect("lines").push(line);
        let loaded = LoadedCase::parse("luge", Path::new(""), LUGE).expect("a case");
        let options = with_progress(Options::default(), &loaded.case, tell);
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

    fn begun(at: f64, dofs: f64, error_before: Option<f64>) -> MeshStart {
        MeshStart {
            at,
            dofs,
            error_before,
        }
    }

    #[test]
    fn the_time_left_holds_what_meshes_of_second_order_take_and_shrinks_as_it_passes() {
        // Each mesh has 2.83 times the unknowns and time and half the error: from 1 % to 0.45 % two
        // take 2.83 and 8 s.
        let meshes = [begun(0.0, 1e5, None), begun(1.0, 2.83e5, Some(0.01))];
        let [least, most] = remaining(&meshes, 1.0, 0.0045).expect("an estimate");
        assert!(least < 10.8 && most > 10.8, "{least} {most}");
        let [later, _] = remaining(&meshes, 3.0, 0.0045).expect("an estimate");
        assert!((least - later - 2.0).abs() < 1e-12);
        let [least, most] = remaining(&meshes, 1.0, 0.009).expect("an estimate");
        assert!(
            least < 2.83 && most > 2.83 && most < 2.0 * least,
            "{least} {most}"
        );
        // Far from what is requested, and before there are two meshes, too much is open.
        assert!(remaining(&meshes, 1.0, 0.001).is_none());
        assert!(remaining(&meshes[..1], 1.0, 0.009).is_none());
    }

    #[test]
    fn a_wait_is_told_as_a_range_and_only_where_it_matters() {
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
