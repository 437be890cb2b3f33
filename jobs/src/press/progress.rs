//! How far a contact is.

use kufe_contact::Iterate;

/// One line while the solver works: the mesh in hand, and how far those before it are from the relative error `asked`.
pub fn progress_line(state: &Iterate, asked: f64) -> String {
    let so_far = state
        .error_before
        .map_or("not known yet".to_owned(), percent);
    format!(
        "mesh {}: {} unknowns, {} nodes touch, p_max {:.1} MPa, residual {:.0e}; error {so_far}, asked {}",
        state.level + 1,
        state.dofs,
        state.contact_nodes,
        state.p_max / 1e6,
        state.residual,
        percent(asked)
    )
}

/// A share in per cent, small ones with a digit more.
pub fn percent(share: f64) -> String {
    let percent = 1e2 * share;
    let digits = if percent < 1.0 { 3 } else { 2 };
    format!("{percent:.digits$} %")
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::{Arc, Mutex};

    use kufe_contact::{Options, Watcher};

    use super::*;
    use crate::case_file::LoadedCase;
    use crate::press::press_with;
    use crate::watch::Watch;

    const ASKED: f64 = 0.002;

    /// A luge steel, whose third mesh states an error of 0.202 %.
    const LUGE: &str = "[runner]\n\
        shape = { kind = \"luge\", length_m = 0.3, rocker_radius_m = 25.0, edge_radius_m = 2e-3, tilt_rad = 0.02, width_m = 0.020, height_m = 0.008 }\n\
        [ice]\nyoungs_modulus_pa = 9e9\npoissons_ratio = 0.33\nthickness_m = 0.05\n\
        [load]\nfz_n = 500.0\n[accuracy]\np_max = 0.002\n";

    #[test]
    fn a_fourth_mesh_is_told_with_the_error_of_three_which_is_more_than_asked() {
        let told = Arc::new(Mutex::new(Vec::new()));
        let lines = told.clone();
        let watcher: Watcher = Arc::new(move |state: &Iterate| {
            if let Ok(mut lines) = lines.lock() {
                lines.push((state.level, state.error_before, progress_line(state, ASKED)));
            }
        });
        let loaded = LoadedCase::parse("luge", Path::new(""), LUGE).expect("a case");
        let options = Options {
            progress: Some(watcher),
            ..Options::default()
        };
        press_with(loaded, &Watch::default(), options).expect("an answer");
        let told = told.lock().expect("lines");
        for (level, error, line) in told.iter() {
            let text = error.map_or("error not known yet".to_owned(), |e| {
                format!("error {}", percent(e))
            });
            assert!(line.ends_with(&format!("{text}, asked 0.200 %")), "{line}");
            assert!(*level > 2 || error.is_none(), "{line}");
            assert!(error.is_none_or(|error| error > ASKED), "{line}");
        }
        assert!(told.iter().any(|(_, error, _)| error.is_some()), "{told:?}");
    }
}
