//! Dependences on columns outside the catalogue.

use std::collections::BTreeMap;

use kufe_sled::effects::{Channel, Column, Custom, Expression, Level};

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::recordings::frame::{Frame, further_columns};
use crate::evidence::runs::recordings::prepare::Data;
use crate::procedure::candidate::Candidate;

/// A column of the model: its name, the recorded column that it needs, and its samples.
type KnownColumn = (&'static str, Column, fn(&Frame) -> &[f64]);

/// Columns of the model that friction and grip may depend on.
const KNOWN: [KnownColumn; 9] = [
    ("v_mps", Column::Speed, |f| &f.v),
    ("fz_n", Column::Load, |f| &f.acceleration[2]),
    ("alpha_rad", Column::Slip, |f| &f.slip),
    ("delta_rad", Column::Steering, |f| &f.steer),
    ("gamma_rad", Column::RollSplit, |f| &f.roll_split),
    ("roll_rate_radps", Column::RollRate, |f| &f.rate[0]),
    ("roll_acceleration_radps2", Column::RollRate, |f| {
        &f.rate_slope[0]
    }),
    ("pitch_rate_radps", Column::PitchRate, |f| &f.rate[1]),
    ("t_s", Column::Time, |f| &f.t),
];

/// Dependences on single columns outside the catalogue: linear and quadratic terms of friction and
/// grip, and a side force.
///
/// Columns outside the model are carriers: they are tested, but simulations cannot use them.
pub fn unknown(data: &Data, mass: f64, along: bool) -> Vec<Candidate<Amplitude>> {
    let known = KNOWN.iter().filter(|(_, c, _)| data.available.contains(c));
    let known = known.map(|(name, _, of)| {
        // The load is approximated by mass times vertical acceleration.
        let unit = if *name == "fz_n" { mass } else { 1.0 };
        (
            (*name).to_owned(),
            None,
            mean_and_sd(data, |f| Some(of(f)), unit),
        )
    });
    let carried = further_columns(&data.frames, true).into_iter();
    let carried = carried.map(|name| {
        let moments = mean_and_sd(data, |f| f.extra.get(&name).map(Vec::as_slice), 1.0);
        (name.clone(), Some(name), moments)
    });
    let mut out = Vec::new();
    for (name, carrier, moments) in known.chain(carried) {
        let Some((centre, scale)) = moments else {
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
            let is_force = channel == Channel::Lateral;
            let sizes = [typical, if is_force { 1e5 } else { 10.0 }];
            let law = Candidate::law(&[&name], custom, carrier.clone(), unit, sizes);
            out.push(law);
        }
    }
    out
}

/// Dependences of grip and friction on columns that differ from run to run only.
pub fn covariates(data: &Data, along: bool) -> Vec<Candidate<Amplitude>> {
    let mut out = Vec::new();
    for name in further_columns(&data.frames, false) {
        let Some((centre, scale)) =
            mean_and_sd(data, |f| f.extra.get(&name).map(Vec::as_slice), 1.0)
        else {
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

/// Mean and standard deviation of a column over the training samples, in units of `1 / unit`;
/// `None` if it is not recorded or constant.
fn mean_and_sd(
    data: &Data,
    column: impl Fn(&Frame) -> Option<&[f64]>,
    unit: f64,
) -> Option<(f64, f64)> {
    let mut all: Vec<f64> = Vec::new();
    for frame in data.training() {
        let column = column(frame)?;
        all.extend(frame.samples().map(|i| unit * column[i]));
    }
    let n = all.len() as f64;
    let mean = all.iter().sum::<f64>() / n;
    let sd = (all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
    (sd > 0.0).then_some((mean, sd))
}
