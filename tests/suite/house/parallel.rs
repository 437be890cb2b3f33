//! Sums over pieces that threads take as they come: their last digits depend on how many threads there are.

use std::path::Path;

use super::files::{crates, root, rust_files};
use super::text::code_of;
use super::told;

/// What a parallel iterator may not end with: each adds in the order of pieces.
const ADDS: [&str; 8] = [
    "sum",
    "product",
    "reduce",
    "reduce_with",
    "fold",
    "fold_with",
    "try_reduce",
    "try_fold",
];
/// What may follow, since its order does not matter: a largest or least number, a conjunction.
const ORDERLESS: [&str; 6] = ["f64::max", "f64::min", "f32::max", "max(", "min(", "a && b"];

/// The methods that a parallel iterator which begins in `code` ends with, each with its arguments.
fn ends(code: &str) -> Vec<(String, String)> {
    const BEGINS: [&str; 5] = [
        ".par_iter",
        ".into_par_iter",
        ".par_chunks",
        ".par_bridge",
        ".par_windows",
    ];
    let mut found = Vec::new();
    for begin in BEGINS {
        for (at, _) in code.match_indices(begin) {
            found.extend(chain(&code[at..]));
        }
    }
    found
}

/// The methods of a chain of calls, with their arguments.
fn chain(code: &str) -> Vec<(String, String)> {
    let mut methods = Vec::new();
    let mut rest = code;
    while let Some(call) = rest.trim_start().strip_prefix('.') {
        let name: String = call
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect();
        let Some(open) = call.find('(') else { break };
        let mut depth = 0usize;
        let mut close = call.len();
        for (at, c) in call.char_indices().skip_while(|(at, _)| *at < open) {
            match c {
                '(' => depth += 1,
                ')' if depth == 1 => {
                    close = at;
                    break;
                }
                ')' => depth -= 1,
                _ => {}
            }
        }
        methods.push((name, call[open + 1..close].to_string()));
        rest = call[close..].strip_prefix(')').unwrap_or_default();
        rest = rest.trim_start().trim_start_matches('?');
        // What comes after a collection is done by one thread.
        if methods
            .last()
            .is_some_and(|(name, _)| name.starts_with("collect"))
        {
            break;
        }
    }
    methods
}

fn adds_in_any_order(code: &str) -> Vec<String> {
    let adds = |(name, arguments): &(String, String)| {
        ADDS.contains(&name.as_str()) && !ORDERLESS.iter().any(|o| arguments.contains(o))
    };
    let ends = ends(code).into_iter().filter(adds);
    ends.map(|(name, _)| name).collect()
}

#[test]
fn no_sum_depends_on_the_number_of_threads() {
    let mut faults = Vec::new();
    for folder in crates() {
        for path in rust_files(&folder.join("src")) {
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            for name in adds_in_any_order(&code_of(&text)) {
                let place = path.strip_prefix(root()).unwrap_or(Path::new(&path));
                faults.push(format!(
                    "{}: a parallel iterator ends in `{name}`; collect and add in order",
                    place.display()
                ));
            }
        }
    }
    told(faults);
}

#[test]
fn a_parallel_sum_is_found_and_one_within_a_piece_is_not() {
    let within = "x.par_iter().map(|r| r.iter().sum::<f64>()).collect::<Vec<_>>().iter().sum()";
    assert!(adds_in_any_order(within).is_empty());
    let largest = "x.par_chunks(8).map(|c| c[0]).reduce(|| 0.0, f64::max)";
    assert!(adds_in_any_order(largest).is_empty());
    let piecewise = "x\n.into_par_iter()\n.map(|r| (r, 1))\n.sum::<f64>()";
    assert_eq!(adds_in_any_order(piecewise), ["sum"]);
    let folded = "x.par_chunks(8).fold(|| 0.0, |a, c| a + c[0]).reduce(|| 0.0, |a, b| a + b)";
    assert_eq!(adds_in_any_order(folded), ["fold", "reduce"]);
}
