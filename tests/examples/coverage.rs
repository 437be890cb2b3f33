//! The table of docs/verification.md that says how often stated errors hold the true ones.
//!
//! `cargo run --release -p kufe-tests --example coverage -- all` solves every row of
//! tests/data/coverage.csv to 2, 0.5 and 0.1 %, without `all` one in ten to 2 %, with the names of
//! classes only their rows, with numbers only these accuracies, with a .csv the rows of that one,
//! drawn from another seed; what does not hold is listed after the table.

use kufe_tests::coverage::{Miss, Outcome, Row, rows, rows_of};

const ASKED: [f64; 3] = [0.02, 0.005, 0.001];

fn main() {
    let (all, others): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|word| word == "all");
    let (step, usual) = if !all.is_empty() {
        (1, &ASKED[..])
    } else {
        (10, &ASKED[..1])
    };
    let (files, others): (Vec<String>, Vec<String>) =
        others.into_iter().partition(|word| word.ends_with(".csv"));
    let drawn = match files.first() {
        Some(file) => rows_of(&std::fs::read_to_string(file).expect("a table of rows")),
        None => rows(),
    };
    let numbers: Vec<f64> = others.iter().filter_map(|word| word.parse().ok()).collect();
    let asked = if numbers.is_empty() { usual } else { &numbers };
    let wanted: Vec<&String> = others
        .iter()
        .filter(|w| w.parse::<f64>().is_err())
        .collect();
    let asked_for = |row: &Row| wanted.is_empty() || wanted.contains(&&row.class);
    let rows: Vec<Row> = drawn.into_iter().filter(asked_for).step_by(step).collect();
    let mut classes: Vec<&str> = rows.iter().map(|row| row.class.as_str()).collect();
    classes.dedup();
    println!(
        "| class | contacts | asked | reached | peak covered | area covered | approach covered | stated over true, peak | over the root of the true ones' mean square |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut misses = Vec::new();
    for class in classes {
        let of: Vec<&Row> = rows.iter().filter(|row| row.class == class).collect();
        for &asked in asked {
            let outcomes: Vec<(&Row, Outcome)> = of
                .iter()
                .filter_map(|row| match row.outcome(asked) {
                    Ok(outcome) => Some((*row, outcome)),
                    Err(error) => {
                        misses.push(format!("{} %: {}: {error}", 100.0 * asked, row.text));
                        None
                    }
                })
                .collect();
            let covered = [0, 1, 2].map(|k| share(&outcomes, k, asked, &mut misses));
            let reached = outcomes
                .iter()
                .filter(|(_, outcome)| outcome.reached)
                .count();
            println!(
                "| {class} | {} | {} % | {reached} | {} | {} | {} | {} |",
                of.len(),
                100.0 * asked,
                covered[0],
                covered[1],
                covered[2],
                ratio(&outcomes)
            );
        }
    }
    println!("\nNot covered:\n");
    for miss in misses {
        println!("- {miss}");
    }
}

/// How many of how many stated errors of figure `k` hold the true ones.
fn share(outcomes: &[(&Row, Outcome)], k: usize, asked: f64, misses: &mut Vec<String>) -> String {
    let (mut covered, mut known) = (0, 0);
    for (row, outcome) in outcomes {
        let Some(miss) = outcome.figures[k] else {
            continue;
        };
        known += 1;
        if row.holds(k, miss) {
            covered += 1;
        } else {
            let figure = ["peak", "area", "approach"][k];
            let (off, stated) = (100.0 * miss.off, 100.0 * miss.stated);
            let asked = 100.0 * asked;
            misses.push(format!(
                "{figure} off by {off:.3} %, {stated:.3} % stated, {asked} % asked: {}",
                row.text
            ));
        }
    }
    match known {
        0 => String::new(),
        _ => format!("{covered} of {known}"),
    }
}

/// The median of the stated error of the peak over the true one; and that of stated errors over the
/// root of the mean square of the true ones, which no true error that is next to nothing by chance
/// makes large.
fn ratio(outcomes: &[(&Row, Outcome)]) -> String {
    let peaks: Vec<Miss> = outcomes
        .iter()
        .filter_map(|(_, outcome)| outcome.figures[0])
        .filter(|miss| miss.stated > 0.0)
        .collect();
    if peaks.is_empty() {
        return " | ".into();
    }
    let median = |of: &dyn Fn(&Miss) -> f64| {
        let mut values: Vec<f64> = peaks.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let squares: f64 = peaks.iter().map(|miss| miss.off * miss.off).sum();
    let root = (squares / peaks.len() as f64).sqrt();
    format!(
        "{:.1} | {:.1}",
        median(&|miss| miss.stated / miss.off.max(1e-12)),
        median(&|miss| miss.stated) / root
    )
}
