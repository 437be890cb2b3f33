//! Which runs are locked away until the end.

use crate::evidence::runs::recordings::frame::Frame;

/// Indices of runs to learn from and of runs that are opened once, at the end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Locked {
    /// To learn from.
    pub training: Vec<usize>,
    /// Locked away.
    pub held: Vec<usize>,
}

/// A rule without chance: of every second session of at least three runs its last run; with six sessions or more, one
/// whole session (the middle one by name); with three tracks or more, the one with the fewest runs if it holds no more
/// than a quarter of them (what is peculiar to a locked track could not be found). Of segments, every fourth.
pub fn lock(frames: &[Frame], segmented: bool) -> Locked {
    let mut held = vec![false; frames.len()];
    if segmented {
        held.iter_mut().skip(3).step_by(4).for_each(|h| *h = true);
    } else {
        let names = |of: fn(&Frame) -> &str| -> Vec<String> {
            let mut list: Vec<String> = frames.iter().map(|f| of(f).to_owned()).collect();
            list.sort();
            list.dedup();
            list
        };
        let sessions = names(|f| &f.session);
        for session in sessions.iter().skip(1).step_by(2) {
            let runs: Vec<usize> = (0..frames.len())
                .filter(|i| frames[*i].session == *session)
                .collect();
            if runs.len() >= 3
                && let Some(last) = runs.last()
            {
                held[*last] = true;
            }
        }
        if sessions.len() >= 6 {
            let middle = &sessions[sessions.len() / 2];
            (0..frames.len())
                .filter(|i| frames[*i].session == *middle)
                .for_each(|i| held[i] = true);
        }
        let tracks = names(|f| &f.track);
        if tracks.len() >= 3
            && let Some((count, least)) = tracks
                .iter()
                .map(|t| (frames.iter().filter(|f| f.track == *t).count(), t))
                .min_by_key(|(count, _)| *count)
            && 4 * count <= frames.len()
        {
            (0..frames.len())
                .filter(|i| frames[*i].track == *least)
                .for_each(|i| held[i] = true);
        }
        if !held.iter().any(|h| *h) && frames.len() >= 5 {
            held[frames.len() - 1] = true;
        }
    }
    let pick = |wanted: bool| (0..frames.len()).filter(|i| held[*i] == wanted).collect();
    Locked {
        training: pick(false),
        held: pick(true),
    }
}
