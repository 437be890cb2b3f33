//! Leaving out again, and estimates with their errors.

use crate::error::Error;
use crate::evidence::runs::fit::estimate::{ESTIMATED, Estimate, STATED, estimate};
use crate::evidence::runs::fit::gauss_newton::{fit, residuals};
use crate::evidence::runs::model::chain::Chain;
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::searcher::Searcher;

impl Searcher<'_> {
    /// Leaves out again what the others have made superfluous.
    pub fn backward(
        &mut self,
        mut chain: Chain,
        free: &[usize],
    ) -> Result<(Chain, Whitener), Error> {
        let already = chain.effects.active.len() - self.owners.len();
        let mut step = 0;
        while self.steps.len() > 1 && step < self.steps.len() {
            let whitener = Whitener::estimate(&residuals(&chain, self.training), self.used);
            let estimates = self
                .estimates(&chain, &whitener, free)
                .0
                .split_off(free.len());
            let weak = chain
                .free()
                .iter()
                .zip(&estimates)
                .filter(|((e, _), _)| *e >= already && self.owners[*e - already] == step)
                .all(|(_, est)| (est.value / est.error.max(1e-300)).abs() < 1.5);
            if weak && self.owners.contains(&step) && self.steps[step].channel != "track" {
                self.remarks.push(format!(
                    "{} became superfluous once the others were there and was removed",
                    self.steps[step].effect
                ));
                let owners = std::mem::take(&mut self.owners);
                let mut place = 0;
                chain.effects.active.retain(|_| {
                    place += 1;
                    place <= already || owners[place - 1 - already] != step
                });
                self.owners = owners
                    .into_iter()
                    .filter(|o| *o != step)
                    .map(|o| o - usize::from(o > step))
                    .collect();
                self.steps.remove(step);
                chain = fit(&chain, self.training, free, self.used)?.0;
            } else {
                step += 1;
            }
        }
        fit(&chain, self.training, free, self.used)
    }

    /// Base parameters (as multipliers) first, then the effects' amplitudes, and the chain that holds them.
    pub fn estimates(
        &self,
        chain: &Chain,
        whitener: &Whitener,
        free: &[usize],
    ) -> (Vec<Estimate>, Chain) {
        // Where the noise is only estimated its bias is not known well enough to be taken off.
        let (trust, settle) = if self.data.noise_estimated {
            (ESTIMATED, false)
        } else {
            (STATED, true)
        };
        let maker = self.maker(chain);
        estimate(chain, whitener, self.training, free, &maker, trust, settle)
    }
}
