//! Which data are locked away until the end: a rule without chance, made before noise and signs are looked at.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// How much is locked away, by how the data are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LockRules {
    /// Of segments of one run, every so many-th. Chosen.
    pub segments_every: usize,
    /// Of rows of experiments, every so many-th. Chosen.
    pub rows_every: usize,
    /// Fewest rows of experiments of which any are locked away. Chosen.
    pub fewest_rows: usize,
    /// Fewest maps of which one is locked away. Chosen.
    pub fewest_maps: usize,
    /// Of runs, one in so many at least, where their sessions are long enough. Chosen.
    pub runs_every: usize,
    /// Runs that are left to learn from before so many are. Derived: signs of eleven give p-values of 0.001.
    pub fewest_to_learn: usize,
    /// Fewest runs of a session whose last is locked away. Chosen.
    pub fewest_in_session: usize,
    /// Fewest sessions of which a whole one is locked away. Chosen.
    pub fewest_sessions: usize,
    /// Fewest tracks of which one is locked away. Chosen.
    pub fewest_tracks: usize,
}

impl Default for LockRules {
    fn default() -> Self {
        Self {
            segments_every: 4,
            rows_every: 5,
            fewest_rows: 20,
            fewest_maps: 3,
            runs_every: 4,
            fewest_to_learn: 11,
            fewest_in_session: 3,
            fewest_sessions: 6,
            fewest_tracks: 3,
        }
    }
}

/// Indices of data to learn from and of data that are opened once, at the end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Locked {
    /// To learn from.
    pub training: Vec<usize>,
    /// Locked away.
    pub held: Vec<usize>,
}

impl Locked {
    fn of(held: &[bool]) -> Self {
        let pick = |wanted: bool| (0..held.len()).filter(|i| held[*i] == wanted).collect();
        Self {
            training: pick(false),
            held: pick(true),
        }
    }
}

/// Where a run was driven.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a> {
    /// Session.
    pub session: &'a str,
    /// Track.
    pub track: &'a str,
    /// Who drove.
    pub driver: &'a str,
}

/// How many runs there are by name, and how many of them are locked away.
#[derive(Default)]
struct Shares<'a>(BTreeMap<&'a str, [usize; 2]>);

impl<'a> Shares<'a> {
    /// Counts a run.
    fn count(&mut self, name: &'a str, held: bool) {
        let [all, locked] = self.0.entry(name).or_default();
        *all += 1;
        *locked += usize::from(held);
    }

    /// Locks one more away.
    fn lock(&mut self, name: &'a str) {
        self.0.entry(name).or_default()[1] += 1;
    }

    /// The share that is locked away.
    fn of(&self, name: &str) -> f64 {
        let [all, locked] = self.0.get(name).copied().unwrap_or_default();
        locked as f64 / f64::max(all as f64, 1.0)
    }
}

impl LockRules {
    /// With three tracks or more, the one with the fewest runs if it holds no more than a quarter of them (what is peculiar to a locked
    /// track could not be found); with six sessions or more, the whole middle one; then as many runs as every second session gives, one each,
    /// or as make up a quarter of all where eleven are left to learn from, of sessions of at least three runs and no more than half of one. Each is of the track and the driver of
    /// whom the smallest share is locked away, so that what differs between them is learned and judged of all; of those that are alike the
    /// last run of every second session comes first.
    pub fn runs(&self, runs: &[Place]) -> Locked {
        let mut held = vec![false; runs.len()];
        let tracks = names(runs.iter().map(|r| r.track));
        let count = |track: &str| runs.iter().filter(|r| r.track == track).count();
        if tracks.len() >= self.fewest_tracks
            && let Some(least) = tracks.iter().min_by_key(|track| count(track))
            && 4 * count(least) <= runs.len()
        {
            hold(&mut held, runs, |run| run.track == *least);
        }
        let sessions = names(runs.iter().map(|r| r.session));
        let whole = sessions.get(sessions.len() / 2);
        let whole = whole.filter(|_| sessions.len() >= self.fewest_sessions);
        if let Some(whole) = whole {
            hold(&mut held, runs, |run| run.session == *whole);
        }
        // Runs of each session that may give some, from its last on.
        let mut own: Vec<Vec<usize>> = vec![Vec::new(); sessions.len()];
        for (i, run) in runs.iter().enumerate().rev() {
            if let Some(k) = sessions.iter().position(|session| *session == run.session) {
                own[k].push(i);
            }
        }
        let gives =
            |k: &usize| own[*k].len() >= self.fewest_in_session && Some(&sessions[*k]) != whole;
        let mut left: Vec<usize> = own.iter().map(|own| own.len() / 2).collect();
        let mut locked = [Shares::default(), Shares::default()];
        for (run, held) in runs.iter().zip(&held) {
            locked[0].count(run.track, *held);
            locked[1].count(run.driver, *held);
        }
        let seconds = (1..own.len()).step_by(2).filter(gives).count();
        let already = held.iter().filter(|held| **held).count();
        let to_spare = runs.len().saturating_sub(self.fewest_to_learn);
        let fewest = to_spare.min(runs.len() / self.runs_every.max(1));
        for _ in 0..seconds.max(fewest.saturating_sub(already)) {
            let sessions = (0..own.len()).filter(gives).filter(|k| left[*k] > 0);
            let all =
                sessions.flat_map(|k| own[k].iter().enumerate().map(move |(n, i)| (k, n, *i)));
            let able = all.filter(|(.., i)| !held[*i]);
            let order = |(k, before, i): &(usize, usize, usize)| {
                let share = locked[0].of(runs[*i].track) + locked[1].of(runs[*i].driver);
                (share, (*before, k % 2 == 0, *k))
            };
            let next = able.min_by(|a, b| {
                let [a, b] = [order(a), order(b)];
                a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
            });
            let Some((k, _, i)) = next else { break };
            held[i] = true;
            left[k] -= 1;
            locked[0].lock(runs[i].track);
            locked[1].lock(runs[i].driver);
        }
        if runs.len() >= 5 && !held.contains(&true) {
            held[runs.len() - 1] = true;
        }
        Locked::of(&held)
    }

    /// Of the segments of one run every fourth.
    pub fn segments(&self, count: usize) -> Locked {
        Locked::of(&every(self.segments_every, count))
    }

    /// Of rows every fifth, where there are rows enough to spare.
    pub fn rows(&self, count: usize) -> Locked {
        match count >= self.fewest_rows {
            true => Locked::of(&every(self.rows_every, count)),
            false => Locked::of(&vec![false; count]),
        }
    }

    /// Of maps the last, where there are three or more.
    pub fn maps(&self, count: usize) -> Locked {
        let held: Vec<bool> = (0..count)
            .map(|i| count >= self.fewest_maps && i + 1 == count)
            .collect();
        Locked::of(&held)
    }
}

fn every(step: usize, count: usize) -> Vec<bool> {
    let step = step.max(1);
    (0..count).map(|i| i % step == step - 1).collect()
}

/// Locks away the runs of which `wanted` says so.
fn hold(held: &mut [bool], runs: &[Place], wanted: impl Fn(&Place) -> bool) {
    for (held, run) in held.iter_mut().zip(runs) {
        *held |= wanted(run);
    }
}

/// Each name once, in the order in which they come.
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
    fn last_runs_a_whole_session_and_the_rarest_track_are_locked_away() {
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
        assert_eq!(locked.held, [0, 1, 5, 9, 10, 11, 17]);
        assert_eq!(locked.training.len() + locked.held.len(), 18);
    }

    /// Ten sessions of four runs, on two tracks in turn; then by five drivers in turn.
    #[test]
    fn every_track_and_driver_has_its_share_locked_away() {
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
        let on_a = locked.held.iter().filter(|i| runs[**i].track == "a");
        // The sixth session is locked away as a whole.
        assert_eq!(locked.held.len(), 10);
        assert_eq!(on_a.count(), 5);
        assert!((20..24).all(|i| locked.held.contains(&i)));
        // On one track it is every second session.
        let alone: Vec<Place> = runs.iter().map(|r| Place { track: "a", ..*r }).collect();
        let locked = LockRules::default().runs(&alone);
        assert_eq!(locked.held, [3, 7, 11, 15, 20, 21, 22, 23, 31, 39]);
        let drivers = ["m", "n", "o", "p", "q"];
        let by_turns: Vec<Place> = runs
            .iter()
            .zip(drivers.iter().cycle())
            .map(|(run, driver)| Place { driver, ..*run })
            .collect();
        let locked = LockRules::default().runs(&by_turns);
        for driver in drivers {
            let own = locked
                .held
                .iter()
                .filter(|i| by_turns[**i].driver == driver);
            assert_eq!(own.count(), 2, "{driver}: {:?}", locked.held);
        }
    }

    #[test]
    fn of_few_runs_most_are_learned_from() {
        let place = Place {
            session: "",
            track: "a",
            driver: "m",
        };
        let locked = |count: usize| LockRules::default().runs(&vec![place; count]).held.len();
        assert_eq!(
            [4, 5, 9, 11, 12, 13, 16, 44].map(locked),
            [0, 1, 1, 1, 1, 2, 4, 11]
        );
    }

    #[test]
    fn few_rows_and_maps_are_all_learned_from() {
        let rules = LockRules::default();
        assert!(rules.rows(19).held.is_empty() && rules.maps(2).held.is_empty());
        assert_eq!(rules.rows(20).held, [4, 9, 14, 19]);
        assert_eq!(
            (rules.maps(3).held, rules.segments(8).held),
            (vec![2], vec![3, 7])
        );
    }
}
