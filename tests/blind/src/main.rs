//! `blind`: writes blind cases for `kufe discover` and scores its answers.
//!
//! Exit codes: 0 ok, 1 a threshold missed, 2 usage, 3 bad input.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::time::Duration;

use clap::{Parser, Subcommand};
use kufe_blind::score::{Options, Outcome, open_table, score};
use kufe_blind::{catalogue, ci, constants, table};

#[derive(Parser)]
#[command(name = "blind", about = "Blind cases for kufe discover")]
struct Arguments {
    #[command(subcommand)]
    command: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Lists the cases.
    List,
    /// Writes cases: data in one folder, answers in another, a name for each case in both.
    Write {
        /// Comma-separated beginnings of case names, `@0.02` behind one or alone for a size, or
        /// `all`.
        #[arg(long)]
        families: String,
        /// Seeds a case.
        #[arg(long, default_value_t = 1)]
        seeds: u64,
        /// First seed.
        #[arg(long, default_value_t = 1)]
        first_seed: u64,
        /// Folder for the data.
        #[arg(long)]
        data: PathBuf,
        /// Folder for the answers.
        #[arg(long)]
        answers: PathBuf,
    },
    /// Runs the finder on cases and prints a table by family.
    Score {
        #[command(flatten)]
        how: How,
        /// Comma-separated beginnings of case names, `@0.02` behind one or alone for a size, or
        /// `all`.
        #[arg(long, default_value = "all")]
        families: String,
        /// Seeds a case.
        #[arg(long, default_value_t = 20)]
        seeds: u64,
        /// First seed.
        #[arg(long, default_value_t = 1)]
        first_seed: u64,
        /// File for the outcomes, one JSON object a line, written as they come.
        #[arg(long)]
        save: Option<PathBuf>,
        /// One row a case instead of a family.
        #[arg(long)]
        by_case: bool,
        /// Let the finder search for the hidden effect and for no other: what it misses then, these
        /// data do not contain.
        #[arg(long)]
        only_hidden: bool,
    },
    /// Prints the table of saved outcomes.
    Table {
        /// Files that `score --save` wrote.
        files: Vec<PathBuf>,
        /// One row a case instead of a family.
        #[arg(long)]
        by_case: bool,
    },
    /// Runs the fixed subset and checks its thresholds.
    Ci {
        #[command(flatten)]
        how: How,
    },
    /// Prints the score at half and at twice each chosen constant of a search, on a few cheap
    /// cases.
    Constants {
        #[command(flatten)]
        how: How,
        /// The usual rules: what `cargo run --release -p kufe-discover --example rules` prints.
        #[arg(long)]
        rules: PathBuf,
        /// Only constants whose key holds one of these words.
        #[arg(long, value_delimiter = ',')]
        only: Vec<String>,
    },
}

#[derive(clap::Args)]
struct How {
    /// The `kufe` command.
    #[arg(long)]
    kufe: PathBuf,
    /// Cases at a time.
    #[arg(long, default_value_t = 2)]
    jobs: usize,
    /// Seconds allowed for one case.
    #[arg(long, default_value_t = 300)]
    limit: u64,
    /// Folder that keeps data, answers and reports.
    #[arg(long)]
    keep: Option<PathBuf>,
}

impl How {
    fn options(self, first_seed: u64, seeds: u64) -> std::io::Result<Options> {
        Ok(Options {
            kufe: std::path::absolute(self.kufe)?,
            first_seed,
            seeds,
            jobs: self.jobs,
            limit: Duration::from_secs(self.limit),
            keep: self.keep.map(std::path::absolute).transpose()?,
            rules: None,
            only_hidden: false,
        })
    }
}

fn main() -> ExitCode {
    match run(Arguments::parse().command) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(message) => {
            eprintln!("blind: {message}");
            ExitCode::from(3)
        }
    }
}

fn run(task: Task) -> Result<bool, String> {
    match task {
        Task::List => {
            let ids: String = catalogue::all()
                .iter()
                .map(|spec| spec.id() + "\n")
                .collect();
            say(&ids)?;
            Ok(true)
        }
        Task::Write {
            families,
            seeds,
            first_seed,
            data,
            answers,
        } => {
            let specs = catalogue::chosen(&families).map_err(|error| error.to_string())?;
            for seed in first_seed..first_seed + seeds {
                for spec in &specs {
                    let case = spec.build(seed).map_err(|error| error.to_string())?;
                    let name = spec.folder(seed);
                    case.write(&data.join(&name), &answers.join(format!("{name}.json")))
                        .map_err(|error| error.to_string())?;
                }
            }
            Ok(true)
        }
        Task::Score {
            how,
            families,
            seeds,
            first_seed,
            save,
            by_case,
            only_hidden,
        } => {
            let specs = catalogue::chosen(&families).map_err(|error| error.to_string())?;
            let options = how.options(first_seed, seeds);
            let options = Options {
                only_hidden,
                ..options.map_err(|error| error.to_string())?
            };
            let file = save
                .map(|path| {
                    std::fs::File::create(&path)
                        .map_err(|error| format!("{}: {error}", path.display()))
                })
                .transpose()?
                .map(Mutex::new);
            let outcomes = score(&specs, &options, &|outcome| tell(outcome, file.as_ref()))
                .map_err(|error| error.to_string())?;
            print(&outcomes, by_case)?;
            Ok(true)
        }
        Task::Table { files, by_case } => {
            let mut outcomes = Vec::new();
            for path in files {
                let text = std::fs::read_to_string(&path)
                    .map_err(|error| format!("{}: {error}", path.display()))?;
                for (row, line) in text.lines().enumerate() {
                    let outcome: Outcome = serde_json::from_str(line)
                        .map_err(|error| format!("{}: row {}: {error}", path.display(), row + 1))?;
                    outcomes.push(outcome);
                }
            }
            print(&outcomes, by_case)?;
            Ok(true)
        }
        Task::Ci { how } => {
            let specs = ci::specs();
            let options = how
                .options(ci::FIRST_SEED, ci::SEEDS)
                .map_err(|error| error.to_string())?;
            let outcomes = score(&specs, &options, &|outcome| tell(outcome, None))
                .map_err(|error| error.to_string())?;
            print(&outcomes, false)?;
            let missed = ci::missed(&outcomes);
            for line in &missed {
                say(&format!("missed: {line}\n"))?;
            }
            Ok(missed.is_empty())
        }
        Task::Constants { how, rules, only } => {
            let text = std::fs::read_to_string(&rules)
                .map_err(|error| format!("{}: {error}", rules.display()))?;
            let options = how.options(0, 0).map_err(|error| error.to_string())?;
            let rows = constants::constants(&text, &only, &options, &|row| {
                eprintln!(
                    "{} {} {:e}: {} of {} in class, {} false claims",
                    row.kind, row.key, row.value, row.in_class, row.hidden, row.false_claims
                );
            })
            .map_err(|error| error.to_string())?;
            say(&constants::markdown(&rows))?;
            Ok(true)
        }
    }
}

fn tell(outcome: &Outcome, file: Option<&Mutex<std::fs::File>>) {
    let claims: Vec<String> = outcome
        .claims
        .iter()
        .map(|c| format!("{} of {}", c.effect, c.class.len()))
        .collect();
    let what = outcome
        .failure
        .clone()
        .unwrap_or_else(|| format!("{} [{}]", outcome.verdict, claims.join(", ")));
    eprintln!(
        "{} seed {} {:.1} s: {what}",
        outcome.id, outcome.seed, outcome.seconds
    );
    if let Some(file) = file {
        let line = serde_json::to_string(outcome).expect("an outcome is plain data");
        let mut file = file.lock().expect("no holder panics");
        if let Err(error) = writeln!(file, "{line}") {
            eprintln!("blind: outcomes not saved: {error}");
        }
    }
}

/// Prints on standard output; a reader that has gone away has read enough.
fn say(text: &str) -> Result<(), String> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(format!("standard output: cannot be written: {error}"))
        }
        _ => Ok(()),
    }
}

fn print(outcomes: &[Outcome], by_case: bool) -> Result<(), String> {
    let key = |outcome: &Outcome| {
        if by_case {
            outcome.id.clone()
        } else {
            table::family(outcome)
        }
    };
    let rows: Vec<_> = table::grouped(outcomes, key)
        .iter()
        .map(|(group, of)| table::rates(group, of))
        .collect();
    say(&format!(
        "{}\n{}\n{}\n{}",
        table::markdown(&rows, &table::today()),
        table::by_share(outcomes),
        table::base_table(outcomes),
        open_table(outcomes)
    ))
}
