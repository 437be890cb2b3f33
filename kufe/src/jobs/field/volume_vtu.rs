//! `field.vtu` and `runner.vtu`: displacement and stress in ice and runner on their hexahedra.

use std::io::Write;

use crate::jobs::Failure;
use crate::jobs::field::contact_vtp::finite;
use kufe_contact::{ElasticRunner, RunnerField, Solution, SurfaceField, VolumeField};
use kufe_fem::{
    Body, ElementKind, Material, Section, grid_stresses, maximum_shear, nodal_stresses, von_mises,
};
use kufe_mesh::{HexMesh, VtuField, write_vtu};

/// The ice, with `contact_pressure_pa` (0 below the contact plane), `gap_m` (NaN there) and, where there is one, the plastic depth of its surface
/// (0 below it). Where the solver used mirror planes the file holds the part that it solved, and says so in the field data `mirrored_at_x_y`:
/// 1 where x = 0, and where y = 0, is such a plane. Returns the largest compressive stress across the surface [Pa], which may be more than the
/// largest contact pressure: stresses are continued to the nodes from within the cells.
///
/// # Errors
/// [`Failure::BadInput`] with the writer's words.
pub fn write_ice(
    writer: &mut dyn Write,
    (volume, solution): (&VolumeField, &Solution),
    plastic_depth: Option<&[f64]>,
    shear: bool,
) -> Result<f64, Failure> {
    let surface = &solution.surface;
    let mesh = volume.grid.hex_mesh();
    let stresses = ice_stresses(volume, &mesh)?;
    let at_nodes = |values: &[f64], below: f64| at_nodes(volume, surface, values, below);
    let pressure = at_nodes(&surface.pressure, 0.0);
    let gap: Vec<f64> = surface.gap.iter().copied().map(finite).collect();
    let gap = at_nodes(&gap, f64::NAN);
    let depth = plastic_depth.map(|depth| at_nodes(depth, 0.0));
    let mut own = vec![("contact_pressure_pa", &pressure[..]), ("gap_m", &gap[..])];
    own.extend(depth.iter().map(|depth| ("plastic_depth_m", &depth[..])));
    let mirrored = solution.symmetry;
    let moved = &volume.displacement;
    write(writer, (&mesh, mirrored), moved, &stresses, &own, shear)?;
    Ok(stresses.iter().map(|stress| -stress[2]).fold(0.0, f64::max))
}

/// Stresses [Pa] at the nodes: from the grid, or where its cells are no plain ones from the mesh.
fn ice_stresses(volume: &VolumeField, mesh: &HexMesh) -> Result<Vec<[f64; 6]>, Failure> {
    let ice = material(volume.youngs_modulus, volume.poissons_ratio)?;
    let below = match volume.bed {
        Some((bed, layers)) => Some((layers, material(bed.youngs_modulus, bed.poissons_ratio)?)),
        None => None,
    };
    if volume.element == ElementKind::Hex8 {
        return Ok(grid_stresses(
            &volume.grid,
            ice,
            below,
            &volume.displacement,
        ));
    }
    let [nx, ny, _] = volume.grid.shape();
    let (layers, bed) = below.unwrap_or((0, ice));
    let section = |cell: usize| Section {
        material: if cell < layers * (nx - 1) * (ny - 1) {
            bed
        } else {
            ice
        },
        kind: volume.element,
    };
    let sections = (0..mesh.cells.len()).map(section).collect();
    stresses(mesh, sections, &volume.displacement)
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
    let section = Section {
        material: material(elastic.youngs_modulus, elastic.poissons_ratio)?,
        kind: elastic.element_kind(),
    };
    let (mesh, moved) = (&field.mesh, &field.displacement);
    let stresses = stresses(mesh, vec![section; mesh.cells.len()], moved)?;
    write(writer, (mesh, mirrored), moved, &stresses, &[], shear)
}

fn material(youngs_modulus: f64, poissons_ratio: f64) -> Result<Material, Failure> {
    Material::new(youngs_modulus, poissons_ratio).map_err(Failure::bad_input)
}

fn stresses(
    mesh: &HexMesh,
    sections: Vec<Section>,
    displacement: &[[f64; 3]],
) -> Result<Vec<[f64; 6]>, Failure> {
    let body = Body::new(mesh.clone(), sections).map_err(Failure::bad_input)?;
    Ok(nodal_stresses(&body, displacement.as_flattened()))
}

/// Displacement [m], stress tensor, von Mises stress and, with `shear`, maximum shear stress [Pa] at the nodes, and fields of a body's own.
///
/// Stresses are those of the Gauss points continued to the corners and averaged over the cells of a node.
fn write(
    writer: &mut dyn Write,
    (mesh, mirrored): (&HexMesh, [bool; 2]),
    displacement: &[[f64; 3]],
    stresses: &[[f64; 6]],
    own: &[(&str, &[f64])],
    shear: bool,
) -> Result<(), Failure> {
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
        field("displacement_m", 3, displacement.as_flattened()),
        field("stress_pa", 9, &tensors),
        field("von_mises_pa", 1, &mises),
    ];
    if let Some(largest) = &largest {
        fields.push(field("max_shear_pa", 1, largest));
    }
    fields.extend(own.iter().map(|&(name, values)| field(name, 1, values)));
    let mirrored = mirrored.map(|used| f64::from(u8::from(used)));
    let planes = [("mirrored_at_x_y", &mirrored[..])];
    write_vtu(mesh, &fields, &[], &planes, writer).map_err(Failure::bad_input)
}
