//! What `kufe press` says in words.

use std::path::Path;

use kufe::jobs::slide::Slid;
use kufe::jobs::{Pressed, percent};
use kufe_contact::{Measure, RunnerLoads, Solution};

use crate::press::series::table::Row;

/// The picture's title.
pub fn title(solution: &Solution) -> String {
    format!(
        "p_max {:.2} MPa ({:.2} on this mesh)   Fz {}   contact {} x {}",
        solution.p_max / 1e6,
        solution.p_max_mesh / 1e6,
        force(solution.fz),
        length(solution.length),
        length(solution.width),
    )
}

/// The readable summary; the largest pressure of the maps and the largest stress of the field are `p_max_map` and `stress_max` [Pa].
pub fn text(pressed: &Pressed, [p_max_map, stress_max]: [f64; 2], out: &Path) -> String {
    let solution = &pressed.solution;
    let yields = solution.p_max >= solution.bound();
    let within = |value: f64, error: f64| {
        let short = match pressed.short {
            Some(_) => ": the accuracy asked was not reached",
            None => "",
        };
        format!(" (estimated error {}){short}", percent(error / value))
    };
    let [of_peak, of_area] = match yields {
        false => [within(solution.p_max, solution.p_max_error), String::new()],
        true => [
            ", all that the ice bears".to_owned(),
            within(solution.area, solution.area_error),
        ],
    };
    let mut rows = vec![
        (
            "peak pressure",
            format!(
                "{:.2} MPa +- {:.2}{of_peak}",
                solution.p_max / 1e6,
                solution.p_max_error / 1e6,
            ),
        ),
        ("on this mesh", on_mesh(solution.p_max_mesh, p_max_map)),
        (
            "mean pressure",
            format!(
                "{:.2} MPa +- {:.2}",
                solution.p_mean / 1e6,
                solution.p_mean_error / 1e6
            ),
        ),
        (
            "contact length",
            length_within(solution.length, solution.length_error),
        ),
        (
            "contact width",
            length_within(solution.width, solution.width_error),
        ),
        (
            "contact area",
            format!(
                "{:.4} mm2 +- {:.4}{of_area}",
                solution.area * 1e6,
                solution.area_error * 1e6
            ),
        ),
        (
            "approach",
            format!(
                "{:.3} µm +- {:.3}",
                solution.approach * 1e6,
                solution.approach_error * 1e6
            ),
        ),
        (
            "pitch, roll",
            format!(
                "{} +- {}, {} +- {}",
                angle(solution.pitch),
                angle(solution.pitch_error),
                angle(solution.roll),
                angle(solution.roll_error)
            ),
        ),
        ("normal force", force(solution.fz)),
        (
            "solved in",
            format!(
                "{:.3} s, {} unknowns, {} iterations",
                pressed.seconds, solution.dofs, solution.iterations
            ),
        ),
        ("written to", out.display().to_string()),
    ];
    if let Some(hull) = &pressed.hull {
        let residual = hull.underside.quality().residual_rms;
        let share = 1e2 * residual / solution.approach;
        let fit = format!(
            "{:.4} µm from the hull's vertices ({share:.2} % of the approach)",
            1e6 * residual
        );
        rows.insert(rows.len() - 2, ("hull's fit", fit));
    }
    if let Some(under) = &solution.under_peak {
        let shear = format!(
            "{:.2} MPa +- {:.2} at {}",
            under.shear / 1e6,
            under.shear_error / 1e6,
            length_within(under.depth, under.depth_error)
        );
        rows.insert(rows.len() - 2, ("largest shear", shear));
    }
    if let Some(loads) = &pressed.runner {
        let place = rows.len() - 2;
        rows.splice(place..place, steel(loads));
    }
    // Where the ice yields both have its hardness as their peak.
    if let Some(check) = pressed.check.as_ref().filter(|_| !yields) {
        let second = match &check.found {
            Ok(found) => format!(
                "{:.2} MPa +- {:.2} by boundary elements, {:.1} ms",
                found.p_max / 1e6,
                found.p_max_error / 1e6,
                1e3 * check.seconds
            ),
            Err(reason) => format!("none by boundary elements: {reason}"),
        };
        rows.insert(1, ("second answer", second));
    }
    if let Some(slid) = &pressed.sliding {
        let place = rows.len() - 2;
        rows.splice(place..place, sliding(slid));
    }
    let place = rows.iter().position(|(name, _)| *name == "on this mesh");
    if let (Some(place), Some(said)) = (place, in_field(solution.p_max_mesh, stress_max)) {
        rows.insert(place + 1, ("in field.vtu", said));
    }
    for (by, error) in [("noise", pressed.moved), ("spacing", pressed.between)] {
        let moved = error.map(|error| 1e-6 * error.p_max * solution.p_max);
        if let Some(moved) = moved {
            let said = format!("+- {moved:.2} MPa of the peak besides, by their {by}");
            rows.insert(1, ("hull's vertices", said));
        }
    }
    let mut text = format!("{}\n", pressed.loaded.name);
    for (name, value) in rows {
        text.push_str(&format!("  {name:<15} {value}\n"));
    }
    text
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
fn steel(loads: &RunnerLoads) -> Vec<(&'static str, String)> {
    let at =
        |[x, y, z]: [f64; 3]| format!("x {:.1}, y {:.2}, z {:.2} mm", 1e3 * x, 1e3 * y, 1e3 * z);
    let stress = format!(
        "{:.1} MPa (von Mises) at most, at {}",
        1e-6 * loads.von_mises,
        at(loads.at)
    );
    let mut rows = vec![("runner's stress", stress)];
    for mount in &loads.mounts {
        // A rounding error below 0 is 0.
        let shown = |value: f64, digits: i32| {
            let scale = 10_f64.powi(digits);
            (value * scale).round() / scale + 0.0
        };
        let [fx, fy, fz] = mount.force.map(|force| shown(force, 1));
        let [mx, my, mz] = mount.moment.map(|moment| shown(moment, 2));
        let said = format!(
            "{fz:.1} N upwards, {fx:.1} and {fy:.1} along x and y, moments {mx:.2}, {my:.2}, {mz:.2} N m, at {}",
            at(mount.at)
        );
        rows.push(("mount bears", said));
    }
    rows
}

/// What sliding adds.
fn sliding(slid: &Slid) -> [(&'static str, String); 7] {
    let with = |m: Measure, factor: f64, digits: usize| {
        format!(
            "{:.digits$} +- {:.digits$}",
            factor * m.value,
            factor.abs() * m.error
        )
    };
    let film = &slid.film.film;
    let thickest = film.thickest().map_or(0.0, |station| station.thickness);
    [
        (
            "friction",
            format!(
                "mu {}e-3: ploughing {}, film {}",
                with(slid.friction.mu, 1e3, 3),
                with(slid.friction.ploughing, 1e3, 3),
                with(slid.friction.viscous, 1e3, 3),
            ),
        ),
        (
            "mu changes",
            format!(
                "by {:+.2} % for 1 % more speed, {:+.2} % for hardness, {:+.2} % for viscosity; {:+.1} % on ice 1 K warmer",
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
pub fn series(rows: &[Row], kept: usize, out: &Path) -> String {
    let mut text = String::new();
    for row in rows {
        let varied: Vec<String> = row
            .values
            .iter()
            .map(|(k, v)| format!("{k} = {v}"))
            .collect();
        let figure = |key: &str| row.result.as_ref().and_then(|r| r[key].as_f64());
        let said = match (figure("p_max_pa"), figure("length_m"), figure("width_m")) {
            (Some(p), Some(l), Some(w)) => {
                let short = row
                    .error
                    .as_ref()
                    .map_or("", |_| ", short of the accuracy asked");
                format!(
                    "p_max {:.2} MPa, contact {} x {}{short}",
                    p / 1e6,
                    length(l),
                    length(w)
                )
            }
            _ => "short of the accuracy asked".to_owned(),
        };
        text.push_str(&format!(
            "  {}  {}: {said}\n",
            row.folder,
            varied.join(", ")
        ));
    }
    let held = match kept {
        0 => String::new(),
        kept => format!(", {kept} of them there already"),
    };
    text.push_str(&format!(
        "  {} steps{held}; table.csv, table.json and series.pvd in {}\n",
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

fn length_within(metres: f64, error: f64) -> String {
    format!("{} +- {:.*}", length(metres), digits(metres), 1e3 * error)
}

fn length(metres: f64) -> String {
    format!("{:.*} mm", digits(metres), metres * 1e3)
}

/// Digits of a length in millimetres.
fn digits(metres: f64) -> usize {
    if metres >= 1e-3 { 2 } else { 4 }
}

fn force(newtons: f64) -> String {
    // 1 kN less a rounding error is 1 kN too.
    if newtons >= 999.95 {
        format!("{:.3} kN", newtons / 1e3)
    } else {
        format!("{newtons:.1} N")
    }
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
