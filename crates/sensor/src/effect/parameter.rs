//! Parameters of an effect.

/// Role of a parameter when it is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// Size of the effect: tested to decide whether the effect is present.
    Size,
    /// Form of the effect: never tested alone.
    Shape,
    /// Given by the recording, never fitted.
    Fixed,
}

/// Growth of an effect with a parameter near its neutral value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Growth {
    /// Proportional to the parameter.
    Linear,
    /// Proportional to its square, as for a blur: fitted as the square, never negative.
    Square,
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Key in `model.toml`, with its unit as a suffix where it has one: `pitch_rad`.
    pub name: &'static str,
    /// Unit: `rad`, `m`, `s`, `px` or `EV`; `1` for a plain number.
    pub unit: &'static str,
    /// Value at which the effect vanishes.
    pub neutral: f64,
    /// Range of plausible values, ends included.
    pub range: [f64; 2],
    /// Step for numerical derivatives.
    pub step: f64,
    /// Material size, the least size that matters; 0 where the parameter is not a size.
    pub material: f64,
    /// Role when it is fitted.
    pub role: Role,
    /// Growth of the effect with this parameter.
    pub growth: Growth,
}

impl Parameter {
    /// Returns a size that the effect grows in proportion to, neutral at 0.
    pub const fn size(name: &'static str, unit: &'static str, range: [f64; 2], material: f64) -> Self {
        let (neutral, step) = (0.0, 0.5 * material);
        Self { name, unit, neutral, range, step, material, role: Role::Size, growth: Growth::Linear }
    }

    /// Returns a size whose square the effect grows with, neutral at 0.
    pub const fn square(name: &'static str, unit: &'static str, largest: f64, material: f64) -> Self {
        let size = Self::size(name, unit, [0.0, largest], material);
        Self { step: material, growth: Growth::Square, ..size }
    }

    /// Returns a parameter that changes the effect's form, 0 for the plain form.
    pub const fn shape(name: &'static str, unit: &'static str, range: [f64; 2], step: f64) -> Self {
        let size = Self::size(name, unit, range, 0.0);
        Self { step, role: Role::Shape, ..size }
    }

    /// Returns a parameter that the recording gives.
    pub const fn fixed(name: &'static str, unit: &'static str) -> Self {
        let range = [f64::NEG_INFINITY, f64::INFINITY];
        Self { role: Role::Fixed, ..Self::shape(name, unit, range, 1e-3) }
    }
}
