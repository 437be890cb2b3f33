//! mu over pressure, and its residuals over the columns that the named effects need.

use kufe_sled::correlation;

use crate::evidence::experiments::base::Base;
use crate::evidence::experiments::fit::{Fit, Setting};
use crate::evidence::experiments::rows::{Row, further_columns};
use crate::finding::{Curve, Picture, Plot, Scatter, Series};

/// Rows of a moving mean of a curve.
const ROWS: usize = 5;

/// Measured coefficients with the law, and each named effect over its strongest column.
pub fn pictures(setting: &Setting, rows: &[Row], first: &Fit, last: &Fit) -> Vec<Picture> {
    let named = (0..last.chosen.len()).filter_map(|k| effect_picture(setting, rows, last, k));
    [law(setting, rows, first)]
        .into_iter()
        .chain(named)
        .collect()
}

/// Contribution of an effect over its strongest column, with residuals of the fit without it.
fn effect_picture(setting: &Setting, rows: &[Row], last: &Fit, k: usize) -> Option<Picture> {
    let adds = |row: &Row| 1e3 * last.added(setting, row, k);
    let added: Vec<f64> = rows.iter().map(adds).collect();
    let strength = |values: &[f64]| correlation(values, &added).abs();
    let (column, x) = further_columns(rows)
        .into_iter()
        .max_by(|a, b| strength(&a.1).total_cmp(&strength(&b.1)))?;
    let mut ordered: Vec<(f64, f64)> = x.iter().copied().zip(added.iter().copied()).collect();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0));
    let means = ordered.chunks(ROWS).map(|part| {
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / part.len() as f64;
        (
            mean(&mut part.iter().map(|row| row.0)),
            mean(&mut part.iter().map(|row| row.1)),
        )
    });
    let (line_x, line_y) = means.unzip();
    let without = |(row, added): (&Row, &f64)| 1e3 * last.residual(setting, row) + added;
    let effect = &setting.candidates[last.chosen[k]].effect;
    Some(Picture {
        title: format!("{effect} over {column}"),
        caption: format!(
            "Points: the residual of each row without {effect} in the model, with a standard deviation. Line: what it adds, \
             the mean of {ROWS} rows."
        ),
        plot: scatter(
            rows,
            [
                &format!("residual of mu without {effect}"),
                column,
                "mu without it [1e-3]",
            ],
            x,
            rows.iter().zip(&added).map(without).collect(),
            ("the effect", line_x, line_y),
        ),
    })
}

/// Measured friction with the base law: over the film's, or over pressure.
fn law(setting: &Setting, rows: &[Row], first: &Fit) -> Picture {
    let (title, [label, x_name], x, curve) = match setting.base {
        Base::Film => {
            let film: Vec<f64> = rows.iter().map(|r| 1e3 * r.film).collect();
            let most = film.iter().copied().fold(0.0, f64::max);
            let (x, y) = (vec![0.0, most], vec![0.0, first.step[0] * most]);
            (
                "Measured friction and the melt film",
                ["friction over that of the film", "mu of the film [1e-3]"],
                film,
                ("film times zeta, refitted", x, y),
            )
        }
        _ => {
            let pressure: Vec<f64> = rows.iter().map(|r| 1e-6 * r.pressure).collect();
            let low = pressure.iter().copied().fold(f64::INFINITY, f64::min);
            let high = pressure.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // Extends the curve a little past the points.
            let margin = (0.06 * (high - low)).max(1e-9 * high.abs()).max(1e-12);
            let (low, high) = (low - margin, high + margin);
            let point = |k| {
                let p = low + (high - low) * f64::from(k) / 60.0;
                let mut row = rows[0].clone();
                row.pressure = 1e6 * p;
                (p, 1e3 * first.base_law(setting, &row))
            };
            let (x, y) = (0..=60).map(point).unzip();
            (
                "Measured friction and the base law",
                ["friction over pressure", "largest pressure [MPa]"],
                pressure,
                ("base law, refitted", x, y),
            )
        }
    };
    let mu = rows.iter().map(|r| 1e3 * r.mu).collect();
    Picture {
        title: title.to_owned(),
        caption: String::new(),
        plot: scatter(rows, [label, x_name, "mu [1e-3]"], x, mu, curve),
    }
}

/// A value of each row with the standard deviation of its mu, and a curve.
fn scatter(
    rows: &[Row],
    [label, x_name, y_name]: [&str; 3],
    x: Vec<f64>,
    y: Vec<f64>,
    (name, line_x, line_y): (&str, Vec<f64>, Vec<f64>),
) -> Plot {
    Plot::Scatter(Scatter {
        label: label.to_owned(),
        x_name: x_name.to_owned(),
        y_name: y_name.to_owned(),
        x,
        series: vec![Series {
            name: "measured".to_owned(),
            y,
            sd: rows.iter().map(|row| 1e3 * row.mu_sd).collect(),
        }],
        curve: Some(Curve {
            name: name.to_owned(),
            x: line_x,
            y: line_y,
        }),
    })
}
