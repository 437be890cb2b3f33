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

/// Order with which rims between nodes and trilinear cells both settle.
const ORDER: i32 = 2;
/// Factor of safety of the grid convergence index (P. J. Roache, Annu. Rev. Fluid Mech. 29, 1997).
const SAFETY: f64 = 1.25;
/// Ploughing force over the load below which its error is measured by this [1].
const LEAST_PLOUGHING: f64 = 1e-4;
/// Depth of the groove over the approach below which its error is measured by this.
const LEAST_DEPTH: f64 = 0.05;

impl Errors {
    /// The grid convergence index of the last two meshes, the last one `refined` times as fine as the one before, and what the area between
    /// nodes and rims changes on the last one: `plain` is that mesh's answer without it. The two add up as independent errors do. Infinite
    /// for one mesh.
    ///
    /// The index alone does not do: where nodes lie beside rims is chance, and two meshes may agree by it.
    pub fn of(measures: &[Measures], plain: &Measures, refined: f64) -> Self {
        let [.., before, last] = measures else {
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
        let index = SAFETY / (refined.powi(ORDER) - 1.0);
        let error = |of: fn(&Measures) -> f64| {
            (index * (of(before) - of(last))).hypot(of(plain) - of(last))
        };
        Errors {
            p_max: error(|m| m.p_max),
            depth: error(|m| m.depth),
            ploughing: error(|m| m.ploughing),
            front: error(|m| m.front),
            back: error(|m| m.back),
            load_ahead: error(|m| m.load_ahead),
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
