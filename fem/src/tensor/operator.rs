//! The stiffness of trilinear hexahedra on a tensor grid, applied without being stored.

use kufe_mesh::TensorGrid;
use rayon::prelude::*;

use crate::body::{ElementKind, Material};
use crate::tensor::axis::Axis;
use crate::tensor::factors::FaceTerms;
use crate::tensor::factors::{CellMass, Factors};
use crate::tensor::slab::{Pool, Scratch, band_height, part, walk};

/// Components that are fixed on each face: `fixed[c][axis]` is (low face, high face).
pub type FixedFaces = [[[bool; 2]; 3]; 3];

/// Another material in the lower part of a tensor grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowerLayer {
    /// Number of cells along z that it fills, from below.
    pub cells: usize,
    /// Their material.
    pub material: Material,
}

/// Products of 1-D matrices whose sum is the stiffness.
#[derive(Clone, Debug)]
struct Products {
    /// x and y with the mass of these products.
    plane: [Axis; 2],
    /// By layer of material, from below.
    layers: Vec<Factors>,
}

/// Isotropic elasticity on a tensor grid of trilinear hexahedra, in one material or two layers.
///
/// With the 1-D matrices K, M, D of each axis ([`Axis`]) the block of test component c and trial
/// component d is a sum of Kronecker products:
///
/// * c = d: (lambda + 2 mu) K on axis c, M on the others, plus mu K on each other axis in turn;
/// * c != d: lambda D_c D_d^T + mu D_c^T D_d, M on the third axis.
///
/// Vectors hold component after component, each in [`TensorGrid::node`] order: `3 * node_count`
/// numbers. The integration is exact. Cost per node: 52 multiplications, 29 of them fused with an
/// addition, and 48 further additions.
///
/// [`TensorOperator::with_mean_dilatation`] is the operator of [`ElementKind::Hex8Dilatation`], at
/// twice the cost.
#[derive(Clone, Debug)]
pub struct TensorOperator {
    /// x, y and z.
    pub axes: [Axis; 3],
    /// The material, of the upper layer where there are two.
    pub material: Material,
    /// Fixed faces; results are 0 there.
    pub fixed: FixedFaces,
    lower: Option<LowerLayer>,
    kind: ElementKind,
    products: Vec<Products>,
    pool: Pool,
}

impl TensorOperator {
    /// The operator of a grid.
    pub fn new(grid: &TensorGrid, material: Material, fixed: FixedFaces) -> Self {
        let mut operator = TensorOperator {
            axes: [Axis::new(&grid.x), Axis::new(&grid.y), Axis::new(&grid.z)],
            material,
            fixed,
            lower: None,
            kind: ElementKind::Hex8,
            products: Vec::new(),
            pool: Pool::default(),
        };
        operator.multiply_out();
        operator
    }

    /// The operator with another material in its lower cells.
    ///
    /// # Panics
    /// If a layer has no cells.
    pub fn on_layer(mut self, layer: LowerLayer) -> Self {
        let cells = self.axes[2].len() - 1;
        assert!(
            layer.cells >= 1 && layer.cells < cells,
            "{} of {cells} cells in the lower layer",
            layer.cells,
        );
        self.lower = Some(layer);
        self.multiply_out();
        self
    }

    /// The operator with the mean dilatation of each cell in place of the dilatation.
    ///
    /// With the bulk modulus kappa = lambda + 2/3 mu, a cell's energy is the sum of two terms: the
    /// deviatoric energy, that of the plain element with Lame's constants -2/3 mu and mu; and kappa
    /// times the square of the mean dilatation, that of the plain element with kappa and 0 and the
    /// mass matrices of cellwise means.
    pub fn with_mean_dilatation(mut self) -> Self {
        self.kind = ElementKind::Hex8Dilatation;
        self.multiply_out();
        self
    }

    /// The element of its cells.
    pub fn element_kind(&self) -> ElementKind {
        self.kind
    }

    /// The lower layer, where there are two.
    pub fn lower_layer(&self) -> Option<LowerLayer> {
        self.lower
    }

    fn multiply_out(&mut self) {
        // Lame's constants as combinations of lambda and mu, and the mass, of each product.
        let parts: &[([[f64; 2]; 2], CellMass)] = match self.kind {
            ElementKind::Hex8Dilatation => &[
                ([[0.0, -2.0 / 3.0], [0.0, 1.0]], CellMass::Consistent),
                ([[1.0, 2.0 / 3.0], [0.0, 0.0]], CellMass::OfMeans),
            ],
            _ => &[([[1.0, 0.0], [0.0, 1.0]], CellMass::Consistent)],
        };
        let [x, y, z] = &self.axes;
        let products = parts.iter().map(|&(share, mass)| {
            let factors = |first: usize, nodes: &[f64], own: Material| {
                let (lambda, mu) = (own.lame_lambda(), own.shear_modulus());
                let moduli = share.map(|[of_lambda, of_mu]| of_lambda * lambda + of_mu * mu);
                Factors::new([x, y, &Axis::new(nodes)], moduli, mass, first)
            };
            let from = self.lower.map_or(0, |layer| layer.cells);
            let below = self
                .lower
                .iter()
                .map(|layer| factors(0, &z.nodes[..=layer.cells], layer.material));
            let above = factors(from, &z.nodes[from..], self.material);
            Products {
                layers: below.chain([above]).collect(),
                plane: match mass {
                    CellMass::Consistent => [x.clone(), y.clone()],
                    CellMass::OfMeans => [x.averaged(0.0), y.averaged(0.0)],
                },
            }
        });
        self.products = products.collect();
    }

    /// Coefficients along the axes of the scalar operator that preconditions component `c` [Pa]:
    /// lambda + 2 mu along axis `c`, mu along the others.
    pub(crate) fn scalar_coefficients(&self, c: usize) -> [f64; 3] {
        let (lambda, mu) = (self.material.lame_lambda(), self.material.shear_modulus());
        let mut along = [mu; 3];
        along[c] += lambda + mu;
        along
    }

    /// The z axis of component `c` of the preconditioner.
    ///
    /// With two layers its matrices are weighted by the ratio of the lower material's moduli to the
    /// upper one's: mu in the mass and for the horizontal components, lambda + 2 mu in the
    /// stiffness of the vertical one. If both have the same Poisson's ratio, this is exactly the
    /// block diagonal of the stiffness.
    pub(crate) fn preconditioned_z(&self, c: usize) -> Axis {
        let Some(layer) = self.lower else {
            return self.axes[2].clone();
        };
        let (below, above) = (layer.material, self.material);
        let shear = below.shear_modulus() / above.shear_modulus();
        let own = if c == 2 {
            below.uniaxial_strain_modulus() / above.uniaxial_strain_modulus()
        } else {
            shear
        };
        Axis::weighted(&self.axes[2].nodes, |cell| {
            if cell < layer.cells {
                [own, shear]
            } else {
                [1.0; 2]
            }
        })
    }

    /// Nodes along each axis.
    pub fn shape(&self) -> [usize; 3] {
        [self.axes[0].len(), self.axes[1].len(), self.axes[2].len()]
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.shape().iter().product()
    }

    /// Number of displacements that are not on a fixed face.
    pub fn free_dofs(&self) -> usize {
        let free = |c: usize, axis: usize| {
            let fixed = self.fixed[c][axis];
            self.axes[axis].len() - usize::from(fixed[0]) - usize::from(fixed[1])
        };
        (0..3).map(|c| free(c, 0) * free(c, 1) * free(c, 2)).sum()
    }

    /// Sets the fixed entries of a vector to 0.
    pub fn mask(&self, u: &mut [f64]) {
        let [nx, ny, nz] = self.shape();
        let nodes = nx * ny * nz;
        for (c, component) in u.chunks_exact_mut(nodes).enumerate() {
            component
                .par_chunks_mut(nx * ny)
                .enumerate()
                .for_each(|(k, plane)| {
                    mask_plane(plane, self.fixed[c], [nx, ny, nz], k);
                });
        }
    }

    /// `out` = K `u`, with 0 on fixed entries; the fixed entries of `u` are prescribed values.
    ///
    /// # Panics
    /// If a vector does not have `3 * node_count` numbers.
    pub fn apply(&self, u: &[f64], out: &mut [f64]) {
        self.apply_in_bands(u, out, band_height(self.shape()));
    }

    /// [`TensorOperator::apply`] with bands of `height` rows.
    pub(super) fn apply_in_bands(&self, u: &[f64], out: &mut [f64], height: usize) {
        let [nx, ny, nz] = self.shape();
        let plane = nx * ny;
        let nodes = plane * nz;
        assert_eq!(
            (u.len(), out.len()),
            (3 * nodes, 3 * nodes),
            "vectors of {nodes} nodes"
        );
        // Every plane's numbers are the same in any slab, so slabs may depend on the number of
        // threads.
        let planes = nz.div_ceil(rayon::current_num_threads());
        let slab = planes.max(MIN_PLANES) * plane;
        let (out_x, rest) = out.split_at_mut(nodes);
        let (out_y, out_z) = rest.split_at_mut(nodes);
        out_x
            .par_chunks_mut(slab)
            .zip(out_y.par_chunks_mut(slab))
            .zip(out_z.par_chunks_mut(slab))
            .enumerate()
            .for_each(|(place, ((x, y), z))| {
                let first = place * slab / plane;
                self.pool.with(self.shape(), |scratch| {
                    self.slab(u, first, height, scratch, &mut [x, y, z]);
                });
            });
    }

    /// K u on the planes from `first` on, as many as `out` holds by component.
    fn slab(
        &self,
        u: &[f64],
        first: usize,
        height: usize,
        scratch: &mut Scratch,
        out: &mut [&mut [f64]; 3],
    ) {
        let [nx, ny, nz] = self.shape();
        let length = out[0].len();
        if let Some((products, others)) = self.products.split_first() {
            self.slab_of(products, u, (first, height), scratch, out);
            for products in others {
                let mut further = std::mem::take(&mut scratch.further);
                further.resize(3 * length, 0.0);
                let (x, rest) = further.split_at_mut(length);
                let (y, z) = rest.split_at_mut(length);
                self.slab_of(products, u, (first, height), scratch, &mut [x, y, z]);
                for (sum, part) in out.iter_mut().zip(further.chunks_exact(length)) {
                    sum.iter_mut().zip(part).for_each(|(sum, v)| *sum += *v);
                }
                scratch.further = further;
            }
        }
        for (c, component) in out.iter_mut().enumerate() {
            for (place, plane) in component.chunks_exact_mut(nx * ny).enumerate() {
                mask_plane(plane, self.fixed[c], [nx, ny, nz], first + place);
            }
        }
    }

    /// Adds one of the sums of products, without the mask of fixed entries.
    fn slab_of(
        &self,
        products: &Products,
        u: &[f64],
        (first, height): (usize, usize),
        scratch: &mut Scratch,
        out: &mut [&mut [f64]; 3],
    ) {
        let shape = self.shape();
        let size = shape[0] * shape[1];
        let planes = first..first + out[0].len() / size;
        let mut shared = Vec::new();
        for factors in &products.layers {
            let own = planes.start.max(factors.first)..planes.end.min(factors.end());
            if own.is_empty() {
                continue;
            }
            let from = (own.start - first) * size;
            // At the interface of two materials both contribute.
            let meet = own.start == factors.first && own.start > 0;
            if meet {
                shared = part(out, from..from + size)
                    .map(|plane| plane.to_vec())
                    .concat();
            }
            let mut of_own = part(out, from..from + own.len() * size);
            walk(factors, u, shape, own.clone(), height, scratch, &mut of_own);
            for (k, sign) in [(factors.first, -1.0), (factors.end() - 1, 1.0)] {
                if own.contains(&k) && !self.is_fixed(k) {
                    let at = (k - first) * size;
                    let [x, y] = &products.plane;
                    let of = |c: usize| &u[(c * shape[2] + k) * size..][..size];
                    let face = FaceTerms {
                        axes: [x, y],
                        lambda: sign * factors.lambda,
                        mu: sign * factors.mu,
                    };
                    let u = [of(0), of(1), of(2)];
                    face.add(u, &mut scratch.row, part(out, at..at + size));
                }
            }
            if meet {
                let parts = part(out, from..from + size)
                    .into_iter()
                    .zip(shared.chunks_exact(size));
                for (sum, part) in parts {
                    sum.iter_mut().zip(part).for_each(|(sum, v)| *sum += *v);
                }
            }
        }
    }

    /// Whether all of plane `k` is fixed.
    fn is_fixed(&self, k: usize) -> bool {
        let last = self.axes[2].len() - 1;
        let on = |fixed: &[[bool; 2]; 3]| (fixed[2][0] && k == 0) || (fixed[2][1] && k == last);
        self.fixed.iter().all(on)
    }
}

/// Smallest number of planes of a slab, which also computes with the two adjacent planes.
const MIN_PLANES: usize = 4;

fn mask_plane(plane: &mut [f64], fixed: [[bool; 2]; 3], shape: [usize; 3], k: usize) {
    let [nx, ny, nz] = shape;
    if (fixed[2][0] && k == 0) || (fixed[2][1] && k == nz - 1) {
        plane.fill(0.0);
        return;
    }
    if fixed[1][0] {
        plane[..nx].fill(0.0);
    }
    if fixed[1][1] {
        plane[(ny - 1) * nx..].fill(0.0);
    }
    for row in plane.chunks_exact_mut(nx) {
        if fixed[0][0] {
            row[0] = 0.0;
        }
        if fixed[0][1] {
            row[nx - 1] = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    //! The operator against assembled matrices, and its bits for any slabs and bands.

    use kufe_mesh::TensorGrid;

    use super::*;
    use crate::body::Body;
    use crate::body::Material;
    use crate::body::Section;
    use crate::precondition::elimination::End;
    use crate::precondition::fast_diagonal::FastDiagonal;
    use crate::precondition::planewise_diagonal::PlanewiseDiagonal;
    use crate::sparse::assembly::assemble;

    /// The assembled stiffness of the same hexahedra, on graded grids whose rows are shorter and
    /// longer than a register.
    #[test]
    fn operator_is_the_assembled_stiffness() {
        for shape in [
            [2, 2, 2],
            [3, 5, 4],
            [9, 2, 3],
            [12, 6, 5],
            [16, 3, 4],
            [17, 3, 3],
            [35, 4, 3],
        ] {
            let axis = |n: usize, growth: f64| -> Vec<f64> {
                (0..n).map(|i| 1e-2 * growth.powi(i as i32)).collect()
            };
            let grid = TensorGrid {
                x: axis(shape[0], 1.4),
                y: axis(shape[1], 1.3),
                z: axis(shape[2], 1.7),
            };
            let nodes = grid.node_count();
            let ice = Material::new(9e9, 0.33).unwrap();
            let free = [[[false; 2]; 3]; 3];
            let plain = TensorOperator::new(&grid, ice, free);
            for operator in [plain.clone(), plain.with_mean_dilatation()] {
                let body = Body::uniform(grid.hex_mesh(), ice, operator.element_kind()).unwrap();
                let u: Vec<f64> = (0..3 * nodes).map(|i| (1.3 * i as f64).sin()).collect();
                let (mut expected, mut found) = (vec![0.0; 3 * nodes], vec![f64::NAN; 3 * nodes]);
                assemble(&body).apply(&u, &mut expected);
                let by_component: Vec<f64> = (0..3 * nodes)
                    .map(|i| u[3 * (i % nodes) + i / nodes])
                    .collect();
                operator.apply(&by_component, &mut found);
                let size = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                for (i, found) in found.iter().enumerate() {
                    let expected = expected[3 * (i % nodes) + i / nodes];
                    assert!(
                        (found - expected).abs() < 1e-13 * size,
                        "{shape:?}, {i}: {found} instead of {expected}"
                    );
                }
            }
        }
    }

    fn layered() -> (TensorGrid, Material, Material, LowerLayer) {
        let grid = TensorGrid {
            x: vec![0.0, 0.1, 0.3, 0.6],
            y: vec![-0.2, 0.0, 0.1],
            z: vec![-1.0, -0.6, -0.3, -0.1, 0.0],
        };
        let ice = Material::new(9.0e9, 0.33).unwrap();
        let concrete = Material::new(30.0e9, 0.2).unwrap();
        let layer = LowerLayer {
            cells: 2,
            material: concrete,
        };
        (grid, ice, concrete, layer)
    }

    #[test]
    fn two_layers_have_the_assembled_stiffness_of_their_hexahedra() {
        let (grid, ice, concrete, layer) = layered();
        let free = [[[false; 2]; 3]; 3];
        let plain = TensorOperator::new(&grid, ice, free).on_layer(layer);
        for operator in [plain.clone(), plain.with_mean_dilatation()] {
            let mesh = grid.hex_mesh();
            let of = |material| Section {
                material,
                kind: operator.element_kind(),
            };
            let mut sections = vec![of(ice); mesh.cells.len()];
            sections[..mesh.cells.len() / 2].fill(of(concrete));
            let assembled = assemble(&Body::new(mesh, sections).unwrap());
            let nodes = grid.node_count();
            let u: Vec<f64> = (0..3 * nodes).map(|i| (1.7 * i as f64).sin()).collect();
            let by_node: Vec<f64> = (0..3 * nodes).map(|i| u[i % 3 * nodes + i / 3]).collect();
            let (mut out, mut expected) = (vec![0.0; 3 * nodes], vec![0.0; 3 * nodes]);
            operator.apply(&u, &mut out);
            assembled.apply(&by_node, &mut expected);
            let largest = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for i in 0..3 * nodes {
                let error = (out[i % 3 * nodes + i / 3] - expected[i]).abs();
                assert!(error < 1e-12 * largest, "{error:e} of {largest:e}");
            }
        }
    }

    #[test]
    fn slabs_give_the_same_bits_for_any_number_of_threads() {
        let (_, ice, concrete, _) = layered();
        let axis = |n: usize| -> Vec<f64> { (0..n).map(|i| 1.1f64.powi(i as i32)).collect() };
        let grid = TensorGrid {
            x: axis(11),
            y: axis(6),
            z: axis(23),
        };
        let fixed = [[[true, false], [false, true], [true, false]]; 3];
        let plain = TensorOperator::new(&grid, ice, fixed);
        let lower = |cells: usize| {
            plain.clone().on_layer(LowerLayer {
                cells,
                material: concrete,
            })
        };
        // Slabs of two threads begin at plane 12, those of five at planes 5, 10, 15 and 20.
        let layered = [lower(4), lower(5), lower(11), lower(12)];
        let means = lower(5).with_mean_dilatation();
        for operator in layered.into_iter().chain([plain.clone(), means]) {
            let n = 3 * operator.node_count();
            let u: Vec<f64> = (0..n).map(|i| (0.9 * i as f64).sin()).collect();
            let with = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                let mut out = vec![f64::NAN; n];
                pool.build()
                    .unwrap()
                    .install(|| operator.apply(&u, &mut out));
                out
            };
            let one = with(1);
            assert!(one.iter().all(|v| v.is_finite()));
            for threads in [2, 3, 5] {
                assert_eq!(one, with(threads), "{threads} threads");
            }
        }
    }

    #[test]
    fn bands_give_the_same_bits_for_any_number_of_rows() {
        let (_, ice, concrete, _) = layered();
        let axis = |n: usize| -> Vec<f64> { (0..n).map(|i| 1.1f64.powi(i as i32)).collect() };
        let fixed = [[[true, false], [false, true], [true, false]]; 3];
        for nx in [5, 8, 21] {
            let grid = TensorGrid {
                x: axis(nx),
                y: axis(17),
                z: axis(9),
            };
            let operator = TensorOperator::new(&grid, ice, fixed).on_layer(LowerLayer {
                cells: 3,
                material: concrete,
            });
            let n = 3 * operator.node_count();
            let u: Vec<f64> = (0..n).map(|i| (0.9 * i as f64).sin()).collect();
            let with = |height: usize| {
                let mut out = vec![f64::NAN; n];
                operator.apply_in_bands(&u, &mut out, height);
                out
            };
            let whole = with(17);
            assert!(whole.iter().all(|v| v.is_finite()));
            for height in [1, 2, 5, 8, 16] {
                assert_eq!(whole, with(height), "{height} rows of {nx}");
            }
        }
    }

    /// With one Poisson's ratio the preconditioner is the inverse of the stiffness' diagonal
    /// blocks, layers included: on a displacement of one component P^-1 K u gives u back in that
    /// component.
    #[test]
    fn layers_of_one_poissons_ratio_are_inverted_exactly_in_each_component() {
        let (grid, ice, _, _) = layered();
        let stiff = Material::new(30.0e9, 0.33).unwrap();
        let layer = LowerLayer {
            cells: 2,
            material: stiff,
        };
        let fixed = [[[true; 2], [true; 2], [true, false]]; 3];
        let operator = TensorOperator::new(&grid, ice, fixed).on_layer(layer);
        let fast = FastDiagonal::new(&operator, None);
        let nodes = grid.node_count();
        for c in 0..3 {
            let mut u = vec![0.0; 3 * nodes];
            (0..nodes).for_each(|n| u[c * nodes + n] = (2.3 * n as f64).cos());
            operator.mask(&mut u);
            let mut force = vec![0.0; 3 * nodes];
            operator.apply(&u, &mut force);
            let mut back = vec![0.0; 3 * nodes];
            let mut modal = vec![0.0; fast.mode_count()];
            let mut scratch = vec![0.0; fast.scratch_len()];
            fast.apply(&force, &mut back, &mut modal, &mut scratch);
            for n in c * nodes..(c + 1) * nodes {
                assert!((back[n] - u[n]).abs() < 1e-10, "{} {}", back[n], u[n]);
            }
            let eliminated = PlanewiseDiagonal::new(&operator, End::High);
            eliminated.apply(&force, &mut back, &mut modal);
            // Its products are done in single precision.
            for n in c * nodes..(c + 1) * nodes {
                assert!((back[n] - u[n]).abs() < 1e-5, "{} {}", back[n], u[n]);
            }
        }
    }
}
