//! The numbers of an effect.

/// Role of a parameter when it is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// Size of the effect: decides whether it is there.
    Size,
    /// Form of the effect: decides nothing alone.
    Shape,
    /// Given by the recording, never fitted.
    Fixed,
}

/// Growth of an effect with a parameter near its neutral value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Growth {
    /// In proportion.
    Linear,
    /// With the square, as a blur grows: fitted as its square, never negative.
    Square,
}

/// One number of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Key in `model.toml`, with its unit as suffix where it has one: `pitch_rad`.
    pub name: &'static str,
    /// `rad`, `m`, `s`, `px`, `EV`; `1` for a plain number.
    pub unit: &'static str,
    /// Value at which the effect vanishes.
    pub neutral: f64,
    /// Plausible values, ends included.
    pub range: [f64; 2],
    /// A small change, for derivatives.
    pub step: f64,
    /// The least size worth caring about; 0 where the parameter is no size.
    pub material: f64,
    /// Role when it is fitted.
    pub role: Role,
    /// Growth of the effect with it.
    pub growth: Growth,
}

impl Parameter {
    /// The size of an effect that grows in proportion and vanishes at 0.
    pub const fn size(name: &'static str, unit: &'static str, range: [f64; 2], material: f64) -> Self {
        let (neutral, step) = (0.0, 0.5 * material);
        Self { name, unit, neutral, range, step, material, role: Role::Size, growth: Growth::Linear }
    }

    /// The size of an effect that grows with the square from 0.
    pub const fn square(name: &'static str, unit: &'static str, largest: f64, material: f64) -> Self {
        let size = Self::size(name, unit, [0.0, largest], material);
        Self { step: material, growth: Growth::Square, ..size }
    }

    /// A number that changes an effect's form, 0 for the plain one.
    pub const fn shape(name: &'static str, unit: &'static str, range: [f64; 2], step: f64) -> Self {
        let size = Self::size(name, unit, range, 0.0);
        Self { step, role: Role::Shape, ..size }
    }

    /// A number that the recording gives.
    pub const fn fixed(name: &'static str, unit: &'static str) -> Self {
        let range = [f64::NEG_INFINITY, f64::INFINITY];
        Self { role: Role::Fixed, ..Self::shape(name, unit, range, 1e-3) }
    }
}
