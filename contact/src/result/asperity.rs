//! The asperities of a contact: its connected components.

use crate::SurfaceField;

/// A connected component of the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asperity {
    /// Centre of pressure, x and y [m].
    pub centre: [f64; 2],
    /// Normal force [N].
    pub force: f64,
    /// Area of its nodes, which exceeds the contact by half a cell at its rim on average [m2].
    pub area: f64,
    /// Largest nodal pressure [Pa].
    pub p_max: f64,
}

impl SurfaceField {
    /// The asperities in contact, the largest force first. Two nodes with pressure belong to the
    /// same asperity if they are neighbours on a line of the grid.
    ///
    /// ```
    /// use kufe_contact::SurfaceField;
    /// let at = |k: usize| k as f64;
    /// let mut pressure = vec![0.0; 15];
    /// (pressure[6], pressure[8]) = (2.0, 3.0);
    /// let field = SurfaceField {
    ///     x: (0..5).map(at).collect(),
    ///     y: (0..3).map(at).collect(),
    ///     gap: vec![0.0; 15],
    ///     yielded: vec![0.0; 15],
    ///     uz: vec![0.0; 15],
    ///     pressure,
    /// };
    /// let found = field.asperities();
    /// assert_eq!(found.len(), 2);
    /// assert_eq!((found[0].force, found[0].centre), (3.0, [3.0, 1.0]));
    /// ```
    pub fn asperities(&self) -> Vec<Asperity> {
        let nx = self.x.len();
        let areas = self.node_areas();
        let mut open: Vec<bool> = self.pressure.iter().map(|p| *p <= 0.0).collect();
        let mut found = Vec::new();
        for first in 0..open.len() {
            let mut waiting = vec![first];
            let (mut force, mut moments, mut area, mut p_max) = (0.0, [0.0; 2], 0.0, 0.0f64);
            while let Some(n) = waiting.pop() {
                if std::mem::replace(&mut open[n], true) {
                    continue;
                }
                let (i, j) = (n % nx, n / nx);
                let own = self.pressure[n] * areas[n];
                force += own;
                moments[0] += own * self.x[i];
                moments[1] += own * self.y[j];
                area += areas[n];
                p_max = p_max.max(self.pressure[n]);
                let along = [(i > 0).then(|| n - 1), (i + 1 < nx).then(|| n + 1)];
                let above = Some(n + nx).filter(|n| *n < areas.len());
                let across = [n.checked_sub(nx), above];
                waiting.extend(along.into_iter().chain(across).flatten());
            }
            if force > 0.0 {
                found.push(Asperity {
                    centre: moments.map(|moment| moment / force),
                    force,
                    area,
                    p_max,
                });
            }
        }
        found.sort_by(|a, b| b.force.total_cmp(&a.force));
        found
    }
}
