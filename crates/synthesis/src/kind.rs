//! The list of methods.

use std::{fmt, str::FromStr};

use reality_sim_core::{
    names::{UnknownName, by_name},
    pose::CameraPose,
};

use crate::{
    Auto, Blend, Memory, Method, Nearest, Plane, Provenance, Quadratic, SynthesisError, Synthesizer,
};

/// Method of this package, to choose by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum MethodKind {
    /// [`Auto`].
    #[default]
    Auto,
    /// [`Nearest`].
    Nearest,
    /// [`Quadratic`].
    Quadratic,
    /// [`Plane`].
    Plane,
    /// [`Blend`].
    Blend,
}

impl MethodKind {
    /// All, in the order in which they are listed.
    pub const ALL: [Self; 5] = [Self::Auto, Self::Nearest, Self::Quadratic, Self::Plane, Self::Blend];

    /// Methods to compare with each other: all but [`Auto`], which chooses among them.
    pub const COMPARED: [Self; 4] = [Self::Nearest, Self::Quadratic, Self::Plane, Self::Blend];

    /// What it is called.
    pub fn name(self) -> &'static str {
        self.method().name()
    }

    /// What it does, in a line.
    pub fn description(self) -> &'static str {
        match self {
            Self::Auto => "The picture recorded at the pose where there is one, else as blend",
            Self::Nearest => "The nearest picture as it is",
            Self::Quadratic => "The paper's Eq. 4: a polynomial of second order from the nearest picture",
            Self::Plane => "One picture, through the ground plane and both lenses",
            Self::Blend => "Several pictures, mixed pixel by pixel",
        }
    }

    fn method(self) -> &'static dyn Method {
        match self {
            Self::Auto => &Auto,
            Self::Nearest => &Nearest,
            Self::Quadratic => &Quadratic,
            Self::Plane => &Plane,
            Self::Blend => &Blend,
        }
    }
}

impl Method for MethodKind {
    fn name(&self) -> &'static str {
        self.method().name()
    }

    fn draw(
        &self,
        from: &Synthesizer,
        pose: CameraPose,
        memory: &mut Memory,
        colors: &mut [[u8; 3]],
    ) -> Result<Provenance, SynthesisError> {
        self.method().draw(from, pose, memory, colors)
    }
}

impl fmt::Display for MethodKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for MethodKind {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        by_name("synthesis method", &Self::ALL, Self::name, name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_back_and_an_unknown_one_lists_those_known() {
        for kind in MethodKind::ALL {
            assert_eq!(kind.name().parse(), Ok(kind));
            assert_eq!(kind.to_string(), kind.name());
        }
        let unknown = "Blend".parse::<MethodKind>().unwrap_err();
        assert_eq!(unknown.known, MethodKind::ALL.map(MethodKind::name));
    }

    #[test]
    fn all_but_auto_are_compared() {
        assert_eq!(MethodKind::COMPARED, MethodKind::ALL[1..]);
    }
}
