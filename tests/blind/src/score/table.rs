//! The table by family, and the date it was made on.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::score::outcome::{BaseFound, Found, Outcome};

/// Rates of one group of outcomes.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Rates {
    /// Group: family, with its share where it has sizes.
    pub group: String,
    /// Cases with a report.
    pub cases: usize,
    /// Cases without a report.
    pub failures: usize,
    /// Share of cases with a false claim.
    pub false_claims: Option<f64>,
    /// Share of cases with a wrong firm name.
    pub wrong_firm: Option<f64>,
    /// Share of overconfident cases.
    pub overconfident: Option<f64>,
    /// Share of hidden effects named exactly.
    pub exact: Option<f64>,
    /// Share of hidden effects named exactly or inside a class.
    pub in_class: Option<f64>,
    /// Share of hidden effects that are in a class or reported as an error of the installation.
    pub reported: Option<f64>,
    /// Median size of that class.
    pub class_size: Option<f64>,
    /// Median explainable gap closed.
    pub closed: Option<f64>,
    /// Share of gap intervals that hold 1, the truth when an effect is modelled fully.
    pub closed_covers: Option<f64>,
    /// Share of parameter intervals that hold the truth.
    pub parameter_covers: Option<f64>,
    /// Share of local effects with an overlap of at least one half.
    pub placed: Option<f64>,
    /// Median seconds.
    pub seconds: Option<f64>,
}

fn rate(values: impl Iterator<Item = bool>) -> Option<f64> {
    let (mut yes, mut all) = (0, 0);
    for value in values {
        yes += usize::from(value);
        all += 1;
    }
    (all > 0).then(|| f64::from(yes as u32) / f64::from(all))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|v| v.is_finite());
    if values.is_empty() {
        return None;
    }
    values.sort_by(f64::total_cmp);
    let n = values.len();
    Some(0.5 * (values[(n - 1) / 2] + values[n / 2]))
}

/// Rates of the outcomes in one group.
pub fn rates(group: &str, outcomes: &[&Outcome]) -> Rates {
    let good: Vec<&Outcome> = outcomes
        .iter()
        .copied()
        .filter(|o| o.failure.is_none())
        .collect();
    let found: Vec<&Found> = good.iter().flat_map(|o| &o.found).collect();
    Rates {
        group: group.to_owned(),
        cases: good.len(),
        failures: outcomes.len() - good.len(),
        false_claims: rate(good.iter().map(|o| o.false_claim)),
        wrong_firm: rate(good.iter().map(|o| o.wrong_firm)),
        overconfident: rate(good.iter().map(|o| o.overconfident)),
        exact: rate(found.iter().map(|f| f.exact)),
        in_class: rate(found.iter().map(|f| f.in_class)),
        reported: rate(found.iter().map(|f| f.in_class || f.installed)),
        class_size: median(
            found
                .iter()
                .filter_map(|f| f.class_size.map(|n| n as f64))
                .collect(),
        ),
        closed: median(
            found
                .iter()
                .filter_map(|f| f.closed.map(|c| c[0]))
                .collect(),
        ),
        closed_covers: rate(
            found
                .iter()
                .filter_map(|f| f.closed.map(|c| c[1] <= 1.0 && 1.0 <= c[2])),
        ),
        parameter_covers: rate(found.iter().filter_map(|f| f.parameter_inside)),
        placed: rate(found.iter().filter_map(|f| f.overlap.map(|o| o >= 0.5))),
        seconds: median(good.iter().map(|o| o.seconds).collect()),
    }
}

/// Groups outcomes by a key, keys in order.
pub fn grouped(
    outcomes: &[Outcome],
    key: impl Fn(&Outcome) -> String,
) -> Vec<(String, Vec<&Outcome>)> {
    let mut groups: BTreeMap<String, Vec<&Outcome>> = BTreeMap::new();
    for outcome in outcomes {
        groups.entry(key(outcome)).or_default().push(outcome);
    }
    groups.into_iter().collect()
}

/// Family with its share.
pub fn family(outcome: &Outcome) -> String {
    match outcome.share {
        Some(share) => format!("{} @ {share}", outcome.family),
        None => outcome.family.clone(),
    }
}

/// The table as Markdown, with its date.
pub fn markdown(rows: &[Rates], date: &str) -> String {
    let mut text = format!("Blind cases, {date}\n\n");
    text.push_str(
        "| family | cases | failed | false claims | wrong firm | overconfident | exact | in class | or within tolerances | class size | gap closed | gap interval holds 1 | parameter inside | place overlap >= 0.5 | s |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let percent =
        |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{:.0} %", 100.0 * v));
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.1}"));
    for row in rows {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            row.group,
            row.cases,
            row.failures,
            percent(row.false_claims),
            percent(row.wrong_firm),
            percent(row.overconfident),
            percent(row.exact),
            percent(row.in_class),
            percent(row.reported),
            number(row.class_size),
            percent(row.closed),
            percent(row.closed_covers),
            percent(row.parameter_covers),
            percent(row.placed),
            number(row.seconds)
        );
    }
    text
}

/// Mean relative error of each base parameter after the effect was added, with its standard error,
/// and how many intervals hold the truth, over the outcomes that found what was hidden.
pub fn base_table(outcomes: &[Outcome]) -> String {
    let all_found = |o: &&Outcome| !o.found.is_empty() && o.found.iter().all(|f| f.in_class);
    let mut by_key: BTreeMap<&str, Vec<&BaseFound>> = BTreeMap::new();
    for base in outcomes.iter().filter(all_found).flat_map(|o| &o.base) {
        by_key.entry(&base.key).or_default().push(base);
    }
    let mut text = String::from(
        "| base parameter | cases | mean error | standard error | interval holds |\n|---|---|---|---|---|\n",
    );
    for (key, found) in by_key {
        let n = found.len() as f64;
        let mean = found.iter().map(|base| base.error).sum::<f64>() / n;
        let squares: f64 = found.iter().map(|base| (base.error - mean).powi(2)).sum();
        let spread = (squares / (n - 1.0).max(1.0)).sqrt();
        let reported: Vec<bool> = found.iter().filter_map(|base| base.inside).collect();
        let covered = reported.iter().filter(|inside| **inside).count();
        let _ = writeln!(
            text,
            "| {key} | {n} | {:+.2} % | {:.2} % | {covered} of {} |",
            100.0 * mean,
            100.0 * spread / n.sqrt(),
            reported.len()
        );
    }
    text
}

/// Shares from which on rows of [`by_share`] count; as large is what comes this near.
const SHARES: [f64; 3] = [0.007, 0.02, 0.06];
const NEAR: f64 = 0.95;

/// Results for effects in other worlds, by the share of the noise's variance that they have
/// outside what tolerances imitate; empty where there are none. Effects that reached their bounds before
/// the requested share are counted and omitted.
pub fn by_share(outcomes: &[Outcome]) -> String {
    let all: Vec<(f64, Option<f64>, &Found, &Outcome)> = outcomes
        .iter()
        .filter(|o| o.failure.is_none() && o.family.ends_with("-effect"))
        .flat_map(|o| o.found.iter().map(move |f| (f, o)))
        .filter_map(|(f, o)| f.share.map(|share| (share, o.share, f, o)))
        .collect();
    if all.is_empty() {
        return String::new();
    }
    let (bound, free): (Vec<_>, Vec<_>) = all.into_iter().partition(|(share, requested, ..)| {
        requested.is_some_and(|requested| *share < NEAR * requested)
    });
    let mut text = String::from(
        "| share after tolerances | effects | in class | reported as installation | not reported | a wrong name |\n|---|---|---|---|---|---|\n",
    );
    let mut row = |what: String, holds: &dyn Fn(f64) -> bool| {
        let of: Vec<(&Found, &Outcome)> = free
            .iter()
            .filter(|(share, ..)| holds(*share))
            .map(|(.., f, o)| (*f, *o))
            .collect();
        let percent = |is: &dyn Fn(&Found, &Outcome) -> bool| {
            rate(of.iter().map(|(f, o)| is(f, o)))
                .map_or("-".to_owned(), |v| format!("{:.0} %", 100.0 * v))
        };
        let _ = writeln!(
            text,
            "| {what} | {} | {} | {} | {} | {} |",
            of.len(),
            percent(&|f, _| f.in_class),
            percent(&|f, _| f.installed && !f.in_class),
            percent(&|f, o| o.claims.is_empty() && !f.installed),
            percent(&|_, o| o.false_claim),
        );
    };
    let percent = |share: f64| format!("{} %", (1e3 * share).round() / 10.0);
    for from in SHARES {
        let holds = |share: f64| share >= NEAR * from;
        row(format!("at least {}", percent(from)), &holds);
    }
    row(format!("below {}", percent(SHARES[0])), &|share| {
        share < NEAR * SHARES[0]
    });
    if !bound.is_empty() {
        let _ = writeln!(text, "\nleft out, at their bounds: {}", bound.len());
    }
    text
}

/// Today's date, UTC, as year-month-day.
pub fn today() -> String {
    let seconds = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .map_or(0, |d| d.as_secs());
    civil(seconds / 86_400)
}

/// Days since 1970-01-01 as a date of the Gregorian calendar.
fn civil(days: u64) -> String {
    // eras of 400 years from 0000-03-01
    let z = days + 719_468;
    let era = z / 146_097;
    let day_of_era = z % 146_097;
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 {
        shifted + 3
    } else {
        shifted - 9
    };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn shares_count_from_their_row_on_and_bounds_are_left_out() {
        let outcome = |requested: Option<f64>, share: f64, in_class: bool, installed: bool| {
            let found = json!([{"effect": "speed", "share": share, "exact": in_class, "in_class": in_class, "installed": installed}]);
            let claims = if in_class {
                json!([{"effect": "speed", "class": ["speed"]}])
            } else {
                json!([])
            };
            let whole = json!({"id": "", "family": "clean-effect", "share": requested, "seed": 1, "verdict": "", "claims": claims,
                "false_claim": false, "wrong_firm": false, "overconfident": false, "found": found, "base": [], "seconds": 1.0});
            serde_json::from_value::<Outcome>(whole).unwrap()
        };
        let text = by_share(&[
            outcome(Some(0.02), 0.0195, true, false),
            outcome(None, 0.3, false, true),
            outcome(None, 0.001, false, false),
            outcome(Some(0.02), 0.005, false, false),
        ]);
        for line in [
            "| at least 0.7 % | 2 | 50 % | 50 % | 0 % | 0 % |",
            "| at least 2 % | 2 | 50 % | 50 % | 0 % | 0 % |",
            "| at least 6 % | 1 | 0 % | 100 % | 0 % | 0 % |",
            "| below 0.7 % | 1 | 0 % | 0 % | 100 % | 0 % |",
            "left out, at their bounds: 1",
        ] {
            assert!(text.contains(line), "{line}\n{text}");
        }
        assert!(by_share(&[]).is_empty());
    }

    #[test]
    fn days_become_dates_of_the_calendar() {
        assert_eq!(civil(0), "1970-01-01");
        assert_eq!(civil(11_016), "2000-02-29");
        assert_eq!(civil(20_454), "2026-01-01");
    }

    #[test]
    fn median_of_an_even_count_is_the_middle() {
        assert_eq!(median(vec![4.0, 1.0, 3.0, 2.0]), Some(2.5));
        assert_eq!(median(vec![f64::NAN]), None);
    }
}
