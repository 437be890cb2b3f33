//! `field.vtu` and `runner.vtu`: displacement and stress in ice and runner on their hexahedra.

use std::io::Write;

use kufe_contact::{ElasticRunner, RunnerField, VolumeField};
use kufe_fem::{Body, ElementKind, Material, nodal_stresses, von_mises};
use kufe_mesh::{HexMesh, VtuField, write_vtu};

use crate::failure::Failure;

/// The ice. Where the solver used mirror planes the file holds the part that it solved.
///
/// # Errors
/// [`Failure::BadInput`] with the writer's words.
pub fn write_ice(writer: impl Write, volume: &VolumeField) -> Result<(), Failure> {
    let elasticity = [volume.youngs_modulus, volume.poissons_ratio];
    write(
        writer,
        volume.grid.hex_mesh(),
        &volume.displacement,
        elasticity,
    )
}

/// The runner, undeformed where it first touches, its displacement against its mount; the part that was solved.
///
/// # Errors
/// As [`write_ice`].
pub fn write_runner(
    writer: impl Write,
    field: &RunnerField,
    elastic: &ElasticRunner,
) -> Result<(), Failure> {
    let elasticity = [elastic.youngs_modulus, elastic.poissons_ratio];
    write(writer, field.mesh.clone(), &field.displacement, elasticity)
}

/// Displacement [m], stress tensor and von Mises stress [Pa] at the nodes.
///
/// Stresses are those of the Gauss points continued to the corners and averaged over the cells of a node.
fn write(
    writer: impl Write,
    mesh: HexMesh,
    displacement: &[[f64; 3]],
    [youngs_modulus, poissons_ratio]: [f64; 2],
) -> Result<(), Failure> {
    let material = Material::new(youngs_modulus, poissons_ratio).map_err(Failure::bad_input)?;
    let body = Body::uniform(mesh, material, ElementKind::Hex8).map_err(Failure::bad_input)?;
    let displacement: Vec<f64> = displacement.iter().flatten().copied().collect();
    let stresses = nodal_stresses(&body, &displacement);
    let mises: Vec<f64> = stresses.iter().map(|&stress| von_mises(stress)).collect();
    let tensors: Vec<f64> = stresses
        .iter()
        .flat_map(|&[xx, yy, zz, yz, zx, xy]| [xx, xy, zx, xy, yy, yz, zx, yz, zz])
        .collect();
    let field = |name, components, values| VtuField {
        name,
        components,
        values,
    };
    let fields = [
        field("displacement_m", 3, &displacement),
        field("stress_pa", 9, &tensors),
        field("von_mises_pa", 1, &mises),
    ];
    write_vtu(body.mesh(), &fields, &[], writer).map_err(Failure::bad_input)
}
