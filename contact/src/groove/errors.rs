//! How far the last mesh's figures are from those of fine meshes.

use crate::groove::measures::Measures;

/// Estimated errors, in the figures' own units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Errors {
    pub p_max: f64,
    pub depth: f64,
    pub ploughing: f64,
    pub front: f64,
    pub back: f64,
    pub load_ahead: f64,
}

/// Scatter of the groove with the places of its rims between nodes, over the figure, times the cells to the power 1.5: as many
/// nodes' shares of the plane are full or open by chance as there are rims to cross.
const SCATTER: f64 = 0.15;
/// Share of the change from the mesh before: scatter falls to 0.54 of it on a mesh 1.5 times as fine.
const SHARE: f64 = 0.6;
/// Scatter of the peak pressure where it is below the hardness and so smooth, times the square of the cells.
const SMOOTH_SCATTER: f64 = 0.03;
/// Ploughing force over the load below which its error is measured by this [1].
const LEAST_PLOUGHING: f64 = 1e-4;
/// Depth of the groove over the approach below which its error is measured by this.
const LEAST_DEPTH: f64 = 0.05;

impl Errors {
    /// The change from the mesh before and the scatter of `cells` cells over half the patch; infinite for one mesh.
    pub fn of(measures: &[Measures], cells: f64, hardness: f64) -> Self {
        let [.., a, b] = measures else {
            let none = f64::INFINITY;
            return Errors {
                p_max: none,
                depth: none,
                ploughing: none,
                front: none,
                back: none,
                load_ahead: none,
            };
        };
        let scatter = SCATTER * cells.powf(-1.5);
        let length = b.front - b.back;
        let smooth = match b.p_max < hardness {
            true => SMOOTH_SCATTER / (cells * cells) * b.p_max,
            false => 0.0,
        };
        Errors {
            p_max: (a.p_max - b.p_max).abs() + smooth,
            depth: SHARE * (a.depth - b.depth).abs() + scatter * b.depth,
            ploughing: SHARE * (a.ploughing - b.ploughing).abs() + scatter * b.ploughing,
            front: SHARE * (a.front - b.front).abs() + scatter * length,
            back: SHARE * (a.back - b.back).abs() + scatter * length,
            load_ahead: SHARE * (a.load_ahead - b.load_ahead).abs() + scatter * b.load_ahead.abs(),
        }
    }

    /// Largest of the errors of peak pressure, groove and ploughing, over their values.
    pub fn largest(&self, of: &Measures) -> f64 {
        let shares = [
            self.p_max / of.p_max,
            self.depth / of.depth.max(LEAST_DEPTH * of.approach),
            self.ploughing / of.ploughing.max(LEAST_PLOUGHING * of.fz),
        ];
        shares.into_iter().fold(0.0, f64::max)
    }
}
