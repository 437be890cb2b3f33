//! `field.vtu` and `runner.vtu`: displacement and stress in ice and runner on their hexahedra.

use std::io::Write;

use crate::Failure;
use crate::field::contact_vtp::finite;
use kufe_contact::{ElasticRunner, RunnerField, Solution, SurfaceField, VolumeField};
use kufe_fem::{Body, ElementKind, Material, Section, maximum_shear, nodal_stresses, von_mises};
use kufe_mesh::{HexMesh, VtuField, write_vtu};

/// The ice, with `contact_pressure_pa` (0 below the contact plane), `gap_m` (NaN there) and, where there is one, the plastic depth of its surface
/// (0 below it). Where the solver used mirror planes the file holds the part that it solved, and says so in the field data `mirrored_at_x_y`:
/// 1 where x = 0, and where y = 0, is such a plane.
///
/// # Errors
/// [`Failure::BadInput`] with the writer's words.
pub fn write_ice(
    writer: &mut dyn Write,
    solution: &Solution,
    plastic_depth: Option<&[f64]>,
    shear: bool,
) -> Result<(), Failure> {
    let (volume, surface) = (&solution.volume, &solution.surface);
    let mesh = volume.grid.hex_mesh();
    let mut sections = sections(
        [volume.youngs_modulus, volume.poissons_ratio],
        volume.element,
        mesh.cells.len(),
    )?;
    if let Some((bed, layers)) = volume.bed {
        let [nx, ny, _] = volume.grid.shape();
        let cells = layers * (nx - 1) * (ny - 1);
        let own = self::sections(
            [bed.youngs_modulus, bed.poissons_ratio],
            volume.element,
            cells,
        )?;
        sections[..cells].copy_from_slice(&own);
    }
    let at_nodes = |values: &[f64], below: f64| at_nodes(volume, surface, values, below);
    let pressure = at_nodes(&surface.pressure, 0.0);
    let gap: Vec<f64> = surface.gap.iter().copied().map(finite).collect();
    let gap = at_nodes(&gap, f64::NAN);
    let depth = plastic_depth.map(|depth| at_nodes(depth, 0.0));
    let mut own = vec![("contact_pressure_pa", &pressure[..]), ("gap_m", &gap[..])];
    own.extend(depth.iter().map(|depth| ("plastic_depth_m", &depth[..])));
    let mirrored = solution.symmetry;
    let moved = &volume.displacement;
    write(writer, (mesh, mirrored), moved, sections, &own, shear)
}

/// A field on the whole surface at all nodes of the part that was solved, which has the surface's last columns and rows; `below` the surface.
fn at_nodes(volume: &VolumeField, surface: &SurfaceField, field: &[f64], below: f64) -> Vec<f64> {
    let [nx, ny, nz] = volume.grid.shape();
    let (all, rows) = (surface.x.len(), surface.y.len());
    let mut values = vec![below; nx * ny * (nz - 1)];
    for row in field.chunks_exact(all).skip(rows - ny) {
        values.extend_from_slice(&row[all - nx..]);
    }
    values
}

/// The runner, undeformed where it first touches, its displacement against its mount; the part that was solved, as in
/// [`write_ice`].
///
/// # Errors
/// As [`write_ice`].
pub fn write_runner(
    writer: &mut dyn Write,
    field: &RunnerField,
    elastic: &ElasticRunner,
    mirrored: [bool; 2],
    shear: bool,
) -> Result<(), Failure> {
    let sections = sections(
        [elastic.youngs_modulus, elastic.poissons_ratio],
        elastic.element_kind(),
        field.mesh.cells.len(),
    )?;
    write(
        writer,
        (field.mesh.clone(), mirrored),
        &field.displacement,
        sections,
        &[],
        shear,
    )
}

fn sections(
    [youngs_modulus, poissons_ratio]: [f64; 2],
    kind: ElementKind,
    cells: usize,
) -> Result<Vec<Section>, Failure> {
    let material = Material::new(youngs_modulus, poissons_ratio).map_err(Failure::bad_input)?;
    Ok(vec![Section { material, kind }; cells])
}

/// Displacement [m], stress tensor, von Mises stress and, with `shear`, maximum shear stress [Pa] at the nodes, and fields of a body's own.
///
/// Stresses are those of the Gauss points continued to the corners and averaged over the cells of a node.
fn write(
    writer: &mut dyn Write,
    (mesh, mirrored): (HexMesh, [bool; 2]),
    displacement: &[[f64; 3]],
    sections: Vec<Section>,
    own: &[(&str, &[f64])],
    shear: bool,
) -> Result<(), Failure> {
    let body = Body::new(mesh, sections).map_err(Failure::bad_input)?;
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
    let largest: Option<Vec<f64>> = shear.then(|| {
        let each = stresses.iter().map(|&stress| maximum_shear(stress));
        each.collect()
    });
    let mut fields = vec![
        field("displacement_m", 3, &displacement),
        field("stress_pa", 9, &tensors),
        field("von_mises_pa", 1, &mises),
    ];
    if let Some(largest) = &largest {
        fields.push(field("max_shear_pa", 1, largest));
    }
    fields.extend(own.iter().map(|&(name, values)| field(name, 1, values)));
    let mirrored = mirrored.map(|used| f64::from(u8::from(used)));
    let planes = [("mirrored_at_x_y", &mirrored[..])];
    write_vtu(body.mesh(), &fields, &[], &planes, writer).map_err(Failure::bad_input)
}
