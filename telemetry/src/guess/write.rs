//! A mapping to edit, with what is sure, likely and open.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use kufe_sled::COLUMNS;

use crate::guess::sample::{Guess, Sample, sample};
use crate::mapping::index_help;
use crate::source::Log;

/// One file of a run, with its path as the mapping is to name it.
struct Logger {
    name: String,
    pattern: String,
    sample: Sample,
}

/// A commented `mapping.toml` for recordings like these: files of one run, one a logger, with their paths from the mapping.
///
/// Every line says how sure it is and why. What cannot be told is a comment that begins with `# ?`, with the line that
/// answers it below, to be completed and freed of its `#`.
pub fn guess_mapping(files: &[(PathBuf, Log)]) -> String {
    let (names, run) = split_names(files);
    let loggers: Vec<Logger> = files
        .iter()
        .zip(names)
        .map(|((path, log), (name, last))| Logger {
            name,
            pattern: path
                .parent()
                .unwrap_or(Path::new(""))
                .join(last)
                .display()
                .to_string()
                .replace('\\', "/"),
            sample: sample(log),
        })
        .collect();
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
    let mut taken: BTreeSet<&str> = BTreeSet::new();
    let mut channels = String::new();
    for column in COLUMNS.iter().chain(&["s_m"]) {
        let by_weight = |l: &&Logger| l.sample.columns.get(column).map_or(0, |guess| guess.weight);
        match loggers
            .iter()
            .rev()
            .max_by_key(by_weight)
            .filter(|l| by_weight(l) > 0)
        {
            Some(logger) => {
                taken.insert(&logger.name);
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
            let first = loggers
                .iter()
                .rev()
                .max_by_key(|l| l.sample.columns.get(column).map_or(0, |g| g.weight));
            if first.is_some_and(|first| first.name != logger.name) && guess.open.is_none() {
                text += &line(&format!("also.{column}"), guess, None);
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

fn head(text: &mut String, logger: &Logger, run: &str) {
    let _ = writeln!(
        text,
        "\n[logger.{}]\nfiles = {:?}      # the * is the run's name, here {run:?}",
        logger.name, logger.pattern
    );
    match &logger.sample.time {
        Some((name, unit, why)) => {
            let _ = writeln!(text, "time = {name:?}          # {why}");
            if let Some(unit) = unit {
                let _ = writeln!(text, "time_unit = {unit:?}");
            }
        }
        None if logger.sample.clocked => {}
        None => text.push_str("# ? no channel looks like a time: name it, or state the rate of the samples\n# rate_hz = 100.0\n"),
    }
}

/// One column's line, or the question about it.
fn line(column: &str, guess: &Guess, logger: Option<&String>) -> String {
    let mut keys = Vec::new();
    keys.extend(logger.map(|logger| format!("logger = {logger:?}")));
    keys.push(format!("from = {:?}", guess.from));
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

/// A name for each file's logger with the pattern of its last part, and the run's name: what all files' names share.
fn split_names(files: &[(PathBuf, Log)]) -> (Vec<(String, String)>, String) {
    let part = |path: &Path, of: fn(&Path) -> Option<&std::ffi::OsStr>| {
        of(path).map_or(String::new(), |s| s.to_string_lossy().to_string())
    };
    let stems: Vec<String> = files
        .iter()
        .map(|(path, _)| part(path, Path::file_stem))
        .collect();
    let endings: Vec<String> = files
        .iter()
        .map(|(path, _)| part(path, Path::extension))
        .collect();
    let ending = |i: usize| {
        if endings[i].is_empty() {
            String::new()
        } else {
            format!(".{}", endings[i])
        }
    };
    if files.len() == 1 {
        return (
            vec![("box".to_string(), format!("*{}", ending(0)))],
            stems[0].clone(),
        );
    }
    let first: Vec<char> = stems[0].chars().collect();
    let shared = |of: &dyn Fn(&str, &str) -> bool, parts: Vec<String>| {
        parts
            .into_iter()
            .filter(|p| stems.iter().all(|s| of(s, p) && s.len() > p.len()))
            .max_by_key(String::len)
    };
    let prefix = shared(
        &|s, p| s.starts_with(p),
        (1..first.len())
            .map(|n| first[..n].iter().collect())
            .collect(),
    );
    let suffix = shared(
        &|s, p| s.ends_with(p),
        (1..first.len())
            .map(|n| first[n..].iter().collect())
            .collect(),
    );
    let bare = |text: &str| text.trim_matches(['_', '-', '.', ' ']).to_string();
    let plain = |text: &str, i: usize| {
        let kept: String = bare(text)
            .chars()
            .filter(|c| c.is_ascii_alphanumeric() || *c == '_')
            .collect();
        if kept.is_empty() {
            format!("logger{}", i + 1)
        } else {
            kept.to_lowercase()
        }
    };
    let (prefix, suffix) = (prefix.unwrap_or_default(), suffix.unwrap_or_default());
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
        (plain(&own, i), pattern)
    });
    (names.collect(), run.clone())
}
