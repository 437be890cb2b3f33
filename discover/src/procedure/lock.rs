//! Selection of held-out data: a deterministic rule, applied before noise and signs are examined.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Amount of held-out data, by kind and layout.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LockRules {
    /// Interval of held-out rows of experiments. Chosen.
    pub rows_every: usize,
    /// Fewest rows of experiments of which any are held out. Chosen.
    pub fewest_rows: usize,
    /// Interval of held-out segments of one run; and of runs, at least one in so many if their
    /// sessions are long enough. Chosen.
    pub every: usize,
    /// Training runs that must remain. Derived: signs of eleven give p-values of 0.001.
    pub fewest_to_learn: usize,
    /// Fewest sessions of which a whole one is held out. Chosen.
    pub fewest_sessions: usize,
    /// Fewest tracks, maps and runs of a session of which one is held out. Derived: of two, the
    /// remaining one has none to compare with.
    pub fewest: usize,
}

impl Default for LockRules {
    fn default() -> Self {
        Self {
            rows_every: 5,
            fewest_rows: 20,
            every: 4,
            fewest_to_learn: 11,
            fewest_sessions: 6,
            fewest: 3,
        }
    }
}

/// Indices of training data and of held-out data, which are evaluated once, at the end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Split {
    pub training: Vec<usize>,
    pub held_out: Vec<usize>,
}

impl Split {
    fn of(held_out: &[bool]) -> Self {
        let pick = |wanted: bool| {
            (0..held_out.len())
                .filter(|i| held_out[*i] == wanted)
                .collect()
        };
        Self {
            training: pick(false),
            held_out: pick(true),
        }
    }
}

/// Where a run was driven.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a> {
    pub session: &'a str,
    pub track: &'a str,
    pub driver: &'a str,
}

/// Number of runs and of held-out runs by name.
#[derive(Default)]
struct Shares<'a>(BTreeMap<&'a str, [usize; 2]>);

impl<'a> Shares<'a> {
    fn count(&mut self, name: &'a str, held_out: bool) {
        let [all, locked] = self.0.entry(name).or_default();
        *all += 1;
        *locked += usize::from(held_out);
    }

    /// Holds out one more.
    fn lock(&mut self, name: &'a str) {
        self.0.entry(name).or_default()[1] += 1;
    }

    /// The share that is held out.
    fn of(&self, name: &str) -> f64 {
        let [all, locked] = self.0.get(name).copied().unwrap_or_default();
        locked as f64 / f64::max(all as f64, 1.0)
    }
}

impl LockRules {
    /// Held-out runs.
    ///
    /// With at least three tracks, the one with the fewest runs if it has at most a quarter of them
    /// (effects peculiar to a held-out track could not be found). With at least six sessions, the
    /// whole middle one. Then as many runs as every second session gives, one each, or as make up a
    /// quarter of all if eleven training runs remain, of sessions of at least three runs and at
    /// most half of one.
    ///
    /// Each is of the track and driver with the smallest held-out share, so that all are both
    /// learned and tested. Ties go to the last run of every second session.
    pub fn runs(&self, runs: &[Place]) -> Split {
        let mut held_out = vec![false; runs.len()];
        let tracks = names(runs.iter().map(|r| r.track));
        let count = |track: &str| runs.iter().filter(|r| r.track == track).count();
        if tracks.len() >= self.fewest
            && let Some(least) = tracks.iter().min_by_key(|track| count(track))
            && 4 * count(least) <= runs.len()
        {
            hold_out(&mut held_out, runs, |run| run.track == *least);
        }
        let sessions = names(runs.iter().map(|r| r.session));
        let whole = sessions.get(sessions.len() / 2);
        let whole = whole.filter(|_| sessions.len() >= self.fewest_sessions);
        if let Some(whole) = whole {
            hold_out(&mut held_out, runs, |run| run.session == *whole);
        }
        // Runs of each session that may be held out, from its last on.
        let mut own: Vec<Vec<usize>> = vec![Vec::new(); sessions.len()];
        for (i, run) in runs.iter().enumerate().rev() {
            if let Some(k) = sessions.iter().position(|session| *session == run.session) {
                own[k].push(i);
            }
        }
        let gives = |k: &usize| own[*k].len() >= self.fewest && Some(&sessions[*k]) != whole;
        let mut spare: Vec<usize> = own.iter().map(|own| own.len() / 2).collect();
        let mut locked = [Shares::default(), Shares::default()];
        for (run, held_out) in runs.iter().zip(&held_out) {
            locked[0].count(run.track, *held_out);
            locked[1].count(run.driver, *held_out);
        }
        let seconds = (1..own.len()).step_by(2).filter(gives).count();
        let already = held_out.iter().filter(|held_out| **held_out).count();
        let to_spare = runs.len().saturating_sub(self.fewest_to_learn);
        let fewest = to_spare.min(runs.len() / self.every.max(1));
        for _ in 0..seconds.max(fewest.saturating_sub(already)) {
            let sessions = (0..own.len()).filter(gives).filter(|k| spare[*k] > 0);
            let all =
                sessions.flat_map(|k| own[k].iter().enumerate().map(move |(n, i)| (k, n, *i)));
            let able = all.filter(|(.., i)| !held_out[*i]);
            let order = |(k, before, i): &(usize, usize, usize)| {
                let share = locked[0].of(runs[*i].track) + locked[1].of(runs[*i].driver);
                (share, (*before, k % 2 == 0, *k))
            };
            let next = able.min_by(|a, b| {
                let [a, b] = [order(a), order(b)];
                a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
            });
            let Some((k, _, i)) = next else { break };
            held_out[i] = true;
            spare[k] -= 1;
            locked[0].lock(runs[i].track);
            locked[1].lock(runs[i].driver);
        }
        if runs.len() >= 5 && !held_out.contains(&true) {
            held_out[runs.len() - 1] = true;
        }
        Split::of(&held_out)
    }

    /// Every fourth segment of one run.
    pub fn segments(&self, count: usize) -> Split {
        Split::of(&every(self.every, count))
    }

    /// Every fifth row, if there are enough.
    pub fn rows(&self, count: usize) -> Split {
        match count >= self.fewest_rows {
            true => Split::of(&every(self.rows_every, count)),
            false => Split::of(&vec![false; count]),
        }
    }

    /// The last map, if there are at least three.
    pub fn maps(&self, count: usize) -> Split {
        let held_out: Vec<bool> = (0..count)
            .map(|i| count >= self.fewest && i + 1 == count)
            .collect();
        Split::of(&held_out)
    }
}

fn every(step: usize, count: usize) -> Vec<bool> {
    let step = step.max(1);
    (0..count).map(|i| i % step == step - 1).collect()
}

/// Holds out the runs that satisfy `wanted`.
fn hold_out(held_out: &mut [bool], runs: &[Place], wanted: impl Fn(&Place) -> bool) {
    for (held_out, run) in held_out.iter_mut().zip(runs) {
        *held_out |= wanted(run);
    }
}

/// Each name once, in order of appearance.
fn names<'a>(all: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut list: Vec<&str> = Vec::new();
    for name in all {
        if !list.contains(&name) {
            list.push(name);
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_runs_a_whole_session_and_the_rarest_track_are_held_out() {
        let names: Vec<(String, &str)> = (0..18)
            .map(|i| {
                (
                    format!("s{}", i / 3),
                    if i < 2 {
                        "rare"
                    } else if i < 10 {
                        "a"
                    } else {
                        "b"
                    },
                )
            })
            .collect();
        let runs: Vec<Place> = names
            .iter()
            .map(|(session, track)| Place {
                session,
                track,
                driver: "",
            })
            .collect();
        let locked = LockRules::default().runs(&runs);
        assert_eq!(locked.held_out, [0, 1, 5, 9, 10, 11, 17]);
        assert_eq!(locked.training.len() + locked.held_out.len(), 18);
    }

    /// Ten sessions of four runs, on two tracks in turn; then by five drivers in turn.
    #[test]
    fn every_track_and_driver_has_a_held_out_share() {
        let sessions: Vec<String> = (1..=10).map(|k| format!("s{k}")).collect();
        let on = |session| {
            let k = sessions.iter().position(|s| s == session).unwrap_or(0);
            if k % 2 == 0 { "a" } else { "b" }
        };
        let runs: Vec<Place> = (0..40)
            .map(|i| &sessions[i / 4])
            .map(|session| Place {
                session,
                track: on(session),
                driver: "",
            })
            .collect();
        let locked = LockRules::default().runs(&runs);
        let on_a = locked.held_out.iter().filter(|i| runs[**i].track == "a");
        assert_eq!(locked.held_out.len(), 10);
        assert_eq!(on_a.count(), 5);
        assert!((20..24).all(|i| locked.held_out.contains(&i)));
        // On one track it is every second session.
        let alone: Vec<Place> = runs.iter().map(|r| Place { track: "a", ..*r }).collect();
        let locked = LockRules::default().runs(&alone);
        assert_eq!(locked.held_out, [3, 7, 11, 15, 20, 21, 22, 23, 31, 39]);
        let drivers = ["m", "n", "o", "p", "q"];
        let by_turns: Vec<Place> = runs
            .iter()
            .zip(drivers.iter().cycle())
            .map(|(run, driver)| Place { driver, ..*run })
            .collect();
        let locked = LockRules::default().runs(&by_turns);
        for driver in drivers {
            let own = locked
                .held_out
                .iter()
                .filter(|i| by_turns[**i].driver == driver);
            assert_eq!(own.count(), 2, "{driver}: {:?}", locked.held_out);
        }
    }

    #[test]
    fn few_runs_are_mostly_training_runs() {
        let place = Place {
            session: "",
            track: "a",
            driver: "m",
        };
        let locked = |count: usize| {
            LockRules::default()
                .runs(&vec![place; count])
                .held_out
                .len()
        };
        assert_eq!(
            [4, 5, 9, 11, 12, 13, 16, 44].map(locked),
            [0, 1, 1, 1, 1, 2, 4, 11]
        );
    }

    #[test]
    fn few_rows_and_maps_are_all_training_data() {
        let rules = LockRules::default();
        assert!(rules.rows(19).held_out.is_empty() && rules.maps(2).held_out.is_empty());
        assert_eq!(rules.rows(20).held_out, [4, 9, 14, 19]);
        assert_eq!(
            (rules.maps(3).held_out, rules.segments(8).held_out),
            (vec![2], vec![3, 7])
        );
    }
}
