//! Messages and paths on one line.

use std::{fmt, path::Path};

/// Puts a message on one line: replaces line breaks and other control characters by spaces, and joins runs of spaces.
pub fn one_line(message: impl fmt::Display) -> String {
    let message = message.to_string();
    let printable: String =
        message.chars().map(|letter| if is_unprintable(letter) { ' ' } else { letter }).collect();
    printable.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns whether a character is a control character, or one of two that some programs take for the end of a line.
fn is_unprintable(letter: char) -> bool {
    letter.is_control() || matches!(letter, '\u{2028}' | '\u{2029}')
}

/// Path for a message, printed without line breaks.
#[derive(Debug)]
pub struct Printable<'a>(pub &'a Path);

impl fmt::Display for Printable<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.0.to_string_lossy();
        text.chars().try_for_each(|letter| {
            if is_unprintable(letter) {
                write!(formatter, "{}", letter.escape_default())
            } else {
                write!(formatter, "{letter}")
            }
        })
    }
}
