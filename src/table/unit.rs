//! Units as files spell them.

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// s
    Time,
    /// Hz: cycles per second.
    Frequency,
    /// rad/s
    AngularFrequency,
    /// Pa
    Pressure,
    /// m
    Length,
    /// Anything of which no more is known than its unit.
    Other,
}

/// A unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// As it is written here.
    pub name: &'static str,
    /// What it is a unit of.
    pub quantity: Quantity,
    /// A power of ten or a fraction: one of it is so many, over `per`, of the SI unit.
    factor: f64,
    per: f64,
}

const fn unit(name: &'static str, quantity: Quantity, factor: f64, per: f64) -> Unit {
    Unit { name, quantity, factor, per }
}

/// The units that are known, and other spellings of each. Case counts where it tells M from m.
const UNITS: [(Unit, &[&str]); 21] = [
    (unit("s", Quantity::Time, 1.0, 1.0), &["sec", "secs", "second", "seconds"]),
    (unit("ms", Quantity::Time, 1.0, 1e3), &["msec"]),
    (unit("min", Quantity::Time, 60.0, 1.0), &["mins", "minute", "minutes"]),
    (unit("h", Quantity::Time, 3600.0, 1.0), &["hr", "hour", "hours"]),
    (unit("Hz", Quantity::Frequency, 1.0, 1.0), &["hz", "HZ", "hertz", "Hertz", "cycles/s"]),
    (unit("kHz", Quantity::Frequency, 1e3, 1.0), &["khz"]),
    (unit("rad/s", Quantity::AngularFrequency, 1.0, 1.0), &["rad/sec", "rad s^-1", "rad.s-1", "rad s-1", "rad·s⁻¹"]),
    (unit("Pa", Quantity::Pressure, 1.0, 1.0), &["pa", "PA", "N/m2", "N/m^2", "N/m²"]),
    (unit("kPa", Quantity::Pressure, 1e3, 1.0), &["KPa", "kpa"]),
    (unit("MPa", Quantity::Pressure, 1e6, 1.0), &["Mpa", "MPA", "N/mm2", "N/mm^2", "N/mm²"]),
    (unit("GPa", Quantity::Pressure, 1e9, 1.0), &["Gpa", "gpa", "GPA"]),
    (unit("m", Quantity::Length, 1.0, 1.0), &["metre", "metres", "meter", "meters"]),
    (unit("cm", Quantity::Length, 1.0, 1e2), &[]),
    (unit("mm", Quantity::Length, 1.0, 1e3), &["millimetre", "millimeter", "millimeters"]),
    (
        unit("um", Quantity::Length, 1.0, 1e6),
        &["µm", "μm", "micron", "microns", "Microns", "micrometer", "micrometers", "micrometre", "micrometres"],
    ),
    (unit("nm", Quantity::Length, 1.0, 1e9), &["nanometer", "nanometers", "nanometre"]),
    (unit("A", Quantity::Length, 1.0, 1e10), &["Å", "angstrom", "Angstrom"]),
    (unit("C", Quantity::Other, 1.0, 1.0), &["°C", "degC", "deg C"]),
    (unit("K", Quantity::Other, 1.0, 1.0), &[]),
    (unit("N", Quantity::Other, 1.0, 1.0), &[]),
    (unit("deg", Quantity::Other, 1.0, 1.0), &["°"]),
];

impl Unit {
    /// s
    pub const SECOND: Self = UNITS[0].0;
    /// Hz
    pub const HERTZ: Self = UNITS[4].0;
    /// rad/s
    pub const RADIAN_PER_SECOND: Self = UNITS[6].0;
    /// Pa
    pub const PASCAL: Self = UNITS[7].0;
    /// kPa
    pub const KILOPASCAL: Self = UNITS[8].0;
    /// MPa
    pub const MEGAPASCAL: Self = UNITS[9].0;
    /// GPa
    pub const GIGAPASCAL: Self = UNITS[10].0;

    /// The unit that is spelt so; none if it is not known, or could be two.
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        UNITS.iter().find(|(unit, others)| unit.name == text || others.contains(&text)).map(|(unit, _)| *unit)
    }

    /// m
    pub const METRE: Self = UNITS[11].0;

    /// A value in this unit in SI units. Division by a power of ten keeps the digits that a user typed: 0.3 um is the
    /// double nearest to 3e-7 m.
    pub fn to_si(self, value: f64) -> f64 {
        value * self.factor / self.per
    }

    /// The names of all units of a quantity.
    pub fn names(quantity: Quantity) -> Vec<&'static str> {
        UNITS.iter().filter(|(unit, _)| unit.quantity == quantity).map(|(unit, _)| unit.name).collect()
    }
}
