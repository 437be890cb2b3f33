//! Gliding runs on a flat rink: the index, and speed over time of each run.

use std::io::Read;

use crate::friction::error::Error;
use crate::friction::tables::experiments::{AIR_PRESSURE, CELSIUS, air_pressure, celsius};
use crate::friction::tables::table::{Columns, Extra, Table};

/// One row of `glides.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct GlideEntry {
    /// Name of the run.
    pub run: String,
    /// File of the run, relative to the index.
    pub file: String,
    /// Specimen on the sled.
    pub specimen: String,
    /// Direction of travel, one of two labels.
    pub direction: String,
    /// Mass of sled and athlete [kg].
    pub mass_kg: f64,
    /// Drag area [m2].
    pub cda_m2: f64,
    /// Air temperature [degrees Celsius].
    pub air_c: f64,
    /// Air pressure [Pa].
    pub air_pa: f64,
    /// Session of the measurement.
    pub session: Option<String>,
    /// Ice temperature [degrees Celsius].
    pub ice_c: Option<f64>,
    /// Relative humidity [%].
    pub humidity_pct: Option<f64>,
    /// Rocker radius of the specimen [m].
    pub rocker_radius_m: Option<f64>,
    /// Peak pressure of the specimen [Pa].
    pub p_max_pa: Option<f64>,
    /// Standard deviation of the peak pressure [Pa].
    pub p_max_sd_pa: Option<f64>,
}

/// Speed over time of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct GlideTrace {
    /// Time [s], increasing.
    pub t: Vec<f64>,
    /// Speed [m/s].
    pub v: Vec<f64>,
    /// Distance [m]; measured, or integrated from the speed.
    pub s: Vec<f64>,
    /// Whether the distance was measured.
    pub s_measured: bool,
}

const INDEX: Columns = Columns {
    required: &[
        "run",
        "file",
        "specimen",
        "direction",
        "mass_kg",
        "cda_m2",
        "air_c",
        "air_pa",
    ],
    optional: &[
        "session",
        "ice_c",
        "humidity_pct",
        "rocker_radius_m",
        "p_max_pa",
        "p_max_sd_pa",
    ],
    extra: Extra::Refused,
};

const TRACE: Columns = Columns {
    required: &["t_s", "v_mps"],
    optional: &["s_m"],
    extra: Extra::Kept,
};

/// By how much a measured way and the integral of the speed may be apart: twice what a wheel or a radar is off by at worst, and
/// far from knots (1.9), mph (2.2) and km/h (3.6).
const MOST_APART: f64 = 1.25;

/// Reads the index `glides.csv`; `file` is the name that errors carry.
///
/// # Errors
/// [`Error::MissingColumn`], [`Error::UnknownColumn`], [`Error::BadValue`]; two runs of one name or one file, more than two
/// directions and an empty table count as bad values.
pub fn read_glide_index(file: &str, reader: impl Read) -> Result<Vec<GlideEntry>, Error> {
    let table = Table::read(file, reader, &INDEX)?;
    let mut entries: Vec<GlideEntry> = Vec::new();
    let mut directions: Vec<String> = Vec::new();
    for row in 0..table.rows() {
        let run = table.name(row, "run")?;
        if entries.iter().any(|entry| entry.run == run) {
            return Err(table.bad(row, "run", &run, "a name that no run before has"));
        }
        let own = table.name(row, "file")?;
        if let Some(before) = entries.iter().find(|entry| entry.file == own) {
            let expected = format!("a file of its own: run {} has this one", before.run);
            return Err(table.bad(row, "file", &own, &expected));
        }
        let direction = table.name(row, "direction")?;
        if !directions.contains(&direction) {
            directions.push(direction.clone());
        }
        if directions.len() > 2 {
            let two = format!("{} or {}", directions[0], directions[1]);
            return Err(table.bad(row, "direction", &direction, &two));
        }
        let positive = |v: f64| v > 0.0;
        entries.push(GlideEntry {
            run,
            file: own,
            specimen: table.name(row, "specimen")?,
            direction,
            mass_kg: table.number(
                row,
                "mass_kg",
                |v| (1.0..=2000.0).contains(&v),
                "a mass in kg, 1 to 2000",
            )?,
            cda_m2: table.number(
                row,
                "cda_m2",
                |v| (0.0..=5.0).contains(&v),
                "a drag area in m2, 0 to 5",
            )?,
            air_c: table.number(row, "air_c", celsius, CELSIUS)?,
            air_pa: table.number(row, "air_pa", air_pressure, AIR_PRESSURE)?,
            session: table
                .text(row, "session")
                .filter(|text| !text.is_empty())
                .map(str::to_string),
            ice_c: table.optional(row, "ice_c", celsius, CELSIUS)?,
            humidity_pct: table.optional(
                row,
                "humidity_pct",
                |v| (0.0..=100.0).contains(&v),
                "a relative humidity in %, 0 to 100",
            )?,
            rocker_radius_m: table.optional(
                row,
                "rocker_radius_m",
                positive,
                "a radius in m, positive",
            )?,
            p_max_pa: table.optional(
                row,
                "p_max_pa",
                |v| (1e4..1e11).contains(&v),
                "a pressure in Pa (7.7e6)",
            )?,
            p_max_sd_pa: table.optional(
                row,
                "p_max_sd_pa",
                |v| v >= 0.0,
                "a standard deviation in Pa, 0 or more",
            )?,
        });
    }
    if entries.is_empty() {
        return Err(Error::TooFew {
            what: format!("{file}: runs"),
            have: 0,
            need: 2,
        });
    }
    Ok(entries)
}

/// Reads the speed of one run; the distance is integrated by the trapezoidal rule where `s_m` is absent.
///
/// # Errors
/// [`Error::MissingColumn`]; [`Error::BadValue`] for cells that are no numbers, time that does not increase, a gap of more
/// than ten usual steps, speeds beyond 60 m/s or whose integral is not `s_m`; [`Error::TooFew`] below thirty samples.
pub fn read_glide(file: &str, reader: impl Read) -> Result<GlideTrace, Error> {
    const FEWEST: usize = 30;
    let table = Table::read(file, reader, &TRACE)?;
    if table.rows() < FEWEST {
        return Err(Error::TooFew {
            what: format!("{file}: samples"),
            have: table.rows(),
            need: FEWEST,
        });
    }
    let column = |name: &'static str, fits: fn(f64) -> bool, expected: &'static str| {
        (0..table.rows())
            .map(|row| table.number(row, name, fits, expected))
            .collect::<Result<Vec<f64>, Error>>()
    };
    let t = column("t_s", |_| true, "a time in s")?;
    let speed = |v: f64| (-2.0..=60.0).contains(&v);
    let v = column("v_mps", speed, "a speed in m/s, up to 60")?;
    let steps: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if let Some(at) = steps.iter().position(|step| *step <= 0.0) {
        let before = format!("a time after {} s", t[at]);
        return Err(table.bad(at + 1, "t_s", &t[at + 1].to_string(), &before));
    }
    let usual = *steps
        .clone()
        .select_nth_unstable_by(t.len() / 2 - 1, f64::total_cmp)
        .1;
    if let Some(at) = steps.iter().position(|step| *step > 10.0 * usual) {
        let expected = format!(
            "no gap: steps are usually {usual:.4} s, this is {:.4} s",
            steps[at]
        );
        return Err(table.bad(at + 1, "t_s", &t[at + 1].to_string(), &expected));
    }
    let s_measured = table.header().iter().any(|name| name == "s_m");
    let s = if s_measured {
        let s = column("s_m", |_| true, "a distance in m")?;
        if let Some(at) = s.windows(2).position(|pair| pair[1] < pair[0] - 0.05) {
            let expected = format!("a distance not below {} m", s[at]);
            return Err(table.bad(at + 1, "s_m", &s[at + 1].to_string(), &expected));
        }
        let (way, of_speed) = (s[s.len() - 1] - s[0], integrate(&t, &v)[t.len() - 1]);
        if !(1.0 / MOST_APART..=MOST_APART).contains(&(of_speed / way)) {
            let expected = format!(
                "speeds in m/s whose integral is the way: it is {of_speed:.1} m, s_m grows by {way:.1} m, {:.2} times less (3.6: km/h)",
                of_speed / way
            );
            return Err(table.bad(0, "v_mps", &v[0].to_string(), &expected));
        }
        s
    } else {
        integrate(&t, &v)
    };
    Ok(GlideTrace {
        t,
        v,
        s,
        s_measured,
    })
}

/// Running integral of `y` over `x` by the trapezoidal rule, starting at 0.
pub(crate) fn integrate(x: &[f64], y: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut out = vec![0.0];
    for i in 1..x.len() {
        sum += 0.5 * (y[i] + y[i - 1]) * (x[i] - x[i - 1]);
        out.push(sum);
    }
    out
}
