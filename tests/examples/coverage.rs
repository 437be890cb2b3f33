//! Coverage of stated errors, as reported in docs/verification.md.
//!
//! `cargo run --release -p kufe-tests --example coverage` solves every tenth row of
//! tests/data/coverage.csv to 2 % and prints a table, then the errors that are not covered.
//! Arguments:
//!
//! - `all`: every row, to 2, 0.5 and 0.1 %
//! - a number: this requested error instead
//! - the name of a class: only its rows
//! - a .csv file: its rows instead

use kufe_tests::coverage::{ErrorPair, Outcome, Row, rows, rows_of};

const REQUESTED: [f64; 3] = [0.02, 0.005, 0.001];

fn main() {
    let (all, others): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|word| word == "all");
    let (step, usual) = if !all.is_empty() {
        (1, &REQUESTED[..])
    } else {
        (10, &REQUESTED[..1])
    };
    let (files, others): (Vec<String>, Vec<String>) =
        others.into_iter().partition(|word| word.ends_with(".csv"));
    let table = match files.first() {
        Some(file) => rows_of(&std::fs::read_to_string(file).expect("a table of rows")),
        None => rows(),
    };
    let numbers: Vec<f64> = others.iter().filter_map(|word| word.parse().ok()).collect();
    let tolerances = if numbers.is_empty() { usual } else { &numbers };
    let classes: Vec<&String> = others
        .iter()
        .filter(|w| w.parse::<f64>().is_err())
        .collect();
    let selected = |row: &Row| classes.is_empty() || classes.contains(&&row.class);
    let rows: Vec<Row> = table.into_iter().filter(selected).step_by(step).collect();
    let mut classes: Vec<&str> = rows.iter().map(|row| row.class.as_str()).collect();
    classes.dedup();
    println!(
        "| class | contacts | requested | reached | peak covered | area covered | approach covered | stated over true, peak | stated over root mean square, peak |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut not_covered = Vec::new();
    for class in classes {
        let of: Vec<&Row> = rows.iter().filter(|row| row.class == class).collect();
        for &requested in tolerances {
            let outcomes: Vec<(&Row, Outcome)> = of
                .iter()
                .filter_map(|row| match row.outcome(requested) {
                    Ok(outcome) => Some((*row, outcome)),
                    Err(error) => {
                        not_covered.push(format!("{} %: {}: {error}", 100.0 * requested, row.text));
                        None
                    }
                })
                .collect();
            let covered = [0, 1, 2].map(|k| share(&outcomes, k, requested, &mut not_covered));
            let reached = outcomes
                .iter()
                .filter(|(_, outcome)| outcome.reached)
                .count();
            println!(
                "| {class} | {} | {} % | {reached} | {} | {} | {} | {} |",
                of.len(),
                100.0 * requested,
                covered[0],
                covered[1],
                covered[2],
                ratio(&outcomes)
            );
        }
    }
    println!("\nNot covered:\n");
    for line in not_covered {
        println!("- {line}");
    }
}

/// Number of covered errors of quantity `k` (0: peak, 1: area, 2: approach), and of all with a
/// reference value. Appends the others to `not_covered`.
fn share(
    outcomes: &[(&Row, Outcome)],
    k: usize,
    requested: f64,
    not_covered: &mut Vec<String>,
) -> String {
    let (mut covered, mut total) = (0, 0);
    for (row, outcome) in outcomes {
        let Some(errors) = outcome.errors[k] else {
            continue;
        };
        total += 1;
        if row.is_covered(k, errors) {
            covered += 1;
        } else {
            let quantity = ["peak", "area", "approach"][k];
            let (actual, stated) = (100.0 * errors.actual, 100.0 * errors.stated);
            let requested = 100.0 * requested;
            not_covered.push(format!(
                "{quantity} error {actual:.3} %, {stated:.3} % stated, {requested} % requested: {}",
                row.text
            ));
        }
    }
    match total {
        0 => String::new(),
        _ => format!("{covered} of {total}"),
    }
}

/// Median ratio of stated to actual error of the peak, and median stated error over the root mean
/// square of the actual errors. Actual errors near zero have no effect on the second.
fn ratio(outcomes: &[(&Row, Outcome)]) -> String {
    let peaks: Vec<ErrorPair> = outcomes
        .iter()
        .filter_map(|(_, outcome)| outcome.errors[0])
        .filter(|errors| errors.stated > 0.0)
        .collect();
    if peaks.is_empty() {
        return " | ".into();
    }
    let median = |of: &dyn Fn(&ErrorPair) -> f64| {
        let mut values: Vec<f64> = peaks.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let squares: f64 = peaks.iter().map(|p| p.actual * p.actual).sum();
    let root = (squares / peaks.len() as f64).sqrt();
    format!(
        "{:.1} | {:.1}",
        median(&|p| p.stated / p.actual.max(1e-12)),
        median(&|p| p.stated) / root
    )
}
