//! HTML fragments.

/// Escapes a text for the content of an element or the value of an attribute.
pub(super) fn escaped(text: &str) -> String {
    let escape = |c: char| match c {
        '&' => "&amp;".to_owned(),
        '<' => "&lt;".to_owned(),
        '>' => "&gt;".to_owned(),
        '"' => "&quot;".to_owned(),
        '\'' => "&#39;".to_owned(),
        // Characters that are not allowed on a page.
        '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' => "\u{fffd}".to_owned(),
        c => c.to_string(),
    };
    text.chars().map(escape).collect()
}

/// A table with a heading for each column.
pub(super) fn table(heads: &[&str], rows: &[Vec<String>]) -> String {
    let cells = |name: &str, cells: &mut dyn Iterator<Item = &str>| {
        let cells: Vec<String> = cells.map(|cell| format!("<{name}>{}</{name}>", escaped(cell))).collect();
        format!("<tr>{}</tr>\n", cells.concat())
    };
    let head = cells("th", &mut heads.iter().copied());
    let body: String = rows.iter().map(|row| cells("td", &mut row.iter().map(String::as_str))).collect();
    format!("<div class=\"table\"><table>\n{head}{body}</table></div>\n")
}

/// A section of the page that is collapsed at first.
pub(super) fn folded(title: &str, content: &str) -> String {
    format!("<details><summary>{}</summary>\n{content}</details>\n", escaped(title))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stays_text() {
        assert_eq!(escaped("a < b & \"c\" 'd'>\0"), "a &lt; b &amp; &quot;c&quot; &#39;d&#39;&gt;\u{fffd}");
        let table = table(&["<b>"], &[vec!["</table>".to_owned()]]);
        assert!(table.contains("<th>&lt;b&gt;</th>") && table.matches("</table>").count() == 1);
    }
}
