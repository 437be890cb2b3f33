//! Runs the finder on cases and compares its reports with the answers.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::answer::{Answer, CaseError, Hides};
use crate::catalogue::Spec;

/// How the finder is run.
#[derive(Debug, Clone)]
pub struct Options {
    /// The `kufe` command.
    pub kufe: PathBuf,
    /// First seed.
    pub first_seed: u64,
    /// Seeds a case.
    pub seeds: u64,
    /// Cases at a time.
    pub jobs: usize,
    /// Limit for one run of the finder.
    pub limit: Duration,
    /// Folder that keeps data and reports; a temporary one where absent.
    pub keep: Option<PathBuf>,
}

/// One step of a report.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Claim {
    /// Name.
    pub effect: String,
    /// The class, the name included.
    pub class: Vec<String>,
    /// Explainable gap closed: value, low, high.
    pub closed: Option<[f64; 3]>,
}

/// What came of one hidden effect.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Found {
    /// Hidden effect.
    pub effect: String,
    /// Named itself.
    pub exact: bool,
    /// Named, or in the class of a named one.
    pub in_class: bool,
    /// Size of that class.
    pub class_size: Option<usize>,
    /// Explainable gap closed by that step: value, low, high.
    pub closed: Option<[f64; 3]>,
    /// Whether the parameter's interval holds the truth, where it could be compared.
    pub parameter_inside: Option<bool>,
    /// Overlap of the reported with the true stretches (intersection over union).
    pub overlap: Option<f64>,
}

/// What came of one case.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    /// Case.
    pub id: String,
    /// Family.
    pub family: String,
    /// Share asked for.
    pub share: Option<f64>,
    /// Seed.
    pub seed: u64,
    /// Why there is no report, if there is none.
    pub failure: Option<String>,
    /// Verdict.
    pub verdict: String,
    /// Claims in the report's order.
    pub claims: Vec<Claim>,
    /// A claim where nothing was hidden, or of something that is neither hidden nor tolerated.
    pub false_claim: bool,
    /// A single name, not of a class, that is not hidden.
    pub wrong_firm: bool,
    /// A single name where the data cannot carry one.
    pub overconfident: bool,
    /// Hidden effects.
    pub found: Vec<Found>,
    /// Relative errors of the base parameters in `model.next.toml`.
    pub base_errors: Vec<(String, f64)>,
    /// Time of the finder's run.
    pub seconds: f64,
}

/// Runs every case for every seed; `done` is called with each outcome as it comes.
pub fn score(
    specs: &[Spec],
    options: &Options,
    done: &(dyn Fn(&Outcome) + Sync),
) -> Result<Vec<Outcome>, CaseError> {
    let temporary = tempfile::tempdir().map_err(|source| CaseError::File {
        path: "temporary folder".into(),
        source,
    })?;
    let root = options
        .keep
        .clone()
        .unwrap_or_else(|| temporary.path().to_path_buf());
    // seeds outermost, so that an interrupted run has seen every case
    let tasks: Vec<(&Spec, u64)> = (0..options.seeds)
        .flat_map(|k| specs.iter().map(move |spec| (spec, options.first_seed + k)))
        .collect();
    let next = AtomicUsize::new(0);
    let outcomes = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..options.jobs.max(1) {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    let Some((spec, seed)) = tasks.get(k) else {
                        break;
                    };
                    let outcome = one(spec, *seed, options, &root);
                    done(&outcome);
                    outcomes
                        .lock()
                        .expect("no holder panics")
                        .push((k, outcome));
                }
            });
        }
    });
    let mut outcomes = outcomes.into_inner().expect("no holder panics");
    outcomes.sort_by_key(|(k, _)| *k);
    Ok(outcomes.into_iter().map(|(_, outcome)| outcome).collect())
}

/// Writes a case, runs the finder on it, and judges its report.
fn one(spec: &Spec, seed: u64, options: &Options, root: &Path) -> Outcome {
    let id = spec.id();
    let folder = spec.folder(seed);
    let data = root.join("data").join(&folder);
    let out = root.join("out").join(&folder);
    let mut outcome = Outcome {
        id,
        family: spec.family.to_owned(),
        share: spec.share,
        seed,
        failure: None,
        verdict: String::new(),
        claims: Vec::new(),
        false_claim: false,
        wrong_firm: false,
        overconfident: false,
        found: Vec::new(),
        base_errors: Vec::new(),
        seconds: 0.0,
    };
    let case = match spec.build(seed).and_then(|case| {
        case.write(&data, &root.join("answers").join(format!("{folder}.json")))?;
        Ok(case)
    }) {
        Ok(case) => case,
        Err(error) => {
            outcome.failure = Some(error.to_string());
            return outcome;
        }
    };
    let start = Instant::now();
    let threads = if options.jobs > 1 { 1 } else { 2 };
    match discover(
        &options.kufe,
        &data,
        &case.answer,
        &out,
        options.limit,
        threads,
    ) {
        Ok(report) => judge(&report, &case.answer, &mut outcome),
        Err(message) => outcome.failure = Some(message),
    }
    outcome.seconds = start.elapsed().as_secs_f64();
    if let Ok(text) = std::fs::read_to_string(out.join("model.next.toml")) {
        outcome.base_errors = base_errors(&text, &case.answer);
    }
    if options.keep.is_none() {
        // a folder that cannot be removed goes with the temporary root
        let _ = std::fs::remove_dir_all(&data);
        let _ = std::fs::remove_dir_all(&out);
    }
    outcome
}

/// Runs `kufe discover` inside the data folder and reads `report.json`.
fn discover(
    kufe: &Path,
    data: &Path,
    answer: &Answer,
    out: &Path,
    limit: Duration,
    threads: usize,
) -> Result<Value, String> {
    let log = data.with_extension("log");
    let file =
        std::fs::File::create(&log).map_err(|error| format!("{}: {error}", log.display()))?;
    let mut child = Command::new(kufe)
        .arg("discover")
        .arg(&answer.data)
        .arg("--model")
        .arg(&answer.model)
        .arg("-o")
        .arg(out)
        // several cases at a time fill the cores already
        .arg("--threads")
        .arg(threads.to_string())
        .current_dir(data)
        .stdout(Stdio::null())
        .stderr(file)
        .spawn()
        .map_err(|error| format!("{}: {error}", kufe.display()))?;
    let start = Instant::now();
    let status = loop {
        match child.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) if start.elapsed() > limit => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(format!("no answer within {} s", limit.as_secs()));
            }
            Ok(None) => std::thread::sleep(Duration::from_millis(20)),
            Err(error) => return Err(error.to_string()),
        }
    };
    let said = std::fs::read_to_string(&log).unwrap_or_default();
    let _ = std::fs::remove_file(&log);
    let report = out.join("report.json");
    let Ok(text) = std::fs::read_to_string(&report) else {
        let last = said
            .lines()
            .rev()
            .find(|line| !line.trim().is_empty())
            .unwrap_or("")
            .to_owned();
        return Err(format!("{status}, no report.json: {last}"));
    };
    serde_json::from_str(&text).map_err(|error| format!("report.json: {error}"))
}

fn triple(value: &Value) -> Option<[f64; 3]> {
    Some([
        value["value"].as_f64()?,
        value["low"].as_f64()?,
        value["high"].as_f64()?,
    ])
}

/// Compares a report with the answer.
pub fn judge(report: &Value, answer: &Answer, outcome: &mut Outcome) {
    outcome.verdict = report["verdict"].as_str().unwrap_or("").to_owned();
    let empty = Vec::new();
    let steps = report["steps"].as_array().unwrap_or(&empty);
    for step in steps {
        let effect = step["effect"].as_str().unwrap_or("").to_owned();
        let mut class: Vec<String> = step["class"]
            .as_array()
            .map(|names| {
                names
                    .iter()
                    .filter_map(|n| n.as_str().map(str::to_owned))
                    .collect()
            })
            .unwrap_or_default();
        if !class.contains(&effect) {
            class.push(effect.clone());
        }
        outcome.claims.push(Claim {
            effect,
            class,
            closed: triple(&step["explainable_gap_closed"]),
        });
    }
    let true_name = |name: &str| answer.hides.iter().any(|h| h.effect == name);
    let fair = |name: &str| {
        true_name(name)
            || answer.tolerated.iter().any(|t| t == name)
            || answer
                .hides
                .iter()
                .any(|h| h.class.iter().any(|c| c == name))
    };
    // a class is a fair claim when any of its names is
    outcome.false_claim = outcome
        .claims
        .iter()
        .any(|claim| !claim.class.iter().any(|name| fair(name)))
        || (answer.hides.is_empty() && outcome.claims.is_empty() && outcome.verdict == "located");
    outcome.wrong_firm = outcome.claims.iter().any(|claim| {
        claim.class.len() == 1
            && !claim.effect.starts_with("unknown:")
            && !true_name(&claim.effect)
            && !answer.tolerated.contains(&claim.effect)
    });
    outcome.overconfident =
        answer.too_little_to_name && outcome.claims.iter().any(|claim| claim.class.len() == 1);
    for hides in &answer.hides {
        let exact = outcome
            .claims
            .iter()
            .position(|claim| claim.effect == hides.effect);
        let at = exact.or_else(|| {
            outcome
                .claims
                .iter()
                .position(|claim| claim.class.contains(&hides.effect))
        });
        let claim = at.map(|k| &outcome.claims[k]);
        outcome.found.push(Found {
            effect: hides.effect.clone(),
            exact: exact.is_some(),
            in_class: at.is_some(),
            class_size: claim.map(|claim| claim.class.len()),
            closed: claim.and_then(|claim| claim.closed),
            parameter_inside: exact.and_then(|k| parameter_inside(&steps[k], hides)),
            overlap: at.and_then(|k| overlap(&steps[k], hides)),
        });
    }
}

/// Whether the interval of the parameter with the answer's key holds the truth.
fn parameter_inside(step: &Value, hides: &Hides) -> Option<bool> {
    let parameters = step["parameters"].as_array()?;
    let parameter = parameters
        .iter()
        .find(|p| p["name"].as_str() == Some(hides.key.as_str()))?;
    let (low, high) = (parameter["low"].as_f64()?, parameter["high"].as_f64()?);
    Some((low..=high).contains(&hides.size))
}

/// Stretches `s A-B m` of the report's `where`, or `from_m` and `to_m` among its parameters.
fn stretches(step: &Value) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    let text = step["where"].as_str().unwrap_or("");
    for part in text.split("s ").skip(1) {
        let mut numbers = part.splitn(2, ['-', '\u{2013}']);
        let (Some(from), Some(rest)) = (numbers.next(), numbers.next()) else {
            continue;
        };
        let to: String = rest
            .chars()
            .take_while(|c| c.is_ascii_digit() || *c == '.')
            .collect();
        if let (Ok(from), Ok(to)) = (from.trim().parse(), to.parse()) {
            found.push((from, to));
        }
    }
    if found.is_empty() {
        let of = |key: &str| {
            step["parameters"]
                .as_array()?
                .iter()
                .find(|p| p["name"].as_str() == Some(key))?["value"]
                .as_f64()
        };
        if let (Some(from), Some(to)) = (of("from_m"), of("to_m")) {
            found.push((from, to));
        }
    }
    found
}

/// Intersection over union, on a decimetre grid.
fn overlap(step: &Value, hides: &Hides) -> Option<f64> {
    if hides.places.is_empty() {
        return None;
    }
    let told = stretches(step);
    let inside =
        |list: &[(f64, f64)], s: f64| list.iter().any(|(from, to)| (*from..=*to).contains(&s));
    let truth: Vec<(f64, f64)> = hides
        .places
        .iter()
        .map(|(_, from, to)| (*from, *to))
        .collect();
    let end = truth
        .iter()
        .chain(&told)
        .map(|x| x.1)
        .fold(0.0, f64::max)
        .min(1e5);
    let (mut both, mut any) = (0.0, 0.0);
    for k in 0..=(end * 10.0) as usize {
        let s = k as f64 / 10.0;
        let (a, b) = (inside(&truth, s), inside(&told, s));
        both += f64::from(u8::from(a && b));
        any += f64::from(u8::from(a || b));
    }
    Some(if any > 0.0 { both / any } else { 0.0 })
}

/// Relative errors of the base parameters that the next model states.
fn base_errors(text: &str, answer: &Answer) -> Vec<(String, f64)> {
    let Ok(model) = text.parse::<toml::Table>() else {
        return Vec::new();
    };
    answer
        .base
        .iter()
        .filter_map(|(key, truth)| {
            let mut at = model.get(key.split('.').next()?)?;
            for part in key.split('.').skip(1) {
                at = at.get(part)?;
            }
            let value = at
                .as_float()
                .or_else(|| at.as_integer().map(|i| i as f64))?;
            Some((key.clone(), value / truth - 1.0))
        })
        .collect()
}
