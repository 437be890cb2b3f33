//! Checks of a problem: the ranges of its numbers, and combinations that exclude each other.

use kufe_fem::Material;

use crate::problem::gap::Gap;
use crate::{
    ElasticRunner, Error, Foundation, Ice, Load, LoadedPlace, Mount, Options, Problem, Tilt,
};

const PASCALS: &str = "a positive number of Pa";
const METRES: &str = "a positive number of m";

/// A problem whose numbers are in their ranges, with its options, material and gap.
pub(crate) struct CheckedProblem<'a> {
    pub problem: &'a Problem,
    pub options: &'a Options,
    /// Material of the ice.
    pub material: Material,
    pub gap: Gap<'a>,
}

impl<'a> CheckedProblem<'a> {
    /// Checks the ranges, and the fit of hull, track and load.
    pub fn new(problem: &'a Problem, options: &'a Options) -> Result<Self, Error> {
        Ok(CheckedProblem {
            problem,
            options,
            material: check(problem, options)?,
            gap: Gap::new(problem)?,
        })
    }

    /// [`CheckedProblem::new`], and checks that the hull can carry the load at the stated hardness.
    pub fn bearable(problem: &'a Problem, options: &'a Options) -> Result<Self, Error> {
        let checked = CheckedProblem::new(problem, options)?;
        if let (Load::Force { fz, .. }, Some(hardness)) = (problem.load, problem.ice.hardness) {
            let [x0, x1, y0, y1] = problem.runner.underside.extent();
            let capacity = hardness * (x1 - x0) * (y1 - y0);
            if capacity <= fz {
                return Err(Error::LoadExceedsHardness { fz, capacity });
            }
        }
        Ok(checked)
    }

    /// Largest pressure that the ice bears [Pa].
    pub fn hardness(&self) -> f64 {
        self.problem.ice.hardness.unwrap_or(f64::INFINITY)
    }
}

/// Checks every number of the problem; returns the material of the ice.
fn check(problem: &Problem, options: &Options) -> Result<Material, Error> {
    check_ice(&problem.ice)?;
    let curvature = problem.track_curvature;
    finite("track curvature", curvature, "a finite number of 1/m")?;
    check_load(&problem.load)?;
    let [x_low, x_high, y_low, y_high] = problem.runner.underside.extent();
    let (length, width) = (x_high - x_low, y_high - y_low);
    within(length > 0.0, "length of the hull", length, METRES)?;
    within(width > 0.0, "width of the hull", width, METRES)?;
    if let Some(elastic) = &problem.runner.elastic {
        check_elastic(problem, elastic)?;
        check_mount(problem, elastic)?;
    }
    let name = "accuracy of the peak pressure";
    positive(name, options.p_max_tolerance, "a positive number")?;
    let (residual, expected) = (options.residual, "more than 0 and less than 1");
    let usable = residual > 0.0 && residual < 1.0;
    within(usable, "requested residual", residual, expected)?;
    if let Some(cells) = options.cells {
        let (usable, name) = ((1..=1000).contains(&cells), "cells over half the patch");
        within(usable, name, cells as f64, "1 to 1000")?;
    }
    let ice = &problem.ice;
    solid_material("ice material", ice.youngs_modulus, ice.poissons_ratio)
}

/// The material of these constants; an error with the body's `name` if they are those of no solid.
pub(crate) fn solid_material(
    name: &'static str,
    youngs_modulus: f64,
    poissons_ratio: f64,
) -> Result<Material, Error> {
    Material::new(youngs_modulus, poissons_ratio)
        .map_err(|_| Error::out_of_range(name, youngs_modulus, "an elastic solid"))
}

/// Smallest ratio of a runner's Young's modulus to that of the ice. A smaller one is a wrong unit,
/// and the ice's compliance is then below the rounding of the runner's.
const MIN_STIFFNESS_RATIO: f64 = 1e-9;

/// Largest tilt [rad]. Free tilts and those of a deformed runner are treated as small angles.
pub(crate) const MAX_TILT: f64 = 0.12;

/// Force or approach must be positive, offsets finite, and tilts at most [`MAX_TILT`].
fn check_load(load: &Load) -> Result<(), Error> {
    let (offsets, tilts) = match *load {
        Load::Force {
            fz,
            offset_x,
            offset_y,
            tilt,
        } => {
            positive("normal force", fz, "a positive number of N")?;
            let tilts = match tilt {
                Tilt::Free => [0.0; 2],
                Tilt::Fixed { pitch, roll } => [pitch, roll],
            };
            ([offset_x, offset_y], tilts)
        }
        Load::Approach {
            approach,
            pitch,
            roll,
        } => {
            positive("approach", approach, METRES)?;
            ([0.0; 2], [pitch, roll])
        }
    };
    for offset in offsets {
        finite(
            "offset of the line of action",
            offset,
            "a finite number of m",
        )?;
    }
    for tilt in tilts {
        let expected = "at most 0.12 rad either way";
        within(tilt.abs() <= MAX_TILT, "fixed tilt", tilt, expected)?;
    }
    Ok(())
}

pub(crate) fn within(
    holds: bool,
    name: &'static str,
    value: f64,
    expected: &'static str,
) -> Result<(), Error> {
    if holds {
        return Ok(());
    }
    Err(Error::out_of_range(name, value, expected))
}

fn finite(name: &'static str, value: f64, expected: &'static str) -> Result<(), Error> {
    within(value.is_finite(), name, value, expected)
}

pub(crate) fn positive(
    name: &'static str,
    value: f64,
    expected: &'static str,
) -> Result<(), Error> {
    within(value > 0.0 && value.is_finite(), name, value, expected)
}

fn check_ratio(name: &'static str, ratio: f64) -> Result<(), Error> {
    let expected = "more than -1 and less than 0.5";
    within(ratio > -1.0 && ratio < 0.5, name, ratio, expected)
}

fn check_ice(ice: &Ice) -> Result<(), Error> {
    positive("ice Young's modulus", ice.youngs_modulus, PASCALS)?;
    check_ratio("ice Poisson's ratio", ice.poissons_ratio)?;
    match ice.foundation {
        Foundation::HalfSpace => {}
        Foundation::RigidBed { thickness } => positive("ice thickness", thickness, METRES)?,
        Foundation::ElasticBed { thickness, bed } => {
            positive("ice thickness", thickness, METRES)?;
            positive("bed thickness", bed.thickness, METRES)?;
            positive("bed Young's modulus", bed.youngs_modulus, PASCALS)?;
            check_ratio("bed Poisson's ratio", bed.poissons_ratio)?;
        }
    }
    match ice.hardness {
        Some(hardness) => positive("ice hardness", hardness, PASCALS),
        None => Ok(()),
    }
}

/// Checks a runner's material and, where it is meshed on the ice's columns, its top and its flank.
fn check_elastic(problem: &Problem, elastic: &ElasticRunner) -> Result<(), Error> {
    positive("runner's Young's modulus", elastic.youngs_modulus, PASCALS)?;
    check_ratio("runner's Poisson's ratio", elastic.poissons_ratio)?;
    let own = elastic.solid.as_ref();
    let young = own.map_or(elastic.youngs_modulus, |solid| {
        solid.material().youngs_modulus()
    });
    let stiff = young >= MIN_STIFFNESS_RATIO * problem.ice.youngs_modulus;
    let expected = "at least 1e-9 of the ice's";
    within(stiff, "runner's Young's modulus", young, expected)?;
    if elastic.solid.is_none() && problem.runner.is_bounded() {
        finite("runner's top", elastic.top, "a finite number of m")?;
    }
    match elastic.flank {
        Some(flank) => positive("slope of the runner's flank", flank, "a positive number"),
        None => Ok(()),
    }
}

/// Places must lie on the hull and have a positive length; loads without a mount must balance the
/// load.
fn check_mount(problem: &Problem, elastic: &ElasticRunner) -> Result<(), Error> {
    if elastic.mount == Mount::Top {
        return Ok(());
    }
    let extent = problem.runner.underside.extent();
    let places = elastic.mount.places();
    let (count, name) = (places.len() as f64, "places of the runner's mount");
    within(count > 0.0, name, count, "1 or more")?;
    for place in places {
        positive("length of a mount's place", place.length, METRES)?;
        let half = 0.5 * place.length;
        let slack = 1e-9 * place.length;
        let inside = place.x - half >= extent[0] - slack && place.x + half <= extent[1] + slack;
        let expected = "a place within the runner's ends";
        within(inside, "middle of a mount's place", place.x, expected)?;
    }
    let Mount::Loads(loads) = &elastic.mount else {
        return Ok(());
    };
    let Load::Force {
        offset_x,
        tilt: Tilt::Free,
        ..
    } = problem.load
    else {
        return Err(Error::Unsuitable(
            "a runner without a mount needs a normal force and free tilt".into(),
        ));
    };
    let sum = |f: &dyn Fn(&LoadedPlace) -> f64| loads.iter().map(f).sum::<f64>();
    let (share, line) = (sum(&|l| l.share), sum(&|l| l.share * l.place.x));
    let whole = (share - 1.0).abs() <= 1e-6;
    within(whole, "sum of the loads' shares", share, "1")?;
    let (name, expected) = ("line of action of the loads", "that of the normal force");
    within((line - offset_x).abs() <= 1e-6, name, line, expected)
}
