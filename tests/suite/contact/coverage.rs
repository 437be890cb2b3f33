//! Coverage of stated errors in random contacts, on a subset of the rows of the example `coverage`.

use kufe_tests::coverage::rows;

/// Every seventh row at 2 %: all classes except "narrow flat".
#[test]
fn stated_errors_of_peaks_cover_in_95_percent_of_random_contacts() {
    let (mut covered, mut count, mut reported) = (0, 0, Vec::new());
    for row in rows().iter().step_by(7) {
        let outcome = row
            .outcome(0.02)
            .unwrap_or_else(|error| panic!("{}: {error}", row.text));
        let Some(errors) = outcome.errors[0] else {
            continue;
        };
        count += 1;
        if row.is_covered(0, errors) {
            covered += 1;
        } else {
            reported.push(format!("{}: {errors:?}", row.text));
        }
        assert!(outcome.reached, "{}", row.text);
        assert!(errors.actual < 0.02, "{}: {errors:?}", row.text);
    }
    assert!(count >= 30, "{count} rows");
    assert!(
        100 * covered >= 95 * count,
        "{covered} of {count}: {reported:?}"
    );
}
