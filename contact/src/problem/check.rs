//! Ranges of the numbers in a problem, and what does not go together.

use kufe_fem::Material;

use crate::{
    Bed, ElasticRunner, Error, Foundation, Ice, Load, LoadedPlace, Mount, Options, Problem, Tilt,
};

/// The ice's material, where every number of the problem is in its range.
pub(crate) fn check(problem: &Problem, options: &Options) -> Result<Material, Error> {
    check_ice(&problem.ice)?;
    let curvature = problem.track_curvature;
    within(
        curvature.is_finite(),
        "track curvature",
        curvature,
        "a finite number of 1/m",
    )?;
    match problem.load {
        Load::Force { fz, .. } => positive("normal force", fz, "a positive number of N")?,
        Load::Approach { approach, .. } => {
            positive("approach", approach, "a positive number of m")?;
        }
    }
    check_load(&problem.load)?;
    check_extent(problem)?;
    if let Some(elastic) = &problem.runner.elastic {
        check_elastic(problem, elastic)?;
        check_mount(problem, elastic)?;
    }
    positive(
        "accuracy of the peak pressure",
        options.p_max_tolerance,
        "a positive number",
    )?;
    within(
        options.residual > 0.0 && options.residual < 1.0,
        "requested residual",
        options.residual,
        "more than 0 and less than 1",
    )?;
    if let Some(cells) = options.cells {
        within(
            (1..=1000).contains(&cells),
            "cells over half the patch",
            cells as f64,
            "1 to 1000",
        )?;
    }
    let ice = &problem.ice;
    Material::new(ice.youngs_modulus, ice.poissons_ratio).map_err(|_| Error::OutOfRange {
        name: "ice material",
        value: ice.youngs_modulus,
        expected: "an elastic solid",
    })
}

/// Largest tilt [rad]. Tilts are taken as small: a round section's curvature is off by 1.5 times
/// the square of the roll.
pub(crate) const MOST_TILT: f64 = 0.12;

/// Offsets and tilts are numbers, tilts those of a runner on its underside.
fn check_load(load: &Load) -> Result<(), Error> {
    let (offsets, tilts) = match *load {
        Load::Force {
            offset_x,
            offset_y,
            tilt,
            ..
        } => match tilt {
            Tilt::Free => ([offset_x, offset_y], [0.0; 2]),
            Tilt::Fixed { pitch, roll } => ([offset_x, offset_y], [pitch, roll]),
        },
        Load::Approach { pitch, roll, .. } => ([0.0; 2], [pitch, roll]),
    };
    for offset in offsets {
        within(
            offset.is_finite(),
            "offset of the line of action",
            offset,
            "a finite number of m",
        )?;
    }
    for tilt in tilts {
        within(
            tilt.abs() <= MOST_TILT,
            "fixed tilt",
            tilt,
            "at most 0.12 rad either way",
        )?;
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
    Err(Error::OutOfRange {
        name,
        value,
        expected,
    })
}

fn positive(name: &'static str, value: f64, expected: &'static str) -> Result<(), Error> {
    within(value > 0.0 && value.is_finite(), name, value, expected)
}

const RATIO: &str = "more than -1 and less than 0.5";

fn check_ice(ice: &Ice) -> Result<(), Error> {
    let (modulus, ratio) = (ice.youngs_modulus, ice.poissons_ratio);
    positive("ice Young's modulus", modulus, "a positive number of Pa")?;
    within(
        ratio > -1.0 && ratio < 0.5,
        "ice Poisson's ratio",
        ratio,
        RATIO,
    )?;
    match ice.foundation {
        Foundation::HalfSpace => {}
        Foundation::RigidBed { thickness } => {
            positive("ice thickness", thickness, "a positive number of m")?;
        }
        Foundation::ElasticBed { thickness, bed } => {
            positive("ice thickness", thickness, "a positive number of m")?;
            check_bed(bed)?;
        }
    }
    match ice.hardness {
        Some(hardness) => positive("ice hardness", hardness, "a positive number of Pa"),
        None => Ok(()),
    }
}

fn check_bed(bed: Bed) -> Result<(), Error> {
    let ratio = bed.poissons_ratio;
    positive("bed thickness", bed.thickness, "a positive number of m")?;
    positive(
        "bed Young's modulus",
        bed.youngs_modulus,
        "a positive number of Pa",
    )?;
    within(
        ratio > -1.0 && ratio < 0.5,
        "bed Poisson's ratio",
        ratio,
        RATIO,
    )
}

/// The hull has a length and a width.
fn check_extent(problem: &Problem) -> Result<(), Error> {
    let [x_low, x_high, y_low, y_high] = problem.runner.underside.extent();
    for (name, size) in [
        ("length of the hull", x_high - x_low),
        ("width of the hull", y_high - y_low),
    ] {
        within(size > 0.0, name, size, "a positive number of m")?;
    }
    Ok(())
}

/// A runner's material is a solid's; on the ice's columns its top and its flank are numbers.
fn check_elastic(problem: &Problem, elastic: &ElasticRunner) -> Result<(), Error> {
    let (modulus, ratio) = (elastic.youngs_modulus, elastic.poissons_ratio);
    positive(
        "runner's Young's modulus",
        modulus,
        "a positive number of Pa",
    )?;
    within(
        ratio > -1.0 && ratio < 0.5,
        "runner's Poisson's ratio",
        ratio,
        RATIO,
    )?;
    let bounded = problem
        .runner
        .underside
        .extent()
        .iter()
        .all(|end| end.is_finite());
    if elastic.solid.is_none() && bounded {
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
        positive(
            "length of a mount's place",
            place.length,
            "a positive number of m",
        )?;
        let half = 0.5 * place.length;
        let slack = 1e-9 * place.length;
        within(
            place.x - half >= extent[0] - slack && place.x + half <= extent[1] + slack,
            "middle of a mount's place",
            place.x,
            "a place within the runner's ends",
        )?;
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
        return Err(Error::LoadsNeedFreeTilt);
    };
    let sum = |f: &dyn Fn(&LoadedPlace) -> f64| loads.iter().map(f).sum::<f64>();
    let (share, line) = (sum(&|l| l.share), sum(&|l| l.share * l.place.x));
    within(
        (share - 1.0).abs() <= 1e-6,
        "sum of the loads' shares",
        share,
        "1",
    )?;
    within(
        (line - offset_x).abs() <= 1e-6,
        "line of action of the loads",
        line,
        "that of the normal force",
    )
}
