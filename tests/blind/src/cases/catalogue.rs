//! The list of cases: families, what each hides, and how large.

use crate::cases::answer::{Case, CaseError};
use crate::cases::label::Label;
use crate::cases::{campaign_case, experiments, pressure_case, run_case};
use crate::open_worlds::{self, faults::Family};
use crate::other_worlds::{self, EFFECTS, LEVELS, WORLDS, World};
use crate::world::hidden::{ENTRIES, Kind};

/// Shares of the residual's noise variance for effects in runs.
pub const RUN_SHARES: [f64; 3] = [0.007, 0.02, 0.06];
/// Further shares in other worlds: misfits as large as the noise, and ten times its variance.
pub const LARGE_SHARES: [f64; 2] = [1.0, 10.0];
/// Shares for friction experiments, which have tens of rows instead of tens of thousands.
pub const EXPERIMENT_SHARES: [f64; 3] = [0.5, 1.5, 4.0];

/// One case, before its seed is chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Spec {
    /// What it is called.
    pub label: Label,
    /// How it is built.
    pub recipe: Recipe,
}

/// Ways to build a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Recipe {
    /// A campaign of runs.
    Runs(run_case::Recipe),
    /// A campaign of another world, with what it hides.
    World(other_worlds::World, Option<other_worlds::Effect>),
    /// A campaign of an open world.
    Open(Family, open_worlds::Hiding),
    /// A table of friction experiments.
    Experiments(experiments::Recipe),
    /// Runs and friction experiments together.
    Campaign(campaign_case::Recipe),
    /// Pressure measurements.
    Pressures(pressure_case::Recipe),
}

impl Spec {
    /// `family/name@share`.
    pub fn id(&self) -> String {
        self.label.id()
    }

    /// Its name as a folder.
    pub fn folder(&self, seed: u64) -> String {
        self.label.folder(seed)
    }

    /// Whether it hides an effect of a stated size in another world.
    fn is_sized_world(&self) -> bool {
        let noise = |world| matches!(world, World::Noise(_));
        matches!(self.recipe, Recipe::World(world, Some(_)) if !noise(world))
            && self.label.share.is_some()
    }

    /// Builds the case for a seed.
    pub fn build(&self, seed: u64) -> Result<Case, CaseError> {
        match self.recipe {
            Recipe::Runs(recipe) => Ok(run_case::build(&self.label, recipe, seed)),
            Recipe::World(world, effect) => {
                Ok(other_worlds::build(world, effect, &self.label, seed))
            }
            Recipe::Open(family, hiding) => {
                Ok(open_worlds::build(family, hiding, &self.label, seed))
            }
            Recipe::Experiments(recipe) => Ok(experiments::build(&self.label, recipe, seed)),
            Recipe::Campaign(recipe) => Ok(campaign_case::build(&self.label, recipe, seed)),
            Recipe::Pressures(recipe) => pressure_case::build(&self.label, recipe, seed),
        }
    }
}

/// Every case there is.
pub fn all() -> Vec<Spec> {
    use run_case::Recipe as R;
    let mut specs = Vec::new();
    let mut add = |family, name: &str, share, recipe| {
        let label = Label {
            family,
            name: name.to_owned(),
            share,
        };
        specs.push(Spec { label, recipe });
    };
    for (name, recipe) in [
        ("white", R::White),
        ("ar1", R::Coloured),
        ("unstated-noise", R::UnstatedNoise),
        ("quiet", R::Quiet),
        ("session-drift", R::SessionDrift),
        ("survey", R::Survey),
        ("mistuned", R::Mistuned),
    ] {
        add("null", name, None, Recipe::Runs(recipe));
    }
    add(
        "null",
        "seven-points",
        None,
        Recipe::Experiments(experiments::Recipe::SevenPoints),
    );
    add(
        "null",
        "experiments",
        None,
        Recipe::Experiments(experiments::Recipe::Null),
    );
    add(
        "null",
        "pressures",
        None,
        Recipe::Pressures(pressure_case::Recipe::Null),
    );
    add(
        "wrong-survey",
        "five-times-too-small",
        None,
        Recipe::Runs(R::WrongSurvey),
    );

    add("film", "three-tracks", None, Recipe::Runs(R::Film));
    add("film", "one-track", None, Recipe::Runs(R::FilmOnOneTrack));

    for entry in ENTRIES {
        let family = match entry.kind {
            Kind::BeyondRollRate
            | Kind::BeyondExtra
            | Kind::BeyondPitchGrip
            | Kind::BeyondSpeedHump
            | Kind::BeyondProduct => "beyond",
            kind if kind.is_of_a_sensor() => "fault",
            _ if entry.longitudinal => "longitudinal",
            _ => "lateral",
        };
        let name = match entry.kind {
            Kind::AccelerometerBiasX | Kind::AccelerometerTiltPitch => format!("{}-x", entry.name),
            Kind::AccelerometerBiasY | Kind::AccelerometerTiltRoll | Kind::AccelerometerScaleY => {
                format!("{}-y", entry.name)
            }
            _ => entry.name.replace("unknown:", "").replace("_radps", ""),
        };
        for share in RUN_SHARES {
            add(
                family,
                &name,
                Some(share),
                Recipe::Runs(R::Single(entry.kind)),
            );
        }
    }
    for kind in [Kind::YawRateLag, Kind::SlipLag, Kind::SteerLag] {
        for ms in [2, 5, 20] {
            let name = format!("{}-{ms}-ms", kind.entry().name);
            add("late", &name, None, Recipe::Runs(R::Late(kind, ms)));
        }
    }
    for (name, recipe) in [
        ("temperature~humidity", R::TiedHumidity),
        ("drag-area~air-density", R::Single(Kind::DragArea)),
        ("load~plowing", R::Single(Kind::Load)),
        ("slope~accelerometer-tilt", R::Single(Kind::Slope)),
    ] {
        add("twin", name, Some(0.02), Recipe::Runs(recipe));
    }
    for (name, a, b) in [
        ("temperature+slip-drag", Kind::Temperature, Kind::SlipDrag),
        (
            "camber-thrust+temperature-grip",
            Kind::CamberThrust,
            Kind::TemperatureGrip,
        ),
        ("speed-grip+lever-arm", Kind::SpeedGrip, Kind::LeverArm),
        (
            "steer-drag+temperature-grip",
            Kind::SteerDrag,
            Kind::TemperatureGrip,
        ),
    ] {
        add("two", name, Some(0.02), Recipe::Runs(R::Pair(a, b)));
    }
    add(
        "few-sessions",
        "temperature",
        Some(0.02),
        Recipe::Runs(R::TwoSessions(Kind::Temperature)),
    );
    add(
        "few-sessions",
        "temperature-grip",
        Some(0.02),
        Recipe::Runs(R::TwoSessions(Kind::TemperatureGrip)),
    );
    add(
        "new-track",
        "temperature-grip",
        Some(0.02),
        Recipe::Runs(R::NewTrack(Kind::TemperatureGrip)),
    );
    add(
        "new-track",
        "camber-thrust",
        Some(0.02),
        Recipe::Runs(R::NewTrack(Kind::CamberThrust)),
    );
    for world in WORLDS {
        let [null, effects] = world.families();
        add(null, "none", None, Recipe::World(world, None));
        for effect in EFFECTS {
            add(
                effects,
                effect.case,
                None,
                Recipe::World(world, Some(*effect)),
            );
        }
        for effect in other_worlds::sized() {
            for share in RUN_SHARES.into_iter().chain(LARGE_SHARES) {
                let recipe = Recipe::World(world, Some(effect));
                add(effects, effect.case, Some(share), recipe);
            }
        }
    }
    for level in LEVELS {
        let (world, share) = (World::Noise(level), Some(f64::from(level) / 1e3));
        let [null, effects] = world.families();
        add(null, "none", share, Recipe::World(world, None));
        for law in EFFECTS.iter().filter(|e| e.name.starts_with("unknown:")) {
            let recipe = Recipe::World(world, Some(*law));
            add(effects, law.case, share, recipe);
        }
    }
    for family in Family::ALL {
        for (hiding, name) in open_worlds::Hiding::ALL {
            let recipe = Recipe::Open(family, hiding);
            if hiding == open_worlds::Hiding::None {
                add(family.name(), name, None, recipe);
                continue;
            }
            for share in open_worlds::SHARES {
                add(family.name(), name, Some(share), recipe);
            }
        }
    }
    for cause in experiments::CAUSES {
        for share in EXPERIMENT_SHARES {
            add(
                "experiment",
                cause.name,
                Some(share),
                Recipe::Experiments(experiments::Recipe::Single(cause.cause)),
            );
        }
    }
    for (name, runs, cause) in [
        ("none", R::White, None),
        (
            "temperature",
            R::Single(Kind::Temperature),
            Some(experiments::Cause::Temperature),
        ),
        (
            "temperature~humidity",
            R::TiedHumidity,
            Some(experiments::Cause::Temperature),
        ),
        (
            "speed",
            R::Single(Kind::Speed),
            Some(experiments::Cause::Speed),
        ),
        (
            "humidity",
            R::Single(Kind::Humidity),
            Some(experiments::Cause::Humidity),
        ),
        ("on-the-track-alone", R::Single(Kind::Temperature), None),
        ("steer-drag", R::Single(Kind::SteerDrag), None),
    ] {
        let (family, share) = match name {
            "none" => ("campaign-null", None),
            _ => ("campaign", Some(0.02)),
        };
        let recipe = campaign_case::Recipe { runs, cause };
        add(family, name, share, Recipe::Campaign(recipe));
    }
    for (name, recipe) in pressure_case::HIDDEN {
        add("pressure", name, None, Recipe::Pressures(*recipe));
    }
    specs
}

/// The cases whose id starts with one of the comma-separated beginnings, `@0.02` behind it for a
/// size; `all` for every case.
///
/// Cases of other worlds with a stated size apply only where the request has a size.
pub fn chosen(requested: &str) -> Result<Vec<Spec>, CaseError> {
    let mut found: Vec<Spec> = Vec::new();
    for requested in requested.split(',').map(str::trim) {
        let (begins, size) = match requested.split_once('@') {
            Some((begins, size)) => (begins, Some(format!("@{size}"))),
            None if requested == "all" => ("", None),
            None => (requested, None),
        };
        let hits: Vec<Spec> = all()
            .into_iter()
            .filter(|spec| match &size {
                Some(size) => spec.id().starts_with(begins) && spec.id().ends_with(size.as_str()),
                None => spec.id().starts_with(begins) && !spec.is_sized_world(),
            })
            .collect();
        if hits.is_empty() {
            return Err(CaseError::Unknown(requested.to_owned()));
        }
        for hit in hits {
            if !found.contains(&hit) {
                found.push(hit);
            }
        }
    }
    Ok(found)
}
