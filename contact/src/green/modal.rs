//! Green's matrices that are not stored: products through the modes of the contact plane.

use std::cell::RefCell;

use faer::{Mat, MatRef};
use kufe_fem::Tridiagonal;

use crate::bodies::elastic_body::{BodyWork, ElasticBody, Inverse, Stiffness};
use crate::green::matrix::{CandidateRectangle, SeparableOperator, sweep_lines};

/// G = B M^-1 B^T of all bodies, applied without storing it.
///
/// For a body that is constrained only on faces of its grid, G is diagonal in the modes of x and y
/// of the contact plane, G f = Qx (T o (Qx^T F Qy)) Qy^T: four products of matrices as wide as the
/// plane. For the other bodies the preconditioner M^-1 is applied. G^-1 is approximated by the
/// operator with 1/T and the dual modes M Q, since Q^-1 = Q^T M on free nodes; for the ice alone it
/// preconditions conjugate gradients on a subset of the nodes.
pub(crate) struct ModalGreen<'a> {
    pub window: CandidateRectangle,
    /// G of the bodies that are constrained only on faces.
    pub forms: Vec<SeparableOperator>,
    /// G^-1 of the ice over the whole plane, on the rectangle.
    pub stiffness: SeparableOperator,
    /// Diagonal of the sum of the forms, by candidate.
    pub diagonal: Vec<f64>,
    candidates: &'a [usize],
    /// Length of a plane vector.
    plane: usize,
    others: Vec<(&'a ElasticBody, RefCell<BodyWork>)>,
}

impl<'a> ModalGreen<'a> {
    /// G between `candidates` of a plane of `plane` nodes. With `scaled`, the responses of bodies
    /// that are constrained only on faces are those of elasticity, not of their preconditioner.
    /// `None` if the first body is constrained otherwise than on faces.
    pub fn new(
        bodies: &'a [ElasticBody],
        candidates: &'a [usize],
        plane: usize,
        scaled: bool,
    ) -> Option<Self> {
        let Inverse::Planewise(first) = &bodies.first()?.inverse else {
            return None;
        };
        let window = CandidateRectangle::new(candidates, first.columns.plane_width);
        let mut forms = Vec::new();
        let mut others = Vec::new();
        for body in bodies {
            let Inverse::Planewise(inverse) = &body.inverse else {
                others.push((body, RefCell::new(body.work())));
                continue;
            };
            let factor = if scaled { inverse.response } else { 1.0 };
            let rows = [0, 1].map(|axis| {
                let range = &window.along[axis];
                let start = range.start - inverse.columns.first[axis];
                let modes = inverse.basis.along(axis);
                modes.subrows(start, range.len()).to_owned()
            });
            let table = faer::Scale(factor) * inverse.preconditioner.end_response();
            forms.push(form(&window, rows, table));
        }
        let Stiffness::Tensor(operator) = &bodies[0].stiffness else {
            return None;
        };
        let rows = [0, 1].map(|axis| {
            let modes = first.basis.along(axis);
            dual(modes, &operator.axes[axis].mass, &window.along[axis])
        });
        let response = first.preconditioner.end_response();
        let [mx, my] = [response.nrows(), response.ncols()];
        let inverse = Mat::from_fn(mx, my, |a, b| response[(a, b)].recip());
        let stiffness = form(&window, rows, inverse);
        let mut diagonal = vec![0.0; candidates.len()];
        for form in &forms {
            let field = form.diagonal();
            for (number, diagonal) in diagonal.iter_mut().enumerate() {
                *diagonal += window.at(&field, number);
            }
        }
        Some(ModalGreen {
            window,
            forms,
            stiffness,
            diagonal,
            candidates,
            plane,
            others,
        })
    }

    /// G f.
    pub fn times(&self, force: &[f64]) -> Vec<f64> {
        let mut deflection = self.others_deflection(force);
        let field = self.window.scatter(force.iter().copied().enumerate());
        for form in &self.forms {
            let field = form.times(&field);
            for (number, deflection) in deflection.iter_mut().enumerate() {
                *deflection += self.window.at(&field, number);
            }
        }
        deflection
    }

    /// The part of G f of the bodies that are not in `forms`.
    pub fn others_deflection(&self, force: &[f64]) -> Vec<f64> {
        if self.others.is_empty() {
            return vec![0.0; force.len()];
        }
        let forces = self.candidates.iter().copied().zip(force.iter().copied());
        let forces: Vec<(usize, f64)> = forces.filter(|(_, f)| *f != 0.0).collect();
        let mut closing = vec![0.0; self.plane];
        for (body, work) in &self.others {
            body.respond(&forces, &mut closing, &mut work.borrow_mut());
        }
        self.candidates.iter().map(|&node| closing[node]).collect()
    }

    /// One pass of [`crate::green::matrix::Green::sweep`], line by line across the rectangle's
    /// longer side.
    ///
    /// The deflection of the bodies that are not in `forms` is that before the pass.
    pub fn sweep(
        &self,
        force: &mut [f64],
        deflection: &mut [f64],
        update: impl Fn(usize, f64, f64) -> f64,
    ) {
        let others = self.others_deflection(force);
        sweep_lines(&self.window, &self.forms, &others, force, update);
        deflection.copy_from_slice(&self.times(force));
    }
}

/// The operator of modes along x and y on the rectangle and their table, in its order of axes.
fn form(window: &CandidateRectangle, [x, y]: [Mat<f64>; 2], table: Mat<f64>) -> SeparableOperator {
    let (long, short, table) = match window.axes {
        [0, _] => (x, y, table),
        _ => (y, x, table.transpose().to_owned()),
    };
    SeparableOperator {
        long: long.transpose().to_owned(),
        short,
        table,
    }
}

/// Rows of M Q.
fn dual(modes: MatRef<'_, f64>, mass: &Tridiagonal, rows: &std::ops::Range<usize>) -> Mat<f64> {
    Mat::from_fn(rows.len(), modes.ncols(), |i, a| {
        let node = rows.start + i;
        let near = [node.wrapping_sub(1), node, node + 1];
        let values = mass[node].iter().zip(near);
        let inside = values.filter(|(_, k)| *k < modes.nrows());
        inside.map(|(m, k)| m * modes[(k, a)]).sum()
    })
}

#[cfg(test)]
mod tests {
    //! Claims on Green's matrices that are not stored: they are the stored ones, and contacts come
    //! out the same.

    use std::sync::Arc;

    use faer::Mat;
    use kufe_mesh::{BobRunner, HexMesh, Paraboloid, graded_levels, mapped_runner_mesh};

    use crate::accuracy::mesh_solve::tests::MeshProblem;
    use crate::green::matrix::{Green, StorageLimit};
    use crate::{
        ElasticRunner, Foundation, Ice, Load, LoadedPlace, Mount, Place, Problem, Runner,
        RunnerSolid, Tilt,
    };

    /// No matrix is stored.
    const NONE: StorageLimit = StorageLimit {
        faces: 0,
        mounted: 0,
    };

    type Failure = Box<dyn std::error::Error>;

    fn ice(thickness: f64, hardness: Option<f64>) -> Ice {
        Ice {
            foundation: Foundation::RigidBed { thickness },
            hardness,
            ..Ice::half_space(9e9, 0.33)
        }
    }

    fn paraboloid() -> Result<Runner, Failure> {
        Ok(Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005)?)))
    }

    fn bob(mount: Mount, solid: Option<HexMesh>) -> Result<Runner, Failure> {
        let top = 0.03;
        let fixed = |p: [f64; 3]| p[2] > top - 1e-9;
        let solid = solid
            .map(|mesh| RunnerSolid::new(mesh, 210e9, 0.3, fixed))
            .transpose()?;
        Ok(Runner {
            underside: Arc::new(BobRunner::default().swept()?),
            elastic: Some(ElasticRunner {
                mount,
                solid: solid.map(Arc::new),
                ..ElasticRunner::fixed_at_top(210e9, 0.3, top)
            }),
        })
    }

    /// Contacts of every kind of body, of hardness, and of motions that are free or fixed.
    fn contacts() -> Result<Vec<(&'static str, MeshProblem)>, Failure> {
        let central = Load::central(1000.0, Tilt::Free);
        let offset = Load::Force {
            fz: 1000.0,
            offset_x: 0.02,
            offset_y: 1e-5,
            tilt: Tilt::Free,
        };
        let fixed = Load::Approach {
            approach: 12e-6,
            pitch: 1e-4,
            roll: 1e-3,
        };
        let place = |x: f64| Place { x, length: 0.05 };
        let half = |x: f64| LoadedPlace {
            place: place(x),
            share: 0.5,
        };
        let swept = BobRunner::default().swept()?;
        let line = |half: f64, count: i32| -> Vec<f64> {
            let at = |i: i32| half * f64::from(i) / f64::from(count);
            (-count..=count).map(at).collect()
        };
        let levels = graded_levels(5, 1.0)?;
        let solid = mapped_runner_mesh(&line(0.4, 30), &line(0.0035, 6), &swept, 0.03, &levels)?;
        let unbounded = Runner {
            elastic: Some(ElasticRunner::fixed_at_top(9e9, 0.3, 0.0)),
            ..paraboloid()?
        };
        let cases = [
            ("rigid", paraboloid()?, ice(0.005, None), offset),
            ("fixed", paraboloid()?, Ice::half_space(9e9, 0.33), fixed),
            ("hard", paraboloid()?, ice(0.005, Some(60e6)), offset),
            ("unbounded", unbounded, Ice::half_space(9e9, 0.33), central),
            ("top", bob(Mount::Top, None)?, ice(0.02, None), central),
            (
                "places",
                bob(Mount::Places(vec![place(-0.3), place(0.3)]), None)?,
                ice(0.02, None),
                central,
            ),
            (
                "loads",
                bob(Mount::Loads(vec![half(-0.3), half(0.3)]), None)?,
                ice(0.02, None),
                central,
            ),
            (
                "solid",
                bob(Mount::Top, Some(solid))?,
                ice(0.02, None),
                central,
            ),
        ];
        cases
            .into_iter()
            .map(|(name, runner, ice, load)| {
                Ok((
                    name,
                    MeshProblem::new(Problem::new(runner, ice, load), 5.0)?,
                ))
            })
            .collect()
    }

    fn largest(values: &[f64]) -> f64 {
        values.iter().fold(0.0, |most, v| most.max(v.abs()))
    }

    /// Products and diagonals compared with the stored matrices, on bodies of every kind.
    #[test]
    fn products_are_those_of_the_stored_matrices() -> Result<(), Failure> {
        for (name, meshed) in contacts()? {
            let contact = &meshed.mesh.contact;
            let n = contact.candidates.len();
            let force: Vec<f64> = (0..n).map(|i| (1.0 + i as f64).sin().max(-0.2)).collect();
            let [stored, scaled] = contact.dense_greens();
            let greens = contact.greens(NONE);
            let stored = [stored, scaled];
            for (kind, (green, stored)) in greens.iter().zip(&stored).enumerate() {
                let Green::Modal(green) = green else {
                    return Err("a stored matrix above the limit".into());
                };
                let plane = green.others.is_empty();
                if !plane && kind == 1 {
                    continue;
                }
                let moved = green.times(&force);
                let expected = stored * Mat::from_fn(n, 1, |i, _| force[i]);
                let size = largest(&moved);
                for (i, moved) in moved.iter().enumerate() {
                    let off = (moved - expected[(i, 0)]).abs();
                    assert!(off < 1e-11 * size, "{name} {kind} {i}: {off:e} of {size:e}");
                    if plane {
                        let off = (green.diagonal[i] / stored[(i, i)] - 1.0).abs();
                        assert!(off < 1e-11, "{name} {kind} {i}: {off:e}");
                    }
                }
            }
        }
        Ok(())
    }

    /// A pass line by line is one node by node in the lines' order, on the stored matrix.
    #[test]
    fn passes_over_lines_are_passes_over_nodes() -> Result<(), Failure> {
        for (name, meshed) in contacts()? {
            let contact = &meshed.mesh.contact;
            let [_, stored] = contact.dense_greens();
            let [_, Green::Modal(green)] = contact.greens(NONE) else {
                return Err("a stored matrix above the limit".into());
            };
            if !green.others.is_empty() {
                continue;
            }
            let gap = contact.unpressed_gap();
            let motion = 1.5 * meshed.patch.motion;
            let update = |i: usize, force: f64, deflection: f64| {
                (force - 1.4 * (gap[i] - motion + deflection) / stored[(i, i)]).max(0.0)
            };
            let n = gap.len();
            let (mut force, mut deflection) = (vec![0.0; n], vec![0.0; n]);
            let mut expected = vec![0.0; n];
            for _ in 0..3 {
                green.sweep(&mut force, &mut deflection, update);
                for &[_, i] in green.window.lines.iter().flatten() {
                    let moved: f64 = (0..n).map(|j| stored[(i, j)] * expected[j]).sum();
                    expected[i] = update(i, expected[i], moved);
                }
            }
            let size = largest(&expected);
            assert!(size > 0.0, "{name}: nothing was pressed");
            for (a, b) in force.iter().zip(&expected) {
                assert!((a - b).abs() < 1e-10 * size, "{name}: {a} {b}");
            }
        }
        Ok(())
    }

    /// Whole solves on one mesh, by the stored matrix and its factors and by inner iterations.
    #[test]
    fn contacts_are_the_same_without_a_stored_matrix() -> Result<(), Failure> {
        for (name, meshed) in contacts()? {
            let (expected, straight) = meshed.solve(StorageLimit::USUAL)?;
            let (found, inner) = meshed.solve(NONE)?;
            let [straight, iterations] = [straight, inner].map(|progress| progress.iterations);
            let size = largest(&expected.force);
            for (a, b) in found.force.iter().zip(&expected.force) {
                assert!((a - b).abs() < 1e-8 * size, "{name}: {a} {b} of {size}");
            }
            let depth = meshed.mesh.contact.depth(&expected);
            for a in 0..3 {
                let row = meshed.mesh.contact.rows.iter().map(|r| r[a]);
                let reach = row.fold(0.0f64, |most, r| most.max(r.abs()));
                let off = (found.motion[a] - expected.motion[a]).abs() * reach;
                assert!(off < 1e-6 * depth, "{name} {a}: {off:e} of {depth:e}");
            }
            println!("{name}: {straight} iterations, {iterations} without a stored matrix");
            assert!(
                iterations <= 2 * straight + 20,
                "{name}: {iterations} {straight}"
            );
        }
        Ok(())
    }
}
