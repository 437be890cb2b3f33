//! The results of `kufe press` as text.

use std::path::Path;

use kufe::jobs::{Failure, SolvedContact, newtons, percent};
use kufe::results::{
    ContactResult, Data, Datum, Measured, PeakPressure, QUANTITIES, Quantity, RunnerResult,
};

use crate::text::measured;

/// Lines: a name and its text.
type Rows = Vec<(&'static str, String)>;

/// The readable summary: the peak with its whole error and the parts of that first, then every other
/// quantity of the result.
///
/// `writing` is how long the files took [s].
///
/// # Errors
/// [`Failure::BadInput`] for a result that JSON cannot state.
pub fn text(
    pressed: &SolvedContact,
    result: &ContactResult,
    out: &Path,
    writing: f64,
) -> Result<String, Failure> {
    let mut rows = peak(result, pressed.solution.bound());
    let on_mesh_pa = result.p_max_mesh_pa;
    let p_max_map = result.p_max_map_pa.unwrap_or(on_mesh_pa);
    rows.push(("on this mesh", on_mesh(on_mesh_pa, p_max_map)));
    let in_field = in_field(on_mesh_pa, result.stress_max_pa.unwrap_or(on_mesh_pa));
    rows.extend(in_field.map(|text| ("in field.vtu", text)));
    rows.extend(quantities(result)?);
    let absent = result.check_absent.as_ref();
    rows.extend(absent.map(|reason| ("by boundary elements", format!("no peak: {reason}"))));
    rows.push(("normal force", newtons(result.fz_n)));
    rows.extend(result.hull_fit.as_ref().map(|fit| {
        let (rms, share) = (1e6 * fit.residual_rms_m, 1e2 * fit.residual_over_approach);
        let text = format!("{rms:.4} µm from the hull's vertices ({share:.2} % of the approach)");
        ("hull's fit", text)
    }));
    rows.extend(result.runner.iter().flat_map(steel));
    rows.extend(pressed.sliding.as_ref().map(|slid| {
        let (pressure, from) = (1e-6 * slid.hardness.value, slid.hardness.from.in_words());
        ("hardness", format!("{pressure:.2} MPa ({from})"))
    }));
    let (seconds, dofs, iterations) = (result.seconds, result.dofs, result.iterations);
    let solved = format!("{seconds:.3} s, {dofs} unknowns, {iterations} iterations");
    rows.push(("solved in", solved));
    rows.extend(pressed.hull.as_ref().map(|hull| {
        let [reading, fitting] = hull.seconds;
        let text = format!("{reading:.3} s, its surface fitted in {fitting:.3} s");
        ("hull read in", text)
    }));
    rows.push(("written to", format!("{} in {writing:.3} s", out.display())));
    let wide = rows.iter().map(|(name, _)| name.chars().count()).max();
    let wide = wide.unwrap_or_default();
    let rows = rows.iter();
    let rows = rows.map(|(name, text)| format!("  {name:<wide$}  {text}\n"));
    Ok(format!(
        "{}\n{}",
        pressed.loaded.name,
        rows.collect::<String>()
    ))
}

/// Every quantity of the result but the peak pressure, with its error.
fn quantities(result: &ContactResult) -> Result<Rows, Failure> {
    let document = Datum::of(result)?;
    let whole = document.group();
    let part = |key: &str| whole?.get(key)?.group();
    let parts = ["subsurface", "mu_sensitivity"].map(part);
    let groups: Vec<&Data> = parts.into_iter().chain([whole]).flatten().collect();
    let others = QUANTITIES
        .iter()
        .filter(|one| **one != PeakPressure::DESCRIPTION);
    let rows = others.filter_map(|one| {
        let found = groups.iter().find_map(|data| measured(data, one.key));
        Some((one.label, found?))
    });
    Ok(rows.collect())
}

/// The peak with its whole error, and the parts of that; where the ice yields at `bound` [Pa] its
/// hardness is the peak.
fn peak(result: &ContactResult, bound: f64) -> Rows {
    let total = result.peak();
    if total.value >= bound {
        return vec![("peak pressure", format!("{total}, all that the ice bears"))];
    }
    let of_peak = within(total, result.accuracy_reached);
    let mut rows = vec![("peak pressure", format!("{total}{of_peak}"))];
    let parts = result.peak_error_parts();
    rows.extend(parts.iter().filter(|_| parts.len() > 1).map(|part| {
        let error = PeakPressure::DESCRIPTION.amount(part.error);
        ("of that", format!("+- {error} by {}", part.source))
    }));
    rows
}

/// A relative error, and whether it is what the case requests.
fn within<Q: Quantity>(measured: Measured<Q>, reached: bool) -> String {
    let short = if reached {
        ""
    } else {
        ": the requested accuracy was not reached"
    };
    let error = percent(measured.error / measured.value);
    format!(" (estimated error {error}){short}")
}

/// The mesh's peak, and the maps' where their pixels miss it by more than a hundredth.
fn on_mesh(p_max_mesh: f64, p_max_map: f64) -> String {
    let (mesh, map) = (1e-6 * p_max_mesh, 1e-6 * p_max_map);
    if (p_max_map / p_max_mesh - 1.0).abs() < 0.01 {
        format!("{mesh:.2} MPa, as in the maps")
    } else {
        format!(
            "{mesh:.2} MPa; the maps' pixels are wider than this peak and show {map:.2} MPa at most"
        )
    }
}

/// The largest stress of the field where it is more than the largest pressure.
fn in_field(p_max_mesh: f64, stress_max: f64) -> Option<String> {
    let (more, stress) = (1e2 * (stress_max / p_max_mesh - 1.0), 1e-6 * stress_max);
    (more > 0.5).then(|| {
        format!(
            "stresses up to {stress:.2} MPa, {more:.0} % over the pressure, as they are carried on from within the cells: for the pressure take contact_pressure_pa"
        )
    })
}

/// What an elastic runner adds.
fn steel(runner: &RunnerResult) -> Rows {
    let at =
        |[x, y, z]: [f64; 3]| format!("x {:.1}, y {:.2}, z {:.2} mm", 1e3 * x, 1e3 * y, 1e3 * z);
    let (stress, place) = (
        1e-6 * runner.runner_von_mises_max_pa,
        at(runner.runner_von_mises_at_m),
    );
    let stress = format!("{stress:.1} MPa (von Mises) at most, at {place}");
    let mounts = runner.mounts.iter().map(|mount| {
        // A rounding error below 0 is 0.
        let shown = |value: f64, scale: f64| (value * scale).round() / scale + 0.0;
        let [fx, fy, fz] = mount.force_n.map(|force| shown(force, 1e1));
        let [mx, my, mz] = mount.moment_nm.map(|moment| shown(moment, 1e2));
        let place = at(mount.at_m);
        let text = format!(
            "{fz:.1} N upwards, {fx:.1} and {fy:.1} along x and y, moments {mx:.2}, {my:.2}, {mz:.2} N m, at {place}"
        );
        ("mount bears", text)
    });
    std::iter::once(("runner's stress", stress))
        .chain(mounts)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_that_the_maps_miss_is_said_to_be_missed() {
        assert_eq!(on_mesh(139.39e6, 139.38e6), "139.39 MPa, as in the maps");
        let narrow = on_mesh(915.43e6, 678.83e6);
        assert!(narrow.contains("915.43 MPa;") && narrow.contains("678.83 MPa at most"));
    }

    #[test]
    fn stresses_beyond_the_pressure_are_explained_and_no_others() {
        assert_eq!(in_field(139.39e6, 139.4e6), None);
        let more = in_field(100e6, 109e6).expect("a note");
        assert!(more.contains("109.00 MPa, 9 % over the pressure"));
    }
}
