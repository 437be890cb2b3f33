//! The trilinear eight-node hexahedron.
//!
//! Corners are in VTK's order. Displacements and forces of an element are 24 numbers, corner by
//! corner, (x, y, z) within a corner. Strains and stresses are (xx, yy, zz, yz, zx, xy) with
//! engineering shear strains. Source: T. J. R. Hughes, The Finite Element Method (1987), chapter 3.

use crate::body::Material;

/// Positions of an element's eight corners [m].
pub type Corners = [[f64; 3]; 8];

/// A 24 x 24 matrix of an element, by rows.
pub type ElementMatrix = [[f64; 24]; 24];

/// Natural coordinates of the corners.
pub const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// For each corner its edges along xi, eta and zeta, each from its low end to its high one.
pub(crate) const EDGES: [[[usize; 2]; 3]; 8] = [
    [[0, 1], [0, 3], [0, 4]],
    [[0, 1], [1, 2], [1, 5]],
    [[3, 2], [1, 2], [2, 6]],
    [[3, 2], [0, 3], [3, 7]],
    [[4, 5], [4, 7], [0, 4]],
    [[4, 5], [5, 6], [1, 5]],
    [[7, 6], [5, 6], [2, 6]],
    [[7, 6], [4, 7], [3, 7]],
];

/// Abscissa 1/sqrt(3) of the two-point Gauss rule; its weights are 1.
pub const GAUSS: f64 = 0.577_350_269_189_625_8;

/// Natural coordinates of the 2 x 2 x 2 Gauss points, in the order of the nearest corners.
pub fn gauss_points() -> [[f64; 3]; 8] {
    CORNERS.map(|corner| corner.map(|c| c * GAUSS))
}

/// Shape functions N_a = (1 + xi xi_a)(1 + eta eta_a)(1 + zeta zeta_a) / 8 at natural coordinates
/// `xi`.
pub fn shape_functions(xi: [f64; 3]) -> [f64; 8] {
    CORNERS.map(|c| (0..3).map(|k| 1.0 + xi[k] * c[k]).product::<f64>() / 8.0)
}

/// Derivatives of the shape functions by the natural coordinates.
pub fn shape_derivatives(xi: [f64; 3]) -> [[f64; 3]; 8] {
    CORNERS.map(|c| {
        let f = [1.0 + xi[0] * c[0], 1.0 + xi[1] * c[1], 1.0 + xi[2] * c[2]];
        [
            c[0] * f[1] * f[2] / 8.0,
            f[0] * c[1] * f[2] / 8.0,
            f[0] * f[1] * c[2] / 8.0,
        ]
    })
}

/// The map from natural to real coordinates at one point.
#[derive(Clone, Copy, Debug)]
pub struct Jacobian {
    /// Rows d xi_m / d x_i [1/m].
    pub inverse: [[f64; 3]; 3],
    /// Determinant of d x_i / d xi_m [m^3]; positive for a valid element.
    pub determinant: f64,
}

impl Jacobian {
    /// The map of the element with these corners at natural coordinates `xi`.
    ///
    /// The inverse is not finite if the determinant is zero.
    pub fn at(corners: &Corners, xi: [f64; 3]) -> Self {
        Self::from_derivatives(corners, &shape_derivatives(xi))
    }

    fn from_derivatives(corners: &Corners, derivatives: &[[f64; 3]; 8]) -> Self {
        let mut j = [[0.0; 3]; 3];
        for (corner, d) in corners.iter().zip(derivatives) {
            for i in 0..3 {
                for m in 0..3 {
                    j[i][m] += corner[i] * d[m];
                }
            }
        }
        let cofactor = |i: usize, m: usize| {
            let (i1, i2, m1, m2) = ((i + 1) % 3, (i + 2) % 3, (m + 1) % 3, (m + 2) % 3);
            j[i1][m1] * j[i2][m2] - j[i1][m2] * j[i2][m1]
        };
        let determinant = (0..3).map(|m| j[0][m] * cofactor(0, m)).sum::<f64>();
        let inverse =
            std::array::from_fn(|m| std::array::from_fn(|i| cofactor(i, m) / determinant));
        Self {
            inverse,
            determinant,
        }
    }
}

/// Gradients d N_a / d x of the shape functions [1/m] at natural coordinates `xi`, and the Jacobian
/// determinant [m^3].
pub fn gradients(corners: &Corners, xi: [f64; 3]) -> ([[f64; 3]; 8], f64) {
    let derivatives = shape_derivatives(xi);
    let jacobian = Jacobian::from_derivatives(corners, &derivatives);
    let g = derivatives.map(|d| pull_back(d, &jacobian.inverse));
    (g, jacobian.determinant)
}

/// Lengths along x, y and z [m] of an element that is a box along these axes with its corners in
/// order; `None` for another element.
pub fn box_lengths(corners: &Corners) -> Option<[f64; 3]> {
    let (low, high) = (corners[0], corners[6]);
    let boxed = CORNERS.iter().zip(corners).all(|(natural, corner)| {
        (0..3).all(|i| corner[i] == if natural[i] < 0.0 { low[i] } else { high[i] })
    });
    boxed.then(|| std::array::from_fn(|i| high[i] - low[i]))
}

/// Gradient in real coordinates of a function with the natural derivatives `d`.
pub(crate) fn pull_back(d: [f64; 3], inverse: &[[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|i| d[0] * inverse[0][i] + d[1] * inverse[1][i] + d[2] * inverse[2][i])
}

/// Smallest Jacobian determinant [m^3] over the Gauss points and the centre.
///
/// The stiffness of an element is only meaningful if this is positive.
pub fn smallest_determinant(corners: &Corners) -> f64 {
    if let Some([x, y, z]) = box_lengths(corners).filter(|lengths| lengths.iter().all(|l| *l > 0.0))
    {
        return x * y * z / 8.0;
    }
    let centre = Jacobian::at(corners, [0.0; 3]).determinant;
    gauss_points().iter().fold(centre, |smallest, &xi| {
        let d = Jacobian::at(corners, xi).determinant;
        // NaN takes precedence over any number.
        if d < smallest || d.is_nan() {
            d
        } else {
            smallest
        }
    })
}

/// Volume of the element [m^3], exact for straight edges.
pub fn volume(corners: &Corners) -> f64 {
    gauss_points()
        .iter()
        .map(|&xi| Jacobian::at(corners, xi).determinant)
        .sum()
}

/// Strain-displacement matrix B (6 x 24) [1/m] at natural coordinates `xi`: strain = B u.
pub fn strain_displacement(corners: &Corners, xi: [f64; 3]) -> [[f64; 24]; 6] {
    let mut b = [[0.0; 24]; 6];
    for (a, g) in gradients(corners, xi).0.iter().enumerate() {
        for (c, row, axis) in [
            (0, 0, 0),
            (1, 1, 1),
            (2, 2, 2),
            (2, 3, 1),
            (1, 3, 2),
            (0, 4, 2),
            (2, 4, 0),
            (1, 5, 0),
            (0, 5, 1),
        ] {
            b[row][3 * a + c] = g[axis];
        }
    }
    b
}

/// Adds the stiffness density of two scalar functions with gradients `ga` and `gb`, for Lame
/// constants times a point's weight, to a 3 x 3 block: K_ij = lambda ga_i gb_j + mu ga_j gb_i + mu
/// (ga . gb) delta_ij.
#[inline]
pub(crate) fn add_block(
    block: &mut [[f64; 3]; 3],
    [ga, gb]: [[f64; 3]; 2],
    [lambda, mu]: [f64; 2],
) {
    let dot = mu * (ga[0] * gb[0] + ga[1] * gb[1] + ga[2] * gb[2]);
    for i in 0..3 {
        for j in 0..3 {
            block[i][j] += lambda * ga[i] * gb[j] + mu * ga[j] * gb[i];
        }
        block[i][i] += dot;
    }
}

/// Adds a point's weight times B^T D B to the upper half of a stiffness, for elements with a
/// modified B (6 x 24).
pub(crate) fn add_density(
    k: &mut ElementMatrix,
    b: &[[f64; 24]; 6],
    weight: f64,
    material: Material,
) {
    for j in 0..24 {
        let stress = material.stress(std::array::from_fn(|row| b[row][j]));
        for i in 0..=j {
            let density: f64 = (0..6).map(|row| b[row][i] * stress[row]).sum();
            k[i][j] += weight * density;
        }
    }
}

/// The symmetric matrix with the upper half of `k`.
pub(crate) fn mirrored(mut k: ElementMatrix) -> ElementMatrix {
    for j in 0..24 {
        for i in 0..j {
            k[j][i] = k[i][j];
        }
    }
    k
}

/// Stiffness matrix K = integral of B^T D B over the element, 2 x 2 x 2 Gauss points.
///
/// 24 x 24, symmetric [N/m]. Every Jacobian determinant must be positive
/// ([`smallest_determinant`]); [`crate::Body`] checks it.
pub fn stiffness(corners: &Corners, material: Material) -> ElementMatrix {
    let (lambda, mu) = (material.lame_lambda(), material.shear_modulus());
    let mut blocks = [[[[0.0; 3]; 3]; 8]; 8];
    for xi in gauss_points() {
        let (g, determinant) = gradients(corners, xi);
        for a in 0..8 {
            for b in a..8 {
                let moduli = [lambda * determinant, mu * determinant];
                add_block(&mut blocks[a][b], [g[a], g[b]], moduli);
            }
        }
    }
    let mut k = [[0.0; 24]; 24];
    for a in 0..8 {
        for b in a..8 {
            for i in 0..3 {
                for j in 0..3 {
                    k[3 * a + i][3 * b + j] = blocks[a][b][i][j];
                    k[3 * b + j][3 * a + i] = blocks[a][b][i][j];
                }
            }
        }
    }
    k
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// An element whose corners are moved by up to a quarter of its edges, and stretched by axis.
    pub fn distorted(scale: [f64; 3]) -> Corners {
        let mut seed = 1u64;
        CORNERS.map(|c| {
            std::array::from_fn(|k| {
                seed = seed
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                let noise = (seed >> 33) as f64 / (1u64 << 31) as f64 - 0.5;
                scale[k] * (c[k] + noise)
            })
        })
    }

    fn times(k: &ElementMatrix, u: &[f64; 24]) -> [f64; 24] {
        std::array::from_fn(|i| (0..24).map(|j| k[i][j] * u[j]).sum())
    }

    pub fn rigid_motions(corners: &Corners) -> Vec<[f64; 24]> {
        let mut modes = Vec::new();
        for axis in 0..3 {
            let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
            let (mut shift, mut turn) = ([0.0; 24], [0.0; 24]);
            for a in 0..8 {
                shift[3 * a + axis] = 1.0;
                turn[3 * a + p] = -corners[a][q];
                turn[3 * a + q] = corners[a][p];
            }
            modes.push(shift);
            modes.push(turn);
        }
        modes
    }

    #[test]
    fn shape_functions_sum_to_one_and_are_one_at_their_corner() {
        for xi in [[0.1, -0.7, 0.4], [1.0, -1.0, 0.3]] {
            assert!((shape_functions(xi).iter().sum::<f64>() - 1.0).abs() < 1e-15);
            for axis in 0..3 {
                let sum: f64 = shape_derivatives(xi).iter().map(|d| d[axis]).sum();
                assert!(sum.abs() < 1e-15);
            }
        }
        for a in 0..8 {
            assert_eq!(shape_functions(CORNERS[a])[a], 1.0);
        }
    }

    #[test]
    fn stiffness_is_symmetric_and_leaves_rigid_motions_free() {
        let corners = distorted([1.0, 0.1, 3.0]);
        let k = stiffness(&corners, Material::new(1.0, 0.3).unwrap());
        let size = k.iter().flatten().fold(0.0f64, |s, v| s.max(v.abs()));
        for mode in rigid_motions(&corners) {
            for f in times(&k, &mode) {
                assert!(f.abs() < 1e-13 * size, "{f}");
            }
        }
        for (i, row) in k.iter().enumerate() {
            for (j, v) in row.iter().enumerate() {
                assert_eq!(*v, k[j][i]);
            }
        }
    }

    #[test]
    fn stiffness_is_the_integral_of_b_transposed_d_b() {
        let corners = distorted([1.0, 0.5, 2.0]);
        let material = Material::new(3.0, 0.25).unwrap();
        let k = stiffness(&corners, material);
        for j in 0..24 {
            let mut column = [0.0; 24];
            for xi in gauss_points() {
                let b = strain_displacement(&corners, xi);
                let stress = material.stress(std::array::from_fn(|r| b[r][j]));
                let determinant = Jacobian::at(&corners, xi).determinant;
                for i in 0..24 {
                    column[i] += determinant * (0..6).map(|r| b[r][i] * stress[r]).sum::<f64>();
                }
            }
            for i in 0..24 {
                assert!((column[i] - k[i][j]).abs() < 1e-13, "{i} {j}");
            }
        }
    }

    #[test]
    fn an_inverted_element_has_a_negative_determinant() {
        let mut corners = CORNERS;
        assert!((smallest_determinant(&corners) - 1.0).abs() < 1e-15);
        corners.swap(0, 6);
        assert!(smallest_determinant(&corners) < 0.0);
        corners[0][0] = f64::NAN;
        assert!(smallest_determinant(&corners).is_nan());
    }
}
