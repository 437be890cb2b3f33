//! Dependences on columns outside the catalogue.

use std::collections::BTreeMap;

use kufe_sled::effects::{Channel, Column, Custom, Expression, Level};

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::recordings::frame::further_columns;
use crate::evidence::runs::recordings::prepare::Data;
use crate::procedure::candidate::Candidate;

/// Dependences on single columns outside the catalogue: linear and quadratic terms of friction and
/// grip, and a side force.
///
/// Columns outside the model are carriers: they are tested, but simulations cannot use them.
pub fn unknown(data: &Data, mass: f64, along: bool) -> Vec<Candidate<Amplitude>> {
    let known = [
        ("v_mps", Column::Speed),
        ("fz_n", Column::Load),
        ("alpha_rad", Column::Slip),
        ("delta_rad", Column::Steering),
        ("gamma_rad", Column::RollSplit),
        ("roll_rate_radps", Column::RollRate),
        ("roll_acceleration_radps2", Column::RollRate),
        ("pitch_rate_radps", Column::PitchRate),
        ("t_s", Column::Time),
    ];
    let mut columns: Vec<(String, Option<String>)> = known
        .iter()
        .filter(|(_, column)| data.available.contains(column))
        .map(|(name, _)| ((*name).to_owned(), None))
        .collect();
    let carried = further_columns(&data.frames, true).into_iter();
    columns.extend(carried.map(|name| (name.clone(), Some(name))));
    let mut out = Vec::new();
    for (name, carrier) in columns {
        let Some((centre, scale)) = mean_and_sd(data, mass, &name) else {
            continue;
        };
        let x = Expression::quoted(&name);
        let z = format!("(({x} - {centre:.6e}) / {scale:.6e})");
        let size = format!("abs({x}) / {scale:.6e}");
        let mut forms = vec![
            (Channel::Grip, z.clone(), 0.02, ""),
            (Channel::Grip, format!("{z}^2"), 0.02, ""),
            (Channel::Lateral, format!("{x} / {scale:.6e}"), 10.0, "N"),
        ];
        if along {
            forms.push((Channel::Friction, z.clone(), 1e-4, ""));
            forms.push((Channel::Friction, format!("{z}^2"), 1e-4, ""));
        }
        if centre.abs() < scale {
            // For a column of both signs the absolute value is a separate form.
            forms.push((Channel::Grip, size.clone(), 0.02, ""));
            if along {
                forms.push((Channel::Friction, size, 1e-4, ""));
            }
        }
        for (channel, text, typical, unit) in forms {
            let Some(custom) = Custom::new(channel, &text, carrier.as_deref()) else {
                continue;
            };
            let limit = if channel == Channel::Lateral {
                1e5
            } else {
                10.0
            };
            let sizes = [typical, limit];
            out.push(Candidate::law(
                &[&name],
                custom,
                carrier.clone(),
                unit,
                sizes,
            ));
        }
    }
    out
}

/// Dependences of grip and friction on columns that differ from run to run only.
pub fn covariates(data: &Data, along: bool) -> Vec<Candidate<Amplitude>> {
    let mut out = Vec::new();
    for name in further_columns(&data.frames, false) {
        let Some((centre, scale)) = mean_and_sd(data, 1.0, &name) else {
            continue;
        };
        let mut of_session = BTreeMap::new();
        let varies_in_sessions = data.training().any(|frame| {
            let value = frame.extra[&name][0];
            *of_session.entry(&frame.session).or_insert(value) != value
        });
        let text = format!(
            "({} - {centre:.6e}) / {scale:.6e}",
            Expression::quoted(&name)
        );
        let grip = (Channel::Grip, 0.02);
        let friction = along.then_some((Channel::Friction, 1e-4));
        for (channel, typical) in [grip].into_iter().chain(friction) {
            let Some(custom) = Custom::new(channel, &text, Some(&name)) else {
                continue;
            };
            let mut law = Candidate::law(&[&name], custom, Some(name.clone()), "", [typical, 10.0]);
            law.act.level = if varies_in_sessions {
                Level::Run
            } else {
                Level::Session
            };
            out.push(law);
        }
    }
    out
}

/// Mean and standard deviation of a column over the training samples; `None` if it is not recorded
/// or constant. The load is approximated by mass times vertical acceleration.
fn mean_and_sd(data: &Data, mass: f64, name: &str) -> Option<(f64, f64)> {
    let mut all: Vec<f64> = Vec::new();
    for frame in data.training() {
        let column: &[f64] = match name {
            "v_mps" => &frame.v,
            "fz_n" => &frame.acceleration[2],
            "alpha_rad" => &frame.slip,
            "delta_rad" => &frame.steer,
            "gamma_rad" => &frame.roll_split,
            "roll_rate_radps" => &frame.rate[0],
            "pitch_rate_radps" => &frame.rate[1],
            "roll_acceleration_radps2" => &frame.rate_slope[0],
            "t_s" => &frame.t,
            other => frame.extra.get(other)?,
        };
        let unit = if name == "fz_n" { mass } else { 1.0 };
        all.extend(frame.samples().map(|i| unit * column[i]));
    }
    let n = all.len() as f64;
    let mean = all.iter().sum::<f64>() / n;
    let sd = (all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
    (sd > 0.0).then_some((mean, sd))
}
