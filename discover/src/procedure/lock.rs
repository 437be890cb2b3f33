//! Selection of held-out data: a deterministic rule, applied before noise and signs are examined.

use crate::procedure::rules::thresholds;

thresholds! {
    /// Amount of held-out data, by kind and layout.
    pub struct LockRules {
        /// Interval of held-out rows of experiments. Chosen.
        pub rows_every: usize = 5,
        /// Fewest rows of experiments of which any are held out. Chosen.
        pub fewest_rows: usize = 20,
        /// Interval of held-out segments of one run; and of runs, at least one in so many if their
        /// sessions are long enough. Chosen.
        pub every: usize = 4,
        /// Training runs that must remain. Derived: signs of eleven give p-values of 0.001.
        pub fewest_to_learn: usize = 11,
        /// Fewest sessions of which a whole one is held out. Chosen.
        pub fewest_sessions: usize = 6,
        /// Fewest tracks, maps and runs of a session of which one is held out. Derived: of two, the
        /// remaining one has none to compare with.
        pub fewest: usize = 3,
    }
}

/// Indices of training data and of held-out data, which are evaluated once, at the end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Split {
    pub training: Vec<usize>,
    pub held_out: Vec<usize>,
}

impl Split {
    fn of(count: usize, is_held_out: impl Fn(usize) -> bool) -> Self {
        let (held_out, training) = (0..count).partition(|i| is_held_out(*i));
        Self { training, held_out }
    }
}

/// Where a run was driven.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a> {
    pub session: &'a str,
    pub track: &'a str,
    pub driver: &'a str,
}

impl LockRules {
    /// Held-out runs.
    ///
    /// 1. With at least three tracks: the track with the fewest runs, if it has at most a quarter
    ///    of them (effects peculiar to a held-out track could not be found).
    /// 2. With at least six sessions: the whole middle session.
    /// 3. Single runs of sessions of at least three runs, at most half of a session: as many as
    ///    there are such sessions among every second one, or more up to a quarter of all runs while
    ///    eleven training runs remain.
    ///
    /// Each single run is of the track and driver with the smallest held-out share, so that all are
    /// both learned and tested. Ties go to the last run of every second session.
    pub fn runs(&self, runs: &[Place]) -> Split {
        let mut held_out = vec![false; runs.len()];
        let tracks = names(runs.iter().map(|r| r.track));
        let count = |track: &str| runs.iter().filter(|r| r.track == track).count();
        let rarest = tracks.iter().min_by_key(|track| count(track));
        let rarest =
            rarest.filter(|track| tracks.len() >= self.fewest && 4 * count(track) <= runs.len());
        let sessions = names(runs.iter().map(|r| r.session));
        let whole = sessions.get(sessions.len() / 2);
        let whole = whole.filter(|_| sessions.len() >= self.fewest_sessions);
        for (run, held_out) in runs.iter().zip(&mut held_out) {
            *held_out = Some(&run.track) == rarest || Some(&run.session) == whole;
        }
        let of_session = |(number, session): (usize, &&str)| {
            let last_first = (0..runs.len()).rev();
            let own: Vec<usize> = last_first
                .filter(|i| runs[*i].session == *session)
                .collect();
            let is_eligible = own.len() >= self.fewest && Some(session) != whole;
            is_eligible.then_some(EligibleSession {
                number,
                spare: own.len() / 2,
                runs: own,
            })
        };
        let mut eligible: Vec<EligibleSession> =
            sessions.iter().enumerate().filter_map(of_session).collect();
        let seconds = eligible.iter().filter(|session| session.number % 2 == 1);
        let already = held_out.iter().filter(|held_out| **held_out).count();
        let to_spare = runs.len().saturating_sub(self.fewest_to_learn);
        let fewest = to_spare.min(runs.len() / self.every.max(1));
        for _ in 0..seconds.count().max(fewest.saturating_sub(already)) {
            let Some((session, run)) = next_single_run(runs, &held_out, &eligible) else {
                break;
            };
            held_out[run] = true;
            eligible[session].spare -= 1;
        }
        if runs.len() >= 5 && !held_out.contains(&true) {
            held_out[runs.len() - 1] = true;
        }
        Split::of(runs.len(), |i| held_out[i])
    }

    /// Every fourth segment of one run.
    pub fn segments(&self, count: usize) -> Split {
        let every = self.every.max(1);
        Split::of(count, |i| i % every == every - 1)
    }

    /// Every fifth row, if there are enough.
    pub fn rows(&self, count: usize) -> Split {
        let every = self.rows_every.max(1);
        let enough = count >= self.fewest_rows;
        Split::of(count, |i| enough && i % every == every - 1)
    }

    /// The last map, if there are at least three.
    pub fn maps(&self, count: usize) -> Split {
        Split::of(count, |i| count >= self.fewest && i + 1 == count)
    }
}

/// A session of which single runs may be held out.
struct EligibleSession {
    number: usize,
    /// Its runs, from its last on.
    runs: Vec<usize>,
    /// How many more may be held out.
    spare: usize,
}

/// The run of the track and driver with the smallest held-out share, after the index of its session
/// in `sessions`. Ties go to the last run of every second session.
fn next_single_run(
    runs: &[Place],
    held_out: &[bool],
    sessions: &[EligibleSession],
) -> Option<(usize, usize)> {
    let share = |is_like: &dyn Fn(&Place) -> bool| {
        let like = (0..runs.len()).filter(|i| is_like(&runs[*i]));
        let locked = like.clone().filter(|i| held_out[*i]).count();
        locked as f64 / like.count() as f64
    };
    let order = |number: usize, before: usize, i: usize| {
        let by_track = share(&|run| run.track == runs[i].track);
        let by_driver = share(&|run| run.driver == runs[i].driver);
        (
            by_track + by_driver,
            (before, number.is_multiple_of(2), number),
        )
    };
    let mut available = Vec::new();
    for (k, session) in sessions.iter().enumerate().filter(|(_, s)| s.spare > 0) {
        for (before, i) in session.runs.iter().enumerate() {
            if !held_out[*i] {
                available.push((order(session.number, before, *i), (k, *i)));
            }
        }
    }
    let least = available.into_iter();
    let least = least.min_by(|(a, _), (b, _)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    least.map(|(_, session_and_run)| session_and_run)
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
