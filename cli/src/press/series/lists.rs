//! Lists of loads, radii and tilts, and their combinations.

/// The lists of a series; every combination is solved, the load running fastest.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct Lists {
    /// Normal force [N], or several as 500,1000,2000: a series in folders of its own, with series.pvd and table.csv
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub fz_n: Vec<f64>,
    /// Track radius in the vertical plane [m], positive in a valley, inf on a straight; one or several
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub radius_m: Vec<f64>,
    /// Radius of the rocker [m], of a shape; one or several
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub rocker_radius_m: Vec<f64>,
    /// Fixed pitch angle [rad], positive lowers the nose; one or several
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub pitch_rad: Vec<f64>,
    /// Fixed roll angle [rad], positive lifts the left side; one or several
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub roll_rad: Vec<f64>,
    /// Solve steps again that the output folder already holds
    #[arg(long)]
    pub fresh: bool,
}

impl Lists {
    /// Whether there is any list.
    pub fn is_series(&self) -> bool {
        self.named().iter().any(|(_, values)| !values.is_empty())
    }

    /// The lists, the one that runs slowest first.
    fn named(&self) -> [(&'static str, &[f64]); 5] {
        [
            ("rocker_radius_m", &self.rocker_radius_m),
            ("radius_m", &self.radius_m),
            ("pitch_rad", &self.pitch_rad),
            ("roll_rad", &self.roll_rad),
            ("fz_n", &self.fz_n),
        ]
    }

    /// How many combinations there are.
    pub fn count(&self) -> usize {
        let lengths = self.named().map(|(_, values)| values.len().max(1));
        lengths.iter().fold(1, |n: usize, &k| n.saturating_mul(k))
    }

    /// Every combination, as pairs of key and value.
    pub fn steps(&self) -> Vec<Vec<(&'static str, f64)>> {
        let mut steps: Vec<Vec<(&'static str, f64)>> = vec![Vec::new()];
        for (key, values) in self.named().into_iter().filter(|(_, v)| !v.is_empty()) {
            steps = steps
                .iter()
                .flat_map(|step| {
                    values.iter().map(move |&value| {
                        let mut longer = step.clone();
                        longer.push((key, value));
                        longer
                    })
                })
                .collect();
        }
        steps
    }

    /// Times for ParaView: the values themselves where one list rises, else 1, 2, 3 ...
    pub fn times(&self, count: usize) -> Vec<f64> {
        let lists: Vec<&[f64]> = self
            .named()
            .into_iter()
            .map(|(_, values)| values)
            .filter(|values| values.len() > 1)
            .collect();
        match lists[..] {
            [only]
                if only.windows(2).all(|w| w[0] < w[1]) && only.iter().all(|v| v.is_finite()) =>
            {
                only.to_vec()
            }
            _ => (1..=count).map(|k| k as f64).collect(),
        }
    }
}
