//! Units in which sizes are stated.

use super::number::{INTERVAL, Uncertain, digits, with_interval};

/// Unit in which a size is stated.
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
    /// Fractions.
    Percent,
    /// Linear values of the sensor.
    PercentOfFullScale,
    /// Exposure, in factors of 2.
    ExposureValues,
    /// No unit: a plain number.
    Plain,
}

impl Unit {
    /// Returns the number of these units in one base unit: radian, second, metre, pixel, 1.
    pub fn factor(self) -> f64 {
        match self {
            Self::Degrees | Self::DegreesPerSecond => 1f64.to_degrees(),
            Self::Milliseconds => 1e3,
            Self::Centimeters | Self::Percent | Self::PercentOfFullScale => 100.0,
            Self::Pixels | Self::ExposureValues | Self::Plain => 1.0,
        }
    }

    /// Returns the symbol after a number; empty for a plain number.
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

    /// Writes a number with the symbol: "3 %"; degrees follow without a space.
    fn after(self, number: &str) -> String {
        match self {
            Self::Degrees | Self::DegreesPerSecond => format!("{number}{}", self.symbol()),
            Self::Plain => number.to_owned(),
            _ => format!("{number} {}", self.symbol()),
        }
    }

    /// Writes a parameter's value, given in its base unit, with two digits: "0.080°"; a plain number with its name: "k1 =
    /// 0.0031".
    pub fn limit_in_words(self, parameter: &str, value: f64) -> String {
        let number = self.after(&digits(self.factor() * value, 2));
        if self == Self::Plain { format!("{parameter} = {number}") } else { number }
    }
}

/// Number with its uncertainty, in the unit in which it is stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amount {
    /// Number in that unit.
    pub number: Uncertain,
    /// The unit.
    pub unit: Unit,
}

impl Uncertain {
    /// Converts the number from its base unit (radian, second, metre, pixel, 1) to the unit in which it is stated.
    pub fn in_unit(self, unit: Unit) -> Amount {
        Amount { number: self.scaled(unit.factor()), unit }
    }
}

impl Amount {
    /// Writes the number without its sign, as "1.02°".
    pub fn size(self) -> String {
        Self { number: Uncertain { value: self.number.value.abs(), ..self.number }, ..self }.signed()
    }

    /// Writes the number with its sign.
    pub fn signed(self) -> String {
        let (value, _) = with_interval(self.number.value, INTERVAL * self.number.sigma);
        self.unit.after(&value)
    }

    /// Writes the 95 % interval in parentheses after a space, as " (± 0.05°)"; empty where it is not known.
    pub fn interval(self) -> String {
        let (_, interval) = with_interval(self.number.value, INTERVAL * self.number.sigma);
        // The interval need not repeat what the percentage refers to.
        let unit = if self.unit == Unit::PercentOfFullScale { Unit::Percent } else { self.unit };
        interval.map_or_else(String::new, |interval| format!(" (± {})", unit.after(&interval)))
    }

    /// Writes the size with a direction, "1.02° too low (± 0.05°)": the first word for positive values, else the second.
    pub fn with_direction(self, [positive, negative]: [&str; 2]) -> String {
        let word = if self.number.value < 0.0 { negative } else { positive };
        format!("{} {word}{}", self.size(), self.interval())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_stated_in_familiar_units() {
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
