//! Settings of a data set, by the names of the program's options.

use std::{fmt, str::FromStr};

use reality_sim_synthesis::MethodKind;
use serde::{Deserialize, Serialize};

/// Largest number of balls, and of robots, in a picture.
const MOST_THINGS: u16 = 50;

/// Settings of a data set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DatasetSettings {
    /// Number of pictures.
    pub count: u32,
    /// Seed of poses and things; a picture depends on the seed and its number alone.
    pub seed: u64,
    /// Method by which the pictures are made. Those of `nearest` and `quadratic` show another pose than the labels.
    #[serde(with = "by_name")]
    pub method: MethodKind,
    /// Largest distance of the nearest recorded picture, root mean square pixels. `docs/reconstruction.md` measures pictures as far
    /// away as 142 px.
    pub within: f64,
    /// Number of balls in a picture, each number as often.
    #[serde(with = "by_name")]
    pub balls: Numbers,
    /// Number of robots in a picture, each number as often.
    #[serde(with = "by_name")]
    pub robots: Numbers,
    /// Format of the pictures.
    pub format: PictureFormat,
    /// Whether the distance of every pixel, millimetres, is written, as 16-bit pictures.
    pub depth: bool,
    /// Whether it is written which thing every pixel shows, as 16-bit pictures.
    pub instances: bool,
    /// Whether it is written how far every pixel can be trusted, as 8-bit pictures.
    pub trust: bool,
}

impl Default for DatasetSettings {
    fn default() -> Self {
        Self {
            count: 100,
            seed: 0,
            method: MethodKind::Auto,
            within: 150.0,
            balls: Numbers { least: 0, most: 1 },
            robots: Numbers { least: 0, most: 3 },
            format: PictureFormat::Jpg,
            depth: false,
            instances: false,
            trust: false,
        }
    }
}

/// Format of the pictures.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PictureFormat {
    /// JPEG, of quality 95.
    #[default]
    Jpg,
    /// PNG.
    Png,
}

impl PictureFormat {
    /// Returns the ending of file names.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Jpg => "jpg",
            Self::Png => "png",
        }
    }
}

/// Numbers from a least to a greatest one, at most 50. The text of one is `MIN..MAX`, or one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numbers {
    least: u16,
    most: u16,
}

/// Text that is no [`Numbers`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("give one number, or two as MIN..MAX, from 0 to {MOST_THINGS}")]
pub struct InvalidNumbers;

impl Numbers {
    /// Chooses one of the numbers, each as often, with a random number from 0 to below 1.
    pub fn choose(self, random: f64) -> u32 {
        u32::from(self.least) + (random * f64::from(self.most - self.least + 1)) as u32
    }
}

impl fmt::Display for Numbers {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}..{}", self.least, self.most)
    }
}

impl FromStr for Numbers {
    type Err = InvalidNumbers;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (least, most) = text.split_once("..").unwrap_or((text, text));
        match (least.trim().parse(), most.trim().parse()) {
            (Ok(least), Ok(most)) if least <= most && most <= MOST_THINGS => Ok(Self { least, most }),
            _ => Err(InvalidNumbers),
        }
    }
}

/// Values that their text stands for in files.
mod by_name {
    use std::{fmt::Display, str::FromStr};

    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub(super) fn serialize<T: Display, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(value)
    }

    pub(super) fn deserialize<'de, T, D>(deserializer: D) -> Result<T, D::Error>
    where
        T: FromStr<Err: Display>,
        D: Deserializer<'de>,
    {
        String::deserialize(deserializer)?.parse().map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_one_or_two_in_order() {
        assert_eq!("0..3".parse(), Ok(Numbers { least: 0, most: 3 }));
        assert_eq!("2".parse(), Ok(Numbers { least: 2, most: 2 }));
        for wrong in ["", "3..2", "-1..2", "1..", "0..51", "a", "1..2..3"] {
            assert_eq!(wrong.parse::<Numbers>(), Err(InvalidNumbers), "{wrong}");
        }
    }

    #[test]
    fn settings_are_read_by_name_and_written_as_they_were() {
        let text = r#"{"count": 3, "method": "blend", "balls": "1..2", "robots": "0", "format": "png"}"#;
        let settings: DatasetSettings = serde_json::from_str(text).unwrap();
        assert_eq!((settings.method, settings.balls), (MethodKind::Blend, Numbers { least: 1, most: 2 }));
        let again: DatasetSettings =
            serde_json::from_str(&serde_json::to_string(&settings).unwrap()).unwrap();
        assert_eq!(again, settings);
        for wrong in [r#"{"balls": "3..1"}"#, r#"{"method": "Blend"}"#, r#"{"pictures": 3}"#] {
            assert!(serde_json::from_str::<DatasetSettings>(wrong).is_err(), "{wrong}");
        }
    }
}
