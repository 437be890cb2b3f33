//! `field.vtu`, `runner.vtu` and `contact.vtp`: fields of ice, runner and contact for ParaView.

use std::io::Write;

use kufe_contact::{Bed, ElasticRunner, RunnerField, Solution, SurfaceField, VolumeField};
use kufe_fem::{
    Body, ElementKind, Material, Section, grid_stresses, maximum_shear, nodal_stresses, von_mises,
};
use kufe_mesh::{HexMesh, VtuField, write_vtp, write_vtu};

use crate::jobs::failure::{Failure, Located};

/// The ice, with `contact_pressure_pa` (0 below the contact plane), `gap_m` (NaN there) and, where
/// there is one, the plastic depth of its surface (0 below it). Where the solver used mirror planes
/// the file holds the part that it solved, as the field data state by `mirrored_at_x_y`: 1 where x
/// = 0, and where y = 0, is such a plane. Returns the largest compressive stress across the surface
/// [Pa], which may be more than the largest contact pressure: stresses are continued to the nodes
/// from within the cells.
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
    let mut extra = vec![("contact_pressure_pa", &pressure[..]), ("gap_m", &gap[..])];
    extra.extend(depth.iter().map(|depth| ("plastic_depth_m", &depth[..])));
    let mirrored = solution.symmetry;
    let moved = &volume.displacement;
    write(writer, (&mesh, mirrored), moved, &stresses, &extra, shear)?;
    Ok(stresses.iter().map(|stress| -stress[2]).fold(0.0, f64::max))
}

/// Stresses at the nodes [Pa]: computed on the grid for plain eight-node cells, else on the mesh.
fn ice_stresses(volume: &VolumeField, mesh: &HexMesh) -> Result<Vec<[f64; 6]>, Failure> {
    let ice = material(volume.youngs_modulus, volume.poissons_ratio)?;
    let of_bed = |(bed, layers): (Bed, usize)| {
        Ok::<_, Failure>((layers, material(bed.youngs_modulus, bed.poissons_ratio)?))
    };
    let below = volume.bed.map(of_bed).transpose()?;
    let moved = &volume.displacement;
    if volume.element == ElementKind::Hex8 {
        return Ok(grid_stresses(&volume.grid, ice, below, moved));
    }
    let [nx, ny, _] = volume.grid.shape();
    let (layers, bed) = below.unwrap_or((0, ice));
    let in_bed = layers * (nx - 1) * (ny - 1);
    let section = |cell: usize| Section {
        material: if cell < in_bed { bed } else { ice },
        kind: volume.element,
    };
    let sections = (0..mesh.cells.len()).map(section).collect();
    stresses(mesh, sections, moved)
}

/// Extends a field of the surface to all nodes of the solved part, which has the last columns and
/// rows of the surface. Nodes below the surface get the value `below`.
fn at_nodes(volume: &VolumeField, surface: &SurfaceField, field: &[f64], below: f64) -> Vec<f64> {
    let [nx, ny, nz] = volume.grid.shape();
    let (all, rows) = (surface.x.len(), surface.y.len());
    let mut values = vec![below; nx * ny * (nz - 1)];
    for row in field.chunks_exact(all).skip(rows - ny) {
        values.extend_from_slice(&row[all - nx..]);
    }
    values
}

/// Writes the solved part of the runner as [`write_ice`]: undeformed, at first contact, with its
/// displacement relative to its mount.
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
    Material::new(youngs_modulus, poissons_ratio).bad_input()
}

fn stresses(
    mesh: &HexMesh,
    sections: Vec<Section>,
    displacement: &[[f64; 3]],
) -> Result<Vec<[f64; 6]>, Failure> {
    let body = Body::new(mesh.clone(), sections).bad_input()?;
    Ok(nodal_stresses(&body, displacement.as_flattened()))
}

/// Writes displacement [m], stress tensor, von Mises stress and, with `shear`, maximum shear stress
/// [Pa] at the nodes, and the further scalar fields `extra`.
///
/// Stresses are extrapolated from the Gauss points to the corners and averaged over the cells of a
/// node.
fn write(
    writer: &mut dyn Write,
    (mesh, mirrored): (&HexMesh, [bool; 2]),
    displacement: &[[f64; 3]],
    stresses: &[[f64; 6]],
    extra: &[(&str, &[f64])],
    shear: bool,
) -> Result<(), Failure> {
    let scalars = |scalar: fn([f64; 6]) -> f64| -> Vec<f64> {
        stresses.iter().map(|&stress| scalar(stress)).collect()
    };
    let (mises, largest) = (scalars(von_mises), shear.then(|| scalars(maximum_shear)));
    let tensor = |&[xx, yy, zz, yz, zx, xy]: &[f64; 6]| [xx, xy, zx, xy, yy, yz, zx, yz, zz];
    let tensors: Vec<f64> = stresses.iter().flat_map(tensor).collect();
    let mut fields = vec![
        field("displacement_m", 3, displacement.as_flattened()),
        field("stress_pa", 9, &tensors),
        field("von_mises_pa", 1, &mises),
    ];
    fields.extend(
        largest
            .as_ref()
            .map(|values| field("max_shear_pa", 1, values)),
    );
    fields.extend(extra.iter().map(|&(name, values)| field(name, 1, values)));
    let mirrored = mirrored.map(|used| f64::from(u8::from(used)));
    let planes = [("mirrored_at_x_y", &mirrored[..])];
    Ok(write_vtu(mesh, &fields, &[], &planes, writer)?)
}

/// Writes the whole patch, both sides of a mirror plane: the cells of the contact plane with a node
/// that touches, on the deformed ice, with `contact_pressure_pa`, `gap_m` (NaN where there is no
/// hull) and `uz_m` at the nodes. The pressure integrates to the load `fz` [N].
///
/// # Errors
/// [`Failure::BadInput`] with the message of the writer.
pub fn write_contact(
    writer: &mut dyn Write,
    surface: &SurfaceField,
    fz: f64,
) -> Result<(), Failure> {
    let (nx, ny) = (surface.x.len(), surface.y.len());
    let mut number = vec![usize::MAX; nx * ny];
    let mut nodes = Vec::new();
    let mut cells = Vec::new();
    for j in 0..ny - 1 {
        for i in 0..nx - 1 {
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| j * nx + i);
            if corners.iter().all(|&n| surface.pressure[n] <= 0.0) {
                continue;
            }
            cells.push(corners.map(|n| {
                if number[n] == usize::MAX {
                    number[n] = nodes.len();
                    nodes.push(n);
                }
                number[n]
            }));
        }
    }
    let point = |&n: &usize| [surface.x[n % nx], surface.y[n / nx], surface.uz[n]];
    let points: Vec<[f64; 3]> = nodes.iter().map(point).collect();
    let at = |values: &[f64]| -> Vec<f64> { nodes.iter().map(|&n| values[n]).collect() };
    let (pressure, uz) = (at(&surface.balanced_pressure(fz)), at(&surface.uz));
    let gap: Vec<f64> = at(&surface.gap).into_iter().map(finite).collect();
    let fields = [
        field("contact_pressure_pa", 1, &pressure),
        field("gap_m", 1, &gap),
        field("uz_m", 1, &uz),
    ];
    Ok(write_vtp(&points, &cells, &fields, writer)?)
}

/// A gap, NaN where there is none.
fn finite(gap: f64) -> f64 {
    if gap.is_finite() { gap } else { f64::NAN }
}

fn field<'a>(name: &'a str, components: usize, values: &'a [f64]) -> VtuField<'a> {
    VtuField {
        name,
        components,
        values,
    }
}
