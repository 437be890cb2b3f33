//! What may have been done to channels, and how it is undone.

use crate::friction::GRAVITY;

use crate::record::check::relations::fault::FaultKind;
use crate::record::check::relations::slow::Slow;
use crate::record::run::COLUMNS;

/// How channels are mended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Act {
    /// Times a factor.
    Scale(f64),
    /// Exchanged.
    Swap,
    /// Gravity added.
    Weigh,
    /// The clock, times a factor.
    Clock(f64),
}

/// One thing that may be wrong, undone.
#[derive(Clone, Debug, PartialEq)]
pub struct Mend {
    /// The channels, by their place in [`COLUMNS`].
    pub channels: Vec<usize>,
    /// What is wrong.
    pub kind: FaultKind,
    /// In words.
    pub looks_like: &'static str,
    /// What to write in the mapping.
    pub line: String,
    act: Act,
}

impl Mend {
    /// Names of the channels.
    pub fn columns(&self) -> Vec<String> {
        match self.kind {
            FaultKind::Clock => vec!["t_s".to_string()],
            _ => self
                .channels
                .iter()
                .map(|c| COLUMNS[*c].to_string())
                .collect(),
        }
    }

    /// The factor on its channels, where it is one.
    pub fn factor(&self) -> Option<f64> {
        match self.act {
            Act::Scale(factor) => Some(factor),
            _ => None,
        }
    }

    /// Whether a run has what is to be mended.
    pub fn applies(&self, slow: &Slow) -> bool {
        self.channels.iter().all(|c| slow.channels[*c].is_some())
    }

    /// The channels mended.
    pub fn applied(&self, slow: &Slow) -> Slow {
        let mut mended = slow.clone();
        match self.act {
            Act::Swap => mended.channels.swap(self.channels[0], self.channels[1]),
            Act::Clock(factor) => mended.dt_s *= factor,
            Act::Scale(_) | Act::Weigh => {
                for c in &self.channels {
                    for x in mended.channels[*c].iter_mut().flatten() {
                        match self.act {
                            Act::Scale(factor) => *x *= factor,
                            _ => *x += GRAVITY,
                        }
                    }
                }
            }
        }
        mended
    }
}

/// Everything that is tried, the likelier of two that look alike first.
pub fn mends() -> Vec<Mend> {
    let mut all = Vec::new();
    let mut scaled = |channels: &[usize], kind, looks_like, word: &str, factor| {
        let names: Vec<&str> = channels.iter().map(|c| COLUMNS[*c]).collect();
        all.push(Mend {
            channels: channels.to_vec(),
            kind,
            looks_like,
            line: format!("{word} for {}", names.join(", ")),
            act: Act::Scale(factor),
        });
    };
    let (unit, sign) = (FaultKind::Unit, FaultKind::Sign);
    let degree = std::f64::consts::PI / 180.0;
    for channels in [&[0][..], &[1], &[2], &[0, 1], &[0, 1, 2]] {
        scaled(channels, unit, "multiples of g", "unit = \"g\"", GRAVITY);
    }
    for channels in [&[3][..], &[4], &[5], &[3, 4, 5]] {
        scaled(
            channels,
            unit,
            "degrees per second",
            "unit = \"deg/s\"",
            degree,
        );
    }
    scaled(&[6], unit, "km/h", "unit = \"km/h\"", 1.0 / 3.6);
    scaled(&[6], unit, "miles per hour", "unit = \"mph\"", 0.447_04);
    scaled(&[6], unit, "knots", "unit = \"kn\"", 1852.0 / 3600.0);
    scaled(&[7], unit, "degrees", "unit = \"deg\"", degree);
    for c in [0, 1, 2, 3, 4, 5, 7] {
        scaled(&[c], sign, "the other sign", "sign = -1", -1.0);
    }
    for (a, b) in [
        (0, 1),
        (0, 2),
        (1, 2),
        (3, 4),
        (3, 5),
        (4, 5),
        (7, 8),
        (7, 9),
    ] {
        all.push(Mend {
            channels: vec![a, b],
            kind: FaultKind::Swapped,
            looks_like: "one another",
            line: format!("exchange the names of {} and {}", COLUMNS[a], COLUMNS[b]),
            act: Act::Swap,
        });
    }
    all.push(Mend {
        channels: vec![2],
        kind: FaultKind::Gravity,
        looks_like: "an acceleration without gravity",
        line: "zero = -9.81 for az_mps2".to_string(),
        act: Act::Weigh,
    });
    all.push(Mend {
        channels: Vec::new(),
        kind: FaultKind::Clock,
        looks_like: "milliseconds",
        line: "unit = \"ms\" for the clock".to_string(),
        act: Act::Clock(1e-3),
    });
    all
}
