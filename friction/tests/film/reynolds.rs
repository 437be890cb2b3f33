//! The two-dimensional Reynolds equation beside the closure of a long strip.

use crate::patches::{WATER, rounding};
use kufe_friction::film::{
    FilmConditions, FilmOptions, PressureMap, ReynoldsFilm, film, film_pressure, reynolds_film,
    squeeze_out_rate,
};

const OPTIONS: FilmOptions = FilmOptions { accuracy: 1e-6 };

/// A rectangle of `rows` by `columns` cells whose pressure rises and falls as a parabola along it, even across.
fn rectangle(length: f64, width: f64, rows: usize, columns: usize, peak: f64) -> PressureMap {
    let at = |row: usize| (row as f64 + 0.5) / rows as f64;
    let pressure = (0..rows * columns).map(|k| peak * rounding(at(k / columns)).powi(2));
    PressureMap::new(
        length / rows as f64,
        width / columns as f64,
        columns,
        pressure.collect(),
    )
    .expect("a map")
}

/// An ellipse with Hertz's pressures.
fn ellipse(length: f64, width: f64, rows: usize, columns: usize, peak: f64) -> PressureMap {
    let at = |i: usize, n: usize| (2.0 * i as f64 + 1.0) / n as f64 - 1.0;
    let pressure = (0..rows * columns).map(|k| {
        let (x, y) = (at(k / columns, rows), at(k % columns, columns));
        peak * (1.0 - x * x - y * y).max(0.0).sqrt()
    });
    PressureMap::new(
        length / rows as f64,
        width / columns as f64,
        columns,
        pressure.collect(),
    )
    .expect("a map")
}

fn both(map: &PressureMap, conditions: &FilmConditions) -> (ReynoldsFilm, f64, f64) {
    let plane = reynolds_film(map, conditions, &WATER, &OPTIONS).expect("a film");
    let strip = film(&plane.strip, conditions, &WATER, &OPTIONS).expect("a film");
    let friction = strip.totals.friction / plane.film.totals.friction - 1.0;
    let thickness = strip.totals.mean_thickness / plane.film.totals.mean_thickness - 1.0;
    (plane, friction, thickness)
}

#[test]
fn strip_closure_is_off_by_half_a_percent_at_aspect_20_and_less_when_longer() {
    let conditions = FilmConditions::new(25.0, -5.0);
    let mut last = f64::INFINITY;
    for (aspect, most) in [(20.0, 5e-3), (60.0, 2e-3), (400.0, 1.5e-3)] {
        let (_, friction, thickness) = both(
            &rectangle(1.0e-3 * aspect, 1.0e-3, 80, 16, 18.0e6),
            &conditions,
        );
        println!("rectangle {aspect}: friction {friction:.2e}, thickness {thickness:.2e}");
        assert!(
            friction.abs() < most && thickness.abs() < 2.0 * most,
            "{aspect}: {friction} {thickness}"
        );
        assert!(friction.abs() < 1.05 * last);
        last = friction.abs();
    }
}

#[test]
fn strip_closure_of_a_hertzian_ellipse_is_off_by_one_percent_at_most() {
    let conditions = FilmConditions::new(25.0, -5.0);
    for (aspect, most) in [(20.0, 0.01), (60.0, 0.01), (400.0, 0.01)] {
        let (_, friction, thickness) = both(
            &ellipse(1.0e-3 * aspect, 1.0e-3, 80, 32, 18.0e6),
            &conditions,
        );
        println!("ellipse {aspect}: friction {friction:.2e}, thickness {thickness:.2e}");
        assert!(
            friction.abs() < most && thickness.abs() < most,
            "{aspect}: {friction} {thickness}"
        );
    }
}

#[test]
fn film_carries_the_load_of_each_row_in_a_parabola() {
    let conditions = FilmConditions::new(25.0, -5.0);
    let columns = 24;
    let map = rectangle(0.4, 1.0e-3, 60, columns, 18.0e6);
    let plane = reynolds_film(&map, &conditions, &WATER, &OPTIONS).expect("a film");
    for row in 0..60 {
        let cells = &plane.pressure[row * columns..(row + 1) * columns];
        let (mean, given) = (cells.iter().sum::<f64>() / columns as f64, map.row(row)[0]);
        assert!((mean / given - 1.0).abs() < 1e-9, "{row}: {mean} {given}");
    }
    let (row, h, mu) = (30, plane.film.stations[30].thickness, WATER.water_viscosity);
    let s = squeeze_out_rate(map.row(row)[0], h, 1.0e-3, mu);
    for column in 0..columns {
        let y = 1.0e-3 * ((column as f64 + 0.5) / columns as f64 - 0.5);
        let parabola = film_pressure(y, s, h, 1.0e-3, mu);
        let error = (plane.pressure[row * columns + column] - parabola) / map.row(row)[0];
        assert!(error.abs() < 5e-3, "{column}: {error}");
    }
}

#[test]
fn pressure_and_thickness_meet_the_reynolds_equation() {
    let conditions = FilmConditions::new(25.0, -5.0);
    let (rows, columns) = (200, 24);
    let map = rectangle(0.02, 1.0e-3, rows, columns, 18.0e6);
    let plane = reynolds_film(&map, &conditions, &WATER, &OPTIONS).expect("a film");
    let (dx, dy, mu) = (map.dx(), map.dy(), WATER.water_viscosity);
    let h = |row: usize| plane.film.stations[row].thickness;
    let p = |row: usize, column: usize| plane.pressure[row * columns + column];
    for row in [40, 100, 160] {
        for column in [5, 12, 20] {
            // Written out: h^3 lap p + 3 h^2 h' p_x, by central differences.
            let lap = (p(row + 1, column) - 2.0 * p(row, column) + p(row - 1, column)) / (dx * dx)
                + (p(row, column + 1) - 2.0 * p(row, column) + p(row, column - 1)) / (dy * dy);
            let slope = (h(row + 1) - h(row - 1)) / (2.0 * dx);
            let p_x = (p(row + 1, column) - p(row - 1, column)) / (2.0 * dx);
            let left = h(row).powi(2) / (12.0 * mu) * (h(row) * lap + 3.0 * slope * p_x);
            let melted = 917.0 / 999.8 * plane.film.stations[row].melt_rate;
            let right = 12.5 * slope - melted;
            assert!(
                (left - right).abs() < 2e-3 * melted,
                "{row} {column}: {left} {right}"
            );
        }
    }
}

#[test]
fn more_columns_bring_the_closure_of_an_even_strip_to_one() {
    // Cells across see the parabola's mean with an error of the second order: what is left of a long strip.
    let conditions = FilmConditions::new(25.0, -5.0);
    let off = |columns: usize| {
        let plane = reynolds_film(
            &rectangle(0.4, 1.0e-3, 40, columns, 18.0e6),
            &conditions,
            &WATER,
            &OPTIONS,
        );
        plane.expect("a film").outflow_factor[20] - 1.0
    };
    let (coarse, middle, fine) = (off(8), off(16), off(32));
    let order = ((coarse - middle) / (middle - fine)).log2();
    assert!((order - 2.0).abs() < 0.1, "{coarse} {middle} {fine}");
    let extrapolated = fine + (fine - middle) / 3.0;
    assert!(extrapolated.abs() < 1e-4, "{extrapolated}");
}
