//! Which data are locked away until the end: a rule without chance, made before noise and signs are looked at.

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
}

impl LockRules {
    /// Of every second session of at least three runs its last run; with six sessions or more, one whole session (the
    /// middle one by name); with three tracks or more, the one with the fewest runs if it holds no more than a quarter of
    /// them (what is peculiar to a locked track could not be found).
    pub fn runs(&self, runs: &[Place]) -> Locked {
        let mut held = vec![false; runs.len()];
        let sessions = names(runs.iter().map(|r| r.session));
        for session in sessions.iter().skip(1).step_by(2) {
            let own: Vec<usize> = (0..runs.len())
                .filter(|i| runs[*i].session == *session)
                .collect();
            if own.len() >= self.fewest_in_session
                && let Some(last) = own.last()
            {
                held[*last] = true;
            }
        }
        if sessions.len() >= self.fewest_sessions {
            let middle = sessions[sessions.len() / 2];
            for (held, run) in held.iter_mut().zip(runs) {
                *held |= run.session == middle;
            }
        }
        let tracks = names(runs.iter().map(|r| r.track));
        let count = |track: &str| runs.iter().filter(|r| r.track == track).count();
        if tracks.len() >= self.fewest_tracks
            && let Some(least) = tracks.iter().min_by_key(|track| count(track))
            && 4 * count(least) <= runs.len()
        {
            for (held, run) in held.iter_mut().zip(runs) {
                *held |= run.track == *least;
            }
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

fn names<'a>(all: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut list: Vec<&str> = all.collect();
    list.sort_unstable();
    list.dedup();
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
            .map(|(session, track)| Place { session, track })
            .collect();
        let locked = LockRules::default().runs(&runs);
        assert_eq!(locked.held, [0, 1, 5, 9, 10, 11, 17]);
        assert_eq!(locked.training.len() + locked.held.len(), 18);
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
