//! Examples: what an effect makes of stated values.

/// Parameters, values and the number that the effect must give, by the names that the formulas use.
///
/// `mu` asks for the friction coefficient, `slope_rad` for the track's slope, the column of a sensor for what it reads,
/// `mass_kg` and its like for a constant of the sled; `fx_f_n`, `fx_r_n`, `fy_f_n`, `fy_r_n` are the forces on the
/// runners, `fx_n`, `fy_n`, `mz_nm` those on the body. A name with `_rate` is a derivative by time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Example {
    /// Parameters, as in [`Info::parameters`](crate::effects::Info::parameters).
    pub parameters: &'static [f64],
    /// What is known before; everything else is 0.
    pub given: &'static [(&'static str, f64)],
    /// What must come out.
    pub gives: (&'static str, f64),
}

impl Example {
    /// No example.
    pub(crate) const NEW: Example = Example {
        parameters: &[],
        given: &[],
        gives: ("", f64::NAN),
    };
}
