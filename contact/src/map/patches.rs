//! Maps of contacts that are far apart along the runner, as those of a runner that rests on its two ends.

use std::ops::Range;

use crate::result::solution::{Solution, SurfaceField};

use crate::map::pressure_map::PressureMap;

/// Contacts are shown apart where the empty stretch between them is this many times as long as they are.
const APART: f64 = 5.0;

/// One map for the whole contact, or two where it consists of two parts that are far apart along the runner.
pub fn pressure_maps(solution: &Solution) -> Vec<PressureMap> {
    let field = &solution.surface;
    let Some(parts) = split(field) else {
        return vec![PressureMap::of(solution)];
    };
    let parts = parts.map(|columns| cropped(field, columns));
    let forces = parts.each_ref().map(force);
    let part = |k: usize| {
        let fz = solution.fz * forces[k] / (forces[0] + forces[1]);
        PressureMap::new(&parts[k], fz, solution.bound())
    };
    vec![part(0), part(1)]
}

/// A map cut in two where it shows two parts that are far apart, each with a margin around its contact.
pub fn parted(map: PressureMap) -> Vec<PressureMap> {
    let x: Vec<f64> = (0..map.nx).map(|i| map.x0 + i as f64 * map.dx).collect();
    match split_columns(&x, &map.pressure) {
        None => vec![map],
        Some(parts) => parts.map(|columns| part(&map, columns)).into(),
    }
}

/// The columns of a part that touch, and half as many again around them.
fn part(map: &PressureMap, columns: Range<usize>) -> PressureMap {
    let touches = |&i: &usize| map.pressure.chunks(map.nx).any(|row| row[i] > 0.0);
    let first = columns.clone().find(touches).unwrap_or(columns.start);
    let last = columns.clone().rfind(touches).unwrap_or(columns.end - 1);
    let margin = (last - first).div_ceil(4).max(2);
    let from = first.saturating_sub(margin).max(columns.start);
    let to = (last + 1 + margin).min(columns.end);
    let crop = |values: &[f64]| -> Vec<f64> {
        let rows = values.chunks(map.nx);
        rows.flat_map(|row| row[from..to].iter().copied()).collect()
    };
    PressureMap {
        x0: map.x0 + from as f64 * map.dx,
        nx: to - from,
        pressure: crop(&map.pressure),
        gap: crop(&map.gap),
        uz: crop(&map.uz),
        ..*map
    }
}

/// The columns on both sides of the middle of the longest empty stretch, where that is long.
fn split(field: &SurfaceField) -> Option<[Range<usize>; 2]> {
    split_columns(&field.x, &field.pressure)
}

/// As [`split`], of rows of pressures over columns at `x`.
fn split_columns(x: &[f64], pressure: &[f64]) -> Option<[Range<usize>; 2]> {
    let columns = x.len();
    let touched: Vec<usize> = (0..columns)
        .filter(|&i| pressure.chunks(columns).any(|row| row[i] > 0.0))
        .collect();
    let length = |pair: &[usize]| x[pair[1]] - x[pair[0]];
    let widest = touched
        .windows(2)
        .max_by(|a, b| length(a).total_cmp(&length(b)))?;
    let whole = x[*touched.last()?] - x[touched[0]];
    let empty = length(widest);
    if empty < APART * (whole - empty) {
        return None;
    }
    let middle = 0.5 * (x[widest[0]] + x[widest[1]]);
    let at = x.partition_point(|&x| x < middle);
    // Each part keeps an empty column on the inside.
    (widest[1] > widest[0] + 2 && at > widest[0] + 1).then_some([0..at, at..columns])
}

fn cropped(field: &SurfaceField, columns: Range<usize>) -> SurfaceField {
    let crop = |values: &[f64]| {
        values
            .chunks(field.x.len())
            .flat_map(|row| row[columns.clone()].iter().copied())
            .collect()
    };
    SurfaceField {
        x: field.x[columns.clone()].to_vec(),
        y: field.y.clone(),
        pressure: crop(&field.pressure),
        gap: crop(&field.gap),
        yielded: crop(&field.yielded),
        uz: crop(&field.uz),
    }
}

/// Integral of the pressure by the trapezoidal rule [N]; its share matters, not its value.
fn force(field: &SurfaceField) -> f64 {
    let half_widths = |nodes: &[f64]| -> Vec<f64> {
        let last = nodes.len() - 1;
        (0..=last)
            .map(|k| 0.5 * (nodes[(k + 1).min(last)] - nodes[k.saturating_sub(1)]))
            .collect()
    };
    let (along, across) = (half_widths(&field.x), half_widths(&field.y));
    field
        .pressure
        .iter()
        .enumerate()
        .map(|(k, p)| p * along[k % along.len()] * across[k / along.len()])
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pressure 1 Pa where `touches`, on nodes 0..=40 by 0..=2 m.
    fn field(touches: impl Fn(usize) -> bool) -> SurfaceField {
        let x: Vec<f64> = (0..=40).map(f64::from).collect();
        let row: Vec<f64> = (0..=40).map(|i| f64::from(u8::from(touches(i)))).collect();
        let pressure = [vec![0.0; 41], row, vec![0.0; 41]].concat();
        SurfaceField {
            x,
            y: vec![0.0, 1.0, 2.0],
            gap: vec![0.0; pressure.len()],
            yielded: vec![0.0; pressure.len()],
            uz: vec![0.0; pressure.len()],
            pressure,
        }
    }

    #[test]
    fn a_contact_on_two_ends_is_parted_in_the_middle_and_its_force_kept() {
        let two = field(|i| (2..=3).contains(&i) || (36..=38).contains(&i));
        let [left, right] = split(&two)
            .expect("two parts")
            .map(|part| cropped(&two, part));
        assert_eq!((left.x[0], right.x[right.x.len() - 1]), (0.0, 40.0));
        assert_eq!((force(&left), force(&right)), (2.0, 3.0));
    }

    #[test]
    fn a_map_of_two_ends_is_cut_into_two_maps_that_keep_their_places() {
        let two = field(|i| (2..=3).contains(&i) || (36..=38).contains(&i));
        let map = PressureMap {
            x0: 0.0,
            y0: 0.0,
            dx: 1.0,
            dy: 1.0,
            nx: 41,
            ny: 3,
            pressure: two.pressure,
            gap: two.gap,
            uz: two.uz,
        };
        let [left, right]: [PressureMap; 2] = parted(map).try_into().expect("two parts");
        assert_eq!((left.x0, left.nx, right.x0, right.nx), (0.0, 6, 34.0, 7));
        assert_eq!(left.pressure[6..12], [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
        assert_eq!(right.pressure[7..14], [0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_single_contact_and_two_near_ones_stay_whole() {
        assert_eq!(split(&field(|i| (10..=30).contains(&i))), None);
        assert_eq!(
            split(&field(|i| (5..=15).contains(&i) || (25..=35).contains(&i))),
            None
        );
    }
}
