//! What values say of a unit that nothing states.

/// What values say.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Said {
    /// A unit, and why.
    Unit(&'static str, String),
    /// Units that it may be, and why that cannot be told.
    Open(&'static [&'static str], String),
}

/// Middle and largest magnitude of the finite values; `None` where there are none.
pub(crate) fn extent(values: &[f64]) -> Option<[f64; 2]> {
    let mut finite: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    if finite.is_empty() {
        return None;
    }
    let middle = finite.len() / 2;
    let median = *finite.select_nth_unstable_by(middle, f64::total_cmp).1;
    let largest = finite.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    Some([median, largest])
}

/// The unit of a column's values by their size: a body at rest feels 9.81 m/s2, no sled or car exceeds 70 m/s or turns by 12 rad/s.
pub(crate) fn unit_by_values(column: &str, values: &[f64]) -> Option<Said> {
    let [median, largest] = extent(values)?;
    let by_largest = format!("largest magnitude {largest:.4}");
    Some(match column {
        "az_mps2" => match median.abs() {
            m if (0.7..1.4).contains(&m) => {
                Said::Unit("g", format!("median {median:.3}, that of gravity in g"))
            }
            m if (7.0..14.0).contains(&m) => Said::Unit(
                "m/s^2",
                format!("median {median:.3}, that of gravity in m/s2"),
            ),
            _ => Said::Open(
                &["g", "m/s^2"],
                format!("median {median:.3} is gravity's in no unit"),
            ),
        },
        "ax_mps2" | "ay_mps2" if largest > 8.0 => Said::Unit("m/s^2", by_largest),
        "ax_mps2" | "ay_mps2" => Said::Open(&["g", "m/s^2"], by_largest),
        "v_mps" if largest > 70.0 => Said::Unit("km/h", format!("{by_largest}, too fast for m/s")),
        "v_mps" => Said::Open(&["m/s", "km/h", "mph", "knots"], by_largest),
        "roll_rate_radps" | "pitch_rate_radps" | "yaw_rate_radps" => match largest {
            l if l > 12.0 => Said::Unit("deg/s", format!("{by_largest}, too fast for rad/s")),
            l if l < 3.0 => Said::Unit(
                "rad/s",
                format!("{by_largest}, too slow for deg/s in a curve"),
            ),
            _ => Said::Open(&["deg/s", "rad/s"], by_largest),
        },
        "alpha_rad" | "delta_rad" | "gamma_rad" => match largest {
            l if l > 0.6 => Said::Unit("deg", format!("{by_largest}, too large for rad")),
            _ => Said::Open(&["rad", "deg"], by_largest),
        },
        _ => Said::Open(&["m", "km"], by_largest),
    })
}

/// The unit of a time by its usual step, if it is a time: it never falls.
pub(crate) fn time_unit(values: &[f64]) -> Option<Said> {
    let finite: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    let mut steps: Vec<f64> = finite.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.is_empty() || steps.iter().any(|step| *step < 0.0) {
        return None;
    }
    steps.retain(|step| *step > 0.0);
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let told = format!("usual step {median}");
    Some(match median {
        m if m < 0.6 => Said::Unit("s", format!("{told}: {:.0} Hz", 1.0 / m)),
        m if (1000.0..1e6).contains(&m) => Said::Unit("us", format!("{told}: {:.0} Hz", 1e6 / m)),
        m if m.fract() == 0.0 && m < 1000.0 => {
            Said::Unit("ms", format!("{told}: {:.0} Hz", 1e3 / m))
        }
        _ => Said::Open(&["s", "ms", "us"], told),
    })
}
