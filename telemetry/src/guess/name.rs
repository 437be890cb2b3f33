//! What a channel's name says, in the manners of AiM, MoTeC, Race Logic and of German and English crews.

/// Words of a name, any line of which makes it this column's; a longer line is a better sign.
type Words = &'static [&'static str];

/// Columns, what their channels are called, and lines of words that speak against them.
const NAMES: [(&str, Words, Words); 11] = [
    (
        "ax_mps2",
        &[
            "long acc",
            "longitudinal",
            "inline acc",
            "g long",
            "force long",
            "acc x",
            "accel x",
            "langsbeschl",
            "laengsbeschl",
            "ax",
            "x acc",
            "longacc",
        ],
        &["angular", "gyro"],
    ),
    (
        "ay_mps2",
        &[
            "lateral acc",
            "lateral",
            "lat acc",
            "g lat",
            "force lat",
            "acc y",
            "accel y",
            "querbeschl",
            "ay",
            "y acc",
            "latacc",
        ],
        &["angular", "gyro", "velocity", "slip"],
    ),
    (
        "az_mps2",
        &[
            "vertical acc",
            "vert acc",
            "g vert",
            "force vert",
            "acc z",
            "accel z",
            "hochbeschl",
            "vertikalbeschl",
            "az",
            "z acc",
            "vertacc",
        ],
        &["angular", "gyro", "velocity"],
    ),
    (
        "roll_rate_radps",
        &[
            "roll rate",
            "rollrate",
            "gyro roll",
            "gyro x",
            "wankrate",
            "rollgeschw",
            "wx",
            "x rate",
        ],
        &["split"],
    ),
    (
        "pitch_rate_radps",
        &[
            "pitch rate",
            "pitchrate",
            "gyro pitch",
            "gyro y",
            "nickrate",
            "nickgeschw",
            "wy",
            "y rate",
        ],
        &[],
    ),
    (
        "yaw_rate_radps",
        &[
            "yaw rate",
            "yawrate",
            "gyro yaw",
            "gyro z",
            "gierrate",
            "giergeschw",
            "gierwinkelgeschw",
            "wz",
            "z rate",
        ],
        &[],
    ),
    (
        "v_mps",
        &[
            "gps speed",
            "ground speed",
            "speed",
            "velocity",
            "geschwindigkeit",
            "geschw",
            "v",
            "tempo",
            "vel",
        ],
        &[
            "engine", "accuracy", "wind", "vertical", "motor", "lateral", "winkel",
        ],
    ),
    (
        "alpha_rad",
        &[
            "slip angle",
            "sideslip",
            "slip",
            "schwimmwinkel",
            "schraglauf",
            "schraeglauf",
            "alpha",
        ],
        &["ratio", "schlupf"],
    ),
    (
        "delta_rad",
        &[
            "steering angle",
            "steering",
            "steer",
            "lenkwinkel",
            "lenkung",
            "lenk",
            "delta",
        ],
        &["torque", "moment", "time"],
    ),
    (
        "gamma_rad",
        &[
            "roll split",
            "rollsplit",
            "knickwinkel",
            "knick",
            "verdrehung",
            "verdrehwinkel",
            "twist",
            "gamma",
        ],
        &["rate"],
    ),
    (
        "s_m",
        &["distance", "strecke", "weg", "odometer", "s"],
        &["wheel"],
    ),
];

/// What times are called.
const TIMES: [&str; 8] = [
    "t s",
    "time",
    "zeit",
    "timestamp",
    "timestamps",
    "t",
    "elapsed",
    "uhrzeit",
];

/// A guess by a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Named {
    pub column: &'static str,
    /// Length of the words that speak for it; longer is surer.
    pub weight: usize,
    /// Whether the name is the column's own.
    pub own: bool,
}

/// The column that a name speaks for.
pub(crate) fn by_name(name: &str) -> Option<Named> {
    let plain = plain(name);
    if let Some((column, ..)) = NAMES.iter().find(|(column, ..)| *column == name) {
        return Some(Named {
            column,
            weight: 1000,
            own: true,
        });
    }
    let holds = |words: &str| {
        // One or two letters must be the whole name; longer words may be part of a German one.
        words.len() > 2 && format!(" {plain}").contains(&format!(" {words}"))
            || plain == words
            || words.len() > 5 && plain.contains(words)
    };
    // Geschwindigkeit holds a wind and means none.
    let begins = |word: &str| format!(" {plain}").contains(&format!(" {word}"));
    let fits = NAMES
        .iter()
        .filter(|(_, _, against)| !against.iter().any(|word| begins(word)));
    let fits = fits.filter_map(|(column, words, _)| {
        let weight = words
            .iter()
            .filter(|words| holds(words))
            .map(|words| words.len())
            .max()?;
        Some(Named {
            column,
            weight,
            own: false,
        })
    });
    fits.max_by_key(|named| named.weight)
}

/// Whether a name is that of a time; earlier in the list is surer.
pub(crate) fn time_rank(name: &str) -> Option<usize> {
    let plain = plain(name);
    let begins = |word: &str| plain == word || word.len() > 3 && plain.starts_with(word);
    TIMES
        .iter()
        .position(|word| begins(word))
        .filter(|_| !plain.contains("lap"))
}

/// A name in small letters, without accents, its words apart by single spaces.
fn plain(name: &str) -> String {
    let mut plain = String::new();
    let mut before = ' ';
    for c in name.chars() {
        let small = match c {
            'ä' | 'Ä' => 'a',
            'ö' | 'Ö' => 'o',
            'ü' | 'Ü' => 'u',
            _ => c.to_ascii_lowercase(),
        };
        // LateralAcc is two words, and so is gyro_z.
        if c.is_uppercase() && before.is_lowercase() || !small.is_ascii_alphanumeric() {
            plain.push(' ');
        }
        if small.is_ascii_alphanumeric() {
            plain.push(small);
        }
        before = c;
    }
    plain.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_four_makers_and_two_languages_are_known() {
        for (name, column) in [
            ("Lateral Acc", "ay_mps2"),
            ("InlineAcc", "ax_mps2"),
            ("GPS_LatAcc", "ay_mps2"),
            ("G Force Long", "ax_mps2"),
            ("VerticalAcc", "az_mps2"),
            ("Accel Z", "az_mps2"),
            ("Querbeschleunigung", "ay_mps2"),
            ("Längsbeschleunigung", "ax_mps2"),
            ("Gyro Yaw", "yaw_rate_radps"),
            ("YawRate", "yaw_rate_radps"),
            ("Gierrate", "yaw_rate_radps"),
            ("gyro_x", "roll_rate_radps"),
            ("Nickrate", "pitch_rate_radps"),
            ("GPS Speed", "v_mps"),
            ("Ground Speed", "v_mps"),
            ("Geschwindigkeit", "v_mps"),
            ("Lenkwinkel", "delta_rad"),
            ("Steering Angle", "delta_rad"),
            ("Schwimmwinkel", "alpha_rad"),
            ("Slip Angle", "alpha_rad"),
            ("Knickwinkel", "gamma_rad"),
            ("Distance", "s_m"),
            ("v_mps", "v_mps"),
        ] {
            assert_eq!(
                by_name(name).map(|named| named.column),
                Some(column),
                "{name}"
            );
        }
        for name in [
            "Engine Speed",
            "Lap",
            "Bahntemperatur",
            "Steering Torque",
            "Satellites",
            "Brake Pressure",
        ] {
            assert_eq!(by_name(name), None, "{name}");
        }
        assert!(time_rank("Zeit").is_some() && time_rank("Timestamp").is_some());
        assert!(time_rank("Lap Time").is_none() && time_rank("Temperature").is_none());
    }
}
