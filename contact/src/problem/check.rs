//! Ranges of the numbers in a problem, and what does not go together.

use kufe_fem::Material;

use crate::problem::gap::Gap;
use crate::{
    ElasticRunner, Error, Foundation, Ice, Load, LoadedPlace, Mount, Options, Problem, Tilt,
};

const PASCALS: &str = "a positive number of Pa";
const METRES: &str = "a positive number of m";

/// The ice's material and the gap of a problem that has passed every check before it is solved.
pub(crate) fn checked<'a>(
    problem: &'a Problem,
    options: &Options,
) -> Result<(Material, Gap<'a>), Error> {
    let material = check(problem, options)?;
    let gap = Gap::new(problem)?;
    capacity(problem)?;
    Ok((material, gap))
}

/// Refuses a load that the hull cannot pass on at the stated hardness.
pub(crate) fn capacity(problem: &Problem) -> Result<(), Error> {
    let (Load::Force { fz, .. }, Some(hardness)) = (problem.load, problem.ice.hardness) else {
        return Ok(());
    };
    let [x0, x1, y0, y1] = problem.runner.underside.extent();
    let capacity = hardness * (x1 - x0) * (y1 - y0);
    if capacity <= fz {
        Err(Error::LoadExceedsHardness { fz, capacity })
    } else {
        Ok(())
    }
}

/// The ice's material, where every number of the problem is in its range.
pub(crate) fn check(problem: &Problem, options: &Options) -> Result<Material, Error> {
    check_ice(&problem.ice)?;
    let curvature = problem.track_curvature;
    let expected = "a finite number of 1/m";
    within(
        curvature.is_finite(),
        "track curvature",
        curvature,
        expected,
    )?;
    check_load(&problem.load)?;
    let [x_low, x_high, y_low, y_high] = problem.runner.underside.extent();
    let (length, width) = (x_high - x_low, y_high - y_low);
    within(length > 0.0, "length of the hull", length, METRES)?;
    within(width > 0.0, "width of the hull", width, METRES)?;
    if let Some(elastic) = &problem.runner.elastic {
        check_elastic(problem, elastic)?;
        check_mount(problem, elastic)?;
    }
    let tolerance = options.p_max_tolerance;
    let name = "accuracy of the peak pressure";
    positive(name, tolerance, "a positive number")?;
    let (residual, expected) = (options.residual, "more than 0 and less than 1");
    let usable = residual > 0.0 && residual < 1.0;
    within(usable, "requested residual", residual, expected)?;
    if let Some(cells) = options.cells {
        let usable = (1..=1000).contains(&cells);
        within(
            usable,
            "cells over half the patch",
            cells as f64,
            "1 to 1000",
        )?;
    }
    let ice = &problem.ice;
    solid_material("ice material", ice.youngs_modulus, ice.poissons_ratio)
}

/// The material of these constants; an error with the `name` of what has them where no solid does.
pub(crate) fn solid_material(
    name: &'static str,
    youngs_modulus: f64,
    poissons_ratio: f64,
) -> Result<Material, Error> {
    Material::new(youngs_modulus, poissons_ratio)
        .map_err(|_| Error::out_of_range(name, youngs_modulus, "an elastic solid"))
}

/// Smallest Young's modulus of a runner over that of the ice. A softer one is a wrong unit, and its
/// compliance has no digits in common with that of the ice.
const SOFTEST: f64 = 1e-9;

/// Largest tilt [rad]. Tilts are taken as small: a round section's curvature is off by 1.5 times
/// the square of the roll.
pub(crate) const MOST_TILT: f64 = 0.12;

/// Force or approach is positive, offsets and tilts are numbers, tilts those of a runner on its
/// underside.
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
        let (name, expected) = ("offset of the line of action", "a finite number of m");
        within(offset.is_finite(), name, offset, expected)?;
    }
    for tilt in tilts {
        let expected = "at most 0.12 rad either way";
        within(tilt.abs() <= MOST_TILT, "fixed tilt", tilt, expected)?;
    }
    Ok(())
}

fn within(
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

/// A runner's material is a solid's; on the ice's columns its top and its flank are numbers.
fn check_elastic(problem: &Problem, elastic: &ElasticRunner) -> Result<(), Error> {
    positive("runner's Young's modulus", elastic.youngs_modulus, PASCALS)?;
    check_ratio("runner's Poisson's ratio", elastic.poissons_ratio)?;
    let own = elastic.solid.as_ref();
    let young = own.map_or(elastic.youngs_modulus, |solid| {
        solid.material().youngs_modulus()
    });
    within(
        young >= SOFTEST * problem.ice.youngs_modulus,
        "runner's Young's modulus",
        young,
        "at least 1e-9 of the ice's",
    )?;
    let extent = problem.runner.underside.extent();
    if elastic.solid.is_none() && extent.iter().all(|end| end.is_finite()) {
        let top = elastic.top;
        within(top.is_finite(), "runner's top", top, "a finite number of m")?;
    }
    match elastic.flank {
        Some(flank) => positive("slope of the runner's flank", flank, "a positive number"),
        None => Ok(()),
    }
}

/// Places lie on the hull and are longer than nothing; loads without a mount balance the load.
fn check_mount(problem: &Problem, elastic: &ElasticRunner) -> Result<(), Error> {
    if elastic.mount == Mount::Top {
        return Ok(());
    }
    let extent = problem.runner.underside.extent();
    let places = elastic.mount.places();
    let count = places.len() as f64;
    within(
        count > 0.0,
        "places of the runner's mount",
        count,
        "1 or more",
    )?;
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
    within(
        (share - 1.0).abs() <= 1e-6,
        "sum of the loads' shares",
        share,
        "1",
    )?;
    let (name, expected) = ("line of action of the loads", "that of the normal force");
    within((line - offset_x).abs() <= 1e-6, name, line, expected)
}
