//! Friction of one runner under one load: the contact is solved and its peak pressure inserted into
//! the law.

use std::path::PathBuf;

use kufe::jobs::simulate::stated_conditions;
use kufe::jobs::{DrivingConditions, Failure, FrictionLaw, case_file::LoadedCase};

use crate::output::{OutputDir, case_inputs};
use crate::terminal::Global;
use crate::text::document_text;

/// Options that apply only to the pressure-dependent friction law.
const BY_LAW: [&str; 5] = ["alpha_rad", "model", "air_c", "air_pa", "humidity_pct"];

/// Arguments of `kufe friction CASE`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case; with --groove several, side by side
    #[arg(required = true, value_name = "CASE")]
    pub cases: Vec<PathBuf>,
    /// Speed [m/s], always needed; with --groove one or several, as 5,20,35
    #[arg(long, value_name = "LIST")]
    #[arg(value_delimiter = ',', allow_negative_numbers = true)]
    pub v_mps: Vec<f64>,
    /// Ice temperature [degrees Celsius], for effects that need it; with --groove one or several,
    /// as -10,-5,-1
    #[arg(long, value_name = "LIST")]
    #[arg(value_delimiter = ',', allow_hyphen_values = true)]
    pub ice_c: Vec<f64>,
    /// Friction of the groove that the runner ploughs and of the melt film in it, for all speeds
    /// and temperatures of the ice, instead of the pressure-dependent law
    #[arg(long, conflicts_with_all = BY_LAW)]
    pub groove: bool,
    /// With --groove, one speed and one case: find the shape with the least friction over one or
    /// two parameters within bounds, as rocker_radius_m=15:60,section_radius_m=0.005:0.008
    #[arg(long, value_name = "KEY=LOW:HIGH", value_delimiter = ',')]
    pub optimise: Vec<String>,
    /// With --groove: folder for friction.csv, friction.json and friction.png
    #[arg(long, short, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// Slip angle [rad]
    #[arg(long, value_name = "RAD")]
    #[arg(default_value_t = 0.0, allow_negative_numbers = true)]
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
        let table = match (self.out.is_some(), self.optimise.is_empty()) {
            (true, _) => Some("-o writes friction over speed and temperature of the ice"),
            (_, false) => Some("--optimise compares runners on ice of one temperature"),
            _ => None,
        };
        let mut missing = Vec::new();
        if self.v_mps.is_empty() {
            missing.push("--v-mps is missing: give the speed in m/s, as --v-mps 30".to_owned());
        }
        if let Some(why) = table.filter(|_| !self.groove) {
            missing.push(format!("--groove is missing: {why}"));
        }
        if (self.groove || table.is_some()) && self.ice_c.is_empty() {
            missing.push(
                "--ice-c is missing: give the temperature of the ice in degrees Celsius, as --ice-c -5, or several as --ice-c -10,-5,-1"
                    .to_owned(),
            );
        }
        if missing.is_empty() {
            return Ok(());
        }
        Err(Failure::Usage(missing.join("\n")))
    }

    /// The output folder, if one is requested; it is checked before anything is solved.
    ///
    /// # Errors
    /// As [`OutputDir::begin`].
    pub fn output(
        &self,
        cases: &[LoadedCase],
        global: &Global,
    ) -> Result<Option<OutputDir>, Failure> {
        let Some(out) = &self.out else {
            return Ok(None);
        };
        let mut inputs = Vec::new();
        for (path, loaded) in self.cases.iter().zip(cases) {
            inputs.extend(case_inputs(Some(path), loaded)?);
        }
        OutputDir::begin("friction", &inputs, out, global.force).map(Some)
    }
}

/// Solves and prints.
///
/// # Errors
/// [`Failure::Usage`] for numbers out of range, [`Failure::BadInput`] for the files,
/// [`Failure::NotConverged`] if the solver stops short.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let ([path], &[speed], &([] | [_])) = (&args.cases[..], &args.v_mps[..], &args.ice_c[..])
    else {
        let text = "expected one case, one --v-mps and one --ice-c; several go with --groove";
        return Err(Failure::Usage(text.into()));
    };
    let conditions = DrivingConditions {
        v_mps: speed,
        alpha_rad: args.alpha_rad,
        environment: stated_conditions([
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
    let mut text = document_text(&result)?;
    if result.capped {
        text += "mu is capped: the pressure is outside the range that the law was fitted to\n";
    }
    global.answer(&result, || text)
}
