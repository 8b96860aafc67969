//! Text of files that reaches a terminal or a page.

use super::*;

/// Name that clears the screen and adds a line, as a file may hold it.
const FORGED: &str = r"walk\u001b[2J\nerror      mean 0.00 cm\u0000";

#[test]
fn names_with_control_characters_are_refused_and_quoted() {
    let folder = tempfile::tempdir().unwrap();
    let walk = copy_of_short_walk(folder.path());
    edit(&walk.join("sequence.toml"), |text| text.replace("\"short\"", &format!("\"{FORGED}\"")));
    let message = assert_fails(&["tag", shown(&walk)], &["sequence.toml, line", "control characters"]);
    assert!(!message.contains('\x1b') && !message.contains('\0'), "{message:?}");
}

#[test]
fn names_in_a_database_cannot_forge_lines() {
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("forged.db");
    fs::copy(&short_walk().2, &database).unwrap();
    let connection = rusqlite::Connection::open(&database).unwrap();
    let name = "short\x1b[2J\nimages    9999\u{9b}2J\u{202e}";
    connection.execute("UPDATE sequences SET name = ?1", [name]).unwrap();
    drop(connection);
    let words = printed(&["info", shown(&database)]);
    let is_control = |letter: char| letter != '\n' && letter.is_control();
    assert!(!words.contains(is_control) && !words.contains('\u{202e}'), "{words:?}");
    assert!(!words.lines().any(|line| line.starts_with("images    9999")), "{words}");
    let json = printed(&["info", shown(&database), "--json"]);
    assert!(!json.contains(is_control), "{json:?}");
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["sequences"][0]["name"], name);
}
