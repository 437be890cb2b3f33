//! The largest order of convergence that is believed of values that a rim moves.

use std::sync::Arc;

use kufe_mesh::Paraboloid;

use crate::accuracy::estimators::{HIGHEST_ORDER, Limit, MeshValue};
use crate::accuracy::meshes::{Meshes, Verdict};
use crate::problem::check::CheckedProblem;
use crate::{Error, Ice, Load, Options, Problem, Runner, Tilt};

/// The order as it is, at half and at twice.
const ORDERS: [f64; 3] = [0.5 * HIGHEST_ORDER, HIGHEST_ORDER, 2.0 * HIGHEST_ORDER];
const TOLERANCES: [f64; 2] = [0.02, 0.005];

/// A contact on ice that yields, with the approach that rectangles give it and what they know it
/// to.
struct Row {
    problem: Problem,
    approach: f64,
    known_to: f64,
}

/// Those of `tests/data/coverage.csv`, or of the table that `KUFE_ROWS` names.
fn rows() -> Vec<Row> {
    let table = match std::env::var_os("KUFE_ROWS") {
        Some(path) => std::fs::read_to_string(path).expect("a table of rows"),
        None => include_str!("../../../tests/data/coverage.csv").into(),
    };
    let row = |line: &str| {
        let cells: Vec<f64> = line
            .split(',')
            .skip(1)
            .map(|n| n.parse().expect("a number"))
            .collect();
        let runner = Runner::rigid(Arc::new(
            Paraboloid::new(cells[0], cells[1]).expect("radii"),
        ));
        let ice = Ice {
            hardness: Some(cells[10]),
            ..Ice::half_space(9e9, 0.33)
        };
        Row {
            problem: Problem::new(runner, ice, Load::central(cells[3], Tilt::Free)),
            approach: cells[16],
            known_to: cells[17],
        }
    };
    let yields = table
        .lines()
        .filter(|line| line.starts_with("ice that yields,"));
    yields.map(row).collect()
}

/// The approach of a contact solved to an accuracy, by each of [`ORDERS`]: what decides when meshes
/// do is the area, whatever these say.
fn approaches(problem: &Problem, tolerance: f64) -> Result<[Limit; 3], Error> {
    let options = Options {
        p_max_tolerance: tolerance,
        ..Options::default()
    };
    let mut meshes = Meshes::guess(CheckedProblem::bearable(problem, &options)?, Vec::new())?;
    loop {
        let contact = meshes.solve_next()?;
        match meshes.judge(&contact) {
            Verdict::Reached(_) | Verdict::OutOfReach(_) => {
                return Ok(ORDERS.map(|order| meshes.solved.approach_by_rim_up_to(order)));
            }
            Verdict::Refine(plan) => meshes.refine(contact, plan),
            Verdict::Widen(found) => meshes.widen(&contact, &found)?,
        }
    }
}

/// The share of limits that hold 1, known to so much, and the median of what they state over what
/// they are off by.
fn reported(limits: &mut [(Limit, f64)]) -> [f64; 2] {
    let off = |(limit, _): &(Limit, f64)| (limit.value - 1.0).abs();
    let covered = limits.iter().filter(|l| off(l) <= l.0.error + l.1).count();
    let mut ratios: Vec<f64> = limits
        .iter()
        .map(|l| l.0.error / off(l).max(1e-12))
        .collect();
    ratios.sort_by(f64::total_cmp);
    [
        covered as f64 / limits.len() as f64,
        ratios[ratios.len() / 2],
    ]
}

/// A generator of numbers in [-1, 1) (G. Marsaglia's xorshift, 2003).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Three meshes of 3 to 8 cells and twice as many, with limit 1: a smooth error of an order of 0.5
/// to 3 and of 0.1 to 10 % on the coarsest, and one of the rim between nodes of 0.1 to 1 times
/// that, which falls with the cells' size to the power 1.5.
fn sequence(random: &mut Random) -> [MeshValue; 3] {
    let first = (5.5 + 2.5 * random.next()).floor();
    let (order, error) = (
        1.75 + 1.25 * random.next(),
        10f64.powf(-2.0 + random.next()),
    );
    let rim = error * 10f64.powf(0.5 * random.next() - 0.5);
    let second = (first * 2f64.sqrt()).round();
    [first, second, 2.0 * first].map(|cells| {
        let h = first / cells;
        MeshValue {
            cells,
            value: 1.0 - error * h.powf(order) + rim * h.powf(1.5) * random.next(),
        }
    })
}

/// `cargo test --release -p kufe-contact highest -- --ignored --nocapture`; with `KUFE_ROWS`
/// another table's rows.
#[test]
#[ignore = "slow study: .ci/slow"]
fn the_highest_order_holds_errors_at_half_and_twice_itself() {
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    let sequences: Vec<[MeshValue; 3]> = (0..20_000).map(|_| sequence(&mut random)).collect();
    let rows = rows();
    let solved: Vec<Vec<([Limit; 3], f64)>> = TOLERANCES
        .iter()
        .map(|&tolerance| {
            let of = |row: &Row| {
                let part = |l: Limit| Limit {
                    value: l.value / row.approach,
                    error: l.error / row.approach,
                };
                (
                    approaches(&row.problem, tolerance)
                        .expect("a contact")
                        .map(part),
                    row.known_to,
                )
            };
            rows.iter().map(of).collect()
        })
        .collect();
    println!("| order | sequences covered | stated over true | contacts at 2 % | | at 0.5 % | |");
    println!("|---|---|---|---|---|---|---|");
    for (k, &order) in ORDERS.iter().enumerate() {
        let mut made: Vec<(Limit, f64)> = sequences
            .iter()
            .map(|&meshes| (Limit::richardson_at_rim(meshes, order), 0.0))
            .collect();
        let [covered, ratio] = reported(&mut made);
        print!("| {order} | {:.1} % | {ratio:.1} |", 100.0 * covered);
        for of in &solved {
            let mut limits: Vec<(Limit, f64)> =
                of.iter().map(|(l, known)| (l[k], *known)).collect();
            let [covered, ratio] = reported(&mut limits);
            print!(
                " {:.0} % of {} | {ratio:.1} |",
                100.0 * covered,
                limits.len()
            );
            // One in twenty may be off, and of few one.
            let least = 0.95f64.min(1.0 - 1.0 / limits.len() as f64);
            assert!(order != HIGHEST_ORDER || covered >= least, "{covered}");
        }
        println!();
        // Rims of contacts move less: theirs are covered more often.
        assert!(order != HIGHEST_ORDER || covered >= 0.9, "{covered}");
    }
}
