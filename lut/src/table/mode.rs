//! The modes of interpolation.

/// How values between the nodes are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Piecewise bilinear on the table's own axes and values, as Simulink's n-D Lookup Table computes it with
    /// "linear point-slope", "clip" and "use last table value" (MathWorks guideline jc_0626).
    Bilinear,
    /// C1 and monotone where the data are: bicubic Hermite patches of the logarithm of the quantity over
    /// the logarithm of the force and the (reduced) curvature.
    Smooth,
}

impl Mode {
    /// Both modes.
    pub const ALL: [Mode; 2] = [Mode::Bilinear, Mode::Smooth];

    /// Name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Bilinear => "bilinear",
            Mode::Smooth => "smooth",
        }
    }
}
