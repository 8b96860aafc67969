//! Units in which a person says sizes.

use super::number::{INTERVAL, Uncertain, digits, with_interval};

/// Unit in which a size is said.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unit {
    /// Angles.
    Degrees,
    /// Angular rates.
    DegreesPerSecond,
    /// Times.
    Milliseconds,
    /// Lengths on the field.
    Centimeters,
    /// Lengths in the picture.
    Pixels,
    /// Parts of one.
    Percent,
    /// Linear values of the sensor.
    PercentOfFullScale,
    /// Exposure, in factors of 2.
    ExposureValues,
    /// None: a plain number.
    Plain,
}

impl Unit {
    /// The number of these units in one of the base unit: radian, second, metre, pixel, 1.
    pub fn factor(self) -> f64 {
        match self {
            Self::Degrees | Self::DegreesPerSecond => 1f64.to_degrees(),
            Self::Milliseconds => 1e3,
            Self::Centimeters | Self::Percent | Self::PercentOfFullScale => 100.0,
            Self::Pixels | Self::ExposureValues | Self::Plain => 1.0,
        }
    }

    /// Its symbol after a number; empty for a plain one.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Degrees => "°",
            Self::DegreesPerSecond => "°/s",
            Self::Milliseconds => "ms",
            Self::Centimeters => "cm",
            Self::Pixels => "px",
            Self::Percent => "%",
            Self::PercentOfFullScale => "% of full scale",
            Self::ExposureValues => "EV",
            Self::Plain => "",
        }
    }

    /// A number with the symbol: "3 %"; degrees follow without a space.
    fn after(self, number: &str) -> String {
        match self {
            Self::Degrees | Self::DegreesPerSecond => format!("{number}{}", self.symbol()),
            Self::Plain => number.to_owned(),
            _ => format!("{number} {}", self.symbol()),
        }
    }

    /// A parameter's value, in its base unit, with two digits: "0.080°"; a plain number with its name: "k1 = 0.0031".
    pub fn limit_in_words(self, parameter: &str, value: f64) -> String {
        let number = self.after(&digits(self.factor() * value, 2));
        if self == Self::Plain { format!("{parameter} = {number}") } else { number }
    }
}

/// A number, with its uncertainty, in the unit in which it is said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amount {
    /// In that unit.
    pub number: Uncertain,
    /// The unit.
    pub unit: Unit,
}

impl Uncertain {
    /// The number, in a base unit (radian, second, metre, pixel, 1), in the unit in which it is said.
    pub fn in_unit(self, unit: Unit) -> Amount {
        Amount { number: self.scaled(unit.factor()), unit }
    }
}

impl Amount {
    /// Its size without its sign, as in "1.02°".
    pub fn size(self) -> String {
        Self { number: Uncertain { value: self.number.value.abs(), ..self.number }, ..self }.signed()
    }

    /// With its sign.
    pub fn signed(self) -> String {
        let (value, _) = with_interval(self.number.value, INTERVAL * self.number.sigma);
        self.unit.after(&value)
    }

    /// The 95 % interval in parentheses after a space, as in " (± 0.05°)"; nothing where it is not known.
    pub fn interval(self) -> String {
        let (_, interval) = with_interval(self.number.value, INTERVAL * self.number.sigma);
        // What a percentage is part of needs no repeating.
        let unit = if self.unit == Unit::PercentOfFullScale { Unit::Percent } else { self.unit };
        interval.map_or_else(String::new, |interval| format!(" (± {})", unit.after(&interval)))
    }

    /// "1.02° too low (± 0.05°)": the first word where it is positive, else the second.
    pub fn with_direction(self, [positive, negative]: [&str; 2]) -> String {
        let word = if self.number.value < 0.0 { negative } else { positive };
        format!("{} {word}{}", self.size(), self.interval())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_in_the_units_of_people() {
        assert_eq!(Unit::Degrees.limit_in_words("pitch_rad", 0.0014), "0.080°");
        assert_eq!(Unit::Milliseconds.limit_in_words("readout_s", 0.0042), "4.2 ms");
        assert_eq!(Unit::Percent.limit_in_words("strength", 0.031), "3.1 %");
        assert_eq!(Unit::Plain.limit_in_words("k1", 0.0031), "k1 = 0.0031");
        assert_eq!(Unit::Pixels.limit_in_words("sigma_px", 0.31), "0.31 px");
    }

    #[test]
    fn a_direction_follows_the_sign() {
        let offset = |value: f64| Uncertain { value, sigma: 0.001 }.in_unit(Unit::PercentOfFullScale);
        let words = ["brighter", "darker"];
        assert_eq!(offset(0.031).with_direction(words), "3.1 % of full scale brighter (± 0.2 %)");
        assert_eq!(offset(-0.031).with_direction(words), "3.1 % of full scale darker (± 0.2 %)");
    }
}
