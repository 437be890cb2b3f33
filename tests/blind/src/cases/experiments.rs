//! Cases made of friction experiments: a table of measured coefficients.

use std::fmt::Write as _;

use crate::cases::answer::{Answer, Case, Hides};
use crate::cases::label::Label;
use crate::residuals::least_squares::{cosine, dot, project_out};
use crate::world::noise::Source;

/// What an experiment can hide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Cause {
    Temperature,
    Speed,
    Load,
    Plowing,
    Humidity,
    Wear,
    DragArea,
    Headwind,
    AirDensity,
}

/// A cause with its name, parameter and first guess of size.
#[derive(Debug, Clone, Copy)]
pub struct CauseEntry {
    /// The cause.
    pub cause: Cause,
    /// Its name in reports.
    pub name: &'static str,
    key: &'static str,
    unit: &'static str,
    start: f64,
    limit: f64,
    both_signs: bool,
}

macro_rules! causes {
    ($($cause:ident $name:literal $key:literal $unit:literal $start:literal $limit:literal $both:literal;)*) => {
        /// All causes.
        pub const CAUSES: &[CauseEntry] = &[$(CauseEntry { cause: Cause::$cause, name: $name, key: $key,
            unit: $unit, start: $start, limit: $limit, both_signs: $both }),*];
    };
}

causes! {
    Temperature "temperature" "slope_per_k" "1/K" -0.02 0.15 true;
    Speed "speed" "exponent" "" -0.2 1.2 true;
    Load "load" "exponent" "" -0.2 0.9 true;
    Plowing "plowing" "coefficient" "" 0.001 0.015 false;
    Humidity "humidity" "slope_per_pct" "1/%" 0.01 0.04 true;
    Wear "wear" "slope_per_km" "1/km" 0.2 0.95 false;
    DragArea "drag-area" "cda_m2" "m2" 0.05 0.4 true;
    Headwind "headwind" "speed_mps" "m/s" 1.0 10.0 true;
    AirDensity "air-density" "factor" "" 0.2 0.45 true;
}

/// Ways to build a table.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub enum Recipe {
    SevenPoints,
    Null,
    Single(Cause),
}

/// The published table of seven specimens: name, mu, its deviation, peak pressure [MPa], its
/// deviation.
const PUBLISHED: [(&str, f64, f64, f64, f64); 7] = [
    ("Alpha 1", 0.0045, 0.0004, 7.7, 0.4),
    ("Alpha 2", 0.0038, 0.0004, 8.6, 0.5),
    ("Beta 1", 0.0042, 0.0004, 13.6, 0.7),
    ("Beta 2", 0.0046, 0.0004, 16.0, 0.9),
    ("Gamma 1", 0.0030, 0.0003, 10.9, 0.6),
    ("Gamma 2", 0.0027, 0.0003, 11.8, 0.6),
    ("Gamma 3", 0.0033, 0.0003, 9.6, 0.5),
];
const CDA_M2: f64 = 0.28;
/// Relative standard deviations of a measured coefficient and a computed pressure.
const MU_SD: f64 = 0.05;
const PRESSURE_SD: f64 = 0.02;

#[derive(Debug, Clone)]
struct Row {
    specimen: usize,
    session: usize,
    pressure_mpa: f64,
    fz_n: f64,
    v_mps: f64,
    ice_c: f64,
    air_c: f64,
    air_pa: f64,
    humidity_pct: f64,
    distance_m: f64,
}

/// `mu = 1e-3 (b p^2 - c p + d)`, p in MPa, at most 0.007.
fn base_mu(law: [f64; 3], p: f64) -> f64 {
    (1e-3 * (law[0] * p * p - law[1] * p + law[2])).min(0.007)
}

fn mu(law: [f64; 3], row: &Row, hidden: Option<(Cause, f64)>) -> f64 {
    let mu = base_mu(law, row.pressure_mpa);
    let Some((cause, k)) = hidden else { return mu };
    let density = row.air_pa / (287.05 * (row.air_c + 273.15));
    let v = row.v_mps;
    let air = |area: f64, speed: f64| 0.5 * density * area * speed * speed / row.fz_n;
    match cause {
        Cause::Temperature => mu * (1.0 + k * (row.ice_c + 5.0)),
        Cause::Speed => mu * (v / 25.0).powf(k),
        Cause::Load => mu * (row.fz_n / 1000.0).powf(k),
        Cause::Plowing => mu + k * (row.fz_n / 1000.0 * 14.7 / (14.7 - 0.6 * row.ice_c)).sqrt(),
        Cause::Humidity => mu * (1.0 + k * (row.humidity_pct - 70.0)),
        Cause::Wear => mu * (1.0 + k * row.distance_m / 1000.0),
        Cause::DragArea => mu + air(k, v),
        Cause::Headwind => mu + air(CDA_M2, v + k) - air(CDA_M2, v),
        Cause::AirDensity => mu + k * air(CDA_M2, v),
    }
}

/// Residual of the rows that a refit of `b, c, d` leaves, in units of each row's deviation.
fn signature(law: [f64; 3], rows: &[Row], cause: Cause, size: f64) -> Vec<f64> {
    let sd: Vec<f64> = rows.iter().map(|row| row_sd(law, row)).collect();
    let of = |f: &dyn Fn(&Row) -> f64| -> Vec<f64> {
        rows.iter().zip(&sd).map(|(r, s)| f(r) / s).collect()
    };
    let columns = [
        of(&|r| r.pressure_mpa.powi(2)),
        of(&|r| r.pressure_mpa),
        of(&|_| 1.0),
    ];
    let effect = of(&|r| mu(law, r, Some((cause, size))) - mu(law, r, None));
    project_out(&columns, &effect)
}

/// Standard deviation of a row's gap: of mu itself and of the law through the pressure.
fn row_sd(law: [f64; 3], row: &Row) -> f64 {
    let p = row.pressure_mpa;
    let slope = 1e-3 * (2.0 * law[0] * p - law[1]);
    (MU_SD * base_mu(law, p)).hypot(slope * PRESSURE_SD * p)
}

/// Builds a table with what the recipe hides, and its answer.
pub fn build(label: &Label, recipe: Recipe, seed: u64) -> Case {
    let source = &mut Source::new(seed, &label.id());
    let law = [0.088, 2.01, 14.66];
    let (table, hides) = match recipe {
        Recipe::SevenPoints => (published(), Vec::new()),
        Recipe::Null => (table(law, &draw(source), None, source), Vec::new()),
        Recipe::Single(cause) => {
            let entry = CAUSES
                .iter()
                .find(|e| e.cause == cause)
                .expect("every cause has a row");
            let rows = draw(source);
            let sign = if entry.both_signs { source.sign() } else { 1.0 };
            let mut size = sign * entry.start;
            let share_of = |size: f64| {
                let s = signature(law, &rows, cause, size);
                dot(&s, &s) / s.len() as f64
            };
            let wanted = label.share.unwrap_or(1.5);
            for _ in 0..6 {
                size = (size * (wanted / share_of(size)).sqrt()).clamp(-entry.limit, entry.limit);
            }
            let own = signature(law, &rows, cause, size);
            let class = CAUSES
                .iter()
                .filter(|other| other.cause != cause)
                .filter(|other| {
                    cosine(&own, &signature(law, &rows, other.cause, other.start)).abs() >= 0.9
                })
                .map(|other| other.name.to_owned())
                .collect();
            let hides = Hides {
                effect: entry.name.to_owned(),
                class,
                key: entry.key.to_owned(),
                size,
                unit: entry.unit.to_owned(),
                share: share_of(size),
                places: Vec::new(),
            };
            (table(law, &rows, Some((cause, size)), source), vec![hides])
        }
    };
    let b = (
        law[0] * (1.0 + 0.01 * source.normal()),
        law[1] * (1.0 + 0.005 * source.normal()),
    );
    let law_stated = if recipe == Recipe::SevenPoints {
        law
    } else {
        [b.0, b.1, law[2]]
    };
    Case {
        files: vec![
            ("experiments.csv".to_owned(), table.into_bytes()),
            ("model.toml".to_owned(), model(law_stated).into_bytes()),
        ],
        fresh: Vec::new(),
        answer: Answer {
            family: label.family.to_owned(),
            name: label.name.clone(),
            wanted_share: label.share,
            seed,
            data: "experiments.csv".to_owned(),
            model: Some("model.toml".to_owned()),
            hides,
            tolerated: Vec::new(),
            too_little_to_name: false,
            base: Vec::new(),
        },
    }
}

/// A table of runners whose friction does not go by pressure, with what is hidden in it.
pub fn constant(mu: f64, hidden: Option<(Cause, f64)>, source: &mut Source) -> String {
    table([0.0, 0.0, 1e3 * mu], &draw(source), hidden, source)
}

/// Eight specimens in each of ten sessions, two of them at another load and speed.
fn draw(source: &mut Source) -> Vec<Row> {
    let mut rows = Vec::new();
    for session in 1..=10 {
        let ice_c = source.uniform(-12.0, -1.0);
        let air_c = ice_c + source.uniform(1.0, 8.0);
        let air_pa = source.uniform(92_000.0, 101_500.0);
        let humidity_pct = source.uniform(45.0, 95.0);
        let mut order: Vec<usize> = (0..8).collect();
        source.shuffle(&mut order);
        for (turn, specimen) in order.into_iter().enumerate() {
            let fz_n = [600.0, 900.0, 1300.0, 1800.0][(source.uniform(0.0, 4.0) as usize).min(3)];
            rows.push(Row {
                specimen,
                session,
                pressure_mpa: (6.5 + 1.35 * specimen as f64) * (fz_n / 1000.0_f64).powf(0.1),
                fz_n,
                v_mps: source.uniform(4.0, 16.0),
                ice_c: ice_c + 0.1 * source.normal(),
                air_c,
                air_pa,
                humidity_pct,
                distance_m: 150.0 * turn as f64,
            });
        }
    }
    rows
}

fn table(law: [f64; 3], rows: &[Row], hidden: Option<(Cause, f64)>, source: &mut Source) -> String {
    let mut text = String::from(
        "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd,session,fz_n,v_mps,ice_c,air_c,humidity_pct,air_pa,distance_m\n",
    );
    for row in rows {
        let sd = MU_SD * base_mu(law, row.pressure_mpa);
        let measured = mu(law, row, hidden) + sd * source.normal();
        let pressure = row.pressure_mpa * (1.0 + PRESSURE_SD * source.normal()) * 1e6;
        let _ = writeln!(
            text,
            "S{},{pressure:.0},{:.0},{measured:.7},{sd:.7},{},{},{:.3},{:.2},{:.2},{:.1},{:.0},{:.1}",
            row.specimen + 1,
            PRESSURE_SD * row.pressure_mpa * 1e6,
            row.session,
            row.fz_n,
            row.v_mps + 0.05 * source.normal(),
            row.ice_c + 0.1 * source.normal(),
            row.air_c,
            row.humidity_pct,
            row.air_pa,
            row.distance_m
        );
    }
    text
}

fn published() -> String {
    let mut text = String::from("specimen,p_max_pa,p_max_sd_pa,mu,mu_sd\n");
    for (name, mu, mu_sd, p, p_sd) in PUBLISHED {
        let _ = writeln!(text, "{name},{:?},{:?},{mu},{mu_sd}", p * 1e6, p_sd * 1e6);
    }
    text
}

fn model(law: [f64; 3]) -> String {
    format!(
        "[sled]\nmass_kg = 105.0\nj_yy_kgm2 = 10.0\nj_zz_kgm2 = 10.0\nl_f_m = 0.3\nl_r_m = 0.3\n\
         accel_x_m = 0.0\naccel_y_m = 0.0\naccel_z_m = 0.0\nslip_x_m = 0.0\ncda_m2 = {CDA_M2}\nyaw_drag_per_deg = 0.0694\n\n\
         [friction.longitudinal]\nb = {:.6}\nc = {:.6}\nd = {:.6}\nmu_cap = 0.007\nzeta = 1.0\nzeta_acts_on = \"mu\"\n\n\
         [friction.front]\nmu_zeta = 2.577\nc = 0.024\ne = 0.99\nk_n_per_rad = 10522.0\n\n\
         [friction.rear]\nmu_zeta = 3.288\nc = 0.076\ne = 0.99\nk_n_per_rad = 49776.0\n",
        law[0], law[1], law[2]
    )
}
