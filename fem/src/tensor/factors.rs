//! Coefficients of the kernel of the tensor operator.
//!
//! The 1-D matrices of linear elements are sums over cells. With the difference v = u_(i+1) - u_i
//! and the sum w = u_(i+1) + u_i of a cell of length h between two nodes, and h_i the lumped mass
//! of a node,
//!
//! (M u)_i = h_i u_i + (h v / 6)_(above) - (h v / 6)_(below),
//! (K u)_i = (v / h)_(below) - (v / h)_(above),
//! (2 D u)_i = w_(below) - w_(above),
//!
//! where the terms of a missing cell are 0. So a cell needs two numbers, h / 6 and 1 / h, and a
//! node its lumped mass. For the mass of cellwise means, (u_i + u_(i+1)) (v_i + v_(i+1)) h / 4, h /
//! 4 replaces h / 6.

use crate::tensor::axis::{Axis, Tridiagonal};

/// Two numbers per cell: h / 6, or h / 4 [m], and 1 / h [1/m] times a modulus.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Cell {
    pub mass: f64,
    pub stiffness: f64,
}

/// A row of nodes along x and the cells above it in y.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Lumped mass of y.
    pub lumped: f64,
    /// The cell above for each modulus, mu and lambda + 2 mu, divided by the coupling.
    pub above: [Cell; 2],
}

/// A plane of nodes between two cells of z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer {
    /// Lumped mass of z times the coupling.
    pub lumped: f64,
    /// The cells below and above by modulus, their masses times the coupling.
    pub below: [Cell; 2],
    pub above: [Cell; 2],
}

/// The 1-D matrices with the Lame constants in them.
///
/// In an axis D + D^T is E = diag(-1, 0 .. 0, 1), so that, with a "coupling" s = (lambda + mu) / 4,
///
/// lambda D_x D_y^T + mu D_x^T D_y = -s (2 D_x) (2 D_y) + lambda D_x E_y + mu E_x D_y:
///
/// one product per pair of components in the grid, plus the terms of E on its faces. All terms with
/// M of z are divided by s, so that products of differences need no factor.
#[derive(Clone, Debug)]
pub(crate) struct Factors {
    /// Along x: lumped mass, and h / 6 (or h / 4) of the cells below and above, continued by zeros
    /// to whole vectors.
    pub mass_x: [Vec<f64>; 3],
    /// 1 / h of the cells below and above, by modulus as in [`Row::above`].
    pub stiffness_x: [[Vec<f64>; 2]; 2],
    /// Terms of 2 D and E in addition to u_(i-1) - u_(i+1) at the ends of x, with zeros for missing
    /// nodes: 2 D - share E for the shares of lambda and of mu, and 2 D alone.
    pub ends_x: [Vec<f64>; 3],
    pub rows: Vec<Row>,
    pub layers: Vec<Layer>,
    /// s [Pa].
    pub coupling: f64,
    /// 2 lambda / (lambda + mu) and 2 mu / (lambda + mu).
    pub shares: [f64; 2],
    /// Lame constants [Pa].
    pub lambda: f64,
    pub mu: f64,
    /// Index in the grid of the first plane of these layers.
    pub first: usize,
}

/// How the mass of a cell couples its two nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CellMass {
    /// Products of the linear functions, h / 6.
    Consistent,
    /// Products of their means over the cell, h / 4.
    OfMeans,
}

impl Factors {
    /// The factors of the planes of `z`, of which `first` is the first in the grid.
    pub fn new(
        [x, y, z]: [&Axis; 3],
        [lambda, mu]: [f64; 2],
        mass: CellMass,
        first: usize,
    ) -> Self {
        let cell = |axis: &Axis, e: usize| cell(axis, e, mass);
        let coupling = 0.25 * (lambda + mu);
        let shares = [lambda, mu].map(|modulus| 2.0 * modulus / (lambda + mu));
        let moduli = [mu, lambda + 2.0 * mu];
        let nx = x.len();
        let along_x = |value: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let mut values: Vec<f64> = (0..nx).map(value).collect();
            values.resize(padded(nx), 0.0);
            values
        };
        // Twice for the nodes below and above a cell: that of node i is `offset` 1 below it, 0
        // above it.
        let around = |offset: usize, of: &dyn Fn(Cell) -> f64| {
            along_x(&|i| i.checked_sub(offset).map_or(0.0, |e| of(cell(x, e))))
        };
        let ends = |share: f64| {
            along_x(&|i| match i {
                0 => share - 1.0,
                i if i + 1 == nx => 1.0 - share,
                _ => 0.0,
            })
        };
        Factors {
            mass_x: [
                along_x(&|i| x.lumped_mass[i]),
                around(1, &|c| c.mass),
                around(0, &|c| c.mass),
            ],
            stiffness_x: moduli.map(|modulus| {
                [1, 0].map(|offset| around(offset, &|c| c.stiffness * modulus / coupling))
            }),
            ends_x: [ends(shares[0]), ends(shares[1]), ends(0.0)],
            rows: (0..y.len())
                .map(|j| Row {
                    lumped: y.lumped_mass[j],
                    above: moduli.map(|modulus| cell(y, j).times(1.0, modulus / coupling)),
                })
                .collect(),
            layers: (0..z.len())
                .map(|k| {
                    let scaled = |e: Option<usize>| {
                        let cell = e.map_or(Cell::default(), |e| cell(z, e));
                        moduli.map(|modulus| cell.times(coupling, modulus))
                    };
                    Layer {
                        lumped: coupling * z.lumped_mass[k],
                        below: scaled(k.checked_sub(1)),
                        above: scaled(Some(k)),
                    }
                })
                .collect(),
            coupling,
            shares,
            lambda,
            mu,
            first,
        }
    }

    /// The plane after the last.
    pub fn end(&self) -> usize {
        self.first + self.layers.len()
    }
}

/// Cell `e` of an axis; all zeros after its last.
fn cell(axis: &Axis, e: usize, mass: CellMass) -> Cell {
    axis.nodes.get(e + 1).map_or(Cell::default(), |next| {
        let h = next - axis.nodes[e];
        Cell {
            mass: match mass {
                CellMass::Consistent => h / 6.0,
                CellMass::OfMeans => h / 4.0,
            },
            stiffness: 1.0 / h,
        }
    })
}

impl Cell {
    fn times(self, mass: f64, stiffness: f64) -> Self {
        Cell {
            mass: mass * self.mass,
            stiffness: stiffness * self.stiffness,
        }
    }
}

/// Number of values in the widest vector register.
pub(crate) const WIDEST: usize = 8;

/// Length of a row of `nx` nodes in whole vectors.
pub(crate) fn padded(nx: usize) -> usize {
    nx.next_multiple_of(WIDEST)
}

/// An end of z of one material: the terms with E = diag(-1, 0 .. 0, 1) of z,
///
/// lambda D_x E_z M_y u_z in x, lambda D_y E_z M_x u_z in y and mu E_z (D_x M_y u_x + D_y M_x u_y)
/// in z.
pub(crate) struct FaceTerms<'a> {
    pub axes: [&'a Axis; 2],
    /// Lame constants times E's entry [Pa].
    pub lambda: f64,
    pub mu: f64,
}

impl FaceTerms<'_> {
    /// Adds to the plane's part of K u; `u` is its part by component, and `row` has room for a row.
    pub fn add(&self, u: [&[f64]; 3], row: &mut Vec<f64>, [out_x, out_y, out_z]: [&mut [f64]; 3]) {
        let [x, y] = self.axes;
        let nx = x.len();
        let mut term = |to: &mut [f64],
                        factor: f64,
                        along_x: &Tridiagonal,
                        along_y: &Tridiagonal,
                        u: &[f64]| {
            for (j, (to, [low, on, high])) in to.chunks_exact_mut(nx).zip(along_y).enumerate() {
                let at = |j: usize| &u[j * nx..(j + 1) * nx];
                // Where there is no such row its coefficient is 0.
                let (below, above) = (at(j.saturating_sub(1)), at((j + 1).min(y.len() - 1)));
                row.clear();
                row.push(0.0);
                let three = below.iter().zip(at(j)).zip(above);
                row.extend(three.map(|((b, o), a)| factor * (low * b + on * o + high * a)));
                row.push(0.0);
                for ((to, three), t) in to.iter_mut().zip(row.windows(3)).zip(along_x) {
                    *to += t[0] * three[0] + t[1] * three[1] + t[2] * three[2];
                }
            }
        };
        term(out_x, self.lambda, &x.gradient, &y.mass, u[2]);
        term(out_y, self.lambda, &x.mass, &y.gradient, u[2]);
        term(out_z, self.mu, &x.gradient, &y.mass, u[0]);
        term(out_z, self.mu, &x.mass, &y.gradient, u[1]);
    }
}
