//! Splitting of classes and combination of p-values, by data with stated results.

use crate::error::Result;
use crate::finding::{Rival, Step};
use crate::joint::indexed::{Indexed, KindEvidence};
use crate::joint::kinds::{Joint, JointFit, PartFit};
use crate::options::Options;
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{
    Account, Description, Evidence, ExtendedFit, HeldOutResults, Screen, Selection,
};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::shared_effects::{Amount, ScreenEstimate, SharesEffects};

/// Data that know some effects, each with one size; a fit is the name of the effect added last.
#[derive(Default)]
struct StatedData {
    sizes: Vec<Amount>,
    screen_estimates: Vec<ScreenEstimate>,
    is_untestable: Vec<&'static str>,
    of_the_air: Vec<&'static str>,
    decrease: Option<Decrease>,
}

impl Evidence for StatedData {
    type Act = ();
    type Fit = String;
    fn fit_base(&mut self, _: &mut Account) -> Result<String> {
        Ok(String::new())
    }
    fn screen(&mut self, _: &String, _: &mut Account) -> Result<Screen<()>> {
        unreachable!("not used here")
    }
    fn add(
        &mut self,
        _: &String,
        selection: &Selection<()>,
        _: usize,
    ) -> Result<ExtendedFit<String>> {
        Ok(ExtendedFit {
            fit: selection.candidate.effect.clone(),
            is_writable: true,
            rms: [0.0, 0.0],
            place: None,
        })
    }
    fn remove_superfluous(&mut self, fit: String, _: &mut Account) -> Result<String> {
        Ok(fit)
    }
    fn without(&mut self, fit: &String, _: usize) -> Result<String> {
        Ok(fit.clone())
    }
    fn misfit_decrease(&self, _: &String, _: &String) -> Result<Option<Decrease>> {
        Ok(self.decrease.clone())
    }
    fn compare(&mut self, _: &String, _: &String, _: &[Step]) -> Result<HeldOutResults> {
        unreachable!("not used here")
    }
    fn describe(&mut self, _: &String, _: &String, _: &mut Account) -> Result<Description> {
        unreachable!("not used here")
    }
}

impl SharesEffects for StatedData {
    fn screen_estimates(&self) -> &[ScreenEstimate] {
        &self.screen_estimates
    }
    fn is_common(&self, effect: &str) -> bool {
        !self.of_the_air.contains(&effect)
    }
    fn is_untestable(&self, effect: &str) -> bool {
        self.is_untestable.contains(&effect)
    }
    fn select(&mut self, _: &String, amount: &Amount) -> Option<Selection<()>> {
        let known = self.sizes.iter().any(|own| own.is_same(amount));
        known.then(|| selection_of(&amount.effect, amount.value, &[]).with_act(()))
    }
    fn amounts(&self, fit: &String, _: usize) -> Vec<Amount> {
        let own = self.sizes.iter().filter(|own| own.effect == *fit);
        own.cloned().collect()
    }
}

fn amount(effect: &str, value: f64, error: f64) -> Amount {
    Amount {
        effect: effect.to_owned(),
        key: "size".to_owned(),
        unit: String::new(),
        value,
        error,
    }
}

fn chance(effect: &str, value: f64, error: f64, p_value: f64) -> ScreenEstimate {
    ScreenEstimate {
        amount: amount(effect, value, error),
        p_value,
    }
}

fn selection_of(effect: &str, size: f64, rivals: &[(&str, f64)]) -> Selection<usize> {
    let rival = |(name, size): &(&str, f64)| Rival {
        effect: (*name).to_owned(),
        parameter: "size".to_owned(),
        size: *size,
        unit: String::new(),
        t: 10.0,
        gain: 100.0,
        correlation: 0.99,
        t_of_named_beyond: 0.0,
        in_class: true,
        decides: String::new(),
    };
    Selection {
        candidate: Candidate {
            effect: effect.to_owned(),
            key: "size".to_owned(),
            unit: String::new(),
            low: -10.0,
            high: 10.0,
            typical: 1.0,
            decides: String::new(),
            act: 0,
        },
        size,
        error: size.abs() / 10.0,
        class: [effect]
            .into_iter()
            .chain(rivals.iter().map(|r| r.0))
            .map(str::to_owned)
            .collect(),
        rivals: rivals.iter().map(rival).collect(),
        p_value: 1e-3,
        randomised: Default::default(),
        place: String::new(),
        channel: ("along", "N"),
        remark: None,
        parameters: Vec::new(),
    }
}

fn with_joint<T>(stated: [StatedData; 2], of: impl FnOnce(&mut Joint, &JointFit) -> T) -> T {
    let options = Options::default();
    let parts = ["runs", "experiments"].into_iter().zip(stated);
    let parts = parts.map(|(name, stated)| {
        let mut indexed = Indexed::new(stated);
        let fit = indexed.fit_base(&mut Account::default());
        assert_eq!(fit.ok(), Some(0));
        (name, Box::new(indexed) as KindEvidence)
    });
    let mut joint = Joint::new(parts.collect(), &options);
    let part = PartFit {
        free: 0,
        written: 0,
        steps: Vec::new(),
    };
    let fit = JointFit {
        parts: vec![part.clone(), part],
        estimates: Vec::new(),
    };
    of(&mut joint, &fit)
}

fn of_class(own: StatedData, other: StatedData, rivals: &[(&str, f64)]) -> (String, Vec<String>) {
    with_joint([own, other], |joint, fit| {
        let selection = selection_of("humidity", 1.0, rivals);
        let joint = joint.with_joint_class(fit, 0, &selection);
        joint.map_or_else(
            |error| (error.to_string(), Vec::new()),
            |selection| (selection.candidate.effect, selection.class),
        )
    })
}

#[test]
fn other_data_split_a_class_by_their_estimates() {
    let runs = || StatedData {
        sizes: vec![amount("temperature", 0.5, 0.05)],
        ..StatedData::default()
    };
    let ice_house = |humidity: f64, temperature: f64| StatedData {
        sizes: vec![
            amount("humidity", humidity, 0.1),
            amount("temperature", temperature, 0.05),
        ],
        ..StatedData::default()
    };
    let rivals = [("temperature", 0.5)];
    // The ice house measures the temperature at the size of the runs and no humidity.
    let (named, class) = of_class(runs(), ice_house(0.0, 0.5), &rivals);
    assert_eq!((named.as_str(), class.len()), ("temperature", 1));
    // It confirms the humidity instead.
    let (named, class) = of_class(runs(), ice_house(1.0, 0.0), &rivals);
    assert_eq!((named.as_str(), class.len()), ("humidity", 1));
    // It measures both at their sizes, or knows neither, or cannot measure one.
    let (_, class) = of_class(runs(), ice_house(1.0, 0.5), &rivals);
    assert_eq!(class, ["humidity", "temperature"]);
    let (_, class) = of_class(runs(), StatedData::default(), &rivals);
    assert_eq!(class, ["humidity", "temperature"]);
    let blind = StatedData {
        sizes: vec![amount("humidity", 1.0, 0.1)],
        is_untestable: vec!["temperature"],
        ..StatedData::default()
    };
    let (_, class) = of_class(runs(), blind, &rivals);
    assert_eq!(class, ["humidity", "temperature"]);
}

fn weakly(
    own: Vec<ScreenEstimate>,
    other: Vec<ScreenEstimate>,
    of_the_air: Vec<&'static str>,
) -> Option<(String, f64)> {
    let of = |screen_estimates: Vec<ScreenEstimate>| StatedData {
        sizes: screen_estimates.iter().map(|c| c.amount.clone()).collect(),
        screen_estimates,
        ..StatedData::default()
    };
    let other = StatedData {
        of_the_air,
        ..of(other)
    };
    with_joint([of(own), other], |joint, fit| {
        let selection = joint.weak_together(fit, &Account::default());
        selection.map(|selection| (selection.candidate.effect, selection.p_value))
    })
}

#[test]
fn two_kinds_together_select_an_effect_that_none_selects_alone() {
    let of = |size: f64, p: f64| vec![chance("temperature", size, 0.3, p)];
    let found = weakly(of(1.0, 0.01), of(1.1, 0.01), Vec::new());
    let q: f64 = 1e-4;
    let p = q * (1.0 - q.ln());
    assert!(found.is_some_and(|(name, own)| name == "temperature" && (own / p - 1.0).abs() < 1e-9));
    // Different signs, too weak, different bodies, or one kind alone.
    assert_eq!(weakly(of(1.0, 0.01), of(-1.0, 0.01), Vec::new()), None);
    assert_eq!(weakly(of(1.0, 0.05), of(1.0, 0.2), Vec::new()), None);
    assert_eq!(
        weakly(of(1.0, 0.01), of(1.0, 0.01), vec!["temperature"]),
        None
    );
    assert_eq!(weakly(of(1.0, 1e-4), Vec::new(), Vec::new()), None);
}
