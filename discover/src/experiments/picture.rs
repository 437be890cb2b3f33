//! mu over pressure, and what is left of it over the columns that the named effects need.

use std::fmt::Write as _;

use super::fit::{Fit, Setting};
use super::rows::Row;
use crate::html::unit_of;
use crate::plot::Frame;
use crate::report::Picture;

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
        let both: Vec<f64> = before.iter().chain(&after).copied().collect();
        let frame = Frame::around(&values, &both);
        let mut svg = frame.open("what is left of mu");
        let unit = match unit_of(&column) {
            "" => String::new(),
            unit => format!(" [{unit}]"),
        };
        frame.axes(&mut svg, &format!("{column}{unit}"), "mu - fitted [1e-3]");
        frame.level(&mut svg, 0.0);
        frame.points(&mut svg, &values, &before, "before", 0);
        frame.points(&mut svg, &values, &after, "after", 1);
        let _ = writeln!(svg, "</svg>");
        pictures.push(Picture {
            title: format!("{} over {column}", setting.candidates[*c].name),
            svg,
        });
    }
    pictures
}

fn law(setting: &Setting, rows: &[Row], first: &Fit) -> Picture {
    let pressure: Vec<f64> = rows.iter().map(|r| 1e-6 * r.pressure).collect();
    let mu: Vec<f64> = rows.iter().map(|r| 1e3 * r.mu).collect();
    let error: Vec<f64> = rows.iter().map(|r| 1e3 * r.mu_sd).collect();
    let ends: Vec<f64> = mu
        .iter()
        .zip(&error)
        .flat_map(|(m, e)| [m - e, m + e])
        .collect();
    let frame = Frame::around(&pressure, &ends);
    let mut svg = frame.open("friction over pressure");
    frame.axes(&mut svg, "largest pressure [MPa]", "mu [1e-3]");
    let [low, high] = frame.x;
    let line: Vec<(f64, f64)> = (0..=60)
        .map(|k| {
            let p = low + (high - low) * f64::from(k) / 60.0;
            let mut row = rows[0].clone();
            row.pressure = 1e6 * p;
            (p, 1e3 * first.predict(setting, &row, &[]).0)
        })
        .collect();
    frame.line(&mut svg, &line, "base law, refitted", 1);
    frame.bars(&mut svg, &pressure, &mu, &error);
    frame.points(&mut svg, &pressure, &mu, "measured", 0);
    let _ = writeln!(svg, "</svg>");
    Picture {
        title: "Measured friction and the base law".to_owned(),
        svg,
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
