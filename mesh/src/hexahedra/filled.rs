//! The space between a scanned hull's underside and a flat top.

use crate::error::MeshError;
use crate::fit::FittedUnderside;
use crate::hexahedra::hex_mesh::limit_slope;
use crate::hull::triangles::{Hull, HullReport};
use crate::shapes::underside::Underside;

/// Numbers of columns along and across in which the space over an underside is measured.
const COLUMNS: [usize; 2] = [512, 128];
/// Largest relative difference between the volumes of the hull and of the columns. The bending
/// stiffness is proportional to the cube of the height, so its error is at most three times as
/// large.
const MAX_DIFFERENCE: f64 = 0.02;

/// The space between a hull's fitted underside and its flat top, as upright columns over a
/// rectangle.
#[derive(Clone, Debug)]
pub struct Filled {
    /// Height of the flat top over the lowest point [m].
    pub top: f64,
    /// Middles of the columns along x and y [m].
    middles: [Vec<f64>; 2],
    /// Their undersides, at most at the top; x fastest [m].
    heights: Vec<f64>,
}

impl Filled {
    /// The space below the hull's highest point, or below `top` [m] over its lowest point if given.
    ///
    /// The volume of the hull below the height h is the surface integral of (min(z, h) - h) n_z, to
    /// which upright sides, the top and an open upper end do not contribute. It differs from the
    /// space over the underside by undercuts, holes and a top that is not flat.
    ///
    /// # Errors
    /// [`MeshError::Invalid`] for an open hull without `top`, if more than 2 per cent of the
    /// outline's rectangle lies outside the hull, or if the volume of a closed hull and the space
    /// differ by more than that. The volume of an open hull is not known.
    pub fn of(
        hull: &Hull,
        report: &HullReport,
        underside: &FittedUnderside,
        top: Option<f64>,
    ) -> Result<Self, MeshError> {
        let highest = hull.bounds()[1][2] - underside.level();
        let top = match top {
            Some(top) => top,
            None if report.open_edges == 0 => highest,
            None => {
                return Err(MeshError::Invalid(format!(
                    "the hull is open ({} edges belong to one triangle only), and an elastic runner \
                     is filled up to its top: expected runner.height_m, from its lowest point to its \
                     flat top (its highest vertex is at {highest:.4} m)",
                    report.open_edges
                )));
            }
        };
        let [x0, x1, y0, y1] = underside.extent();
        let [nx, ny] = COLUMNS;
        let middles = [(x0, x1, nx), (y0, y1, ny)].map(|(from, to, count)| {
            let at = |k: usize| from + (to - from) * (k as f64 + 0.5) / count as f64;
            (0..count).map(at).collect::<Vec<f64>>()
        });
        let [xs, ys] = &middles;
        let row = |&y: &f64| xs.iter().map(move |&x| underside.height(x, y));
        let heights: Vec<f64> = ys.iter().flat_map(row).collect();
        let outside = heights.iter().filter(|z| z.is_infinite()).count();
        let filled = Filled {
            top,
            middles,
            heights: heights.into_iter().map(|z| z.min(top)).collect(),
        };
        let misfit = |found: &str, share: f64| {
            (share.abs() > MAX_DIFFERENCE).then(|| {
                MeshError::Invalid(format!(
                    "the hull cannot be filled with columns from its underside to its top at \
                     {top:.4} m: {:.1} % {found}; expected at most {:.0} %: another \
                     runner.height_m, or hexahedra of its own (runner.mesh)",
                    100.0 * share.abs(),
                    100.0 * MAX_DIFFERENCE
                ))
            })
        };
        let outline = outside as f64 / filled.heights.len() as f64;
        let steel = steel_below(hull, underside.level() + top);
        let space = filled.volume();
        let difference = if steel < space {
            "of that space is not steel: undercuts, holes, or a top that is not flat"
        } else {
            "more steel lies below that top: the hull is wider above than below"
        };
        let closed = report.open_edges == 0;
        let refused = misfit("of the rectangle around its outline is empty", outline);
        let refused =
            refused.or_else(|| misfit(difference, steel / space - 1.0).filter(|_| closed));
        refused.map_or(Ok(filled), Err)
    }

    /// The columns' volume [m^3].
    fn volume(&self) -> f64 {
        self.over(&self.heights)
    }

    /// Volume from these heights of the columns to the top [m^3].
    fn over(&self, heights: &[f64]) -> f64 {
        let [dx, dy] = [0, 1].map(|axis| self.middles[axis][1] - self.middles[axis][0]);
        heights.iter().map(|z| self.top - z).sum::<f64>() * dx * dy
    }

    /// Relative increase of the volume if the underside continues straight where it is steeper than
    /// `slope`.
    pub fn gain(&self, slope: f64) -> f64 {
        let mut limited = self.heights.clone();
        let [x, y] = &self.middles;
        limit_slope(x, y, &mut limited, slope);
        self.over(&limited) / self.volume() - 1.0
    }
}

/// Volume of the hull below the plane at `top` [m^3]; openings above the plane and upright sides do
/// not contribute.
fn steel_below(hull: &Hull, top: f64) -> f64 {
    let part = |corners: &[u32; 3]| {
        let depth = corners.map(|c| (hull.positions[c as usize][2] - top).min(0.0));
        hull.normal(corners)[2] * depth.iter().sum::<f64>() / 6.0
    };
    hull.triangles.iter().map(part).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::tessellate::tessellate;
    use crate::hull::triangles::check_hull;
    use crate::shapes::swept::BobRunner;
    use crate::shapes::swept::LugeSteel;

    fn bob() -> Hull {
        let runner = BobRunner {
            length: 0.3,
            rocker_radius: 8.0,
            ..BobRunner::default()
        };
        tessellate(&runner.swept().unwrap(), 1e-3).unwrap()
    }

    fn filled(hull: &Hull, top: Option<f64>) -> Result<Filled, String> {
        let report = check_hull(hull).unwrap();
        let underside = FittedUnderside::new(hull, 0.0).unwrap();
        Filled::of(hull, &report, &underside, top).map_err(|error| error.to_string())
    }

    #[test]
    fn a_swept_runner_is_filled_up_to_its_top_and_a_round_section_gains_more_than_a_flat_one() {
        let round = filled(&bob(), None).unwrap();
        assert!((round.top - 0.030).abs() < 1e-7, "{}", round.top);
        let steel = LugeSteel::default().swept().unwrap();
        let flat = filled(&tessellate(&steel, 1e-3).unwrap(), None).unwrap();
        let gains = [&round, &flat].map(|filled| filled.gain(0.15));
        println!("{gains:?}");
        assert!(gains[0] > 0.02 && gains[1] < 0.005, "{gains:?}");
        assert!(round.gain(0.35) < gains[0]);
        let own = check_hull(&bob()).unwrap().volume;
        assert!((round.volume() / own - 1.0).abs() < 2e-3);
    }

    #[test]
    fn an_open_hull_needs_its_height() {
        let mut open = bob();
        let positions = open.positions.clone();
        open.triangles
            .retain(|t| t.iter().any(|&c| positions[c as usize][2] < 0.0299));
        let refusal = filled(&open, None).unwrap_err();
        assert!(refusal.contains("height_m"), "{refusal}");
        assert_eq!(filled(&open, Some(0.030)).unwrap().top, 0.030);
        assert_eq!(filled(&open, Some(0.020)).unwrap().top, 0.020);
    }

    /// An underside alone, with a ragged side, a hole, and one that the rim cuts: the body ends
    /// where the scan does, nothing is extrapolated, and the notch is filled.
    #[test]
    fn a_ragged_scan_with_holes_is_filled_within_its_rims() {
        let mut scan = bob();
        let positions = scan.positions.clone();
        let corner = |c: u32| positions[c as usize];
        let holes = [[0.05, 0.002, 0.001], [-0.03, 0.004, 0.002]];
        scan.triangles.retain(|t| {
            let side = t
                .iter()
                .all(|&c| corner(c)[1].abs() < 0.0042 && corner(c)[2] < 0.029);
            let ragged = t
                .iter()
                .all(|&c| corner(c)[0] > 0.135 && corner(c)[1] > 0.003);
            let hole = t.iter().any(|&c| {
                let [x, y, _] = corner(c);
                holes
                    .iter()
                    .any(|[at, across, radius]| (x - at).hypot(y - across) < *radius)
            });
            side && !ragged && !hole
        });
        let report = check_hull(&scan).unwrap();
        assert!(report.open_edges > 0);
        let whole = FittedUnderside::new(&scan, 0.0).unwrap();
        assert!(Filled::of(&scan, &report, &whole, None).is_err());
        let cut = whole.within_outline();
        let [x0, x1, y0, y1] = cut.extent();
        assert!(x0 >= -0.15 - 1e-9 && x1 <= 0.15 + 1e-9 && y0 >= -0.0043 && y1 <= 0.0043);
        assert!(y1 - y0 > 0.0076 && x1 - x0 > 0.28, "{:?}", cut.extent());
        let filled = Filled::of(&scan, &report, &cut, Some(0.030)).unwrap();
        let runner = BobRunner {
            length: 0.3,
            rocker_radius: 8.0,
            ..BobRunner::default()
        };
        let runner = runner.swept().unwrap();
        let [xs, ys] = &filled.middles;
        for (k, height) in filled.heights.iter().enumerate() {
            let (x, y) = (xs[k % xs.len()], ys[k / xs.len()]);
            let off = height - runner.height(x, y);
            assert!(off.abs() < 0.1e-3, "{x} {y}: {off}");
        }
    }

    #[test]
    fn what_columns_cannot_fill_is_refused_with_its_share() {
        // The upper half of the sides moved inwards: a T upside down.
        let mut undercut = bob();
        for p in &mut undercut.positions {
            if p[2] > 0.02 {
                p[1] *= 0.5;
            }
        }
        let refusal = filled(&undercut, None).unwrap_err();
        assert!(refusal.contains("undercuts"), "{refusal}");
        // Ends that narrow to half the width.
        let mut narrow = bob();
        for p in &mut narrow.positions {
            p[1] *= 1.0 - 0.5 * (p[0] / 0.15).powi(2);
        }
        let refusal = filled(&narrow, None).unwrap_err();
        assert!(refusal.contains("outline"), "{refusal}");
        let refusal = filled(&bob(), Some(0.040)).unwrap_err();
        assert!(refusal.contains("0.04"), "{refusal}");
    }
}
