//! How often the stated errors of the largest shear under the peak, and of its depth, hold the true
//! ones.
//!
//! `cargo run --release -p kufe-tests --example under_peak -- 20261127 40` draws 40 contacts from a
//! seed, solves each to 2 and 0.5 % of the peak and compares with the integral of point loads over
//! Hertz's ellipse; a line a contact, then one an accuracy.

use kufe_tests::coverage::Miss;
use kufe_tests::under_peak::drawn;

fn main() {
    let mut numbers = std::env::args()
        .skip(1)
        .map(|word| word.parse().expect("a number"));
    let (seed, count) = (numbers.next().unwrap_or(1), numbers.next().unwrap_or(20));
    let contacts = drawn(seed, count as usize);
    for asked in [0.02, 0.005] {
        let mut misses: [Vec<Miss>; 2] = Default::default();
        for contact in &contacts {
            let found = contact.outcome(asked).expect("a solution");
            let hertz = contact.hertz();
            println!(
                "a/b {:.1}, nu {:.2}, offset {:.2?}: shear {} ; depth {}",
                hertz.a / hertz.b,
                contact.ice[1],
                contact.offset,
                reported(found[0]),
                reported(found[1])
            );
            misses
                .iter_mut()
                .zip(found)
                .for_each(|(all, miss)| all.push(miss));
        }
        for (figure, misses) in ["shear", "depth"].iter().zip(&misses) {
            println!(
                "{} % asked, {figure}: {} of {} hold; median stated {:.3} %, off {:.3} %, stated over true {:.1}",
                100.0 * asked,
                misses.iter().filter(|m| m.off <= m.stated).count(),
                misses.len(),
                100.0 * median(misses, |m| m.stated),
                100.0 * median(misses, |m| m.off),
                median(misses, |m| m.stated / m.off.max(1e-12)),
            );
        }
    }
}

fn reported(miss: Miss) -> String {
    let covered = if miss.off <= miss.stated {
        ""
    } else {
        " NOT COVERED"
    };
    format!(
        "off {:.3} %, stated {:.3} %{covered}",
        100.0 * miss.off,
        100.0 * miss.stated
    )
}

fn median(misses: &[Miss], of: impl Fn(&Miss) -> f64) -> f64 {
    let mut values: Vec<f64> = misses.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
