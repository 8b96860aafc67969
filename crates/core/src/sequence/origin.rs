//! Which robot recorded a sequence, and when: optional keys of `sequence.toml`.

use std::path::Path;

use serde::Deserialize;

use super::{
    check_folder,
    error::{Fault, SequenceError, excerpt},
    limits::MAX_TOML_BYTES,
    printable::is_printable,
    sequence_file::SEQUENCE_FILE,
    text::read_and_parse,
    toml_text::{line_of_key, parse},
};

/// Which robot recorded a sequence, and when.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Origin {
    /// Name of the robot.
    pub robot: Option<String>,
    /// Day of the recording, such as `2026-05-31`: days in order of time are in the order of their texts.
    pub recorded_on: Option<String>,
}

#[derive(Deserialize)]
struct OriginTable {
    robot: Option<String>,
    recorded_on: Option<Day>,
}

/// A date of TOML, or one in quotes.
#[derive(Deserialize)]
#[serde(untagged)]
enum Day {
    Date(toml::value::Datetime),
    Text(String),
}

/// Reads which robot recorded a sequence, `robot`, and on which day, `recorded_on`, from its `sequence.toml`. Fails if the file cannot be
/// read, with a name that cannot be printed, or with a day that is none.
pub fn read_origin(folder: &Path) -> Result<Origin, SequenceError> {
    check_folder(folder)?;
    read_and_parse(&folder.join(SEQUENCE_FILE), MAX_TOML_BYTES, parse_origin)
}

fn parse_origin(path: &Path, text: &str) -> Result<Origin, SequenceError> {
    let OriginTable { robot, recorded_on } = parse(path, text)?;
    if let Some(robot) = robot.as_ref().filter(|robot| !is_printable(robot)) {
        let fault = Fault::BadName { key: "robot", name: excerpt(robot) };
        return Err(SequenceError::at(path, line_of_key(text, &["robot"]), fault));
    }
    let recorded_on = recorded_on.map(|day| match day {
        Day::Date(date) => date.to_string(),
        Day::Text(text) => text,
    });
    let is_day = |day: &str| day.parse::<toml::value::Datetime>().is_ok_and(|date| date.date.is_some());
    match recorded_on {
        Some(day) if !is_day(&day) => {
            let fault = Fault::BadDay { day: excerpt(&day) };
            Err(SequenceError::at(path, line_of_key(text, &["recorded_on"]), fault))
        }
        // Of a time, the date.
        day => Ok(Origin { robot, recorded_on: day.map(|day| day.chars().take(10).collect()) }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn origin(text: &str) -> Result<Origin, SequenceError> {
        parse_origin(Path::new("sequence.toml"), text)
    }

    #[test]
    fn robot_and_day_are_read_where_they_are_told() {
        let told = |robot: Option<&str>, day: Option<&str>| Origin {
            robot: robot.map(str::to_owned),
            recorded_on: day.map(str::to_owned),
        };
        for (text, expected) in [
            ("name = \"walk\"", told(None, None)),
            ("robot = \"nao-23\"\nrecorded_on = 2026-05-31", told(Some("nao-23"), Some("2026-05-31"))),
            ("recorded_on = \"2026-05-31\"", told(None, Some("2026-05-31"))),
            ("recorded_on = 2026-05-31T10:20:30Z", told(None, Some("2026-05-31"))),
        ] {
            assert_eq!(origin(text).unwrap(), expected, "{text}");
        }
    }

    #[test]
    fn what_is_no_robot_and_no_day_is_refused_with_its_line() {
        for text in ["\nrobot = \"a\\nb\"", "\nrecorded_on = \"yesterday\"", "\nrecorded_on = \"10:20:30\""] {
            let error = origin(text).unwrap_err().to_string();
            assert!(error.starts_with("sequence.toml, line 2: "), "{error}");
        }
    }
}
