//! The results of `kufe press` as text.

use std::path::Path;

use kufe::jobs::slide::SolvedSliding;
use kufe::jobs::{SolvedContact, newtons, percent};
use kufe::results::{
    ContactResult, Length, Measured, PeakPressure, Quantity, RunnerResult, SeriesRow,
};
use kufe_contact::Measure;

/// Lines: a name and its text.
type Rows = Vec<(&'static str, String)>;

/// The readable summary: the peak with its whole error and the parts of that first, then all else.
///
/// `writing` is how long the files took [s].
pub fn text(pressed: &SolvedContact, result: &ContactResult, out: &Path, writing: f64) -> String {
    let bound = pressed.solution.bound();
    let mut rows = peak(result, bound);
    let on_mesh_pa = result.p_max_mesh_pa;
    let p_max_map = result.p_max_map_pa.unwrap_or(on_mesh_pa);
    rows.push(("on this mesh", on_mesh(on_mesh_pa, p_max_map)));
    let in_field = in_field(on_mesh_pa, result.stress_max_pa.unwrap_or(on_mesh_pa));
    rows.extend(in_field.map(|text| ("in field.vtu", text)));
    let of_area = if result.p_max.value >= bound {
        within(result.area, result.accuracy_reached)
    } else {
        String::new()
    };
    let angle = |radians: f64| match radians {
        0.0 => "0 rad".into(),
        _ => format!("{radians:.3e} rad"),
    };
    let angles = [
        (result.pitch.value, result.pitch.error),
        (result.roll.value, result.roll.error),
    ];
    let angles = angles.map(|(value, error)| format!("{} +- {}", angle(value), angle(error)));
    rows.push(("mean pressure", result.p_mean.to_string()));
    rows.push(("contact length", result.length.to_string()));
    rows.push(("contact width", result.width.to_string()));
    rows.push(("contact area", format!("{}{of_area}", result.area)));
    rows.push(("approach", result.approach.to_string()));
    rows.push(("pitch, roll", angles.join(", ")));
    rows.push(("normal force", newtons(result.fz_n)));
    rows.extend(result.hull_fit.as_ref().map(|fit| {
        let (rms, share) = (1e6 * fit.residual_rms_m, 1e2 * fit.residual_over_approach);
        let text = format!("{rms:.4} µm from the hull's vertices ({share:.2} % of the approach)");
        ("hull's fit", text)
    }));
    let shear = result
        .subsurface
        .as_ref()
        .and_then(|line| line.shear.as_ref());
    let shear = shear.map(|found| format!("{} at {}", found.shear, found.depth));
    rows.extend(shear.map(|text| ("largest shear", text)));
    rows.extend(result.runner.iter().flat_map(steel));
    rows.extend(pressed.sliding.iter().flat_map(sliding));
    let (seconds, dofs, iterations) = (result.seconds, result.dofs, result.iterations);
    let solved = format!("{seconds:.3} s, {dofs} unknowns, {iterations} iterations");
    rows.push(("solved in", solved));
    rows.extend(pressed.hull.as_ref().map(|hull| {
        let [reading, fitting] = hull.seconds;
        let text = format!("{reading:.3} s, its surface fitted in {fitting:.3} s");
        ("hull read in", text)
    }));
    rows.push(("written to", format!("{} in {writing:.3} s", out.display())));
    let rows = rows
        .iter()
        .map(|(name, text)| format!("  {name:<18} {text}\n"));
    format!("{}\n{}", pressed.loaded.name, rows.collect::<String>())
}

/// The peak with its whole error, the parts of that, and the second answer; where the ice yields at
/// `bound` [Pa] its hardness is the peak.
fn peak(result: &ContactResult, bound: f64) -> Rows {
    let total = result.peak();
    if total.value >= bound {
        return vec![("peak pressure", format!("{total}, all that the ice bears"))];
    }
    let of_peak = within(total, result.accuracy_reached);
    let mut rows = vec![("peak pressure", format!("{total}{of_peak}"))];
    let parts = result.peak_error_parts();
    rows.extend(parts.iter().filter(|_| parts.len() > 1).map(|part| {
        let name = match part.source {
            "discretisation" => "  discretisation",
            "scan noise" => "  scan noise",
            _ => "  hull's fit",
        };
        let error = PeakPressure::DESCRIPTION.amount(part.error);
        (name, format!("+- {error}"))
    }));
    let check = result.check.as_ref().map(|check| {
        let time = 1e3 * check.check_seconds;
        format!("{} by boundary elements, {time:.1} ms", check.p_max)
    });
    let absent = result.check_absent.as_ref();
    let absent = absent.map(|reason| format!("none by boundary elements: {reason}"));
    rows.extend(
        check
            .into_iter()
            .chain(absent)
            .map(|text| ("second answer", text)),
    );
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

/// What sliding adds.
fn sliding(slid: &SolvedSliding) -> Rows {
    let with = |[value, error]: [f64; 2], factor: f64, digits: usize| {
        let (value, error) = (factor * value, factor.abs() * error);
        format!("{value:.digits$} +- {error:.digits$}")
    };
    let of = |m: Measure, factor: f64, digits: usize| with([m.value, m.error], factor, digits);
    let (friction, groove) = (&slid.friction, &slid.groove);
    let film = &slid.film.film;
    let [mu, ploughing, viscous, boundary] = [
        [friction.mu.value, friction.mu.error],
        [friction.ploughing.value, friction.ploughing.error],
        [friction.viscous.value, friction.viscous.error],
        [friction.boundary.value, friction.boundary.error],
    ]
    .map(|part| with(part, 1e3, 3));
    let share = 1e2 * film.totals.boundary_share;
    let boundary = match friction.boundary.value {
        0.0 => String::new(),
        _ => format!(", boundary {boundary} on {share:.1} % of the patch"),
    };
    let by = &slid.sensitivity;
    let rough = by.roughness.zip(by.boundary_shear);
    let rough = rough.map_or(String::new(), |(roughness, shear)| {
        let (roughness, shear) = (roughness.value, shear.value);
        format!(", {roughness:+.2} % for roughness, {shear:+.2} % for boundary shear")
    });
    let (speed, hardness, viscosity) = (by.speed.value, by.hardness.value, by.viscosity.value);
    let warmer = 1e2 * by.temperature.value;
    let changes = format!(
        "by {speed:+.2} % for 1 % more speed, {hardness:+.2} % for hardness, {viscosity:+.2} % for viscosity{rough}; {warmer:+.1} % on ice 1 K warmer"
    );
    let (pressure, from) = (slid.hardness.value / 1e6, slid.hardness.from.in_words());
    let time = 1e3 * slid.hardness.contact_time.value;
    let [front, ahead] = [groove.front, groove.load_ahead].map(|m| of(m, 1e3, 2));
    let back = if groove.back.value < 0.0 {
        format!("{} mm behind it", of(groove.back, -1e3, 2))
    } else {
        format!("{} mm ahead of it", of(groove.back, 1e3, 2))
    };
    let (depth, area) = (of(groove.deepest, 1e6, 2), 1e6 * groove.profile.area());
    let thickest = film
        .thickest()
        .map_or(0.0, |station| 1e6 * station.thickness);
    let mean = 1e6 * film.totals.mean_thickness;
    vec![
        (
            "friction",
            format!("mu {mu}e-3: ploughing {ploughing}, film {viscous}{boundary}"),
        ),
        ("mu changes", changes),
        (
            "hardness",
            format!("{pressure:.2} MPa ({from}), of ice {time:.2} ms under the runner"),
        ),
        ("groove", format!("{depth} µm deep, {area:.4} mm2")),
        (
            "patch",
            format!("from {front} mm ahead of the lowest point to {back}"),
        ),
        ("load acts", format!("{ahead} mm ahead of the lowest point")),
        (
            "film",
            format!("{mean:.3} µm on average, at most {thickest:.3} µm"),
        ),
    ]
}

/// The steps of a series, a line each.
pub fn series(rows: &[SeriesRow], retained: usize, out: &Path) -> String {
    let mut text = String::new();
    for row in rows {
        let varied = row.varied.named().into_iter();
        let varied: Vec<String> = varied
            .map(|(key, value)| format!("{key} = {value}"))
            .collect();
        let mut parts = Vec::new();
        if let Some(found) = &row.result {
            let peak = PeakPressure::DESCRIPTION.amount(found.p_max.value);
            let [length, width] =
                [found.length.value, found.width.value].map(|m| Length::DESCRIPTION.amount(m));
            parts.push(format!("p_max {peak}, contact {length} x {width}"));
        }
        if row.error.is_some() {
            parts.push("requested accuracy not reached".to_owned());
        }
        let (folder, varied, parts) = (&row.folder, varied.join(", "), parts.join(", "));
        text += &format!("  {folder}  {varied}: {parts}\n");
    }
    let before = match retained {
        0 => String::new(),
        retained => format!(", {retained} of them there already"),
    };
    text + &format!(
        "  {} steps{before}; table.csv, table.json and series.pvd in {}\n",
        rows.len(),
        out.display()
    )
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
