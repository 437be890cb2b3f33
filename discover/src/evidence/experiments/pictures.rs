//! mu over pressure, and its residuals over the columns that the named effects need.

use kufe_sled::correlation;

use crate::evidence::experiments::base::Base;
use crate::evidence::experiments::fit::{Fit, Setting};
use crate::evidence::experiments::rows::Row;
use crate::finding::{Curve, Picture, Plot, Scatter, Series};

/// Measured coefficients with the law, and each named effect over its strongest column.
pub fn pictures(
    setting: &Setting,
    rows: &[Row],
    first: &Fit,
    (last, chosen): (&Fit, &[usize]),
) -> Vec<Picture> {
    let mut pictures = vec![law(setting, rows, first)];
    for k in 0..chosen.len() {
        pictures.extend(driven(setting, rows, (last, chosen), k));
    }
    pictures
}

/// Rows of a moving mean of the curve.
const ROWS: usize = 5;

/// Contribution of an effect over its strongest column, with residuals of the fit without it.
fn driven(
    setting: &Setting,
    rows: &[Row],
    (last, chosen): (&Fit, &[usize]),
    k: usize,
) -> Option<Picture> {
    let adds = |row: &Row| 1e3 * last.added(setting, row, chosen, k);
    let residual = |row: &Row| 1e3 * (row.mu - last.predict(setting, row, chosen).1);
    let added: Vec<f64> = rows.iter().map(adds).collect();
    let (column, x) = strongest_column(rows, &added)?;
    let mut ordered: Vec<(f64, f64)> = x.iter().copied().zip(added.iter().copied()).collect();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0));
    let means = ordered.chunks(ROWS).map(|part| {
        let mean =
            |of: &dyn Fn(&(f64, f64)) -> f64| part.iter().map(of).sum::<f64>() / part.len() as f64;
        (mean(&|row| row.0), mean(&|row| row.1))
    });
    let (line_x, line_y) = means.unzip();
    let effect = &setting.candidates[chosen[k]].effect;
    Some(Picture {
        title: format!("{effect} over {column}"),
        caption: format!(
            "Points: the residual of each row without {effect} in the model, with a standard deviation. Line: what it adds, \
             the mean of {ROWS} rows."
        ),
        plot: Plot::Scatter(Scatter {
            label: format!("residual of mu without {effect}"),
            x_name: column,
            y_name: "mu without it [1e-3]".to_owned(),
            x,
            series: vec![Series {
                name: "measured".to_owned(),
                y: rows
                    .iter()
                    .zip(&added)
                    .map(|(row, added)| residual(row) + added)
                    .collect(),
                sd: rows.iter().map(|row| 1e3 * row.mu_sd).collect(),
            }],
            curve: Some(Curve {
                name: "the effect".to_owned(),
                x: line_x,
                y: line_y,
            }),
        }),
    })
}

fn law(setting: &Setting, rows: &[Row], first: &Fit) -> Picture {
    if setting.base == Base::Film {
        return over_film(rows, first);
    }
    let pressure: Vec<f64> = rows.iter().map(|r| 1e-6 * r.pressure).collect();
    let low = pressure.iter().copied().fold(f64::INFINITY, f64::min);
    let high = pressure.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Extends the curve a little beyond the points.
    let margin = (0.06 * (high - low)).max(1e-9 * high.abs()).max(1e-12);
    let (low, high) = (low - margin, high + margin);
    let (x, y) = (0..=60)
        .map(|k| {
            let p = low + (high - low) * f64::from(k) / 60.0;
            let mut row = rows[0].clone();
            row.pressure = 1e6 * p;
            (p, 1e3 * first.predict(setting, &row, &[]).0)
        })
        .unzip();
    measured(
        rows,
        "Measured friction and the base law",
        ["friction over pressure", "largest pressure [MPa]"],
        pressure,
        ("base law, refitted", x, y),
    )
}

fn over_film(rows: &[Row], first: &Fit) -> Picture {
    let film: Vec<f64> = rows.iter().map(|r| 1e3 * r.film).collect();
    let most = film.iter().copied().fold(0.0, f64::max);
    measured(
        rows,
        "Measured friction and the melt film",
        ["friction over that of the film", "mu of the film [1e-3]"],
        film,
        (
            "film times zeta, refitted",
            vec![0.0, most],
            vec![0.0, first.step[0] * most],
        ),
    )
}

/// Measured friction over `place`, with a curve.
fn measured(
    rows: &[Row],
    title: &str,
    [label, x_name]: [&str; 2],
    place: Vec<f64>,
    (name, x, y): (&str, Vec<f64>, Vec<f64>),
) -> Picture {
    Picture {
        title: title.to_owned(),
        caption: String::new(),
        plot: Plot::Scatter(Scatter {
            label: label.to_owned(),
            x_name: x_name.to_owned(),
            y_name: "mu [1e-3]".to_owned(),
            x: place,
            series: vec![Series {
                name: "measured".to_owned(),
                y: rows.iter().map(|r| 1e3 * r.mu).collect(),
                sd: rows.iter().map(|r| 1e3 * r.mu_sd).collect(),
            }],
            curve: Some(Curve {
                name: name.to_owned(),
                x,
                y,
            }),
        }),
    }
}

/// The column most strongly related to an effect's change of mu.
fn strongest_column(rows: &[Row], change: &[f64]) -> Option<(String, Vec<f64>)> {
    let names = rows.first()?.columns.keys();
    names
        .map(|name| {
            let values: Vec<f64> = rows.iter().map(|r| r.columns[name]).collect();
            (correlation(&values, change).abs(), name.clone(), values)
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name, values)| (name, values))
}
