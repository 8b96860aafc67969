//! Messages and paths on one line.

use std::{borrow::Cow, fmt, path::Path};

/// Puts a message on one line: replaces line breaks and other control characters by spaces, and joins runs of spaces.
pub fn one_line(message: impl fmt::Display) -> String {
    let message = message.to_string();
    let printable: String =
        message.chars().map(|letter| if is_unprintable(letter) { ' ' } else { letter }).collect();
    printable.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns a number with what it counts: "1 picture", "2 pictures".
pub fn counted(number: usize, noun: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {noun}{plural}")
}

/// Escapes the control characters of a text for a terminal, which would obey them; line breaks stay.
pub fn for_terminal(text: &str) -> Cow<'_, str> {
    let is_obeyed = |letter: char| letter != '\n' && is_unprintable(letter);
    if text.contains(is_obeyed) {
        Cow::Owned(text.chars().map(|letter| escaped_if(is_obeyed(letter), letter)).collect())
    } else {
        Cow::Borrowed(text)
    }
}

/// Escapes the control characters of a value that is printed on one line, line breaks among them: nothing in it can look like
/// another line.
pub fn on_one_line(value: &str) -> String {
    value.chars().map(|letter| escaped_if(is_unprintable(letter), letter)).collect()
}

/// Returns whether every character of a text can be printed as it is.
pub(super) fn is_printable(text: &str) -> bool {
    !text.contains(is_unprintable)
}

fn escaped_if(escapes: bool, letter: char) -> String {
    if escapes { letter.escape_default().to_string() } else { letter.to_string() }
}

/// Returns whether a character is a control character, one of two that some programs take for the end of a line, or one that
/// turns the direction of writing around.
fn is_unprintable(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{2028}' | '\u{2029}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Path for a message, printed without line breaks.
#[derive(Debug)]
pub struct Printable<'a>(pub &'a Path);

impl fmt::Display for Printable<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&on_one_line(&self.0.to_string_lossy()))
    }
}
