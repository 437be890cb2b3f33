//! The hexahedra of a body on a tensor grid, as they are assembled.

use kufe_fem::{Body, Error, Material, Section, TensorOperator};
use kufe_mesh::TensorGrid;

/// The body that a tensor operator stands for; `material` is that of its cells, but of its lower layer's.
///
/// # Errors
/// Those of [`Body::new`] and [`Material::new`].
pub(crate) fn hexahedra(operator: &TensorOperator, material: Material) -> Result<Body, Error> {
    let [x, y, z] = operator.axes.each_ref().map(|axis| axis.nodes.clone());
    let mesh = TensorGrid { x, y, z }.hex_mesh();
    let of = |material| Section {
        material,
        kind: operator.element_kind(),
    };
    let mut sections = vec![of(material); mesh.cells.len()];
    if let Some(layer) = operator.lower_layer() {
        let (lambda, mu) = (layer.lambda, layer.mu);
        let youngs_modulus = mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
        let bed = Material::new(youngs_modulus, 0.5 * lambda / (lambda + mu))?;
        let [nx, ny, _] = operator.shape().map(|nodes| nodes - 1);
        sections[..nx * ny * layer.cells].fill(of(bed));
    }
    Body::new(mesh, sections)
}
