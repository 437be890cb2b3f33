//! The closure for a long strip against the two-dimensional Reynolds equation.

use super::closed_form::{film_pressure, squeeze_out_rate};
use super::patches::{WATER, rounding};
use super::plane_film::reynolds_film;
use super::pressure_map::PressureMap;
use kufe_sled::friction::film::{FilmConditions, FilmOptions, film};

const OPTIONS: FilmOptions = FilmOptions { accuracy: 1e-6 };

/// A rectangle of `rows` by `columns` cells. The pressure is a parabola along it and uniform
/// across.
fn rectangle(length: f64, width: f64, rows: usize, columns: usize, peak: f64) -> PressureMap {
    let at = |row: usize| (row as f64 + 0.5) / rows as f64;
    let pressure = (0..rows * columns).map(|k| peak * rounding(at(k / columns)).powi(2));
    PressureMap::new(
        length / rows as f64,
        width / columns as f64,
        columns,
        pressure.collect(),
    )
}

/// An ellipse with Hertzian pressures.
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
}

/// Relative errors of friction and mean thickness of the strip against the plane film, extrapolated
/// to cells of zero width. The discretisation error across is of second order (last test) and
/// larger than the error of the closure.
fn closure_error(map: impl Fn(usize) -> PressureMap, columns: usize) -> [f64; 2] {
    let conditions = FilmConditions::new(25.0, -5.0);
    let ratio = |columns: usize| {
        let plane = reynolds_film(&map(columns), &conditions, &WATER, &OPTIONS).expect("a film");
        let strip = film(&plane.strip, &conditions, &WATER, &OPTIONS).expect("a film");
        [
            strip.totals.friction / plane.film.totals.friction - 1.0,
            strip.totals.mean_thickness / plane.film.totals.mean_thickness - 1.0,
        ]
    };
    let (coarse, fine) = (ratio(columns), ratio(2 * columns));
    [0, 1].map(|i| (4.0 * fine[i] - coarse[i]) / 3.0)
}

#[test]
fn strip_closure_error_is_below_1e_3_at_aspect_20_and_2e_6_at_400() {
    let at = |aspect: f64, rows: usize| {
        closure_error(
            |columns| rectangle(1.0e-3 * aspect, 1.0e-3, rows, columns, 18.0e6),
            12,
        )
    };
    let mut frictions = Vec::new();
    for aspect in [20.0, 40.0, 80.0, 400.0] {
        let [friction, thickness] = at(aspect, 80);
        println!("rectangle {aspect}: friction {friction:.2e}, thickness {thickness:.2e}");
        assert!(friction.abs() < 5e-4 && thickness.abs() < 1e-3);
        frictions.push(friction);
    }
    // Flow along the patch is of order aspect^-2. The thin start, where it has most influence,
    // reduces the order to 3/2.
    for pair in frictions[..3].windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.3..2.1).contains(&order), "{frictions:?}");
    }
    assert!(frictions[3].abs() < 2e-6, "{frictions:?}");
    // Rows half as long change the result by a small fraction of it.
    let [finer, _] = at(20.0, 160);
    println!("rectangle 20, rows half as long: {finer:.2e}");
    assert!(
        (finer / frictions[0] - 1.0).abs() < 0.2,
        "{finer} {frictions:?}"
    );
}

#[test]
fn strip_closure_error_of_a_hertzian_ellipse_is_at_most_5e_4() {
    for aspect in [20.0, 60.0, 400.0] {
        let [friction, thickness] = closure_error(
            |columns| ellipse(1.0e-3 * aspect, 1.0e-3, 80, columns, 18.0e6),
            24,
        );
        println!("ellipse {aspect}: friction {friction:.2e}, thickness {thickness:.2e}");
        assert!(friction.abs() < 5e-4 && thickness.abs() < 5e-4);
    }
}

#[test]
fn film_pressure_carries_each_row_and_is_a_parabola() {
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
fn pressure_and_thickness_satisfy_the_reynolds_equation() {
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
fn strip_closure_converges_with_columns_at_order_two() {
    // The mean of the parabola over the cells across has an error of second order: the residual of
    // a long strip.
    let conditions = FilmConditions::new(25.0, -5.0);
    let closure_error = |columns: usize| {
        let plane = reynolds_film(
            &rectangle(0.4, 1.0e-3, 40, columns, 18.0e6),
            &conditions,
            &WATER,
            &OPTIONS,
        );
        plane.expect("a film").outflow_factor[20] - 1.0
    };
    let (coarse, middle, fine) = (closure_error(8), closure_error(16), closure_error(32));
    let order = ((coarse - middle) / (middle - fine)).log2();
    assert!((order - 2.0).abs() < 0.1, "{coarse} {middle} {fine}");
    let extrapolated = fine + (fine - middle) / 3.0;
    assert!(extrapolated.abs() < 1e-4, "{extrapolated}");
}
