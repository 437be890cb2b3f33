//! Claims in the track channel: slope, profile and the accelerometer's faults that look like them.

use super::*;

/// The track channel of a look, where it can be used.
pub(super) struct Surveyed {
    channel: TrackChannel,
    /// Slope and the accelerometer's faults that look like it.
    list: Vec<Candidate>,
    /// How well the slope is known [rad].
    sd: f64,
}

impl Surveyed {
    /// Whether the channel and what the forces say of a candidate go together; a candidate that it knows nothing of does.
    pub(super) fn agrees(&self, candidate: &Candidate, size: f64, error: f64) -> bool {
        let same = |c: &Candidate| c.effect == candidate.effect && c.key == candidate.key;
        self.list.iter().position(same).is_none_or(|c| {
            let seen = self.channel.judge(c, self.sd);
            (seen.size - size).abs() < 3.0 * seen.error.hypot(error)
        })
    }
}

impl Searcher<'_> {
    /// The channel, unless there is none, its runs disagree, or a slope fitted in it has already taken what it says.
    pub(super) fn surveyed(&mut self, chain: &Chain, maker: &TwinMaker) -> Option<Surveyed> {
        if !self.used[3] || !chain.frozen.is_empty() {
            return None;
        }
        let list: Vec<Candidate> = self
            .fresh(chain, &self.candidates.track)
            .into_iter()
            .filter(|c| !c.is_profile())
            .collect();
        let channel = TrackChannel::new(chain, self.training, &list)?;
        let stated = self.model.survey.map(|s| s.slope_sd_rad);
        if stated.is_none() && self.steps.is_empty() {
            self.remarks.push(
                "no [survey] in the model: a slope deviation of 0.002 rad is assumed".to_owned(),
            );
        }
        let quiet = maker.sensors_only();
        let twins: Vec<Frame> = self
            .training
            .iter()
            .enumerate()
            .map(|(i, frame)| quiet.pair(frame, chain, 5_000_003, i).plus)
            .collect();
        let expected = TrackChannel::new(chain, &twins, &[])?.scatter();
        if channel.scatter() > AGREES_WITHIN * expected {
            let told = format!(
                "from run to run the speed's derivative, the accelerometer and the track's slope disagree by {:.3} m/s2, the sensors' noise explains {expected:.3}: the track channel is not used, and slope, track-profile and the accelerometer's pitch are not judged",
                channel.scatter()
            );
            if self.steps.is_empty() {
                self.remarks.push(told);
            }
            return None;
        }
        Some(Surveyed {
            channel,
            list,
            sd: stated.unwrap_or(0.002),
        })
    }

    pub(super) fn on_the_track(&mut self, chain: &Chain, track: &Surveyed) -> Option<Pick> {
        let Surveyed { channel, list, sd } = track;
        let sd = *sd;
        // A sensor's fault also shows in the forces: what they contradict is no candidate.
        let agrees = |c: usize| {
            self.by_forces
                .iter()
                .find(|(known, ..)| known.effect == list[c].effect && known.key == list[c].key)
                .is_none_or(|(known, size, error)| track.agrees(known, *size, *error))
        };
        let able: Vec<usize> = (0..list.len()).filter(|c| agrees(*c)).collect();
        let at = |factor: f64| -> Option<usize> {
            able.iter()
                .copied()
                .filter(|c| channel.judge(*c, sd * factor).p_value <= ALPHA_TRACK)
                .max_by(|a, b| {
                    let z = |c: usize| {
                        (channel.judge(c, sd * factor).size / channel.judge(c, sd * factor).error)
                            .abs()
                    };
                    z(*a).total_cmp(&z(*b))
                })
        };
        if let Some(named) = at(1.0) {
            let seen = channel.judge(named, sd);
            let mut class = vec![list[named].effect.clone()];
            for j in able.iter().copied().filter(|j| *j != named) {
                if channel.beyond(named, j, sd).abs() < 2.0 {
                    class.push(list[j].effect.clone());
                }
            }
            if at(2.0).is_none() {
                self.depends.push(format!(
                    "{} stands out at the stated survey deviation but not at twice it",
                    list[named].effect
                ));
            }
            return Some(Pick {
                place: "all runs".to_owned(),
                channel: 3,
                candidate: list[named].clone(),
                size: seen.size,
                class,
                rivals: Vec::new(),
                p_value: seen.p_value,
                bias_t: None,
                track_error: Some(seen.error),
            });
        }
        let profile = self.candidates.track.iter().find(|c| c.is_profile())?;
        if chain
            .effects
            .active
            .iter()
            .any(|e| e.effect_name() == profile.effect)
        {
            return None;
        }
        let (p, track, from, to, slope, needed_sd) = channel.profile(sd);
        if p > ALPHA_TRACK {
            if channel.profile(0.5 * sd).0 <= ALPHA_TRACK && needed_sd > sd {
                self.remarks.push(format!("the track's profile would be off if its survey were twice as good as stated; {needed_sd:.5} rad fits it"));
            }
            return None;
        }
        if channel.profile(2.0 * sd).0 > ALPHA_TRACK {
            self.depends.push(format!(
                "the track's profile departs from its survey at the stated deviation of {sd:.5} rad, not at twice it; {needed_sd:.5} rad fits it"
            ));
        }
        let candidate = profile.within(&track, from, to);
        Some(Pick {
            place: format!(
                "s {from:.0}-{to:.0} m on track {track} most; the whole profile departs by {needed_sd:.5} rad"
            ),
            channel: 3,
            candidate,
            size: slope,
            class: vec![profile.effect.clone()],
            rivals: Vec::new(),
            p_value: p,
            bias_t: None,
            track_error: Some(needed_sd),
        })
    }
}
