//! Runs the finder on cases.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::cases::answer::{Answer, CaseError, fresh_folder};
use crate::cases::catalogue::Spec;
use crate::score::fresh::compared;
use crate::score::judge::{base_found, judge};
use crate::score::outcome::Outcome;

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
    /// Rules of judgement for the finder; its own where absent.
    pub rules: Option<PathBuf>,
    /// Whether the finder searches for the hidden effects and for no others.
    pub only_hidden: bool,
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
    let answer_file = root.join("answers").join(format!("{folder}.json"));
    let mut outcome = Outcome {
        id,
        family: spec.label.family.to_owned(),
        share: spec.label.share,
        seed,
        failure: None,
        verdict: String::new(),
        claims: Vec::new(),
        false_claim: false,
        wrong_firm: false,
        overconfident: false,
        found: Vec::new(),
        base: Vec::new(),
        seconds: 0.0,
        cpu_seconds: None,
        adequate: None,
        fresh: None,
    };
    let case = match spec.build(seed).and_then(|case| {
        case.write(&data, &answer_file)?;
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
    let answered = discover(
        options,
        &data,
        &case.answer,
        &out,
        threads,
        &mut outcome.cpu_seconds,
    );
    outcome.seconds = start.elapsed().as_secs_f64();
    match answered {
        Ok(report) => {
            outcome.adequate = report["adequate"].as_bool();
            judge(&report, &case.answer, &mut outcome);
            if let Ok(next) = std::fs::read_to_string(out.join("model.next.toml")) {
                outcome.base = base_found(&next, &report, &case.answer);
            }
        }
        Err(message) => outcome.failure = Some(message),
    }
    if !case.fresh.is_empty() && outcome.failure.is_none() {
        let written = out.join("model.next.toml");
        match compared(
            &options.kufe,
            &fresh_folder(&answer_file),
            &data.join("model.toml"),
            &written,
        ) {
            Ok(fresh) => outcome.fresh = Some(fresh),
            Err(message) => outcome.failure = Some(message),
        }
    }
    if options.keep.is_none() {
        // a folder that cannot be removed goes with the temporary root
        let _ = std::fs::remove_dir_all(&data);
        let _ = std::fs::remove_dir_all(fresh_folder(&answer_file));
        let _ = std::fs::remove_dir_all(&out);
    }
    outcome
}

/// Processor time of a running process and its threads [s], from Linux's `/proc`: fields 14 and 15
/// of `stat` (proc_pid_stat(5)), in hundredths of a second.
fn cpu(process: u32) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The second field is a name in parentheses, which may contain anything.
    let mut fields = stat.rsplit(')').next()?.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / 100.0)
}

/// What the finder calls a hidden effect, or all that no name of its catalogue is.
fn name_of(effect: &str) -> String {
    let beyond = effect.starts_with("unknown:") || effect.starts_with("beyond:");
    String::from(if beyond { "unknown" } else { effect })
}

/// Runs `kufe discover` inside the data folder and reads `report.json`.
fn discover(
    options: &Options,
    data: &Path,
    answer: &Answer,
    out: &Path,
    threads: usize,
    cpu_seconds: &mut Option<f64>,
) -> Result<Value, String> {
    let (kufe, limit) = (&options.kufe, options.limit);
    let log = data.with_extension("log");
    let file =
        std::fs::File::create(&log).map_err(|error| format!("{}: {error}", log.display()))?;
    let rules = options.rules.iter();
    let hidden = answer.hides.iter().filter(|_| options.only_hidden);
    let hidden: Vec<String> = hidden.map(|h| name_of(&h.effect)).collect();
    let mut child = Command::new(kufe)
        .arg("discover")
        .args(rules.flat_map(|path| [Path::new("--rules"), path.as_path()]))
        .args(hidden.iter().flat_map(|name| ["--only", name.as_str()]))
        .arg(&answer.data)
        .args(answer.model.iter().flat_map(|model| ["--model", model]))
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
        *cpu_seconds = cpu(child.id()).or(*cpu_seconds);
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
    let log_text = std::fs::read_to_string(&log).unwrap_or_default();
    let _ = std::fs::remove_file(&log);
    let report = out.join("report.json");
    let Ok(text) = std::fs::read_to_string(&report) else {
        let last = log_text
            .lines()
            .rev()
            .find(|line| !line.trim().is_empty())
            .unwrap_or("")
            .to_owned();
        return Err(format!("{status}, no report.json: {last}"));
    };
    serde_json::from_str(&text).map_err(|error| format!("report.json: {error}"))
}
