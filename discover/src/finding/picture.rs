//! Pictures of a report, as data.

use serde::Serialize;

/// A picture for the page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Picture {
    /// What it shows.
    pub title: String,
    /// What its marks mean; empty where its key says it.
    pub caption: String,
    /// What is drawn.
    pub plot: Plot,
}

/// What a picture draws.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Plot {
    /// Points over one column.
    Scatter {
        /// What it is called for those who do not see it.
        label: String,
        /// Column of `x`, whose suffix tells the unit.
        x_name: String,
        /// What the points are, with unit.
        y_name: String,
        /// Places along the column.
        x: Vec<f64>,
        /// Points at all places.
        series: Vec<Series>,
        /// A curve through them; a line at 0 where there is none.
        #[serde(skip_serializing_if = "Option::is_none")]
        curve: Option<Curve>,
    },
    /// What is left along a track, run by run, before and after.
    Strip {
        /// Channel.
        channel: String,
        /// Its unit.
        unit: String,
        /// Track.
        track: String,
        /// Where the first stretch begins [m].
        from_m: f64,
        /// Length of a stretch [m].
        step_m: f64,
        /// Where effects were found.
        places: Vec<Place>,
        /// The runs.
        runs: Vec<StripRun>,
    },
    /// Largest pressures of measurements without a map, beside the simulated ones.
    Peaks {
        /// The measurements.
        rows: Vec<Peak>,
    },
    /// A measured map and the simulated ones on its pixels, row by row from the lower left.
    Maps {
        /// Pixels along x.
        nx: usize,
        /// Pixels along y.
        ny: usize,
        /// Centre of the first pixel [m].
        x0: f64,
        /// Centre of the first pixel [m].
        y0: f64,
        /// Pixel length [m].
        dx: f64,
        /// Pixel width [m].
        dy: f64,
        /// Measured pressure [Pa].
        measured: Vec<f64>,
        /// Simulated before any effect was added [Pa].
        before: Vec<f64>,
        /// Simulated after [Pa]; empty where nothing was added.
        after: Vec<f64>,
    },
}

/// The largest pressure of one measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Peak {
    /// Row, with force and radius.
    pub name: String,
    /// Whether the search had not seen it.
    pub not_seen: bool,
    /// Measured [Pa].
    pub measured: f64,
    /// Its standard deviation [Pa].
    pub sd: f64,
    /// Simulated before any effect was added [Pa].
    pub before: f64,
    /// Simulated after [Pa]; nothing where nothing was added.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<f64>,
}

/// Where an effect acts along a track.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// The effect.
    pub effect: String,
    /// From [m].
    pub from: f64,
    /// To [m].
    pub to: f64,
}

/// One run along its track.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StripRun {
    /// Run.
    pub run: String,
    /// Its session.
    pub session: String,
    /// Mean residual of each stretch before any effect was added; NaN where the run has none.
    pub before: Vec<f64>,
    /// After.
    pub after: Vec<f64>,
}

/// One set of points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Name.
    pub name: String,
    /// Values.
    pub y: Vec<f64>,
    /// Their standard deviations; empty where they are not drawn.
    pub sd: Vec<f64>,
}

/// A curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Name.
    pub name: String,
    /// Places.
    pub x: Vec<f64>,
    /// Values.
    pub y: Vec<f64>,
}
