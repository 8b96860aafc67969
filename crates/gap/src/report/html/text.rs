//! Text in HTML.

/// Escapes text for use between tags and in attributes. Control characters, which HTML does not allow, are shown by their escapes.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            letter if letter.is_control() && letter != '\n' => escaped.extend(letter.escape_default()),
            _ => escaped.push(letter),
        }
    }
    escaped
}

/// Returns a text with a capital letter.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters.next().map(|letter| letter.to_uppercase().collect()).unwrap_or_default();
    first + letters.as_str()
}

/// Returns a table with a row of headings. Headings are plain text, and those that start with `>` are above numbers; rows
/// are HTML.
pub fn table(headings: &[&str], rows: &[String]) -> String {
    let heading = |text: &&str| match text.strip_prefix('>') {
        Some(text) => format!("<th class=\"n\" scope=\"col\">{}</th>", escape(text)),
        None => format!("<th scope=\"col\">{}</th>", escape(text)),
    };
    let headings: String = headings.iter().map(heading).collect();
    format!(
        "<div class=\"scroll\"><table><thead><tr>{headings}</tr></thead><tbody>{}</tbody></table></div>\n",
        rows.concat()
    )
}

/// Returns a table cell with text.
pub(super) fn cell(text: &str) -> String {
    format!("<td>{}</td>", escape(text))
}

/// Returns a table cell with a number.
pub(super) fn number(text: &str) -> String {
    format!("<td class=\"n\">{}</td>", escape(text))
}

/// Returns a table cell with an effect's name above its id.
pub(super) fn effect_cell(name: &str, id: &str) -> String {
    format!("<td>{}<br/><code>{}</code></td>", escape(&capital(name)), escape(id))
}
