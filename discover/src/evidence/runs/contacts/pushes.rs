//! Pushes of a single run at a place that others pass: they do not repeat and are no evidence.

use kufe_sled::effects::Effect;
use rayon::prelude::*;

use crate::evidence::runs::campaign::Campaign;
use crate::evidence::runs::contacts::MIN_HITS;
use crate::evidence::runs::contacts::find::{Stretch, stretches};
use crate::evidence::runs::contacts::model::{at_stretch, wall};
use crate::evidence::runs::contacts::run_contacts::{
    contacts_of, residuals_without, without_contacts,
};
use crate::evidence::runs::contacts::selection::Lever;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::evidence::Account;

/// A push of one run.
struct Push {
    run: usize,
    stretch: Stretch,
    force_n: f64,
}

impl Campaign<'_> {
    /// Marks pushes that no other run shares; if contacts cannot be selected, also pushes that up
    /// to half of the runs of a track share, and those beyond the runners.
    ///
    /// Training samples there are excluded, with a remark that names runs and places. Returns
    /// whether there are any. Pushes of held-out runs, detected together with these, do not count
    /// in any comparison.
    pub fn mark_pushes(&mut self, model: &ResidualModel, account: &mut Account) -> bool {
        let Some(effect) = wall().filter(|_| self.used[1] && self.used[2] && !self.data.segmented)
        else {
            return false;
        };
        let found = self.find_contacts(model);
        let lever = found.as_ref().map(|found| found.lever);
        let learned = self.whole().len();
        let all: Vec<Frame> = self.whole().iter().chain(&self.held_out).cloned().collect();
        let residual = residuals_without(model, &all);
        let side: Vec<Vec<f64>> = residual.iter().map(|l| l[1].clone()).collect();
        let pushes = |seen: usize| {
            let runs = (&all[..seen], &side[..seen]);
            self.pushes(effect, runs, learned, lever)
        };
        let of_training = pushes(learned);
        for push in pushes(all.len()) {
            if let Some(index) = push.run.checked_sub(learned) {
                let Stretch { from_m, to_m, .. } = push.stretch;
                self.held_out[index].pushed.push([from_m, to_m]);
            }
        }
        let mut frames = all;
        frames.truncate(learned);
        let mut descriptions = Vec::new();
        for push in of_training {
            let Stretch { from_m, to_m, .. } = push.stretch;
            let frame = &mut frames[push.run];
            frame.pushed.push([from_m, to_m]);
            let (name, force_n) = (&frame.name, push.force_n);
            descriptions.push(format!(
                "{name} ({force_n:.0} N, s {from_m:.0}-{to_m:.0} m)"
            ));
        }
        if descriptions.is_empty() {
            return false;
        }
        self.training = frames.iter().map(without_contacts).collect();
        self.whole = frames;
        account.unexplained = found
            .filter(|found| found.lever != Lever::Between)
            .map(|found| found.unexplained());
        account.remarks.push(format!(
            "runs were pushed aside, possibly by a wall; their samples there are omitted: {}",
            descriptions.join(", ")
        ));
        true
    }

    /// The pushes that too few of the first `learned` runs share to be learned from. `side` is the
    /// lateral residual of each run at every retained sample.
    fn pushes(
        &self,
        effect: &'static Effect,
        (frames, side): (&[Frame], &[Vec<f64>]),
        learned: usize,
        lever: Option<Lever>,
    ) -> Vec<Push> {
        let rules = self.options.rules.runs.contacts;
        let mut pushes = Vec::new();
        for stretch in stretches(frames, side, &rules, None) {
            let place = [at_stretch(effect, &stretch)];
            let own: Vec<_> = frames
                .par_iter()
                .zip(side)
                .map(|(frame, y)| contacts_of(frame, y, &place))
                .collect();
            let hit: Vec<usize> = (0..own.len()).filter(|i| !own[*i].is_empty()).collect();
            let on = |f: &&Frame| f.track == stretch.track;
            let runs = frames[..learned].iter().filter(on).count();
            let most = match lever {
                Some(Lever::Between) => MIN_HITS - 1,
                Some(Lever::Beyond) => runs,
                Some(Lever::AtRunner) | None => runs / 2,
            };
            if hit.iter().filter(|run| **run < learned).count() > most {
                continue;
            }
            pushes.extend(hit.into_iter().map(|run| Push {
                run,
                stretch: stretch.clone(),
                force_n: own[run][0].contact.force_n,
            }));
        }
        pushes
    }
}
