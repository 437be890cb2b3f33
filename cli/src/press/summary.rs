//! The results of `kufe press` as text.

use std::path::Path;

use kufe::jobs::slide::SolvedSliding;
use kufe::jobs::{SolvedContact, newtons, percent};
use kufe::results::{
    ContactResult, Length, Measured, PeakPressure, Quantity, RunnerResult, SeriesRow,
};
use kufe_contact::Measure;

/// The readable summary: the peak with its whole error and the parts of that first, then all else.
///
/// `writing` is how long the files took [s].
pub fn text(pressed: &SolvedContact, result: &ContactResult, out: &Path, writing: f64) -> String {
    let mut rows = peak(result, pressed.solution.bound());
    let p_max_map = result.p_max_map_pa.unwrap_or(result.p_max_mesh_pa);
    rows.push(("on this mesh", on_mesh(result.p_max_mesh_pa, p_max_map)));
    let stress_max = result.stress_max_pa.unwrap_or(result.p_max_mesh_pa);
    let in_field = in_field(result.p_max_mesh_pa, stress_max);
    rows.extend(in_field.map(|text| ("in field.vtu", text)));
    let of_area = if result.p_max.value >= pressed.solution.bound() {
        within(result.area, result.accuracy_reached)
    } else {
        String::new()
    };
    rows.extend([
        ("mean pressure", result.p_mean.to_string()),
        ("contact length", result.length.to_string()),
        ("contact width", result.width.to_string()),
        ("contact area", format!("{}{of_area}", result.area)),
        ("approach", result.approach.to_string()),
        (
            "pitch, roll",
            format!(
                "{} +- {}, {} +- {}",
                angle(result.pitch.value),
                angle(result.pitch.error),
                angle(result.roll.value),
                angle(result.roll.error)
            ),
        ),
        ("normal force", newtons(result.fz_n)),
    ]);
    if let Some(fit) = &result.hull_fit {
        let said = format!(
            "{:.4} µm from the hull's vertices ({:.2} % of the approach)",
            1e6 * fit.residual_rms_m,
            1e2 * fit.residual_over_approach
        );
        rows.push(("hull's fit", said));
    }
    let shear = result
        .subsurface
        .as_ref()
        .and_then(|line| line.shear.as_ref());
    rows.extend(shear.map(|found| {
        let said = format!("{} at {}", found.shear, found.depth);
        ("largest shear", said)
    }));
    rows.extend(result.runner.iter().flat_map(steel));
    rows.extend(pressed.sliding.iter().flat_map(sliding));
    rows.push((
        "solved in",
        format!(
            "{:.3} s, {} unknowns, {} iterations",
            result.seconds, result.dofs, result.iterations
        ),
    ));
    rows.push(("written to", format!("{} in {writing:.3} s", out.display())));
    let mut text = format!("{}\n", pressed.loaded.name);
    for (name, value) in rows {
        text.push_str(&format!("  {name:<18} {value}\n"));
    }
    text
}

/// The peak with its whole error, the parts of that, and the second answer; where the ice yields at
/// `bound` [Pa] its hardness is the peak.
fn peak(result: &ContactResult, bound: f64) -> Vec<(&'static str, String)> {
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
        (
            name,
            format!("+- {}", PeakPressure::DESCRIPTION.amount(part.error)),
        )
    }));
    if let Some(check) = &result.check {
        let time = 1e3 * check.check_seconds;
        let said = format!("{} by boundary elements, {time:.1} ms", check.p_max);
        rows.push(("second answer", said));
    }
    let absent = result.check_absent.as_ref();
    rows.extend(absent.map(|reason| {
        let said = format!("none by boundary elements: {reason}");
        ("second answer", said)
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
    format!(
        " (estimated error {}){short}",
        percent(measured.error / measured.value)
    )
}

/// The mesh's peak, and the maps' where their pixels miss it by more than a hundredth.
fn on_mesh(p_max_mesh: f64, p_max_map: f64) -> String {
    let mesh = format!("{:.2} MPa", p_max_mesh / 1e6);
    match (p_max_map / p_max_mesh - 1.0).abs() < 0.01 {
        true => format!("{mesh}, as in the maps"),
        false => format!(
            "{mesh}; the maps' pixels are wider than this peak and show {:.2} MPa at most",
            p_max_map / 1e6
        ),
    }
}

/// The largest stress of the field where it is more than the largest pressure.
fn in_field(p_max_mesh: f64, stress_max: f64) -> Option<String> {
    let more = stress_max / p_max_mesh - 1.0;
    (more > 0.005).then(|| {
        format!(
            "stresses up to {:.2} MPa, {:.0} % over the pressure, as they are carried on from within the cells: for the pressure take contact_pressure_pa",
            stress_max / 1e6,
            1e2 * more
        )
    })
}

/// What an elastic runner adds.
fn steel(runner: &RunnerResult) -> Vec<(&'static str, String)> {
    let at =
        |[x, y, z]: [f64; 3]| format!("x {:.1}, y {:.2}, z {:.2} mm", 1e3 * x, 1e3 * y, 1e3 * z);
    let stress = format!(
        "{:.1} MPa (von Mises) at most, at {}",
        1e-6 * runner.runner_von_mises_max_pa,
        at(runner.runner_von_mises_at_m)
    );
    let mut rows = vec![("runner's stress", stress)];
    for mount in &runner.mounts {
        // A rounding error below 0 is 0.
        let shown = |value: f64, digits: i32| {
            let scale = 10_f64.powi(digits);
            (value * scale).round() / scale + 0.0
        };
        let [fx, fy, fz] = mount.force_n.map(|force| shown(force, 1));
        let [mx, my, mz] = mount.moment_nm.map(|moment| shown(moment, 2));
        let said = format!(
            "{fz:.1} N upwards, {fx:.1} and {fy:.1} along x and y, moments {mx:.2}, {my:.2}, {mz:.2} N m, at {}",
            at(mount.at_m)
        );
        rows.push(("mount bears", said));
    }
    rows
}

/// What sliding adds.
fn sliding(slid: &SolvedSliding) -> [(&'static str, String); 7] {
    let with = |m: Measure, factor: f64, digits: usize| {
        format!(
            "{:.digits$} +- {:.digits$}",
            factor * m.value,
            factor.abs() * m.error
        )
    };
    let film = &slid.film.film;
    let thickest = film.thickest().map_or(0.0, |station| station.thickness);
    let by = &slid.sensitivity;
    let rough = by.roughness.zip(by.boundary_shear);
    let rough = rough.map_or(String::new(), |(roughness, shear)| {
        let (roughness, shear) = (roughness.value, shear.value);
        format!(", {roughness:+.2} % for roughness, {shear:+.2} % for boundary shear")
    });
    let boundary = match slid.friction.boundary {
        none if none.value == 0.0 => String::new(),
        boundary => format!(
            ", boundary {} on {:.1} % of the patch",
            with(boundary, 1e3, 3),
            1e2 * film.totals.boundary_share
        ),
    };
    [
        (
            "friction",
            format!(
                "mu {}e-3: ploughing {}, film {}{boundary}",
                with(slid.friction.mu, 1e3, 3),
                with(slid.friction.ploughing, 1e3, 3),
                with(slid.friction.viscous, 1e3, 3),
            ),
        ),
        (
            "mu changes",
            format!(
                "by {:+.2} % for 1 % more speed, {:+.2} % for hardness, {:+.2} % for viscosity{rough}; {:+.1} % on ice 1 K warmer",
                slid.sensitivity.speed.value,
                slid.sensitivity.hardness.value,
                slid.sensitivity.viscosity.value,
                1e2 * slid.sensitivity.temperature.value,
            ),
        ),
        (
            "hardness",
            format!(
                "{:.2} MPa ({}), of ice {:.2} ms under the runner",
                slid.hardness.value / 1e6,
                slid.hardness.from.in_words(),
                1e3 * slid.hardness.contact_time.value
            ),
        ),
        (
            "groove",
            format!(
                "{} µm deep, {:.4} mm2",
                with(slid.groove.deepest, 1e6, 2),
                slid.groove.profile.area() * 1e6
            ),
        ),
        (
            "patch",
            format!(
                "from {} mm ahead of the lowest point to {}",
                with(slid.groove.front, 1e3, 2),
                match slid.groove.back.value < 0.0 {
                    true => format!("{} mm behind it", with(slid.groove.back, -1e3, 2)),
                    false => format!("{} mm ahead of it", with(slid.groove.back, 1e3, 2)),
                }
            ),
        ),
        (
            "load acts",
            format!(
                "{} mm ahead of the lowest point",
                with(slid.groove.load_ahead, 1e3, 2)
            ),
        ),
        (
            "film",
            format!(
                "{:.3} µm on average, at most {:.3} µm",
                1e6 * film.totals.mean_thickness,
                1e6 * thickest
            ),
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
        let said = match &row.result {
            Some(found) => format!(
                "p_max {}, contact {} x {}{}",
                PeakPressure::DESCRIPTION.amount(found.p_max.value),
                length(found.length.value),
                length(found.width.value),
                row.error
                    .as_ref()
                    .map_or("", |_| ", requested accuracy not reached")
            ),
            None => "requested accuracy not reached".to_owned(),
        };
        text.push_str(&format!(
            "  {}  {}: {said}\n",
            row.folder,
            varied.join(", ")
        ));
    }
    let before = match retained {
        0 => String::new(),
        retained => format!(", {retained} of them there already"),
    };
    text.push_str(&format!(
        "  {} steps{before}; table.csv, table.json and series.pvd in {}\n",
        rows.len(),
        out.display()
    ));
    text
}

fn angle(radians: f64) -> String {
    match radians {
        0.0 => "0 rad".into(),
        _ => format!("{radians:.3e} rad"),
    }
}

fn length(metres: f64) -> String {
    Length::DESCRIPTION.amount(metres)
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
