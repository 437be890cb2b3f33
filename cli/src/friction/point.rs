//! Friction of one runner under one load: the contact is solved and its peak pressure inserted into
//! the law.

use std::path::PathBuf;

use kufe::jobs::simulate::stated_conditions;
use kufe::jobs::{DrivingConditions, Failure, FrictionLaw, case_file::LoadedCase};
use kufe::results::FrictionByLaw;

use crate::friction::request::Request;
use crate::terminal::Global;

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
    /// Ice temperature [degrees Celsius], for effects that need it; with --groove one or several,
    /// as -10,-5,-1
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub ice_c: Vec<f64>,
    /// Friction of the groove that the runner ploughs and of the melt film in it, over all speeds
    /// and temperatures of the ice, instead of a law over the pressure
    #[arg(long, conflicts_with_all = BY_LAW)]
    pub groove: bool,
    /// With --groove, one speed and one case: the runner with the least friction, by one or two
    /// numbers of its shape within bounds, as rocker_radius_m=15:60,section_radius_m=0.004:0.008
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
    /// Model of the sled and its friction, whose [friction.longitudinal] and [effects] apply; the
    /// published law where absent
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
    /// Checks that the options given are complete.
    ///
    /// # Errors
    /// [`Failure::Usage`] with what is missing, why, and what to give.
    pub fn check_complete(&self) -> Result<(), Failure> {
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
        let table = tables.iter().find(|(requested, _)| *requested);
        if let (false, Some((_, why))) = (self.groove, table) {
            missing.push(format!("--groove is missing: {why}"));
        }
        if (self.groove || table.is_some()) && self.ice_c.is_empty() {
            let how = "give the temperature of the ice in degrees Celsius, as --ice-c -5, or several as --ice-c -10,-5,-1";
            missing.push(format!("--ice-c is missing: {how}"));
        }
        if missing.is_empty() {
            Ok(())
        } else {
            Err(Failure::Usage(missing.join("\n")))
        }
    }

    /// The table over speed and temperature, where one is requested.
    pub fn sliding(&self) -> Option<Request<'_>> {
        self.groove.then_some(Request {
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
    let conditions = DrivingConditions {
        v_mps: speed,
        alpha_rad: args.alpha_rad,
        conditions: stated_conditions([
            args.ice_c.first().copied(),
            args.air_c,
            args.air_pa,
            args.humidity_pct,
            None,
            None,
        ])?,
    };
    let law = match &args.model {
        Some(path) => FrictionLaw::of_model(path)?,
        None => FrictionLaw::published(),
    };
    let loaded = LoadedCase::read(path)?;
    let result = global.watched(|watch| law.solve(&loaded, &conditions, watch))?;
    global.answer(&result, || text(&result))
}

fn text(result: &FrictionByLaw) -> String {
    let mut text = format!(
        "peak pressure  {:.3} MPa +- {:.3}\nnormal force   {:.1} N\nmu             {:.3}e-3 +- {:.3}e-3 (by the pressure's error)\nforce          {:.3} N along the runner, at a slip angle of {} rad\npower          {:.1} W lost at {} m/s\n",
        result.p_max.value * 1e-6,
        result.p_max.error * 1e-6,
        result.fz_n,
        result.mu * 1e3,
        result.mu_error * 1e3,
        result.fx_n,
        result.alpha_rad,
        -result.power_w,
        result.v_mps,
    );
    if result.capped {
        text += "the pressure is outside those of the fit of the law: this is its largest mu\n";
    }
    let (applied, ignored) = (&result.effects, &result.effects_not_concerned);
    if !applied.is_empty() {
        text += &format!(
            "effects        {} (mu before them {:.3}e-3)\n",
            applied.join(", "),
            result.mu_base * 1e3
        );
    }
    if !ignored.is_empty() {
        text += &format!("not of the friction coefficient: {}\n", ignored.join(", "));
    }
    text
}
