//! Bodies of hexahedra: materials, element kinds, and checks made once.

use kufe_mesh::HexMesh;
use rayon::prelude::*;

use crate::element::hex8::{self, Corners, ElementMatrix};
use crate::element::{hex8_axial, hex8_dilatation, hex8_incompatible};
use crate::error::Error;

/// A hexahedral mesh whose cells have materials and elements, checked once.
///
/// Displacements and forces of a body are `3 * node_count` numbers, node by node, (x, y, z) within
/// a node.
///
/// ```
/// use kufe_fem::{Body, ElementKind, Material};
/// use kufe_mesh::TensorGrid;
/// let grid = TensorGrid { x: vec![0.0, 1.0], y: vec![0.0, 1.0], z: vec![0.0, 1.0] };
/// let steel = Material::new(210e9, 0.3)?;
/// let body = Body::uniform(grid.hex_mesh(), steel, ElementKind::Hex8Incompatible)?;
/// assert_eq!(body.dofs(), 24);
/// # Ok::<(), kufe_fem::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Body {
    mesh: HexMesh,
    sections: Vec<Section>,
}

impl Body {
    /// A body with one section per cell.
    ///
    /// Fails if there are no cells, a cell names a missing node, a Jacobian determinant at a Gauss
    /// point or at a cell's centre is not positive, the number of sections differs from that of
    /// cells, or the number of nodes exceeds 32 bits.
    pub fn new(mesh: HexMesh, sections: Vec<Section>) -> Result<Self, Error> {
        let node_count = mesh.points.len();
        let limit = (u32::MAX / 3) as usize;
        if mesh.cells.is_empty() {
            return Err(Error::NoCells);
        }
        if node_count > limit {
            return Err(Error::TooManyNodes { node_count, limit });
        }
        if sections.len() != mesh.cells.len() {
            return Err(Error::Length {
                what: "sections of a body's cells",
                found: sections.len(),
                expected: mesh.cells.len(),
            });
        }
        let nodes = mesh.cells.as_flattened().iter();
        if let Some((place, &node)) = nodes.enumerate().find(|(_, node)| **node >= node_count) {
            return Err(Error::NodeIndex {
                cell: place / 8,
                node,
                node_count,
            });
        }
        let body = Self { mesh, sections };
        let inverted = (0..body.mesh.cells.len())
            .into_par_iter()
            .find_map_first(|cell| {
                let determinant = hex8::smallest_determinant(&body.corners(cell));
                let valid = determinant > 0.0 && determinant.is_finite();
                (!valid).then_some(Error::InvertedCell { cell, determinant })
            });
        inverted.map_or(Ok(body), Err)
    }

    /// A body of one material and one kind of element. Fails as [`Body::new`].
    pub fn uniform(mesh: HexMesh, material: Material, kind: ElementKind) -> Result<Self, Error> {
        let sections = vec![Section { material, kind }; mesh.cells.len()];
        Self::new(mesh, sections)
    }

    /// The mesh.
    pub fn mesh(&self) -> &HexMesh {
        &self.mesh
    }

    /// The sections, one per cell.
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.mesh.points.len()
    }

    /// Number of displacements, three per node.
    pub fn dofs(&self) -> usize {
        3 * self.mesh.points.len()
    }

    /// Positions of a cell's corners [m].
    pub fn corners(&self, cell: usize) -> Corners {
        self.mesh.cells[cell].map(|node| self.mesh.points[node])
    }

    /// The 24 values of `u` (`dofs` long) at a cell's corners.
    pub fn gather(&self, cell: usize, u: &[f64]) -> [f64; 24] {
        let nodes = &self.mesh.cells[cell];
        std::array::from_fn(|d| u[3 * nodes[d / 3] + d % 3])
    }
}

/// Kind of an eight-node hexahedron.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ElementKind {
    /// Trilinear, 2 x 2 x 2 Gauss points. Locks in bending of thin bodies.
    #[default]
    Hex8,
    /// Trilinear with incompatible modes, for bodies that bend.
    Hex8Incompatible,
    /// Trilinear with the shear of planes across its first axis averaged along it, for beams along
    /// that axis.
    Hex8Axial,
    /// Trilinear with the mean change of volume, for nearly incompressible materials.
    Hex8Dilatation,
}

impl ElementKind {
    /// The element of a block that does not bend: [`ElementKind::Hex8`], or
    /// [`ElementKind::Hex8Dilatation`] from a Poisson's ratio of
    /// [`hex8_dilatation::NEARLY_INCOMPRESSIBLE`] on.
    pub fn of_block(poissons_ratio: f64) -> Self {
        if poissons_ratio >= hex8_dilatation::NEARLY_INCOMPRESSIBLE {
            ElementKind::Hex8Dilatation
        } else {
            ElementKind::Hex8
        }
    }
}

/// Material and element of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// The material.
    pub material: Material,
    /// The element.
    pub kind: ElementKind,
}

impl Section {
    /// Stiffness matrix (24 x 24) [N/m] of an element with these corners [m].
    pub fn stiffness(&self, corners: &Corners) -> ElementMatrix {
        match self.kind {
            ElementKind::Hex8 => hex8::stiffness(corners, self.material),
            ElementKind::Hex8Incompatible => hex8_incompatible::stiffness(corners, self.material),
            ElementKind::Hex8Axial => hex8_axial::stiffness(corners, self.material),
            ElementKind::Hex8Dilatation => hex8_dilatation::stiffness(corners, self.material),
        }
    }
}

/// An isotropic linear elastic material.
///
/// ```
/// let ice = kufe_fem::Material::new(9.0e9, 0.33)?;
/// assert!((ice.plane_strain_modulus() - 10.1e9).abs() < 1e7);
/// # Ok::<(), kufe_fem::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    youngs_modulus: f64,
    poissons_ratio: f64,
}

impl Material {
    /// A material from Young's modulus E [Pa] and Poisson's ratio nu.
    ///
    /// Fails unless 0 < E < infinity and -1 < nu < 0.5.
    pub fn new(youngs_modulus: f64, poissons_ratio: f64) -> Result<Self, Error> {
        if !(youngs_modulus > 0.0 && youngs_modulus.is_finite()) {
            return Err(Error::YoungsModulus {
                found: youngs_modulus,
            });
        }
        if !(poissons_ratio > -1.0 && poissons_ratio < 0.5) {
            return Err(Error::PoissonsRatio {
                found: poissons_ratio,
            });
        }
        Ok(Self {
            youngs_modulus,
            poissons_ratio,
        })
    }

    /// Young's modulus E [Pa].
    pub fn youngs_modulus(&self) -> f64 {
        self.youngs_modulus
    }

    /// Poisson's ratio nu.
    pub fn poissons_ratio(&self) -> f64 {
        self.poissons_ratio
    }

    /// Shear modulus, Lame's second constant: mu = E / (2 (1 + nu)) [Pa].
    pub fn shear_modulus(&self) -> f64 {
        self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))
    }

    /// Lame's first constant: lambda = E nu / ((1 + nu) (1 - 2 nu)) [Pa].
    pub fn lame_lambda(&self) -> f64 {
        let nu = self.poissons_ratio;
        self.youngs_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    }

    /// Plane-strain modulus: E' = E / (1 - nu^2) [Pa], the half-space's modulus in contact.
    pub fn plane_strain_modulus(&self) -> f64 {
        self.youngs_modulus / (1.0 - self.poissons_ratio * self.poissons_ratio)
    }

    /// Modulus of uniaxial strain: M = lambda + 2 mu [Pa].
    pub fn uniaxial_strain_modulus(&self) -> f64 {
        self.lame_lambda() + 2.0 * self.shear_modulus()
    }

    /// Stress [Pa] of a small strain, both as (xx, yy, zz, yz, zx, xy) with engineering shear
    /// strains.
    ///
    /// sigma = lambda tr(epsilon) I + 2 mu epsilon.
    pub fn stress(&self, strain: [f64; 6]) -> [f64; 6] {
        let mu = self.shear_modulus();
        let pressure = self.lame_lambda() * (strain[0] + strain[1] + strain[2]);
        [
            pressure + 2.0 * mu * strain[0],
            pressure + 2.0 * mu * strain[1],
            pressure + 2.0 * mu * strain[2],
            mu * strain[3],
            mu * strain[4],
            mu * strain[5],
        ]
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use kufe_mesh::TensorGrid;

    use super::*;

    /// A moved block of about `n`^3 cells of five materials, every other one with incompatible
    /// modes.
    pub fn mixed(n: usize) -> Body {
        let mesh = block([n, n + 1, n + 2], [1.0, 2.0, 0.5], 0.2);
        let sections = (0..mesh.cells.len())
            .map(|cell| Section {
                material: Material::new(1.0 + (cell % 5) as f64, 0.3).unwrap(),
                kind: [ElementKind::Hex8, ElementKind::Hex8Incompatible][cell % 2],
            })
            .collect();
        Body::new(mesh, sections).unwrap()
    }

    /// A block of `n` cells along each axis, its inner nodes moved by up to `noise` of a cell.
    pub fn block(n: [usize; 3], size: [f64; 3], noise: f64) -> HexMesh {
        let axis = |a: usize| {
            (0..=n[a])
                .map(|i| size[a] * i as f64 / n[a] as f64)
                .collect()
        };
        let grid = TensorGrid {
            x: axis(0),
            y: axis(1),
            z: axis(2),
        };
        let mut mesh = grid.hex_mesh();
        let mut seed = 7u64;
        for p in &mut mesh.points {
            let inner = (0..3).all(|a| p[a] > 0.0 && p[a] < size[a]);
            for a in 0..3 {
                seed = seed
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                let random = 2.0 * ((seed >> 33) as f64 / (1u64 << 31) as f64) - 1.0;
                if inner {
                    p[a] += noise * random * size[a] / n[a] as f64;
                }
            }
        }
        mesh
    }

    #[test]
    fn bad_meshes_are_refused_with_their_place() {
        let steel = Material::new(210e9, 0.3).unwrap();
        let good = block([2, 2, 2], [1.0; 3], 0.0);
        let refuse = |mesh: HexMesh| Body::uniform(mesh, steel, ElementKind::Hex8).unwrap_err();

        let mut mesh = good.clone();
        mesh.cells[3][5] = 99;
        assert_eq!(
            refuse(mesh),
            Error::NodeIndex {
                cell: 3,
                node: 99,
                node_count: 27
            }
        );
        let mut mesh = good.clone();
        mesh.cells[2].swap(0, 6);
        assert!(
            matches!(refuse(mesh), Error::InvertedCell { cell: 2, determinant } if determinant < 0.0)
        );
        let mut mesh = good.clone();
        mesh.points[13][1] = f64::NAN;
        assert!(matches!(refuse(mesh), Error::InvertedCell { cell: 0, .. }));
        let mut mesh = good;
        mesh.cells.clear();
        assert_eq!(refuse(mesh), Error::NoCells);
    }

    #[test]
    fn moduli_that_no_solid_has_are_refused_with_the_value() {
        for e in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = Material::new(e, 0.3).unwrap_err();
            assert!(error.to_string().contains(&format!("{e}")), "{error}");
        }
        for nu in [0.5, 0.7, -1.0, f64::NAN, f64::INFINITY] {
            let error = Material::new(1.0, nu).unwrap_err();
            assert!(matches!(error, Error::PoissonsRatio { .. }), "{error}");
        }
    }

    #[test]
    fn uniaxial_stress_gives_youngs_modulus_and_poissons_ratio() {
        let steel = Material::new(210e9, 0.3).unwrap();
        let stress = steel.stress([1e-3, -0.3e-3, -0.3e-3, 0.0, 0.0, 0.0]);
        assert!((stress[0] - 210e6).abs() < 1e-6);
        assert!(stress[1].abs() < 1e-6 && stress[2].abs() < 1e-6);
        assert!((steel.uniaxial_strain_modulus() - 2.826923e11).abs() < 1e6);
    }
}
