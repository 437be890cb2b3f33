//! Coverage of the stated errors of the largest shear stress under the peak and of its depth.
//!
//! `cargo run --release -p kufe-tests --example under_peak -- 20261127 40` draws 40 contacts with a
//! seed and solves each to 2 and 0.5 % of the peak. The reference is the integral of point loads
//! over Hertz's ellipse. Prints a line for each contact and a summary for each accuracy.

use kufe_tests::coverage::ErrorPair;
use kufe_tests::under_peak::random_contacts;

fn main() {
    let mut numbers = std::env::args()
        .skip(1)
        .map(|word| word.parse().expect("a number"));
    let (seed, count) = (numbers.next().unwrap_or(1), numbers.next().unwrap_or(20));
    let contacts = random_contacts(seed, count as usize);
    for requested in [0.02, 0.005] {
        let mut errors: [Vec<ErrorPair>; 2] = Default::default();
        for contact in &contacts {
            let found = contact.errors(requested).expect("a solution");
            let hertz = contact.hertz();
            println!(
                "a/b {:.1}, nu {:.2}, offset {:.2?}: shear {} ; depth {}",
                hertz.a / hertz.b,
                contact.ice[1],
                contact.offset,
                reported(found[0]),
                reported(found[1])
            );
            errors
                .iter_mut()
                .zip(found)
                .for_each(|(all, pair)| all.push(pair));
        }
        for (quantity, errors) in ["shear", "depth"].iter().zip(&errors) {
            println!(
                "{} % requested, {quantity}: {} of {} covered; median stated {:.3} %, actual {:.3} %, stated over actual {:.1}",
                100.0 * requested,
                errors.iter().filter(|e| e.actual <= e.stated).count(),
                errors.len(),
                100.0 * median(errors, |e| e.stated),
                100.0 * median(errors, |e| e.actual),
                median(errors, |e| e.stated / e.actual.max(1e-12)),
            );
        }
    }
}

fn reported(errors: ErrorPair) -> String {
    let covered = if errors.actual <= errors.stated {
        ""
    } else {
        " NOT COVERED"
    };
    format!(
        "error {:.3} %, stated {:.3} %{covered}",
        100.0 * errors.actual,
        100.0 * errors.stated
    )
}

fn median(errors: &[ErrorPair], of: impl Fn(&ErrorPair) -> f64) -> f64 {
    let mut values: Vec<f64> = errors.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
