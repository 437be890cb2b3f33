//! The unit of a MAT-file's variable, by the last part of its name.

/// Units by the last part of a name.
const UNITS: [(&str, &str); 24] = [
    ("1pm", "1/m"),
    ("bytes", "B"),
    ("c", "degC"),
    ("deg", "deg"),
    ("hz", "Hz"),
    ("j", "J"),
    ("k", "K"),
    ("kg", "kg"),
    ("kgm2", "kg m^2"),
    ("kgps", "kg/s"),
    ("m", "m"),
    ("m2", "m^2"),
    ("mps", "m/s"),
    ("mps2", "m/s^2"),
    ("ms", "ms"),
    ("n", "N"),
    ("nm", "N m"),
    ("pa", "Pa"),
    ("pct", "%"),
    ("rad", "rad"),
    ("radps", "rad/s"),
    ("radps2", "rad/s^2"),
    ("s", "s"),
    ("seconds", "s"),
];

/// The unit of a name that has one.
pub(super) fn unit(name: &str) -> Option<&'static str> {
    let last = name.rsplit('_').next()?;
    let (_, unit) = UNITS.iter().find(|(suffix, _)| *suffix == last)?;
    Some(unit)
}
