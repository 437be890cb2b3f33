//! Columns that the channels of a sample may be, and how sure that is: a mapping to edit.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use kufe_sled::{COLUMNS, Sensor, correlation};

use crate::log::{Channel, Log};
use crate::plan::index_help;
use crate::unit::{column_unit, conversion, has_dimension, name_unit, unit_words};

/// One file of a run, with its path as the mapping is to name it.
struct Logger {
    name: String,
    pattern: String,
    sample: Sample,
}

/// A commented `mapping.toml` for recordings like these: files of one run, one a logger, with their
/// paths from the mapping.
///
/// Every line says how sure it is and why. An open question is a comment that begins with `# ?`,
/// above the line that answers it, to be completed and freed of its `#`.
pub fn guess_mapping(files: &[(PathBuf, Log)]) -> String {
    let (names, run) = split_names(files);
    let logger = |((path, log), (name, last)): (&(PathBuf, Log), _)| Logger {
        name,
        pattern: path
            .with_file_name::<String>(last)
            .display()
            .to_string()
            .replace('\\', "/"),
        sample: Sample::of(log),
    };
    let loggers: Vec<Logger> = files.iter().zip(names).map(logger).collect();
    let mut text = String::from(
        "# What the channels of these recordings are. Lines that begin with \"# ?\" are questions: answer the line below each and\n\
         # take its # away. Then: kufe runs import THIS -o runs/\n\nrate_hz = 100.0          # of the runs\n",
    );
    let several = loggers.len() > 1;
    let lead = loggers
        .iter()
        .find(|l| l.sample.columns.contains_key("ay_mps2"))
        .unwrap_or(&loggers[0]);
    if several {
        let _ = writeln!(
            text,
            "clock = {:?}          # the logger whose clock the runs keep",
            lead.name
        );
    }
    let mut channels = String::new();
    for column in COLUMNS.iter().chain(&["s_m"]) {
        match best(&loggers, column) {
            Some(logger) => {
                channels += &line(
                    column,
                    &logger.sample.columns[*column],
                    several.then_some(&logger.name),
                );
            }
            None if *column == "s_m" => {}
            None => {
                let logger = if several {
                    format!("logger = {:?}, ", lead.name)
                } else {
                    String::new()
                };
                let _ = writeln!(
                    channels,
                    "# ? {column}: no channel of that name\n# {column} = {{ {logger}from = \"?\", unit = \"?\" }}"
                );
            }
        }
    }
    for logger in &loggers {
        head(&mut text, logger, &run);
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
        let names: Vec<String> = others
            .iter()
            .take(60)
            .map(|name| format!("{name:?}"))
            .collect();
        let _ = writeln!(text, "# Not used: {}", names.join(", "));
    }
    text += &index_help();
    text
}

/// The logger with the best channel for a column, the first of equal ones.
fn best<'a>(loggers: &'a [Logger], column: &str) -> Option<&'a Logger> {
    let guess = |logger: &'a Logger| Some((logger, logger.sample.columns.get(column)?));
    let candidates = loggers.iter().rev().filter_map(guess);
    let best = candidates.max_by(|(_, a), (_, b)| a.compare(b));
    best.map(|(logger, _)| logger)
}

/// Text as TOML writes it.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

fn head(text: &mut String, logger: &Logger, run: &str) {
    let _ = writeln!(
        text,
        "\n[logger.{}]\nfiles = {}      # the * is the run's name, here {run:?}",
        logger.name,
        quoted(&logger.pattern)
    );
    if logger.sample.upside_down {
        text.push_str(
            "rotation = [3.141592653589793, 0.0, 0.0]      # likely: az points down, as in a box that is upside down\n",
        );
    }
    match &logger.sample.time {
        Some((name, unit, why)) => {
            let _ = writeln!(text, "time = {}          # {why}", quoted(name));
            if let Some(unit) = unit {
                let _ = writeln!(text, "time_unit = {unit:?}");
            }
        }
        None if logger.sample.clocked => {}
        None => text.push_str("# ? no channel seems to be a time: name it, or state the rate of the samples\n# rate_hz = 100.0\n"),
    }
}

/// One column's line, or the question about it.
fn line(column: &str, guess: &Guess, logger: Option<&String>) -> String {
    let mut keys = Vec::new();
    keys.extend(logger.map(|logger| format!("logger = {logger:?}")));
    keys.push(format!("from = {}", quoted(&guess.from)));
    keys.extend(guess.unit.map(|unit| format!("unit = {unit:?}")));
    keys.extend(guess.negative.then(|| "sign = -1".to_string()));
    match guess.open {
        None => format!(
            "{column} = {{ {} }}      # {}\n",
            keys.join(", "),
            guess.why
        ),
        Some(units) => {
            keys.push("unit = \"?\"".to_string());
            format!(
                "# ? {column}: is {:?} in {}? {}\n# {column} = {{ {} }}\n",
                guess.from,
                units.join(" or "),
                guess.why,
                keys.join(", ")
            )
        }
    }
}

/// A name for each file's logger with the pattern of its last part, and the run's name: the part
/// that all files' names share.
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
        return (
            vec![("box".to_string(), format!("*{}", ending(0)))],
            stems[0].clone(),
        );
    }
    // One run's files in a folder for each logger.
    if stems.iter().all(|stem| *stem == stems[0]) {
        let names = files.iter().enumerate().map(|(i, (path, _))| {
            let folder = path
                .parent()
                .map_or(String::new(), |folder| part(folder, Path::file_name));
            (logger_name(&folder, i), format!("*{}", ending(i)))
        });
        return (distinct(names.collect()), stems[0].clone());
    }
    let first: Vec<char> = stems[0].chars().collect();
    let shared = |of: fn(&str, &str) -> bool, part: &dyn Fn(usize) -> String| {
        let parts = (1..first.len()).map(part);
        parts
            .filter(|p| stems.iter().all(|s| of(s, p) && s.len() > p.len()))
            .max_by_key(String::len)
            .unwrap_or_default()
    };
    let prefix = shared(|s, p| s.starts_with(p), &|n| first[..n].iter().collect());
    let suffix = shared(|s, p| s.ends_with(p), &|n| first[n..].iter().collect());
    let bare = |text: &str| text.trim_matches(['_', '-', '.', ' ']).to_string();
    let by_suffix = bare(&suffix).len() >= bare(&prefix).len();
    let run = bare(if by_suffix { &suffix } else { &prefix });
    let names = stems.iter().enumerate().map(|(i, stem)| {
        let (own, pattern) = if run.is_empty() {
            (stem.clone(), format!("{stem}{}", ending(i)))
        } else if by_suffix {
            let own = stem[..stem.len() - run.len()].to_string();
            (own.clone(), format!("{own}*{}", ending(i)))
        } else {
            let own = stem[run.len()..].to_string();
            (own.clone(), format!("*{own}{}", ending(i)))
        };
        (logger_name(&own, i), pattern)
    });
    (distinct(names.collect()), run.clone())
}

/// A name for the table of the i-th logger, by a part of its file's path.
fn logger_name(text: &str, i: usize) -> String {
    let plain = |c: &char| c.is_ascii_alphanumeric() || *c == '_';
    let name: String = text.chars().filter(plain).collect();
    match name.trim_matches('_') {
        "" => format!("logger{}", i + 1),
        name => name.to_lowercase(),
    }
}

/// Appends the place of a logger to a name that one before it has.
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
    pub from: String,
    /// The unit to write; none where the file states it.
    pub unit: Option<&'static str>,
    /// Whether the values have the other sign.
    pub negative: bool,
    /// Weight of the name.
    pub weight: usize,
    /// Samples with a value.
    pub samples: usize,
    /// Change of the slope from sample to sample as a share of the slope: small where a filter
    /// smoothed the values.
    pub roughness: f64,
    /// How sure, and why.
    pub why: String,
    /// Units that it may be, where nothing decides.
    pub open: Option<&'static [&'static str]>,
}

impl Guess {
    /// Better is kufe's own name, then the faster channel, then the one that no filter smoothed,
    /// then the surer name.
    fn compare(&self, other: &Guess) -> Ordering {
        let by = |a: f64, b: f64, ratio: f64| match (a > ratio * b, b > ratio * a) {
            (true, _) => Ordering::Greater,
            (_, true) => Ordering::Less,
            _ => Ordering::Equal,
        };
        let smoothed = |guess: &Guess| {
            let name = guess.from.to_lowercase();
            SMOOTHED.split(',').any(|word| name.contains(word))
        };
        let own = |guess: &Guess| guess.weight >= OWN;
        own(self)
            .cmp(&own(other))
            .then(by(self.samples as f64, other.samples as f64, 1.5))
            .then(smoothed(other).cmp(&smoothed(self)))
            .then(by(self.roughness, other.roughness, 2.0))
            .then(self.weight.cmp(&other.weight))
    }
}

/// Words in names of filtered or computed channels.
const SMOOTHED: &str = "filt,smooth,avg,average,mean,lowpass,calc";

/// Weight of a name of kufe's own.
const OWN: usize = 1000;

/// Columns that a file's channels may be.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sample {
    /// The time channel, its unit where the file does not state it, and why.
    pub time: Option<(String, Option<&'static str>, String)>,
    /// Whether the file has times of its own.
    pub clocked: bool,
    /// Whether its box is upside down, or has axes forward, right and down.
    pub upside_down: bool,
    pub columns: BTreeMap<&'static str, Guess>,
    /// Channels that are no column.
    pub others: Vec<String>,
}

impl Sample {
    /// Guesses by names, then by what the file states, then by values.
    fn of(log: &Log) -> Sample {
        let mut found = Sample {
            clocked: !log.clocks.is_empty(),
            ..Sample::default()
        };
        let mut times: Vec<(usize, &Channel, Option<&'static str>, String)> = Vec::new();
        for channel in &log.channels {
            if let (Some(rank), Some(said)) = (time_rank(&channel.name), time_unit(&channel.values))
            {
                let stated = channel
                    .unit
                    .as_deref()
                    .filter(|unit| conversion(unit, "s").is_ok());
                let (unit, why) = match (stated, said) {
                    (Some(unit), _) => (None, format!("the file says {unit}")),
                    (None, Said::Unit(unit, why)) => (Some(unit), why),
                    (None, Said::Open(_, why)) => (Some("s"), format!("? s, ms or us: {why}")),
                };
                times.push((rank, channel, unit, why));
                continue;
            }
            // The unit that the file states may be one of another quantity.
            let converts = |named: &Named| {
                let unit = channel.unit.as_deref().filter(|unit| has_dimension(unit));
                unit.is_none_or(|unit| conversion(unit, column_unit(named.column)).is_ok())
            };
            match by_name(&channel.name).filter(converts) {
                None => found.others.push(channel.name.clone()),
                Some(named) => {
                    let guess = guess(channel, named.column, named.weight, named.own);
                    let better = found
                        .columns
                        .get(named.column)
                        .is_none_or(|known| known.compare(&guess).is_lt());
                    let loser = if better {
                        found.columns.insert(named.column, guess)
                    } else {
                        Some(guess)
                    };
                    found.others.extend(loser.map(|loser| loser.from));
                }
            }
        }
        if let Some((_, channel, unit, why)) = times.into_iter().min_by_key(|time| time.0) {
            found.time = Some((channel.name.clone(), unit, why));
        }
        share_unit(&mut found.columns, &["az_mps2", "ax_mps2", "ay_mps2"]);
        share_unit(
            &mut found.columns,
            &["yaw_rate_radps", "roll_rate_radps", "pitch_rate_radps"],
        );
        found.turn_over(log);
        found
    }

    /// A vertical axis that points down is that of the whole box where the pitch rate says so: a sled
    /// that pitches up is pressed down in any box, but not where one axis has the other sign.
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

/// The axes of one accelerometer, and of one gyroscope, have one unit: that of the first whose
/// values decide.
fn share_unit(columns: &mut BTreeMap<&'static str, Guess>, axes: &[&'static str]) {
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

fn guess(channel: &Channel, column: &'static str, weight: usize, own: bool) -> Guess {
    let stated = channel
        .unit
        .as_deref()
        .filter(|unit| conversion(unit, column_unit(column)).is_ok());
    let name = if own {
        "sure: the name is kufe's own"
    } else {
        "likely: by its name"
    };
    let (unit, open, mut why) = match (stated, unit_by_values(column, &channel.values)) {
        (Some(unit), _) => (None, None, format!("{name}; the file says {unit}")),
        (None, Some(Said::Unit(unit, why))) => (Some(unit), None, format!("{name}; {why}")),
        (None, Some(Said::Open(units, why))) => (None, Some(units), why),
        (None, None) => (None, Some(&["?"][..]), "it holds no values".to_string()),
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

/// Sum of the slope's changes from sample to sample, as a share of the sum of the slopes.
fn roughness(values: &[f64]) -> f64 {
    let finite: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    let slopes = finite.windows(2).map(|w| (w[1] - w[0]).abs()).sum::<f64>();
    let changes = finite.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs());
    changes.sum::<f64>() / slopes.max(f64::MIN_POSITIVE)
}

/// The unit of values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Said {
    /// A unit, and why.
    Unit(&'static str, String),
    /// Units that it may have, and why that is open.
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

/// The unit of a column's values by their size: a body at rest has a specific force of 9.81 m/s2,
/// no sled or car exceeds 70 m/s or turns by 12 rad/s.
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
    let step_text = format!("usual step {median}");
    Some(match median {
        m if m < 0.6 => Said::Unit("s", format!("{step_text}: {:.0} Hz", 1.0 / m)),
        m if (1000.0..1e6).contains(&m) => {
            Said::Unit("us", format!("{step_text}: {:.0} Hz", 1e6 / m))
        }
        m if m.fract() == 0.0 && m < 1000.0 => {
            Said::Unit("ms", format!("{step_text}: {:.0} Hz", 1e3 / m))
        }
        _ => Said::Open(&["s", "ms", "us"], step_text),
    })
}

/// Columns, the words in names of their channels, and words that exclude a channel; words are
/// separated by commas, and longer ones are surer.
const NAMES: [(&str, &str, &str); 11] = [
    (
        "ax_mps2",
        "long acc,longitudinal,inline acc,g long,force long,acc x,accel x,langsbeschl,\
         laengsbeschl,ax,x acc,longacc",
        "angular,gyro",
    ),
    (
        "ay_mps2",
        "lateral acc,lateral,lat acc,g lat,force lat,acc y,accel y,querbeschl,ay,y acc,latacc",
        "angular,gyro,velocity,slip",
    ),
    (
        "az_mps2",
        "vertical acc,vert acc,g vert,force vert,acc z,accel z,hochbeschl,vertikalbeschl,az,z acc,\
         vertacc",
        "angular,gyro,velocity",
    ),
    (
        "roll_rate_radps",
        "roll rate,rollrate,gyro roll,gyro x,wankrate,rollgeschw,wx,x rate",
        "split",
    ),
    (
        "pitch_rate_radps",
        "pitch rate,pitchrate,gyro pitch,gyro y,nickrate,nickgeschw,wy,y rate",
        "",
    ),
    (
        "yaw_rate_radps",
        "yaw rate,yawrate,gyro yaw,gyro z,gierrate,giergeschw,gierwinkelgeschw,wz,z rate",
        "",
    ),
    (
        "v_mps",
        "gps speed,ground speed,speed,velocity,geschwindigkeit,geschw,v,tempo,vel",
        "engine,accuracy,wind,vertical,motor,lateral,winkel",
    ),
    (
        "alpha_rad",
        "slip angle,sideslip,slip,schwimmwinkel,schraglauf,schraeglauf,alpha",
        "ratio,schlupf",
    ),
    (
        "delta_rad",
        "steering angle,steering,steer,lenkwinkel,lenkung,lenk,delta",
        "torque,moment,time",
    ),
    (
        "gamma_rad",
        "roll split,rollsplit,knickwinkel,knick,verdrehung,verdrehwinkel,twist,gamma",
        "rate",
    ),
    ("s_m", "distance,strecke,weg,odometer,s", "wheel"),
];

/// Words in names of times, surer ones first.
const TIMES: &str =
    "utc time,gps time,unix time,utc,t s,time,zeit,timestamp,timestamps,t,elapsed,uhrzeit";

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
    let mut plain = plain(name);
    if name_unit(name).is_some() {
        let words: Vec<&str> = plain.split(' ').collect();
        plain = words[..words.len().saturating_sub(unit_words(name))].join(" ");
    }
    if let Some((column, ..)) = NAMES.iter().find(|(column, ..)| *column == name) {
        return Some(Named {
            column,
            weight: OWN,
            own: true,
        });
    }
    let holds = |words: &&str| {
        // One or two letters must be the whole name; longer words may be part of a German one.
        words.len() > 2 && format!(" {plain}").contains(&format!(" {words}"))
            || plain == **words
            || words.len() > 5 && plain.contains(*words)
    };
    // Geschwindigkeit contains a wind and means none.
    let begins = |word: &str| !word.is_empty() && format!(" {plain}").contains(&format!(" {word}"));
    let fits = NAMES.iter().filter_map(|(column, words, against)| {
        let weight = words.split(',').filter(holds).map(str::len).max()?;
        (!against.split(',').any(begins)).then_some(Named {
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
    let rank = TIMES.split(',').position(begins);
    rank.filter(|_| !plain.contains("lap"))
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
