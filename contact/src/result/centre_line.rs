//! Stress in the ice on the vertical line under the peak pressure.

use kufe_fem::maximum_shear;

/// Stresses on a vertical line in the ice.
#[derive(Clone, Debug, PartialEq)]
pub struct CentreLine {
    /// Where the line meets the surface [m].
    pub at: [f64; 2],
    /// Depths under the surface, increasing: the middles of the layers of cells [m].
    pub depth: Vec<f64>,
    /// Stress (xx, yy, zz, yz, zx, xy) at each depth, tension positive [Pa].
    pub stress: Vec<[f64; 6]>,
}

/// Where the shear is largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestShear {
    /// Largest of the maximum shear stress (sigma_1 - sigma_3) / 2 on the line [Pa].
    pub value: f64,
    /// Its depth [m].
    pub depth: f64,
}

/// The largest shear on the line under the peak pressure, with its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnderPeak {
    /// Largest of the maximum shear stress in the limit of finer and finer meshes [Pa].
    pub shear: f64,
    /// Estimated discretisation error of the shear [Pa].
    pub shear_error: f64,
    /// Its depth on the last mesh [m].
    pub depth: f64,
    /// Estimated error of the depth [m].
    pub depth_error: f64,
}

impl CentreLine {
    /// Maximum shear stress (sigma_1 - sigma_3) / 2 at each depth [Pa].
    pub fn shear(&self) -> Vec<f64> {
        self.stress.iter().map(|&s| maximum_shear(s)).collect()
    }

    /// The largest maximum shear stress and its depth: stresses are cubic between depths. `None` where it is largest at an end of the line.
    ///
    /// Under a circular Hertz contact of radius a it is 0.310 p_max at 0.481 a, under a line contact of half-width b
    /// 0.300 p_max at 0.786 b, for a Poisson's ratio of 0.3 (K. L. Johnson, Contact Mechanics, sections 4.1 and 3.4).
    pub fn largest_shear(&self) -> Option<LargestShear> {
        let shear = self.shear();
        let top = (0..shear.len()).max_by(|&a, &b| shear[a].total_cmp(&shear[b]))?;
        let last = shear.len() - 1;
        // Principal stresses change places where two are equal: shear has a kink there, stresses have none.
        let between = (top.saturating_sub(1)..last.min(top + 1)).flat_map(|k| {
            let (from, to) = (self.depth[k], self.depth[k + 1]);
            (0..=STEPS).map(move |step| from + (to - from) * f64::from(step) / f64::from(STEPS))
        });
        let at = between.map(|depth| LargestShear {
            value: maximum_shear(self.stress_at(depth)),
            depth,
        });
        at.max_by(|a, b| a.value.total_cmp(&b.value))
            .filter(|at| self.depth[0] < at.depth && at.depth < self.depth[last])
    }

    /// Stress at a depth by the cubics through the four depths nearest to it [Pa].
    pub fn stress_at(&self, depth: f64) -> [f64; 6] {
        let count = self.depth.len().min(4);
        let next = self.depth.partition_point(|&d| d < depth);
        let first = next.saturating_sub(2).min(self.depth.len() - count);
        let nodes = &self.depth[first..first + count];
        let mut stress = [0.0; 6];
        for (k, own) in self.stress[first..first + count].iter().enumerate() {
            let weight = lagrange(nodes, k, depth);
            for (sum, part) in stress.iter_mut().zip(own) {
                *sum += weight * part;
            }
        }
        stress
    }
}

/// Steps between two depths in which the largest shear is looked for: it is off by the square of one at the most.
const STEPS: u32 = 200;

/// The polynomial through all nodes that is 1 at node `k` and 0 at the others, at `x`.
pub(crate) fn lagrange(nodes: &[f64], k: usize, x: f64) -> f64 {
    let others = (0..nodes.len()).filter(|&other| other != k);
    others
        .map(|other| (x - nodes[other]) / (nodes[k] - nodes[other]))
        .product()
}
