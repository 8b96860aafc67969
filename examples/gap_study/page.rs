//! Insertion of the tables into a page.

use std::{error::Error, fs, path::Path};

/// Marks at which the tables begin and end.
const MARKS: [&str; 2] = ["<!-- study: begin -->\n", "<!-- study: end -->\n"];

/// Replaces the tables between the marks of a page.
pub fn put(page: &Path, tables: &str) -> Result<(), Box<dyn Error>> {
    let text = fs::read_to_string(page)?;
    let [begin, end] = MARKS.map(|mark| text.find(mark));
    let (Some(begin), Some(end)) = (begin, end) else {
        return Err(format!(
            "{} has no marks {MARKS:?} for the tables: write them where these belong",
            page.display()
        )
        .into());
    };
    let from = begin + MARKS[0].len();
    fs::write(page, format!("{}\n{tables}\n{}", &text[..from], &text[end..]))?;
    Ok(())
}
