//! Equilibrium of one body: loads and prescribed displacements in, displacements and reactions out.

use crate::body::Body;
use crate::cg::{self, Jacobi};
use crate::constraints::Constraints;
use crate::element::hex8;
use crate::error::Error;
use crate::sparse::assembly::BlockMatrix;
use crate::sparse::assembly::assemble;
use crate::sparse::cholesky::Factor;

/// How to solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Solver {
    /// Sparse Cholesky, [`Factor`].
    #[default]
    Cholesky,
    /// Conjugate gradients with the diagonal as preconditioner.
    ConjugateGradients(cg::Options),
}

/// Displacements and the reactions that support them.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Displacements, three a node [m].
    pub displacement: Vec<f64>,
    /// Forces that the supports exert on the body, three a node [N]; zero where nothing is
    /// prescribed.
    pub reaction: Vec<f64>,
    /// History of conjugate gradients; empty for Cholesky.
    pub history: cg::History,
}

/// Adds the consistent nodal forces [N] of a body force given by position [N/m^3].
///
/// Fails where `loads` does not have three numbers a node.
pub fn add_body_force(
    body: &Body,
    force: impl Fn([f64; 3]) -> [f64; 3],
    loads: &mut [f64],
) -> Result<(), Error> {
    check_length("loads", loads.len(), body.dofs())?;
    for (cell, nodes) in body.mesh().cells.iter().enumerate() {
        let f = hex8::body_force(&body.corners(cell), &force);
        for (d, value) in f.iter().enumerate() {
            loads[3 * nodes[d / 3] + d % 3] += value;
        }
    }
    Ok(())
}

/// Solves K u = f with prescribed displacements.
///
/// The free rows hold: K_ff u_f = f_f - K_fp u_p; the reactions are the residual of the prescribed
/// rows: r_p = K_pf u_f + K_pp u_p - f_p. `loads` are nodal forces, three a node [N]. Fails where
/// lengths differ, the supports leave a mechanism, or conjugate gradients do not converge.
///
/// ```
/// use kufe_fem::{Body, Constraints, ElementKind, Material, Solver, equilibrium};
/// use kufe_mesh::TensorGrid;
/// let grid = TensorGrid { x: vec![0.0, 0.1], y: vec![0.0, 0.1], z: vec![0.0, 0.1] };
/// let body = Body::uniform(grid.hex_mesh(), Material::new(9.0e9, 0.0)?, ElementKind::Hex8)?;
/// let mut constraints = Constraints::new(8);
/// constraints.clamp(0..4)?;                                   // the bottom
/// let mut loads = vec![0.0; 24];
/// (4..8).for_each(|node| loads[3 * node + 2] = -250.0);       // 1 kN on the top
/// let state = equilibrium(&body, &constraints, &loads, Solver::Cholesky)?;
/// let pushed = -1000.0 * 0.1 / (9.0e9 * 0.01);                // F L / (E A)
/// assert!((state.displacement[3 * 4 + 2] / pushed - 1.0).abs() < 1e-12);
/// # Ok::<(), kufe_fem::Error>(())
/// ```
pub fn equilibrium(
    body: &Body,
    constraints: &Constraints,
    loads: &[f64],
    solver: Solver,
) -> Result<Equilibrium, Error> {
    let n = body.dofs();
    check_length("loads", loads.len(), n)?;
    let map = constraints.dof_map();
    check_length("displacements of the constraints", map.dofs(), n)?;
    let stiffness = assemble(body);
    let (displacement, history) = match solver {
        Solver::Cholesky => {
            let factor = Factor::of_body(&stiffness, &map, &body.mesh().points)?;
            let u = factor.displacement(&stiffness, constraints, &map, loads);
            (u, cg::History::default())
        }
        Solver::ConjugateGradients(options) => iterate(&stiffness, constraints, loads, &options)?,
    };
    let mut residual = vec![0.0; n];
    stiffness.apply(&displacement, &mut residual);
    let mut reaction = vec![0.0; n];
    for (dof, _) in constraints.iter() {
        reaction[dof] = residual[dof] - loads[dof];
    }
    Ok(Equilibrium {
        displacement,
        reaction,
        history,
    })
}

fn iterate(
    stiffness: &BlockMatrix,
    constraints: &Constraints,
    loads: &[f64],
    options: &cg::Options,
) -> Result<(Vec<f64>, cg::History), Error> {
    let n = stiffness.dofs();
    let (mut u, mut rhs) = (vec![0.0; n], vec![0.0; n]);
    constraints.write_values(&mut u);
    stiffness.apply(&u, &mut rhs);
    for (r, f) in rhs.iter_mut().zip(loads) {
        *r = f - *r;
    }
    constraints.write_zeros(&mut rhs);
    let mut diagonal = stiffness.diagonal();
    constraints.write_zeros(&mut diagonal);
    let jacobi = Jacobi::new(&diagonal);
    let mut correction = vec![0.0; n];
    let history = cg::solve(
        |v, out| {
            stiffness.apply(v, out);
            constraints.write_zeros(out);
        },
        |r, out| jacobi.apply(r, out),
        &rhs,
        &mut correction,
        &mut cg::Workspace::default(),
        options,
    )?;
    for (u, c) in u.iter_mut().zip(&correction) {
        *u += c;
    }
    Ok((u, history))
}

fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected {
        Ok(())
    } else {
        Err(Error::Length {
            what,
            found,
            expected,
        })
    }
}
