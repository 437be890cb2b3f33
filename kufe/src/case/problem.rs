//! Conversion of a case into a contact problem.

use std::fmt::Display;
use std::path::Path;
use std::sync::Arc;

use kufe_contact::{ElasticRunner, Problem, Runner, RunnerSolid};
use kufe_files::read_regular;
use kufe_mesh::{
    FittedUnderside, Hull, Paraboloid, Rocker, Section, Swept, Underside, check_hull, read_gmsh,
    read_vtu, size_warnings,
};

use crate::case::fitted_hull::{FittedHull, fit_hull};
use crate::case::range::combination;
use crate::case::{Case, CaseError, SectionTable, Shape};

/// Largest size of a mesh file [bytes].
const MAX_BYTES: u64 = 1 << 31;
/// Largest slope of the solid under a runner that is flat across, such as a luge steel.
const MAX_FLANK_SLOPE: f64 = 0.15;
/// Volume fraction that a solid with this slope may add to a hull that counts as flat across. The
/// default luge steel gains 0.0009, a bobsled runner 0.045.
const MAX_GAIN: f64 = 0.01;

impl Case {
    /// The contact problem of the case; paths are relative to `base`, the case's folder.
    ///
    /// # Errors
    /// [`CaseError`] where the case is out of range or the hull cannot be obtained.
    pub fn problem(&self, base: &Path) -> Result<Problem, CaseError> {
        Ok(self.stated(base, None)?.0)
    }

    /// As [`problem`](Self::problem), with the fitted hull, so that its warnings and its fit can be
    /// reported; `hull` as in [`runner`](Self::runner).
    ///
    /// # Errors
    /// As [`problem`](Self::problem).
    pub fn stated(
        &self,
        base: &Path,
        hull: Option<&Hull>,
    ) -> Result<(Problem, Option<FittedHull>), CaseError> {
        let (runner, hull) = self.runner(base, hull)?;
        let problem = self.problem_of(runner, base)?;
        Ok((problem, hull))
    }

    /// The runner, and its fitted hull where the case names one; paths are relative to `base`.
    ///
    /// `hull` [m] replaces the file that `runner.hull` names; no file is read then.
    ///
    /// # Errors
    /// As [`problem`](Self::problem).
    pub fn runner(
        &self,
        base: &Path,
        hull: Option<&Hull>,
    ) -> Result<(Runner, Option<FittedHull>), CaseError> {
        self.check()?;
        let table = &self.runner;
        let (underside, hull, elastic): (Arc<dyn Underside>, _, _) =
            match (&table.mesh, &table.shape, &table.hull) {
                (Some(path), ..) => {
                    let (hull, elastic) = self.meshed(&base.join(path))?;
                    (hull.underside.clone(), Some(hull), Some(elastic))
                }
                (None, Some(shape), _) => {
                    let section = table.section.clone().unwrap_or_default();
                    let (top, flat) = match *shape {
                        Shape::Bob { height_m, .. } => (height_m, false),
                        Shape::Luge { height_m, .. } => (height_m, true),
                        Shape::Paraboloid { .. } => (f64::INFINITY, false),
                    };
                    let elastic = table.elastic.then(|| self.elastic_runner(top, flat));
                    let underside = shape_underside(shape, &section, base)?;
                    (underside, None, elastic.transpose()?)
                }
                (None, None, Some(path)) => {
                    let fitted = fit_hull(table, &base.join(path), hull);
                    let (hull, filled) = fitted.map_err(CaseError::in_file("runner.hull"))?;
                    let elastic = filled.map(|filled| {
                        self.elastic_runner(filled.top, filled.gain(MAX_FLANK_SLOPE) < MAX_GAIN)
                    });
                    (hull.underside.clone(), Some(hull), elastic.transpose()?)
                }
                (None, None, None) => {
                    return Err(combination("runner", "expected a hull, a shape or a mesh"));
                }
            };
        Ok((Runner { underside, elastic }, hull))
    }

    /// The contact problem of the case with a given runner; other paths are relative to `base`.
    ///
    /// # Errors
    /// As [`problem`](Self::problem).
    pub fn problem_of(&self, runner: Runner, base: &Path) -> Result<Problem, CaseError> {
        self.check()?;
        let mut ice = self.ice.ice();
        if let Some(sliding) = &self.sliding {
            ice.hardness = Some(sliding.hardness(ice.hardness));
        }
        let mut problem = Problem {
            runner,
            ice,
            ice_surface: self.ice.surface(base)?,
            track_curvature: self.track.curvature(),
            load: self.load.load(),
        };
        crate::case::effects::switch_on(&self.effects, &mut problem)?;
        Ok(problem)
    }

    /// A runner given as a hexahedral mesh: the smooth surface fitted through the nodes of its
    /// underside, and its factorised stiffness.
    ///
    /// The mount fixes the nodes at the top: all of them, or those over the fixed places.
    fn meshed(&self, path: &Path) -> Result<(FittedHull, ElasticRunner), CaseError> {
        let named = |reason: &dyn Display| CaseError::Mesh {
            reason: format!("{}: {reason}", path.display()),
        };
        let bytes = read_regular(path, MAX_BYTES);
        let bytes = bytes.map_err(|error| named(&error))?;
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let mesh = match ending.as_deref() {
            Some("msh") => read_gmsh(&bytes),
            Some("vtu") => read_vtu(&bytes),
            _ => return Err(named(&"expected hexahedra in a .msh or a .vtu file")),
        };
        let mut mesh = mesh.map_err(|error| named(&error))?;
        let scale = self.runner.scale.unwrap_or(1.0);
        mesh.points.iter_mut().flatten().for_each(|v| *v *= scale);
        let ends = [0, 1, 2].map(|axis| {
            let along = || mesh.points.iter().map(|p| p[axis]);
            let low = along().fold(f64::INFINITY, f64::min);
            [low, along().fold(f64::NEG_INFINITY, f64::max)]
        });
        let extent = ends.map(|[low, high]| high - low);
        let top = ends[2][1];
        let mount = self.runner.mount.as_ref().map(|mount| mount.mount());
        let fixed = |p: [f64; 3]| {
            top - p[2] <= 1e-6 * extent[2] && mount.as_ref().is_none_or(|m| m.over(p[0]))
        };
        let [modulus, ratio] = [self.runner.youngs_modulus_pa, self.runner.poissons_ratio];
        let solid = RunnerSolid::new(mesh, modulus, ratio, fixed).map_err(|error| named(&error))?;
        let part = solid.underside();
        let mut report = check_hull(&part).map_err(|error| named(&error))?;
        // The report is of the underside alone, which is open; the size is that of the whole mesh.
        report.warnings = size_warnings(extent);
        report.extent = extent;
        let noise = self.runner.noise(&mut report, || solid.noise());
        let underside = FittedUnderside::new(&part, noise.found).map_err(|error| named(&error))?;
        let hull = FittedHull::new(underside, part, report, noise, None);
        let elastic = ElasticRunner {
            solid: Some(Arc::new(solid)),
            ..ElasticRunner::fixed_at_top(modulus, ratio, top)
        };
        Ok((hull, elastic))
    }

    /// Elasticity and mount of a runner whose flat top is at the height `top` [m]. The solid of a
    /// runner that is flat across is filled over the radius of its edge alone.
    fn elastic_runner(&self, top: f64, flat_across: bool) -> Result<ElasticRunner, CaseError> {
        let mount = self.runner.mount.as_ref().map(|mount| mount.mount());
        if mount.is_some() && top.is_infinite() {
            let expected = "expected a shape with a top: a paraboloid has none";
            return Err(combination("runner.mount", expected));
        }
        let [modulus, ratio] = [self.runner.youngs_modulus_pa, self.runner.poissons_ratio];
        Ok(ElasticRunner {
            mount: mount.unwrap_or_default(),
            flank: flat_across.then_some(MAX_FLANK_SLOPE),
            ..ElasticRunner::fixed_at_top(modulus, ratio, top)
        })
    }
}

/// The underside of a shape, with a measured or worn section where the case states one.
fn shape_underside(
    shape: &Shape,
    section: &SectionTable,
    base: &Path,
) -> Result<Arc<dyn Underside>, CaseError> {
    let modified = |nominal: Section| {
        section
            .of(nominal, base)
            .map_err(CaseError::in_file("runner.section"))
    };
    let rounded = |rocker_radius: f64, section, length, height| {
        let rocker = Rocker::arc(rocker_radius)?;
        Swept::with_rounded_ends(rocker, section, length, height).map(Arc::new)
    };
    Ok(match *shape {
        Shape::Bob {
            length_m,
            rocker_radius_m,
            section_radius_m,
            width_m,
            height_m,
        } => {
            let section = modified(Section::arc(section_radius_m, width_m)?)?;
            rounded(rocker_radius_m, section, length_m, height_m)?
        }
        Shape::Paraboloid {
            rocker_radius_m,
            section_radius_m,
        } => Arc::new(Paraboloid::new(rocker_radius_m, section_radius_m)?),
        Shape::Luge {
            length_m,
            rocker_radius_m,
            edge_radius_m,
            tilt_rad,
            width_m,
            height_m,
        } => {
            let section = modified(Section::edge(edge_radius_m, tilt_rad, width_m)?)?;
            rounded(rocker_radius_m, section, length_m, height_m)?
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::FileAxis;
    use kufe_contact::{Foundation, Load, Tilt};
    use kufe_mesh::BobRunner;

    fn case(shape: &str, rest: &str) -> Case {
        let text = format!(
            "[runner]\nshape = {{ {shape} }}\n[ice]\nyoungs_modulus_pa = 9e9\npoissons_ratio = 0.33\n\
             thickness_m = \"half-space\"\n[load]\nfz_n = 800\n{rest}"
        );
        Case::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    #[test]
    fn a_paraboloid_has_the_radii_of_its_case() -> Result<(), CaseError> {
        let shape = "kind = \"paraboloid\", rocker_radius_m = 30, section_radius_m = 0.005";
        let problem = case(
            shape,
            "tilt = \"fixed\"\nroll_rad = 0.01\n[track]\nradius_m = -50\n",
        )
        .problem(Path::new(""))?;
        let height = |x, y| problem.runner.underside.height(x, y);
        assert!((height(0.1, 0.0) / (0.01 / 60.0) - 1.0).abs() < 1e-12);
        assert!((height(0.0, 0.001) / (1e-6 / 0.01) - 1.0).abs() < 1e-12);
        assert_eq!(problem.track_curvature, -0.02);
        assert_eq!(problem.ice.foundation, Foundation::HalfSpace);
        assert_eq!(
            problem.load,
            Load::Force {
                fz: 800.0,
                offset_x: 0.0,
                offset_y: 0.0,
                tilt: Tilt::Fixed {
                    pitch: 0.0,
                    roll: 0.01
                },
            }
        );
        Ok(())
    }

    #[test]
    fn dimensions_that_do_not_fit_are_refused_with_their_numbers() {
        let shape = "kind = \"bob\", length_m = 1, rocker_radius_m = 30, section_radius_m = 0.005, width_m = 0.01, height_m = 0.001";
        let error = case(shape, "")
            .problem(Path::new(""))
            .map(|_| ())
            .expect_err("no height");
        assert!(error.to_string().starts_with("runner.shape: "), "{error}");
    }

    #[test]
    fn a_hull_is_read_from_the_cases_folder_and_fitted() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let runner = BobRunner {
            length: 0.2,
            ..BobRunner::default()
        }
        .swept()?;
        let hull = kufe_mesh::tessellate(&runner, 0.001)?;
        // Written in millimetres, lying on its side, to be turned back by scale, up and forward.
        let mut text = String::new();
        for [x, y, z] in &hull.positions {
            text += &format!("v {} {} {}\n", 1e3 * y, 1e3 * z, 1e3 * x);
        }
        for [a, b, c] in &hull.triangles {
            text += &format!("f {} {} {}\n", a + 1, b + 1, c + 1);
        }
        std::fs::write(folder.path().join("bob.obj"), text)?;
        let mut case = case(
            "kind = \"paraboloid\", rocker_radius_m = 30, section_radius_m = 0.005",
            "",
        );
        case.runner.shape = None;
        case.runner.hull = Some("bob.obj".into());
        case.runner.scale = Some(0.001);
        case.runner.up = Some(FileAxis::Y);
        case.runner.forward = Some(FileAxis::Z);
        let (problem, hull) = case.stated(folder.path(), None)?;
        let fitted = problem.runner.underside;
        for (x, y) in [(0.0, 0.0), (0.05, 0.0), (0.02, 0.0007), (-0.03, -0.001)] {
            let error = fitted.height(x, y) - runner.height(x, y);
            assert!(error.abs() < 2e-7, "{error:e} at {x}, {y}");
        }
        let report = hull.expect("a hull").report;
        assert!((report.extent[0] - 0.2).abs() < 1e-9 && report.warnings.is_empty());
        Ok(())
    }

    #[test]
    fn a_hull_that_does_not_exist_is_named() {
        let mut case = case(
            "kind = \"paraboloid\", rocker_radius_m = 30, section_radius_m = 0.005",
            "",
        );
        case.runner.shape = None;
        case.runner.hull = Some("nowhere.obj".into());
        let error = case
            .problem(Path::new("hulls"))
            .map(|_| ())
            .expect_err("no such file")
            .to_string();
        assert!(
            error.starts_with("runner.hull: ") && error.contains("nowhere.obj"),
            "{error}"
        );
    }
}
