//! The results of `kufe press` as text.

use std::path::Path;

use kufe::jobs::{Failure, SolvedContact};
use kufe::plot::{Scale, percent, quantity};
use kufe::results::{ContactResult, Figure, MountResult};

/// The readable summary: figures of the result and of its files, and times.
///
/// `writing` is the time of writing the files [s].
///
/// # Errors
/// [`Failure::BadInput`] for a result that cannot be written as JSON.
pub fn text(
    pressed: &SolvedContact,
    result: &ContactResult,
    out: &Path,
    writing: f64,
) -> Result<String, Failure> {
    let mut rows = result.figures()?;
    let on_mesh_pa = result.p_max_mesh_pa;
    let p_max_map = result.p_max_map_pa.unwrap_or(on_mesh_pa);
    rows.push(on_mesh(on_mesh_pa, p_max_map));
    rows.extend(in_field(
        on_mesh_pa,
        result.stress_max_pa.unwrap_or(on_mesh_pa),
    ));
    rows.extend(
        result
            .runner
            .iter()
            .flat_map(|runner| &runner.mounts)
            .map(mount),
    );
    rows.extend(pressed.hull.as_ref().map(|hull| {
        let [reading, fitting] = hull.seconds.map(|time| quantity(time, "s"));
        let read = format!("read in {reading}, its surface fitted in {fitting}");
        Figure::new("hull", read, "")
    }));
    let (out, time) = (out.display().to_string(), quantity(writing, "s"));
    rows.push(Figure::new("written to", out, format!("in {time}")));
    let wide = rows.iter().map(|row| row.name.chars().count()).max();
    let wide = wide.unwrap_or_default();
    let rows = rows.iter().map(|Figure { name, text, note }| {
        let note = Some(note).filter(|note| !note.is_empty());
        let note = note.map_or(String::new(), |note| format!(" ({note})"));
        format!("  {name:<wide$}  {text}{note}\n")
    });
    Ok(format!(
        "{}\n{}",
        pressed.loaded.name,
        rows.collect::<String>()
    ))
}

/// The peak on the mesh, and the peak of the maps if it differs by more than 1 %.
fn on_mesh(p_max_mesh: f64, p_max_map: f64) -> Figure {
    let [mesh, map] = [p_max_mesh, p_max_map].map(|pressure| quantity(pressure, "Pa"));
    let note = if (p_max_map / p_max_mesh - 1.0).abs() < 0.01 {
        "as in the maps".to_owned()
    } else {
        format!("the maps' pixels are wider than this peak and show {map} at most")
    };
    Figure::new("on this mesh", mesh, note)
}

/// The largest stress of the field if it exceeds the largest pressure.
fn in_field(p_max_mesh: f64, stress_max: f64) -> Option<Figure> {
    let more = stress_max / p_max_mesh - 1.0;
    (more > 0.005).then(|| {
        let note = format!(
            "stress, {} above the pressure because it is extrapolated from within the cells; the pressure is contact_pressure_pa",
            percent(more)
        );
        Figure::new("in field.vtu", quantity(stress_max, "Pa"), note)
    })
}

/// The load on a part of the mount.
fn mount(mount: &MountResult) -> Figure {
    let shown = |values: [f64; 3], unit: &str| {
        let largest = values
            .iter()
            .fold(0.0, |most: f64, value| most.max(value.abs()));
        // Rounding errors are shown as 0.
        let values = values.map(|value| {
            if value.abs() < 1e-6 * largest {
                0.0
            } else {
                value
            }
        });
        let scale = Scale::of(unit, largest);
        scale.with_unit(&values.map(|value| scale.number(value)).join(", "))
    };
    let note = format!(
        "moments {}, at {}",
        shown(mount.moment_nm, "N m"),
        shown(mount.at_m, "m")
    );
    let force = shown(mount.force_n, "N");
    Figure::new("mount bears along x, y, z", force, note)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_that_the_maps_miss_is_marked() {
        assert_eq!(on_mesh(139.39e6, 139.38e6).note, "as in the maps");
        let narrow = on_mesh(915.43e6, 678.83e6);
        assert!(narrow.text == "915.4 MPa" && narrow.note.contains("678.8 MPa at most"));
    }

    #[test]
    fn stresses_beyond_the_pressure_are_explained_and_no_others() {
        assert_eq!(in_field(139.39e6, 139.4e6), None);
        let more = in_field(100e6, 109e6).expect("a note");
        assert!(more.text == "109 MPa" && more.note.contains("9.00 % above the pressure"));
    }
}
