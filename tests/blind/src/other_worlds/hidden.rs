//! What a case of another world hides.

use super::wrong::Fault;

/// A hidden force, by the size that stands in its law.
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
    /// Walls at several places that some runs hit, harder or softer; the size is the lever of the bumper [m].
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
}

impl Hidden {
    /// The size of this force; 0 where another one is hidden.
    pub fn force(&self, force: Force) -> f64 {
        match self.effect.acts {
            Acts::Force(hidden) if hidden == force => self.size,
            _ => 0.0,
        }
    }
}
