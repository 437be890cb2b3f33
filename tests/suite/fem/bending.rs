//! Bending of a slender steel: locking of the trilinear element, accuracy of incompatible modes.

use kufe_fem::{Body, Constraints, ElementKind, Material, nodal_stresses};
use kufe_tests::fem::closed_form::Beam;
use kufe_tests::fem::loads::add_traction;
use kufe_tests::fem::statics::{Solver, equilibrium};
use kufe_tests::meshes::{block, faces_where, nodes_where, shake};

/// A cantilever of the size of a luge steel: 0.6 m x 20 mm x 8 mm.
fn steel() -> Beam {
    Beam {
        length: 0.6,
        width: 0.020,
        height: 0.008,
        material: Material::new(210e9, 0.3).unwrap(),
    }
}

/// Tip deflection and mid-span bending stress over those of beam theory, for an end load in z and a
/// clamp at x = 0.
fn cantilever(cells: [usize; 3], kind: ElementKind, distortion: [f64; 3]) -> [f64; 2] {
    let (beam, load) = (steel(), 50.0);
    let size = [beam.length, beam.width, beam.height];
    let mut mesh = block(cells, size);
    shake(&mut mesh, cells, size, distortion);
    let mut constraints = Constraints::new(mesh.points.len());
    constraints
        .clamp(nodes_where(&mesh, |p| p[0] == 0.0))
        .unwrap();
    let end = faces_where(&mesh, |p| p[0] == beam.length);
    let body = Body::uniform(mesh, beam.material, kind).unwrap();
    let mut loads = vec![0.0; body.dofs()];
    let shear = load / (beam.width * beam.height);
    add_traction(body.mesh(), &end, |_| [0.0, 0.0, shear], &mut loads);
    let u = equilibrium(&body, &constraints, &loads, Solver::Cholesky)
        .unwrap()
        .displacement;
    let tip = nodes_where(body.mesh(), |p| p[0] == beam.length);
    let mean = tip.iter().map(|&node| u[3 * node + 2]).sum::<f64>() / tip.len() as f64;

    let stress = nodal_stresses(&body, &u);
    let middle = beam.length / 2.0;
    let bottom = nodes_where(body.mesh(), |p| {
        p[2] == 0.0 && (p[0] - middle).abs() < 0.1 * beam.length
    });
    let ratio = |&node: &usize| {
        let arm = beam.length - body.mesh().points[node][0];
        stress[node][0] / (6.0 * load * arm / (beam.width * beam.height.powi(2)))
    };
    let ratio = bottom.iter().map(ratio).sum::<f64>() / bottom.len() as f64;
    [mean / beam.cantilever_tip_deflection(load), ratio]
}

/// The error of beam theory is about (h/L) nu^2, because the clamp also fixes the width and height of
/// the section.
#[test]
fn incompatible_modes_give_the_cantilever_of_beam_theory_within_one_percent() {
    let [tip, stress] = cantilever([40, 2, 1], ElementKind::Hex8Incompatible, [0.0; 3]);
    println!("one cell over the height: tip {tip:.4}, stress {stress:.4}");
    assert!((tip - 1.0).abs() < 0.01, "{tip}");
    assert!((stress - 1.0).abs() < 0.01, "{stress}");
    let [tip, stress] = cantilever([60, 3, 3], ElementKind::Hex8Incompatible, [0.0, 0.0, 0.1]);
    println!("upright columns, heights shaken by 0.1 cells: tip {tip:.4}, stress {stress:.4}");
    assert!((tip - 1.0).abs() < 0.01, "{tip}");
    assert!((stress - 1.0).abs() < 0.05, "{stress}");
}

/// Trapezoidal cells stiffen every element with eight nodes (R. H. MacNeal, Finite Elem. Anal. Des.
/// 3 (1987), 175-181). A runner's mesh has upright columns and therefore no such cells.
#[test]
fn refinement_halves_the_excess_stiffness_of_tilted_columns() {
    let tilted = [0.1, 0.1, 0.1];
    let [coarse, _] = cantilever([60, 2, 2], ElementKind::Hex8Incompatible, tilted);
    let [fine, _] = cantilever([160, 4, 4], ElementKind::Hex8Incompatible, tilted);
    let [plain, _] = cantilever([60, 2, 2], ElementKind::Hex8, tilted);
    println!("tilted columns: tip {coarse:.3} coarse, {fine:.3} fine; plain {plain:.3} coarse");
    assert!(plain < coarse && coarse < fine, "{plain} {coarse} {fine}");
    assert!(1.0 - fine < 0.5 * (1.0 - coarse), "{coarse} {fine}");
}

/// The axial element has a constant shear strain along the beam. The remaining error is that of the
/// strains across the beam. It is inversely proportional to the square of the number of cells over
/// the height and the width.
#[test]
fn the_axial_element_gives_the_cantilever_of_beam_theory_within_two_percent() {
    let [coarse, _] = cantilever([40, 2, 1], ElementKind::Hex8Axial, [0.0; 3]);
    let [tip, stress] = cantilever([40, 8, 6], ElementKind::Hex8Axial, [0.0; 3]);
    println!(
        "axial: tip {coarse:.4} with one cell over the height, {tip:.4} and stress {stress:.4} with six and eight across"
    );
    assert!((tip - 1.0).abs() < 0.02, "{tip}");
    assert!((stress - 1.0).abs() < 0.03, "{stress}");
    assert!((0.7..1.0).contains(&coarse), "{coarse}");
    // Columns of different height, as over a rounded underside.
    let [shaken, _] = cantilever([60, 8, 6], ElementKind::Hex8Axial, [0.0, 0.1, 0.1]);
    println!("axial: tip {shaken:.4} with heights and widths shaken by 0.1 cells");
    assert!((shaken - 1.0).abs() < 0.03, "{shaken}");
    let [plain, _] = cantilever([40, 8, 6], ElementKind::Hex8, [0.0; 3]);
    assert!(plain < 0.5, "{plain}");
}

/// Cells 15 mm long and 8 mm high store a parasitic shear of about (l/h)^2 (1 - nu) / 2 times the
/// bending energy.
#[test]
fn plain_hexahedra_lock_on_thin_steel() {
    let [coarse, _] = cantilever([40, 2, 1], ElementKind::Hex8, [0.0; 3]);
    let [fine, _] = cantilever([160, 2, 4], ElementKind::Hex8, [0.0; 3]);
    println!(
        "plain hexahedra: {coarse:.3} of the deflection with 40 cells, {fine:.3} with 160 x 4"
    );
    assert!(coarse < 0.5, "{coarse}");
    assert!(fine > coarse && fine < 0.97, "{fine}");
}
