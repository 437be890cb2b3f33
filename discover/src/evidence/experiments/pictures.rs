//! mu over pressure, and what is left of it over the columns that the named effects need.

use crate::evidence::experiments::fit::{Fit, Setting};
use crate::evidence::experiments::rows::Row;
use crate::finding::picture::{Curve, Picture, Plot, Series};

/// The measured coefficients with the law, and the residual before and after over each named effect's strongest column.
pub fn pictures(
    setting: &Setting,
    rows: &[Row],
    first: &Fit,
    (last, chosen): (&Fit, &[usize]),
) -> Vec<Picture> {
    let mut pictures = vec![law(setting, rows, first)];
    let left = |fit: &Fit, chosen: &[usize]| -> Vec<f64> {
        rows.iter()
            .map(|row| 1e3 * (row.mu - fit.predict(setting, row, chosen).1))
            .collect()
    };
    let (before, after) = (left(first, &[]), left(last, chosen));
    for c in chosen {
        let change: Vec<f64> = rows
            .iter()
            .map(|row| setting.candidates[*c].slope(row, 0.004, 0.0))
            .collect();
        let Some((column, values)) = strongest_column(rows, &change) else {
            continue;
        };
        let series = [("before", &before), ("after", &after)].map(|(name, y)| Series {
            name: name.to_owned(),
            y: y.clone(),
            sd: Vec::new(),
        });
        pictures.push(Picture {
            title: format!("{} over {column}", setting.candidates[*c].effect),
            caption: String::new(),
            plot: Plot::Scatter {
                label: "what is left of mu".to_owned(),
                x_name: column,
                y_name: "mu - fitted [1e-3]".to_owned(),
                x: values,
                series: series.into(),
                curve: None,
            },
        });
    }
    pictures
}

fn law(setting: &Setting, rows: &[Row], first: &Fit) -> Picture {
    let pressure: Vec<f64> = rows.iter().map(|r| 1e-6 * r.pressure).collect();
    let low = pressure.iter().copied().fold(f64::INFINITY, f64::min);
    let high = pressure.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // A little beyond the points, as far as a diagram reaches.
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
    Picture {
        title: "Measured friction and the base law".to_owned(),
        caption: String::new(),
        plot: Plot::Scatter {
            label: "friction over pressure".to_owned(),
            x_name: "largest pressure [MPa]".to_owned(),
            y_name: "mu [1e-3]".to_owned(),
            x: pressure,
            series: vec![Series {
                name: "measured".to_owned(),
                y: rows.iter().map(|r| 1e3 * r.mu).collect(),
                sd: rows.iter().map(|r| 1e3 * r.mu_sd).collect(),
            }],
            curve: Some(Curve {
                name: "base law, refitted".to_owned(),
                x,
                y,
            }),
        },
    }
}

/// The column that an effect's change of mu follows most closely.
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

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let mean = |x: &[f64]| x.iter().sum::<f64>() / n;
    let (ma, mb) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        ab += (x - ma) * (y - mb);
        aa += (x - ma).powi(2);
        bb += (y - mb).powi(2);
    }
    ab / (aa * bb).sqrt().max(1e-300)
}
