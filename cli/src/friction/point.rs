//! Friction of one runner under one load: the contact is solved and its peak pressure looked up in the law.

use std::path::PathBuf;
use std::time::Instant;

use kufe::case::StatedProblem;
use kufe::jobs::field::pretty;
use kufe::jobs::{Failure, case_file::LoadedCase};
use kufe::results::{FrictionByLaw, Measured};
use kufe_contact::solve;
use kufe_sled::effects::{Effects, Kind, OperatingPoint};
use kufe_sled::friction::{Longitudinal, longitudinal_force};
use kufe_sled::{Conditions, Model};

use crate::friction::asked::Asked;
use crate::output::global::Global;
use crate::output::say::{say, warn};

/// Options of a law over the pressure, and of no groove.
const BY_LAW: [&str; 5] = ["alpha_rad", "model", "air_c", "air_pa", "humidity_pct"];

/// Arguments of `kufe friction CASE`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case; with --groove several, side by side
    #[arg(required = true, value_name = "CASE")]
    pub cases: Vec<PathBuf>,
    /// Speed [m/s], always needed; with --groove one or several, as 5,20,35
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    pub v_mps: Vec<f64>,
    /// Ice temperature [degrees Celsius], for effects that need it; with --groove one or several, as -10,-5,-1
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub ice_c: Vec<f64>,
    /// Friction of the groove that the runner ploughs and of the melt film in it, over all speeds and temperatures of the ice, instead of
    /// a law over the pressure
    #[arg(long, conflicts_with_all = BY_LAW)]
    pub groove: bool,
    /// With --groove, one speed and one case: the runner with the least friction, by one or two numbers of its shape within bounds, as
    /// rocker_radius_m=15:60,section_radius_m=0.004:0.008
    #[arg(long, value_name = "KEY=LOW:HIGH", value_delimiter = ',')]
    pub optimise: Vec<String>,
    /// With --groove: folder for friction.csv, friction.json and friction.png
    #[arg(long, short, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// Slip angle [rad]
    #[arg(
        long,
        value_name = "RAD",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    pub alpha_rad: f64,
    /// Model of the sled and its friction, whose [friction.longitudinal] and [effects] hold; the published law where absent
    #[arg(long, short, value_name = "MODEL.toml")]
    pub model: Option<PathBuf>,
    /// Air temperature [degrees Celsius], for effects that need it
    #[arg(long, value_name = "CELSIUS", allow_negative_numbers = true)]
    pub air_c: Option<f64>,
    /// Air pressure [Pa], for effects that need it
    #[arg(long, value_name = "PA")]
    pub air_pa: Option<f64>,
    /// Relative humidity [%], for effects that need it
    #[arg(long, value_name = "PCT")]
    pub humidity_pct: Option<f64>,
}

impl Args {
    /// What must stand beside the options given.
    ///
    /// # Errors
    /// [`Failure::Usage`] that says what is missing, why, and what to give.
    pub fn complete(&self) -> Result<(), Failure> {
        let tables = [
            (
                self.out.is_some(),
                "-o writes friction over speed and temperature of the ice",
            ),
            (
                !self.optimise.is_empty(),
                "--optimise compares runners on ice of one temperature",
            ),
        ];
        let mut missing = Vec::new();
        if self.v_mps.is_empty() {
            missing.push("--v-mps is missing: give the speed in m/s, as --v-mps 30".to_owned());
        }
        let groove = self.groove;
        let asked = tables.iter().find(|(asked, _)| *asked);
        if let (false, Some((_, why))) = (groove, asked) {
            missing.push(format!("--groove is missing: {why}"));
        }
        if (groove || asked.is_some()) && self.ice_c.is_empty() {
            let how = "give the temperature of the ice in degrees Celsius, as --ice-c -5, or several as --ice-c -10,-5,-1";
            missing.push(format!("--ice-c is missing: {how}"));
        }
        match missing.is_empty() {
            true => Ok(()),
            false => Err(Failure::Usage(missing.join("\n"))),
        }
    }

    /// The table over speed and temperature, where one is asked for.
    pub fn sliding(&self) -> Option<Asked<'_>> {
        self.groove.then_some(Asked {
            cases: &self.cases,
            speeds: &self.v_mps,
            temperatures: &self.ice_c,
            optimise: &self.optimise,
            out: self.out.as_ref(),
        })
    }
}

/// Solves and prints.
///
/// # Errors
/// [`Failure::Usage`] for numbers out of range, [`Failure::BadInput`] for the files,
/// [`Failure::NotConverged`] where the solver stops short.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let ([path], &[speed], &([] | [_])) = (&args.cases[..], &args.v_mps[..], &args.ice_c[..])
    else {
        let text = "expected one case, one --v-mps and one --ice-c; several go with --groove";
        return Err(Failure::Usage(text.into()));
    };
    check(args, speed)?;
    let (law, effects, drag_area) = model(args)?;
    let loaded = LoadedCase::read(path)?;
    let StatedProblem { problem, hull } = loaded.stated()?;
    let warnings = loaded.hull_warnings(hull.as_ref());
    let bar = global.progress();
    bar.set_message("solving the contact");
    let started = Instant::now();
    let solved = solve(&problem, &loaded.case.options());
    bar.finish_and_clear();
    let solution = solved.map_err(|error| loaded.failure(&error))?;
    loaded.fine_enough(hull.as_ref(), &solution)?;
    for warning in &warnings {
        warn(&warning.to_string());
    }
    let base = law.mu(solution.p_max);
    let point = operating_point(args, speed, solution.fz, drag_area);
    let (mu, applied, ignored) = with_effects(base, &effects, &point)?;
    let capped =
        matches!(law, Longitudinal::Pressure(law) if law.uncapped(solution.p_max) > law.mu_cap);
    let error = match law {
        Longitudinal::Pressure(law) => law.slope(solution.p_max).abs() * solution.p_max_error,
        Longitudinal::Fixed(_) => 0.0,
    };
    let fx = longitudinal_force(solution.fz, args.alpha_rad, mu);
    let result = FrictionByLaw {
        p_max: Measured::new(solution.p_max, solution.p_max_error),
        fz_n: solution.fz,
        mu,
        mu_base: base,
        mu_error: error,
        depends_on_pressure: law.needs_pressure(),
        capped,
        alpha_rad: args.alpha_rad,
        fx_n: fx,
        v_mps: speed,
        power_w: fx * speed,
        effects: applied,
        effects_not_concerned: ignored,
        seconds: started.elapsed().as_secs_f64(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    if global.json {
        say(&pretty(&result)?);
        return Ok(());
    }
    let (applied, ignored) = (&result.effects, &result.effects_not_concerned);
    let mut text = format!(
        "peak pressure  {:.3} MPa +- {:.3}\nnormal force   {:.1} N\nmu             {:.3}e-3 +- {:.3}e-3 (by the pressure's error)\nforce          {:.3} N along the runner, at a slip angle of {} rad\npower          {:.1} W lost at {} m/s\n",
        solution.p_max * 1e-6,
        solution.p_max_error * 1e-6,
        solution.fz,
        mu * 1e3,
        error * 1e3,
        fx,
        args.alpha_rad,
        -fx * speed,
        speed,
    );
    if capped {
        text +=
            "the pressure lies beyond those that the law was fitted to: this is its largest mu\n";
    }
    if !applied.is_empty() {
        text += &format!(
            "effects        {} (mu before them {:.3}e-3)\n",
            applied.join(", "),
            base * 1e3
        );
    }
    if !ignored.is_empty() {
        text += &format!("not of the friction coefficient: {}\n", ignored.join(", "));
    }
    say(&text);
    Ok(())
}

fn check(args: &Args, speed: f64) -> Result<(), Failure> {
    let told = |name: &str, value: f64, expected: &str| {
        Err(Failure::Usage(format!(
            "--{name} {value}: expected {expected}"
        )))
    };
    if !(0.0..=100.0).contains(&speed) {
        return told("v-mps", speed, "0 to 100 m/s");
    }
    if args.alpha_rad.is_nan() || args.alpha_rad.abs() > std::f64::consts::FRAC_PI_2 {
        return told(
            "alpha-rad",
            args.alpha_rad,
            "a slip angle in rad within a quarter turn",
        );
    }
    for (name, value) in [
        ("ice-c", args.ice_c.first().copied()),
        ("air-c", args.air_c),
    ] {
        if let Some(value) = value.filter(|v| !(-60.0..=60.0).contains(v)) {
            return told(name, value, "degrees Celsius, -60 to 60");
        }
    }
    if let Some(value) = args.air_pa.filter(|v| !(30e3..=120e3).contains(v)) {
        return told("air-pa", value, "an air pressure in Pa, 30000 to 120000");
    }
    if let Some(value) = args.humidity_pct.filter(|v| !(0.0..=100.0).contains(v)) {
        return told("humidity-pct", value, "0 to 100");
    }
    Ok(())
}

fn model(args: &Args) -> Result<(Longitudinal, Effects, f64), Failure> {
    let Some(path) = &args.model else {
        return Ok((Longitudinal::PUBLISHED, Effects::default(), f64::NAN));
    };
    let told =
        |error: &dyn std::fmt::Display| Failure::BadInput(format!("{}: {error}", path.display()));
    let model = Model::load(path).map_err(Failure::bad_input)?;
    let law = model.friction.longitudinal.model().map_err(|e| told(&e))?;
    let effects = Effects::from_tables(&model.effects).map_err(|e| told(&e))?;
    Ok((law, effects, model.sled.cda_m2))
}

fn operating_point(args: &Args, speed: f64, fz: f64, drag_area: f64) -> OperatingPoint {
    let known = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let conditions = Conditions {
        ice_c: known(args.ice_c.first().copied()),
        air_c: known(args.air_c),
        air_pa: known(args.air_pa),
        humidity_pct: known(args.humidity_pct),
        distance_m: 0.0,
        mass_kg: f64::NAN,
    };
    OperatingPoint {
        t: 0.0,
        s: 0.0,
        v: speed,
        fz,
        conditions,
        air_density: conditions.air_density(),
        drag_area,
        film: f64::NAN,
    }
}

/// The coefficient after every effect on it, the names of those, and of the model's others.
fn with_effects(
    base: f64,
    effects: &Effects,
    at: &OperatingPoint,
) -> Result<(f64, Vec<String>, Vec<String>), Failure> {
    let (mut mu, mut applied, mut ignored) = (base, Vec::new(), Vec::new());
    for active in &effects.active {
        let Some(with) = active.coefficient(mu, at) else {
            ignored.push(active.name.clone());
            continue;
        };
        if let Kind::Custom(own) = &active.kind
            && with.is_nan()
        {
            return Err(Failure::Usage(format!(
                "the model's effect {} needs {}: a condition is not given, or belongs to a run",
                active.name,
                own.names().join(", ")
            )));
        }
        for column in active.columns() {
            let missing = match column {
                "ice_c" => at.conditions.ice_c.is_nan().then_some("--ice-c"),
                "air_c" => at.conditions.air_c.is_nan().then_some("--air-c"),
                "air_pa" => at.conditions.air_pa.is_nan().then_some("--air-pa"),
                "humidity_pct" => at
                    .conditions
                    .humidity_pct
                    .is_nan()
                    .then_some("--humidity-pct"),
                "film" => Some("the tables of a sled's runners"),
                _ => None,
            };
            if let Some(option) = missing {
                return Err(Failure::Usage(format!(
                    "the model's effect {} needs {option}",
                    active.name
                )));
            }
        }
        mu = with;
        if mu.is_nan() {
            return Err(Failure::Usage(format!(
                "the model's effect {} needs --air-c and --air-pa",
                active.name
            )));
        }
        applied.push(active.name.clone());
    }
    Ok((mu, applied, ignored))
}
