//! What a case of another world hides.

use super::wrong::{Fault, SPEED};

/// A hidden force, by the size in its law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Force {
    Temperature,
    Speed,
    SlipDrag,
    DragArea,
    AeroYaw,
    SpeedGrip,
    TemperatureGrip,
    LoadGrip,
    Camber,
    Relaxation,
    PitchGrip,
    HumpGrip,
    ProductGrip,
    PitchDip,
}

/// What an effect changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Acts {
    /// Ice or air.
    Force(Force),
    /// A channel of the recorder.
    Recorder(Fault),
    /// The mass that the model states is too small by so much [kg].
    Mass,
    /// The yaw inertia of the model is too small by this factor.
    YawInertia,
    /// The true centre of gravity lies so much ahead of the model's [m].
    Centre,
    /// A wall that pushes at one place in every run [N].
    Wall,
    /// Walls at several places that some runs hit, harder or softer; the size is the lever of the
    /// bumper [m].
    Bumper(Chance),
}

/// Who hits a wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Chance {
    /// Anybody, by chance.
    ByRun,
    /// By driver: one often and hard, one seldom and softly.
    ByDriver,
}

/// An effect that a world may hide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// Its name in reports.
    pub name: &'static str,
    /// What its case is called: its name, and its size where there are several.
    pub case: &'static str,
    /// What it changes.
    pub acts: Acts,
    /// Key and unit of its parameter.
    pub key: &'static str,
    /// Unit of its parameter.
    pub unit: &'static str,
    /// A size that somebody who looks for it would meet.
    pub size: f64,
    /// Whether both signs occur.
    pub both: bool,
    /// Names that nobody could tell from it on such runs.
    pub class: &'static [&'static str],
}

/// An effect of both signs in a class by itself.
pub const fn effect(
    name: &'static str,
    acts: Acts,
    key: &'static str,
    unit: &'static str,
    size: f64,
) -> Effect {
    Effect {
        name,
        case: name,
        acts,
        key,
        unit,
        size,
        both: true,
        class: &[],
    }
}

impl Effect {
    /// Of one sign alone.
    pub const fn positive(mut self) -> Effect {
        self.both = false;
        self
    }

    /// A case with a name of its own.
    pub const fn called(mut self, case: &'static str) -> Effect {
        self.case = case;
        self
    }

    /// With names that nobody could tell from it.
    pub const fn like(mut self, class: &'static [&'static str]) -> Effect {
        self.class = class;
        self
    }
}

/// An effect with the size it has in a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hidden {
    /// The effect.
    pub effect: Effect,
    /// Its size.
    pub size: f64,
    /// Where a wall pushes [m].
    pub place_m: [f64; 2],
    /// Factor on the pushes of walls that some runs hit, whose size is their lever.
    pub strength: f64,
}

impl Hidden {
    /// The size of this force; 0 where another one is hidden.
    pub fn force(&self, force: Force) -> f64 {
        match self.effect.acts {
            Acts::Force(hidden) if hidden == force => self.size,
            _ => 0.0,
        }
    }

    /// Whether it is a force: the sled and its sensors are as stated.
    pub fn is_force(&self) -> bool {
        use Acts::*;
        matches!(self.effect.acts, Force(_) | Wall | Bumper(_))
    }

    /// Whether runs on the first or the second road feel it.
    pub fn is_felt_on(&self, track: usize) -> bool {
        self.effect.acts != Acts::Wall || track == 0
    }

    /// The recorder's fault with its size, if it is one.
    pub fn fault(&self) -> Option<(Fault, f64)> {
        match self.effect.acts {
            Acts::Recorder(fault) => Some((fault, self.size)),
            _ => None,
        }
    }

    /// How much there is of it: its size without the sign, or the strength of walls.
    pub fn amount(&self) -> f64 {
        match self.effect.acts {
            Acts::Bumper(_) => self.strength,
            _ => self.size.abs(),
        }
    }

    /// The same effect, this much of it.
    pub fn of_amount(mut self, amount: f64) -> Hidden {
        match self.effect.acts {
            Acts::Bumper(_) => self.strength = amount,
            _ => self.size = amount.copysign(self.size),
        }
        self
    }

    /// The least and the most that there may be of it: what a sled, a rink or a recorder could
    /// still be taken for one with.
    pub fn bounds(&self) -> [f64; 2] {
        let most = match self.effect.acts {
            Acts::Force(force) => match force {
                Force::Temperature => 0.08,
                Force::TemperatureGrip => 0.05,
                Force::Speed => 1.5,
                Force::SlipDrag => 15.0,
                Force::DragArea => 0.25,
                Force::AeroYaw => 0.6,
                Force::SpeedGrip => 0.03,
                Force::LoadGrip | Force::PitchGrip => 0.7,
                Force::Camber => 3.0,
                Force::Relaxation => 2.0,
                Force::HumpGrip | Force::PitchDip | Force::ProductGrip => 0.5,
            },
            Acts::Recorder(fault) => match fault {
                // The other way: the lower it saturates the larger is the fault.
                Fault::Saturating(_) => return [0.2, 20.0],
                Fault::Bias(0..3) => 2.0,
                Fault::Bias(3..6) => 0.2,
                Fault::Bias(SPEED) | Fault::Stepping(_) => 3.0,
                Fault::Bias(_) | Fault::Warming(_) => 0.05,
                Fault::Scale(_) if self.size < 0.0 => 0.5,
                Fault::Scale(_) => 1.0,
                Fault::Delay(SPEED) => 1.0,
                Fault::Delay(_) => 0.1,
                Fault::Bowed(_) => 10.0,
            },
            Acts::Mass => 120.0,
            Acts::YawInertia if self.size < 0.0 => 0.5,
            Acts::YawInertia => 1.0,
            Acts::Centre => 0.3,
            Acts::Wall => 3000.0,
            Acts::Bumper(_) => 5.0,
        };
        [0.0, most]
    }

    /// Whether it shows along the track rather than across it.
    pub fn is_longitudinal(&self) -> bool {
        use Force::*;
        match self.effect.acts {
            Acts::Force(Temperature | Speed | SlipDrag | DragArea | AeroYaw) => true,
            Acts::Recorder(fault) => matches!(fault.channel(), 0 | SPEED),
            _ => false,
        }
    }
}
