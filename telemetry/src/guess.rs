//! A mapping to edit, guessed from sample recordings: the column of each channel, and how certain
//! the guess is.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use kufe_sled::{COLUMNS, Sensor, correlation, median};

use crate::log::{Channel, Log};
use crate::plan::index_help;
use crate::text::continue_days;
use crate::unit::{column_unit, conversion, has_dimension, name_unit, unit_words};

/// One file of a run, with its path pattern in the mapping.
struct Logger {
    name: String,
    pattern: String,
    sample: Sample,
}

/// A commented `mapping.toml` for recordings like `files`: the files of one run, one per logger,
/// with their paths relative to the mapping.
///
/// Every line states how certain it is and why. An open question is a comment that begins with
/// `# ?`; the line below is the answer, to be completed and uncommented.
pub fn guess_mapping(files: &[(PathBuf, Log)]) -> String {
    let (names, run) = split_names(files);
    let logger = |((path, log), (name, last)): (&(PathBuf, Log), (String, String))| {
        let pattern = path.with_file_name(last).display().to_string();
        Logger {
            name,
            pattern: pattern.replace('\\', "/"),
            sample: Sample::of(log),
        }
    };
    let loggers: Vec<Logger> = files.iter().zip(names).map(logger).collect();
    let mut text = String::from(
        "# What the channels of these recordings are. Lines that begin with \"# ?\" are questions: answer the line below each and\n\
         # take its # away. Then: kufe runs import THIS -o runs/\n\nrate_hz = 100.0          # of the runs\n",
    );
    let several = loggers.len() > 1;
    let mut lateral = loggers
        .iter()
        .filter(|l| l.sample.columns.contains_key("ay_mps2"));
    let lead = lateral.next().unwrap_or(&loggers[0]);
    let mut of_lead = String::new();
    if several {
        let name = &lead.name;
        text += &format!("clock = {name:?}          # the logger whose clock the runs keep\n");
        of_lead = format!("logger = {name:?}, ");
    }
    let mut channels = String::new();
    for column in COLUMNS.iter().chain(&["s_m"]) {
        if let Some(logger) = best(&loggers, column) {
            let guess = &logger.sample.columns[*column];
            channels += &line(column, guess, several.then_some(&logger.name));
        } else if *column != "s_m" {
            channels += &format!(
                "# ? {column}: no channel of that name\n# {column} = {{ {of_lead}from = \"?\", unit = \"?\" }}\n"
            );
        }
    }
    for logger in &loggers {
        text += &head(logger, &run);
        if several
            && logger.name != lead.name
            && logger.sample.clocked | logger.sample.time.is_some()
        {
            text += "# clock = \"shared\"         # if its clock is that of the runs; else its delay is found from channels that are related\n";
            text += "# delay_s = 0.0            # or state by how much it is late\n";
        }
        for (column, guess) in &logger.sample.columns {
            if best(&loggers, column).is_none_or(|best| best.name == logger.name) {
                continue;
            }
            let mut guess = guess.clone();
            if let Some(units) = guess.open.take() {
                guess.unit = units.first().copied();
                guess.why += "; the unit is of no account for the clock";
            }
            if guess.unit != Some("?") {
                text += &line(&format!("also.{column}"), &guess, None);
            }
        }
    }
    text += "\n[channels]\n";
    text += &channels;
    let others: Vec<&String> = loggers.iter().flat_map(|l| &l.sample.others).collect();
    if !others.is_empty() {
        let names = others.iter().take(60).map(|name| format!("{name:?}"));
        let names: Vec<String> = names.collect();
        text += &format!("# Not used: {}\n", names.join(", "));
    }
    text += &index_help();
    text
}

/// The logger with the best channel for a column; the first of equally good ones.
fn best<'a>(loggers: &'a [Logger], column: &str) -> Option<&'a Logger> {
    let guess = |logger: &'a Logger| Some((logger, logger.sample.columns.get(column)?));
    let candidates = loggers.iter().rev().filter_map(guess);
    let best = candidates.max_by(|(_, a), (_, b)| a.compare(b));
    best.map(|(logger, _)| logger)
}

/// A string in TOML notation.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// A logger's table, without `also`.
fn head(logger: &Logger, run: &str) -> String {
    let mut text = format!(
        "\n[logger.{}]\nfiles = {}      # the * is the run's name, here {run:?}\n",
        logger.name,
        quoted(&logger.pattern)
    );
    if logger.sample.upside_down {
        text += "rotation = [3.141592653589793, 0.0, 0.0]      # likely: az points down, as in a box that is upside down\n";
    }
    if let Some((name, unit, why)) = &logger.sample.time {
        text += &format!("time = {}          # {why}\n", quoted(name));
        text.extend(unit.map(|unit| format!("time_unit = {unit:?}\n")));
    } else if !logger.sample.clocked {
        let why = logger.sample.no_time.as_deref();
        let why = why.unwrap_or("no channel seems to be a time");
        text += &format!(
            "# ? {why}: name the time, or state the rate of the samples\n# rate_hz = 100.0\n"
        );
    }
    text
}

/// The line of one column, or the question about it.
fn line(column: &str, guess: &Guess, logger: Option<&String>) -> String {
    let mut keys = Vec::new();
    keys.extend(logger.map(|logger| format!("logger = {logger:?}")));
    keys.push(format!("from = {}", quoted(&guess.from)));
    keys.extend(guess.unit.map(|unit| format!("unit = {unit:?}")));
    keys.extend(guess.negative.then(|| "sign = -1".to_string()));
    keys.extend(guess.open.map(|_| "unit = \"?\"".to_string()));
    let (keys, from, why) = (keys.join(", "), &guess.from, &guess.why);
    let Some(units) = guess.open else {
        return format!("{column} = {{ {keys} }}      # {why}\n");
    };
    let units = units.join(" or ");
    format!("# ? {column}: is {from:?} in {units}? {why}\n# {column} = {{ {keys} }}\n")
}

/// The logger name and the file name pattern of each file, and the run's name: the part that all
/// file names have in common.
fn split_names(files: &[(PathBuf, Log)]) -> (Vec<(String, String)>, String) {
    let part = |path: &Path, of: fn(&Path) -> Option<&std::ffi::OsStr>| {
        of(path).map_or(String::new(), |s| s.to_string_lossy().to_string())
    };
    let stem = |(path, _): &(PathBuf, Log)| part(path, Path::file_stem);
    let stems: Vec<String> = files.iter().map(stem).collect();
    let ending = |i: usize| match part(&files[i].0, Path::extension) {
        none if none.is_empty() => none,
        ending => format!(".{ending}"),
    };
    if files.len() == 1 {
        let only = ("box".to_string(), format!("*{}", ending(0)));
        return (vec![only], stems[0].clone());
    }
    // Files of equal names in one folder per logger.
    if stems.iter().all(|stem| *stem == stems[0]) {
        let names = files.iter().enumerate().map(|(i, (path, _))| {
            let folder = part(path.parent().unwrap_or(Path::new("")), Path::file_name);
            (logger_name(&folder, i), format!("*{}", ending(i)))
        });
        return (distinct(names.collect()), stems[0].clone());
    }
    let first: Vec<char> = stems[0].chars().collect();
    // The longest part that all names share; no word or number is cut.
    let shared = |cut: fn(&str, &str) -> Option<usize>, part: &dyn Fn(usize) -> String| {
        let in_all = |p: &String| {
            let cuts_no_word = |s: &String| cut(s, p).is_some_and(|at| is_boundary(s, at));
            stems.iter().all(cuts_no_word)
        };
        let parts = (0..=first.len()).map(part).filter(in_all);
        parts.max_by_key(String::len).unwrap_or_default()
    };
    let prefix = shared(|s, p| s.starts_with(p).then_some(p.len()), &|n| {
        first[..n].iter().collect()
    });
    let suffix = shared(|s, p| s.ends_with(p).then(|| s.len() - p.len()), &|n| {
        first[n..].iter().collect()
    });
    let bare = |text: &str| text.trim_matches(['_', '-', '.', ' ']).to_string();
    let by_suffix = bare(&suffix).len() >= bare(&prefix).len();
    let run = bare(if by_suffix { &suffix } else { &prefix });
    let names = stems.iter().enumerate().map(|(i, stem)| {
        let [own, before, after] = if run.is_empty() {
            [stem, stem, ""]
        } else if by_suffix {
            let own = &stem[..stem.len() - run.len()];
            [own, &format!("{own}*"), ""]
        } else {
            [&stem[run.len()..], "*", &stem[run.len()..]]
        };
        (logger_name(own, i), format!("{before}{after}{}", ending(i)))
    });
    (distinct(names.collect()), run.clone())
}

/// Whether a word, a number or the text ends or begins at this byte.
fn is_boundary(text: &str, at: usize) -> bool {
    let (before, after) = text.split_at(at);
    let (Some(before), Some(after)) = (before.chars().next_back(), after.chars().next()) else {
        return true;
    };
    !before.is_alphanumeric()
        || !after.is_alphanumeric()
        || before.is_numeric() != after.is_numeric()
        || (before.is_lowercase() && after.is_uppercase())
}

/// A name for the table of the i-th logger, from a part of its file's path.
fn logger_name(text: &str, i: usize) -> String {
    let plain = |c: &char| c.is_ascii_alphanumeric() || *c == '_';
    let name: String = text.chars().filter(plain).collect();
    match name.trim_matches('_') {
        "" => format!("logger{}", i + 1),
        name => name.to_lowercase(),
    }
}

/// Appends the number of a logger to a name that a previous logger has.
fn distinct(mut names: Vec<(String, String)>) -> Vec<(String, String)> {
    for i in 1..names.len() {
        let (before, own) = names.split_at_mut(i);
        if before.iter().any(|(name, _)| *name == own[0].0) {
            own[0].0 += &format!("_{}", i + 1);
        }
    }
    names
}

/// A channel that may be a column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Guess {
    /// Name of the channel.
    pub from: String,
    /// The unit to write; `None` if the file states it.
    pub unit: Option<&'static str>,
    /// Whether the values have the opposite sign.
    pub negative: bool,
    /// Number of characters of the name that match the column; larger is more certain.
    pub weight: usize,
    /// Number of finite samples.
    pub samples: usize,
    /// Ratio of second to first differences (see [`roughness`]): small for filtered values.
    pub roughness: f64,
    /// Certainty and reason, as written in the mapping.
    pub why: String,
    /// Possible units, if neither file nor values decide.
    pub open: Option<&'static [&'static str]>,
}

impl Guess {
    /// Prefers kufe's own column names, then higher rates, then channels that are no
    /// [`SECOND_CHOICE`], then unfiltered ones, then names that are more certain.
    fn compare(&self, other: &Guess) -> Ordering {
        let by = |a: f64, b: f64, ratio: f64| match (a > ratio * b, b > ratio * a) {
            (true, _) => Ordering::Greater,
            (_, true) => Ordering::Less,
            _ => Ordering::Equal,
        };
        let is_second_choice = |guess: &Guess| {
            let name = guess.from.to_lowercase();
            SECOND_CHOICE.split(',').any(|word| name.contains(word))
        };
        let is_exact = |guess: &Guess| guess.weight >= EXACT_NAME;
        is_exact(self)
            .cmp(&is_exact(other))
            .then(by(self.samples as f64, other.samples as f64, 1.5))
            .then(is_second_choice(other).cmp(&is_second_choice(self)))
            .then(by(self.roughness, other.roughness, 2.0))
            .then(self.weight.cmp(&other.weight))
    }
}

/// Words in names of channels that are used only if there is no other: filtered or computed ones,
/// and the speed of a wheel, which slips and lifts.
const SECOND_CHOICE: &str = "filt,smooth,avg,average,mean,lowpass,calc,wheel,radgeschw";

/// Weight of a name that is a column of kufe.
const EXACT_NAME: usize = 1000;

/// Guesses for the channels of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sample {
    /// The time channel, its unit if the file does not state it, and the reason.
    pub time: Option<(String, Option<&'static str>, String)>,
    /// Why a channel with the name of a time is not a time.
    pub no_time: Option<String>,
    /// Whether the format states the times of channels.
    pub clocked: bool,
    /// Whether the sensor box is upside down (axes forward, right, down).
    pub upside_down: bool,
    /// The guess for each column.
    pub columns: BTreeMap<&'static str, Guess>,
    /// Channels that match no column.
    pub others: Vec<String>,
}

impl Sample {
    /// Guesses by names, then by units in the file, then by values.
    fn of(log: &Log) -> Sample {
        let mut found = Sample {
            clocked: !log.clocks.is_empty(),
            ..Sample::default()
        };
        let mut times: Vec<(usize, &Channel, Option<&'static str>, String)> = Vec::new();
        for channel in &log.channels {
            let time = time_rank(&channel.name).map(|rank| (rank, time_unit(&channel.values)));
            if let Some((_, Err(why))) = &time {
                let (name, why) = (&channel.name, why);
                found.no_time = Some(format!("{name:?} has the name of a time, but {why}"));
            }
            if let Some((rank, Ok(guess))) = time {
                let (unit, why) = match (stated_unit(channel, "s"), guess.units) {
                    (Some(unit), _) => (None, format!("the file says {unit}")),
                    (None, [unit]) => (Some(*unit), guess.why),
                    (None, _) => (Some("s"), format!("? s, ms or us: {}", guess.why)),
                };
                times.push((rank, channel, unit, why));
                continue;
            }
            // A channel whose stated unit is of another quantity does not match.
            let converts = |named: &Named| {
                let unit = channel.unit.as_deref().filter(|unit| has_dimension(unit));
                unit.is_none_or(|unit| conversion(unit, column_unit(named.column)).is_ok())
            };
            let Some(named) = by_name(&channel.name).filter(converts) else {
                found.others.push(channel.name.clone());
                continue;
            };
            let own = guess(channel, named);
            let known = found.columns.get(named.column);
            let worse = if known.is_none_or(|known| known.compare(&own).is_lt()) {
                found.columns.insert(named.column, own)
            } else {
                Some(own)
            };
            found.others.extend(worse.map(|worse| worse.from));
        }
        // If the format states clocks, a time channel of one group does not apply to other groups.
        let time = times.into_iter().min_by_key(|time| time.0);
        if let Some((_, channel, unit, why)) = time.filter(|_| !found.clocked) {
            found.time = Some((channel.name.clone(), unit, why));
        }
        found.one_box(log);
        let rates = ["yaw_rate_radps", "roll_rate_radps", "pitch_rate_radps"];
        share_unit(&mut found.columns, ["az_mps2", "ax_mps2", "ay_mps2"]);
        share_unit(&mut found.columns, rates);
        found.turn_over(log);
        found
    }

    /// Takes the three axes of one accelerometer together: `x_acc` and `y_acc` with `z_acc`. Other
    /// channels called longitudinal or lateral may be in the vehicle's axes.
    fn one_box(&mut self, log: &Log) {
        let Some(up) = self.columns.get("az_mps2").map(|guess| guess.from.clone()) else {
            return;
        };
        for (at, z) in up.char_indices().filter(|(_, c)| matches!(c, 'z' | 'Z')) {
            let twin = |column: &'static str, axis: [char; 2]| {
                let axis = if z == 'z' { axis[0] } else { axis[1] };
                let name = format!("{}{axis}{}", &up[..at], &up[at + 1..]);
                let channel = log.channels.iter().find(|channel| channel.name == name)?;
                let named = by_name(&name).filter(|named| named.column == column)?;
                Some(guess(channel, named))
            };
            let twins = (twin("ax_mps2", ['x', 'X']), twin("ay_mps2", ['y', 'Y']));
            let (Some(ax), Some(ay)) = twins else {
                continue;
            };
            for (column, own) in [("ax_mps2", ax), ("ay_mps2", ay)] {
                self.others.retain(|name| *name != own.from);
                let from = own.from.clone();
                let before = self.columns.insert(column, own);
                let before = before.map(|guess| guess.from).filter(|name| *name != from);
                self.others.extend(before);
            }
        }
    }

    /// Decides whether a vertical axis that points down belongs to a box that is upside down or has
    /// the opposite sign alone. In the former, vertical acceleration and pitch rate are both
    /// negated, so that their correlation remains negative: a sled that pitches up is pressed down.
    fn turn_over(&mut self, log: &Log) {
        let guess = |axis: Sensor| self.columns.get(axis.name());
        let values = |axis: Sensor| {
            let from = &guess(axis)?.from;
            let channel = log.channels.iter().find(|channel| channel.name == *from);
            channel.map(|channel| channel.values.as_slice())
        };
        let axes = Sensor::ACCELEROMETER.iter().chain(&Sensor::GYROSCOPE);
        let whole = axes.copied().all(|axis| guess(axis).is_some());
        let (up, pitch) = (values(Sensor::Az), values(Sensor::PitchRate));
        let turned = whole && correlation(up.unwrap_or_default(), pitch.unwrap_or_default()) < -0.3;
        let up = self.columns.get_mut(Sensor::Az.name());
        if let Some(up) = up.filter(|up| up.negative && turned) {
            up.negative = false;
            self.upside_down = true;
        }
    }
}

/// Assigns the same unit to the axes of one accelerometer or gyroscope: that of the first axis
/// whose values determine it.
fn share_unit(columns: &mut BTreeMap<&'static str, Guess>, axes: [&'static str; 3]) {
    let decided = axes.iter().find_map(|axis| {
        let guess = columns.get(axis).filter(|guess| guess.open.is_none())?;
        Some((guess.unit?, guess.from.clone()))
    });
    let Some((unit, from)) = decided else { return };
    for axis in axes {
        if let Some(guess) = columns.get_mut(axis).filter(|guess| guess.open.is_some()) {
            guess.unit = Some(unit);
            guess.open = None;
            guess.why = format!("likely: by its name; {unit} as {from:?}");
        }
    }
}

/// The unit that the file states, if it converts to `target`.
fn stated_unit<'a>(channel: &'a Channel, target: &str) -> Option<&'a str> {
    let unit = channel.unit.as_deref();
    unit.filter(|unit| conversion(unit, target).is_ok())
}

fn guess(channel: &Channel, Named { column, weight }: Named) -> Guess {
    let name = match weight {
        EXACT_NAME => "sure: the name is kufe's own",
        _ => "likely: by its name",
    };
    let found = unit_by_values(column, &channel.values);
    let (unit, open, mut why) = match (stated_unit(channel, column_unit(column)), found) {
        (Some(unit), _) => (None, None, format!("{name}; the file says {unit}")),
        (None, None) => (None, Some(&["?"][..]), "it holds no values".to_string()),
        (None, Some(UnitGuess { units, why })) => match units {
            [unit] => (Some(*unit), None, format!("{name}; {why}")),
            _ => (None, Some(units), why),
        },
    };
    let median = extent(&channel.values).map_or(0.0, |[median, _]| median);
    let negative = column == "az_mps2" && median < 0.0 && open.is_none();
    if negative {
        why += "; its axis points down";
    }
    Guess {
        from: channel.name.clone(),
        unit,
        negative,
        weight,
        samples: channel.values.iter().filter(|x| x.is_finite()).count(),
        roughness: roughness(&channel.values),
        why,
        open,
    }
}

fn finite(values: &[f64]) -> Vec<f64> {
    values.iter().copied().filter(|x| x.is_finite()).collect()
}

/// Ratio of the sum of absolute second differences to that of absolute first differences.
fn roughness(values: &[f64]) -> f64 {
    let finite = finite(values);
    let slopes = finite.windows(2).map(|w| (w[1] - w[0]).abs()).sum::<f64>();
    let changes = finite.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs());
    changes.sum::<f64>() / slopes.max(f64::MIN_POSITIVE)
}

/// The unit of values, or possible units, with the reason.
pub(crate) struct UnitGuess {
    pub units: &'static [&'static str],
    pub why: String,
}

/// Median and largest magnitude of the finite values; `None` without finite values.
pub(crate) fn extent(values: &[f64]) -> Option<[f64; 2]> {
    let finite = finite(values);
    let median = median(finite.iter().copied())?;
    let largest = finite.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    Some([median, largest])
}

const RATES: &[&str] = &["roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps"];
const ANGLES: &[&str] = &["alpha_rad", "delta_rad", "gamma_rad"];

/// Columns, a bound on the largest magnitude, the possible units of values above this bound, and
/// the reason: no sled or car exceeds 70 m/s or 12 rad/s. The first row that applies counts.
const BY_LARGEST: [(&[&str], f64, &[&str], &str); 9] = [
    (&["ax_mps2", "ay_mps2"], 8.0, &["m/s^2"], ""),
    (&["ax_mps2", "ay_mps2"], -1.0, &["g", "m/s^2"], ""),
    (&["v_mps"], 70.0, &["km/h"], ", too fast for m/s"),
    (&["v_mps"], -1.0, &["m/s", "km/h", "mph", "knots"], ""),
    (RATES, 12.0, &["deg/s"], ", too fast for rad/s"),
    (RATES, 3.0, &["deg/s", "rad/s"], ""),
    (RATES, -1.0, &["rad/s"], ", too slow for deg/s in a curve"),
    (ANGLES, 0.6, &["deg"], ", too large for rad"),
    (ANGLES, -1.0, &["rad", "deg"], ""),
];

/// The unit of a column's values from their magnitude; a body at rest has a specific force of
/// 9.81 m/s2.
pub(crate) fn unit_by_values(column: &str, values: &[f64]) -> Option<UnitGuess> {
    let [median, largest] = extent(values)?;
    if column == "az_mps2" {
        let (units, why): (&[&str], &str) = match median.abs() {
            m if (0.7..1.4).contains(&m) => (&["g"], ", that of gravity in g"),
            m if (7.0..14.0).contains(&m) => (&["m/s^2"], ", that of gravity in m/s2"),
            _ => (&["g", "m/s^2"], " is gravity's in no unit"),
        };
        let why = format!("median {median:.3}{why}");
        return Some(UnitGuess { units, why });
    }
    let mut rows = BY_LARGEST.iter();
    let row = rows.find(|(columns, above, ..)| columns.contains(&column) && largest > *above);
    let (units, why) = row.map_or((&["m", "km"][..], ""), |(_, _, units, why)| (units, why));
    let why = format!("largest magnitude {largest:.4}{why}");
    Some(UnitGuess { units, why })
}

/// The unit of a time channel from its median step. A time never decreases, except at midnight.
///
/// # Errors
/// The reason why the channel is not a time.
pub(crate) fn time_unit(values: &[f64]) -> Result<UnitGuess, String> {
    let mut finite = finite(values);
    continue_days(&mut finite, true);
    if let Some(pair) = finite.windows(2).find(|pair| pair[1] < pair[0]) {
        return Err(format!("it falls from {} to {}", pair[0], pair[1]));
    }
    let steps = finite.windows(2).map(|pair| pair[1] - pair[0]);
    let step = median(steps.filter(|step| *step > 0.0)).ok_or("it does not grow")?;
    let (units, per_second): (&[&str], f64) = match step {
        _ if step < 0.6 => (&["s"], 1.0),
        _ if (1000.0..1e6).contains(&step) => (&["us"], 1e6),
        _ if (1e6..1e9).contains(&step) => (&["ns"], 1e9),
        _ if step.fract() == 0.0 && step < 1000.0 => (&["ms"], 1e3),
        _ => (&["s", "ms", "us"], 0.0),
    };
    // Differences of large times have rounding errors.
    let mut why = format!("usual step {}", (1e6 * step).round() / 1e6);
    if per_second > 0.0 {
        why += &format!(": {:.0} Hz", per_second / step);
    }
    Ok(UnitGuess { units, why })
}

/// Columns, words in names of their channels, and words that exclude a channel. Words are separated
/// by commas; longer words are more certain.
const NAMES: &str = include_str!("../assets/names.csv");

fn names() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    NAMES.lines().filter_map(|line| {
        let (column, words) = line.split_once(';')?;
        let (words, against) = words.split_once(';')?;
        Some((column, words, against))
    })
}

/// Words in names of time channels, the most certain first.
const TIMES: &str =
    "utc time,gps time,unix time,utc,t s,time,zeit,timestamp,timestamps,t,elapsed,uhrzeit";

/// A guess from a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Named {
    pub column: &'static str,
    /// Number of matching characters; [`EXACT_NAME`] for the column's own name.
    pub weight: usize,
}

/// The last part of a name like `log.ax_g`, the field of a MATLAB structure.
fn field(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}

/// The column that a name matches best.
pub(crate) fn by_name(name: &str) -> Option<Named> {
    let without_unit = |name: &str| {
        let plain = plain(name);
        let words: Vec<&str> = plain.split(' ').collect();
        let unit = name_unit(name).map_or(0, |_| unit_words(name));
        words[..words.len().saturating_sub(unit)].join(" ")
    };
    let field = field(name);
    if let Some((column, ..)) = names().find(|(column, ..)| *column == field) {
        let weight = EXACT_NAME;
        return Some(Named { column, weight });
    }
    let [plain, field] = [name, field].map(without_unit);
    let holds = |words: &&str| {
        // One or two letters must be the whole name; long words may be part of a German compound.
        words.len() > 2 && format!(" {plain}").contains(&format!(" {words}"))
            || plain == **words
            || field == **words
            || words.len() > 5 && plain.contains(*words)
    };
    // Excluded words must begin a word: Geschwindigkeit (speed) contains "wind".
    let begins = |word: &str| !word.is_empty() && format!(" {plain}").contains(&format!(" {word}"));
    let fits = names().filter_map(|(column, words, against)| {
        let weight = words.split(',').filter(holds).map(str::len).max()?;
        (!against.split(',').any(begins)).then_some(Named { column, weight })
    });
    fits.max_by_key(|named| named.weight)
}

/// Rank of a name in the list of time names, 0 being the most certain; `None` for other names.
pub(crate) fn time_rank(name: &str) -> Option<usize> {
    let names = [name, field(name)].map(plain);
    let begins = |word: &str| {
        let begins = |name: &String| name == word || word.len() > 3 && name.starts_with(word);
        names.iter().any(begins)
    };
    let rank = TIMES.split(',').position(begins);
    rank.filter(|_| !names[0].contains("lap"))
}

/// A name in lower case, without accents, its words separated by single spaces.
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
        // LateralAcc and gyro_z are two words each.
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
    fn a_time_that_runs_backwards_is_named_with_the_reason() {
        let channel = |name: &str, values: &[f64]| Channel {
            name: name.to_string(),
            values: values.to_vec(),
            ..Channel::default()
        };
        let times = [0.0, 0.01, 0.02, 0.01, 0.02];
        let channels = vec![channel("Time", &times), channel("v_mps", &[1.0; 5])];
        let log = Log {
            channels,
            ..Log::default()
        };
        let text = guess_mapping(&[(PathBuf::from("a.csv"), log)]);
        let expected = "\"Time\" has the name of a time, but it falls from 0.02 to 0.01";
        assert!(text.contains(expected), "{text}");
    }

    #[test]
    fn of_two_speeds_that_of_the_wheel_is_not_used() {
        let speed = |name: &str, noise: f64| Channel {
            name: name.to_string(),
            unit: Some("km/h".to_string()),
            values: (0..100).map(|i| 90.0 + noise * f64::from(i % 2)).collect(),
            ..Channel::default()
        };
        let (gps, wheel) = (speed("GPS Speed", 0.1), speed("Wheel Speed", 5.0));
        for (channels, expected) in [
            (vec![wheel.clone(), gps.clone()], "GPS Speed"),
            (vec![gps, wheel.clone()], "GPS Speed"),
            (vec![wheel], "Wheel Speed"),
        ] {
            let log = Log {
                channels,
                ..Log::default()
            };
            assert_eq!(Sample::of(&log).columns["v_mps"].from, expected);
        }
    }

    #[test]
    fn names_of_four_makers_and_two_languages_are_known() {
        for (name, column) in [
            ("Lateral Acc", "ay_mps2"),
            ("InlineAcc", "ax_mps2"),
            ("GPS_LatAcc", "ay_mps2"),
            ("G Force Long", "ax_mps2"),
            ("VerticalAcc", "az_mps2"),
            ("Accel Z", "az_mps2"),
            ("Beschl. X", "ax_mps2"),
            ("imu.acc(:,3)", "az_mps2"),
            ("gyr_x_dps", "roll_rate_radps"),
            ("Drehrate Z", "yaw_rate_radps"),
            ("v_gps", "v_mps"),
            ("Slip (deg)", "alpha_rad"),
            ("Querbeschleunigung", "ay_mps2"),
            ("Längsbeschleunigung", "ax_mps2"),
            ("Gyro Yaw", "yaw_rate_radps"),
            ("Gyro Yaw Velocity", "yaw_rate_radps"),
            ("log.ax_g", "ax_mps2"),
            ("log.imu.gyro_z_dps", "yaw_rate_radps"),
            ("log.v_mps", "v_mps"),
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
            "Angular Velocity",
            "engine.speed",
        ] {
            assert_eq!(by_name(name), None, "{name}");
        }
        assert!(time_rank("Zeit").is_some() && time_rank("log.time_s").is_some());
        assert!(time_rank("Timestamp").is_some() && time_rank("lap.time").is_none());
        assert!(time_rank("Lap Time").is_none() && time_rank("Temperature").is_none());
    }
}
