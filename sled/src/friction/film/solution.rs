//! What the film along a strip is, and what it adds up to.

/// The film at one station of the strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmStation {
    /// Distance from the leading edge [m].
    pub xi: f64,
    /// Width of the strip [m].
    pub width: f64,
    /// Pressure averaged over the width [Pa].
    pub pressure: f64,
    /// Thickness of the film [m].
    pub thickness: f64,
    /// Discretisation error of the thickness [m].
    pub thickness_error: f64,
    /// Temperature of film and ice surface: the melting point under the pressure [C].
    pub temperature: f64,
    /// Ice that melts, as the depth that it loses, negative where the film freezes [m/s].
    pub melt_rate: f64,
    /// Shear stress in the film [Pa].
    pub shear: f64,
    /// Heat into the ice [W/m2].
    pub heat_into_ice: f64,
    /// Heat into the steel [W/m2].
    pub heat_into_steel: f64,
}

/// The film summed over the strip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmTotals {
    /// Load that the strip carries [N].
    pub load: f64,
    /// Area of the strip [m2].
    pub area: f64,
    /// Drag of the sheared film [N].
    pub viscous_drag: f64,
    /// Drag over load, dimensionless.
    pub friction: f64,
    /// Power that the film's shear takes: drag times speed [W].
    pub dissipated: f64,
    /// Power that goes into the ice [W].
    pub into_ice: f64,
    /// Power that goes into the steel [W].
    pub into_steel: f64,
    /// Ice that melts, where it does [kg/s].
    pub melted: f64,
    /// Water that freezes again, where it does [kg/s].
    pub refrozen: f64,
    /// Water that is squeezed out sideways [m3/s].
    pub squeezed_out: f64,
    /// Thickness averaged over the area [m].
    pub mean_thickness: f64,
}

impl FilmTotals {
    /// Field by field.
    pub(crate) fn combined(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        FilmTotals {
            load: f(self.load, other.load),
            area: f(self.area, other.area),
            viscous_drag: f(self.viscous_drag, other.viscous_drag),
            friction: f(self.friction, other.friction),
            dissipated: f(self.dissipated, other.dissipated),
            into_ice: f(self.into_ice, other.into_ice),
            into_steel: f(self.into_steel, other.into_steel),
            melted: f(self.melted, other.melted),
            refrozen: f(self.refrozen, other.refrozen),
            squeezed_out: f(self.squeezed_out, other.squeezed_out),
            mean_thickness: f(self.mean_thickness, other.mean_thickness),
        }
    }

    /// Absolute differences, field by field.
    pub(crate) fn difference(&self, other: &Self) -> Self {
        self.combined(other, |a, b| (a - b).abs())
    }

    /// The largest of these errors of `value`, relative to it; those of heat and water, which may be small differences, relative to
    /// the power that is dissipated and to the water that it would melt, `heat_of_ice` [J/kg] and `heat_of_water` [J/m3].
    pub(crate) fn largest_share(&self, value: &Self, heat_of_ice: f64, heat_of_water: f64) -> f64 {
        let power = value.dissipated;
        // Ahead of the first pressure no load is carried, without an error.
        let over = |error: f64, value: f64| if error == 0.0 { 0.0 } else { error / value };
        [
            over(self.load, value.load),
            over(self.area, value.area),
            over(self.viscous_drag, value.viscous_drag),
            over(self.mean_thickness, value.mean_thickness),
            over(self.into_ice, power),
            over(self.into_steel, power),
            over(self.melted * heat_of_ice, power),
            over(self.refrozen * heat_of_ice, power),
            over(self.squeezed_out * heat_of_water, power),
        ]
        .into_iter()
        .fold(0.0, |largest, share| {
            // A share that is no number must not pass for a small one.
            if share <= largest { largest } else { share }
        })
    }
}

/// The melt film along a strip.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// The film by stations of the strip, without the leading edge, where thickness is 0 and shear without bound.
    pub stations: Vec<FilmStation>,
    /// What it adds up to.
    pub totals: FilmTotals,
    /// Discretisation error of each total: its change when every step of the integration is halved.
    pub errors: FilmTotals,
    /// Change of each total on every second station of the strip, `None` below four: how far the stations resolve the patch.
    pub sampling: Option<FilmTotals>,
    /// Steps of the integration.
    pub steps: usize,
}

impl Film {
    /// The station with the thickest film.
    pub fn thickest(&self) -> Option<&FilmStation> {
        self.stations
            .iter()
            .max_by(|a, b| a.thickness.total_cmp(&b.thickness))
    }

    /// The station with the thinnest film: what roughness has to be compared with.
    pub fn thinnest(&self) -> Option<&FilmStation> {
        self.stations
            .iter()
            .min_by(|a, b| a.thickness.total_cmp(&b.thickness))
    }
}
