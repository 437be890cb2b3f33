//! `hull.glb`: the underside after approach and tilt.

use kufe_contact::{Load, Problem, Solution, track_height};
use kufe_mesh::Hull;

/// Number of points along and across.
const POINTS: [usize; 2] = [121, 25];

/// The undeformed underside after approach and tilt, in the frame of `field.vtu`: z = 0 is the ice
/// before it yields, a curved track and waves laid out flat.
///
/// `z = h(x, y) - t(x) - pitch (x - x0) + roll (y - y0) - d`, with `h` the underside, `t` the track
/// and `(x0, y0)` the load's line of action; `d` puts the deepest point of the solved surface at
/// the approach. `None` for a shape without ends.
pub fn placed_hull(problem: &Problem, solution: &Solution) -> Option<Hull> {
    let underside = &problem.runner.underside;
    let extent = underside.extent();
    if extent.iter().any(|end| end.is_infinite()) {
        return None;
    }
    let [x_min, x_max, y_min, y_max] = extent;
    let [x0, y0] = match problem.load {
        Load::Force {
            offset_x, offset_y, ..
        } => [offset_x, offset_y],
        Load::Approach { .. } => [0.0; 2],
    };
    let above = |x: f64, y: f64| {
        let tilted = solution.roll * (y - y0) - solution.pitch * (x - x0);
        let ice = problem.ice_surface.as_ref();
        let ice = ice.map_or(0.0, |surface| surface.height(x, y));
        underside.height(x, y) - ice - track_height(problem.track_curvature, x) + tilted
    };
    let surface = &solution.surface;
    let heights_at = |x: &[f64], y: &[f64]| -> Vec<f64> {
        let rows = y.iter().flat_map(|&y| x.iter().map(move |&x| (x, y)));
        rows.map(|(x, y)| above(x, y)).collect()
    };
    let solved = heights_at(&surface.x, &surface.y).into_iter();
    let down = solved.fold(f64::INFINITY, f64::min) + solution.approach;
    let nodes = |count: usize, low: f64, high: f64| -> Vec<f64> {
        let place = |k| low + (high - low) * k as f64 / (count - 1) as f64;
        (0..count).map(place).collect()
    };
    let [along, across] = [
        nodes(POINTS[0], x_min, x_max),
        nodes(POINTS[1], y_min, y_max),
    ];
    let mut heights = heights_at(&along, &across);
    heights.iter_mut().for_each(|height| *height -= down);
    Some(Hull::underside_of(&along, &across, &heights))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kufe_contact::{Foundation, Ice, Options, Runner, Tilt, solve};
    use kufe_mesh::{BobRunner, Underside};
    use std::sync::Arc;

    #[test]
    fn the_placed_hull_lies_on_the_ice_where_it_touches() -> Result<(), Box<dyn std::error::Error>>
    {
        let hull = BobRunner::default().swept()?;
        let ice = Ice {
            foundation: Foundation::RigidBed { thickness: 0.05 },
            ..Ice::half_space(9e9, 0.33)
        };
        let load = Load::Force {
            fz: 1000.0,
            offset_x: 0.07,
            offset_y: 0.0,
            tilt: Tilt::Free,
        };
        let problem = Problem {
            track_curvature: 0.01,
            ..Problem::new(Runner::rigid(Arc::new(hull.clone())), ice, load)
        };
        let solution = solve(&problem, &Options::default())?;
        let placed = placed_hull(&problem, &solution).expect("a hull with ends");
        // 1 m over 120 cells, 10 mm over 24: the patch, 60 mm long around x = 70 mm, holds nodes on
        // its axis.
        let surface = &solution.surface;
        let middle = surface.y.partition_point(|&y| y < 0.0);
        let mut met = 0;
        for &[x, y, z] in &placed.positions {
            if y.abs() > 1e-12 || (x - 0.07).abs() > 0.02 {
                continue;
            }
            let i = surface.x.partition_point(|&s| s < x).max(1);
            let (a, b) = (surface.x[i - 1], surface.x[i]);
            let row = &surface.uz[middle * surface.x.len()..][..surface.x.len()];
            let ice = row[i - 1] + (x - a) / (b - a) * (row[i] - row[i - 1]);
            // The approach is extrapolated from two meshes, the ice's surface is that of the finer
            // one.
            assert!(
                (z - ice).abs() < 0.03 * solution.approach,
                "{x}: hull {z:e}, ice {ice:e}, approach {:e}",
                solution.approach
            );
            met += 1;
        }
        assert!(met >= 4, "{met} nodes in the patch");
        let [x_min, x_max, ..] = hull.extent();
        let ends = placed
            .positions
            .iter()
            .filter(|p| p[0] == x_min || p[0] == x_max);
        assert!(ends.clone().count() >= 2 && ends.into_iter().all(|p| p[2] > 1e-3));
        Ok(())
    }
}
