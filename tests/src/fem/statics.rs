//! Static equilibrium of one body: displacements and reactions from loads and prescribed
//! displacements.

use kufe_fem::{BlockMatrix, Body, Constraints, Error, Factor, assemble};

use crate::fem::cg::{self, Jacobi};

/// Linear solver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Solver {
    /// Sparse Cholesky, [`Factor`].
    #[default]
    Cholesky,
    /// Conjugate gradients with the Jacobi preconditioner.
    ConjugateGradients(cg::Options),
}

/// Displacements and reactions.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Displacements, three a node [m].
    pub displacement: Vec<f64>,
    /// Forces of the supports on the body, three a node [N]; zero at free degrees of freedom.
    pub reaction: Vec<f64>,
    /// History of conjugate gradients; empty for Cholesky.
    pub history: cg::History,
}

/// Solves K u = f with prescribed displacements.
///
/// The free rows are K_ff u_f = f_f - K_fp u_p. The reactions are the residual of the prescribed
/// rows, r_p = K_pf u_f + K_pp u_p - f_p. `loads` are nodal forces, three a node [N]. Returns an
/// error if the supports allow a rigid motion.
///
/// # Panics
/// If lengths differ or conjugate gradients do not converge.
pub fn equilibrium(
    body: &Body,
    constraints: &Constraints,
    loads: &[f64],
    solver: Solver,
) -> Result<Equilibrium, Error> {
    let n = body.dofs();
    let map = constraints.dof_map();
    assert_eq!([loads.len(), map.dofs()], [n, n]);
    let stiffness = assemble(body);
    let (displacement, history) = match solver {
        Solver::Cholesky => {
            let factor = Factor::of_body(&stiffness, &map, &body.mesh().points)?;
            let u = factor.displacement(&stiffness, constraints, &map, loads);
            (u, cg::History::default())
        }
        Solver::ConjugateGradients(options) => iterate(&stiffness, constraints, loads, &options),
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
) -> (Vec<f64>, cg::History) {
    let n = stiffness.dofs();
    let (mut u, mut rhs) = (vec![0.0; n], vec![0.0; n]);
    constraints.write_values(&mut u);
    stiffness.apply(&u, &mut rhs);
    for (r, f) in rhs.iter_mut().zip(loads) {
        *r = f - *r;
    }
    write_zeros(constraints, &mut rhs);
    let mut diagonal = stiffness.diagonal();
    write_zeros(constraints, &mut diagonal);
    let jacobi = Jacobi::new(&diagonal);
    let mut correction = vec![0.0; n];
    let history = cg::solve(
        |v, out| {
            stiffness.apply(v, out);
            write_zeros(constraints, out);
        },
        |r, out| jacobi.apply(r, out),
        &rhs,
        &mut correction,
        &mut cg::Workspace::default(),
        options,
    )
    .unwrap();
    for (u, c) in u.iter_mut().zip(&correction) {
        *u += c;
    }
    (u, history)
}

fn write_zeros(constraints: &Constraints, u: &mut [f64]) {
    for (dof, _) in constraints.iter() {
        u[dof] = 0.0;
    }
}
