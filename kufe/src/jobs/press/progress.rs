//! How far a contact is.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use kufe_contact::{Iterate, NextMesh, Options};

use crate::jobs::press::left::{MeshStart, left, time_left};

/// Options that tell how far the contact is, a line at a time, of which `asked` is the relative error: the mesh in hand, how far those before
/// it are from it, and about how long the rest takes where that is known and matters.
pub fn with_progress(
    options: Options,
    asked: f64,
    tell: impl Fn(String) + Send + Sync + 'static,
) -> Options {
    let (since, meshes) = (Instant::now(), Arc::new(Mutex::new(Vec::new())));
    let (known, tell) = (meshes.clone(), Arc::new(tell));
    let said = tell.clone();
    let ending = move |meshes: &[MeshStart], error: Option<f64>| {
        let so_far = error.map_or("not known yet".to_owned(), percent);
        let rest = left(meshes, since.elapsed().as_secs_f64(), asked);
        let rest = rest.and_then(time_left);
        let rest = rest.map_or(String::new(), |time| format!("; {time}"));
        format!("error {so_far}, asked {}{rest}", percent(asked))
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
        ..options
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::jobs::case_file::LoadedCase;
    use crate::jobs::press::press_with;
    use crate::jobs::watch::Watch;

    /// A luge steel, whose third mesh states an error of 0.202 %.
    const LUGE: &str = "[runner]\n\
        shape = { kind = \"luge\", length_m = 0.3, rocker_radius_m = 25.0, edge_radius_m = 2e-3, tilt_rad = 0.02, width_m = 0.020, height_m = 0.008 }\n\
        [ice]\nyoungs_modulus_pa = 9e9\npoissons_ratio = 0.33\nthickness_m = 0.05\n\
        [load]\nfz_n = 500.0\n[accuracy]\np_max = 0.002\n";

    #[test]
    fn a_fourth_mesh_is_told_before_it_is_solved_with_the_error_of_three_which_is_more_than_asked()
    {
        let told = Arc::new(Mutex::new(Vec::new()));
        let lines = told.clone();
        let tell = move |line: String| lines.lock().expect("lines").push(line);
        let loaded = LoadedCase::parse("luge", Path::new(""), LUGE).expect("a case");
        let options = with_progress(Options::default(), 0.002, tell);
        press_with(loaded, &Watch::default(), options).expect("an answer");
        let told = told.lock().expect("lines");
        for line in told.iter() {
            let known = !line.contains("error not known yet, asked 0.200 %");
            assert_eq!(known, line.starts_with("mesh 4: "), "{line}");
        }
        let fourth = told.iter().position(|line| line.starts_with("mesh 4: "));
        let fourth = &told[fourth.expect("a fourth mesh")..];
        assert!(fourth[0].contains("unknowns; error 0.2") && fourth.len() > 1);
        assert!(fourth[1].contains(" nodes touch, p_max "), "{fourth:?}");
    }
}
