//! Groups of runs.

use std::collections::{BTreeMap, HashMap};

/// Members of each group, groups in the order of their names.
pub fn members<'a>(names: impl Iterator<Item = &'a str>) -> BTreeMap<&'a str, Vec<usize>> {
    let mut groups: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (i, name) in names.enumerate() {
        groups.entry(name).or_default().push(i);
    }
    groups
}

/// Number of the session of each run, in the order in which they first appear.
pub fn session_numbers<'a>(sessions: impl Iterator<Item = &'a str>) -> Vec<usize> {
    let mut known: HashMap<&str, usize> = HashMap::new();
    let number = |session| {
        let next = known.len();
        *known.entry(session).or_insert(next)
    };
    sessions.map(number).collect()
}
