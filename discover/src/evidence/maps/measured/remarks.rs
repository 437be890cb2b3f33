//! Limits of what pressure measurements can identify.

use kufe::case::effects::CATALOGUE;

use crate::evidence::maps::measured::rows::Row;

/// Effects that these rows can hardly identify, with the reason.
pub fn untestable(rows: &[Row]) -> Vec<(String, String)> {
    let mapped = rows.iter().any(|r| r.map.is_some());
    let reason = "needs the column map, which is absent or empty";
    CATALOGUE
        .iter()
        .filter(|e| e.search.needs_map && !mapped)
        .map(|e| (e.info().name.to_owned(), reason.to_owned()))
        .collect()
}

/// Remarks on the rows.
pub fn remarks_on(rows: &[Row]) -> Vec<String> {
    let mut remarks = vec![
        "errors of a pixel: the sensor's noise as the map itself shows it, a third of a pixel in its place, 0.3 % of the peak, and what a finer mesh changes; 16 neighbouring pixels count as one value; shift and rotation of each film are fitted within its tolerance".to_owned(),
    ];
    if rows.iter().any(|r| r.map.is_none()) {
        remarks.push("rows without a map contribute their peak pressure alone".to_owned());
    }
    if rows.len() < 3 {
        remarks.push(format!(
            "{} rows are too few to hold one out: the misfit is that of the training rows",
            rows.len()
        ));
    }
    let same = |value: &dyn Fn(&Row) -> f64| rows.iter().all(|r| value(r) == value(&rows[0]));
    if same(&|r| r.fz) && same(&|r| r.problem.track_curvature) {
        remarks.push(format!(
            "fz_n and radius_m are the same in all rows ({} N): effects that differ by load alone cannot be distinguished",
            rows[0].fz
        ));
    }
    remarks
}

/// Root mean square of the stated and estimated deviations \[Pa\].
pub fn typical_noise(rows: &[&Row]) -> f64 {
    let of_row = |row: &&Row| {
        if row.noise.is_empty() {
            vec![row.p_max_sd]
        } else {
            row.noise.clone()
        }
    };
    let deviations: Vec<f64> = rows.iter().flat_map(of_row).collect();
    let squares: f64 = deviations.iter().map(|sd| sd * sd).sum();
    f64::sqrt(squares / f64::max(deviations.len() as f64, 1.0))
}
